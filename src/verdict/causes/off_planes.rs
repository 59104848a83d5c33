//! Reject a mistake without judging it: too many depths are off the planes of their surfels.
//!
//! Most mistakes change where splats end, or how fragments are added, but leave each depth on the plane
//! of its surfel. With such a mistake, and with another camera or other surfels, a pixel stays wrong if
//! its depth is off this plane by more than roundings. That is checked in nanoseconds; a verdict takes
//! microseconds a pixel.
//!
//! Depths are clamped to those of the disc. So only pixels count whose rays meet the disc itself.

use super::change::Change;
use super::epsilon::DEPTHS;
use super::sample::near;
use super::shown::Pixel;
use super::{Case, MOST_LEFT};
use crate::frame::Rect;
use crate::method::tiled::pixels;
use crate::scene::{Camera, Surfels};
use crate::splat::View;
use crate::verdict::client::Storage;
use crate::verdict::supposed::Supposed;

/// `Decided:` a depth that is off by more of itself is not a matter of rounding.
const OFF: f64 = 1e-3;
/// The part of a disc in which no depth is clamped.
const INSIDE: f64 = 0.99;

/// Pixels with surfel and depth in the part of the picture that is judged. None if no verdict on the
/// first wrong stages judges such depths by the surfels of the scene.
pub(super) fn in_part(case: &Case<'_, '_>) -> Option<Vec<Pixel>> {
    let client = case.client;
    let name = DEPTHS.into_iter().find(|name| client.frame().scalar(name).is_ok())?;
    let is_judged = near(case).any(|stage| stage.planes.contains(&name));
    let is_exact = matches!(client.storage(name), Storage::Single | Storage::Rounded);
    let surfels = &case.session.scene().surfels;
    let of_discs = case.session.method().splats().is_some() && surfels.tangents().is_none();
    if !is_judged || !is_exact || !of_discs || client.has_records() {
        return None;
    }
    let (depths, ids) =
        (client.frame().scalar(name).ok()?, client.frame().index(&name.replace('Z', "id")).ok()?);
    let whole = [(0, Rect::of_size([ids.width(), ids.height()]))];
    let pieces = client.part.as_deref().unwrap_or(&whole);
    let pixel =
        |(x, y)| Pixel { surfel: *ids.at(x, y) as usize, at: [x, y], depth: *depths.at(x, y) };
    let all = pieces.iter().flat_map(|(_, rect)| pixels(*rect)).map(pixel);
    Some(all.filter(|pixel| pixel.surfel < surfels.len() && pixel.depth.is_finite()).collect())
}

/// Whether a change leaves so many depths off their planes that it cannot explain the wrong pixels.
pub(super) fn rejects(case: &Case<'_, '_>, change: &Change) -> bool {
    let Some(pixels) = case.plane_depths() else { return false };
    let surfels = &case.session.scene().surfels;
    let off = match change {
        Change::Camera(camera) => count(pixels, camera, surfels),
        Change::Scene(scene, _) => count(pixels, case.camera, &scene.surfels),
        Change::Method(_) | Change::Ties(_) => count(pixels, case.camera, surfels),
        Change::Supposed(supposed) if keeps_planes(*supposed) => {
            count(pixels, case.camera, surfels)
        }
        _ => 0,
    };
    MOST_LEFT * off > case.all.near
}

/// The number of pixels with a depth off the plane of the surfel.
fn count(pixels: &[Pixel], camera: &Camera, surfels: &Surfels) -> u64 {
    let view = View::new(camera);
    pixels.iter().filter(|pixel| is_off(pixel, &view, surfels)).count() as u64
}

fn is_off(pixel: &Pixel, view: &View<f64>, surfels: &Surfels) -> bool {
    let reach = INSIDE * f64::from(surfels.radius()[pixel.surfel]);
    pixel.error(surfels, view).abs() > OFF && pixel.distance(surfels, view) < reach
}

/// Whether depths stay on the planes of surfels by another rule.
fn keeps_planes(supposed: Supposed) -> bool {
    matches!(
        supposed,
        Supposed::Limit(_)
            | Supposed::Mirrored
            | Supposed::Transposed
            | Supposed::FilterOnRadius
            | Supposed::DepthNotClamped
            | Supposed::Quads(_)
            | Supposed::QuadsWhole
            | Supposed::QuadsAtMost(_)
            | Supposed::Spread(_)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Exec;
    use crate::method::{Session, ewa};
    use crate::scene::Scene;
    use crate::source::Shape;
    use crate::verdict::client::Client;
    use crate::verdict::tests;

    #[test]
    fn depths_on_other_planes_are_counted() {
        let exec = Exec::new(2, 32).unwrap();
        let scene = Scene::unlit("", Shape::Sphere.surfels(400, 3).unwrap());
        let camera = tests::camera(Shape::Sphere, [96, 72], None);
        let session = Session::new(&scene, ewa::Settings::default().into(), &exec).unwrap();
        let frame = session.define::<f32>(&camera, true).unwrap().frame;
        let client = Client::from(&frame);
        let frame = client.frame();
        let (ids, depths) = (frame.index("visibility.id"), frame.scalar("visibility.Z"));
        let (ids, depths) = (ids.unwrap(), depths.unwrap());
        let shown = pixels(Rect::of_size([96, 72])).filter(|(x, y)| depths.at(*x, *y).is_finite());
        let pixel =
            |(x, y)| Pixel { surfel: *ids.at(x, y) as usize, at: [x, y], depth: *depths.at(x, y) };
        let all: Vec<_> = shown.map(pixel).collect();
        let off = |camera: &Camera| count(&all, camera, &scene.surfels);
        assert_eq!(off(&camera), 0, "clamped depths do not count");
        let wide = Camera { fx: 0.9 * camera.fx, fy: 0.9 * camera.fy, ..camera };
        assert!(4 * off(&wide) > all.len() as u64, "{} of {}", off(&wide), all.len());
    }
}
