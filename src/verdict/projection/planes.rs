//! The planes of the projection that a client has handed in.

use crate::frame::{NO_ID, Plane};
use crate::method::projection::planes::{PLANES, components, vector};
use crate::method::projection::{Has, PixelSample, SampleKind};
use crate::method::{Holds, PlaneRow};
use crate::number::ball::Profile;
use crate::number::{Ball, Real, Vector2};
use crate::scene::Scene;
use crate::verdict::checks::{Report, input, inputs, number, triple, whole};
use crate::verdict::client::{Client, StoredPlane, Ties};

/// The planes of the projection, each if it is there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SamplePlanes<'a> {
    scene: &'a Scene,
    pub(super) ties: Ties,
    pub(super) depth: Option<StoredPlane<'a, f64>>,
    id: Option<StoredPlane<'a, u32>>,
    kind: Option<StoredPlane<'a, u8>>,
    normal: Option<StoredPlane<'a, [f64; 3]>>,
    extent: Option<StoredPlane<'a, f64>>,
    radius: Option<StoredPlane<'a, f64>>,
    left: Option<StoredPlane<'a, f64>>,
    upper: Option<StoredPlane<'a, f64>>,
    color: Option<StoredPlane<'a, [f64; 3]>>,
    tangent: Option<StoredPlane<'a, [f64; 3]>>,
}

/// What a client says is in a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PixelContent {
    /// It gives neither id, nor kind, nor depth.
    Nothing,
    Empty,
    /// This, which the scene may not have.
    Id(u32),
    /// Something, of this kind if it says so.
    Some(Option<SampleKind>),
    /// What is not judged, but for its kind, if that is known.
    Unjudged(Option<SampleKind>),
}

impl<'a> SamplePlanes<'a> {
    pub(crate) fn new(client: &'a Client, scene: &'a Scene) -> Self {
        let [id, kind, depth, normal, extent, radius, left, upper, color, tangent] = &PLANES;
        Self {
            scene,
            ties: client.ties,
            depth: client.scalar(depth),
            id: client.index(id),
            kind: client.count(kind),
            normal: client.triple(normal),
            extent: client.scalar(extent),
            radius: client.scalar(radius),
            left: client.scalar(left),
            upper: client.scalar(upper),
            color: client.triple(color),
            tangent: client.triple(tangent),
        }
    }

    /// Of a pass that leaves depths and ids alone.
    pub(crate) fn of_nearest(
        client: &'a Client,
        scene: &'a Scene,
        [depth, id]: [&PlaneRow; 2],
    ) -> Self {
        Self {
            scene,
            ties: client.ties,
            depth: client.scalar(depth),
            id: client.index(id),
            kind: None,
            normal: None,
            extent: None,
            radius: None,
            left: None,
            upper: None,
            color: None,
            tangent: None,
        }
    }

