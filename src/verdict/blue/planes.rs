//! The planes that a client hands in.

use crate::frame::NO_ID;
use crate::method::blue::planes::{COLOR, ID, NORMAL, OFFSET, WEIGHT};
use crate::method::surface::{ALPHA, DEPTH, SHADED};
use crate::number::ball::Profile;
use crate::number::{Ball, Real};
use crate::verdict::checks::{Report, Surface, number, triple, whole};
use crate::verdict::client::{Client, Storage, StoredPlane, Ties};

/// The planes of a client; each may be missing.
pub(super) struct BluePlanes<'a> {
    pub(super) ties: Ties,
    pub(super) depth_test: Storage,
    color: Option<StoredPlane<'a, [f64; 3]>>,
    offset: Option<StoredPlane<'a, f64>>,
    pub(super) depth: Option<StoredPlane<'a, f64>>,
    normal: Option<StoredPlane<'a, [f64; 3]>>,
    weight: Option<StoredPlane<'a, f64>>,
    pub(super) id: Option<StoredPlane<'a, u32>>,
    shaded: Option<StoredPlane<'a, [f64; 3]>>,
    alpha: Option<StoredPlane<'a, f64>>,
}

/// The surface that a pixel shows.
pub(super) struct PixelSurface<P: Profile> {
    pub(super) id: u32,
    pub(super) offset: Ball<P>,
    pub(super) surface: Surface<P>,
    pub(super) weight: Ball<P>,
}

impl<P: Profile> PixelSurface<P> {
    pub(super) const EMPTY: Self = Self {
        id: NO_ID,
        offset: Ball::ZERO,
        surface: Surface {
            depth: Ball::INFINITY,
            normal: [Ball::ZERO; 3],
            tangent: None,
            color: [Ball::ZERO; 3],
        },
        weight: Ball::ZERO,
    };
}

/// The content of a pixel, according to the client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PixelContent {
    /// The client gives neither id, nor depth, nor weight.
    Nothing,
    Empty,
    /// This id, which the scene may not have.
    Id(u32),
    Some,
}

impl<'a> BluePlanes<'a> {
    pub(super) fn new(client: &'a Client) -> Self {
        Self {
            ties: client.ties,
            depth_test: client.depth_test,
            color: client.triple(&COLOR),
            offset: client.scalar(&OFFSET),
            depth: client.scalar(&DEPTH),
            normal: client.triple(&NORMAL),
            weight: client.scalar(&WEIGHT),
            id: client.index(&ID),
            shaded: client.triple(&SHADED),
            alpha: client.scalar(&ALPHA),
        }
    }

    /// The stages, each with the planes that it judges.
    pub(super) fn stages(&self) -> [(&'static str, Vec<&'static str>); 2] {
        let discs = [
            self.color.map(|plane| plane.name),
            self.offset.map(|plane| plane.name),
            self.depth.map(|plane| plane.name),
            self.normal.map(|plane| plane.name),
            self.weight.map(|plane| plane.name),
            self.id.map(|plane| plane.name),
        ];
        let picture = [self.shaded.map(|plane| plane.name), self.alpha.map(|plane| plane.name)];
        [
            ("discs", discs.into_iter().flatten().collect()),
            ("shading", picture.into_iter().flatten().collect()),
        ]
    }

    /// The content of a pixel, according to the client.
    pub(super) fn says(&self, at: (u32, u32)) -> PixelContent {
        let some = |there: bool| if there { PixelContent::Some } else { PixelContent::Empty };
        match (self.id, self.depth, self.weight) {
            (Some(ids), ..) => match *ids.plane.at(at.0, at.1) {
                NO_ID => PixelContent::Empty,
                id => PixelContent::Id(id),
            },
            (_, Some(depths), _) => some(*depths.plane.at(at.0, at.1) != f64::INFINITY),
            (_, _, Some(weights)) => some(*weights.plane.at(at.0, at.1) != 0.0),
            _ => PixelContent::Nothing,
        }
    }

    /// The id at a pixel; `NO_ID` if the client hands in no ids.
    pub(super) fn id(&self, at: (u32, u32)) -> u32 {
        self.id.map_or(NO_ID, |ids| *ids.plane.at(at.0, at.1))
    }

    /// Checks the planes of the discs at a pixel.
    pub(super) fn check<P: Profile>(
        &self,
        at: (u32, u32),
        shown: &PixelSurface<P>,
        report: &mut Report<'_>,
    ) {
        if let Some(plane) = &self.id {
            whole(0, plane, at, shown.id, report);
        }
        let scalars = [
            (&self.depth, shown.surface.depth),
            (&self.offset, shown.offset),
            (&self.weight, shown.weight),
        ];
        for (plane, truth) in scalars {
            if let Some(plane) = plane {
                number(0, plane, at, truth, report);
            }
        }
        let triples = [(&self.normal, shown.surface.normal), (&self.color, shown.surface.color)];
        for (plane, truth) in triples {
            if let Some(plane) = plane {
                triple(0, plane, at, truth, report);
            }
        }
    }

    /// The surface at a pixel according to the client: as it is stored, or as it was before,
    /// because one shader may do both. A plane that the client does not hand in is taken from
    /// `shown`.
    pub(super) fn surface<P: Profile>(&self, at: (u32, u32), shown: &Surface<P>) -> Surface<P> {
        Surface {
            depth: self.depth.map_or(shown.depth, |plane| plane.ball(at)),
            normal: self.normal.map_or(shown.normal, |plane| plane.balls(at)),
            tangent: None,
            color: self.color.map_or(shown.color, |plane| plane.balls(at)),
        }
    }

    /// The weight of a pixel, in the same way.
    pub(super) fn seen<P: Profile>(&self, at: (u32, u32), shown: Ball<P>) -> Ball<P> {
        self.weight.map_or(shown, |plane| plane.ball_where(at, shown.contains(0.0)))
    }

    /// Checks the colour of the picture.
    pub(super) fn check_picture<P: Profile>(
        &self,
        at: (u32, u32),
        truth: [Ball<P>; 3],
        report: &mut Report<'_>,
    ) {
        if let Some(plane) = &self.shaded {
            triple(1, plane, at, truth, report);
        }
    }

    /// Checks the opacity of the picture.
    pub(super) fn check_alpha<P: Profile>(
        &self,
        at: (u32, u32),
        truth: Ball<P>,
        report: &mut Report<'_>,
    ) {
        if let Some(plane) = &self.alpha {
            number(1, plane, at, truth, report);
        }
    }
}
