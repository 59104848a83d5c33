//! The settings of the method.

use crate::composite::bins::{DepthBins, MAX_BINS, Range};
use crate::error::{Error, Result};
use crate::number::MapInline;
use crate::number::Real;
use crate::scene::{Camera, Scene, Sphere, Surfels};
use crate::setting::{Field, Fields, Slot, Visit, Words};
use crate::splat::SplatSettings;

/// The settings of the method; each of them may change the picture.
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
    /// In the nearest depth bin, the fragment nearest to its own centre \[ZP06, section 5.1\].
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
            // Without the Voronoi test the row stays, marked idle.
            DepthTest::Plain => BinCount::default()
                .field(&mut |field| each(field.idle("without depth = \"voronoi\""))),
        }
    }
}

impl DepthTest {
    /// The row of the depth test, without the row of its bins.
    pub(crate) fn field(&mut self) -> Field<'_> {
        let help = "choose which of a group's overlapping fragments to keep: the nearest, or, in \
                    the nearest depth bin, the one closest to its own centre";
        Field::new("depth", help, Slot::Word(self))
    }
}

impl Words for DepthTest {
    const WORDS: &'static [(&'static str, Self)] =
        &[("plain", Self::Plain), ("voronoi", Self::Voronoi(BinCount::Epsilon))];
}

impl BinCount {
    /// The row of the bins.
    pub(crate) fn field(&mut self, each: &mut Visit<'_>) {
        let mut count = match *self {
            Self::Epsilon => None,
            Self::Count(count) => Some(count),
        };
        let help = "use this many depth bins; `epsilon` makes them no deeper than epsilon";
        each(Field::new("bins", help, Slot::CountOr(&mut count, "epsilon")).range("1 to 65535"));
        *self = count.map_or(Self::Epsilon, Self::Count);
    }

    /// Checks that the number is in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the number is not.
    pub fn check(&self) -> Result<()> {
        match *self {
            Self::Count(n) if !(1..=MAX_BINS).contains(&n) => {
                Err(Error::Invalid(format!("bins: {n}; give 1 to {MAX_BINS}")))
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

    /// The bins of a picture as TOML: `d_min`, `d_max` and n of \[ZP06, eq. 6\]; none if there are
    /// too many bins.
    pub(crate) fn settings_in_scene(
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
    /// Checks that the numbers are in range.
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
    pub(crate) fn bins<R: Real>(
        &self,
        surfels: &Surfels,
        camera: &Camera,
    ) -> Result<Option<DepthBins<R>>> {
        let DepthTest::Voronoi(bins) = &self.depth else { return Ok(None) };
        let epsilon = self.splats.epsilon.resolve(surfels);
        Ok(Some(DepthBins::new(&bins.resolve(surfels, camera, epsilon)?)))
    }
}

/// `d_min` and `d_max` of \[ZP06, eq. 6\]: the depths of the scene's bounding sphere.
///
/// The inputs are the centre (x, y, z) and the radius r of [`Surfels::bounding_sphere`] and the
/// third row m of the view matrix. In f64: `t = -(((m0 x + m1 y) + m2 z) + m3)`; `d_min` is t - r,
/// at least the near plane, and `d_max` is t + r, each rounded once to `f32`. If `d_max` would not
/// be greater than `d_min`, it is the next `f32` after `d_min`. That happens if nothing is in
/// sight, or if the scene is less deep than the spacing of `f32` there.
#[must_use]
pub fn depth_range(surfels: &Surfels, camera: &Camera) -> (f32, f32) {
    let Sphere { center, radius } = surfels.bounding_sphere();
    let [m0, m1, m2, m3] = camera.view_from_world.row(2).to_array().map_inline(f64::from);
    let t = -(((m0 * center.x + m1 * center.y) + m2 * center.z) + m3);
    let (low, high) = ((t - radius) as f32, (t + radius) as f32);
    let low = if low > camera.near { low } else { camera.near };
    (low, if high > low { high } else { low.next_up() })
}
