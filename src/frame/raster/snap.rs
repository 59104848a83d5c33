//! Pixel coordinates in fixed point.

use crate::error::{Error, Result};
use crate::frame::Rect;
use crate::number::{Exact, MapInline};

/// How far coordinates may reach in either direction, in pixels: 2^17.
pub const GUARD_BAND: u32 = 1 << 17;

/// Converts pixel coordinates to fixed point.
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
    #[inline]
    pub(super) fn held(&self, point: [i64; 2]) -> [i64; 2] {
        let guard = i64::from(GUARD_BAND) << self.bits;
        point.map_inline(|c| c.clamp(-guard, guard))
    }

    /// The pixel that contains a point; its left and upper borders are part of it.
    pub(super) fn pixel(&self, point: [i64; 2]) -> [i64; 2] {
        point.map_inline(|c| c >> self.bits)
    }

    /// The first pixel, along one axis, whose centre is not before `halves` half units of fixed
    /// point.
    pub(super) fn first_center_from(&self, halves: i64) -> i64 {
        // (2 i + 1) 2^bits >= halves, solved for the least i.
        (halves + (1 << self.bits) - 1) >> (self.bits + 1)
    }

    /// The centre of a pixel, along one axis, in halves of a fixed-point unit, because with 0 bits
    /// the centre lies between two positions.
    pub(super) fn center(&self, pixel: i64) -> i64 {
        (2 * pixel + 1) << self.bits
    }
}

/// The part of columns and rows `low .. high` that is at or beyond 0.
#[inline]
pub(super) fn not_negative(low: [i64; 2], high: [i64; 2]) -> Rect {
    // The guard band keeps these at 2^17 or less.
    let [x0, y0] = low.map_inline(|c| c.max(0) as u32);
    let [x1, y1] = high.map_inline(|c| c.max(0) as u32);
    Rect { x0, y0, x1, y1 }
}
