//! A second implementation of what a view draws of a hierarchy, from the pages of the crate alone; and its bugs.

#![expect(clippy::disallowed_methods, reason = "a client of its own; no number here is NaN or -0")]

use splatref::frame::Exec;
use splatref::io::hierarchy::{Hierarchy, NONE, Node};
use splatref::scene::{Cloud, Primitives, Scene, Sides, Surfels, Triangles, Vertices};

/// What may be wrong with a client, or only its own way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Way {
    Plain,
    /// All in `f32`, which is lawful where every limit is far enough.
    Single,
    /// The size is so much too large.
    Size(f64),
    /// `r_m` is.
    Distance(f64),
    /// The radius is, once everything has been chosen.
    Radius(f64),
    Floor,
    Round,
    /// One shrinks while the other grows.
    CrossFade,
    /// The finer ones take over at once, where all surfels are asked for, or 1.3 times as many.
    SwitchAt(f64),
    /// The fade begins where half of the surfels are asked for, and ends where all are.
    FadesEarly,
    /// The finer ones have half of their weight.
    HalfWeight,
    /// The finer ones are whole as soon as they are there.
    NoWeight,
    /// A finer one needs at least half a surfel by its weight.
    NoLeast,
    /// Triangles are drawn where their weight is 1, or never, or always.
    TrianglesLate,
    NoTriangles,
    AllTriangles,
    /// Fewer discs are larger: those that are drawn cover.
    Covering,
    /// Discs shrink with their number.
    Shrinking,
    /// Discs do not grow where nothing is finer, or their squares do not.
    NoGrowth,
    SmallSquares,
    /// The radius as the paper prints it: s / (2 `d_p`).
    AsPrinted,
    /// The scale of the object has no part in the radius, or none in the width of a pixel.
    NoScale,
    WorldPixel,
}

/// Every bug of the list. Those that are off are a little more off than what they turn is from its limit.
pub(crate) const BUGS: [Way; 27] = [
    Way::Size(1e-5),
    Way::Size(-1e-5),
    Way::Distance(1e-5),
    Way::Distance(-1e-5),
    Way::Distance(2.5e-6),
    Way::Distance(-2.5e-6),
    Way::Radius(1.2e-4),
    Way::Radius(-1.2e-4),
    Way::Floor,
    Way::Round,
    Way::CrossFade,
    Way::SwitchAt(1.0),
    Way::SwitchAt(1.3),
    Way::FadesEarly,
    Way::HalfWeight,
    Way::NoWeight,
    Way::NoLeast,
    Way::TrianglesLate,
    Way::NoTriangles,
    Way::AllTriangles,
    Way::Covering,
    Way::Shrinking,
    Way::NoGrowth,
    Way::SmallSquares,
    Way::AsPrinted,
    Way::NoScale,
    Way::WorldPixel,
];

/// What is drawn of a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drawn {
    pub(crate) count: u32,
    radius: f64,
    side: f64,
    triangles: bool,
    /// The weight of what is finer.
    finer: f64,
}

impl Way {
    /// A number as the client has it.
    fn number(self, v: f64) -> f64 {
        if self == Self::Single { f64::from(v as f32) } else { v }
    }

    /// The share of the way to what is finer, the share of the own surfels, and the weight of what is finer.
    fn fade(self, share: f64, finer: bool) -> [f64; 2] {
        if !finer {
            return [1.0, 0.0];
        }
        let fade = match self {
            Self::SwitchAt(limit) => f64::from(u8::from(share >= limit)),
            Self::FadesEarly => (2.0 * share - 1.0).clamp(0.0, 1.0),
            _ => self.number(self.number(share - 1.0) / 0.3).clamp(0.0, 1.0),
        };
        match self {
            Self::CrossFade => [1.0 - fade, fade],
            Self::HalfWeight => [(2.0 * (1.0 - fade)).min(1.0), fade],
            Self::NoWeight => [(2.0 * (1.0 - fade)).min(1.0), f64::from(u8::from(fade > 0.0))],
            _ => [self.number(2.0 * (1.0 - fade)).min(1.0), (2.0 * fade).min(1.0)],
        }
    }

