//! Make test scenes whose true picture is known, and measure the error of a renderer against the
//! truth.
//!
//! A [`Shape`] gives surfels that cover it ([`Shape::surfels`]). From the same definition it gives
//! the picture that a perfect renderer would make ([`Shape::true_picture`]), by one ray through
//! each pixel centre, in f64. Any difference that does not come from the discs themselves is an
//! error of the splatting method.
//!
//! | name | geometry | difficulty |
//! |---|---|---|
//! | `sphere` | radius 1 at the origin, smooth colours | silhouettes, grazing discs, curvature |
//! | `torus` | radii 1 and 3/8 around +y, smooth colours | a silhouette in front of its own surface |
//! | `checkerboard` | the plane y = 0 to the horizon | aliasing, grazing discs, large and tiny splats |
//! | `sheets` | two squares, `gap` apart, facing +z | epsilon-z: bleeding and holes |
//! | `staircase` | eight thin plates, each `step` deeper | epsilon-z, depth bins, spacing above `thickness` |
//! | `cluster` | 32 spheres in eight colours, some overlapping | colours that run into each other at creases |
//!
//! The sphere and the spheres of the cluster carry golden spirals. The other shapes are cut into
//! cells, nearly square, with one surfel in each, displaced at random by up to 1/8 of the cell's
//! sides.
//!
//! The radius is everywhere **the spacing**: the square root of the area that a surfel stands for.
//! (For a cell that is not square, it is the root mean square of its sides.) It covers with some
//! margin. A displaced surfel is at most sqrt(1/2) * 5/4 = 0.88 spacings from the corners of its
//! cell. On a sphere, measurements found no point farther than 0.77 spacings from its spiral. On
//! average a point lies in pi discs.
//!
//! ```
//! use splatref::scene::Camera;
//! use splatref::source::Shape;
//!
//! let shape = Shape::by_name("torus").expect("one of Shape::ALL");
//! let surfels = shape.surfels(10_000, 0)?;
//! assert_eq!(surfels.len(), 10_000);
//!
//! let camera = Camera::new(64, 48, shape.default_pose(), shape.default_lens())?;
//! let truth = shape.true_picture(&camera)?;
//! assert!(truth.plane("Z").is_some());
//! # Ok::<(), splatref::Error>(())
//! ```

mod ball;
mod checkerboard;
mod picture;
mod plate;
pub mod sampling;
#[cfg(test)]
mod tests;
mod torus;

use crate::error::{Error, Result};
use crate::frame::Frame;
use crate::memory;
use crate::scene::{Camera, Lens, Pose, Surfels};
use glam::DVec3;
use sampling::Sampler;

/// The largest number of surfels that a shape can be asked for: 2^28.
pub const MAX_COUNT: usize = 1 << 28;
/// The largest parameter of a shape, in world units.
pub const MAX_PARAMETER: f32 = 1024.0;

/// A shape; parameters are world units in (0, [`MAX_PARAMETER`]].
///
/// A parameter is an `f32`: a number in a scene file, such as `gap = 0.1`, is rounded to `f32`
/// first. All formulas then take the `f32`, widened to f64.
///
/// Surfaces have two sides: a ray hits them from either, and the normal is the surface's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// The sphere of radius 1 around the origin; its colour is a smooth function of the position.
    Sphere,
    /// The torus around the y axis with radii 1 and 3/8; its colour is the same function as the
    /// sphere's.
    Torus,
    /// The plane y = 0, normal +y. It is light where floor(x / square) + floor(z / square) is even,
    /// and dark elsewhere.
    ///
    /// The plane and its true picture are infinite. Surfels fill |x|, |z| <= 4096: a square grid
    /// in |x|, |z| <= 4, then ten square rings. Each ring is twice as large as the one before and
    /// has cells twice as wide, so that spacing grows with the distance from the origin as
    /// perspective shrinks it.
    Checkerboard {
        /// Side of a square.
        square: f32,
    },
    /// Two squares that face +z: an orange one, |x|, |y| <= 1 in the plane z = 0, and behind it a
    /// blue one, |x|, |y| <= 3/2 in the plane z = -gap.
    Sheets {
        /// Distance between the sheets.
        gap: f32,
    },
    /// Eight plates that rise and recede: plate k spans |x| <= 1 and k/4 - 9/8 <= y <= k/4 - 5/8.
    /// Its front, normal +z, lies in z = -k step. Its back, normal -z, lies in z = -k
    /// step - thickness. Its rim is open. The lower half of each plate but the first is hidden
    /// behind the plate before.
    ///
    /// Each front has its own colour; the colour of the back is 1 minus it.
    Staircase {
        /// Distance from the front of a plate to the front of the next.
        step: f32,
        /// Distance from the front of a plate to its back.
        thickness: f32,
    },
    /// 32 spheres with centres in [-1, 1]^3 and radii in [1/8, 3/8], in eight colours; some
    /// overlap.
    ///
    /// `Decided:` each sphere is whole. A part inside another sphere has surfels too, and a
    /// renderer must find them hidden.
    Cluster,
}

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray parameter: the point is origin + t direction, the direction at its given length.
    pub t: f64,
    /// Unit normal of the surface in world space, whichever side the ray came from.
    pub normal: DVec3,
    /// Linear RGB in [0, 1].
    pub color: DVec3,
}

