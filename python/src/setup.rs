//! A scene, a camera and a method together: what a picture or a verdict is made of.

use crate::scene::{Content, Scene};
use splatref::frame::{Exec, Rect};
use splatref::io::scene_file::{OutputSettings, Ready, SceneFile};
use splatref::method::{Method, Session};
use splatref::progress::Progress;
use splatref::scene::{self, Camera, Groups};
use splatref::{Error, Result};
use std::sync::{Arc, PoisonError};

/// Everything that a session needs, and its camera.
pub(crate) struct Setup {
    place: Place,
    pub(crate) camera: Camera,
    pub(crate) method: Method,
    groups: Option<Groups>,
    pub(crate) output: OutputSettings,
}

/// Where the scene is.
enum Place {
    /// As it was loaded: every camera sees the same.
    Shared(Arc<Content>),
    /// Made for this camera and frame, from objects.
    Own(Box<Ready>),
}

impl Setup {
    /// Places a scene before the camera of a scene file. Of a scene in parts, reads what a region of the
    /// picture shows, or all if the method needs it.
    pub(crate) fn placed(
        scene: &Scene,
        file: &SceneFile,
        region: Option<Rect>,
        exec: &Exec,
    ) -> Result<Self> {
        let (method, output) = (file.method.method()?, file.output);
        let (place, camera) = match &*scene.content {
            Content::File(loaded) if loaded.is_in_parts() => {
                let mut ready = file.ready_of(loaded.as_ref().clone(), exec)?;
                let camera = ready.camera;
                match ready.part(region, exec)? {
                    Some(part) => {
                        ready.loaded.scene = part;
                        (Place::Own(Box::new(ready)), camera)
                    }
                    None => (Place::Shared(scene.whole(exec)?), camera),
                }
            }
            Content::File(loaded) if loaded.scene.objects.is_some() => {
                let ready = file.ready_of(loaded.as_ref().clone(), exec)?;
                let camera = ready.camera;
                (Place::Own(Box::new(ready)), camera)
            }
            content => {
                let camera = file.camera(content.scene())?;
                (Place::Shared(scene.content.clone()), camera)
            }
        };
        Ok(Self { place, camera, method, groups: None, output })
    }

    /// The same, with the groups of the method.
    pub(crate) fn new(
        scene: &Scene,
        file: &SceneFile,
        region: Option<Rect>,
        exec: &Exec,
        show: Progress<'_>,
    ) -> Result<Self> {
        let mut setup = Self::placed(scene, file, region, exec)?;
        let method = setup.method;
        let grouping = file.grouping(&method)?;
        let Some(default) = method.grouping() else { return Ok(setup) };
        let shared = matches!(setup.place, Place::Shared(_));
        let key = format!("{default:?} {grouping:?}");
        let mut known = scene.groups.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, groups)) = &*known
            && shared
            && *of == key
        {
            setup.groups = Some(groups.clone());
            return Ok(setup);
        }
        let (session, _) = Session::prepare(setup.scene(), method, grouping, exec, show)?;
        let groups = session.groups().cloned();
        drop(session);
        if shared {
            *known = groups.clone().map(|groups| (key, groups));
        }
        setup.groups = groups;
        Ok(setup)
    }

    /// Whether other cameras see the same scene.
    pub(crate) fn is_shared(&self) -> bool {
        matches!(self.place, Place::Shared(_))
    }

    pub(crate) fn scene(&self) -> &scene::Scene {
        match &self.place {
            Place::Shared(content) => content.scene(),
            Place::Own(ready) => &ready.loaded.scene,
        }
    }

    pub(crate) fn groups(&self) -> Option<&Groups> {
        self.groups.as_ref()
    }

    pub(crate) fn session<'a>(&'a self, exec: &'a Exec) -> Result<Session<'a>> {
        Session::with_groups(self.scene(), self.method, self.groups.clone(), exec)
    }

    /// Refuses other formats than f32, for calls that take no others.
    pub(crate) fn check_kept(&self, why: &str) -> Result<()> {
        self.output.check_kept(why).map_err(|error| match error {
            Error::Usage(what) => Error::Invalid(what),
            other => other,
        })
    }
}
