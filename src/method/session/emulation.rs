//! Pictures as they become where passes leave their numbers in buffers of few digits.

use super::{Making, Session};
use crate::error::Result;
use crate::frame::{Frame, NamedPlane};
use crate::method::Job;
use crate::method::buffer_formats::{DepthKey, DepthRange, Formats};
use crate::method::stage::When;
use crate::method::{Method, Picture};
use crate::scene::Camera;

impl Session<'_> {
    /// The picture by the definition in `f32`, as it becomes where passes leave their numbers in buffers of
    /// these formats, see [`mod@crate::method::buffer_formats`]; with `stages`, the planes of every stage, too. What a
    /// method carries to the next frame is what this frame saw in `f32`.
    ///
    /// # Errors
    /// As [`Session::define`].
    pub fn emulate(
        &mut self,
        camera: &Camera,
        formats: Formats,
        stages: bool,
    ) -> Result<Picture<f32>> {
        let picture = if self.stores_itself() {
            self.defined(&self.storing(camera, formats)?.0, stages)?
        } else {
            let mut picture = self.define(camera, stages)?;
            self.store_stages(camera, formats, stages, &mut picture.frame)?;
            picture
        };
        self.index.seen.clone_from(&picture.seen);
        Ok(picture)
    }

    /// The planes of [`Session::emulate`] without those of the stages. Nothing is carried to the next frame, and
    /// the picture in `f32` is not drawn for what else it tells.
    ///
    /// # Errors
    /// As [`Session::define`].
    pub fn emulate_planes(&self, camera: &Camera, formats: Formats) -> Result<Frame<f32>> {
        if self.stores_itself() {
            return Ok(self.defined(&self.storing(camera, formats)?.0, false)?.frame);
        }
        let mut frame = Frame::new(camera.width, camera.height);
        self.store_stages(camera, formats, false, &mut frame)?;
        Ok(frame)
    }

    /// Whether a single stage draws all layers, and rounds each of them itself.
    fn stores_itself(&self) -> bool {
        matches!(self.method, Method::Peeling(_))
    }

    /// The picture whose sums and depth tests are those of buffers, and between which depths these tell apart.
    pub(crate) fn storing<'j>(
        &'j self,
        camera: &'j Camera,
        formats: Formats,
    ) -> Result<(Job<'j>, DepthRange)> {
        let range = DepthRange::new(self.scene, camera);
        let key = DepthKey::new(formats.depth, range);
        Ok((Job { buffers: formats.buffers, key, ..self.job(camera)? }, range))
    }

    /// Runs stage after stage, and puts what each leaves in the frame, rounded, before the next one reads it.
    fn store_stages(
        &self,
        camera: &Camera,
        formats: Formats,
        stages: bool,
        frame: &mut Frame<f32>,
    ) -> Result<()> {
        let (job, range) = self.storing(camera, formats)?;
        self.ask(camera, Making::Define { number: 4, stages: true })?;
        for stage in self.method.stages().iter().filter(|stage| !stage.leaves.is_empty()) {
            let levels = self.method.levels(&job, stage.name);
            let parts =
                if levels.is_empty() { vec![None] } else { levels.into_iter().map(Some).collect() };
            for level in parts {
                let mut left = self.run(&Job { level, ..job }, stage.name, frame)?;
                formats.store(stage, &mut left, &range);
                frame.put(left);
            }
        }
        if !stages {
            frame.planes.retain(|plane| self.is_shown(plane));
        }
        Ok(())
    }

    /// Whether a plane is one of a picture without the planes of the stages.
    pub(crate) fn is_shown(&self, plane: &NamedPlane<f32>) -> bool {
        let rows = self.method.stages().iter().flat_map(|stage| stage.leaves);
        let row = rows.into_iter().find(|row| row.is_called(&plane.name));
        row.is_none_or(|row| matches!(row.when, When::Always | When::Lit | When::Tubes))
    }
}