impl Shape {
    /// Every shape, with parameters that give a good picture.
    pub const ALL: [Self; 6] = [
        Self::Sphere,
        Self::Torus,
        Self::Checkerboard { square: 1.0 },
        Self::Sheets { gap: 0.5 },
        Self::Staircase { step: 0.25, thickness: 0.03125 },
        Self::Cluster,
    ];

    /// The shape of [`Shape::ALL`] that is called `name`.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shape| shape.name() == name)
    }

    /// The name of the shape, whatever its parameters.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Torus => "torus",
            Self::Checkerboard { .. } => "checkerboard",
            Self::Sheets { .. } => "sheets",
            Self::Staircase { .. } => "staircase",
            Self::Cluster => "cluster",
        }
    }

    /// About `count` surfels that cover the shape, with exact normals and colours, rounded once;
    /// [`mod@sampling`] has every step.
    ///
    /// Sphere and torus give exactly `count`; the cluster gives `count`, but at least one for each
    /// sphere. The others give what their grids can hold: within 5 % of `count` from 10,000 on. The
    /// seed turns the spirals and displaces surfels in their cells; it never changes the shape. The
    /// discs cover the shape, see the [module](self), once they are small against its curvature:
    /// from about a hundred surfels a sphere on.
    ///
    /// # Errors
    /// [`Error::Invalid`] if `count` is 0 or more than [`MAX_COUNT`], or if a parameter is not in
    /// its range.
    pub fn surfels(&self, count: usize, seed: u64) -> Result<Surfels> {
        if count == 0 || count > MAX_COUNT {
            return Err(Error::Invalid(format!(
                "{}: {count} surfels; give 1 to {MAX_COUNT}",
                self.name()
            )));
        }
        self.check()?;
        memory::ask(count as u64 * 96, || format!("{}: {count} surfels", self.name()))?;
        let mut sampler = Sampler::new(count, seed);
        match *self {
            Self::Sphere => ball::sample(&[ball::SPHERE], count, &mut sampler),
            Self::Torus => torus::sample(count, &mut sampler),
            Self::Checkerboard { square } => checkerboard::sample(square, count, &mut sampler),
            Self::Sheets { gap } => plate::sample(&plate::sheets(gap), count, &mut sampler),
            Self::Staircase { step, thickness } => {
                plate::sample(&plate::staircase(step, thickness), count, &mut sampler);
            }
            Self::Cluster => ball::sample(&ball::cluster(), count, &mut sampler),
        }
        sampler.finish()
    }

    /// The first point, at a parameter > 0, where a ray meets the shape. If several pieces have one
    /// parameter, the first in order wins.
    ///
    /// The parameter counts lengths of `direction`. For a ray with the view-space direction (x, y,
    /// -1) it is the depth. `None` for a direction of length 0, and if any number is not finite.
    #[must_use]
    pub fn trace(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        self.surface().trace(origin, direction, 0.0)
    }

    /// The shape, prepared for many rays; errors as [`Shape::true_picture`].
    #[cfg(feature = "cli")] // for the study
    pub(crate) fn tracer(&self) -> Result<Tracer> {
        self.check()?;
        Ok(Tracer(self.surface()))
    }

    /// The exact picture: one ray through the centre of each pixel, in f64, without lights.
    ///
    /// Planes, in this order: the colour (empty name, linear RGB, 0 where nothing is seen), `Z`
    /// (depth, +inf where nothing is seen) and `normal` (world space, the null vector where nothing
    /// is seen).
    ///
    /// View rays become world rays through the inverse of `view_from_world`, computed in f64.
    /// `Decided:` the near plane cuts the shape open: a hit that is not farther than the near plane
    /// is skipped, and the ray goes on to the next hit.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Camera::check`], or if a parameter of the shape is not in its range.
    pub fn true_picture(&self, camera: &Camera) -> Result<Frame<f64>> {
        camera.check()?;
        self.check()?;
        Ok(picture::true_picture(&self.surface(), camera))
    }

    /// A pose from which the shape looks good, +y up:
    ///
    /// | shape | eye | target |
    /// |---|---|---|
    /// | sphere | (0, 0, 4) | the origin |
    /// | torus | (0, 3, 4) | the origin |
    /// | checkerboard | (0, 3/2, 0) | (1/2, 1/2, -4) |
    /// | sheets | (2, 3/2, 6) | (0, 0, -gap/2) |
    /// | staircase | (3, 2, 5) | (0, 0, -7/2 step) |
    /// | cluster | (3/2, 2, 5) | the origin |
    #[must_use]
    pub fn default_pose(&self) -> Pose {
        let (eye, target) = match *self {
            Self::Sphere => ([0.0, 0.0, 4.0], [0.0; 3]),
            Self::Torus => ([0.0, 3.0, 4.0], [0.0; 3]),
            Self::Checkerboard { .. } => ([0.0, 1.5, 0.0], [0.5, 0.5, -4.0]),
            Self::Sheets { gap } => ([2.0, 1.5, 6.0], [0.0, 0.0, -0.5 * f64::from(gap)]),
            Self::Staircase { step, .. } => ([3.0, 2.0, 5.0], [0.0, 0.0, -3.5 * f64::from(step)]),
            Self::Cluster => ([1.5, 2.0, 5.0], [0.0; 3]),
        };
        Pose { eye: eye.into(), target: target.into(), up: DVec3::Y }
    }

    /// The lens that fits [`Shape::default_pose`]: a vertical field of view of 34 degrees, for the
    /// checkerboard 60.
    #[must_use]
    pub fn default_lens(&self) -> Lens {
        Lens::FieldOfView(match self {
            Self::Checkerboard { .. } => 60.0,
            _ => 34.0,
        })
    }

    /// Refuses parameters outside (0, `MAX_PARAMETER`].
    fn check(&self) -> Result<()> {
        let parameters: &[(&str, f32)] = match *self {
            Self::Sphere | Self::Torus | Self::Cluster => &[],
            Self::Checkerboard { square } => &[("square", square)],
            Self::Sheets { gap } => &[("gap", gap)],
            Self::Staircase { step, thickness } => &[("step", step), ("thickness", thickness)],
        };
        for (what, value) in parameters {
            if !(*value > 0.0 && *value <= MAX_PARAMETER) {
                return Err(Error::Invalid(format!(
                    "{}: {what} {value}; give a number in (0, {MAX_PARAMETER}]",
                    self.name()
                )));
            }
        }
        Ok(())
    }

    /// The geometry that rays are traced against.
    fn surface(&self) -> Surface {
        match *self {
            Self::Sphere => Surface::Balls(vec![ball::SPHERE]),
            Self::Torus => Surface::Torus,
            Self::Checkerboard { square } => Surface::Checkerboard(square),
            Self::Sheets { gap } => Surface::Plates(plate::sheets(gap)),
            Self::Staircase { step, thickness } => {
                Surface::Plates(plate::staircase(step, thickness))
            }
            Self::Cluster => Surface::Balls(ball::cluster()),
        }
    }
}

