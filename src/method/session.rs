//! A scene that is drawn by one method from as many cameras as one likes.

mod emulation;
mod names;
mod needs;

pub(crate) use names::Names;
pub use needs::Making;

use super::algorithm::Job;
use super::table::Memory;
use super::{Method, Picture};
use crate::error::Result;
use crate::frame::{Exec, Frame, Pool};
use crate::index::Index;
use crate::index::grouping::{Extended, Grouping, GroupingReport};
use crate::index::members::Members;
use crate::index::order::BackToFront;
use crate::index::seen::Seen;
use crate::number::Exact;
use crate::progress::Progress;
use crate::scene::{Boxes, Camera, Groups, Scene};

/// A scene, a method, what the method prepared of the scene, and memory that is used again.
///
/// ```
/// use splatref::frame::Exec;
/// use splatref::method::{Method, Session};
/// use splatref::scene::{Camera, Scene};
/// use splatref::source::Shape;
///
/// let shape = Shape::Sphere;
/// let scene = Scene::lit("sphere", shape.surfels(2_000, 0)?);
/// let exec = Exec::sequential();
/// let mut session = Session::new(&scene, Method::by_name("pyramid")?, &exec)?;
/// for side in [32, 64] {
///     let camera = Camera::new(side, side, shape.default_pose(), shape.default_lens())?;
///     let picture = session.render(&camera)?;
///     assert_eq!(picture.frame.width, side);
/// }
/// # Ok::<(), splatref::Error>(())
/// ```
#[derive(Debug)]
pub struct Session<'a> {
    scene: &'a Scene,
    method: Method,
    exec: &'a Exec,
    index: Index,
    memory: Memory,
    pool: Pool,
    /// What [`Session::render`] has drawn last.
    picture: Option<Picture<f32>>,
}

/// How the groups of a scene were made.
pub type Made = (GroupingReport, Option<Extended>);

impl<'a> Session<'a> {
    /// Prepares a scene for a method: with the groups that the scene brought along, else with
    /// groups made as [`Method::grouping`] says.
    ///
    /// # Errors
    /// As [`Session::with_groups`] and [`Grouping::groups`].
    pub fn new(scene: &'a Scene, method: Method, exec: &'a Exec) -> Result<Self> {
        Ok(Self::prepare(scene, method, None, exec, &|_, _, _| ())?.0)
    }

    /// As [`Session::new`], with a grouping of one's own in place of the scene's groups and of the
    /// method's; tells how the groups were made, if they were.
    ///
    /// `progress` is told the name of a step, how much of it is done, and of how much.
    ///
    /// # Errors
    /// As [`Session::new`].
    pub fn prepare(
        scene: &'a Scene,
        method: Method,
        grouping: Option<Grouping>,
        exec: &'a Exec,
        progress: Progress<'_>,
    ) -> Result<(Self, Option<Made>)> {
        method.check()?;
        method.check_scene(scene)?;
        let Some(default) = method.grouping() else {
            return Ok((Self::with_groups(scene, method, None, exec)?, None));
        };
        if let (None, Some(groups)) = (grouping, scene.surfels.groups()) {
            return Ok((Self::with_groups(scene, method, Some(groups.clone()), exec)?, None));
        }
        let grouping = grouping.unwrap_or(default);
        let (groups, report, extended) = grouping.groups(&scene.surfels, exec, progress)?;
        let session = Self::with_groups(scene, method, Some(groups), exec)?;
        Ok((session, Some((report, extended))))
    }

    /// As [`Session::new`], with groups that somebody else has made.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the settings are out of range, if the method cannot draw the
    /// scene, or if the groups are missing or of another number of surfels.
    pub fn with_groups(
        scene: &'a Scene,
        method: Method,
        groups: Option<Groups>,
        exec: &'a Exec,
    ) -> Result<Self> {
        method.check()?;
        method.check_scene(scene)?;
        let groups = groups.filter(|_| method.grouping().is_some());
        let order = method.needs_order().then(|| BackToFront::new(&scene.surfels, exec));
        let alone = method.draws_objects() && scene.objects.is_none();
        let boxes = alone.then(|| Boxes::new(&scene.surfels));
        let mut index = Index { groups, order, boxes, ..Index::default() };
        index.check(&scene.surfels)?;
        if method.grouping().is_some() {
            index.groups()?;
        }
        if let (Some(groups), Some(order)) = (&index.groups, &index.order) {
            index.members = Some(Members::new(&scene.surfels, groups, order, exec)?);
        }
        let (memory, pool) = (method.memory(), Pool::default());
        Ok(Self { scene, method, exec, index, memory, pool, picture: None })
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// The method.
    #[must_use]
    pub fn method(&self) -> &Method {
        &self.method
    }

    /// The groups, if the method draws them.
    #[must_use]
    pub fn groups(&self) -> Option<&Groups> {
        self.index.groups.as_ref()
    }

    /// What the next frame is given of the last one: what [`Session::render`] saw, or what somebody
    /// resumed; none before the first frame, and of a method that carries nothing.
    #[must_use]
    pub fn seen(&self) -> Option<&Seen> {
        self.index.seen.as_ref()
    }

    /// Goes on from what a frame saw, as if this session had drawn it; from nothing if there is none.
    /// A method that carries nothing takes no notice.
    pub fn resume(&mut self, seen: Option<Seen>) {
        self.index.seen = seen;
    }

    /// The picture in `f32`, by the fast path where there is one, in the memory of the last one. The
    /// next picture is the next frame of a method that carries something from frame to frame; one that is
    /// defined is so too, but leaves what the session carries as it is.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the camera is out of range, or what the method asks of scene
    /// and settings together does not hold.
    pub fn render(&mut self, camera: &Camera) -> Result<&Picture<f32>> {
        camera.check()?;
        let last = self.picture.take();
        let size = |picture: &Picture<f32>| [picture.frame.width, picture.frame.height];
        // The memory of the last picture is there, if it was one of this size.
        if last.as_ref().map(size) != Some(camera.size()) {
            self.ask(camera, Making::Render)?;
        }
        if let Some(last) = last {
            self.pool.recycle(last.frame);
        }
        let Self { scene, exec, index, .. } = self;
        let job = Job::new(scene, index, camera, exec);
        let picture = self.method.draw(&job, &mut self.memory, &mut self.pool)?;
        self.pool.clear();
        self.index.seen.clone_from(&picture.seen);
        let mut picture = picture;
        if let Some(names) = self.names() {
            names.name(&mut picture.frame);
        }
        Ok(self.picture.insert(picture))
    }

    /// The picture by the definition, in any number; with `stages`, the planes of every stage,
    /// which [`Method::stages`] lists.
    ///
    /// # Errors
    /// As [`Session::render`].
    // Compiled here for what the crate has itself, and not again in every crate that draws by definitions.
    #[inline(never)]
    pub fn define<R: Exact>(&self, camera: &Camera, stages: bool) -> Result<Picture<R>> {
        self.defined(&self.job(camera)?, stages)
    }

    /// The picture of a job by the definition.
    fn defined<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
        self.ask(job.camera, Making::Define { number: size_of::<R>() as u64, stages })?;
        let mut picture = self.method.define(job, stages)?;
        if let Some(names) = self.names() {
            names.name(&mut picture.frame);
        }
        Ok(picture)
    }