    /// What an orthographic view with the focal length 1 draws of a node in the scale k, of discs of this size.
    fn node(self, node: &Node, (size, k): (f64, f64), weight: f64) -> Drawn {
        let of = |v| self.number(v);
        let triangles = node.triangles > 0;
        let finer = !node.children.is_empty() || triangles;
        let size = if let Self::Size(off) = self { size * (1.0 + off) } else { size };
        let pixel = if self == Self::WorldPixel { 1.0 } else { of(1.0 / k) };
        let r = if self == Self::AsPrinted { size / (2.0 * pixel) } else { of(size * pixel) / 2.0 };
        let n = f64::from(node.surfels);
        if node.surfels == 0 {
            return Drawn { count: 0, radius: 0.0, side: 0.0, triangles: true, finer: weight };
        }
        let (p_m, mut r_m) = (f64::from(node.estimate.count), f64::from(node.estimate.distance));
        if let Self::Distance(off) = self {
            r_m *= 1.0 + off;
        }
        let q = of(r_m / r);
        let asked = of(p_m * of(q * q));
        let [own, fade] = self.fade(of(asked / n), finer);
        let share = of(weight * own);
        let exact = of(share * asked.min(n));
        let count = match self {
            Self::Floor => exact.floor(),
            Self::Round => exact.round(),
            _ => exact.ceil(),
        };
        let nothing = share == 0.0 || (self == Self::NoLeast && exact < 0.5);
        let count = if nothing { 0.0 } else { count.clamp(1.0, n) };
        let all = of(r_m * of(p_m / n).sqrt());
        let (mut radius, mut side) = (r, size);
        if all > r && self != Self::NoGrowth {
            side *= if self == Self::SmallSquares { 1.0 } else { all / r };
            radius = all;
        }
        radius *= match self {
            Self::Covering if count > 0.0 => (asked.min(n) / count).sqrt(),
            Self::Shrinking if share > 0.0 => share.sqrt(),
            Self::Radius(off) => 1.0 + off,
            _ => 1.0,
        };
        let finer = of(weight * fade);
        let triangles = match self {
            Self::TrianglesLate => finer >= 1.0,
            Self::NoTriangles => false,
            Self::AllTriangles => true,
            _ => finer > 0.0,
        };
        let k = if self == Self::NoScale { 1.0 } else { k };
        Drawn { count: count as u32, radius: radius * k, side, triangles, finer }
    }

    /// What is drawn of each node of a hierarchy of one object, in the order of the nodes.
    pub(crate) fn choose(self, hierarchy: &Hierarchy, size: f64) -> Vec<Drawn> {
        let k = hierarchy.objects()[0].place.scale;
        let mut all: Vec<Drawn> = Vec::new();
        for node in hierarchy.nodes() {
            let weight = if node.parent == NONE { 1.0 } else { all[node.parent as usize].finer };
            all.push(self.node(node, (size, k), weight));
        }
        all
    }

    /// A scene of that: surfels in the order of the nodes, and triangles.
    pub(crate) fn scene(self, hierarchy: &Hierarchy, size: f64, like: &Scene) -> Scene {
        let k = hierarchy.objects()[0].place.scale;
        let mut cloud = Cloud {
            normal: Some(Vec::new()),
            radius: Some(Vec::new()),
            color: Some(Vec::new()),
            ..Cloud::default()
        };
        let mut vertices = Vertices { color: Some(Vec::new()), ..Vertices::default() };
        let (mut corners, mut runs) = (Vec::new(), Vec::new());
        for (number, drawn) in (0..).zip(self.choose(hierarchy, size)) {
            if drawn.count > 0 {
                runs.push((cloud.position.len() as u32, Some(drawn.side as f32)));
                let own = hierarchy.surfels(number, drawn.count).unwrap();
                let radii = vec![drawn.radius as f32; own.position.len()];
                cloud.position.extend(own.position.iter().map(|p| *p * k as f32));
                cloud.normal.iter_mut().for_each(|all| all.extend(own.normal.iter().flatten()));
                cloud.radius.iter_mut().for_each(|all| all.extend(&radii));
                cloud.color.iter_mut().for_each(|all| all.extend(own.color.iter().flatten()));
            }
            if drawn.triangles {
                let (own, triangles) = hierarchy.triangles(number).unwrap().into_parts();
                let first = vertices.position.len() as u32;
                corners.extend(triangles.into_iter().map(|all| all.map(|i| i + first)));
                vertices.position.extend(own.position.iter().map(|p| *p * k as f32));
                vertices.direction.extend(own.direction);
                vertices.radius.extend(own.radius);
                vertices.color.iter_mut().for_each(|all| all.extend(own.color.iter().flatten()));
            }
        }
        let triangles = Triangles::new(vertices, corners).unwrap().0;
        let primitives = Primitives { triangles, ..Primitives::default() };
        let surfels = Surfels::new_with(cloud, &Exec::sequential()).unwrap().0;
        let sides = Some(Sides::new(runs).unwrap());
        Scene { surfels, primitives, sides, objects: None, ..like.clone() }
    }
}
