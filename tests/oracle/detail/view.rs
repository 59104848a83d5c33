//! What a view draws of prefixes, of finer objects and within a budget: object by object.

use crate::oracle::kit::eye::{Eye, V3, wide};
use splatref::scene::objects::Detail;
use splatref::scene::objects::detail::prefix::Estimate;
use splatref::scene::{Camera, Objects, Similarity, Sphere};

/// What is drawn of an object.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Shown {
    /// Surfels, the first so many.
    pub(crate) count: u32,
    /// Whether its primitives are.
    pub(crate) primitives: bool,
    /// Radius and side of its discs, if it has a prefix.
    pub(crate) disc: Option<[f32; 2]>,
    /// How it came to that.
    pub(crate) state: State,
}

/// What the cases have to have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum State {
    #[default]
    Plain,
    Outside,
    Whole,
    /// Finer ones grow, or this one shrinks.
    Growing,
    Shrinking,
    Gone,
    Beyond,
}

/// What a camera asks of an object with a prefix.
struct Asked {
    /// `d_p` z, and z.
    pixel: f64,
    factor: f64,
    inside: bool,
}

fn matrix(place: &Similarity) -> [V3; 3] {
    [0, 1, 2].map(|i| place.rotation.row(i).to_array())
}

/// A point in its place.
pub(crate) fn placed(place: &Similarity, p: V3) -> V3 {
    let t = place.translation.to_array();
    let [x, y, z] = p.map(|c| c * place.scale);
    let m = matrix(place);
    [0, 1, 2].map(|i| m[i][0] * x + m[i][1] * y + m[i][2] * z + t[i])
}

/// A point in the coordinates of the geometry.
fn local(place: &Similarity, p: V3) -> V3 {
    let t = place.translation.to_array();
    let [x, y, z] = [0, 1, 2].map(|i| p[i] - t[i]);
    let m = matrix(place);
    [0, 1, 2].map(|i| (m[0][i] * x + m[1][i] * y + m[2][i] * z) / place.scale)
}

/// Whether a sphere in view space reaches into the picture, widened by `m` pixels.
fn inside(camera: &Camera, eye: &Eye, p: V3, radius: f64, m: f64) -> bool {
    let t = -p[2];
    if t + radius <= eye.near {
        return false;
    }
    let [width, height] = camera.size().map(f64::from);
    let sides = [
        (eye.fx, p[0], eye.cx),
        (eye.fx, -p[0], width - eye.cx),
        (eye.fy, -p[1], eye.cy),
        (eye.fy, p[1], height - eye.cy),
    ];
    !sides.into_iter().any(|(f, along, room)| {
        let c = room + m;
        if eye.perspective {
            f * along + c * t < -radius * (f * f + c * c).sqrt()
        } else {
            f * along + c < -radius * f
        }
    })
}

fn zone(zones: &[[f32; 2]], distance: f64) -> f64 {
    let zones: Vec<[f64; 2]> = zones.iter().map(|z| z.map(f64::from)).collect();
    let before = zones.iter().rev().find(|z| z[0] <= distance);
    let after = zones.iter().find(|z| z[0] > distance);
    match (before, after) {
        (None, None) => 1.0,
        (None, Some(only)) | (Some(only), None) => only[1],
        (Some([a, from]), Some([b, to])) => from + (to - from) * ((distance - a) / (b - a)),
    }
}

/// The corners of the box around the surfels of a geometry and what its primitives use.
pub(crate) fn corners(objects: &Objects, object: u32) -> [V3; 2] {
    let geometry = objects.geometry(object);
    let triangles = &geometry.primitives.triangles;
    let used = triangles.corners().iter().flatten();
    let used = used.map(|&v| triangles.vertices().position[v as usize]);
    let all: Vec<V3> = geometry.surfels.position().iter().copied().chain(used).map(wide).collect();
    let of = |k: usize, better: fn(f64, f64) -> f64| all.iter().map(|p| p[k]).reduce(better);
    [f64::min, f64::max].map(|better| [0, 1, 2].map(|k| of(k, better).expect("a point")))
}

fn asked(objects: &Objects, object: u32, camera: &Camera) -> Asked {
    let (eye, at, shifts) = Eye::middle(camera);
    let place = &objects.places()[object as usize];
    let f = eye.fx.max(eye.fy);
    let Sphere { center: middle, radius } = objects.sphere(object);
    let p = eye.point(middle.to_array());
    let t = -p[2];
    let wanted = objects.refinement();
    let distance = if eye.perspective && t <= radius {
        0.0
    } else {
        let far = if eye.perspective { t } else { 1.0 };
        let off = shifts.map(|shift| {
            let [x, y] = [eye.fx * (p[0] + shift) / far, eye.fy * p[1] / far];
            (x * x + y * y).sqrt()
        });
        (off[0].min(off[1]) - f * radius / far).max(0.0)
    };
    let factor = zone(&wanted.zones, distance);
    let [low, high] = corners(objects, object);
    let e = local(place, at);
    let closest = [0, 1, 2].map(|k| low[k].max(e[k].min(high[k])));
    let near = (-eye.point(placed(place, closest))[2]).max(eye.near);
    let pixel = if eye.perspective { near } else { 1.0 } / f / place.scale;
    let margin = 16.0 + f64::from(wanted.surfel_size) * factor;
    let of_eye = |shift: &f64| inside(camera, &eye, [p[0] + shift, p[1], p[2]], radius, margin);
    let inside = shifts.iter().any(of_eye);
    Asked { pixel: pixel * factor, factor, inside }
}

