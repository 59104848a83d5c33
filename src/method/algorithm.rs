//! Implement a method: the interface of every row of the table of methods.

use super::buffer_formats::{Buffers, DepthKey};
use super::input_planes::InputPlanes;
use super::part::Part;
use super::projection::{Has, Joined};
use super::stage::{Conditions, Keep};
use super::{Picture, Stage};
use crate::error::Result;
use crate::frame::{Exec, Frame, Grid, NamedPlane, Pool, Rect};
use crate::index::Index;
use crate::index::grouping::Grouping;
use crate::number::Exact;
use crate::scene::{Camera, Scene};
use crate::setting::Fields;
use crate::splat::SplatSettings;
use std::fmt::{Debug, Display};

/// The inputs of one picture.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// The scene to draw.
    pub scene: &'a Scene,
    /// The index that was built once from the scene.
    pub index: &'a Index,
    /// The camera that sees the scene.
    pub camera: &'a Camera,
    /// Threads and tiles; these cannot change one bit.
    pub exec: &'a Exec,
    /// How the sums that fragments are blended into are stored.
    pub(crate) buffers: Buffers,
    /// The depth that is compared where the nearest fragment wins.
    pub(crate) key: DepthKey,
    /// The one level that a stage makes, from the list of [`Algorithm::levels`]; none: the stage
    /// makes all levels.
    pub(crate) level: Option<usize>,
    /// The part of the picture that is drawn. Pixels are counted in the picture, so that rounding
    /// is the picture's; planes have the size of the window.
    pub(crate) window: Rect,
    /// The only part of the picture that a verdict judges; none: all of it.
    pub(crate) part: Option<Part<'a>>,
    /// What is known of the scene, if the stages after the projection go on from joined planes. Ids
    /// are then those of the planes.
    pub(crate) joined: Option<&'a Joined>,
}

impl<'a> Job<'a> {
    /// A picture whose sums are stored as they are.
    #[must_use]
    pub fn new(scene: &'a Scene, index: &'a Index, camera: &'a Camera, exec: &'a Exec) -> Self {
        let (buffers, key) = (Buffers::F32, DepthKey::WHOLE);
        let window = Rect::of_size(camera.size());
        let (level, part, joined) = (None, None, None);
        Self { scene, index, camera, exec, buffers, key, level, window, part, joined }
    }

    /// Which attributes the scene has.
    pub(crate) fn has(&self) -> Has {
        self.joined.map_or_else(|| Has::in_scene(self.scene), |joined| joined.has)
    }

    /// The levels that this job makes, from all `levels` of a stage.
    pub(crate) fn only(&self, levels: Vec<usize>) -> Vec<usize> {
        self.level.map_or(levels, |level| vec![level])
    }

    /// Whether only a part of the picture is drawn.
    pub(crate) fn is_part(&self) -> bool {
        self.window != self.picture()
    }

    /// Drops the items that do not touch the window, so that memory grows with the window.
    pub(crate) fn keep_touching<T>(&self, items: &mut Vec<T>, bounds: impl Fn(&T) -> Rect) {
        if self.is_part() {
            items.retain(|item| !bounds(item).intersection(&self.window).is_empty());
            items.shrink_to_fit();
        }
    }

    /// Width and height of the planes.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.window.size()
    }

    /// The tiles of the window.
    pub(crate) fn grid(&self) -> Grid {
        self.exec.grid_of(self.window)
    }

    /// The tiles of the fast paths.
    pub(crate) fn strips(&self) -> Grid {
        self.grid().strips()
    }

    /// All pixels of the picture.
    pub(crate) fn picture(&self) -> Rect {
        Rect::of_size(self.camera.size())
    }

    /// The conditions that decide which planes a frame of the scene has.
    pub(crate) fn there(&self, keep: Keep) -> Conditions {
        let there = Conditions::new(self.scene, keep);
        self.joined.map_or(there, |joined| there.with_attributes(joined.has))
    }

    /// Planes of the window as a frame.
    pub(crate) fn frame<R>(&self, planes: Vec<NamedPlane<R>>) -> Frame<R> {
        let [width, height] = self.size();
        Frame { width, height, planes }
    }
}

