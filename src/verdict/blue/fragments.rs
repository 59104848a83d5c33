//! Find the fragments that may lie in the pixels of a tile.

use crate::composite::decide;
use crate::frame::{Bins, NO_ID, Rect};
use crate::method::Job;
use crate::method::blue::discs::ray;
use crate::method::blue::squares::{Edges, PlacedSquare, SquareProjector};
use crate::method::fragment::facing;
use crate::method::projection::{Has, world};
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, MapInline, Real, Truth};
use crate::scene::Scene;
use crate::splat::View;
use crate::verdict::checks::Surface;
use crate::verdict::client::Storage;
use crate::verdict::marks::{TilePart, counted};
use crate::verdict::projection::AllPolygons;
use crate::verdict::shift::{CUT_OFF, OpenDecision};
use std::ops::Range;

/// A fragment that may lie in a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct PossibleFragment<P: Profile> {
    pub(super) id: u32,
    pub(super) depth: Ball<P>,
    pub(super) offset: Ball<P>,
    /// The offset divided by its limit; 0 for a triangle.
    pub(super) rim: f64,
    /// Whether the fragment certainly lies in the pixel.
    pub(super) lies: bool,
    /// Whether its surfel certainly is drawn, somewhere.
    pub(super) drawn: bool,
    /// The cut-off decision, if it is the only undecided decision on the fragment.
    pub(super) open: Option<OpenDecision>,
    /// Whether the camera sees the back of its surfel.
    pub(super) back: Three,
    /// The surface that a triangle shows; none for a surfel, because the scene has it.
    triangle: Option<Surface<P>>,
}

/// A surfel that may be drawn.
struct Possible<P: Profile> {
    surfel: u32,
    /// The pixels that may be in its square.
    bounds: Rect,
    drawn: bool,
    placed: PlacedSquare<Ball<P>>,
    back: Three,
}

/// All surfels and triangles that may be drawn, and where.
pub(super) struct Fragments<'a, P: Profile> {
    scene: &'a Scene,
    view: View<Ball<P>>,
    projector: SquareProjector<'a, Ball<P>>,
    colored: bool,
    surfels: Vec<(Vec<Possible<P>>, Bins)>,
    triangles: Option<AllPolygons<'a, P>>,
}

impl<'a, P: Profile> Fragments<'a, P> {
    pub(super) fn new(job: &Job<'a>, cull: bool) -> Self {
        let (scene, grid) = (job.scene, job.grid());
        let projector = SquareProjector::new(job, cull);
        let near = near(job);
        let count = near.as_ref().map_or(scene.surfels.len(), Vec::len);
        let ranges = (0..count).step_by(8192).map(|first| first..count.min(first + 8192));
        let surfels = job.exec.ordered(ranges.collect(), |range: Range<usize>| {
            let surfel = |i: usize| near.as_ref().map_or(i, |near| near[i]);
            let place = |i| Possible::new(&projector, surfel(i), job.camera.size());
            let mut possible: Vec<_> = range.filter_map(place).collect();
            job.keep_touching(&mut possible, |one| one.bounds);
            let bins = Bins::new(&grid, possible.len(), |i| possible[i].bounds);
            (possible, bins)
        });
        let some = !scene.primitives.is_empty();
        Self {
            scene,
            view: View::new(job.camera),
            projector,
            colored: Has::in_scene(scene).color,
            surfels,
            triangles: some.then(|| AllPolygons::new(job, scene, cull)),
        }
    }

