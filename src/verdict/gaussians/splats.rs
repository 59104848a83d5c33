//! Project all Gaussians in balls.

use super::discs;
use super::supposed::{supposed_disc, supposed_ellipse, supposed_shape};
use crate::frame::{Bins, Rect};
use crate::method::Job;
use crate::method::gaussians::Order;
use crate::method::gaussians::bounds::End;
use crate::method::gaussians::record::GaussianRecord;
use crate::method::gaussians::splats::{Beside, GaussianSplat, Projected, Solid, Source};
use crate::method::part::{Nearby, Part};
use crate::number::ball::{Profile, Three};
use crate::number::{Ball, MapInline, Real, Truth, Vector2, Vector3};
use crate::splat::gaussian::ProjectedGaussian;
use crate::verdict::checks::widened;
use crate::verdict::client::known;
use crate::verdict::marks::TilePart;
use crate::verdict::supposed::Supposed;
use std::cmp::Ordering;

/// A splat that may be drawn.
pub(super) struct PossibleSplat<P: Profile> {
    /// Its bounds hold every pixel that it may touch.
    pub(super) splat: GaussianSplat<Ball<P>>,
    /// The pixels that its bounds certainly hold.
    pub(super) certain: Rect,
    /// Whether it certainly is neither behind nor degenerate.
    pub(super) sound: bool,
    /// The products of its position with the row of depth: equal products give equal depths,
    /// whatever rounds.
    pub(super) products: [f64; 3],
    /// What its fragments need beside it, if anything; most splats need nothing.
    pub(super) beside: Option<Box<Beside<Ball<P>>>>,
    /// V, (xx, xy, yy), and 1/det V; none if the conic is a client's own.
    ellipse: Option<([Ball<P>; 3], Ball<P>)>,
}

impl<P: Profile> PossibleSplat<P> {
    /// q/2 at a pixel.
    ///
    /// In balls the numbers of the conic are independent, but they share the error of 1/det, which is
    /// great where a splat is long and thin. So 1/det times the form of V is an enclosure too, with
    /// what the products of the conic round: 2^-23 each at most, of which there are three; 2^-20 is
    /// more than twice that. The smaller of both is taken.
    pub(super) fn power(&self, (x, y): (u32, u32)) -> Ball<P> {
        let GaussianSplat { center, conic, .. } = self.splat;
        let plain = ProjectedGaussian::power(center, conic, (x, y));
        let Some(([xx, xy, yy], inverse)) = self.ellipse else { return plain };
        let dx = center.x - Ball::from_f32(x as f32 + 0.5);
        let dy = center.y - Ball::from_f32(y as f32 + 0.5);
        let along = Ball::from_f32(0.5) * (yy * (dx * dx) + xx * (dy * dy));
        let across = xy * (dx * dy);
        let terms = (along.middle + across.middle.abs()) * inverse.middle;
        let shared = widened((along - across) * inverse, terms.abs() / 1_048_576.0);
        if shared.radius < plain.radius { shared } else { plain }
    }
}

/// All splats that may be drawn, ascending in the middles of their keys, with the tiles that they
/// may touch.
pub(super) struct PossibleSplats<P: Profile> {
    pub(super) all: Vec<PossibleSplat<P>>,
    bins: Bins,
}

impl<P: Profile> PossibleSplats<P> {
    /// All that may be drawn, in the order of their indices.
    pub(super) fn found(
        job: &Job<'_>,
        source: &Source<'_, Ball<P>>,
        supposed: Supposed,
    ) -> Vec<PossibleSplat<P>> {
        /// Items that one job projects.
        const SIZE: usize = 1024;
        // A step depends on the keys of all splats.
        let whole = source.settings.order == Order::Steps;
        let part = job.part.filter(|part| part.is_small() && !whole);
        let nearby = part.map(|part| Nearby::new(part, job.camera, source.skirt()));
        let near = |i: &usize| {
            nearby.as_ref().is_none_or(|nearby| {
                let (center, reach) = source.sphere(*i);
                nearby.holds(center, reach)
            })
        };
        let firsts: Vec<usize> = (0..source.len()).step_by(SIZE).collect();
        let batches = job.exec.ordered(firsts, |first| {
            let range = (first..source.len().min(first + SIZE)).filter(near);
            range.filter_map(|i| possible(job, part, source, supposed, i)).collect::<Vec<_>>()
        });
        let mut all: Vec<_> = batches.into_iter().flatten().collect();
        if source.settings.order == Order::Steps {
            steps(&mut all);
        }
        all
    }

