//! The planes that a client has handed in.

use crate::frame::Plane;
use crate::method::projection::planes::{components, vector};
use crate::method::projection::{Has, SampleKind};
use crate::method::pyramid::Cell;
use crate::method::pyramid::planes::{PULL, PUSH, SHADING};
use crate::method::{Holds, PlaneRow};
use crate::number::ball::Profile;
use crate::number::{Ball, Real, Vector2};
use crate::verdict::checks::{Report, input, inputs, number, triple, whole};
use crate::verdict::client::{Client, StoredPlane};

/// The cells of a level.
pub(super) type Level<P> = Plane<Cell<Ball<P>>>;

/// The planes of a level, each if it is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellPlanes<'a> {
    kind: Option<StoredPlane<'a, u8>>,
    front: Option<StoredPlane<'a, f64>>,
    back: Option<StoredPlane<'a, f64>>,
    extent: Option<StoredPlane<'a, f64>>,
    right: Option<StoredPlane<'a, f64>>,
    down: Option<StoredPlane<'a, f64>>,
    normal: Option<StoredPlane<'a, [f64; 3]>>,
    color: Option<StoredPlane<'a, [f64; 3]>>,
    tangent: Option<StoredPlane<'a, [f64; 3]>>,
}

impl<'a> CellPlanes<'a> {
    /// A level that the pull left.
    pub(super) fn pulled(client: &'a Client, level: usize) -> Self {
        Self::new(client, &PULL, level)
    }

    /// A level that the push left.
    pub(super) fn pushed(client: &'a Client, level: usize) -> Self {
        Self::new(client, &PUSH, level)
    }

    fn new(client: &'a Client, rows: &[PlaneRow; 9], level: usize) -> Self {
        let [kind, front, back, extent, right, down, normal, color, tangent] = rows;
        Self {
            kind: client.count_of(kind, level),
            front: client.scalar_of(front, level),
            back: client.scalar_of(back, level),
            extent: client.scalar_of(extent, level),
            right: client.scalar_of(right, level),
            down: client.scalar_of(down, level),
            normal: client.triple_of(normal, level),
            color: client.triple_of(color, level),
            tangent: client.triple_of(tangent, level),
        }
    }

    /// The names of the planes that are there.
    pub(super) fn names(&self) -> Vec<&'static str> {
        let there = [
            self.kind.map(|plane| plane.name),
            self.front.map(|plane| plane.name),
            self.back.map(|plane| plane.name),
            self.extent.map(|plane| plane.name),
            self.right.map(|plane| plane.name),
            self.down.map(|plane| plane.name),
            self.normal.map(|plane| plane.name),
            self.color.map(|plane| plane.name),
            self.tangent.map(|plane| plane.name),
        ];
        there.into_iter().flatten().collect()
    }

    /// A level as the next stage reads it, if its planes are all there.
    pub(super) fn level<P: Profile>(&self, size: [u32; 2], has: Has) -> Option<Level<P>> {
        let (kind, front, back, extent) = (self.kind?, self.front?, self.back?, self.extent?);
        let (right, down, normal) = (self.right?, self.down?, self.normal?);
        let (color, tangent) = (self.color, self.tangent);
        if (has.color && color.is_none()) || (has.tangent && tangent.is_none()) {
            return None;
        }
        let three = |plane: Option<StoredPlane<'_, [f64; 3]>>, has: bool, at| {
            plane.filter(|_| has).map_or([Ball::ZERO; 3], |plane| inputs(&plane, at))
        };
        Some(Plane::from_pixels(size, |x, y| {
            let (at, kind) = ((x, y), usize::from(*kind.plane.at(x, y)));
            Cell {
                // There is no other kind: what is not one was found wrong where it comes from.
                kind: SampleKind::ALL.get(kind).copied().unwrap_or_default(),
                front: input(&front, at),
                back: input(&back, at),
                extent: input(&extent, at),
                displacement: Vector2::new(input(&right, at), input(&down, at)),
                normal: vector(inputs(&normal, at)),
                tangent: vector(three(tangent, has.tangent, at)),
                color: three(color, has.color, at),
            }
        }))
    }

    /// Every plane at a cell against what may be there.
    pub(super) fn check<P: Profile>(
        &self,
        at: (u32, u32),
        truth: &Cell<Ball<P>>,
        report: &mut Report<'_>,
    ) {
        if let Some(plane) = &self.kind {
            whole(0, plane, at, truth.kind as u8, report);
        }
        let scalars = [
            (&self.front, truth.front),
            (&self.back, truth.back),
            (&self.extent, truth.extent),
            (&self.right, truth.displacement.x),
            (&self.down, truth.displacement.y),
        ];
        for (plane, truth) in scalars {
            if let Some(plane) = plane {
                number(0, plane, at, truth, report);
            }
        }
        let triples = [
            (&self.normal, Holds::Vector, components(truth.normal)),
            (&self.color, Holds::Color, truth.color),
            (&self.tangent, Holds::Vector, components(truth.tangent)),
        ];
        for (plane, holds, truth) in triples {
            if let Some(plane) = plane {
                triple(0, (plane, holds), at, truth, report);
            }
        }
    }
}

/// The planes of the picture, each if it is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct PicturePlanes<'a> {
    pub(super) shaded: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) alpha: Option<StoredPlane<'a, f64>>,
    pub(super) depth: Option<StoredPlane<'a, f64>>,
    pub(super) normal: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) tangent: Option<StoredPlane<'a, [f64; 3]>>,
    pub(super) kind: Option<StoredPlane<'a, u8>>,
}

impl<'a> PicturePlanes<'a> {
    pub(super) fn new(client: &'a Client) -> Self {
        let [shaded, alpha, depth, normal, tangent, kind] = &SHADING;
        Self {
            shaded: client.triple(shaded),
            alpha: client.scalar(alpha),
            depth: client.scalar(depth),
            normal: client.triple(normal),
            tangent: client.triple(tangent),
            kind: client.count(kind),
        }
    }
}
