//! Draw one scene by one method, from as many cameras as you like.

mod emulation;
mod joined;
mod names;
mod needs;

pub(crate) use names::Names;
pub use needs::Making;

use super::algorithm::Job;
use super::projection::Joined;
use super::table::Memory;
use super::{Method, Picture};
use crate::error::Result;
use crate::frame::{Exec, Frame, Pool, Rect};
use crate::index::Index;
use crate::index::grouping::{Extended, Grouping, GroupingReport};
use crate::index::members::Members;
use crate::index::order::BackToFront;
use crate::index::seen::Seen;
use crate::number::Exact;
use crate::progress::Progress;
use crate::scene::{Boxes, Camera, Groups, Scene};

/// A scene, a method, the index that the method prepared of the scene, and memory that every
/// picture uses again.
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
    /// The part of the picture that is drawn; none: all of it.
    region: Option<Rect>,
    /// What is known of a scene that is not at hand, see [`Session::finish`].
    joined: Option<Joined>,
    /// The last picture of [`Session::render`].
    picture: Option<Picture<f32>>,
}

/// How the groups of a scene were made.
pub type Made = (GroupingReport, Option<Extended>);

impl<'a> Session<'a> {
    /// Prepares a scene for a method, with the groups that the scene brought along. If it brought
    /// none, makes groups as [`Method::grouping`] says.
    ///
    /// # Errors
    /// As [`Session::with_groups`] and [`Grouping::groups`].
    pub fn new(scene: &'a Scene, method: Method, exec: &'a Exec) -> Result<Self> {
        Ok(Self::prepare(scene, method, None, exec, &|_, _, _| ())?.0)
    }