    /// These splats, sorted and in tiles.
    pub(super) fn new(job: &Job<'_>, mut all: Vec<PossibleSplat<P>>, supposed: Supposed) -> Self {
        job.keep_touching(&mut all, |splat| splat.splat.bounds);
        if supposed == Supposed::BackToFront {
            all.iter_mut().for_each(|splat| splat.splat.key = -splat.splat.key);
        }
        all.sort_unstable_by(|a, b| {
            let by_key = a.splat.key.middle.total_cmp(&b.splat.key.middle);
            by_key.then(tie(supposed, a.splat.index, b.splat.index))
        });
        let bins = Bins::new(&job.grid(), all.len(), |i| all[i].splat.bounds);
        Self { all, bins }
    }

    /// The places of the splats that may touch some pixels of a tile, ascending.
    pub(super) fn places(&self, TilePart { tile, rect }: TilePart) -> Vec<usize> {
        let mut places = Vec::new();
        self.bins.for_each(tile, |i| {
            if !self.all[i as usize].splat.bounds.intersection(&rect).is_empty() {
                places.push(i as usize);
            }
        });
        places
    }
}

/// An item as it is projected by the rule that is supposed, and whether it is drawn at all.
pub(super) fn projected<P: Profile>(
    source: &Source<'_, Ball<P>>,
    supposed: Supposed,
    i: usize,
) -> (Projected<Ball<P>>, Three) {
    let projected = source.project_as(i, supposed_shape(source.shape(i), supposed));
    let projected = Projected {
        on_screen: supposed_ellipse(projected.on_screen, supposed),
        disc: projected.disc.map(|disc| supposed_disc(disc, supposed)),
        ..projected
    };
    let behind = match supposed {
        Supposed::NearIgnored => false.into(),
        _ => source.projector.behind(projected.on_screen.place),
    };
    let degenerate = projected.degenerate();
    let dropped = behind.certainly() || (degenerate.certainly() && !behind.possibly());
    let sound = !behind.possibly() && !degenerate.possibly();
    (projected, Three::new([sound, !dropped, !dropped]))
}

/// What the fragments of an item need beside its splat, if anything.
fn beside<P: Profile>(
    source: &Source<'_, Ball<P>>,
    projected: &Projected<Ball<P>>,
    place: Vector3<Ball<P>>,
) -> Option<Box<Beside<Ball<P>>>> {
    let own = source.settings.order == Order::Pixel;
    let solid = || {
        let adjugate = source.projector.turned(&projected.shape.adjugate);
        Beside::Solid(Solid { place, adjugate })
    };
    projected.disc.map(Beside::Disc).or_else(|| own.then(solid)).map(Box::new)
}

/// An item, if it may be drawn.
fn possible<P: Profile>(
    job: &Job<'_>,
    part: Option<Part<'_>>,
    source: &Source<'_, Ball<P>>,
    supposed: Supposed,
    i: usize,
) -> Option<PossibleSplat<P>> {
    let (projected, drawn) = projected(source, supposed, i);
    if !drawn.possibly() {
        return None;
    }
    let [bounds, certain] = bounds(job, source, &projected);
    if bounds.is_empty() || part.is_some_and(|part| !part.touches(&bounds)) {
        return None;
    }
    let Projected { shape, alpha, on_screen, .. } = projected;
    let place = on_screen.place;
    let [a, b, c, _] = source.projector.view.rows[2].map_inline(|part| part.middle);
    let p = shape.position.map(|part| part.middle);
    let splat = GaussianSplat {
        index: i as u32,
        bounds,
        center: on_screen.center,
        conic: on_screen.conic,
        alpha,
        color: source.look(i, shape.position).1,
        depth: place.z,
        key: projected.key(source.settings.order),
        reach: f32::INFINITY,
    };
    let products = [a * p.x, b * p.y, c * p.z];
    let ellipse = Some((on_screen.ellipse, Ball::ONE / on_screen.det));
    let (beside, sound) = (beside(source, &projected, place), drawn.certainly());
    Some(PossibleSplat { splat, certain, sound, products, beside, ellipse })
}

