//! Emulate buffer formats of few digits: the picture as it becomes where passes store their numbers
//! in them.

use super::{Making, Session};
use crate::error::Result;
use crate::frame::{Frame, NamedPlane};
use crate::method::Job;
use crate::method::buffer_formats::{DepthKey, DepthRange, Formats};
use crate::method::stage::{Stage, When};
use crate::method::{Method, Picture};
use crate::number::Exact;
use crate::scene::Camera;

impl Session<'_> {
    /// Renders the picture by the definition in `f32`, as it becomes where passes store their
    /// numbers in buffers of these formats, see [`mod@crate::method::buffer_formats`]; with
    /// `stages`, also the planes of every stage. A method with temporal state carries to the next
    /// frame what this frame saw in `f32`.
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

    /// The planes of [`Session::emulate`] without the planes of the stages. Nothing is carried to
    /// the next frame. The picture in `f32` is not drawn, because only its planes are wanted.
    ///
    /// # Errors
    /// As [`Session::define`].
    pub fn emulate_planes(&self, camera: &Camera, formats: Formats) -> Result<Frame<f32>> {
        if self.stores_itself() {
            return Ok(self.defined(&self.storing(camera, formats)?.0, false)?.frame);
        }
        let [width, height] = self.window(camera)?.size();
        let mut frame = Frame::new(width, height);
        self.store_stages(camera, formats, false, &mut frame)?;
        Ok(frame)
    }

    /// Whether one stage of the method draws all layers, and rounds each of them itself.
    fn stores_itself(&self) -> bool {
        matches!(self.method, Method::Peeling(_))
    }

    /// The job whose sums and depth tests are rounded as in the buffers, and the range of depths
    /// that the depth buffer covers.
    pub(crate) fn storing<'j>(
        &'j self,
        camera: &'j Camera,
        formats: Formats,
    ) -> Result<(Job<'j>, DepthRange)> {
        let range = DepthRange::new(self.scene, camera);
        let key = DepthKey::new(formats.depth, range);
        Ok((Job { buffers: formats.buffers, key, ..self.job(camera)? }, range))
    }

    /// Runs stage after stage, and puts the planes of each into the frame, rounded, before the next
    /// stage reads them.
    fn store_stages(
        &self,
        camera: &Camera,
        formats: Formats,
        stages: bool,
        frame: &mut Frame<f32>,
    ) -> Result<()> {
        let (job, range) = self.storing(camera, formats)?;
        self.run_all(&job, frame, |stage, left| formats.store(stage, left, &range))?;
        if !stages {
            frame.planes.retain(|plane| self.is_shown(plane));
        }
        Ok(())
    }

    /// Runs stage after stage in any number, each on the planes that the stages before have left,
    /// and returns the planes of all stages. `store` may change the planes that a stage leaves
    /// before the next stage reads them, as storing them in a buffer does. A pyramid is stored level
    /// after level.
    ///
    /// # Errors
    /// As [`Session::define`].
    pub fn run_stages<R: Exact>(
        &self,
        camera: &Camera,
        mut store: impl FnMut(&Stage, &mut Frame<R>),
    ) -> Result<Frame<R>> {
        let job = self.job(camera)?;
        let mut frame = job.frame(Vec::new());
        self.run_all(&job, &mut frame, |stage, left| store(stage, left))?;
        Ok(frame)
    }

    /// Runs the stages of a job, and puts the planes of each into the frame.
    fn run_all<R: Exact>(
        &self,
        job: &Job<'_>,
        frame: &mut Frame<R>,
        mut store: impl FnMut(&Stage, &mut Frame<R>),
    ) -> Result<()> {
        self.ask(job, Making::Define { number: size_of::<R>() as u64, stages: true })?;
        for stage in self.method.stages().iter().filter(|stage| !stage.leaves.is_empty()) {
            let levels = self.method.levels(job, stage.name);
            let parts =
                // A level reads the level before it as it is stored.
                if levels.is_empty() { vec![None] } else { levels.into_iter().map(Some).collect() };
            for level in parts {
                let mut left = self.run(&Job { level, ..*job }, stage.name, frame)?;
                store(stage, &mut left);
                frame.put(left);
            }
        }
        Ok(())
    }

    /// Whether a plane belongs to a picture without the planes of the stages.
    pub(crate) fn is_shown(&self, plane: &NamedPlane<f32>) -> bool {
        let rows = self.method.stages().iter().flat_map(|stage| stage.leaves);
        let row = rows.into_iter().find(|row| row.is_called(&plane.name));
        row.is_none_or(|row| matches!(row.when, When::Always | When::Lit | When::Tubes))
    }
}
