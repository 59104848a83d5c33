//! Pixel coordinates in fixed point.

use crate::error::{Error, Result};
use crate::frame::Rect;
use crate::number::Exact;

/// How far coordinates may reach in either direction, in pixels: 2^17.
pub const GUARD_BAND: u32 = 1 << 17;

/// How pixel coordinates become fixed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Snap {
    pub(super) bits: u32,
}

impl Default for Snap {
    /// 8 sub-pixel bits.
    fn default() -> Self {
        Self { bits: 8 }
    }
}

impl Snap {
    /// A grid of 2^`bits` positions a pixel, in each direction.
    ///
    /// # Errors
    /// [`Error::Invalid`] if `bits` is not in [0, 12].
    pub fn new(bits: u32) -> Result<Self> {
        if bits > 12 {
            return Err(Error::Invalid(format!("{bits} sub-pixel bits; give 0 to 12")));
        }
        Ok(Self { bits })
    }

    /// The positions of a pixel, in each direction: 2^bits.
    pub(crate) fn scale(&self) -> u32 {
        1 << self.bits
    }

    /// A pixel coordinate in fixed point: the nearest, of two the greater.
    ///
    /// ```text
    ///   x held in [-2^17, 2^17]     s = x 2^bits     f = floor(s), + 1 if s - f >= 1/2
    /// ```
    ///
    /// This is floor(s + 1/2) without the rounding of the sum: the numbers below 1/2 must not
    /// become 1, nor odd numbers above 2^23 even. NaN gives 0.
    #[inline]
    pub fn fixed<R: Exact>(&self, x: R) -> i64 {
        let guard = R::from_f32(GUARD_BAND as f32);
        let scaled = x.at_least(-guard).at_most(guard) * R::from_f32(self.scale() as f32);
        // The floor by way of integers, exact here; as an operation it is a call where processors may lack it.
        let whole = scaled.to_i64();
        let below = whole - i64::from(R::from_i64(whole) > scaled);
        below + i64::from(scaled - R::from_i64(below) >= R::from_f32(0.5))
    }

    /// A point held in the guard band, which [`Snap::fixed`] never leaves.
    pub(super) fn held(&self, point: [i64; 2]) -> [i64; 2] {
        let guard = i64::from(GUARD_BAND) << self.bits;
        point.map(|c| c.clamp(-guard, guard))
    }

    /// The pixel that contains a point; its left and upper borders are part of it.
    pub(super) fn pixel(&self, point: [i64; 2]) -> [i64; 2] {
        point.map(|c| c >> self.bits)
    }

    /// The first pixel, of one axis, whose centre is not before `halves` of a fixed-point unit.
    pub(super) fn first_center_from(&self, halves: i64) -> i64 {
        // (2 i + 1) 2^bits >= halves, solved for the least i.
        (halves + (1 << self.bits) - 1) >> (self.bits + 1)
    }

    /// The centre of a pixel, of one axis, in halves of a fixed-point unit: with 0 bits it lies
    /// between two.
    pub(super) fn center(&self, pixel: i64) -> i64 {
        (2 * pixel + 1) << self.bits
    }
}

/// The part of columns and rows `low .. high` at 0 and beyond.
pub(super) fn not_negative(low: [i64; 2], high: [i64; 2]) -> Rect {
    // At most 2^17 by the guard band.
    let [x0, y0] = low.map(|c| c.max(0) as u32);
    let [x1, y1] = high.map(|c| c.max(0) as u32);
    Rect { x0, y0, x1, y1 }
}
