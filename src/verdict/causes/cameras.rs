//! Estimate how another camera moved the picture, from the pixels that the client gave to each surfel.
//! A search cannot: errors fall only where splats meet again.

use crate::frame::Frame;
use crate::method::Session;
use crate::number::Vector3;
use crate::scene::Camera;
use crate::splat::View;
use crate::verdict::client::Client;
use glam::{DMat3, DVec2, DVec3};

/// The affine map from the right picture to the client's, about the principal point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moved {
    /// How X depends on X, on Y, and its shift in px.
    pub(super) x: DVec3,
    /// How Y does.
    pub(super) y: DVec3,
}

/// Fewer surfels show no map.
const FEWEST_SURFELS: usize = 32;
/// How often the worst pairs are left out. Occlusion moves the middle of what is seen of a surfel.
const ROUNDS: usize = 4;

/// The map that fits best, if the client tells surfels.
pub(super) fn moved(session: &Session<'_>, camera: &Camera, client: &Client) -> Option<Moved> {
    let mut pairs = pairs(session, camera, client.frame())?;
    let mut found = fitted(&pairs)?;
    for _ in 0..ROUNDS {
        let off = |(right, seen): &(DVec2, DVec2)| {
            let at = right.extend(1.0);
            DVec2::new(found.x.dot(at), found.y.dot(at)).distance_squared(*seen)
        };
        let mean = pairs.iter().map(off).sum::<f64>() / pairs.len() as f64;
        pairs.retain(|pair| off(pair) <= 2.0 * mean);
        found = fitted(&pairs)?;
    }
    Some(found)
}

/// For each surfel that the client shows, its centre and the middle of its pixels, from the principal
/// point on.
fn pairs(
    session: &Session<'_>,
    camera: &Camera,
    frame: &Frame<f64>,
) -> Option<Vec<(DVec2, DVec2)>> {
    let ids = ["visibility.id", "projection.id", "id"];
    let ids = ids.into_iter().find_map(|name| frame.index(name).ok())?;
    let (view, surfels) = (View::<f64>::new(camera), &session.scene().surfels);
    let mut seen = vec![DVec3::ZERO; surfels.len()];
    let width = ids.width() as usize;
    for (i, id) in ids.values().iter().enumerate() {
        if let Some(sum) = seen.get_mut(*id as usize) {
            let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            *sum += DVec3::new(x - view.cx, y - view.cy, 1.0);
        }
    }
    let pair = |(sum, position): (&DVec3, &glam::Vec3)| {
        let p = view.point(Vector3::from_glam(*position));
        let m = if view.perspective { 1.0 / -p.z } else { 1.0 };
        let right = DVec2::new(view.fx * p.x * m, -view.fy * p.y * m);
        (sum.z > 0.0 && right.is_finite()).then(|| (right, sum.truncate() / sum.z))
    };
    Some(seen.iter().zip(surfels.position()).filter_map(pair).collect())
}

/// The map with the least squares.
fn fitted(pairs: &[(DVec2, DVec2)]) -> Option<Moved> {
    if pairs.len() < FEWEST_SURFELS {
        return None;
    }
    let (mut squares, mut x, mut y) = (DMat3::ZERO, DVec3::ZERO, DVec3::ZERO);
    for (right, seen) in pairs {
        let at = right.extend(1.0);
        squares += DMat3::from_cols(at * at.x, at * at.y, at);
        x += at * seen.x;
        y += at * seen.y;
    }
    let back = squares.inverse();
    back.is_finite().then(|| Moved { x: back * x, y: back * y })
}