    /// The fragments that may lie in each pixel of a tile, in the order of ids. A fragment that
    /// certainly is behind another is left out, unless the client has it: `keeps` gives the
    /// client's id.
    pub(super) fn of_tile(
        &self,
        part: TilePart,
        depth_test: Storage,
        keeps: impl Fn((u32, u32)) -> u32,
    ) -> Vec<Vec<PossibleFragment<P>>> {
        let TilePart { tile, rect } = part;
        let mut found: Vec<Vec<PossibleFragment<P>>> = counted(rect).map(|_| Vec::new()).collect();
        for (possible, bins) in &self.surfels {
            bins.for_each(tile, |i| {
                let one = &possible[i as usize];
                for (_, (x, y)) in counted_in(one.bounds.intersection(&rect)) {
                    let pixel = (y - rect.y0) as usize * rect.columns() + (x - rect.x0) as usize;
                    found[pixel].extend(self.fragment(one, (x, y)));
                }
            });
        }
        if let Some(triangles) = &self.triangles {
            for (own, found) in triangles.fragments(part).iter().zip(&mut found) {
                found.extend(own.iter().map(|one| PossibleFragment {
                    id: self.scene.surfels.len() as u32 + one.index,
                    depth: one.depth,
                    offset: Ball::ZERO,
                    rim: 0.0,
                    lies: one.lies,
                    drawn: true,
                    open: None,
                    back: false.into(),
                    triangle: Some(Surface {
                        depth: one.depth,
                        normal: world(&self.view, one.normal),
                        tangent: None,
                        color: one.color,
                    }),
                }));
            }
        }
        for ((_, at), found) in counted(rect).zip(&mut found) {
            let most = |may: &PossibleFragment<P>| may.depth.middle + may.depth.radius;
            let lying = found.iter().filter(|may| may.lies);
            let front = lying.copied().reduce(|a, b| if most(&b) < most(&a) { b } else { a });
            if let Some(front) = front {
                let own = keeps(at);
                let behind = |may: &PossibleFragment<P>| {
                    decide::before(front.depth, depth_test.tested(may.depth)).certainly()
                };
                found.retain(|may| may.id == own || !behind(may));
            }
        }
        found
    }

    /// The fragment of a surfel at a pixel, if it may lie there.
    fn fragment(&self, one: &Possible<P>, (x, y): (u32, u32)) -> Option<PossibleFragment<P>> {
        let PlacedSquare { edges, disc, .. } = &one.placed;
        let within = in_square(edges, (x, y));
        if !within.possibly() {
            return None;
        }
        let fragment = disc.at(ray(&self.view, (x, y)), self.view.perspective);
        let holds = disc.holds(&fragment, self.view.near);
        let sound = fragment.t.is_finite() & fragment.offset.is_finite();
        let others = within & sound & decide::beyond(fragment.t, self.view.near);
        let inside = decide::inside(fragment.offset, disc.limit);
        let open = one.drawn && others.certainly() && inside.decided().is_none();
        let radius = f64::from(self.scene.surfels.radius()[one.surfel as usize]);
        let limit = radius * radius;
        // A fragment that stays is within the radius of the centre. The reach adds more than any
        // implementation rounds.
        let reach = radius + (disc.p.z.middle.abs() + radius) * ROUNDINGS + disc.p.z.radius;
        let depth = narrower(fragment.t, Ball::new(-disc.p.z.middle, reach));
        let most = 0.5 * limit * (1.0 + ROUNDINGS) + f64::from(f32::MIN_POSITIVE);
        let offset = narrower(fragment.offset, Ball::new(0.5 * limit, most));
        (within & holds).possibly().then(|| PossibleFragment {
            id: one.surfel,
            depth,
            offset,
            rim: fragment.offset.middle / limit,
            lies: one.drawn && (within & holds).certainly(),
            drawn: one.drawn,
            open: open.then(|| OpenDecision {
                surfel: one.surfel,
                limit: Some(CUT_OFF),
                distance: (disc.limit.middle - fragment.offset.middle) / disc.limit.middle,
                radius: (disc.limit.radius + fragment.offset.radius) / disc.limit.middle,
            }),
            back: one.back,
            triangle: None,
        })
    }

    /// The surfaces that a pixel may show of a fragment, seen from the front or from the back.
    pub(super) fn surfaces(&self, may: &PossibleFragment<P>) -> [Option<Surface<P>>; 2] {
        if may.triangle.is_some() {
            return [may.triangle, None];
        }
        let (scene, i) = (self.scene, may.id as usize);
        let own = scene.surfels.color().map_or(scene.material.color, |color| color[i]);
        let color = if self.colored { own.to_array() } else { [0.0; 3] }.map_inline(Ball::from_f32);
        let surface = |back: bool| {
            let normal = scene.surfels.normal()[i].to_array().map_inline(Ball::from_f32);
            let normal = facing(normal, back.into());
            Surface { depth: may.depth, normal, tangent: None, color }
        };
        [
            (!may.back.certainly()).then(|| surface(false)),
            may.back.possibly().then(|| surface(true)),
        ]
    }

