//! From a scene file to a session.

use super::{Loaded, SceneFile};
use crate::error::Result;
use crate::frame::Exec;
use crate::index::grouping::Grouping;
use crate::method::session::Made;
use crate::method::{Method, Session};
use crate::scene::Camera;

/// What a scene file says, loaded and resolved: all that a picture needs.
#[derive(Clone, Debug)]
pub struct Ready {
    /// The scene, and how it came about.
    pub loaded: Loaded,
    /// Where the scene is seen from.
    pub camera: Camera,
    /// What is computed.
    pub method: Method,
    /// How groups are made; none: those of the scene, or as the method says.
    pub grouping: Option<Grouping>,
}

impl SceneFile {
    /// Loads the scene and resolves camera and method. What is wrong with the settings is said
    /// before much is read.
    ///
    /// `progress` is told the name of a step, how much of it is done, and of how much.
    ///
    /// # Errors
    /// As [`SceneFile::load`] and [`SceneFile::camera`]; [`crate::Error::Invalid`] if a setting is
    /// out of range or not of the method, or if the method cannot draw the scene.
    pub fn ready(&self, exec: &Exec, progress: &dyn Fn(&str, u64, u64)) -> Result<Ready> {
        let method = self.method.method()?;
        let grouping = self.grouping(&method)?;
        let loaded = self.load(exec, progress)?;
        method.check_scene(&loaded.scene)?;
        let camera = self.camera(&loaded.scene)?;
        Ok(Ready { loaded, camera, method, grouping })
    }
}

impl Ready {
    /// A session of the scene and the method, and how groups were made, if they were.
    ///
    /// # Errors
    /// As [`Session::prepare`].
    pub fn session<'a>(
        &'a self,
        exec: &'a Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<(Session<'a>, Option<Made>)> {
        Session::prepare(&self.loaded.scene, self.method, self.grouping, exec, progress)
    }
}
