//! The true picture of a scene, against which errors are measured.
//!
//! [`of_surfaces`] sees surfaces along rays, in f64:
//!
//! - Each pixel has 8 x 8 samples ([`SAMPLES`]), at ((i + 1/2) / 8, (j + 1/2) / 8) within it. A
//!   sample shows the nearest surface beyond the near plane, t > near, shaded by
//!   [`crate::shade::phong`] at its own point and normal, or what is behind: the environment in the
//!   direction of the sample's ray, or black. The colour of the pixel is their mean: the sum over
//!   j, and within over i, both ascending, divided by 64, rounded to `f32` once.
//! - `A` (1 where a surface or the environment is seen, else 0), `Z` (depth) and `normal` (world space)
//!   are those of the ray through the pixel's centre. `Decided:` they are not averaged; a mean of depths
//!   is the depth of nothing.
//! - Shapes are met exactly ([`crate::source::Shape::trace`]) along rays taken back through their place.
//!   Triangles are met as [`triangles`] says. Of surfaces at one depth the first in order wins; of the
//!   triangles of one surface the lower index.
//! - With `cull`, what is seen from behind is passed through, as by methods that cull; else its
//!   normal is reversed. From behind a shape is seen where n . d > 0, d the direction of the ray (with
//!   `cull` where n . d >= 0); which side of a triangle is the front its corners say. `Decided:` their
//!   order, and not the normals, as where polygons are drawn.
//! - A surface without a colour has the material's.
//!
//! [`of_points`] has no surface to look at. It takes the picture of [`mod@crate::method::ewa`] in f64, of
//! [`mod@crate::method::peeling`] where surfels have opacities, both with their default settings, at 8 times
//! the size, and the mean of its 8 x 8 pixels as above. `A`, `Z` and `normal` are those of that
//! picture at its own size. That is what EWA splatting comes to without the limits of a pixel; it
//! favours methods that are like it.
//!
//! A camera that is shifted by whole eighths of a pixel sees the same samples in other pixels. So
//! both give the colours under such shifts at once: by [kx, ky] eighths to the right and down, the
//! pixel x has the samples 8 x - kx to 8 x - kx + 7 of the picture that is not shifted.

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

/// What is seen.
#[derive(Clone, Debug)]
pub enum Surface {
    /// An exact shape.
    Shape {
        /// Which.
        shape: Shape,
        /// Where it is put.
        place: Similarity,
        /// Linear RGB for all of it; its own if absent.
        color: Option<Vec3>,
    },
    /// Triangles: normals and colours are interpolated.
    Triangles(Triangles),
}

/// A true picture.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The planes of a picture: the colour, `A`, `Z` and `normal`.
    pub frame: Frame<f32>,
    /// Where it comes from.
    pub how: How,
    /// The colours under shifts, in the order in which these were asked for.
    pub shifted: Vec<Plane<[f32; 3]>>,
}

/// Where a true picture comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// Exact shapes alone.
    Exact,
    /// Triangles, and maybe shapes.
    Triangles,
    /// Points alone.
    Points,
    /// Points with opacities.
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

/// The mean colour of the samples of a pixel: the first sample is at [x, y] of rows of `width`.
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
