//! The two geometry passes: nearest fragments, then sums.

use super::bug::Bug;
use super::habit::Habit;
use super::number::{Number, scrambled, sum};
use super::project::Splat;
use super::targets::{Sums, Targets};
use super::view::Shared;
use splatref::splat::Outline;

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pass {
    Visibility,
    Attributes,
}

/// q and nearness of a splat at the centre of a pixel.
pub(crate) fn fragment(
    shared: &Shared<'_>,
    splat: &Splat,
    [x, y]: [u32; 2],
    pass: Pass,
) -> (Number, Number) {
    let half = shared.number(if shared.how.has(Bug::NoHalfPixel) { 0.0 } else { 0.5 });
    let offset = |pixel: u32, center: Number| sum(shared.number(pixel as f32), half, -center);
    let (dx, dy) = (offset(x, splat.center[0]), offset(y, splat.center[1]));
    let u = splat.ux * dx + splat.uy * dy;
    let v = splat.vy * dy;
    let form = u * u + v * v;
    let plane = sum(splat.w0, splat.wx * dx, splat.wy * dy);
    let w = match shared.how.bug {
        Some(Bug::DepthOfCenter) => splat.w0,
        Some(Bug::DepthClampMissing) => plane,
        _ => plane.clamped(splat.w_far, splat.w_near),
    };
    if shared.outline != Outline::RayCast {
        return (form, w);
    }
    let nearest = shared.nearness(shared.near);
    let q = if !shared.perspective {
        if plane <= nearest { form } else { shared.number(f32::INFINITY) }
    } else if plane.value > 0.0 && plane <= nearest {
        let affine = shared.how.has(Bug::RaysAffine) && pass == Pass::Attributes;
        let w = if affine { splat.w0 } else { plane };
        form / (w * w)
    } else {
        shared.number(f32::INFINITY)
    };
    if shared.low_pass.value > 0.0 {
        let filter = (dx * dx + dy * dy) / shared.low_pass;
        (q.smaller(filter), w)
    } else {
        (q, w)
    }
}

pub(crate) fn inside(shared: &Shared<'_>, q: Number) -> bool {
    if shared.how.has(Bug::RimOutside) { q < shared.limit } else { q <= shared.limit }
}

pub(crate) fn weight(shared: &Shared<'_>, splat: &Splat, q: Number) -> Number {
    let exp = match shared.how.bug {
        Some(Bug::ExpWithoutHalf) => (-q).exp(),
        Some(Bug::FastExp) => (q * -0.5).exp() * (1.0 + 1e-4),
        _ => (q * -0.5).exp(),
    };
    splat.amplitude * exp
}

/// The depth of a nearness.
pub(crate) fn depth(shared: &Shared<'_>, w: Number) -> Number {
    if !shared.perspective {
        return -w;
    }
    match shared.how.habit {
        Habit::DepthByNewton => {
            let table = shared.number(f32::from_bits((1.0 / w.value).to_bits() & !0xFF));
            table * (shared.number(2.0) - w * table)
        }
        _ => w.reciprocal(),
    }
}

/// What the depth buffer holds of a nearness.
pub(crate) fn stored(shared: &Shared<'_>, w: Number) -> f32 {
    if !shared.how.has(Bug::Depth16) {
        return w.value;
    }
    let near = shared.near.value;
    let greatest = if shared.perspective { 1.0 / near } else { -4096.0 * near };
    (w.value / greatest * 65_535.0).round_ties_even() / 65_535.0 * greatest
}

/// The pixels of a splat's quad.
pub(crate) fn pixels(shared: &Shared<'_>, splat: &Splat) -> impl Iterator<Item = [u32; 2]> + use<> {
    let ([x0, x1], [y0, y1]) = (splat.quad.x, splat.quad.y);
    let dropped = shared.how.has(Bug::TileDropped);
    let all = (y0..y1).flat_map(move |y| (x0..x1).map(move |x| [x, y]));
    all.filter(move |pixel| !dropped || pixel.map(|side| side / 16) != [1, 1])
}

/// Finds the nearest fragment of every pixel.
pub(crate) fn visibility(shared: &Shared<'_>, splats: &[Splat], targets: &mut Targets) {
    for splat in splats {
        for pixel in pixels(shared, splat) {
            let (q, w) = fragment(shared, splat, pixel, Pass::Visibility);
            let (inside, w) = (inside(shared, q), stored(shared, w));
            let at = targets.index(pixel);
            let nearest = targets.nearness[at];
            let last =
                shared.how.has(Bug::TiesReversed) || shared.how.habit == Habit::TiesToTheLast;
            let nearer = w > nearest || (last && w == nearest);
            if nearer && (inside || shared.how.has(Bug::DiscardedWriteDepth)) {
                targets.nearness[at] = w;
            }
            if inside && (nearer || shared.how.has(Bug::IdOfTheLast)) {
                targets.id[at] = splat.surfel;
            }
        }
    }
    for at in 0..targets.nearness.len() {
        let w = targets.nearness[at];
        let empty = w == shared.empty();
        let depth = match shared.how.bug {
            _ if empty => shared.number(f32::INFINITY),
            Some(Bug::DiscsMovedBack) => depth(shared, shared.number(w)) + shared.epsilon,
            Some(Bug::DiscsMovedForward) => depth(shared, shared.number(w)) - shared.epsilon,
            _ => depth(shared, shared.number(w)),
        };
        targets.depth[at] = depth.value;
    }
}