/// A method, implemented by its settings. Everything in the settings may change the picture, and
/// [`Fields`] lists all of them.
///
/// [`super::Session`] checks the settings, and that the method draws the scene, before it asks for
/// a picture.
pub trait Algorithm: Fields + Debug + Default + PartialEq + Send + Sync + 'static {
    /// The name in scene files and on the command line.
    const NAME: &'static str;
    /// A one-line summary of the method, with its source.
    const SUMMARY: &'static str;
    /// The passes, in the order in which they run.
    const STAGES: &'static [Stage];
    /// Whether the method draws triangles, ribbons and tubes beside surfels.
    const DRAWS_PRIMITIVES: bool = false;
    /// Whether the method draws triangles beside surfels, but no other primitives.
    const DRAWS_POLYGONS: bool = false;
    /// Whether the method draws the objects of a scene as they are; else the scene must be made
    /// flat.
    const DRAWS_OBJECTS: bool = false;
    /// Whether the method draws a scene of 3D Gaussians.
    const DRAWS_GAUSSIANS: bool = false;
    /// How the method groups surfels by default; none: the method draws no groups.
    const GROUPING: Option<Grouping> = None;
    /// Whether the method blends layers of surfels with opacities; else a surfel is opaque.
    const BLENDS: bool = false;
    /// Whether the method needs the surfels from back to front.
    const BACK_TO_FRONT: bool = false;

    /// Why the method cannot draw a part of a picture alone; none: each pixel depends on nothing but
    /// its own fragments.
    const NEEDS_WHOLE_PICTURE: Option<&'static str> = None;
    /// Whether a method that needs the whole picture can draw the [projection](super::projection) of a
    /// part alone. A job of a part then leaves the planes of the projection, and
    /// [`Algorithm::finish`] goes on from those of the whole picture.
    const PROJECTS_REGIONS: bool = false;

    /// An upper estimate of the bytes that the fast path takes for a pixel, the picture included;
    /// none: there is no fast path.
    const FAST_BYTES_A_PIXEL: Option<u64> = None;

    /// The memory that the fast path works in, kept from picture to picture.
    type Memory: Debug + Default + Send;

    /// Footprints, epsilon and culling, if the method draws splats.
    fn splats(&self) -> Option<&SplatSettings> {
        None
    }

    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if a number is not.
    fn check(&self) -> Result<()>;

    /// Renders by the definition, in any number; with `stages` the planes of every stage are kept.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the method cannot draw the scene with these settings.
    fn define<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>>;

    /// Renders in `f32`, by the fast path where there is one, with the bits of the definition.
    ///
    /// # Errors
    /// As [`Algorithm::define`].
    fn draw(
        &self,
        job: &Job<'_>,
        memory: &mut Self::Memory,
        pool: &mut Pool,
    ) -> Result<Picture<f32>> {
        let _ = (memory, pool);
        self.define(job, false)
    }

    /// Runs one stage on the planes of the stages that it reads, whoever made these planes. Returns
    /// the planes that the stage leaves.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if a plane is missing or has another type or size, or if no stage
    /// of this name can run on its own.
    fn stage<R: Exact>(
        &self,
        job: &Job<'_>,
        stage: &str,
        given: &InputPlanes<'_, R>,
    ) -> Result<Vec<NamedPlane<R>>>;

    /// Runs the stages after the projection on the planes of the projection, joined from regions.
    ///
    /// # Errors
    /// As [`Algorithm::stage`]; [`crate::Error::Invalid`] unless the method projects regions.
    fn finish(
        &self,
        job: &Job<'_>,
        given: &InputPlanes<'_, f32>,
        stages: bool,
    ) -> Result<Picture<f32>> {
        let _ = (job, given, stages);
        Err(super::stage::unknown("projection"))
    }

    /// The levels that a stage makes, each from the one before, in the order in which they are
    /// made; empty if the stage does not work level by level.
    fn levels(&self, job: &Job<'_>, stage: &str) -> Vec<usize> {
        let _ = (job, stage);
        Vec::new()
    }

    /// Explains every decision at one pixel, with its operands, in words.
    ///
    /// # Errors
    /// [`crate::Error::Usage`] if the pixel is outside the picture; else as [`Algorithm::define`].
    fn explain<R: Exact>(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<impl Display>;

    /// The surfels in the sums at a pixel, each with its weight, in `f64`.
    ///
    /// # Errors
    /// As [`Algorithm::explain`].
    fn weights(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<Vec<(u32, f64)>> {
        let _ = (job, pixel);
        Ok(Vec::new())
    }

    /// What the settings resolve to in a scene: names and values as TOML, for the text of a
    /// picture.
    fn settings_in_scene(&self, scene: &Scene, camera: &Camera) -> Vec<(&'static str, String)> {
        let _ = camera;
        self.splats().map_or_else(Vec::new, |splats| splats.settings_in_scene(scene))
    }
}
