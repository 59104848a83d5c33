//! Image reconstruction with templates of k x k pixels \[MOC08\].
//!
//! 1. **Projection** to single pixels, see [`mod@super::projection`].
//! 2. **Propagation** ([`mod@levels`]): each centre moves up the levels of a pyramid until k x k
//!    cells of its level cover it; centres that meet in a cell are merged.
//! 3. **Reconstruction** ([`mod@gather`]): each pixel searches k x k cells around it in every level
//!    for ellipses that hold it, keeps the surface in front, and blends.
//! 4. **Normalization**: depth, normal and colour are sums divided by the sum of weights, see
//!    [`crate::composite::sum`]; the average normal is then turned to world space (down the columns
//!    of the view matrix, (m0 x + m1 y) + m2 z) before it is divided by its length.
//! 5. **Deferred shading**, see [`crate::shade`].
//!
//! The method draws surfels only, and refuses a scene with triangles or lines, which \[MOC08\] does not have. The template is k = 3, 5 or 7 cells wide, h = (k - 1) / 2.
//! Levels are those of [`crate::frame::pyramid::sizes`]. The **top** level is the first whose sides are both at most h + 1: from any
//! of its cells every other is found, so that (section 3.2) coarser ones are not needed.
//!
//! [`gather`] is the definition, over any [`crate::number::Real`].

pub mod fast;
pub mod gather;
pub mod levels;
mod picture;

use crate::error::{Error, Result};
use crate::frame::{Frame, NO_ID, Pool};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::projection::{Kind, Sample};
use crate::method::{Picture, Stage};
use crate::number::{Exact, Vector2, Vector3};

/// The level at which a centre stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LevelRule {
    /// The least l >= 0 with rho <= h 2^l: a cell of level l is found from every pixel within h 2^l
    /// pixels of any point in it, so that the whole ellipse is found. But an ellipse that has just
    /// left a level shares a cell of the next with others that it does not cover, and is merged
    /// with them: a sampling of large or tilted discs gets holes (with k = 3 always, with k = 5
    /// from a tilt of 45 degrees on, with k = 7 from 62).
    Covering,
    /// The least l >= 0 with rho <= k 2^l, which is \[MOC08, eq. 1\], l = ceil(log2(D / `t_s`)), D
    /// being "the projected radius" and `t_s` the size of the template. It cuts ellipses:
    /// guaranteed is a distance of h 2^l only, half the radius or less. Surfaces have fewer holes
    /// by it nevertheless, since discs overlap and fewer are merged.
    #[default]
    Published,
}

/// What is computed; everything here may change the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// k: 3, 5 or 7.
    pub size: u32,
    /// See [`LevelRule`].
    pub levels: LevelRule,
    /// Whether surfels seen from behind are dropped.
    pub cull: bool,
}

impl Default for Settings {
    /// 5 x 5, which \[MOC08, section 5\] finds sufficient.
    fn default() -> Self {
        Self { size: 5, levels: LevelRule::default(), cull: true }
    }
}

impl Settings {
    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the template is not 3, 5 or 7 cells wide.
    pub fn check(&self) -> Result<()> {
        if [3, 5, 7].contains(&self.size) {
            Ok(())
        } else {
            Err(Error::Invalid(format!("template: a size of {}; give 3, 5 or 7", self.size)))
        }
    }

    /// h: how many cells the template reaches to every side.
    #[must_use]
    pub fn half(&self) -> u32 {
        (self.size - 1) / 2
    }

    /// The largest radius in pixels that stays at a level, exactly.
    #[must_use]
    pub fn reach(&self, level: usize) -> f32 {
        let cells = match self.levels {
            LevelRule::Covering => self.half(),
            LevelRule::Published => self.size,
        };
        cells as f32 * (1_u32 << level) as f32
    }
}

/// The centre of an ellipse in a cell of a level; view space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Center<R> {
    /// The surfel, of several that were merged the foremost; [`NO_ID`] in an empty cell.
    pub id: u32,
    /// Depth t in world units; +inf in an empty cell.
    pub depth: R,
    /// Radius r in world units.
    pub radius: R,
    /// Radius rho in pixels.
    pub extent: R,
    /// Where it is in the picture, in pixels.
    pub place: Vector2<R>,
    /// Normal, of any length.
    pub normal: Vector3<R>,
    /// Linear RGB.
    pub color: [R; 3],
}

impl<R: Exact> Center<R> {
    /// An empty cell: all but depth and id is 0.
    #[must_use]
    pub fn empty() -> Self {
        Self {
            id: NO_ID,
            depth: R::INFINITY,
            radius: R::ZERO,
            extent: R::ZERO,
            place: Vector2::new(R::ZERO, R::ZERO),
            normal: Vector3::ZERO,
            color: [R::ZERO; 3],
        }
    }

    /// A centre of level 0.
    #[must_use]
    pub fn new(sample: &Sample<R>) -> Self {
        if sample.kind == Kind::Empty {
            return Self::empty();
        }
        Self {
            id: sample.id,
            depth: sample.depth,
            radius: sample.radius,
            extent: sample.extent,
            place: sample.center,
            normal: sample.normal,
            color: sample.color,
        }
    }

    /// Whether there is a centre.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.id != NO_ID
    }
}

impl Algorithm for Settings {
    const NAME: &'static str = "template";
    const SUMMARY: &'static str =
        "one pixel a point, search with templates of k x k pixels in a pyramid [MOC08]";
    const STAGES: &'static [Stage] = &[];
    type Memory = fast::Levels;

    fn check(&self) -> Result<()> {
        Self::check(self)
    }

    fn define<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
        picture::define(job, self, stages)
    }

    fn draw(
        &self,
        job: &Job<'_>,
        memory: &mut fast::Levels,
        pool: &mut Pool,
    ) -> Result<Picture<f32>> {
        picture::draw(job, self, memory, pool)
    }

    fn stage<R: Exact>(&self, job: &Job<'_>, stage: &str, from: &Frame<R>) -> Result<Frame<R>> {
        let _ = (job, from);
        Err(crate::method::stage::unknown(stage))
    }

    fn explain<R: Exact>(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<String> {
        let _ = (job, pixel);
        Err(Error::Usage("there is no replay of this method".into()))
    }
}
