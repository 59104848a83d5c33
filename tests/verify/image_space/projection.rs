//! Projection to single pixels.

use super::Client;
use super::bug::Bug;
use super::levels::{Level, Record};
use crate::verify::client::habit::Habit;
use crate::verify::client::number::{Number, Vector};

/// The largest radius in pixels, 2^48.
const LARGEST_RADIUS: f32 = f32::from_bits((127 + 48) << 23);

/// What a pixel keeps of a surfel; what a level of the templates keeps of a centre.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    pub(super) id: u32,
    pub(super) depth: Number,
    /// In world units.
    pub(super) radius: Number,
    /// The radius in pixels.
    pub(super) extent: Number,
    /// Column and row, in pixels.
    pub(super) center: [Number; 2],
    /// Towards the viewer, view space.
    pub(super) normal: Vector,
    pub(super) color: Vector,
}

impl Record for Sample {
    fn map(self, f: impl Fn(Number) -> Number) -> Self {
        Self {
            id: self.id,
            depth: f(self.depth),
            radius: f(self.radius),
            extent: f(self.extent),
            center: self.center.map(&f),
            normal: self.normal.map(&f),
            color: self.color.map(&f),
        }
    }
}

/// The nearest surfel of each pixel.
pub(super) fn project(client: &Client<'_>) -> Level<Sample> {
    let [width, height] = client.shared.size;
    let mut samples = Level::made([width, height], |_| None);
    let count = client.shared.scene.surfels.len();
    for surfel in 0..count {
        if client.has(Bug::SurfelMissing) && surfel == count / 2 {
            continue;
        }
        if let Some((sample, [x, y])) = sample(client, surfel) {
            let kept = &mut samples.cells[y * width as usize + x];
            if kept.is_none_or(|kept| nearer(client, &sample, &kept)) {
                *kept = Some(sample.map(Number::stored));
            }
        }
    }
    samples
}

/// Whether a later sample takes the place of an earlier one.
fn nearer(client: &Client<'_>, sample: &Sample, kept: &Sample) -> bool {
    let last = client.how.habit == Habit::TiesToTheLast;
    match client.how.bug {
        Some(Bug::NoDepthTest) => true,
        Some(Bug::DepthTestReversed) => sample.depth > kept.depth,
        Some(Bug::TiesReversed) => sample.depth <= kept.depth,
        _ => sample.depth < kept.depth || (last && sample.depth == kept.depth),
    }
}

/// A surfel and its pixel, if it is seen.
fn sample(client: &Client<'_>, surfel: usize) -> Option<(Sample, [usize; 2])> {
    let (shared, surfels) = (&client.shared, &client.shared.scene.surfels);
    let p = shared.point(surfels.position()[surfel]);
    let n = match client.how.bug {
        Some(Bug::NormalInWorld) => shared.vector(surfels.normal()[surfel].to_array()),
        _ => shared.direction(surfels.normal()[surfel]),
    };
    let t = -p[2];
    if !(t > shared.near) {
        return None;
    }
    let perspective = shared.perspective;
    let m = if perspective { t.reciprocal() } else { client.number(1.0) };
    let (a, b) = if perspective { (p[0] * m, p[1] * m) } else { (p[0], p[1]) };
    let cx =
        if client.has(Bug::PrincipalPointOff) { shared.cx + client.number(0.5) } else { shared.cx };
    let (x, y) = (cx + shared.fx * a, shared.cy - shared.fy * b);
    let g = if perspective { (n[0] * a + n[1] * b) - n[2] } else { -n[2] };
    let culled = match client.how.bug {
        Some(Bug::CullingIgnored) => false,
        Some(Bug::CullingInverted) => shared.cull && g.value <= 0.0,
        _ => shared.cull && g.value >= 0.0,
    };
    if culled || ![x, y, t, g].iter().all(|number| number.value.is_finite()) {
        return None;
    }
    let pixel = pixel(client, [x.value, y.value])?;
    let radius = client.number(surfels.radius()[surfel]);
    let turned = g.value > 0.0 && !client.has(Bug::BackNotReversed);
    let color = surfels.color().map_or([0.0; 3], |color| color[surfel].to_array());
    let sample = Sample {
        id: u32::try_from(surfel).unwrap(),
        depth: if client.has(Bug::DepthOfNearPoint) { t - radius } else { t },
        radius,
        extent: extent(
            client,
            radius,
            if client.has(Bug::ExtentNotByDepth) { client.number(1.0) } else { m },
        ),
        center: [x, y],
        normal: if turned { n.map(|n| -n) } else { n },
        color: shared.vector(color),
    };
    Some((sample, pixel))
}

/// The pixel of a point in the picture.
fn pixel(client: &Client<'_>, [x, y]: [f32; 2]) -> Option<[usize; 2]> {
    let [width, height] = client.shared.size.map(|side| side as f32);
    let seen = x >= 0.0 && x < width && y >= 0.0 && y < height;
    let half = if client.has(Bug::HalfPixelOff) { 0.5 } else { 0.0 };
    // The conversion is the floor; of what is negative it is 0.
    seen.then_some([(x - half) as usize, (y - half) as usize])
}

/// The radius in pixels.
fn extent(client: &Client<'_>, radius: Number, m: Number) -> Number {
    let focal = (client.shared.fx * client.shared.fy).sqrt();
    let extent = radius * (focal * m);
    let extent = if client.has(Bug::ExtentIsDiameter) { extent * 2.0 } else { extent };
    extent.smaller(client.number(LARGEST_RADIUS))
}
