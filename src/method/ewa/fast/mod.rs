//! The fast path for `f32`: the bits of [`super::plain`], from another layout.
//!
//! A tile is done from beginning to end while it is in the cache: its splats are gathered into one
//! list, and its pixels are kept in blocks of 4 x 4, one vector of 16 lanes a quantity. A lane is a
//! pixel and never a partial sum, so every pixel sees the operations of the definition in their
//! order. Three things differ, and none of them changes a bit:
//!
//! - A block is visited whole. The lanes outside a splat's bounds have q > k^2.
//! - The epsilon-z test `1/w <= limit` becomes `w >= least`, with `least` the smallest `f32` that
//!   passes: 1/w, correctly rounded, never grows with w.
//! - A fragment that fails adds weight 0 instead of nothing.

mod kernels;
mod scratch;
mod store;

use super::Settings;
use crate::frame::{Exec, Framebuffer};
use crate::method::prepare::Prepared;
use crate::scene::{Camera, Surfels};
use crate::splat::{Tally, batch};
use scratch::{Record, Scratch};
use std::time::{Duration, Instant};

/// Wall time of the stages; those of the fused passes are shares of their common time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timings {
    /// Projection and binning.
    pub project: Duration,
    /// Visibility splatting, with the gathering of each tile's splats.
    pub visibility: Duration,
    /// Attribute splatting.
    pub attributes: Duration,
    /// Normalization.
    pub normalize: Duration,
}

/// Draws a scene into a framebuffer: both geometry passes and the normalization.
///
/// Every pixel of `target` is overwritten, so a framebuffer can be used for many pictures. Its
/// stencil and margin are not written; see [`super::plain`] for those.
///
/// # Panics
/// If the framebuffer has not the size of the camera's picture.
pub fn render(
    surfels: &Surfels,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    target: &mut Framebuffer<f32>,
) -> (Tally, Timings) {
    assert_eq!((target.width, target.height), (camera.width, camera.height), "framebuffer size");
    let start = Instant::now();
    let grid = exec.grid(camera.width, camera.height);
    let colors = surfels.color();
    let prepared = Prepared::new(
        (surfels, surfels.len()),
        camera,
        settings,
        (exec, &grid),
        |projector, range, records| {
            batch::splats_f32(projector, surfels, range, |splat| {
                records.push(Record::new(&splat, surfels.normal(), colors));
            })
        },
        Record::bounds,
    );
    let project = start.elapsed();

    let start = Instant::now();
    let jobs = target.tiles(&grid, exec).into_iter().enumerate().collect();
    let times = exec.ordered(jobs, |(index, mut tile)| {
        let start = Instant::now();
        let shared = &prepared.shared;
        let mut scratch = Scratch::gather(&prepared, index, &tile);
        if scratch.splats.is_empty() {
            store::clear(&mut tile);
            return [start.elapsed(), Duration::ZERO, Duration::ZERO];
        }
        scratch.visibility(shared);
        let visible = Instant::now();
        scratch.limits(shared, prepared.epsilon);
        scratch.attributes(shared);
        let added = Instant::now();
        scratch.normalize(shared);
        store::store(&scratch, &mut tile);
        [visible - start, added - visible, added.elapsed()]
    });
    let wall = start.elapsed();
    let sums = times.iter().fold([Duration::ZERO; 3], |a, b| [0, 1, 2].map(|i| a[i] + b[i]));
    let total: Duration = sums.iter().sum();
    let share = |part: Duration| match total.as_secs_f64() {
        0.0 => Duration::ZERO,
        total => wall.mul_f64(part.as_secs_f64() / total),
    };
    let timings = Timings {
        project,
        visibility: share(sums[0]),
        attributes: share(sums[1]),
        normalize: share(sums[2]),
    };
    (prepared.tally, timings)
}