/// That of the order of an object's geometry, if it has one.
pub(crate) fn estimate(objects: &Objects, object: u32) -> Option<Estimate> {
    match objects.geometry(object).detail.as_ref()? {
        Detail::Prefix(prefix) => Some(prefix.estimate()),
        Detail::Tree(_) => None,
    }
}

/// What is drawn with a size, without a budget.
fn with_size(objects: &Objects, asked: &[Option<Asked>], size: f64) -> Vec<Shown> {
    let count = asked.len() as u32;
    let finer: Vec<bool> =
        (0..count).map(|o| (0..count).any(|f| objects.coarser(f) == Some(o))).collect();
    // The weights of what is finer than each, found from the roots down by asking above.
    fn below(objects: &Objects, o: u32, of: &dyn Fn(u32, f64) -> f64) -> f64 {
        let w = objects.coarser(o).map_or(1.0, |above| below(objects, above, of));
        of(o, w)
    }
    let wanted = |o: u32| {
        let (estimate, asked) = (estimate(objects, o)?, asked[o as usize].as_ref()?);
        let r = size * asked.pixel / 2.0;
        let q = f64::from(estimate.distance) / r;
        Some((f64::from(estimate.count) * (q * q), r))
    };
    let surfels = |o: u32| objects.geometry(o).surfels.len() as u32;
    let better = |o: u32| finer[o as usize] || !objects.geometry(o).primitives.is_empty();
    let fade = |o: u32| match wanted(o) {
        Some((p, _)) if better(o) => ((p / f64::from(surfels(o)) - 1.0) / 0.3).clamp(0.0, 1.0),
        Some(_) => 0.0,
        None => 1.0,
    };
    let to_finer = |o: u32, w: f64| w * (2.0 * fade(o)).min(1.0);
    let show = |o: u32| {
        let w = objects.coarser(o).map_or(1.0, |above| below(objects, above, &to_finer));
        let Some((p, r)) = wanted(o) else {
            let count = if w > 0.0 { surfels(o) } else { 0 };
            return Shown { count, primitives: w > 0.0, ..Shown::default() };
        };
        let asked = asked[o as usize].as_ref().expect("a prefix");
        if !asked.inside {
            return Shown { state: State::Outside, ..Shown::default() };
        }
        let n = f64::from(surfels(o));
        let own = w * (2.0 * (1.0 - fade(o))).min(1.0);
        let drawn = if own == 0.0 { 0.0 } else { (own * p.min(n)).ceil().max(1.0).min(n) };
        let (mut radius, mut side) = (r, size * asked.factor);
        let beyond = !better(o) && p > n;
        if p > n {
            let e = estimate(objects, o).expect("a prefix");
            radius = f64::from(e.distance) * (f64::from(e.count) / n).sqrt();
            side *= radius / r;
        }
        let k = objects.places()[o as usize].scale;
        let within = |v: f64| v.clamp(2.0_f64.powi(-100), 2.0_f64.powi(100)) as f32;
        let state = match fade(o) {
            _ if beyond => State::Beyond,
            0.0 => State::Whole,
            fade if fade < 0.5 => State::Growing,
            fade if fade < 1.0 => State::Shrinking,
            _ => State::Gone,
        };
        Shown {
            count: drawn as u32,
            primitives: to_finer(o, w) > 0.0,
            disc: Some([within(radius * k), within(side)]),
            state,
        }
    };
    (0..count).map(show).collect()
}

fn spent(shown: &[Shown]) -> u64 {
    shown.iter().filter(|s| s.disc.is_some()).map(|s| u64::from(s.count)).sum()
}

/// The size with which a view asks for so many surfels of an object, if it is in the middle zone.
pub(crate) fn size_for(objects: &Objects, camera: &Camera, object: u32, share: f32) -> Option<f32> {
    let estimate = estimate(objects, object)?;
    let n = objects.geometry(object).surfels.len() as f32;
    let radius = estimate.distance * (estimate.count as f32 / (share * n)).sqrt();
    let size = 2.0 * radius / asked(objects, object, camera).pixel as f32;
    (size > 1e-30 && size <= 4096.0).then_some(size)
}

/// What a camera sees of objects, how many steps of the size keep the budget, and how many objects are
/// in it with a part of what those would have.
pub(crate) fn model(objects: &Objects, camera: &Camera) -> (Vec<Shown>, u32, usize) {
    let all: Vec<Option<Asked>> = (0..objects.objects().len() as u32)
        .map(|o| estimate(objects, o).map(|_| asked(objects, o, camera)))
        .collect();
    let wanted = objects.refinement();
    let mut sizes = vec![f64::from(wanted.surfel_size)];
    (0..2048).for_each(|k| sizes.push(sizes[k] * (65.0 / 64.0)));
    let with = |k: u32| with_size(objects, &all, sizes[k as usize]);
    let Some(budget) = wanted.budget.map(u64::from) else { return (with(0), 0, 0) };
    if spent(&with(0)) <= budget {
        return (with(0), 0, 0);
    }
    let (mut few, mut many) = (2048, 0);
    while few - many > 1 {
        let k = u32::midpoint(few, many);
        if spent(&with(k)) <= budget { few = k } else { many = k }
    }
    let mut shown = with(few);
    let (mut left, mut parts) = (budget, 0);
    for one in shown.iter_mut().filter(|one| one.disc.is_some()) {
        let count = u64::from(one.count).min(left);
        parts += usize::from(count > 0 && count < u64::from(one.count));
        one.count = count as u32;
        left -= count;
    }
    (shown, few, parts)
}
