//! Single-pass point rendering: deferred blending over groups \[ZP06, Algorithm 1\].
//!
//! The passes of \[ZP06, Fig. 7\], for surfels whose [`Groups`] are known, each in its own group
//! and at its own radius (what an extension added or enlarged is for transparency alone):
//!
//! 1. **Projection.** Each surfel becomes a [`Splat`], as in [`super::ewa`].
//! 2. **Geometry pass.** Each group k has a depth-image `I_k`. Each fragment of its surfels that is
//!    inside (q <= k^2), in ascending surfel index, replaces what the pixel of `I_k` holds if it
//!    passes the depth test ([`DepthTest`]); the fragment kept leaves its depth, its weight, and
//!    its weight times normal and times colour (eq. 4). A surfel seen from behind gives its normal
//!    reversed.
//! 3. **Compositing pass.** The operator of Fig. 5 over all `I_k`, see
//!    [`crate::composite::groups`], with the sums in the order of the groups; then depth, average
//!    colour and direction of the normal as in [`super::ewa`]. The id of a pixel is that of the
//!    greatest nearness of all `I_k`, ties to the lower surfel.
//! 4. **Deferred shading**, see [`crate::shade`].
//!
//! The depth test of the geometry pass:
//!
//! - [`DepthTest::Plain`]: the greater nearness wins, ties to the lower surfel.
//! - [`DepthTest::Voronoi`]: the smaller Voronoi-enhanced depth wins (eq. 10, see
//!   [`crate::composite::bins`]), ties to the lower surfel, with `ratio = sqrt(q / (k k))`. With
//!   the paper's kernel, a disc by ray casting without low-pass filter, that is `|f_i - p_i| /
//!   r_i`. `Decided:` with any other footprint q is the squared distance from its own centre in its
//!   own standard deviations, and the ratio is the same formula.
//!
//! `Decided:` `d_min` and `d_max` are the depths of [`depth_range`], which a backend knows before
//! it has drawn anything; the depth of a fragment is brought into the bins (an enlarged splat can
//! leave them).
//!
//! # When it is the 2+1-pass method
//!
//! At a pixel where no two fragments of one group are within epsilon of the nearest fragment of
//! all, and with the plain depth test, the sums of both methods are over the same fragments: the
//! pictures differ by the order of the sums alone. Groups that do not overlap (c = 1, nothing
//! relaxed) leave these pixels where it does not hold, because two fragments of one group are
//! within epsilon:
//!
//! - discs that do not overlap in space, but do on the screen within epsilon of depth: at steep
//!   angles, at the silhouette, and where two sheets are closer than epsilon;
//! - footprints that are larger than their disc: the skirt of a low-pass filter, and the affine
//!   outline of a disc under perspective.
//!
//! There the group keeps the nearer fragment alone.
//!
//! [`plain`] is the definition, over any [`Real`]; [`fast`] gives the same bits for `f32`.
//! [`explain`] lists every decision at one pixel.
//!
//! [`Splat`]: crate::splat::Splat
//! [`Real`]: crate::number::Real
//! [`Groups`]: crate::scene::Groups

pub mod explain;
pub mod fast;
mod picture;
pub mod plain;

use crate::composite::bins::{DepthBins, MAX_BINS, Range};
use crate::error::{Error, Result};
use crate::frame::{Frame, Pool};
use crate::index::grouping::{Extension, Grouping, Rules};
use crate::method::algorithm::{Algorithm, Job};
use crate::method::{Picture, Stage};
use crate::number::Exact;
use crate::scene::{Camera, Scene, Surfels};
use crate::setting::{Field, Fields, Slot, Visit, Words};
use crate::splat::SplatSettings;
pub(super) use picture::image_planes;

/// What is computed; everything here may change the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Footprints, the epsilon of the compositing pass, culling.
    pub splats: SplatSettings,
    /// Which fragment of a group is kept.
    pub depth: DepthTest,
}

/// Which fragment of a group a pixel keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthTest {
    /// The nearest.
    Plain,
    /// In the nearest depth bin the one nearest to its own centre \[ZP06, section 5.1\].
    Voronoi(BinCount),
}

impl Default for DepthTest {
    /// The Voronoi-enhanced test with bins no deeper than epsilon.
    fn default() -> Self {
        Self::Voronoi(BinCount::Epsilon)
    }
}

/// How many depth bins there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BinCount {
    /// Bins no deeper than epsilon, see [`Range::of_epsilon`].
    #[default]
    Epsilon,
    /// n, 1 to [`MAX_BINS`].
    Count(u32),
}

impl Fields for Settings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        self.splats.fields(each);
        each(self.depth.field());
        match &mut self.depth {
            DepthTest::Voronoi(bins) => bins.field(&mut |field| each(field)),
            DepthTest::Plain => BinCount::default()
                .field(&mut |field| each(field.idle("without depth = \"voronoi\""))),
        }
    }
}

impl DepthTest {
    /// The row of the depth test, without that of its bins.
    pub(in crate::method) fn field(&mut self) -> Field<'_> {
        let help = "what a group keeps of overlapping splats: the nearest, or of the nearest bin \
                    of depth the one nearest to its own centre";
        Field::new("depth", help, Slot::Word(self))
    }
}

impl Words for DepthTest {
    const WORDS: &'static [(&'static str, Self)] =
        &[("plain", Self::Plain), ("voronoi", Self::Voronoi(BinCount::Epsilon))];
}

