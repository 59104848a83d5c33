//! The fast path for `f32`: the bits of [`super::plain`], from another layout.

use super::Settings;
use super::plain::{Geometry, store};
use crate::error::Result;
use crate::frame::{Exec, Framebuffer};
use crate::scene::group::Groups;
use crate::scene::{Camera, Surfels};
use crate::splat::Tally;
use std::time::{Duration, Instant};

/// Draws a scene into a framebuffer: the geometry pass, the compositing pass and the normalization.
///
/// # Errors
/// [`crate::Error::Invalid`] if the Voronoi depth test takes too many bins.
///
/// # Panics
/// If the framebuffer has not the size of the camera's picture.
pub fn render(
    surfels: &Surfels,
    groups: &Groups,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    target: &mut Framebuffer<f32>,
) -> Result<(Tally, [(&'static str, Duration); 2])> {
    assert_eq!((target.width, target.height), (camera.width, camera.height), "framebuffer size");
    let start = Instant::now();
    let geometry = Geometry::<f32>::project(surfels, groups, camera, settings, exec)?;
    let projection = start.elapsed();
    let start = Instant::now();
    geometry.each_tile(target, exec, |index, mut tile| {
        let images = geometry.images(index, tile.rect);
        store(&geometry.composite(&images), &mut tile);
    });
    Ok((geometry.tally(), [("projection", projection), ("groups", start.elapsed())]))
}