    /// The ids of the surfels in planes of ids, where a method that draws surfels draws those of objects;
    /// none where it names them by their indices. Primitives are counted on after the surfels: a scene
    /// that has any keeps its indices.
    fn names(&self) -> Option<Names<'_>> {
        if self.method.draws_objects() { None } else { self.numbers() }
    }

    /// The ids of the surfels, which a verdict numbers by their order whatever the method.
    pub(crate) fn numbers(&self) -> Option<Names<'_>> {
        let objects = self.scene.objects.as_ref().filter(|_| self.scene.primitives.is_empty());
        objects.map(Names::new)
    }

    /// Runs one stage of the method on somebody's planes of the stages that it reads, and gives
    /// the planes that the stage leaves.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if a plane is missing, or of another type or size than the
    /// stage's; if there is no such stage; else as [`Session::render`].
    pub fn stage<R: Exact>(
        &self,
        camera: &Camera,
        stage: &str,
        from: &Frame<R>,
    ) -> Result<Frame<R>> {
        self.run(&self.job(camera)?, stage, from)
    }

    /// A stage of a job on somebody's planes.
    fn run<R: Exact>(&self, job: &Job<'_>, stage: &str, from: &Frame<R>) -> Result<Frame<R>> {
        let Some(names) = self.names() else { return self.method.stage(job, stage, from) };
        let mut numbered = from.clone();
        names.number(&mut numbered)?;
        let mut left = self.method.stage(job, stage, &numbered)?;
        names.name(&mut left);
        Ok(left)
    }

    /// Every decision at one pixel, in words.
    ///
    /// # Errors
    /// [`crate::Error::Usage`] if the pixel is outside the picture; else as [`Session::render`].
    pub fn explain<R: Exact>(&self, camera: &Camera, pixel: (u32, u32)) -> Result<String> {
        let job = self.job(camera)?;
        camera.check_pixel(pixel.0, pixel.1)?;
        self.method.explain::<R>(&job, pixel)
    }

    /// The surfels that weigh most at a pixel, by the ids of its planes, in `f64`, the heaviest first; none if the method does
    /// not say.
    ///
    /// # Errors
    /// As [`Session::explain`].
    pub fn weights(&self, camera: &Camera, pixel: (u32, u32)) -> Result<Vec<(u32, f64)>> {
        let job = self.job(camera)?;
        camera.check_pixel(pixel.0, pixel.1)?;
        let mut weights = self.method.weights(&job, pixel)?;
        let names = self.names();
        weights.iter_mut().for_each(|(surfel, _)| *surfel = named(names.as_ref(), *surfel));
        weights.sort_by(|a, b| b.1.total_cmp(&a.1));
        Ok(weights)
    }

    /// Runs a test of the job that a picture is.
    #[cfg(test)]
    pub(crate) fn with_job<T>(&self, camera: &Camera, test: impl FnOnce(&Job<'_>) -> T) -> T {
        test(&self.job(camera).expect("a camera that has been checked"))
    }

    pub(crate) fn job<'j>(&'j self, camera: &'j Camera) -> Result<Job<'j>> {
        camera.check()?;
        let Self { scene, index, exec, .. } = self;
        Ok(Job::new(scene, index, camera, exec))
    }
}

/// The id of a surfel that a verdict has numbered; what is the number of none stays, and so does that of
/// an id of 40 bits.
pub(crate) fn named(names: Option<&Names<'_>>, index: u32) -> u32 {
    names.and_then(|names| names.told(index)).unwrap_or(index)
}

#[cfg(test)]
pub(crate) mod tests;
