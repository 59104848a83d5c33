//! Draw in `f32`, fast: the bits of the definition, from another layout, see [`crate::method`].

mod kernels;

use super::Settings;
use crate::frame::{Framebuffer, FramebufferTile};
use crate::method::Job;
use crate::method::clock::Clock;
use crate::method::fast::tile::Tile;
use crate::method::fast::{draw, prepare};
use crate::splat::Tally;

/// Draws a scene into a framebuffer: both geometry passes and the normalization. The wall times of
/// the fused passes are shares of their common time. Visibility splatting includes gathering each
/// tile's splats.
///
/// Every pixel of `target` is overwritten, so a framebuffer can be used for many pictures. Its
/// stencil and margin are not written, because only the definition has them.
///
/// # Panics
/// If the framebuffer does not have the size of the job's window.
pub(super) fn render(
    job: &Job<'_>,
    settings: &Settings,
    target: &mut Framebuffer<f32>,
) -> (Tally, Clock) {
    assert_eq!([target.width, target.height], job.size(), "framebuffer size");
    let mut clock = Clock::default();
    let prepared = prepare(job, settings);
    clock.lap("projection");
    let shared = &prepared.shared;
    let names = ["visibility", "attributes", "normalization"];
    let gather = |tile: &mut Tile, pixels: &mut FramebufferTile<'_, f32>, _: &mut _| {
        tile.gather(&prepared, pixels.depth.index, pixels.depth.rect);
    };
    draw(job, target, &mut clock, names, gather, |tile, watch| {
        tile.visibility(shared);
        watch.lap(0);
        tile.limits(shared, prepared.epsilon);
        tile.attributes(shared);
        watch.lap(1);
        tile.normalize(shared);
    });
    (prepared.tally, clock)
}