    /// The names of the planes that are there.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        let there = [
            self.id.map(|plane| plane.name),
            self.kind.map(|plane| plane.name),
            self.depth.map(|plane| plane.name),
            self.normal.map(|plane| plane.name),
            self.extent.map(|plane| plane.name),
            self.radius.map(|plane| plane.name),
            self.left.map(|plane| plane.name),
            self.upper.map(|plane| plane.name),
            self.color.map(|plane| plane.name),
            self.tangent.map(|plane| plane.name),
        ];
        there.into_iter().flatten().collect()
    }

    /// What a pixel is said to have; of some primitives it is not known what they come to.
    pub(super) fn says(&self, at: (u32, u32), unclear: &[u32]) -> PixelContent {
        if let Some(ids) = self.id {
            return match *ids.plane.at(at.0, at.1) {
                NO_ID => PixelContent::Empty,
                id if unclear.binary_search(&id).is_ok() => {
                    PixelContent::Unjudged(kind_of(self.scene, id))
                }
                id => PixelContent::Id(id),
            };
        }
        let says = match (self.kind, self.depth) {
            (Some(kinds), _) => match *kinds.plane.at(at.0, at.1) {
                0 => PixelContent::Empty,
                kind => PixelContent::Some(SampleKind::ALL.get(usize::from(kind)).copied()),
            },
            (None, Some(depths)) if *depths.plane.at(at.0, at.1) == f64::INFINITY => {
                PixelContent::Empty
            }
            (None, Some(_)) => PixelContent::Some(None),
            (None, None) => PixelContent::Nothing,
        };
        let sure =
            matches!(says, PixelContent::Empty | PixelContent::Some(Some(SampleKind::Surface)));
        if sure || unclear.is_empty() { says } else { PixelContent::Unjudged(None) }
    }

    /// Every plane at a pixel against a sample.
    pub(super) fn check<P: Profile>(
        &self,
        at: (u32, u32),
        sample: &PixelSample<Ball<P>>,
        report: &mut Report<'_>,
    ) {
        if let Some(plane) = &self.id {
            whole(0, plane, at, sample.id, report);
        }
        self.check_kind(at, Some(sample.kind), report);
        let scalars = [
            (&self.depth, sample.depth),
            (&self.extent, sample.extent),
            (&self.radius, sample.radius),
            (&self.left, sample.center.x),
            (&self.upper, sample.center.y),
        ];
        for (plane, truth) in scalars {
            if let Some(plane) = plane {
                number(0, plane, at, truth, report);
            }
        }
        let triples = [
            (&self.normal, Holds::Vector, components(sample.normal)),
            (&self.color, Holds::Color, sample.color),
            (&self.tangent, Holds::Vector, components(sample.tangent)),
        ];
        for (plane, holds, truth) in triples {
            if let Some(plane) = plane {
                triple(0, (plane, holds), at, truth, report);
            }
        }
    }

    /// The kind of a pixel, if it is known.
    pub(super) fn check_kind(
        &self,
        at: (u32, u32),
        kind: Option<SampleKind>,
        report: &mut Report<'_>,
    ) {
        if let (Some(plane), Some(kind)) = (&self.kind, kind) {
            whole(0, plane, at, kind as u8, report);
        }
    }

    /// Whether the next stage can be judged from the planes: depth, radius, extent, normal, and what
    /// else the scene has; with `places` id and place, else id or kind.
    fn complete(&self, has: Has, places: bool) -> bool {
        let numbers = self.depth.is_some() && self.radius.is_some() && self.extent.is_some();
        let place = if places {
            self.left.is_some() && self.upper.is_some() && self.id.is_some()
        } else {
            self.id.is_some() || self.kind.is_some()
        };
        let triples = self.normal.is_some()
            && (self.color.is_some() || !has.color)
            && (self.tangent.is_some() || !has.tangent);
        numbers && place && triples
    }

    /// The samples as the next stage reads them, if the planes are complete; `places` says whether
    /// ids and centres are needed.
    pub(crate) fn samples<P: Profile>(&self, places: bool) -> Option<Plane<PixelSample<Ball<P>>>> {
        let (has, depth) = (Has::of(self.scene), self.depth?);
        if !self.complete(has, places) {
            return None;
        }
        let size = [depth.plane.width(), depth.plane.height()];
        Some(Plane::from_pixels(size, |x, y| self.sample((x, y), has)))
    }

    fn sample<P: Profile>(&self, at: (u32, u32), has: Has) -> PixelSample<Ball<P>> {
        let id = self.id.map(|plane| *plane.plane.at(at.0, at.1));
        let stored = self.kind.map(|plane| *plane.plane.at(at.0, at.1));
        let kind = match (stored, id) {
            (Some(kind), _) => SampleKind::ALL.get(usize::from(kind)).copied(),
            (None, Some(id)) => kind_of(self.scene, id),
            (None, None) => None,
        };
        let scalar = |plane: &Option<StoredPlane<'_, f64>>| {
            plane.as_ref().map_or(Ball::ZERO, |plane| input(plane, at))
        };
        let three = |plane: &Option<StoredPlane<'_, [f64; 3]>>| {
            plane.as_ref().map_or([Ball::ZERO; 3], |plane| inputs(plane, at))
        };
        PixelSample {
            kind: kind.unwrap_or_default(),
            id: id.unwrap_or(NO_ID),
            depth: scalar(&self.depth),
            radius: scalar(&self.radius),
            extent: scalar(&self.extent),
            center: Vector2::new(scalar(&self.left), scalar(&self.upper)),
            normal: vector(three(&self.normal)),
            tangent: if has.tangent {
                vector(three(&self.tangent))
            } else {
                vector([Ball::ZERO; 3])
            },
            color: if has.color { three(&self.color) } else { [Ball::ZERO; 3] },
        }
    }
}

/// The kind of an id, if the scene has it.
pub(super) fn kind_of(scene: &Scene, id: u32) -> Option<SampleKind> {
    let of = &scene.primitives;
    let counts = [
        (scene.surfels.len(), SampleKind::Surface),
        (of.triangles.len(), SampleKind::Polygon),
        (of.ribbons.len(), SampleKind::Ribbon),
        (of.tubes.len(), SampleKind::Tube),
    ];
    if id == NO_ID {
        return Some(SampleKind::Empty);
    }
    let mut end = 0;
    counts.into_iter().find_map(|(count, kind)| {
        end += count;
        ((id as usize) < end).then_some(kind)
    })
}