impl BinCount {
    /// The row of the bins.
    pub(in crate::method) fn field(&mut self, each: &mut Visit<'_>) {
        let mut count = match *self {
            Self::Epsilon => None,
            Self::Count(count) => Some(count),
        };
        let help = "how many bins of depth; `epsilon`: no deeper than epsilon";
        each(Field::new("bins", help, Slot::CountOr(&mut count, "epsilon")).range("1 to 65535"));
        *self = count.map_or(Self::Epsilon, Self::Count);
    }

    /// Whether the number is in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it is not.
    pub fn check(&self) -> Result<()> {
        match *self {
            Self::Count(n) if !(1..=MAX_BINS).contains(&n) => {
                Err(Error::Invalid(format!("bins: n = {n}; give 1 to {MAX_BINS}")))
            }
            _ => Ok(()),
        }
    }

    /// The bins of a picture; `epsilon` in world units.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Range::of_epsilon`].
    pub fn resolve(&self, surfels: &Surfels, camera: &Camera, epsilon: f32) -> Result<Range> {
        let (nearest, farthest) = depth_range(surfels, camera);
        match *self {
            Self::Count(count) => Ok(Range { nearest, farthest, count }),
            Self::Epsilon => Range::of_epsilon(nearest, farthest, epsilon),
        }
    }

    /// The bins of a picture as TOML: `d_min`, `d_max` and n of \[ZP06, eq. 6\], if there are not
    /// too many.
    pub(in crate::method) fn resolved(
        &self,
        splats: &SplatSettings,
        scene: &Scene,
        camera: &Camera,
    ) -> Option<(&'static str, String)> {
        let epsilon = splats.epsilon.resolve(&scene.surfels);
        let Range { nearest, farthest, count } =
            self.resolve(&scene.surfels, camera, epsilon).ok()?;
        Some(("bins_in_world_units", format!("[{nearest:?}, {farthest:?}, {count}]")))
    }
}

impl Settings {
    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`SplatSettings::check`] and [`BinCount::check`].
    pub fn check(&self) -> Result<()> {
        self.splats.check()?;
        match &self.depth {
            DepthTest::Plain => Ok(()),
            DepthTest::Voronoi(bins) => bins.check(),
        }
    }

    /// The bins of the Voronoi depth test; none for the plain one.
    fn bins<R: Exact>(&self, surfels: &Surfels, camera: &Camera) -> Result<Option<DepthBins<R>>> {
        let DepthTest::Voronoi(bins) = &self.depth else { return Ok(None) };
        let epsilon = self.splats.epsilon.resolve(surfels);
        Ok(Some(DepthBins::new(&bins.resolve(surfels, camera, epsilon)?)))
    }
}

/// `d_min` and `d_max` of \[ZP06, eq. 6\]: the depths of the scene's bounding sphere.
///
/// With the centre (x, y, z) and the radius r of [`Surfels::bounding_sphere`] and the third row m
/// of the view matrix, in f64: `t = -(((m0 x + m1 y) + m2 z) + m3)`; `d_min` is t - r, at least the
/// near plane, and `d_max` is t + r, each rounded once to `f32`. Where `d_max` would not be greater
/// than `d_min` (nothing is in sight, or the scene is less deep than the spacing of `f32` there) it
/// is the next `f32` after it.
#[must_use]
pub fn depth_range(surfels: &Surfels, camera: &Camera) -> (f32, f32) {
    let (center, radius) = surfels.bounding_sphere();
    let [m0, m1, m2, m3] = camera.view_from_world.row(2).to_array().map(f64::from);
    let t = -(((m0 * center.x + m1 * center.y) + m2 * center.z) + m3);
    let (low, high) = ((t - radius) as f32, (t + radius) as f32);
    let low = if low > camera.near { low } else { camera.near };
    (low, if high > low { high } else { low.next_up() })
}

impl Algorithm for Settings {
    const NAME: &'static str = "single-pass";
    const SUMMARY: &'static str = "one geometry pass into the depth-images of groups, epsilon-z compositing [ZP06, Algorithm 1]";
    const STAGES: &'static [Stage] = &[];
    /// c = 0.4, which \[ZP06, section 6.1\] finds acceptable; opposite normals relaxed.
    const GROUPING: Option<Grouping> = Some(Grouping {
        rules: Rules { overlap: 0.4, opposite: true, coplanar: None },
        count: None,
        extension: Extension::None,
    });
    type Memory = ();

    fn splats(&self) -> Option<&SplatSettings> {
        Some(&self.splats)
    }

    fn check(&self) -> Result<()> {
        Self::check(self)
    }

    fn define<R: Exact>(&self, job: &Job<'_>, stages: bool) -> Result<Picture<R>> {
        picture::define(job, self, stages)
    }

    fn draw(&self, job: &Job<'_>, (): &mut (), pool: &mut Pool) -> Result<Picture<f32>> {
        picture::draw(job, self, pool)
    }

    fn stage<R: Exact>(&self, job: &Job<'_>, stage: &str, from: &Frame<R>) -> Result<Frame<R>> {
        let _ = (job, from);
        Err(crate::method::stage::unknown(stage))
    }

    fn explain<R: Exact>(&self, job: &Job<'_>, pixel: (u32, u32)) -> Result<String> {
        let Job { scene, camera, exec, index } = *job;
        let groups = index.groups()?;
        let found = explain::explain::<R>(&scene.surfels, groups, camera, self, exec, pixel)?;
        Ok(found.to_string())
    }

    fn resolved(&self, scene: &Scene, camera: &Camera) -> Vec<(&'static str, String)> {
        let mut resolved = self.splats.resolved(scene);
        if let DepthTest::Voronoi(bins) = &self.depth {
            resolved.extend(bins.resolved(&self.splats, scene, camera));
        }
        resolved
    }
}
