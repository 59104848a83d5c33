//! Go on from the projection of regions that were joined.

use super::{Making, Session};
use crate::error::{Error, Result};
use crate::frame::{Frame, Rect};
use crate::method::projection::{Has, Joined};
use crate::method::{Job, Picture};
use crate::scene::Camera;

impl Session<'_> {
    /// Runs the stages after the projection, and returns the picture. `projection` has the planes of the
    /// projection of the whole picture: joined from the regions that [`Session::set_region`] leaves for
    /// the methods `pyramid` and `template`. Every bit is that of [`Session::define`] in `f32`. Nothing
    /// is projected, so the tally is empty.
    ///
    /// ```
    /// use splatref::frame::{Exec, Rect};
    /// use splatref::method::{Method, Session};
    /// use splatref::scene::{Camera, Scene};
    /// use splatref::source::Shape;
    ///
    /// let shape = Shape::Torus;
    /// let scene = Scene::lit("torus", shape.surfels(2_000, 0)?);
    /// let exec = Exec::sequential();
    /// let camera = Camera::new(64, 48, shape.default_pose(), shape.default_lens())?;
    /// let mut session = Session::new(&scene, Method::by_name("pyramid")?, &exec)?;
    /// let whole = session.define::<f32>(&camera, true)?.frame;
    ///
    /// session.set_region(Some(Rect { x0: 20, y0: 8, x1: 50, y1: 40 }))?;
    /// let part = &session.render(&camera)?.frame;
    /// let depths = [part, &whole].map(|frame| frame.scalar("projection.Z"));
    /// assert_eq!(depths[0].as_ref().unwrap().at(3, 5), depths[1].as_ref().unwrap().at(20 + 3, 8 + 5));
    ///
    /// // The planes of all regions together are those of the whole projection.
    /// assert_eq!(session.finish(&camera, &whole, true)?.frame, whole);
    /// # Ok::<(), splatref::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Invalid`] if the method does not [project
    /// regions](crate::method::Method::projects_regions), or if a plane is missing or has another type
    /// or size; else as [`Session::define`].
    pub fn finish(
        &self,
        camera: &Camera,
        projection: &Frame<f32>,
        stages: bool,
    ) -> Result<Picture<f32>> {
        let here = Joined { has: Has::in_scene(self.scene), behind: None };
        let joined = self.joined.as_ref().unwrap_or(&here);
        let job = Job { joined: Some(joined), ..self.whole_job(camera)? };
        self.ask(&job, Making::Define { number: 4, stages })?;
        self.method.finish(&job, projection, stages)
    }

    /// A session that knows of its scene what is in `joined`, the lights and the material.
    pub(crate) fn with_joined(self, joined: Joined) -> Self {
        Self { joined: Some(joined), ..self }
    }

    /// Whether the region that was set leaves the planes of the projection alone.
    #[must_use]
    pub fn projects(&self, camera: &Camera) -> bool {
        let is_part = self.region.is_some_and(|region| region != Rect::of_size(camera.size()));
        is_part && self.method.projects_regions()
    }

    /// Checks that the pixels of the region are drawn, not their projection alone.
    pub(super) fn check_finished(&self, camera: &Camera) -> Result<()> {
        if !self.projects(camera) {
            return Ok(());
        }
        let name = self.method.name();
        let what = format!(
            "the method {name} draws of a region the projection alone, in f32; for anything else, draw \
             the whole picture"
        );
        Err(Error::Usage(what))
    }
}
