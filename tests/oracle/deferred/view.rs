//! What a frame draws of a world: the nodes that its camera takes, but for objects left out.
//!
//! By the page of levels of detail, node by node, without boxes. Given are the lists (`near`, `far`
//! and `gap` of each node) and the spheres around objects.

use crate::oracle::deferred::ids::Numbers;
use crate::oracle::deferred::model::Flags;
use crate::oracle::deferred::place::{Place, World};
use crate::oracle::kit::eye::V3;
use crate::oracle::kit::scene::surfels;
use splatref::frame::Exec;
use splatref::index::sequential::Sequential;
use splatref::scene::{Camera, Objects, Primitives, Projection, Sphere, Surfels};

/// A similarity, backwards.
fn into_geometry(objects: &Objects, object: usize, p: V3) -> V3 {
    let place = &objects.places()[object];
    let d = [0, 1, 2].map(|i| p[i] - place.translation[i]);
    [0, 1, 2].map(|i| {
        let column = place.rotation.col(i);
        ((column.x * d[0] + column.y * d[1]) + column.z * d[2]) / place.scale
    })
}

fn distance(a: V3, b: V3) -> f64 {
    let d = [0, 1, 2].map(|i| a[i] - b[i]);
    ((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]).sqrt()
}

/// 0 and +inf whatever the scale.
fn times(error: f32, scale: f64) -> f64 {
    if error == 0.0 { 0.0 } else { f64::from(error) * scale }
}

/// The factor of distances.
fn factor() -> f64 {
    1.0 - (-20.0_f64).exp2()
}

/// Whether a sphere in the world is in the picture, widened by so many pixels.
fn in_sight(camera: &Camera, (middle, radius): (V3, f64), wider: f64) -> bool {
    let row = |i| camera.view_from_world.row(i).to_array().map(f64::from);
    let [x, y, z] = [row(0), row(1), row(2)]
        .map(|m| ((m[0] * middle[0] + m[1] * middle[1]) + m[2] * middle[2]) + m[3]);
    let [fx, fy, cx, cy] = [camera.fx, camera.fy, camera.cx, camera.cy].map(f64::from);
    let (t, perspective) = (-z, camera.projection == Projection::Perspective);
    if t + radius <= f64::from(camera.near) {
        return false;
    }
    let sides = [
        (fx * x, cx, fx),
        (-(fx * x), f64::from(camera.width) - cx, fx),
        (-(fy * y), cy, fy),
        (fy * y, f64::from(camera.height) - cy, fy),
    ];
    sides.into_iter().all(|(along, border, f)| {
        let border = border + wider;
        if perspective {
            along + border * t >= -radius * (f * f + border * border).sqrt()
        } else {
            along + border >= -radius * f
        }
    })
}

/// What a camera takes of the nodes of an object.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Taken {
    /// How many have ids.
    pub(crate) first: u32,
    /// Which are drawn.
    pub(crate) nodes: Vec<u32>,
}

/// How far a camera is from an object: its eye there, scale, least distance.
struct Reach {
    eye: V3,
    scale: f64,
    least: f64,
    /// The distance of all nodes of an orthographic camera.
    flat: Option<f64>,
}

impl Reach {
    fn new(objects: &Objects, object: usize, camera: &Camera, threshold: f64) -> Self {
        let f = f64::from(camera.fx.max(camera.fy));
        let scale = if threshold == 0.0 { f64::INFINITY } else { f / threshold };
        let eye = into_geometry(objects, object, camera.eye().to_array());
        let k = objects.places()[object].scale;
        if camera.projection == Projection::Orthographic {
            return Self { eye, scale, least: 1.0 / k, flat: Some(1.0 / k) };
        }
        let Sphere { center: middle, radius } = objects.sphere(object as u32);
        let (c, radius) = (into_geometry(objects, object, middle.to_array()), radius / k);
        let far = distance([0.0; 3], c) + radius;
        let least = distance(c, eye) - radius - far * (-20.0_f64).exp2();
        Self { eye, scale, least: least.max(0.0), flat: None }
    }

    fn takes(&self, list: &Sequential, node: usize, at: V3) -> bool {
        let (near, far) = (list.near()[node], list.far()[node]);
        match self.flat {
            Some(r) => times(near, self.scale) <= r && r < times(far, self.scale),
            None => {
                let r = distance(at, self.eye);
                let limit = times(far, self.scale) + f64::from(list.gap()[node]);
                times(near, self.scale) <= r && factor() * r < limit
            }
        }
    }

