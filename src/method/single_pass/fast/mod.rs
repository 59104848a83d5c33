//! The fast path for `f32`: the bits of the definition, from another layout, see [`crate::method`].
//!
//! In a tile the splats are sorted by group, and the groups are drawn one after the other into the
//! same blocks. What a group has left in a block is then put aside: nearness, weight and splat of
//! each pixel. So the images exist for one tile at a time, and there only where something was
//! drawn.
//!
//! Geometry is visited once, and a weight (an exponential) is computed once a pixel and group, not
//! once a fragment; in exchange each block of an image has to be composited. So this method is the
//! faster one where a block sees many splats of each group, and the slower one where it sees few:
//! where splats are small and groups are many. `cargo bench --bench single_pass` shows both.

mod compositing;
mod geometry;
pub(crate) mod images;

use super::Settings;
use crate::error::Result;
use crate::frame::Framebuffer;
use crate::method::Job;
use crate::method::fast::groups::own;
use crate::method::fast::{draw, prepare};
use crate::method::picture::{Clock, Laps};
use crate::splat::Tally;
use images::GroupImages;

/// Draws a scene into a framebuffer: the geometry pass, the compositing pass and the normalization.
/// The wall times of the fused passes are shares of their common time; the geometry pass includes
/// the gathering of each tile's splats, the compositing pass the normalization.
///
/// Every pixel of `target` is overwritten, so a framebuffer can be used for many pictures. Its
/// stencil and margin are not written; the definition has those.
///
/// # Errors
/// [`crate::Error::Invalid`] if the Voronoi depth test takes too many bins, or if there are no groups of as
/// many surfels.
///
/// # Panics
/// If the framebuffer has not the size of the camera's picture.
pub(super) fn render(
    job: &Job<'_>,
    settings: &Settings,
    target: &mut Framebuffer<f32>,
) -> Result<(Tally, Laps)> {
    assert_eq!([target.width, target.height], job.camera.size(), "framebuffer size");
    let (surfels, groups) = (&job.scene.surfels, job.index.groups()?);
    groups.check(surfels)?;
    let mut clock = Clock::default();
    let bins = settings.bins(surfels, job.camera)?;
    let prepared = prepare(job, &settings.splats);
    clock.lap("projection");
    let shared = &prepared.shared;
    let passes = draw::<2>(job, &prepared, target, |tile, watch| {
        let own = own(&tile.splats, groups);
        let mut images = GroupImages::new(tile, (&own, groups.len()), shared.empty(), None);
        images.draw(tile, shared, bins.as_ref());
        watch.lap(0);
        images.nearest(tile);
        tile.limits(shared, prepared.epsilon);
        images.composite(tile, shared);
        tile.normalize(shared);
    });
    let mut laps = clock.into_laps();
    laps.extend(["geometry", "compositing"].into_iter().zip(passes));
    Ok((prepared.tally, laps))
}
