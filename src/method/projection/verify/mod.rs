//! What a right implementation may leave of the projection: a certificate for each pixel.
//!
//! Surfels are placed in [`Ball`]s. A surfel *may lie* in a pixel if it is not certainly dropped and
//! the pixel is one that its centre may fall into; it *lies* there if it certainly is drawn and
//! there is no other such pixel.
//!
//! 1. The surfel of the id may lie in the pixel. An empty pixel has no surfel.
//! 2. Every plane is in the ball of that surfel's sample; where both sides may be seen, of one of
//!    the two. Of an empty pixel every plane is that of [`PixelSample::empty`].
//! 3. No surfel lies in the pixel whose depth certainly is less than Z; without Z, than the depth
//!    of the id's surfel. Of an empty pixel Z is +inf.
//!
//! Without ids the surfel is the one that errs least, of those that no other certainly hides.
//!
//! **Not judged**: pixels of a triangle, a ribbon or a tube, but for rule 3 and for their kind,
//! which is that of the id; whether a primitive was left out; in a scene of primitives, where a client
//! gives neither ids nor kinds, whatever is not empty.

mod planes;

pub(in crate::method) use planes::SamplePlanes;

use super::surfels::{PlacedPoint, PointProjector};
use super::{Has, PixelSample, SampleKind};
use crate::composite::decide;
use crate::frame::{Bins, Grid, NO_ID, Rect};
use crate::method::algorithm::Job;
use crate::method::judged::{Marks, PixelMarks, counted};
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, Pixel, Real, Truth, Vector3};
use crate::scene::Surfels;
use crate::splat::View;
use crate::verify::verdict::{Doubt, Fault, Judged};
use planes::Says;

/// A surfel that may be drawn.
struct Possible<P: Profile> {
    surfel: u32,
    /// The pixels that it may be drawn into.
    bounds: Rect,
    /// Whether it certainly is drawn.
    drawn: bool,
    placed: PlacedPoint<Ball<P>>,
    normal: Vector3<Ball<P>>,
    back: Three,
}

/// All that may be drawn, and where.
struct AllPossible<'a, P: Profile> {
    surfels: &'a Surfels,
    /// Colours of surfels that have none of their own; if the scene has colours.
    plain: [f32; 3],
    has: Has,
    projector: PointProjector<Ball<P>>,
    batches: Vec<(Vec<Possible<P>>, Bins)>,
}

/// What is known of a pixel.
struct Claim<P: Profile> {
    says: Says,
    /// The client's depth, if it was handed in.
    depth: Option<Ball<P>>,
    /// Of the surfels that lie in the pixel the one whose greatest depth is least.
    front: Option<(u32, Ball<P>)>,
    /// Of the samples that may be meant the one that errs least, and by how much.
    best: Option<(f64, PixelSample<Ball<P>>)>,
}

/// Judges the planes of the projection.
pub(in crate::method) fn judge<P: Profile>(
    job: &Job<'_>,
    cull: bool,
    planes: &SamplePlanes<'_>,
) -> Judged {
    let mut whole = Marks::whole(job);
    let names = planes.names();
    if !names.is_empty() {
        let possible = AllPossible::<P>::new(job, cull);
        let tiles = job.grid().rects().into_iter().enumerate().collect();
        let found = job.exec.ordered(tiles, |(tile, rect)| possible.judge(planes, (tile, rect)));
        found.into_iter().for_each(|marks| whole.put(marks));
    }
    whole.judged("projection", names)
}

impl<'a, P: Profile> AllPossible<'a, P> {
    fn new(job: &Job<'a>, cull: bool) -> Self {
        let (scene, grid) = (job.scene, job.grid());
        let surfels = &scene.surfels;
        let projector = PointProjector::new(View::new(job.camera), cull);
        let ranges = (0..surfels.len()).step_by(8192);
        let ranges = ranges.map(|first| first..surfels.len().min(first + 8192)).collect();
        let batches = job.exec.ordered(ranges, |range: std::ops::Range<usize>| {
            let place = |i| Possible::new(&projector, surfels, i, &grid);
            let possible: Vec<_> = range.filter_map(place).collect();
            let bins = Bins::new(&grid, possible.len(), |i| possible[i].bounds);
            (possible, bins)
        });
        let plain = scene.material.color.to_array();
        Self { surfels, plain, has: Has::of(scene), projector, batches }
    }