    /// How many nodes are looked at: up to the last of which some later one may be taken.
    fn prefix(&self, list: &Sequential) -> usize {
        let all = list.far().len();
        let most = |of: &[f32], from: usize| of[from..].iter().copied().fold(0.0, f32::max);
        let open = |from: &usize| {
            let limit =
                times(most(list.far(), *from), self.scale) + f64::from(most(list.gap(), *from));
            factor() * self.least < limit
        };
        (0..all).filter(open).count()
    }
}

/// What a camera takes of an object with levels of detail; none: it has none.
pub(crate) fn taken(objects: &Objects, object: usize, camera: &Camera) -> Option<Taken> {
    let geometry = objects.geometry(object as u32);
    let detail = geometry.tree()?;
    let Sphere { center: middle, radius } = objects.sphere(object as u32);
    if !in_sight(camera, (middle.to_array(), radius), 16.0 + detail.threshold()) {
        return Some(Taken { first: 0, nodes: Vec::new() });
    }
    let reach = Reach::new(objects, object, camera, detail.threshold());
    let positions = geometry.surfels.position().iter().enumerate();
    let taken =
        positions.filter(|(i, p)| reach.takes(detail.list(), *i, p.to_array().map(f64::from)));
    let nodes: Vec<_> = taken.map(|(i, _)| i as u32).collect();
    let first = reach.prefix(detail.list()) as u32;
    assert!(nodes.iter().all(|node| *node < first), "a node beyond the first {first}");
    Some(Taken { first, nodes })
}

/// A frame's share of a world.
pub(crate) struct View {
    /// The ids of all that is looked at.
    pub(crate) numbers: Numbers,
    /// What may be drawn: object and surfel, ascending in their ids.
    pub(crate) every: Vec<(usize, u32)>,
    /// What may be drawn, placed.
    pub(crate) surfels: Surfels,
    /// The unit of epsilon.
    pub(crate) median: f32,
    /// What is beside the surfels, placed, of each object.
    pub(crate) primitives: Vec<Primitives>,
    /// Objects that pass 1 leaves out.
    pub(crate) left: Vec<bool>,
    pub(crate) colored: bool,
}

impl View {
    pub(crate) fn new(
        world: &World,
        frame: u32,
        camera: &Camera,
        (flags, share): (&Flags, f32),
    ) -> Self {
        let objects = world.objects().at(frame).expect("in range");
        let all: Vec<_> = (0..world.objects.len()).map(|o| taken(&objects, o, camera)).collect();
        let count = |(own, taken): (&u32, &Option<Taken>)| taken.as_ref().map_or(*own, |t| t.first);
        let counts: Vec<u32> = world.counts().iter().zip(&all).map(count).collect();
        let numbers = Numbers::new(&counts).expect("ids");
        let shown = |&(o, s): &(usize, u32)| all[o].as_ref().is_none_or(|t| t.nodes.contains(&s));
        let every: Vec<_> = numbers.every().into_iter().filter(shown).collect();
        let mut each = vec![0_u32; counts.len()];
        every.iter().for_each(|(o, _)| each[*o] += 1);
        let left: Vec<bool> = (0..counts.len())
            .map(|o| {
                let before = flags.selected(o);
                before > 0 && f64::from(before) <= f64::from(share) * f64::from(each[o])
            })
            .collect();
        let median = median(world, frame, &all);
        let primitives = objects.primitives().expect("few");
        let whole = all.iter().all(Option::is_none);
        let placed = if whole {
            objects.flattened(&Exec::sequential()).expect("few surfels").0
        } else {
            surfels(world.placed(frame, &every))
        };
        Self { numbers, every, surfels: placed, median, primitives, left, colored: world.colored() }
    }
}

/// The lower median of what is drawn: of objects without levels of detail their own median, as
/// often as they have surfels.
fn median(world: &World, frame: u32, taken: &[Option<Taken>]) -> f32 {
    let mut all = Vec::new();
    for (thing, taken) in world.objects.iter().zip(taken) {
        let radii = world.geometries[thing.geometry].radius();
        let place = Place::at(&thing.keys, frame);
        match taken {
            Some(t) => all.extend(t.nodes.iter().map(|n| place.radius(radii[*n as usize]))),
            None => all.extend(radii.iter().map(|_| place.radius(lower(radii.to_vec())))),
        }
    }
    lower(all)
}

/// The lower median; 0 of nothing.
fn lower(mut all: Vec<f32>) -> f32 {
    all.sort_by(f32::total_cmp);
    all.get(all.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
}