/// Whether a fragment belongs to the visible surface.
fn visible(shared: &Shared<'_>, w: Number, pixel: [u32; 2], targets: &Targets) -> bool {
    let at = targets.index(pixel);
    let (t, nearest) = (depth(shared, w), shared.number(targets.depth[at]));
    let nearness = shared.number(targets.nearness[at]);
    let bug = shared.how.bug.filter(|bug| *bug != Bug::EpsilonOfNearestRadius || shared.in_radii);
    match bug {
        Some(Bug::EpsilonSubtracted) => t <= nearest - shared.epsilon,
        Some(Bug::EpsilonStrict) => t < nearest + shared.epsilon,
        Some(Bug::EpsilonReversed) => t > nearest + shared.epsilon,
        Some(Bug::EpsilonOfNearness) => w >= nearness - shared.epsilon,
        Some(Bug::EpsilonOfDepthBuffer) if shared.perspective => {
            let z = |w: Number| shared.number(1.0) - w * shared.near;
            z(w) <= z(nearness) + shared.epsilon
        }
        Some(Bug::EpsilonAlongRay) => t <= nearest + shared.epsilon / shared.ray(pixel),
        Some(Bug::EpsilonOfNearestRadius) => {
            let radius = shared.scene.surfels.radius()[targets.id[at] as usize];
            t <= nearest + shared.number(shared.written) * radius
        }
        Some(Bug::DiscsMovedBack | Bug::DiscsMovedForward) => t <= nearest,
        _ => t <= nearest + shared.epsilon,
    }
}

/// The splats in the order in which they are blended.
fn order(shared: &Shared<'_>, splats: &[Splat]) -> Vec<Splat> {
    let mut order = splats.to_vec();
    match shared.how.habit {
        Habit::LastFirst => order.reverse(),
        Habit::Shuffled => order.sort_by_key(|splat| scrambled(splat.surfel.into())),
        _ => {}
    }
    if shared.how.has(Bug::SplatTwice) && !order.is_empty() {
        order.push(order[order.len() / 2]);
    }
    order
}

/// Adds what is visible.
pub(crate) fn attributes(shared: &Shared<'_>, splats: &[Splat], targets: &mut Targets) {
    for splat in order(shared, splats) {
        for pixel in pixels(shared, &splat) {
            let (q, w) = fragment(shared, &splat, pixel, Pass::Attributes);
            let at = targets.index(pixel);
            if !inside(shared, q) || !visible(shared, w, pixel, targets) {
                continue;
            }
            let weight = weight(shared, &splat, q);
            blend(shared, &splat, weight, &mut targets.sums[at]);
            if shared.how.has(Bug::NearestTwice) && splat.surfel == targets.id[at] {
                blend(shared, &splat, weight, &mut targets.sums[at]);
            }
        }
    }
}

/// The blend unit: sums of weight times value.
fn blend(shared: &Shared<'_>, splat: &Splat, weight: Number, sums: &mut Sums) {
    let surfels = &shared.scene.surfels;
    let add = |sum: f32, value: Number| {
        let sum = (shared.number(sum) + value).value;
        if shared.how.has(Bug::HalfSums) { half(sum) } else { sum }
    };
    let reversed = splat.back && !shared.how.has(Bug::NormalsNotReversed);
    let normal = surfels.normal()[splat.surfel as usize];
    let normal = (if reversed { -normal } else { normal }).to_array();
    for (sum, value) in sums.normal.iter_mut().zip(normal) {
        *sum = add(*sum, weight * value);
    }
    if let Some(color) = surfels.color() {
        for (sum, value) in sums.color.iter_mut().zip(color[splat.surfel as usize].to_array()) {
            *sum = add(*sum, weight * value);
            if shared.how.has(Bug::SumsSaturate) && *sum > 1.0 {
                *sum = 1.0;
            }
        }
    }
    sums.weight = add(sums.weight, shared.number(weight.value));
    sums.count = sums.count.saturating_add(1);
}

/// The nearest number of 16 bits.
pub(crate) fn half(value: f32) -> f32 {
    let exponent = (value.to_bits() >> 23) & 0xFF;
    let exponent = exponent.max(127 - 14); // the subnormals share a step
    let step = f32::from_bits((exponent - 10) << 23);
    let rounded = (value / step).round_ties_even() * step;
    if rounded.abs() > 65_504.0 { f32::INFINITY.copysign(value) } else { rounded }
}