    /// Calls `visit` for each surfel that may lie in a pixel of a tile, with the count of the pixel
    /// in the tile, and whether it does lie there.
    fn each(&self, (tile, rect): (usize, &Rect), mut visit: impl FnMut(usize, &Possible<P>, bool)) {
        for (possible, bins) in &self.batches {
            bins.for_each(tile, |i| {
                let one = &possible[i as usize];
                let Rect { x0, y0, x1, y1 } = one.bounds.intersection(rect);
                for (x, y) in (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y))) {
                    let pixel = (y - rect.y0) as usize * rect.columns() + (x - rect.x0) as usize;
                    visit(pixel, one, one.lies());
                }
            });
        }
    }

    /// The sample of a surfel, seen from its back or not.
    fn sample(&self, one: &Possible<P>, back: bool) -> PixelSample<Ball<P>> {
        let i = one.surfel as usize;
        let own = || self.surfels.color().map_or(self.plain, |color| color[i].to_array());
        let color = if self.has.color { own() } else { [0.0; 3] };
        let g = if back { Ball::ONE } else { -Ball::ONE };
        let radius = Ball::from_f32(self.surfels.radius()[i]);
        let color = color.map(Ball::from_f32);
        self.projector.sample(one.surfel, &one.placed, one.normal, g, radius, color)
    }

    fn judge(&self, planes: &SamplePlanes<'_>, (tile, rect): (usize, Rect)) -> Marks {
        let mut marks = Marks::new(rect);
        let mut claims: Vec<Claim<P>> =
            counted(rect).map(|(_, at)| Claim::new(planes, at)).collect();
        self.each((tile, &rect), |pixel, one, lies| {
            if lies {
                claims[pixel].meet(one.surfel, one.placed.t);
            }
        });
        let columns = rect.columns();
        self.each((tile, &rect), |pixel, one, _| {
            let at = (rect.x0 + (pixel % columns) as u32, rect.y0 + (pixel / columns) as u32);
            if claims[pixel].may_mean(one) {
                for back in [false, true] {
                    if if back { one.back.possibly() } else { !one.back.certainly() } {
                        claims[pixel].consider(planes, at, self.sample(one, back));
                    }
                }
                marks.at(pixel).doubt(Doubt::Side, one.back.decided().is_none());
            }
        });
        for (pixel, at) in counted(rect) {
            if matches!(claims[pixel].says, Says::Empty | Says::Nothing)
                && claims[pixel].front.is_none()
            {
                claims[pixel].consider(planes, at, PixelSample::empty());
            }
            claims[pixel].judge(planes, at, &mut marks.at(pixel));
        }
        self.each((tile, &rect), |pixel, one, lies| {
            claims[pixel].doubt(one, lies, &mut marks.at(pixel));
        });
        marks
    }
}

impl<P: Profile> Possible<P> {
    /// A surfel, if it may be drawn into a pixel of the picture.
    fn new(
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
        // With culling what is drawn is seen from the front.
        let back = if projector.cull { false.into() } else { g.gt(Ball::ZERO) };
        let surfel = i as u32;
        let drawn = !dropped.possibly();
        (!bounds.is_empty()).then_some(Self { surfel, bounds, drawn, placed, normal, back })
    }

    /// Whether it certainly lies in the pixel that it may lie in.
    fn lies(&self) -> bool {
        self.drawn && self.bounds.pixels() == 1
    }
}

impl<P: Profile> Claim<P> {
    fn new(planes: &SamplePlanes<'_>, at: (u32, u32)) -> Self {
        let depth = planes.depth.map(|plane| plane.ball(at));
        Self { says: planes.says(at), depth, front: None, best: None }
    }

    /// A surfel that lies in the pixel.
    fn meet(&mut self, surfel: u32, t: Ball<P>) {
        let most = |t: Ball<P>| t.middle + t.radius;
        if self.front.is_none_or(|(_, front)| most(t) < most(front)) {
            self.front = Some((surfel, t));
        }
    }

