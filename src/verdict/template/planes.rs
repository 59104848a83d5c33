//! The planes that a client has handed in.

use crate::frame::{NO_ID, Plane};
use crate::method::Holds;
use crate::method::projection::Has;
use crate::method::projection::planes::{components, vector};
use crate::method::template::Center;
use crate::method::template::planes::{GATHERED, LEVELS, NORMALIZATION, SHADING};
use crate::number::ball::Profile;
use crate::number::{Ball, Real, Vector2};
use crate::verdict::checks::{Report, input, inputs, number, triple, whole};
use crate::verdict::client::{Client, Storage, StoredPlane};

/// The planes of a level, each if it is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct CenterPlanes<'a> {
    id: Option<StoredPlane<'a, u32>>,
    depth: Option<StoredPlane<'a, f64>>,
    radius: Option<StoredPlane<'a, f64>>,
    extent: Option<StoredPlane<'a, f64>>,
    left: Option<StoredPlane<'a, f64>>,
    upper: Option<StoredPlane<'a, f64>>,
    normal: Option<StoredPlane<'a, [f64; 3]>>,
    color: Option<StoredPlane<'a, [f64; 3]>>,
}

impl<'a> CenterPlanes<'a> {
    pub(super) fn new(client: &'a Client, level: usize) -> Self {
        let [id, depth, radius, extent, left, upper, normal, color] = &LEVELS;
        Self {
            id: client.index_of(id, level),
            depth: client.scalar_of(depth, level),
            radius: client.scalar_of(radius, level),
            extent: client.scalar_of(extent, level),
            left: client.scalar_of(left, level),
            upper: client.scalar_of(upper, level),
            normal: client.triple_of(normal, level),
            color: client.triple_of(color, level),
        }
    }

    /// The names of the planes that are there.
    pub(super) fn names(&self) -> Vec<&'static str> {
        let there = [
            self.id.map(|plane| plane.name),
            self.depth.map(|plane| plane.name),
            self.radius.map(|plane| plane.name),
            self.extent.map(|plane| plane.name),
            self.left.map(|plane| plane.name),
            self.upper.map(|plane| plane.name),
            self.normal.map(|plane| plane.name),
            self.color.map(|plane| plane.name),
        ];
        there.into_iter().flatten().collect()
    }

    /// A level as the next stage reads it, if its planes are all there.
    pub(super) fn level<P: Profile>(&self, size: [u32; 2], has: Has) -> Option<Level<P>> {
        let (id, depth, radius, extent) = (self.id?, self.depth?, self.radius?, self.extent?);
        let (left, upper, normal) = (self.left?, self.upper?, self.normal?);
        if has.color && self.color.is_none() {
            return None;
        }
        Some(Plane::from_pixels(size, |x, y| {
            let at = (x, y);
            let color = self.color.filter(|_| has.color);
            Center {
                id: *id.plane.at(x, y),
                depth: input(&depth, at),
                radius: input(&radius, at),
                extent: input(&extent, at),
                center: Vector2::new(input(&left, at), input(&upper, at)),
                normal: vector(inputs(&normal, at)),
                color: color.map_or([Ball::ZERO; 3], |plane| inputs(&plane, at)),
            }
        }))
    }

    /// Every plane at a cell against what may be there.
    pub(super) fn check<P: Profile>(
        &self,
        at: (u32, u32),
        truth: &Center<Ball<P>>,
        report: &mut Report<'_>,
    ) {
        if let Some(plane) = &self.id {
            whole(0, plane, at, truth.id, report);
        }
        let scalars = [
            (&self.depth, truth.depth),
            (&self.radius, truth.radius),
            (&self.extent, truth.extent),
            (&self.left, truth.center.x),
            (&self.upper, truth.center.y),
        ];
        for (plane, truth) in scalars {
            if let Some(plane) = plane {
                number(0, plane, at, truth, report);
            }
        }
        if let Some(plane) = &self.normal {
            triple(0, (plane, Holds::Vector), at, components(truth.normal), report);
        }
        if let Some(plane) = &self.color {
            triple(0, (plane, Holds::Color), at, truth.color, report);
        }
    }
}