    /// The offset of a surfel at a pixel divided by its limit. None unless this is more than 1, the
    /// surfel may be drawn, and the pixel may be in its square.
    pub(super) fn rim(&self, surfel: u32, (x, y): (u32, u32)) -> Option<f64> {
        if surfel == NO_ID || surfel as usize >= self.scene.surfels.len() {
            return None;
        }
        let size = [self.view.width, self.view.height].map_inline(|size| size.middle as u32);
        let one = Possible::new(&self.projector, surfel as usize, size)?;
        let disc = &one.placed.disc;
        let fragment = disc.at(ray(&self.view, (x, y)), self.view.perspective);
        let rim = fragment.offset.middle / disc.limit.middle;
        (in_square(&one.placed.edges, (x, y)).possibly() && rim > 1.0).then_some(rim)
    }
}

/// A bound on the rounding of a depth or an offset, as a fraction of the operands. No
/// implementation rounds more.
const ROUNDINGS: f64 = 1.0 / 65_536.0;

/// The pixels of a rectangle, which may be empty.
fn counted_in(rect: Rect) -> impl Iterator<Item = (usize, (u32, u32))> {
    counted(if rect.is_empty() { Rect::default() } else { rect })
}

/// The ball with the smaller radius.
fn narrower<P: Profile>(own: Ball<P>, around: Ball<P>) -> Ball<P> {
    // Written so that a NaN radius never wins.
    if own.radius <= around.radius { own } else { around }
}

/// Whether a pixel is in a square.
fn in_square<P: Profile>(edges: &Edges<Ball<P>>, (x, y): (u32, u32)) -> Three {
    let between = |[first, end]: [Ball<P>; 2], pixel: u32| {
        let center = Ball::exact(f64::from(pixel) + 0.5);
        first.le(center) & center.lt(end)
    };
    between(edges.x, x) & between(edges.y, y)
}

impl<P: Profile> Possible<P> {
    /// The surfel, if it may be drawn into a pixel of the picture.
    fn new(
        projector: &SquareProjector<'_, Ball<P>>,
        i: usize,
        [width, height]: [u32; 2],
    ) -> Option<Self> {
        let placed = projector.place(i);
        let dropped = placed.reasons.any();
        if dropped.certainly() {
            return None;
        }
        let [x0, x1] = pixels(placed.edges.x, width);
        let [y0, y1] = pixels(placed.edges.y, height);
        let bounds = Rect { x0, y0, x1, y1 };
        // With culling, every drawn surfel is seen from the front.
        let back = if projector.points.cull { false.into() } else { placed.g.gt(Ball::ZERO) };
        let (surfel, drawn) = (i as u32, !dropped.possibly());
        (!bounds.is_empty()).then_some(Self { surfel, bounds, drawn, placed, back })
    }
}

/// The surfels that may touch the part that is judged, ascending, if that part is small and squares are
/// as large as discs: a square has the side of the greater focal length.
fn near(job: &Job<'_>) -> Option<Vec<usize>> {
    let part = job.part.filter(|_| job.scene.sides.is_none())?;
    let [fx, fy] = [job.camera.fx, job.camera.fy].map_inline(|focal| f64::from(focal.abs()));
    let wider = fx.at_least(fy) / fx.at_most(fy);
    part.near(job, 1.0, |i| wider * f64::from(job.scene.surfels.radius()[i]))
}

/// The pixels whose centres may be between two edges.
fn pixels<P: Profile>([first, end]: [Ball<P>; 2], size: u32) -> [u32; 2] {
    let known = |edge: Ball<P>| edge.radius.is_finite() && edge.middle.is_finite();
    let held = |at: f64| at.at_least(0.0).at_most(f64::from(size)) as u32;
    let low = if known(first) { first.middle - first.radius * (1.0 + 1e-9) - 1.0 } else { 0.0 };
    let high =
        if known(end) { end.middle + end.radius * (1.0 + 1e-9) + 1.0 } else { f64::INFINITY };
    [held(low.floor()), held(high.ceil())]
}