    /// Whether the client may mean this surfel.
    fn may_mean(&self, one: &Possible<P>) -> bool {
        let hidden =
            || self.front.is_some_and(|(_, t)| decide::before(t, one.placed.t).certainly());
        match self.says {
            Says::Id(id) => id == one.surfel,
            Says::Surfel => self.depth.is_some() || !hidden(),
            Says::Nothing => !hidden(),
            Says::Empty | Says::Primitive { .. } => false,
        }
    }

    /// A sample that may be meant.
    fn consider(
        &mut self,
        planes: &SamplePlanes<'_>,
        at: (u32, u32),
        sample: PixelSample<Ball<P>>,
    ) {
        let mut worst = 0.0_f64;
        planes.check(at, &sample, &mut |_, error, _| worst = worst.at_least(error));
        if self.best.is_none_or(|(least, _)| worst < least) {
            self.best = Some((worst, sample));
        }
    }

    /// Whether the claim itself can be, and what certainly is in front of it.
    fn judge(&self, planes: &SamplePlanes<'_>, at: (u32, u32), pixel: &mut PixelMarks<'_>) {
        let mut report = |_: usize, error: f64, fault: &dyn Fn() -> Fault| {
            pixel.found(error, fault);
        };
        match (&self.best, self.says) {
            (_, Says::Primitive { kind }) => {
                planes.check_kind(at, kind, &mut report);
            }
            (Some((_, sample)), _) => planes.check(at, sample, &mut report),
            (None, Says::Id(surfel)) => {
                report(0, f64::INFINITY, &|| Fault::Absent { surfel });
            }
            // A surfel lies here: rule 3. But other planes may say what they do not of nothing.
            (None, _) if self.depth().middle == f64::INFINITY => {
                planes.check(at, &PixelSample::<Ball<P>>::empty(), &mut report);
            }
            (None, _) => {
                let (found, closest) = (self.depth().middle, f64::INFINITY);
                report(0, f64::INFINITY, &|| Fault::NoSuchDepth { found, closest });
            }
        }
        if let (Some((surfel, t)), true) = (self.front, self.says != Says::Nothing) {
            let depth = self.depth();
            if self.says != Says::Id(surfel) && decide::before(t, depth).certainly() {
                let (depth, found) = (t.middle, depth.middle);
                let error = t.distance(self.depth());
                pixel.found(error, || Fault::LeftOut { surfel, rim: 0.0, depth, found });
            }
        }
    }

    /// The depth that others are compared with.
    fn depth(&self) -> Ball<P> {
        let of_sample = || self.best.map_or(anywhere(), |(_, sample)| sample.depth);
        match self.says {
            Says::Empty => Ball::INFINITY,
            _ => self.depth.unwrap_or_else(of_sample),
        }
    }

    /// Marks what may be in front.
    fn doubt(&self, one: &Possible<P>, lies: bool, pixel: &mut PixelMarks<'_>) {
        let nearer = decide::before(one.placed.t, self.depth());
        let own = self.best.is_some_and(|(_, sample)| sample.id == one.surfel);
        if !own && nearer.possibly() {
            pixel.doubt(Doubt::Nearer, !nearer.certainly());
            pixel.doubt(Doubt::CutOff, !lies && one.drawn);
            pixel.doubt(Doubt::Fate, !one.drawn);
        }
    }
}

/// Any depth.
fn anywhere<P: Profile>() -> Ball<P> {
    Ball::new(0.0, f64::INFINITY)
}

/// The kind of an id.
fn kind_of(scene: &crate::scene::Scene, id: u32) -> Option<SampleKind> {
    let of = &scene.primitives;
    let mut first = 0;
    let ranges = [
        (scene.surfels.len(), SampleKind::Surface),
        (of.triangles.len(), SampleKind::Polygon),
        (of.ribbons.len(), SampleKind::Ribbon),
        (of.tubes.len(), SampleKind::Tube),
    ];
    if id == NO_ID {
        return Some(SampleKind::Empty);
    }
    for (count, kind) in ranges {
        first += count;
        if (id as usize) < first {
            return Some(kind);
        }
    }
    None
}
