//! The true picture of a scene, against which errors are measured.
//!
//! [`of_surfaces`] casts rays at surfaces, in f64:
//!
//! - Each pixel has 8 x 8 samples ([`SAMPLES`]), at ((i + 1/2) / 8, (j + 1/2) / 8) within it. A
//!   sample shows the nearest surface beyond the near plane, t > near, shaded by
//!   [`crate::shade::phong`] at its own point and normal. Without a surface it shows the
//!   environment in the direction of the sample's ray, or black. The colour of the pixel is the
//!   mean: the sum over j, and within over i, both ascending, divided by 64, rounded to `f32` once.
//! - `A` (1 where a surface or the environment is seen, else 0), `Z` (depth) and `normal` (world
//!   space) come from the ray through the pixel's centre. `Decided:` they are not averaged, because
//!   a mean of depths is the depth of no surface.
//! - Shapes are met exactly ([`crate::source::Shape::trace`]) along rays that are transformed back
//!   into their space. [`triangles`] says how triangles are met. Of surfaces at one depth the first
//!   in order wins; of the triangles of one surface the lower index.
//! - With `cull`, rays pass through back faces, as in methods that cull. Without it, the normal of
//!   a back face is reversed. The back of a shape is seen where n . d > 0, with d the direction of
//!   the ray (with `cull` where n . d >= 0). The corners of a triangle say which side is its front.
//!   `Decided:` their order decides, not the normals, as where polygons are drawn.
//! - A surface without a colour has the material's.
//!
//! [`of_points`] has no surface to look at. It draws the picture of [`mod@crate::method::ewa`] in
//! f64, or of [`mod@crate::method::peeling`] if surfels have opacities, both with default settings,
//! at 8 times the size. The colour of a pixel is the mean of its 8 x 8 pixels as above. `A`, `Z`
//! and `normal` come from the same picture at its own size. This is the limit of EWA splatting
//! without pixels, so it favours methods that are like EWA.
//!
//! A camera that is shifted by whole eighths of a pixel sees the same samples in other pixels, so
//! both functions return the colours under such shifts at once. Under a shift by [kx, ky] eighths
//! to the right and down, pixel x has the samples 8 x - kx to 8 x - kx + 7 of the unshifted
//! picture.

mod cast;
mod caster;
mod points;
mod rays;
#[cfg(test)]
mod tests;
mod tile;
pub mod triangles;

pub use cast::of_surfaces;
pub use points::of_points;

use crate::frame::{Frame, NamedPlane, Plane, Samples};
use crate::scene::{Similarity, Triangles};
use crate::source::Shape;
use glam::Vec3;
use std::fmt;

/// Samples along each side of a pixel.
pub const SAMPLES: u32 = 8;

/// A surface.
#[derive(Clone, Debug)]
pub enum Surface {
    /// An exact shape.
    Shape {
        /// The shape.
        shape: Shape,
        /// Its place.
        place: Similarity,
        /// One linear RGB colour for all of it; its own colours if absent.
        color: Option<Vec3>,
    },
    /// Triangles; normals and colours are interpolated.
    Triangles(Triangles),
}

/// A true picture.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The planes of a picture: the colour, `A`, `Z` and `normal`.
    pub frame: Frame<f32>,
    /// How it was computed.
    pub how: How,
    /// The colours under shifts, in the order of the request.
    pub shifted: Vec<Plane<[f32; 3]>>,
}

/// How a true picture was computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// From exact shapes.
    Exact,
    /// From triangles, and maybe shapes.
    Triangles,
    /// From points.
    Points,
    /// From points with opacities.
    Layers,
}

impl fmt::Display for How {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exact => "the exact surface, 8 x 8 rays a pixel",
            Self::Triangles => "the triangles, 8 x 8 rays a pixel",
            Self::Points => "no surface is known: the splats by EWA in f64 at 8 x 8 times the pixels, which favours EWA",
            Self::Layers => "no surface is known: the layers by depth peeling in f64 at 8 x 8 times the pixels, which favours EWA",
        })
    }
}

/// The frame of a true picture.
fn frame(
    color: Plane<[f32; 3]>,
    alpha: Plane<f32>,
    depth: Plane<f32>,
    normal: Option<Plane<[f32; 3]>>,
) -> Frame<f32> {
    let (width, height) = (color.width(), color.height());
    let named = |name: &str, samples| NamedPlane { name: name.to_owned(), samples };
    let mut planes = vec![
        named("", Samples::Color(color)),
        named("A", Samples::Scalar(alpha)),
        named("Z", Samples::Scalar(depth)),
    ];
    planes.extend(normal.map(|normal| named("normal", Samples::Vector(normal))));
    Frame { width, height, planes }
}

/// The mean colour of a pixel's samples; the first sample is at [x, y] in rows of `width`.
fn mean(samples: &[[f64; 3]], width: usize, [x, y]: [usize; 2]) -> [f32; 3] {
    let side = SAMPLES as usize;
    let mut sum = [0.0; 3];
    for row in 0..side {
        for sample in &samples[(y + row) * width + x..][..side] {
            for (sum, part) in sum.iter_mut().zip(sample) {
                *sum += part;
            }
        }
    }
    sum.map(|sum: f64| (sum / f64::from(SAMPLES * SAMPLES)) as f32 + 0.0)
}
