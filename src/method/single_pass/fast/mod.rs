//! Draw in `f32`, fast: the bits of the definition, from another layout, see [`crate::method`].
//!
//! The splats of a tile are sorted by group, and the groups are drawn one after the other into the
//! same blocks. After each group, nearness, weight and splat of each pixel of a block are put
//! aside. So the images exist for one tile at a time, and only where something was drawn.
//!
//! Geometry is visited once, and a weight (an exponential) is computed once for each pixel and
//! group, not once for each fragment. In exchange each block of an image has to be composited. So
//! this method is faster than `ewa` where a block sees many splats of each group. It is slower
//! where a block sees few: where splats are small and groups are many. `cargo bench --bench
//! single_pass` shows both.

mod compositing;
mod geometry;
pub(crate) mod images;

use super::Settings;
use crate::error::Result;
use crate::frame::{Framebuffer, FramebufferTile};
use crate::method::Job;
use crate::method::clock::Clock;
use crate::method::fast::groups::own;
use crate::method::fast::tile::Tile;
use crate::method::fast::{draw, prepare};
use crate::splat::Tally;
use images::GroupImages;

/// Draws a scene into a framebuffer: the geometry pass, the compositing pass and the normalization.
/// The wall times of the fused passes are shares of their common time. The geometry pass includes
/// gathering each tile's splats, the compositing pass the normalization.
///
/// Every pixel of `target` is overwritten, so a framebuffer can be used for many pictures. Its
/// stencil and margin are not written, because only the definition has them.
///
/// # Errors
/// [`crate::Error::Invalid`] if the Voronoi depth test takes too many bins, or if there are no
/// groups for this number of surfels.
///
/// # Panics
/// If the framebuffer does not have the size of the job's window.
pub(super) fn render(
    job: &Job<'_>,
    settings: &Settings,
    target: &mut Framebuffer<f32>,
) -> Result<(Tally, Clock)> {
    assert_eq!([target.width, target.height], job.size(), "framebuffer size");
    let (surfels, groups) = (&job.scene.surfels, job.index.groups()?);
    groups.check(surfels)?;
    let mut clock = Clock::default();
    let bins = settings.bins(surfels, job.camera)?;
    let prepared = prepare(job, &settings.splats);
    clock.lap("projection");
    let shared = &prepared.shared;
    let names = ["geometry", "compositing"];
    let gather = |tile: &mut Tile, pixels: &mut FramebufferTile<'_, f32>, _: &mut _| {
        tile.gather(&prepared, pixels.depth.index, pixels.depth.rect);
    };
    draw(job, target, &mut clock, names, gather, |tile, watch| {
        let own = own(&tile.splats, groups);
        let mut images = GroupImages::new(tile, &own, groups.len(), shared.empty(), None);
        images.draw(tile, shared, bins.as_ref());
        watch.lap(0);
        images.nearest(tile);
        tile.limits(shared, prepared.epsilon);
        images.composite(tile, shared);
        tile.normalize(shared);
    });
    Ok((prepared.tally, clock))
}
