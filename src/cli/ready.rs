//! A scene ready to be drawn: loaded, divided into groups, ordered, seen by a camera.

use super::{progress, report};
use splatref::Result;
use splatref::frame::Exec;
use splatref::index::grouping::{Extended, GroupingReport};
use splatref::io::scene_file::{Loaded, SceneFile};
use splatref::method::{Method, Preparation};
use splatref::scene::Camera;

/// All that [`super::draw::draw`] needs.
pub(super) struct Ready {
    pub(super) loaded: Loaded,
    pub(super) preparation: Preparation,
    pub(super) camera: Camera,
    pub(super) method: Method,
    /// How the groups were made, if they were not read.
    grouping: Option<(GroupingReport, Option<Extended>)>,
}

impl Ready {
    /// Loads and prepares what a scene file says.
    pub(super) fn new(file: &SceneFile, exec: &Exec) -> Result<Self> {
        // What is wrong with the settings is said before much is read.
        let method = file.method.method()?;
        file.groups.check()?;
        let steps = progress::Steps::new();
        let show = |what: &str, done, of| steps.show(what, done, of);
        let loaded = file.load(exec, &show)?;
        method.check_scene(&loaded.scene)?;
        let surfels = &loaded.scene.surfels;
        let camera = file.camera(&loaded.scene)?;
        let made = file.groups(surfels, &method, exec, &show)?;
        let (groups, grouping) = made.unzip();
        let preparation = Preparation::new(surfels, groups, &method, exec);
        Ok(Self { loaded, preparation, camera, method, grouping: grouping.flatten() })
    }

    /// Says how the groups came about.
    pub(super) fn report_groups(&self) {
        if let Some(groups) = self.preparation.groups() {
            report::groups(groups, self.grouping.as_ref());
        }
    }
}
