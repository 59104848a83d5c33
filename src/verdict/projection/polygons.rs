//! Find every fragment that the triangles of a scene may leave in each pixel, whatever their size
//! and place.
//!
//! The corners of a triangle are intervals on the grid of fixed point; a cut triangle has the
//! corners of its pieces. Where each interval is one place, coverage is exact. Else the weight of a
//! corner is an interval: its edge function over all places of the corners. The piece *may lie* in
//! a pixel if no weight certainly is negative. It *lies* there if all weights certainly are
//! positive. A value of the corners is off by its slope on the screen times the errors of the
//! corners, each times its weight.
//!
//! **Open** are pieces whose visible side is not certain, and triangles whose cut is not certain.
//! An open piece may lie in any pixel that does not have all its corners on one side, at any depth
//! of its corners.

use super::intervals::{Depths, Intervals, ROUNDINGS};
use super::primitives::fixed;
use crate::frame::raster::{GUARD_BAND, Snap, Triangle};
use crate::frame::{Bins, Grid, Rect};
use crate::method::Job;
use crate::method::projection::primitives::{
    Piece, PiecePixel, Primitive, corners, triangle_piece, triangle_within,
};
use crate::method::projection::{PixelSample, SampleKind, SceneProjector};
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline, Real, Vector2, Vector3};
use crate::scene::Scene;
use crate::splat::clip::Clipped;
use crate::verdict::checks::anything;
use crate::verdict::marks::{TilePart, counted};

/// Triangles that may be drawn, and where.
pub(crate) struct AllPolygons<'a, P: Profile> {
    projector: SceneProjector<'a, Ball<P>>,
    drawn: Vec<PossiblePolygon<P>>,
    bins: Bins,
}

/// A piece of a triangle that may be drawn.
pub(super) struct PossiblePolygon<P: Profile> {
    /// The index of the triangle in its list.
    index: u32,
    bounds: Rect,
    /// The range of its depths.
    depths: Ball<P>,
    form: Form<P>,
}

enum Form<P: Profile> {
    Exact(Box<Piece<Ball<P>>>),
    Between(Box<(Piece<Ball<P>>, Depths)>),
    /// The intervals of the corners, if they are known.
    OpenDecision(Option<Intervals>),
}

/// A fragment that a triangle may leave in a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PossibleFragment<P: Profile> {
    /// The index of the triangle in its list.
    pub(crate) index: u32,
    pub(crate) depth: Ball<P>,
    /// The normal in view space.
    pub(crate) normal: Vector3<Ball<P>>,
    pub(crate) color: [Ball<P>; 3],
    /// Whether it certainly lies in the pixel.
    pub(crate) lies: bool,
}

impl<'a, P: Profile> AllPolygons<'a, P> {
    /// The triangles of a scene that has nothing else, in the picture of a job.
    pub(crate) fn new(job: &Job<'_>, scene: &'a Scene, cull: bool) -> Self {
        let projector = SceneProjector::new(scene, job.camera, cull, Snap::default());
        let count = scene.primitives.triangles.len();
        let ranges = (0..count).step_by(1024).map(|i| i..count.min(i + 1024)).collect();
        let found = job.exec.ordered(ranges, |range: std::ops::Range<usize>| {
            let mut drawn = Vec::new();
            range.for_each(|i| triangle(&projector, i, &mut drawn));
            drawn
        });
        let mut drawn: Vec<_> = found.into_iter().flatten().collect();
        drawn.retain(|one| !one.bounds.is_empty());
        job.keep_touching(&mut drawn, |one| one.bounds);
        let bins = Bins::new(&job.grid(), drawn.len(), |i| drawn[i].bounds);
        Self { projector, drawn, bins }
    }

    /// Triangles of a projector's scene that are found already.
    pub(super) fn found(
        projector: SceneProjector<'a, Ball<P>>,
        mut drawn: Vec<PossiblePolygon<P>>,
        grid: &Grid,
    ) -> Self {
        drawn.retain(|one| !one.bounds.is_empty());
        let bins = Bins::new(grid, drawn.len(), |i| drawn[i].bounds);
        Self { projector, drawn, bins }
    }

    /// The fragments that may lie in each pixel of a tile.
    pub(crate) fn fragments(&self, part: TilePart) -> Vec<Vec<PossibleFragment<P>>> {
        let rect = part.rect;
        let mut found: Vec<_> = counted(rect).map(|_| Vec::new()).collect();
        let place =
            |x: u32, y: u32| (y - rect.y0) as usize * rect.columns() + (x - rect.x0) as usize;
        self.each(part, |(x, y), index, sample, lies| {
            let PixelSample { depth, normal, color, .. } = sample;
            found[place(x, y)].push(PossibleFragment { index, depth, normal, color, lies });
        });
        found
    }

