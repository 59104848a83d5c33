//! The one place where benches draw whole pictures: a scene, a method and what is kept between
//! pictures.

use splatref::Result;
use splatref::frame::Exec;
use splatref::io::{exr, provenance};
use splatref::method::{Method, Picture, Preparation, render_f32};
use splatref::scene::{Camera, Groups, Scene};
use std::path::Path;

/// A scene before a method, and the memory of the picture before.
pub(crate) struct Renderer<'a> {
    scene: &'a Scene,
    method: &'a Method,
    exec: &'a Exec,
    preparation: Preparation,
    earlier: Option<Picture<f32>>,
}

impl<'a> Renderer<'a> {
    /// Prepares what the method needs before any view.
    pub(crate) fn new(
        scene: &'a Scene,
        groups: Option<Groups>,
        method: &'a Method,
        exec: &'a Exec,
    ) -> Self {
        let preparation = Preparation::new(&scene.surfels, groups, method, exec);
        Self { scene, method, exec, preparation, earlier: None }
    }

    /// Draws a picture into the memory of the one before.
    pub(crate) fn draw(&mut self, camera: &Camera) -> Result<&Picture<f32>> {
        let Self { scene, method, exec, preparation, earlier } = self;
        let picture = render_f32(scene, preparation, camera, method, exec, earlier.take())?;
        Ok(self.earlier.insert(picture))
    }

    /// How many groups the method draws, if it draws groups.
    pub(crate) fn groups(&self) -> Option<usize> {
        self.preparation.groups().map(Groups::len)
    }

    /// Writes the last picture as an EXR.
    pub(crate) fn keep(&self, camera: &Camera, path: &Path) -> Result<()> {
        let Some(picture) = &self.earlier else { return Ok(()) };
        let Self { scene, method, preparation, .. } = self;
        let text = provenance::text(scene, preparation, camera, method, Default::default());
        exr::write(path, &picture.frame, &text)
    }
}