/// The centres of a level.
pub(super) type Level<P> = Plane<Center<Ball<P>>>;

/// The planes of the picture and of what was gathered for it, each if it is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct PicturePlanes<'a> {
    pub(super) count: Option<StoredPlane<'a, u8>>,
    pub(super) weight: Option<StoredPlane<'a, f64>>,
    pub(super) depths: Option<StoredPlane<'a, f64>>,
    pub(super) front: Option<StoredPlane<'a, f64>>,
    pub(super) radius: Option<StoredPlane<'a, f64>>,
    pub(super) normals: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) colors: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) id: Option<StoredPlane<'a, u32>>,
    pub(super) accumulator: Storage,
    /// The averages, and the weight again.
    pub(super) depth: Option<StoredPlane<'a, f64>>,
    pub(super) normal: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) weight_copy: Option<StoredPlane<'a, f64>>,
    /// The picture.
    pub(super) shaded: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) alpha: Option<StoredPlane<'a, f64>>,
}

/// A stage, and the planes that it judges.
type StagePlanes = (&'static str, Vec<&'static str>);

impl<'a> PicturePlanes<'a> {
    pub(super) fn new(client: &'a Client) -> Self {
        let [count, weight, depths, front, radius, normals, colors, id] = &GATHERED;
        let [depth, normal, copy] = &NORMALIZATION;
        let [shaded, alpha] = &SHADING;
        Self {
            count: client.count(count),
            weight: client.scalar(weight),
            depths: client.scalar(depths),
            front: client.scalar(front),
            radius: client.scalar(radius),
            normals: client.triple(normals),
            colors: client.triple(colors),
            id: client.index(id),
            accumulator: client.accumulator,
            depth: client.scalar(depth),
            normal: client.triple(normal),
            weight_copy: client.scalar(copy),
            shaded: client.triple(shaded),
            alpha: client.scalar(alpha),
        }
    }

    /// The stages, each with the planes that it judges; `gathers` says whether the gathering can be
    /// replayed.
    pub(super) fn stages(&self, gathers: bool) -> [StagePlanes; 3] {
        let scalar = |plane: &Option<StoredPlane<'_, f64>>| plane.map(|plane| plane.name);
        let triple = |plane: &Option<StoredPlane<'_, [f64; 3]>>| plane.map(|plane| plane.name);
        let sums = [
            self.count.map(|plane| plane.name),
            scalar(&self.weight),
            scalar(&self.depths),
            scalar(&self.front),
            scalar(&self.radius),
            triple(&self.normals),
            triple(&self.colors),
            self.id.map(|plane| plane.name),
        ];
        let sums = if gathers { sums.into_iter().flatten().collect() } else { Vec::new() };
        // Averages are judged from sums: the client's, or those of the gathering.
        let known = |own: bool| gathers || (own && self.weight.is_some());
        let averages = [
            scalar(&self.depth).filter(|_| known(self.depths.is_some())),
            triple(&self.normal).filter(|_| known(self.normals.is_some())),
            scalar(&self.weight_copy).filter(|_| known(true)),
        ];
        let shading = [triple(&self.shaded), scalar(&self.alpha)];
        [
            ("reconstruction", sums),
            ("normalization", averages.into_iter().flatten().collect()),
            ("shading", shading.into_iter().flatten().collect()),
        ]
    }

    /// Whether a pixel says that it is empty, or says nothing.
    pub(super) fn empty(&self, (x, y): (u32, u32)) -> Option<bool> {
        let id = self.id.map(|plane| *plane.plane.at(x, y) == NO_ID);
        let weight = self.weight.or(self.weight_copy);
        id.or(weight.map(|plane| *plane.plane.at(x, y) == 0.0))
            .or(self.depth.map(|plane| *plane.plane.at(x, y) == f64::INFINITY))
    }
}
