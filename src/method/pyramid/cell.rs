//! The cell that a level stores for each of its pixels.

use crate::composite::mean::Mean;
use crate::method::projection::{PixelSample, SampleKind};
use crate::number::{Exact, MapInline, Real, Vector2, Vector3};
use crate::splat::Ellipse;

/// A pixel of a level; view space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell<R> {
    /// The kind of primitive.
    pub kind: SampleKind,
    /// The front of the cell's interval of depth, in world units.
    pub front: R,
    /// The back of the interval.
    pub back: R,
    /// Radius of the cell's ellipse in pixels of level 0.
    pub extent: R,
    /// From the centre of the cell to the centre of the ellipse, in pixels of level 0, x right, y
    /// down.
    pub displacement: Vector2<R>,
    /// Normal, of any length.
    pub normal: Vector3<R>,
    /// Tangent of a tube, of any length; else the null vector.
    pub tangent: Vector3<R>,
    /// Linear RGB.
    pub color: [R; 3],
}

impl<R> Cell<R> {
    /// Converts each number to another arithmetic.
    #[must_use]
    pub fn map<S>(self, f: impl Fn(R) -> S) -> Cell<S> {
        Cell {
            kind: self.kind,
            front: f(self.front),
            back: f(self.back),
            extent: f(self.extent),
            displacement: self.displacement.map(&f),
            normal: self.normal.map(&f),
            tangent: self.tangent.map(&f),
            color: self.color.map(&f),
        }
    }
}

impl<R: Real> Cell<R> {
    /// An empty cell: kind [`SampleKind::Empty`], front +inf, back -inf, all else 0.
    #[must_use]
    pub fn empty() -> Self {
        let none = Vector3::ZERO;
        Self {
            kind: SampleKind::Empty,
            front: R::INFINITY,
            back: -R::INFINITY,
            extent: R::ZERO,
            displacement: Vector2::new(R::ZERO, R::ZERO),
            normal: none,
            tangent: none,
            color: [R::ZERO; 3],
        }
    }

    /// A cell of level 0.
    #[must_use]
    pub fn new(sample: &PixelSample<R>) -> Self {
        if sample.kind == SampleKind::Empty {
            return Self::empty();
        }
        Self {
            kind: sample.kind,
            front: sample.depth,
            back: sample.depth + sample.radius,
            extent: sample.extent,
            displacement: Vector2::new(R::ZERO, R::ZERO),
            normal: sample.normal,
            tangent: sample.tangent,
            color: sample.color,
        }
    }

    /// Whether the cell is not empty.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.kind != SampleKind::Empty
    }

    /// Which of four cells are valid and hold the centre of a new cell; `offsets` are measured from
    /// that centre.
    pub fn inside(cells: &[Self; 4], offsets: &[Vector2<R>; 4]) -> [R::Truth; 4] {
        [0, 1, 2, 3].map_inline(|j| {
            let ellipse = Ellipse::new(cells[j].normal, cells[j].extent);
            let holds = ellipse.holds(ellipse.form(offsets[j].x, offsets[j].y));
            holds & R::Truth::from(cells[j].is_valid())
        })
    }

    /// The average of the attributes, see [`super::pull`]. `displacements` are measured from the
    /// new cell's centre, and `first` is the foremost cell, which gives the new cell its kind.
    pub(super) fn average(
        cells: &[Self; 4],
        displacements: [Vector2<R>; 4],
        mean: &Mean<R>,
        first: usize,
    ) -> Self {
        let vector = |v: [Vector3<R>; 4]| {
            Vector3::new(
                mean.average(v.map_inline(|v| v.x)),
                mean.average(v.map_inline(|v| v.y)),
                mean.average(v.map_inline(|v| v.z)),
            )
        };
        let front = cells[first].tangent;
        let tangents = cells.map_inline(|cell| {
            let (own, opposite) = (cell.tangent, cell.tangent.dot(front).lt(R::ZERO));
            let turned = |v: R| R::select(opposite, -v, v);
            Vector3::new(turned(own.x), turned(own.y), turned(own.z))
        });
        Self {
            kind: cells[first].kind,
            front: mean.average(cells.map_inline(|cell| cell.front)),
            back: mean.average(cells.map_inline(|cell| cell.back)),
            extent: mean.average(cells.map_inline(|cell| cell.extent)),
            displacement: Vector2::new(
                mean.average(displacements.map_inline(|d| d.x)),
                mean.average(displacements.map_inline(|d| d.y)),
            ),
            normal: vector(cells.map_inline(|cell| cell.normal)),
            tangent: vector(tangents),
            color: [0, 1, 2].map_inline(|c| mean.average(cells.map_inline(|cell| cell.color[c]))),
        }
    }
}

impl<R: Exact> Cell<R> {
    /// Which of four cells take part, and which one is foremost.
    ///
    /// The candidates are the cells that are [inside](Cell::inside), see
    /// [`crate::composite::mean::foremost`]. If the foremost is a tube, cells that are not tubes
    /// take no part; if it is none, tubes take no part.
    pub(super) fn foremost(cells: &[Self; 4], inside: [bool; 4]) -> ([bool; 4], usize) {
        let (fronts, backs) =
            (cells.map_inline(|cell| cell.front), cells.map_inline(|cell| cell.back));
        let (takes, first) = crate::composite::mean::foremost(inside, fronts, backs);
        let tube = |j: usize| cells[j].kind == SampleKind::Tube;
        ([0, 1, 2, 3].map_inline(|j| takes[j] & (tube(j) == tube(first))), first)
    }
}
