//! Decode unit vectors stored in two numbers: the sphere is mapped to an octahedron, unfolded into
//! a square.
//!
//! ```text
//!   (u, v)      the stored numbers, in [-1, 1]
//!   w         = 1 - |u| - |v|
//!   (x, y)    = (u, v), or ((1 - |v|) sign u, (1 - |u|) sign v) where w < 0, with sign 0 = 1
//!   normal    = (x, y, w) / |(x, y, w)|
//! ```
//!
//! If u and v are each off by at most r, then (x, y, w) is off by at most r, r and 2 r, that is by
//! d = sqrt(6) r. This includes the fold, because the square is folded without a jump. Two vectors
//! d apart, with lengths l and at least l - d, have directions at most 2 d / (2 l - d) apart.
//!
//! Source: Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT
//! 3(2), 2014, `oct`.

use super::format::F32_STEP;
use crate::frame::Plane;
use crate::number::Real;
use crate::verdict::client::Storage;

/// How much the encoding itself may lose of u and v in `f32`: a sum of three, a quotient, and the
/// fold.
const ENCODING: f64 = 8.0 * F32_STEP;
/// How far from 1 the length of a vector may be after a division by its length in `f32`, as inexact
/// as shading languages allow. The encoding forgets the length.
const LENGTH: f64 = 16.0 * F32_STEP;

/// Decodes a plane of (u, v, 0) into vectors, and how far off each vector may be. Empty pixels,
/// with a depth of +inf, become the null vector, because the null vector has no code.
pub(super) fn decoded(
    stored: &Plane<[f64; 3]>,
    storage: Storage,
    depths: &Plane<f64>,
) -> (Plane<[f64; 3]>, Plane<[f64; 3]>) {
    let (width, height) = (stored.width(), stored.height());
    let pixels = stored.values().iter().zip(depths.values());
    let both = |(&[u, v, _], &depth): (&[f64; 3], &f64)| {
        if depth == f64::INFINITY {
            return ([0.0; 3], [0.0; 3]);
        }
        let (normal, radius) = vector([u, v], storage.radius(u).at_least(storage.radius(v)));
        (normal, [radius; 3])
    };
    let (values, radii) = pixels.map(both).unzip();
    (Plane::from_values(width, height, values), Plane::from_values(width, height, radii))
}

/// The unit vector of two numbers that are off by at most `off`, and how far off the vector is; NaN
/// if the numbers are outside the square.
fn vector(stored: [f64; 2], off: f64) -> ([f64; 3], f64) {
    let off = off + ENCODING;
    // NaN fails this comparison, and is refused too.
    if !stored.iter().all(|part| part.abs() <= 1.0 + off) {
        return ([f64::NAN; 3], 0.0);
    }
    let [u, v] = stored.map(|part| part.clamped(-1.0, 1.0));
    let w = 1.0 - u.abs() - v.abs();
    let sign = |part: f64| if part < 0.0 { -1.0 } else { 1.0 };
    let (x, y) =
        if w < 0.0 { ((1.0 - v.abs()) * sign(u), (1.0 - u.abs()) * sign(v)) } else { (u, v) };
    let length = (x * x + y * y + w * w).sqrt();
    let moved = 6.0_f64.sqrt() * off;
    // // Without this test the bound would be negative: such a vector may have any direction.
    let apart = if moved < length { 2.0 * moved / (2.0 * length - moved) } else { 2.0 };
    ([x, y, w].map(|part| part / length), apart + LENGTH)
}
