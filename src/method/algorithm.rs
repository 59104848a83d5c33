//! What a method is: the interface that a row of the table of methods implements.

use super::buffer_formats::{Buffers, DepthKey};
use super::input_planes::InputPlanes;
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

/// What a picture is made of, and how.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// What is given.
    pub scene: &'a Scene,
    /// What was built once from the scene.
    pub index: &'a Index,
    /// Where the scene is seen from.
    pub camera: &'a Camera,
    /// Threads and tiles; these cannot change one bit.
    pub exec: &'a Exec,
    /// How the sums that fragments are blended into are stored.
    pub(crate) buffers: Buffers,
    /// What is compared where the nearest fragment wins.
    pub(crate) key: DepthKey,
    /// The one level that a stage makes, of those of [`Algorithm::levels`]; all of them if none.
    pub(crate) level: Option<usize>,
}

impl<'a> Job<'a> {
    /// A picture whose sums are stored as they are.
    #[must_use]
    pub fn new(scene: &'a Scene, index: &'a Index, camera: &'a Camera, exec: &'a Exec) -> Self {
        let (buffers, key) = (Buffers::F32, DepthKey::WHOLE);
        Self { scene, index, camera, exec, buffers, key, level: None }
    }

    /// Of the levels of a stage those that it makes.
    pub(crate) fn only(&self, levels: Vec<usize>) -> Vec<usize> {
        self.level.map_or(levels, |level| vec![level])
    }

    /// The tiles of the picture.
    pub(crate) fn grid(&self) -> Grid {
        self.exec.grid(self.camera.width, self.camera.height)
    }

    /// The tiles of the fast paths.
    pub(crate) fn strips(&self) -> Grid {
        self.grid().strips()
    }

    /// All pixels of the picture.
    pub(crate) fn picture(&self) -> Rect {
        Rect { x0: 0, y0: 0, x1: self.camera.width, y1: self.camera.height }
    }

    /// What decides which planes a frame of the scene has.
    pub(crate) fn there(&self, keep: Keep) -> Conditions {
        Conditions::new(self.scene, keep)
    }

    /// Planes of the picture as a frame.
    pub(crate) fn frame<R>(&self, planes: Vec<NamedPlane<R>>) -> Frame<R> {
        Frame { width: self.camera.width, height: self.camera.height, planes }
    }
}

/// A method, implemented by its settings: everything in the settings may change the picture, and
/// [`Fields`] lists all of them.
///
/// The settings have been checked and the scene is one that the method draws when a picture is
/// asked for: [`super::Session`] sees to both.
pub trait Algorithm: Fields + Debug + Default + PartialEq + Send + Sync + 'static {
    /// The name in scene files and on the command line.
    const NAME: &'static str;
    /// What the method is, in one line, with its source.
    const SUMMARY: &'static str;
    /// The passes, in the order in which they run.
    const STAGES: &'static [Stage];
    /// Whether triangles, ribbons and tubes are drawn beside surfels.
    const DRAWS_PRIMITIVES: bool = false;
    /// Whether triangles are drawn beside surfels, by a method that draws no other primitives.
    const DRAWS_POLYGONS: bool = false;
    /// Whether the objects of a scene are drawn as they are; else the scene must be made flat.
    const DRAWS_OBJECTS: bool = false;
    /// How surfels are divided into groups if nobody says; none: the method draws no groups.
    const GROUPING: Option<Grouping> = None;
    /// Whether layers of surfels with opacities are blended; else a surfel is opaque.
    const BLENDS: bool = false;
    /// Whether surfels are needed from back to front.
    const BACK_TO_FRONT: bool = false;

    /// About the most bytes that the fast path takes for a pixel, the picture included; none: there
    /// is no fast path.
    const FAST_BYTES_A_PIXEL: Option<u64> = None;

    /// What the fast path works in, kept from picture to picture.
    type Memory: Debug + Default + Send;

    /// Footprints, epsilon and culling of a method that draws splats.
    fn splats(&self) -> Option<&SplatSettings> {
        None
    }

    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if one is not.
    fn check(&self) -> Result<()>;

    /// The definition, in any number; with `stages` the planes of every stage are kept.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the method cannot draw the scene with these settings.
    fn define<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>>;

    /// The picture in `f32`, by the fast path where there is one: the bits of the definition.
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

    /// Runs one stage on the planes of the stages that it reads, whoever made these planes, and
    /// gives the planes that the stage leaves.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if a plane is missing, of another type or size, or if no stage of
    /// this name can be run so.
    fn stage<R: Exact>(
        &self,
        job: &Job<'_>,
        stage: &str,
        given: &InputPlanes<'_, R>,
    ) -> Result<Vec<NamedPlane<R>>>;

    /// The levels that a stage makes, each from the one before, in the order in which they are made; empty of a
    /// stage that does not work level by level.
    fn levels(&self, job: &Job<'_>, stage: &str) -> Vec<usize> {
        let _ = (job, stage);
        Vec::new()
    }

    /// Every decision at one pixel, with its operands, in words.
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

    /// What the settings come to in a scene: names and values as TOML, for the text of a picture.
    fn settings_in_scene(&self, scene: &Scene, camera: &Camera) -> Vec<(&'static str, String)> {
        let _ = camera;
        self.splats().map_or_else(Vec::new, |splats| splats.settings_in_scene(scene))
    }
}