    /// Calls `visit` for every fragment that may lie in a pixel of a tile: with the index of its
    /// triangle, its sample, and whether it certainly lies there.
    pub(super) fn each(
        &self,
        TilePart { tile, rect }: TilePart,
        mut visit: impl FnMut((u32, u32), u32, PixelSample<Ball<P>>, bool),
    ) {
        self.bins.for_each(tile, |i| {
            let one = &self.drawn[i as usize];
            let inner = one.bounds.intersection(&rect);
            match &one.form {
                _ if inner.is_empty() => {}
                Form::Exact(piece) => piece.for_each(&inner, |at| {
                    visit((at.x, at.y), one.index, self.sample(one, piece, &at), true);
                }),
                Form::Between(between) => {
                    let (piece, depths) = &**between;
                    for (_, (x, y)) in counted(inner) {
                        if let Some((weights, lies)) = depths.weights((x, y)) {
                            let at = piece.with(x, y, weights);
                            visit((x, y), one.index, self.sample(one, piece, &at), lies);
                        }
                    }
                }
                Form::OpenDecision(intervals) => {
                    let open = self.open(one);
                    for (_, at) in counted(inner) {
                        if intervals.as_ref().is_none_or(|all| all.may_reach(at)) {
                            visit(at, one.index, open, false);
                        }
                    }
                }
            }
        });
    }

    /// The sample of a triangle of which only its depths are known.
    fn open(&self, one: &PossiblePolygon<P>) -> PixelSample<Ball<P>> {
        let any = anything();
        let vector = Vector3::new(any, any, any);
        PixelSample {
            kind: SampleKind::Polygon,
            id: self.projector.scene.surfels.len() as u32 + one.index,
            depth: one.depths,
            radius: any,
            extent: any,
            center: Vector2::new(any, any),
            normal: vector,
            tangent: Vector3::ZERO,
            color: [any; 3],
        }
    }

    fn sample(
        &self,
        one: &PossiblePolygon<P>,
        piece: &Piece<Ball<P>>,
        at: &PiecePixel<Ball<P>>,
    ) -> PixelSample<Ball<P>> {
        let sample = piece.sample(&self.projector, at);
        let bounded = sample.depth.radius.is_finite();
        PixelSample { depth: if bounded { sample.depth } else { one.depths }, ..sample }
    }
}

/// The pieces that a triangle may be drawn as.
pub(super) fn triangle<P: Profile>(
    projector: &SceneProjector<'_, Ball<P>>,
    index: usize,
    drawn: &mut Vec<PossiblePolygon<P>>,
) {
    let p = corners(&projector.scene.primitives.triangles, &projector.points, index);
    // Where the cut is undecided, the whole triangle is open.
    let Some(polygon) = projector.clip.certain(p) else {
        let depths = depths(projector, &p, &p);
        let bounds = reach(projector, &p);
        let index = index as u32;
        drawn.push(PossiblePolygon { index, bounds, depths, form: Form::OpenDecision(None) });
        return;
    };
    for i in 2..polygon.len() {
        let fan = [polygon[0], polygon[i - 1], polygon[i]];
        drawn.extend(piece(projector, index, &fan, &p));
    }
}

/// The piece of a triangle with these corners, if it may be drawn.
fn piece<P: Profile>(
    projector: &SceneProjector<'_, Ball<P>>,
    index: usize,
    fan: &[Clipped<Ball<P>, 3>; 3],
    p: &[Vector3<Ball<P>>; 3],
) -> Option<PossiblePolygon<P>> {
    let snap = &projector.snap;
    let placed = fan.map_inline(|corner| projector.points.place(corner.position));
    let places: [[[i64; 2]; 2]; 3] =
        placed.each_ref().map_inline(|at| [fixed(snap, at.center.x), fixed(snap, at.center.y)]);
    let least = std::array::from_fn(|k| (places[k].map_inline(|[least, _]| least), placed[k].m));
    let weights = fan.map_inline(|corner| corner.weights);
    let depths = depths(projector, &fan.map_inline(|corner| corner.position), p);
    let of = Primitive { id: (projector.scene.surfels.len() + index) as u32, index };
    let index = index as u32;
    if places.iter().flatten().all(|[least, greatest]| least == greatest) {
        let piece = triangle_piece(projector, of, least, weights, *p)?;
        return Some(PossiblePolygon {
            index,
            bounds: piece.bounds,
            depths,
            form: Form::Exact(Box::new(piece)),
        });
    }
    let intervals = Intervals::new(snap, &places);
    let bounds = intervals.bounds(projector.size);
    // Where the sense of the corners is undecided, so is the visible side.
    if !intervals.is_turned() {
        let form = Form::OpenDecision(Some(intervals));
        return Some(PossiblePolygon { index, bounds, depths, form });
    }
    let raster = Triangle::new(snap, least.map_inline(|(place, _)| place))?;
    let piece = triangle_within(projector, of, raster, bounds, least, weights, *p)?;
    let between = Depths::new(intervals, placed.map_inline(|at| at.m), &weights);
    let form = Form::Between(Box::new((piece, between)));
    Some(PossiblePolygon { index, bounds, depths, form })
}

