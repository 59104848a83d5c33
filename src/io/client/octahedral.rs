//! Unit vectors in two numbers: the sphere on an octahedron, unfolded into a square.
//!
//! ```text
//!   (u, v)      the stored numbers, in [-1, 1]
//!   w         = 1 - |u| - |v|
//!   (x, y)    = (u, v), or ((1 - |v|) sign u, (1 - |u|) sign v) where w < 0, with sign 0 = 1
//!   normal    = (x, y, w) / |(x, y, w)|
//! ```
//!
//! Let each of u and v be off by at most r. Then (x, y, w) is off by at most r, r and 2 r, the fold
//! included, as the square is folded without a jump: by d = sqrt(6) r. Two vectors of lengths l and at
//! least l - d that are d apart have directions that are at most 2 d / (2 l - d) apart.
//!
//! Source: Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT
//! 3(2), 2014, `oct`.

use super::format::F32_STEP;
use crate::frame::Plane;
use crate::number::Real;
use crate::verdict::client::Storage;

/// What the encoding itself may lose of u and v in `f32`: a sum of three, a quotient, and the fold.
const ENCODING: f64 = 8.0 * F32_STEP;
/// How far from 1 the length of a vector may be that was divided by its length in `f32`, as inexactly as
/// shading languages allow. The encoding forgets the length.
const LENGTH: f64 = 16.0 * F32_STEP;

/// The vectors of a plane of (u, v, 0), and how far off each is. Where nothing is, which a depth of
/// +inf says, there is the null vector: it has no numbers of its own.
pub(super) fn decoded(
    (stored, storage): (&Plane<[f64; 3]>, Storage),
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

/// The unit vector of two numbers that are off by at most this, and how far off it is; NaN if they are
/// outside the square.
fn vector(stored: [f64; 2], off: f64) -> ([f64; 3], f64) {
    let off = off + ENCODING;
    // A comparison that NaN fails.
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
    let apart = if moved < length { 2.0 * moved / (2.0 * length - moved) } else { 2.0 };
    ([x, y, w].map(|part| part / length), apart + LENGTH)
}
