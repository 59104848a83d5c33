//! Rasterize triangles and lines exactly: integer arithmetic, one answer.
//!
//! ```text
//!   pixel position (X, Y) ──Snap::fixed──▶ fixed point ──Triangle──▶ pixel, weights of 3 corners
//!                                                      ──Line──────▶ pixel, parameter from a to b
//! ```
//!
//! Rounding happens once, when a corner is snapped. After that, coverage, weights and parameters
//! are exact:
//!
//! - Primitives that share corners neither leave gaps nor overlap.
//! - A picture does not depend on its tiles.
//! - `f32` and `f64` disagree only where they snap a corner differently.
//!
//! Two modules do the work:
//!
//! - [`triangle`]: pixels whose centres are inside, by the top-left rule.
//! - [`mod@line`]: connected lines, one pixel wide.
//!
//! In \[MKC08, sections 4 and 5\] the graphics hardware rasterizes polygons and lines. `Decided:`
//! which pixels those are. Triangles follow the rule that the graphics interfaces share. The
//! interfaces do not agree about lines, so lines follow the rule of [`mod@line`].
//!
//! **Fixed point.** An integer F stands for the coordinate F / 2^bits, with 8 sub-pixel bits as in
//! Direct3D unless said otherwise. Coordinates reach to the **guard band**, |X| <= 2^17 and |Y| <=
//! 2^17 px, twice the largest picture; anything that reaches farther is clipped first
//! ([`crate::splat::clip`]). The guard band and at most 12 bits keep every product here below 2^63.

pub mod line;
pub mod triangle;

#[cfg(test)]
mod tests;

pub use line::Line;
pub use triangle::Triangle;

use crate::error::{Error, Result};
use crate::frame::Rect;
use crate::number::Exact;

/// How far coordinates may reach in either direction, in pixels: 2^17.
pub const GUARD_BAND: u32 = 1 << 17;

/// Converts pixel coordinates to fixed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Snap {
    bits: u32,
}

impl Default for Snap {
    /// 8 sub-pixel bits.
    fn default() -> Self {
        Self { bits: 8 }
    }
}

impl Snap {
    /// A grid with 2^`bits` positions per pixel, in each direction.
    ///
    /// # Errors
    /// [`Error::Invalid`] if `bits` is not in [0, 12].
    pub fn new(bits: u32) -> Result<Self> {
        if bits > 12 {
            return Err(Error::Invalid(format!("{bits} sub-pixel bits; give 0 to 12")));
        }
        Ok(Self { bits })
    }

    /// How many positions a pixel has, in each direction: 2^bits.
    pub(crate) fn scale(&self) -> u32 {
        1 << self.bits
    }

    /// Converts a pixel coordinate to fixed point: the nearest position, the greater one on a tie.
    ///
    /// ```text
    ///   x held in [-2^17, 2^17]     s = x 2^bits     f = floor(s), + 1 if s - f >= 1/2
    /// ```
    ///
    /// This is floor(s + 1/2) without the rounding of the sum, because the numbers below 1/2 must
    /// not become 1, nor odd numbers above 2^23 even. NaN gives 0.
    #[inline]
    pub fn fixed<R: Exact>(&self, x: R) -> i64 {
        let guard = R::from_f32(GUARD_BAND as f32);
        let scaled = x.at_least(-guard).at_most(guard) * R::from_f32(self.scale() as f32);
        // The floor by way of integers, exact here; the `floor` operation is a call where
        // processors may lack it.
        let whole = scaled.to_i64();
        let below = whole - i64::from(R::from_i64(whole) > scaled);
        below + i64::from(scaled - R::from_i64(below) >= R::from_f32(0.5))
    }

    /// Holds a point in the guard band, which [`Snap::fixed`] never leaves.
    fn held(&self, point: [i64; 2]) -> [i64; 2] {
        let guard = i64::from(GUARD_BAND) << self.bits;
        point.map(|c| c.clamp(-guard, guard))
    }

    /// The pixel that contains a point; its left and upper borders are part of it.
    fn pixel(&self, point: [i64; 2]) -> [i64; 2] {
        point.map(|c| c >> self.bits)
    }

    /// The first pixel, along one axis, whose centre is not before `halves` half units of fixed
    /// point.
    fn first_center_from(&self, halves: i64) -> i64 {
        // (2 i + 1) 2^bits >= halves, solved for the least i.
        (halves + (1 << self.bits) - 1) >> (self.bits + 1)
    }

    /// The centre of a pixel, along one axis, in halves of a fixed-point unit, because with 0 bits
    /// the centre lies between two positions.
    fn center(&self, pixel: i64) -> i64 {
        (2 * pixel + 1) << self.bits
    }
}

/// The part of columns and rows `low .. high` that is at or beyond 0.
fn not_negative(low: [i64; 2], high: [i64; 2]) -> Rect {
    // The guard band keeps these at 2^17 or less.
    let [x0, y0] = low.map(|c| c.max(0) as u32);
    let [x1, y1] = high.map(|c| c.max(0) as u32);
    Rect { x0, y0, x1, y1 }
}
