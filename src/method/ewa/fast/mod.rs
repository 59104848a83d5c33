//! The fast path for `f32`: the bits of [`super::plain`], from another layout, see
//! [`crate::method`].

mod kernels;

use super::Settings;
use crate::frame::{Exec, Framebuffer};
use crate::method::fast::{draw, prepare};
use crate::scene::{Camera, Surfels};
use crate::splat::Tally;
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
    let prepared = prepare(surfels, camera, settings, (exec, &grid));
    let project = start.elapsed();
    let shared = &prepared.shared;
    let [visibility, attributes, normalize] = draw(&prepared, target, (exec, &grid), |tile| {
        let start = Instant::now();
        tile.visibility(shared);
        let visible = Instant::now();
        tile.limits(shared, prepared.epsilon);
        tile.attributes(shared);
        let added = Instant::now();
        tile.normalize(shared);
        [visible - start, added - visible, added.elapsed()]
    });
    (prepared.tally, Timings { project, visibility, attributes, normalize })
}