/// The range of depths of a piece with these corners of a triangle.
fn depths<P: Profile>(
    projector: &SceneProjector<'_, Ball<P>>,
    piece: &[Vector3<Ball<P>>; 3],
    triangle: &[Vector3<Ball<P>>; 3],
) -> Ball<P> {
    let size = |sum: f64, p: &Vector3<Ball<P>>| sum + p.z.middle.abs() + p.z.radius;
    let lost = triangle.iter().fold(0.0, size) * ROUNDINGS;
    let near = projector.points.view.near.middle;
    let (mut least, mut most) = (f64::INFINITY, near);
    for p in piece {
        least = least.at_most(-p.z.middle - p.z.radius);
        most = most.at_least(-p.z.middle + p.z.radius);
    }
    let (least, most) = (least.at_least(near) - lost, most + lost);
    let sound = least > 0.0 || !projector.points.view.perspective;
    if sound && (most - least).is_finite() {
        Ball::new(0.5 * (least + most), 0.5 * (most - least) * (1.0 + ROUNDINGS))
    } else {
        anything()
    }
}

/// The pixels that a triangle may reach, wherever it is cut. A pixel is left out if all corners lie
/// on one side of it, by more than their possible error.
fn reach<P: Profile>(projector: &SceneProjector<'_, Ball<P>>, p: &[Vector3<Ball<P>>; 3]) -> Rect {
    let view = &projector.points.view;
    let near = if view.perspective { view.near.middle } else { 1.0 };
    let size = |p: &Vector3<Ball<P>>| {
        [p.x, p.y, p.z].iter().fold(0.0, |sum, c| sum + c.middle.abs()) * ROUNDINGS
            + (p.x.radius + p.y.radius + p.z.radius)
    };
    let off = p.iter().fold(0.0, |off, p| off + size(p));
    let [columns, rows] = [0, 1].map_inline(|axis| {
        let (focal, center) = if axis == 0 {
            (view.fx.middle, view.cx.middle)
        } else {
            (view.fy.middle, view.cy.middle)
        };
        let pixels = projector.size[axis];
        let slack = 2.0 + off * (focal + center.abs() + f64::from(GUARD_BAND)) / near;
        // > 0 if the corner is beyond the coordinate.
        let beyond = |p: &Vector3<Ball<P>>, at: f64| {
            let s = if view.perspective { -p.z.middle } else { 1.0 };
            let c = if axis == 0 { p.x.middle } else { -p.y.middle };
            focal * c + (center - at) * s
        };
        let may = |pixel: &u32| {
            let at = f64::from(*pixel) + 0.5;
            let all_after = p.iter().all(|p| beyond(p, at + slack) > 0.0);
            let all_before = p.iter().all(|p| beyond(p, at - slack) < 0.0);
            !(all_after || all_before)
        };
        let first = (0..pixels).find(may).unwrap_or(pixels);
        let end = (first..pixels).rev().find(may).map_or(first, |last| last + 1);
        [first, end]
    });
    Rect { x0: columns[0], y0: rows[0], x1: columns[1], y1: rows[1] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Exec;
    use crate::index::Index;
    use crate::method::projection::project;
    use crate::number::Exact;
    use crate::number::ball::{Gpu, Ieee};
    use crate::number::random::unit;
    use crate::scene::{Camera, Lens, Pose, Primitives, Surfels, Triangles, Vertices};
    use glam::{DVec3, Vec3};

    /// Triangles of this size around random points, some of them behind the camera.
    fn scene(seed: u64, count: u32, size: f32) -> Scene {
        let at = |i: u64| 2.0 * unit(seed, i) - 1.0;
        let point = |i: u64| Vec3::new(at(3 * i), at(3 * i + 1), at(3 * i + 2));
        let corner = |i: u64| 5.0 * point(10_000 + i / 3) + size * point(i);
        let total = u64::from(3 * count);
        let vertices = Vertices {
            position: (0..total).map(corner).collect(),
            direction: (0..total).map(|i| point(20_000 + i).normalize()).collect(),
            radius: vec![0.0; total as usize],
            color: Some((0..total).map(|i| point(30_000 + i).abs()).collect()),
            ..Vertices::default()
        };
        let corners = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let triangles = Triangles::new(vertices, corners).unwrap().0;
        let primitives = Primitives { triangles, ..Primitives::default() };
        Scene { primitives, ..Scene::unlit("triangles", Surfels::none()) }
    }

    /// The error of a sample against a fragment, in radii.
    fn error<P: Profile, R: Exact>(sample: &PixelSample<R>, may: &PossibleFragment<P>) -> f64 {
        let misfit = |ball: Ball<P>, value: R| ball.misfit(Ball::exact(value.to_f64()));
        let normal = [
            (may.normal.x, sample.normal.x),
            (may.normal.y, sample.normal.y),
            (may.normal.z, sample.normal.z),
        ];
        let all = may.color.into_iter().zip(sample.color).chain(normal);
        all.chain([(may.depth, sample.depth)])
            .fold(0.0, |most, (ball, value)| most.at_least(misfit(ball, value)))
    }

    /// Asserts that the drawn samples fit the fragments that may lie there, and hide the ones that
    /// certainly lie. Returns how many samples there are, how many have a depth known to a
    /// thousandth, and how many certainly lie.
    fn compare<P: Profile + std::fmt::Debug, R: Exact>(
        scene: &Scene,
        camera: &Camera,
        cull: bool,
    ) -> [usize; 3] {
        let exec = Exec::new(1, 16).unwrap();
        let index = Index::default();
        let job = Job::new(scene, &index, camera, &exec);
        let all = AllPolygons::<P>::new(&job, scene, cull);
        let drawn = project::<R>(&job, cull, Snap::default()).unwrap().samples;
        let mut counts = [0; 3];
        for (tile, rect) in job.grid().rects().into_iter().enumerate() {
            for ((_, (x, y)), may) in counted(rect).zip(all.fragments(TilePart { tile, rect })) {
                let sample = drawn.at(x, y);
                let before = |one: &&PossibleFragment<P>| {
                    one.lies && { one.depth.middle + one.depth.radius < sample.depth.to_f64() }
                };
                assert!(!may.iter().any(|one| before(&one)), "{x} {y}");
                if sample.kind == SampleKind::Empty {
                    continue;
                }
                let fits = |one: &&PossibleFragment<P>| error(sample, one) <= 1.0;
                let closest = |a: &&PossibleFragment<P>, b: &&PossibleFragment<P>| {
                    a.depth.radius.total_cmp(&b.depth.radius)
                };
                let found = may.iter().filter(fits).min_by(closest);
                let found = found.unwrap_or_else(|| panic!("{x} {y} {sample:?} {may:?}"));
                let close = found.depth.radius < 1e-3 * found.depth.middle;
                counts = [
                    counts[0] + 1,
                    counts[1] + usize::from(close),
                    counts[2] + usize::from(found.lies),
                ];
            }
        }
        counts
    }

    #[test]
    fn what_is_drawn_may_lie_and_what_lies_is_drawn() {
        let mut counts = [0; 3];
        for seed in 0..12 {
            let size = [0.05, 0.5, 3.0, 20.0][seed as usize % 4];
            let scene = scene(seed, 40, size);
            let lens = [Lens::FieldOfView(50.0), Lens::Orthographic(4.0)][seed as usize / 4 % 2];
            let eye = DVec3::new(0.25, 0.5, 3.0);
            let pose = Pose { eye, target: DVec3::ZERO, up: DVec3::Y };
            let picture = if seed % 3 == 0 { [900, 40] } else { [61, 47] };
            let camera = Camera::new(picture[0], picture[1], pose, lens).unwrap();
            let cull = seed % 5 == 0;
            for found in [
                compare::<Ieee, f32>(&scene, &camera, cull),
                compare::<Ieee, f64>(&scene, &camera, cull),
                compare::<Gpu, f32>(&scene, &camera, cull),
            ] {
                counts = [0, 1, 2].map(|i| counts[i] + found[i]);
            }
        }
        let [all, close, lies] = counts;
        assert!(all > 50_000 && close * 2 > all && lies * 10 > all * 9, "{counts:?}");
    }
}
