//! Project surfels in `f32`, fast: the samples of [`super::project`], bit for bit.
//!
//! 1. **[`points`].** Every surfel that is seen becomes a point: pixel, depth, normal and radius,
//!    so that these are not read again from random places. The scene is read once, in order, 16
//!    surfels at a time, without a branch for each surfel. A chunk of surfels sorts its points by
//!    **bands** of rows in the cache, and writes them out in order.
//! 2. **[`nearest`].** Each band keeps the nearest point of each pixel in memory that fits the
//!    cache; one thread owns it. The points then become the samples of a row of pixels. Colours,
//!    and positions if they are wanted, are read for these points alone. Two rows make a row of the
//!    next coarser level while they are in the cache.

mod layout;
mod mean;
mod nearest;
mod points;
#[cfg(test)]
mod tests;

pub(crate) use layout::{PAD, RowLayout};
pub(crate) use mean::MeanLanes;
pub(crate) use nearest::{NearestPoints, pairs};
pub(crate) use points::Points;
