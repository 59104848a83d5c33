//! Triangles, ribbons and tubes that may be drawn.

use super::planes::kind_of;
use super::polygons::{self, PossiblePolygon};
use crate::frame::raster::{GUARD_BAND, Snap};
use crate::method::projection::primitives::{
    Piece, Primitive, corners, line_piece, triangle_piece,
};
use crate::method::projection::{SampleKind, SceneProjector};
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real, Truth, Vector3};
use crate::scene::indexed::Indexed;
use crate::splat::clip::{Clipped, whole};

/// A piece that may be drawn.
pub(super) struct PossiblePiece<P: Profile> {
    pub(super) piece: Piece<Ball<P>>,
    /// Whether the piece certainly is drawn.
    pub(super) drawn: bool,
}

/// The possible pieces of all primitives of a scene.
pub(super) struct Pieces<P: Profile> {
    pub(super) all: Vec<PossiblePiece<P>>,
    /// The pieces of triangles that are cut, or whose corners have many places.
    pub(super) cut: Vec<PossiblePolygon<P>>,
    /// The ribbons and tubes that are not judged, ascending.
    pub(super) unclear: Vec<u32>,
}

/// The most ways to snap a primitive that are followed.
const MOST: usize = 16;

impl<P: Profile> Pieces<P> {
    /// Finds the pieces of all primitives that may be drawn.
    pub(super) fn new(projector: &SceneProjector<'_, Ball<P>>) -> Self {
        let mut found = Self { all: Vec::new(), cut: Vec::new(), unclear: Vec::new() };
        let of = projector.scene;
        let first = of.surfels.len();
        let primitives = &of.primitives;
        for id in first..first + primitives.len() {
            let kind = kind_of(of, id as u32).unwrap_or_default();
            let (triangles, ribbons) = (primitives.triangles.len(), primitives.ribbons.len());
            let index = id - first;
            let place = match kind {
                SampleKind::Polygon => {
                    found.triangle(projector, id as u32, index);
                    Some(())
                }
                SampleKind::Ribbon => {
                    let index = index - triangles;
                    found.line(&primitives.ribbons, projector, kind, id as u32, index)
                }
                _ => {
                    let index = index - triangles - ribbons;
                    found.line(&primitives.tubes, projector, kind, id as u32, index)
                }
            };
            if place.is_none() {
                found.unclear.push(id as u32);
            }
        }
        found
    }

    /// Adds the pieces of a triangle.
    fn triangle(&mut self, projector: &SceneProjector<'_, Ball<P>>, id: u32, index: usize) {
        let p = corners(&projector.scene.primitives.triangles, &projector.points, index);
        let weights = whole(p).map_inline(|corner: Clipped<_, 3>| corner.weights);
        let of = Primitive { id, index };
        match Ends::new(projector, p).ways() {
            Some(ways) => {
                self.add(ways, |ends| triangle_piece(projector, of, ends, weights, p));
            }
            None => polygons::triangle(projector, index, &mut self.cut),
        }
    }

    /// Adds the pieces of a line. None if they are not known.
    fn line(
        &mut self,
        of: &Indexed<2>,
        projector: &SceneProjector<'_, Ball<P>>,
        kind: SampleKind,
        id: u32,
        index: usize,
    ) -> Option<()> {
        let p = corners(of, &projector.points, index);
        let weights = whole(p).map_inline(|corner: Clipped<_, 2>| corner.weights);
        self.add(Ends::new(projector, p).ways()?, |ends| {
            line_piece(projector, kind, Primitive { id, index }, ends, weights, p)
        });
        Some(())
    }

    /// Adds each piece that a primitive may become.
    fn add<const N: usize>(
        &mut self,
        ways: Ways<P, N>,
        piece: impl Fn([([i64; 2], Ball<P>); N]) -> Option<Piece<Ball<P>>>,
    ) {
        let drawn = ways.len() == 1;
        let pieces = ways.into_iter().filter_map(piece);
        self.all.extend(pieces.map(|piece| PossiblePiece { piece, drawn }));
    }
}

/// The least and the greatest place of a corner on the grid, and its m.
type End<P> = ([[i64; 2]; 2], Ball<P>);

/// The part of a primitive that is seen.
enum Ends<P: Profile, const N: usize> {
    /// It is cut, or may be.
    Unclear,
    /// Nothing of it is seen.
    Nothing,
    /// All of it is seen.
    Whole([End<P>; N]),
}

impl<P: Profile, const N: usize> Ends<P, N> {
    fn new(projector: &SceneProjector<'_, Ball<P>>, p: [Vector3<Ball<P>>; N]) -> Self {
        let finite = |p: &Vector3<Ball<P>>| p.x.is_finite() & p.y.is_finite() & p.z.is_finite();
        if !p.iter().all(|p| finite(p).certainly()) {
            return Self::Unclear;
        }
        if projector.clip.drops(&p).certainly() {
            return Self::Nothing;
        }
        if !projector.clip.keeps(&p).certainly() {
            return Self::Unclear;
        }
        Self::Whole(p.map_inline(|p| {
            let placed = projector.points.place(p);
            let [x, y] =
                [placed.center.x, placed.center.y].map_inline(|x| fixed(&projector.snap, x));
            ([[x[0], y[0]], [x[1], y[1]]], placed.m)
        }))
    }

    /// Every way to snap the ends; empty if nothing is seen. None if the ways are not known.
    fn ways(self) -> Option<Ways<P, N>> {
        match self {
            Self::Unclear => None,
            Self::Nothing => Some(Vec::new()),
            Self::Whole(ends) => {
                let ways = ways(ends.map_inline(|(places, _)| places))?.into_iter();
                let with = |way: [[i64; 2]; N]| std::array::from_fn(|k| (way[k], ends[k].1));
                Some(ways.map(with).collect())
            }
        }
    }
}

/// Ways to snap the ends of a primitive, each with its m.
type Ways<P, const N: usize> = Vec<[([i64; 2], Ball<P>); N]>;

/// The least and the greatest fixed-point number that a coordinate may become.
pub(super) fn fixed<P: Profile>(snap: &Snap, x: Ball<P>) -> [i64; 2] {
    let guard = Ball::from_f32(GUARD_BAND as f32);
    let scaled = x.clamped(-guard, guard) * Ball::from_f32(snap.scale() as f32);
    let (middle, reach) = (scaled.middle, scaled.radius * (1.0 + 1e-9));
    // Exact, because the numbers are at most 2^29, in f64.
    [middle - reach, middle + reach].map_inline(|end| (end + 0.5).floor() as i64)
}

/// Every choice of a place for each corner; none if there are more than are followed.
fn ways<const N: usize>(ends: [[[i64; 2]; 2]; N]) -> Option<Vec<[[i64; 2]; N]>> {
    let mut all = vec![ends.map_inline(|[least, _]| least)];
    for (corner, [least, greatest]) in ends.into_iter().enumerate() {
        for axis in 0..2 {
            match greatest[axis] - least[axis] {
                0 => {}
                1 => {
                    let mut other = all.clone();
                    other.iter_mut().for_each(|way| way[corner][axis] += 1);
                    all.extend(other);
                }
                _ => return None,
            }
        }
    }
    (all.len() <= MOST).then_some(all)
}