/// An item with the numbers of a client's record, in place of those that it is projected to.
///
/// A client bounds a splat by the digits of its registers, of which the record has fewer. So the
/// bounds leave open as much as those of the item itself. In a wrong record the conic may be of another
/// ellipse, which has bounds of its own.
pub(super) fn recorded<P: Profile>(
    job: &Job<'_>,
    source: &Source<'_, Ball<P>>,
    record: &GaussianRecord,
    is_wrong: bool,
    own: &Projected<Ball<P>>,
) -> Option<PossibleSplat<P>> {
    let exact = |number: f32| known::<P>(number.into(), 0.0);
    let ([x, y], alpha) = (record.center.map_inline(exact), exact(record.alpha));
    let ellipse = record.ellipse.map_inline(exact);
    let ends = ProjectedGaussian {
        center: Vector2::new(around(x, own.on_screen.center.x), around(y, own.on_screen.center.y)),
        ellipse: [0, 1, 2].map_inline(|i| around(ellipse[i], own.on_screen.ellipse[i])),
        ..own.on_screen
    };
    let ends = Projected { on_screen: ends, alpha: around(alpha, own.alpha), ..*own };
    let conic = record.conic.map_inline(exact);
    let [mut bounds, certain] = bounds(job, source, &ends);
    if is_wrong {
        let [xx, xy, yy] = conic;
        let det = xx * yy - xy * xy;
        let on_screen =
            ProjectedGaussian { ellipse: [yy / det, -xy / det, xx / det], ..ends.on_screen };
        let [of_conic, _] = self::bounds(job, source, &Projected { on_screen, ..ends });
        bounds = bounds.hull(&of_conic);
    }
    if bounds.is_empty() {
        return None;
    }
    let [x_of_camera, y_of_camera, depth] = record.place.map_inline(exact);
    let splat = GaussianSplat {
        index: record.index,
        bounds,
        center: Vector2::new(x, y),
        conic,
        alpha,
        color: record.color.map_inline(exact),
        depth,
        key: exact(record.key),
        reach: f32::INFINITY,
    };
    let beside = beside(source, own, Vector3::new(x_of_camera, y_of_camera, depth));
    // Exact keys need no products to be known equal.
    let products = [f64::NAN; 3];
    Some(PossibleSplat { splat, certain, sound: true, products, beside, ellipse: None })
}

/// A stored number with as much room as the projected one has.
fn around<P: Profile>(number: Ball<P>, own: Ball<P>) -> Ball<P> {
    Ball::new(number.middle, number.radius + own.radius)
}

/// The pixels that an item may touch, and those that its bounds certainly hold.
fn bounds<P: Profile>(
    job: &Job<'_>,
    source: &Source<'_, Ball<P>>,
    Projected { on_screen, alpha, disc, .. }: &Projected<Ball<P>>,
) -> [Rect; 2] {
    if let Some(disc) = disc {
        let [least, most] = alpha.ends();
        let bounds = |alpha, end| {
            source.bounds_of_disc(disc, Ball::ends, source.reach(alpha), discs::SLACK, end)
        };
        return [bounds(most, End::Most), bounds(least, End::Least)];
    }
    let [x, y] = [on_screen.center.x, on_screen.center.y].map_inline(|at| at.ends());
    let ellipse = on_screen.ellipse.map_inline(Ball::ends);
    let [least, most] = alpha.ends();
    let known = ellipse.iter().chain([&x, &y]).flatten().all(|end| end.is_finite());
    if !known {
        return [job.picture(), Rect::default()];
    }
    let [xx, xy, yy] = ellipse;
    // The extents grow with each element; that of the cross term by its magnitude.
    let across = [xy[0].abs(), xy[1].abs()];
    let [small, large] = if across[0] < across[1] { across } else { [across[1], across[0]] };
    let small = if xy[0] < 0.0 && xy[1] > 0.0 { 0.0 } else { small };
    let positive = |end: f64| if end > 0.0 { end } else { 0.0 };
    let widest = source.bounds([x, y], [xx[1], large, yy[1]], most, source.reach(most));
    let ends = [[x[1], x[0]], [y[1], y[0]]];
    let smallest = [positive(xx[0]), small, positive(yy[0])];
    [widest, source.bounds(ends, smallest, least, source.reach(least))]
}

/// The order of two items with the same key.
pub(super) fn tie(supposed: Supposed, a: u32, b: u32) -> Ordering {
    if supposed == Supposed::HigherIndexFirst { b.cmp(&a) } else { a.cmp(&b) }
}

/// Replaces each key by its step, over all that may be drawn.
fn steps<P: Profile>(all: &mut [PossibleSplat<P>]) {
    // One that may not be drawn may widen the range or not.
    let range = |splats: &mut dyn Iterator<Item = Ball<P>>| {
        splats.fold(None, |range: Option<[Ball<P>; 2]>, key| match range {
            None => Some([key, key]),
            Some([least, most]) => Some([least.at_most(key), most.at_least(key)]),
        })
    };
    let every = range(&mut all.iter().map(|splat| splat.splat.key));
    let drawn = |splat: &&PossibleSplat<P>| splat.sound && !splat.certain.is_empty();
    let certain = range(&mut all.iter().filter(drawn).map(|splat| splat.splat.key));
    let Some([least, most]) = every else { return };
    let [least, most] =
        certain.map_or([least, most], |[inner, outer]| [least.either(inner), most.either(outer)]);
    let range = most - least;
    for PossibleSplat { splat, .. } in all {
        let share = (splat.key - least) / range;
        let step = (share * Ball::from_f32(65_535.0)).floor();
        splat.key = Ball::select(range.gt(Ball::ZERO), step, Ball::ZERO);
    }
}
