//! From a scene file to a session.

use super::{Loaded, SceneFile};
use crate::error::Result;
use crate::frame::Exec;
use crate::index::grouping::Grouping;
use crate::method::session::Made;
use crate::method::{Method, Session};
use crate::scene::{Camera, CameraMotion, Lens, Primitives, Surfels};
use crate::source::flatten;

/// What a scene file says, loaded and resolved: all that the picture of a frame needs.
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
    /// The frame.
    frame: u32,
    /// How the camera moves, if it does, and its lens.
    motion: Option<(CameraMotion, Lens)>,
}

impl SceneFile {
    /// Loads the scene in the frame that is pictured and resolves camera and method. What is wrong
    /// with the settings is said before much is read.
    ///
    /// `progress` is told the name of a step, how much of it is done, and of how much.
    ///
    /// # Errors
    /// As [`SceneFile::check_frame`], [`SceneFile::load`], [`SceneFile::camera`] and [`Ready::at`];
    /// [`crate::Error::Invalid`] if a setting is
    /// out of range or not of the method, or if the method cannot draw the scene.
    pub fn ready(&self, exec: &Exec, progress: &dyn Fn(&str, u64, u64)) -> Result<Ready> {
        let method = self.method.method()?;
        let grouping = self.grouping(&method)?;
        self.check_frame(self.frame)?;
        let loaded = self.load(exec, progress)?;
        let camera = self.camera(&loaded.scene)?;
        let (frame, motion) = (self.frame, self.camera.motion.clone());
        let motion = motion.map(|motion| (motion, self.lens()));
        let mut ready = Ready { loaded, camera, method, grouping, frame, motion };
        ready.place(exec)?;
        Ok(ready)
    }
}

impl Ready {
    /// The same scene in another frame, in the memory of this one.
    ///
    /// # Errors
    /// As [`Ready::camera_at`], [`crate::scene::Objects::at`] and [`flatten()`].
    pub fn at(mut self, frame: u32, exec: &Exec) -> Result<Self> {
        self.camera = self.camera_at(frame)?;
        self.frame = frame;
        if !self.is_still() {
            self.place(exec)?;
        }
        Ok(self)
    }

    /// The camera in a frame.
    ///
    /// # Errors
    /// As [`Camera::new`].
    pub fn camera_at(&self, frame: u32) -> Result<Camera> {
        let Some((motion, lens)) = &self.motion else { return Ok(self.camera) };
        Camera::new(self.camera.width, self.camera.height, motion.at(frame), *lens)
    }

    /// Whether the scene is the same in every frame, so that one session draws all of them.
    #[must_use]
    pub fn is_still(&self) -> bool {
        self.loaded.scene.objects.as_ref().is_none_or(crate::scene::Objects::are_still)
    }

    /// Puts the objects in their places of the frame. What a method is given of them is decided here:
    /// every method draws surfels.
    fn place(&mut self, exec: &Exec) -> Result<()> {
        let scene = &mut self.loaded.scene;
        if let Some(objects) = &scene.objects {
            scene.objects = Some(objects.at(self.frame)?);
            // Those of the last frame make room.
            (scene.surfels, scene.primitives) = (Surfels::none(), Primitives::default());
            *scene = flatten(scene, exec)?;
        }
        self.method.check_scene(scene)
    }

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
