//! The fast projection of surfels in `f32`: the samples of [`super::project`], bit for bit.
//!
//! 1. **[`points`].** Every surfel that is seen becomes a point: pixel, depth, normal and radius,
//!    so that those are not read again from random places. The scene is read once, in order,
//!    16 surfels at a time, without a branch a surfel; a chunk of surfels sorts its points
//!    by **bands** of rows in the cache, and writes them out in order.
//! 2. **[`nearest`].** Each band keeps the nearest point of each pixel in memory that fits the
//!    cache; one thread owns it. What the points carry then becomes the samples of a row of pixels;
//!    colours, and the positions of those who want them, are read for those alone.

mod layout;
mod nearest;
mod points;
#[cfg(test)]
mod tests;

pub(crate) use layout::{PAD, RowLayout};
pub(crate) use nearest::NearestPoints;
pub(crate) use points::Points;
