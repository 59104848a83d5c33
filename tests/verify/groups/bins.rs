//! Bins of depth, and the Voronoi-enhanced depth.

use super::Client;
use super::bug::Bug;
use super::manner::Manner;
use crate::verify::client::number::Number;
use splatref::method::single_pass::BinCount;
use splatref::scene::{Camera, Scene};
use splatref::splat::{Epsilon, SplatSettings};

/// The range of depth, and into how many bins it is divided: what the host hands to the shaders.
#[derive(Clone, Copy)]
pub(super) struct Bins {
    near: f32,
    far: f32,
    count: f32,
}

impl Bins {
    /// The bins of a picture; everything here is in f64 and rounded once.
    pub(super) fn new(
        scene: &Scene,
        camera: &Camera,
        settings: &SplatSettings,
        count: BinCount,
        bug: Option<Bug>,
    ) -> Self {
        let (center, radius) = sphere(scene, bug);
        let view = camera.view_from_world.to_cols_array().map(f64::from);
        let [x, y, z] = center;
        let depth = -(((view[2] * x + view[6] * y) + view[10] * z) + view[14]);
        let clip = f64::from(camera.near);
        let nearest = depth - radius;
        let nearest =
            if nearest < clip || bug == Some(Bug::RangeFromNear) { clip } else { nearest };
        let (near, far) = (nearest as f32, (depth + radius) as f32);
        let far = if far > near { far } else { near.next_up() };
        let count = match count {
            BinCount::Count(count) => count as f32,
            BinCount::Epsilon => {
                let count = (f64::from(far) - f64::from(near)) / epsilon(scene, settings);
                let count = count.ceil() as f32;
                if count > 1.0 { count } else { 1.0 }
            }
        };
        let more = if bug == Some(Bug::BinCountOff) { 1.0 } else { 0.0 };
        Self { near, far, count: count + more }
    }

    /// The bin of a depth.
    fn bin(&self, client: &Client<'_>, t: Number) -> Number {
        let shared = &client.shared;
        let (near, far) = (shared.number(self.near), shared.number(self.far));
        let count = shared.number(self.count);
        let position = match (client.how.bug, client.how.manner) {
            (Some(Bug::BinOfNearness), _) => {
                let of = |t: Number| shared.nearness(t);
                ((of(t) - of(near)) / (of(far) - of(near))) * count
            }
            (_, Manner::BinsByFactor) => (t - near) * (count / (far - near)),
            _ => ((t - near) / (far - near)) * count,
        };
        let bin = match client.how.bug {
            Some(Bug::BinRounded) => position.value.round(),
            Some(Bug::BinCeiled) => position.value.ceil(),
            Some(Bug::BinIgnored) => 0.0,
            _ => position.value.floor(),
        };
        shared.number(bin).clamped(shared.number(0.0), count)
    }

    /// The Voronoi-enhanced depth of a fragment.
    pub(super) fn voronoi(&self, client: &Client<'_>, q: Number, t: Number) -> f32 {
        let shared = &client.shared;
        let square = shared.cutoff * shared.cutoff;
        let ratio = match (client.how.bug, client.how.manner) {
            (Some(Bug::RatioMissing), _) => shared.number(0.0),
            (Some(Bug::RatioSquared), _) => q / square,
            (Some(Bug::RatioNotByCutoff), _) => q.sqrt(),
            (Some(Bug::RatioReversed), _) => shared.number(1.0) - (q / square).sqrt(),
            (_, Manner::RatioOfRoots) => q.sqrt() / shared.cutoff,
            _ => (q / square).sqrt(),
        };
        let most = if client.has(Bug::RatioUncapped) { 1.0 } else { 255.0 / 256.0 };
        let ratio = ratio.smaller(shared.number(most));
        let bin = self.bin(client, t);
        let depth = if client.has(Bug::RatioSign) { bin - ratio } else { bin + ratio };
        match client.how.bug {
            Some(Bug::VoronoiInDepths) => depth.value / self.count,
            _ => depth.value,
        }
    }
}

/// Epsilon in world units, as the host knows it; the median is the lower one.
fn epsilon(scene: &Scene, settings: &SplatSettings) -> f64 {
    f64::from(match settings.epsilon {
        Epsilon::World(depth) => depth,
        Epsilon::MedianRadii(count) => {
            let mut radii = scene.surfels.radius().to_vec();
            radii.sort_by(f32::total_cmp);
            count * radii[(radii.len() - 1) / 2]
        }
    })
}

/// A sphere around all discs: the middle of the box around their centres, and how far they reach.
fn sphere(scene: &Scene, bug: Option<Bug>) -> ([f64; 3], f64) {
    let surfels = &scene.surfels;
    let position = |i: usize| surfels.position()[i].to_array().map(f64::from);
    let all = 0..surfels.len();
    let center = [0, 1, 2].map(|axis| {
        let mut along: Vec<f64> = all.clone().map(|i| position(i)[axis]).collect();
        along.sort_by(f64::total_cmp);
        (along[0] + along[along.len() - 1]) * 0.5
    });
    let mut radius = 0.0;
    for i in all {
        let [x, y, z] = [0, 1, 2].map(|axis| position(i)[axis] - center[axis]);
        let disc = f64::from(surfels.radius()[i]);
        let disc = if bug == Some(Bug::RangeOfCenters) { 0.0 } else { disc };
        let reach = ((x * x + y * y) + z * z).sqrt() + disc;
        radius = if reach > radius { reach } else { radius };
    }
    (center, radius)
}
