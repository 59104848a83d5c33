//! The fast projection of surfels in `f32`: the samples of [`super::project`], bit for bit.
//!
//! 1. **[`points`].** Every surfel that is seen becomes a point: pixel, depth, normal and radius,
//!    so that those are not read again from random places. The scene is read once, in order,
//!    [`LANES`] surfels at a time, without a branch a surfel; a chunk of surfels sorts its points
//!    by **bands** of rows in the cache, and writes them out in order.
//! 2. **[`nearest`].** Each band keeps the nearest point of each pixel in memory that fits the
//!    cache; one thread owns it. What the points carry then becomes the samples of a row of pixels;
//!    colours, and the positions of those who want them, are read for those alone.

mod nearest;
mod points;
mod shape;

pub(in crate::method) use nearest::Nearest;
pub(in crate::method) use points::Points;
pub(in crate::method) use shape::{PAD, Shape, lanes};

/// Surfels or pixels that are treated side by side.
pub(in crate::method) const LANES: usize = 16;

/// One number for each of [`LANES`].
pub(in crate::method) type Lanes = [f32; LANES];

/// Every second of twice [`LANES`] values of a row from an index on: the even and the odd ones.
#[inline(always)]
pub(in crate::method) fn halves<T: Copy + Default>(row: &[T], at: usize) -> [[T; LANES]; 2] {
    let mut pairs = [T::default(); 2 * LANES];
    pairs.copy_from_slice(&row[at..at + 2 * LANES]);
    let (mut even, mut odd) = ([T::default(); LANES], [T::default(); LANES]);
    for i in 0..LANES {
        even[i] = pairs[2 * i];
        odd[i] = pairs[2 * i + 1];
    }
    [even, odd]
}

/// Whether one of these is above 0; all are asked, so that they are asked at once.
#[inline(always)]
pub(in crate::method) fn any_above_0(values: &[f32]) -> bool {
    let mut found = false;
    for &value in values {
        found |= value > 0.0;
    }
    found
}

/// Copies [`LANES`] values, or as many as there is room for: a whole copy is one instruction.
#[inline(always)]
pub(in crate::method) fn put<T: Copy>(to: &mut [T], from: &[T; LANES]) {
    if to.len() == LANES {
        to.copy_from_slice(from);
    } else {
        to.copy_from_slice(&from[..to.len()]);
    }
}

#[cfg(test)]
mod tests;