    /// As [`Session::new`], with your own grouping in place of the scene's groups and the method's
    /// grouping. Returns how the groups were made, if they were made.
    ///
    /// `progress` is called with the name of a step, how much of it is done, and the total.
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
        // The scene brought groups along, and the caller asked for no others.
        if let (None, Some(groups)) = (grouping, scene.surfels.groups()) {
            return Ok((Self::with_groups(scene, method, Some(groups.clone()), exec)?, None));
        }
        let grouping = grouping.unwrap_or(default);
        let (groups, report, extended) = grouping.groups(&scene.surfels, exec, progress)?;
        let session = Self::with_groups(scene, method, Some(groups), exec)?;
        Ok((session, Some((report, extended))))
    }

    /// As [`Session::new`], with groups that you have made.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the settings are out of range, if the method cannot draw the
    /// scene, or if the groups are missing or are for another number of surfels.
    pub fn with_groups(
        scene: &'a Scene,
        method: Method,
        groups: Option<Groups>,
        exec: &'a Exec,
    ) -> Result<Self> {
        method.check()?;
        method.check_scene(scene)?;
        // A method without groups must not see any.
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
        let (region, joined, picture) = (None, None, None);
        Ok(Self { scene, method, exec, index, memory, pool, region, joined, picture })
    }

    /// The same method, groups and state with another scene of as many surfels.
    pub(crate) fn beside<'s>(&'s self, scene: &'s Scene) -> Result<Session<'s>> {
        let groups = self.index.groups.clone();
        let mut session = Session::with_groups(scene, self.method, groups, self.exec)?;
        session.index.seen.clone_from(&self.index.seen);
        session.region = self.region;
        Ok(session)
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

    /// What the next frame receives from the last one: what [`Session::render`] or
    /// [`Session::emulate`] saw, or what [`Session::resume`] put in its place. It is none before the first frame, and for a method
    /// without temporal state.
    #[must_use]
    pub fn seen(&self) -> Option<&Seen> {
        self.index.seen.as_ref()
    }

    /// Resumes from what a frame saw, as if this session had drawn that frame; from nothing if
    /// `seen` is none. A method without temporal state ignores it.
    pub fn resume(&mut self, seen: Option<Seen>) {
        self.index.seen = seen;
    }

    /// Draws only these pixels of every following picture, the ends excluded, until you set another
    /// region; with none, the whole picture. Planes have the size of the region, and every bit is that
    /// of the whole picture. Memory for pixels grows with the region, but every surfel is projected.
    ///
    /// The methods `pyramid` and `template` draw the [projection](super::projection) of a region alone,
    /// because their later stages need the whole picture: [`Session::render`] and [`Session::define`]
    /// leave its planes and no others, with or without stages. Join them, and call [`Session::finish`].
    /// Every other call refuses such a region.
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
    /// let mut session = Session::new(&scene, Method::by_name("ewa")?, &exec)?;
    /// let whole = session.render(&camera)?.frame.clone();
    ///
    /// session.set_region(Some(Rect { x0: 20, y0: 8, x1: 50, y1: 40 }))?;
    /// let part = &session.render(&camera)?.frame;
    /// assert_eq!((part.width, part.height), (30, 32));
    /// assert_eq!(part.scalar("Z")?.at(3, 5), whole.scalar("Z")?.at(20 + 3, 8 + 5));
    /// # Ok::<(), splatref::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`Method::check_region`]. The call that draws a picture checks the region as
    /// [`Camera::check_region`].
    pub fn set_region(&mut self, region: Option<Rect>) -> Result<()> {
        if region.is_some() {
            self.method.check_region()?;
        }
        self.region = region;
        Ok(())
    }

    /// The pixels that are drawn of a camera's picture.
    ///
    /// # Errors
    /// As [`Camera::check_region`], for the region that was set.
    pub fn window(&self, camera: &Camera) -> Result<Rect> {
        let Some(region) = self.region else { return Ok(Rect::of_size(camera.size())) };
        camera.check_region(&region)?;
        Ok(region)
    }

    /// Renders the picture in `f32`, by the fast path where there is one, in the memory of the last
    /// picture. Each call renders the next frame of a method with temporal state.
    /// [`Session::define`] renders that next frame too, but does not advance the state.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the camera is out of range, if the scene has a surface of another
    /// size than the picture, or if scene and settings together break a condition of the method.
    pub fn render(&mut self, camera: &Camera) -> Result<&Picture<f32>> {
        self.check_camera(camera)?;
        let last = self.picture.take();
        let size = |picture: &Picture<f32>| [picture.frame.width, picture.frame.height];
        // A last picture of this size has already got the memory.
        let window = self.window(camera)?;
        if last.as_ref().map(size) != Some(window.size()) {
            self.ask(&self.drawn_job(camera)?, Making::Render)?;
        }
        if let Some(last) = last {
            self.pool.recycle(last.frame);
        }
        let Self { scene, exec, index, .. } = self;
        let job = Job { window, ..Job::new(scene, index, camera, exec) };
        let picture = self.method.draw(&job, &mut self.memory, &mut self.pool)?;
        self.pool.clear();
        self.index.seen.clone_from(&picture.seen);
        let mut picture = picture;
        if let Some(names) = self.names() {
            names.name(&mut picture.frame);
        }
        Ok(self.picture.insert(picture))
    }

    /// Takes the last picture of [`Session::render`] out, if there is one. The next picture then
    /// needs new memory.
    pub fn take_picture(&mut self) -> Option<Picture<f32>> {
        self.picture.take()
    }

    /// Renders the picture by the definition, in any number; with `stages`, also the planes of
    /// every stage, which [`Method::stages`] lists.
    ///
    /// A definition leaves the session as it was: the next call renders the same frame again. Its
    /// [`Picture::seen`] is what this frame saw in the number `R`; hand it to [`Session::resume`] to
    /// go on to the next frame.
    ///
    /// # Errors
    /// As [`Session::render`].
    // Compiled once, in this crate, and not again in every crate that draws by definitions.
    #[inline(never)]
    pub fn define<R: Exact>(&self, camera: &Camera, stages: bool) -> Result<Picture<R>> {
        self.defined(&self.drawn_job(camera)?, stages)
    }

    /// As [`Session::define`], for the whole picture, whatever region was set.
    pub(crate) fn define_whole<R: Exact>(
        &self,
        camera: &Camera,
        stages: bool,
    ) -> Result<Picture<R>> {
        self.defined(&self.whole_job(camera)?, stages)
    }

    /// Draws the whole picture, whatever region was set, by the fast path where there is one. Leaves the
    /// session as it was.
    pub(crate) fn draw_whole(&self, camera: &Camera) -> Result<Picture<f32>> {
        let job = self.whole_job(camera)?;
        self.ask(&job, Making::Render)?;
        self.method.draw(&job, &mut self.method.memory(), &mut Pool::default())
    }

    /// Renders a job by the definition.
    fn defined<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
        self.ask(job, Making::Define { number: size_of::<R>() as u64, stages })?;
        let mut picture = self.method.define(job, stages)?;
        if let Some(names) = self.names() {
            names.name(&mut picture.frame);
        }
        Ok(picture)
    }

    /// The ids of the surfels for planes of ids, if a method that draws surfels draws a scene of
    /// objects; none if the planes hold the indices of the surfels. Primitives are numbered after
    /// the surfels, so a scene that has any keeps its indices.
    fn names(&self) -> Option<Names<'_>> {
        if self.method.draws_objects() { None } else { self.numbers() }
    }

    /// The ids of the surfels, which a verdict numbers by their order, whichever the method.
    pub(crate) fn numbers(&self) -> Option<Names<'_>> {
        if let Some(excerpt) = &self.scene.excerpt {
            return Some(Names::Excerpt(excerpt));
        }
        let objects = self.scene.objects.as_ref().filter(|_| self.scene.primitives.is_empty());
        objects.map(Names::new)
    }

    /// Runs one stage of the method on a client's planes of the stages that it reads, and returns
    /// the planes that the stage leaves.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if a plane is missing, or has another type or size than the
    /// stage's, or if there is no such stage; else as [`Session::render`].
    pub fn stage<R: Exact>(
        &self,
        camera: &Camera,
        stage: &str,
        from: &Frame<R>,
    ) -> Result<Frame<R>> {
        self.run(&self.job(camera)?, stage, from)
    }

    /// Runs a stage of a job on a client's planes.
    fn run<R: Exact>(&self, job: &Job<'_>, stage: &str, from: &Frame<R>) -> Result<Frame<R>> {
        let Some(names) = self.names() else { return self.method.stage(job, stage, from) };
        let mut numbered = from.clone();
        names.number(&mut numbered)?;
        let mut left = self.method.stage(job, stage, &numbered)?;
        names.name(&mut left);
        Ok(left)
    }

    /// Explains every decision at one pixel, in words.
    ///
    /// # Errors
    /// [`crate::Error::Usage`] if the pixel is outside the picture; else as [`Session::render`].
    pub fn explain<R: Exact>(&self, camera: &Camera, pixel: (u32, u32)) -> Result<String> {
        let job = self.whole_job(camera)?;
        camera.check_pixel(pixel.0, pixel.1)?;
        self.method.explain::<R>(&job, pixel)
    }

    /// The surfels that weigh most at a pixel, by the ids of its planes, in `f64`, the heaviest
    /// first. The list is empty if the method does not report weights.
    ///
    /// # Errors
    /// As [`Session::explain`].
    pub fn weights(&self, camera: &Camera, pixel: (u32, u32)) -> Result<Vec<(u32, f64)>> {
        let job = self.whole_job(camera)?;
        camera.check_pixel(pixel.0, pixel.1)?;
        let mut weights = self.method.weights(&job, pixel)?;
        let names = self.names();
        weights.iter_mut().for_each(|(surfel, _)| *surfel = named(names.as_ref(), *surfel));
        weights.sort_by(|a, b| b.1.total_cmp(&a.1));
        Ok(weights)
    }

    /// Runs a test on the job of a picture.
    #[cfg(test)]
    pub(crate) fn with_job<T>(&self, camera: &Camera, test: impl FnOnce(&Job<'_>) -> T) -> T {
        test(&self.job(camera).expect("a camera that has been checked"))
    }

    /// Checks that the camera is in range, and that the scene's surface has the size of its picture.
    fn check_camera(&self, camera: &Camera) -> Result<()> {
        camera.check()?;
        self.scene.surface.as_ref().map_or(Ok(()), |surface| surface.check_size(camera.size()))
    }

    /// The job of the whole picture, whatever region was set.
    pub(crate) fn whole_job<'j>(&'j self, camera: &'j Camera) -> Result<Job<'j>> {
        self.check_camera(camera)?;
        let Self { scene, index, exec, .. } = self;
        Ok(Job::new(scene, index, camera, exec))
    }

    /// The job of the region that was set, for everything but drawing.
    pub(crate) fn job<'j>(&'j self, camera: &'j Camera) -> Result<Job<'j>> {
        self.check_finished(camera)?;
        self.drawn_job(camera)
    }

    /// The job of the region that was set.
    fn drawn_job<'j>(&'j self, camera: &'j Camera) -> Result<Job<'j>> {
        Ok(Job { window: self.window(camera)?, ..self.whole_job(camera)? })
    }
}

/// The id of a surfel that a verdict has numbered. A number that belongs to no surfel stays, and so
/// does the number of a surfel whose id has 40 bits.
pub(crate) fn named(names: Option<&Names<'_>>, index: u32) -> u32 {
    names.and_then(|names| names.told(index)).unwrap_or(index)
}

#[cfg(test)]
pub(crate) mod tests;
