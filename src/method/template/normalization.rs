//! Normalize \[MOC08, section 3.2\]: divide the sums by the sum of weights.

use super::reconstruction::Gathered;
use crate::composite::sum;
use crate::frame::{Framebuffer, Plane};
use crate::method::clock::{Work, spend};
use crate::method::projection::{Has, world};
use crate::number::{Exact, Real, Vector3};
use crate::scene::Camera;
use crate::splat::View;

/// The surface that the picture is shaded from; with normals if `normals` says so.
pub(super) fn normalize<R: Exact>(
    gathered: &Plane<Gathered<R>>,
    camera: &Camera,
    has: Has,
    normals: bool,
) -> Framebuffer<R> {
    spend(Work::Normalize);
    let view = View::new(camera);
    Framebuffer {
        width: camera.width,
        height: camera.height,
        depth: gathered.map(depth),
        id: gathered.map(|pixel| pixel.id),
        weight: gathered.map(|pixel| pixel.weight),
        normal: normals.then(|| gathered.map(|pixel| normal(&view, pixel))),
        color: has.color.then(|| gathered.map(|pixel| sum::average(pixel.colors, pixel.weight))),
        stencil: None,
        margin: None,
    }
}

/// The average depth; +inf where nothing was gathered.
pub(crate) fn depth<R: Real>(pixel: &Gathered<R>) -> R {
    R::select(pixel.weight.gt(R::ZERO), pixel.depths / pixel.weight, R::INFINITY)
}

/// The direction of the average normal, world space.
pub(crate) fn normal<R: Real>(view: &View<R>, pixel: &Gathered<R>) -> [R; 3] {
    let [x, y, z] = sum::average(pixel.normals, pixel.weight);
    world(view, Vector3::new(x, y, z))
}