/// A shape, prepared for many rays.
#[cfg(feature = "cli")]
pub(crate) struct Tracer(Surface);

#[cfg(feature = "cli")]
impl Tracer {
    /// [`Shape::trace`] beyond a parameter of at least 0.
    pub(crate) fn trace(&self, origin: DVec3, direction: DVec3, beyond: f64) -> Option<Hit> {
        self.0.trace(origin, direction, beyond)
    }
}

/// The pieces of a shape, prepared for many rays.
enum Surface {
    Balls(Vec<ball::Ball>),
    Torus,
    Checkerboard(f32),
    Plates(Vec<plate::Plate>),
}

impl Surface {
    /// The nearest hit at a parameter > `beyond`.
    fn trace(&self, origin: DVec3, direction: DVec3, beyond: f64) -> Option<Hit> {
        match self {
            Self::Balls(balls) => nearest(balls, |ball| ball.trace(origin, direction, beyond)),
            Self::Torus => torus::trace(origin, direction, beyond),
            Self::Checkerboard(square) => checkerboard::trace(*square, origin, direction, beyond),
            Self::Plates(plates) => nearest(plates, |plate| plate.trace(origin, direction, beyond)),
        }
    }
}

/// The nearest of the hits on several pieces; a tie goes to the first piece.
fn nearest<T>(pieces: &[T], trace: impl Fn(&T) -> Option<Hit>) -> Option<Hit> {
    pieces.iter().filter_map(trace).reduce(|best, hit| if hit.t < best.t { hit } else { best })
}

/// Eight colours that are easy to tell apart, linear RGB, exact in `f32`.
const PALETTE: [[f64; 3]; 8] = [
    [0.875, 0.25, 0.0625],
    [0.0625, 0.25, 0.75],
    [0.875, 0.625, 0.0625],
    [0.125, 0.5, 0.25],
    [0.625, 0.0625, 0.375],
    [0.125, 0.625, 0.75],
    [0.75, 0.75, 0.6875],
    [0.375, 0.1875, 0.625],
];

/// The colour of sphere and torus: 1/2 + 3/8 sin of (9 x, 11 y + 1, 7 z + 2).
fn pattern(p: DVec3) -> DVec3 {
    let wave = |x: f64| 0.5 + 0.375 * crate::number::elementary::sin(x);
    DVec3::new(wave(9.0 * p.x), wave(11.0 * p.y + 1.0), wave(7.0 * p.z + 2.0))
}
