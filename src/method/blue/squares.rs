//! Place surfels as squares on the screen, see the page of [`super`].

use crate::frame::{Bins, Grid, Rect};
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::prepare::batch_size;
use crate::method::projection::surfels::PointProjector;
use crate::number::{Exact, MapInline, Real, Vector3};
use crate::scene::{Sides, Surfels};
use crate::splat::{Fate, Reasons, Tally, View, ellipse};
use std::ops::Range;

/// The plane and the rim of a disc, in view space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc<R> {
    /// Centre.
    pub(crate) p: Vector3<R>,
    /// Normal.
    pub(crate) n: Vector3<R>,
    /// n . p.
    pub(crate) through: R,
    /// r r.
    pub(crate) limit: R,
}

/// The ends of a square, in pixels: columns and rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edges<R> {
    pub(crate) x: [R; 2],
    pub(crate) y: [R; 2],
}

/// A surfel that is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Square<R> {
    /// The square's pixels in the picture.
    pub(crate) bounds: Rect,
    pub(crate) surfel: u32,
    /// Whether the back of the surfel is seen.
    pub(crate) back: bool,
    pub(crate) disc: Disc<R>,
}

/// A surfel that is placed; its fate is not known yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedSquare<R: Real> {
    pub(crate) edges: Edges<R>,
    pub(crate) disc: Disc<R>,
    /// g, how the surfel is turned: < 0 if its front is seen.
    pub(crate) g: R,
    /// The reasons not to draw it, except `outside`, which follows from the edges.
    pub(crate) reasons: Reasons<R>,
}

/// The shared numbers of a picture's squares.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SquareProjector<'a, R> {
    pub(crate) surfels: &'a Surfels,
    sides: Option<&'a Sides>,
    pub(crate) points: PointProjector<R>,
}

impl<'a, R: Real> SquareProjector<'a, R> {
    pub(crate) fn new(job: &Job<'a>, cull: bool) -> Self {
        let scene = job.scene;
        let points = PointProjector::new(View::new(job.camera), cull);
        Self { surfels: &scene.surfels, sides: scene.sides.as_ref(), points }
    }

    /// Places a surfel on the screen.
    pub(crate) fn place(&self, i: usize) -> PlacedSquare<R> {
        let side = R::from_f32(self.side(i));
        let [position, normal] =
            [self.surfels.position()[i], self.surfels.normal()[i]].map_inline(Vector3::from_glam);
        self.square(position, normal, R::from_f32(self.surfels.radius()[i]), side)
    }

    /// The side of a surfel; 0 for a surfel without one.
    #[inline(always)]
    pub(crate) fn side(&self, i: usize) -> f32 {
        self.sides.and_then(|sides| sides.side(i as u32)).unwrap_or(0.0)
    }

    /// Places a surfel with these numbers; the side is 0 for a surfel without one.
    #[inline(always)]
    pub(crate) fn square(
        &self,
        position: Vector3<R>,
        normal: Vector3<R>,
        radius: R,
        side: R,
    ) -> PlacedSquare<R> {
        let points = &self.points;
        let n = points.view.direction(normal);
        let (placed, g, reasons) = points.reasons(position, n);
        let half = R::from_f32(0.5);
        let own = ellipse::radius_in_pixels(radius, points.focal, placed.m).at_least(half);
        let h = R::select(side.gt(R::ZERO), side * half, own);
        let (p, c) = (placed.p, placed.center);
        PlacedSquare {
            edges: Edges { x: [c.x - h, c.x + h], y: [c.y - h, c.y + h] },
            disc: Disc { p, n, through: n.dot(p), limit: radius * radius },
            g,
            reasons: Reasons { outside: false.into(), ..reasons },
        }
    }
}

impl<R: Exact> PlacedSquare<R> {
    /// The square's pixels in a picture, and its fate; the bounds of a surfel that is not drawn
    /// mean nothing.
    #[inline(always)]
    pub(crate) fn fate(&self, view: &View<R>) -> (Rect, Fate) {
        let Edges { x, y } = &self.edges;
        let (x0, x1) = (before(x[0], view.width), before(x[1], view.width));
        let (y0, y1) = (before(y[0], view.height), before(y[1], view.height));
        let outside = (x0 >= x1) | (y0 >= y1);
        (Rect { x0, y0, x1, y1 }, Reasons { outside, ..self.reasons }.fate())
    }
}

impl<R: Exact> SquareProjector<'_, R> {
    /// A surfel as a square, if it is drawn.
    fn drawn(&self, i: usize, tally: &mut Tally) -> Option<Square<R>> {
        let placed = self.place(i);
        let (bounds, fate) = placed.fate(&self.points.view);
        tally.count(fate);
        let square =
            Square { bounds, surfel: i as u32, back: placed.g > R::ZERO, disc: placed.disc };
        (fate == Fate::Visible).then_some(square)
    }
}

/// Counts exactly how many centres of columns or rows, in a picture of this size, lie before a
/// coordinate.
#[inline(always)]
fn before<R: Exact>(coordinate: R, size: R) -> u32 {
    let held = coordinate.clamped(R::ZERO, size);
    let pixel = held.to_pixel();
    pixel + u32::from(R::from_f32(pixel as f32 + 0.5) < held)
}

/// The squares of a picture, in batches of ascending surfels with their bins.
#[derive(Debug)]
pub(crate) struct Squares<R> {
    pub(crate) tally: Tally,
    batches: Vec<(Vec<Square<R>>, Bins)>,
}

impl<R: Exact> Squares<R> {
    /// The squares of every surfel that is drawn.
    pub(crate) fn new(job: &Job<'_>, cull: bool) -> Self {
        let projector = SquareProjector::new(job, cull);
        Self::projected_by(job, &job.grid(), |range, squares| {
            let mut tally = Tally::default();
            squares.extend(range.filter_map(|i| projector.drawn(i, &mut tally)));
            tally
        })
    }

    /// As [`Squares::new`]; `project` makes the squares of a range of surfels.
    pub(crate) fn projected_by(
        job: &Job<'_>,
        grid: &Grid,
        project: impl Fn(Range<usize>, &mut Vec<Square<R>>) -> Tally + Sync + Send,
    ) -> Self {
        let count = job.scene.surfels.len();
        let size = batch_size(grid, count);
        let ranges = (0..count).step_by(size).map(|first| first..count.min(first + size));
        let results = job.exec.ordered(ranges.collect(), |range: Range<usize>| {
            spend(Work::Project);
            let mut squares = Vec::with_capacity(range.len());
            let tally = project(range, &mut squares);
            job.keep_touching(&mut squares, |square| square.bounds);
            let bins = Bins::new(grid, squares.len(), |i| squares[i].bounds);
            ((squares, bins), tally)
        });
        let tally = results.iter().fold(Tally::default(), |sum, (_, tally)| sum.plus(tally));
        Self { tally, batches: results.into_iter().map(|(batch, _)| batch).collect() }
    }

    /// Calls `visit` for each square that may touch a tile, in the order of the surfels.
    #[inline(always)]
    pub(crate) fn for_each(&self, tile: usize, mut visit: impl FnMut(&Square<R>)) {
        for (squares, bins) in &self.batches {
            bins.for_each(tile, |i| visit(&squares[i as usize]));
        }
    }
}
