//! The candidates that may lie in a pixel of the projection: surfels and pieces of primitives.

use super::primitives::PossiblePiece;
use crate::frame::{Grid, Rect};
use crate::method::projection::primitives::PiecePixel;
use crate::method::projection::surfels::{PlacedPoint, PointProjector};
use crate::method::projection::{PixelSample, SampleKind};
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, Pixel, Real, Truth, Vector3};
use crate::scene::Surfels;

/// A surfel that may be drawn.
pub(super) struct Possible<P: Profile> {
    pub(super) surfel: u32,
    /// The pixels that it may be drawn into.
    pub(super) bounds: Rect,
    /// Whether it certainly is drawn.
    pub(super) drawn: bool,
    pub(super) placed: PlacedPoint<Ball<P>>,
    pub(super) normal: Vector3<Ball<P>>,
    pub(super) back: Three,
}

/// A surfel or a piece that may lie in a pixel.
pub(super) enum Candidate<'a, P: Profile> {
    /// A surfel, and whether it passes the depth test there.
    Surfel(&'a Possible<P>, Three),
    Piece(&'a PossiblePiece<P>, PiecePixel<Ball<P>>),
    /// The sample of a triangle that is cut, and whether it certainly lies there.
    Cut(Box<PixelSample<Ball<P>>>, bool),
}

impl<P: Profile> Candidate<'_, P> {
    pub(super) fn id(&self) -> u32 {
        match self {
            Self::Surfel(one, _) => one.surfel,
            Self::Piece(one, _) => one.piece.id,
            Self::Cut(sample, _) => sample.id,
        }
    }

    pub(super) fn kind(&self) -> SampleKind {
        match self {
            Self::Surfel(..) => SampleKind::Surface,
            Self::Piece(one, _) => one.piece.kind,
            Self::Cut(sample, _) => sample.kind,
        }
    }

    pub(super) fn depth(&self) -> Ball<P> {
        match self {
            Self::Surfel(one, _) => one.placed.t,
            Self::Piece(_, at) => -at.p.z,
            Self::Cut(sample, _) => sample.depth,
        }
    }

    /// Whether it certainly is drawn, somewhere.
    pub(super) fn drawn(&self) -> bool {
        match self {
            Self::Surfel(one, _) => one.drawn,
            Self::Piece(one, _) => one.drawn,
            Self::Cut(_, lies) => *lies,
        }
    }

    /// Whether it certainly lies in the pixel.
    pub(super) fn lies(&self) -> bool {
        self.drawn() && self.is_alone() && self.passes().certainly()
    }

    /// Whether this is the only pixel that it may be drawn into.
    pub(super) fn is_alone(&self) -> bool {
        match self {
            Self::Surfel(one, _) => one.bounds.pixels() == 1,
            Self::Piece(one, _) => one.drawn,
            Self::Cut(_, lies) => *lies,
        }
    }

    /// Whether it passes the depth test.
    pub(super) fn passes(&self) -> Three {
        match self {
            Self::Surfel(_, passes) => *passes,
            Self::Piece(..) | Self::Cut(..) => true.into(),
        }
    }
}

impl<P: Profile> Possible<P> {
    /// The surfel, if it may be drawn into a pixel of the picture.
    pub(super) fn new(
        projector: &PointProjector<Ball<P>>,
        surfels: &Surfels,
        i: usize,
        grid: &Grid,
    ) -> Option<Self> {
        let normal = projector.view.direction(Vector3::from_glam(surfels.normal()[i]));
        let position = Vector3::from_glam(surfels.position()[i]);
        let (placed, g, reasons) = projector.reasons(position, normal);
        let dropped = reasons.any();
        if dropped.certainly() {
            return None;
        }
        let [width, height] = grid.size();
        let [x, y] = placed.pixel();
        let end = |greatest: u32, size: u32| if greatest < size { greatest + 1 } else { size };
        let bounds = Rect {
            x0: x.least(),
            y0: y.least(),
            x1: end(x.greatest(), width),
            y1: end(y.greatest(), height),
        };
        // With culling, every drawn surfel is seen from the front.
        let back = if projector.cull { false.into() } else { g.gt(Ball::ZERO) };
        let surfel = i as u32;
        let drawn = !dropped.possibly();
        (!bounds.is_empty()).then_some(Self { surfel, bounds, drawn, placed, normal, back })
    }
}
