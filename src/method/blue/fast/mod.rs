//! Draw in `f32`, fast: the bits of the definition, from another layout.
//!
//! 1. **[`place`].** 16 surfels at a time become squares, without a branch for each surfel.
//! 2. **[`tile`].** The squares of a tile are gathered into one list. Each square is drawn in
//!    windows of 4 x 4 pixels from its own first pixel on, one vector of 16 lanes a quantity, so
//!    that a small square is one window. A lane is a pixel, and the lanes beyond the square keep
//!    their values. A pixel keeps its depth and the place of its disc in the list; its other values
//!    are read once, at the end.

mod place;
#[cfg(test)]
pub(crate) mod tests;
mod tile;

use super::Settings;
use super::squares::{SquareProjector, Squares};
use crate::frame::Framebuffer;
use crate::method::Job;
use crate::splat::{Tally, View};
use tile::TileOfDiscs;

/// Draws the discs of a scene into a framebuffer, every pixel of it, and counts the fates of the
/// surfels.
///
/// # Panics
/// If the framebuffer does not have the size of the job's window.
pub(super) fn render(job: &Job<'_>, settings: &Settings, target: &mut Framebuffer<f32>) -> Tally {
    assert_eq!([target.width, target.height], job.size(), "framebuffer size");
    let projector = SquareProjector::new(job, settings.cull);
    let strips = job.strips();
    let squares = Squares::projected_by(job, &strips, |range, squares| {
        place::squares(&projector, range, squares)
    });
    let view = View::new(job.camera);
    job.exec.ordered(target.cut(&strips, job.exec), |mut pixels| {
        let mut tile = TileOfDiscs::default();
        tile.gather(&squares, pixels.depth.index, pixels.depth.rect);
        tile.draw(&view);
        tile.store(job.scene, &mut pixels);
    });
    squares.tally
}
