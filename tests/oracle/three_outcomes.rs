//! The formulas and the decisions of the crate over a number with three outcomes, [`Interval`].
//!
//! A decision of an interval must allow what f64 decides for any of the numbers in the interval,
//! and each decision must meet all three outcomes, or the test would test nothing.

use crate::oracle::kit::scene::OUTLINES;
use crate::oracle::three::{Interval, Three};
use glam::DVec3;
use splatref::composite::{bins, decide, groups, mean, sum, under};
use splatref::method::projection::surfels::PointProjector;
use splatref::method::projection::{PixelSample, SampleKind};
use splatref::method::pyramid::{self, Occlusion, Weights, pull, push};
use splatref::method::template::{self, propagation};
use splatref::number::random::unit;
use splatref::number::{Real, Vector2, Vector3};
use splatref::scene::{self, Camera, Pose};
use splatref::splat::project::project_as;
use splatref::splat::{Disc, Footprint, Kernel, Projector, Shared, View, fragment, project};
use std::collections::BTreeMap;

/// How often each decision had each outcome.
#[derive(Default)]
struct Outcomes(BTreeMap<&'static str, [u32; 3]>);

impl Outcomes {
    /// Notes an outcome, which must allow the answer of f64.
    fn note(&mut self, decision: &'static str, truth: Three, answer: bool) {
        assert!(truth.allows(answer), "{decision}: {truth:?}, but f64 says {answer}");
        self.0.entry(decision).or_default()[truth as usize] += 1;
    }

    /// Every decision had every outcome.
    fn are_complete(&self) {
        for (decision, outcomes) in &self.0 {
            assert!(outcomes.iter().all(|n| *n > 0), "{decision}: yes, no, undecided {outcomes:?}");
        }
    }
}

/// Random numbers, one after the other.
struct Dice(u64);

impl Dice {
    /// A number in [low, high).
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 += 1;
        low + (high - low) * f64::from(unit(21, self.0))
    }

    /// An interval about a number in [low, high), of any width from a point to a twentieth, and one
    /// of its numbers.
    fn pair(&mut self, low: f64, high: f64) -> (Interval, f64) {
        let part = [0.0, 1e-9, 1e-3, 0.05][self.between(0.0, 4.0) as usize];
        let interval = Interval::around(self.between(low, high), part);
        (interval, interval.at(self.between(0.0, 1.0)))
    }

    fn vector(&mut self, low: f64, high: f64) -> (Vector3<Interval>, Vector3<f64>) {
        let [x, y, z] = [0; 3].map(|_| self.pair(low, high));
        (Vector3::new(x.0, y.0, z.0), Vector3::new(x.1, y.1, z.1))
    }
}

/// A decision of two numbers, and of intervals of them.
macro_rules! two {
    ($outcomes:ident, $dice:ident, $($decision:ident)*) => {$({
        let ((a, x), (b, y)) = ($dice.pair(0.5, 1.5), $dice.pair(0.5, 1.5));
        $outcomes.note(stringify!($decision), decide::$decision(a, b), decide::$decision(x, y));
    })*};
}

#[test]
fn every_decision_has_three_outcomes() {
    let (mut outcomes, mut dice) = (Outcomes::default(), Dice(0));
    for i in 0..3_000 {
        two!(outcomes, dice, inside nearer visible beyond nearer_bin before holds overlaps moves);
        let [(a, x), (b, y), (c, z), (d, w)] = [0; 4].map(|_| dice.pair(0.5, 1.5));
        let outside = i % 2 == 0;
        let truth = decide::occluded(a, [b, c], outside);
        outcomes.note("occluded", truth, decide::occluded(x, [y, z], outside));
        outcomes.note("opaque", decide::opaque(a), decide::opaque(x));
        let truth = decide::nearer_or_lower((a, i), (b, 1_500));
        outcomes.note("nearer_or_lower", truth, decide::nearer_or_lower((x, i), (y, 1_500)));
        let truth = decide::before_or_lower((a, i), (b, 1_500));
        outcomes.note("before_or_lower", truth, decide::before_or_lower((x, i), (y, 1_500)));
        let four = [Interval::from_f32(0.25), c].map(|radius| [a, radius]);
        let small = Interval::from_f32(0.125);
        let truth = decide::meets(four[0], [b, small]);
        outcomes.note("meets", truth, decide::meets([x, 0.25], [y, 0.125]));
        let (truth, answer) = (
            decide::ternary([a, small * d], [b, small * c]),
            decide::ternary([x, 0.125 * w], [y, 0.125 * z]),
        );
        outcomes.note("ternary before", truth.before, answer.before);
        outcomes.note("ternary behind", truth.behind, answer.behind);
        // Values that a condition chooses.
        assert!(decide::limit(a, b).holds(decide::limit(x, y)));
        let range = bins::Range { nearest: 0.75, farthest: 1.25, count: 7 };
        let (wide, exact) = (bins::DepthBins::new(&range), bins::DepthBins::<f64>::new(&range));
        assert!(wide.voronoi(a, b).holds(exact.voronoi(x, y)));
        let (weight, w) = (a - b, x - y);
        assert!(
            sum::average([c; 3], weight)[0].holds(sum::average([z; 3], w)[0]) || w.abs() < 1e-300
        );
        let layers = under::Under::CLEAR.map(Interval::point).under(a - b, [c; 3]);
        assert!(layers.alpha.holds(under::Under::CLEAR.under(x - y, [z; 3]).alpha));
        let part = groups::WeightedFragment::new(x, y, [z; 3], [w; 3], z);
        assert!(part.map(Interval::point).weight.holds(y));
    }
    outcomes.are_complete();
}

fn camera(orthographic: bool) -> Camera {
    let lens = if orthographic { scene::Lens::Orthographic(6.0) } else { scene::Lens::Focal(40.0) };
    let pose = Pose { eye: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y };
    let mut camera = Camera::new(40, 32, pose, lens).expect("a plain camera");
    camera.near = 0.5;
    camera
}

/// Every number of a footprint.
fn numbers<R: Copy>(f: &Footprint<R>) -> [R; 11] {
    let c = f.center;
    [c.x, c.y, f.ux, f.uy, f.vy, f.w0, f.wx, f.wy, f.w_far, f.w_near, f.amplitude]
}

/// A disc of intervals before the camera, and one of the discs that it stands for.
fn discs(dice: &mut Dice) -> (Disc<Interval>, Disc<f64>) {
    let ((wide, exact), (normals, normal)) = (dice.vector(-1.5, 1.5), dice.vector(-1.0, 1.0));
    let (t, depth) = dice.pair(0.3, 4.0);
    let (radii, radius) = dice.pair(0.01, 0.5);
    let tangents =
        (dice.between(0.0, 4.0) < 1.0).then(|| [dice.vector(-0.3, 0.3), dice.vector(-0.3, 0.3)]);
    let position = Vector3::new(exact.x, exact.y, -depth);
    (
        Disc {
            position: Vector3::new(wide.x, wide.y, -t),
            normal: normals,
            radius: radii,
            tangents: tangents.map(|pair| pair.map(|(wide, _)| wide)),
        },
        Disc { position, normal, radius, tangents: tangents.map(|pair| pair.map(|(_, v)| v)) },
    )
}

/// The fragments of a splat of intervals hold those of a splat.
fn fragments(
    outcomes: &mut Outcomes,
    (shared, wide): (&Shared<Interval>, &Footprint<Interval>),
    (exact, footprint): (&Shared<f64>, &Footprint<f64>),
) {
    for (x, y) in (0..32).step_by(5).flat_map(|y| (0..40).step_by(5).map(move |x| (x, y))) {
        let ((q, w), (form, nearness)) =
            (fragment(shared, wide, (x, y)), fragment(exact, footprint, (x, y)));
        assert!(q.holds(form) && w.holds(nearness), "{q:?} {form} {w:?} {nearness}");
        assert!(wide.weight(q).holds(footprint.weight(form)));
        if !form.is_nan() {
            let truth = decide::inside(q, shared.limit);
            outcomes.note("inside", truth, decide::inside(form, exact.limit));
        }
    }
}

#[test]
fn a_projected_interval_holds_what_is_projected_from_it() {
    let (mut outcomes, mut dice) = (Outcomes::default(), Dice(0));
    for (outline, orthographic) in OUTLINES.into_iter().flat_map(|o| [(o, false), (o, true)]) {
        let kernel = Kernel { outline, ..Kernel::DEFAULT };
        let camera = camera(orthographic);
        let (view, exact) = (View::<Interval>::new(&camera), View::<f64>::new(&camera));
        let shared = (Shared::new(&view, &kernel), Shared::new(&exact, &kernel));
        let (many, one) =
            (Projector::new(view, &kernel, true), Projector::new(exact, &kernel, true));
        for i in 0..1_500 {
            let (wide, disc) = discs(&mut dice);
            let (splat, reasons) = project(&one, &disc, i);
            let crosses = many.crosses(&wide);
            if !orthographic {
                outcomes.note("crosses", crosses, one.crosses(&disc));
            }
            let (found, why) = project_as(&many, &wide, i, one.crosses(&disc));
            outcomes.note("behind", why.behind, reasons.behind);
            if reasons.degenerate || reasons.behind {
                continue;
            }
            assert!(why.degenerate.allows(false));
            outcomes.note("back facing", why.back_facing, reasons.back_facing);
            // Where the bounds are empty in f64 alone, there is no fragment to disagree on.
            if !splat.bounds.is_empty() {
                outcomes.note("outside", why.outside, reasons.outside);
            }
            outcomes.note("back", found.back, splat.back);
            let pairs = numbers(&found.footprint).into_iter().zip(numbers(&splat.footprint));
            assert!(pairs.clone().all(|(wide, value)| wide.holds(value)), "{:?}", disc);
            let both = found.bounds.intersection(&splat.bounds);
            assert!(splat.bounds.is_empty() || both == splat.bounds, "bounds are rounded outwards");
            fragments(&mut outcomes, (&shared.0, &found.footprint), (&shared.1, &splat.footprint));
            // On a record as it was stored.
            let stored = splat.map(Interval::point);
            let shared = (shared.1.map(Interval::point), shared.1);
            fragments(&mut outcomes, (&shared.0, &stored.footprint), (&shared.1, &splat.footprint));
        }
    }
    outcomes.are_complete();
}

#[test]
fn the_projection_to_pixels_has_three_outcomes() {
    let (mut outcomes, mut dice) = (Outcomes::default(), Dice(0));
    let camera = camera(false);
    let many = PointProjector::new(View::<Interval>::new(&camera), true);
    let one = PointProjector::new(View::<f64>::new(&camera), true);
    for _ in 0..5_000 {
        let (wide, disc) = discs(&mut dice);
        let (found, g, why) = many.reasons(wide.position, wide.normal);
        let (placed, facing, reasons) = one.reasons(disc.position, disc.normal);
        outcomes.note("behind", why.behind, reasons.behind);
        outcomes.note("back facing", why.back_facing, reasons.back_facing);
        outcomes.note("outside", why.outside, reasons.outside);
        assert!(why.degenerate.allows(reasons.degenerate));
        if reasons.fate() == splatref::splat::Fate::Visible {
            for (all, pixel) in found.pixel().into_iter().zip(placed.pixel()) {
                assert!(splatref::number::Pixel::least(all) <= pixel);
                assert!(pixel <= splatref::number::Pixel::greatest(all));
            }
            let turned = many.sample(0, &found, wide.normal, g, wide.radius, [g; 3]);
            let sample = one.sample(0, &placed, disc.normal, facing, disc.radius, [facing; 3]);
            assert!(turned.normal.x.holds(sample.normal.x) && turned.extent.holds(sample.extent));
        }
    }
    outcomes.are_complete();
}

/// A sample of a pixel, and an interval about each of its numbers.
fn sample(dice: &mut Dice) -> (PixelSample<Interval>, PixelSample<f64>) {
    let (color, radius) = ([0; 3].map(|_| dice.between(0.0, 1.0)), dice.between(0.1, 0.5));
    let [x, y] = [0; 2].map(|_| dice.between(-2.0, 2.0));
    let sample = PixelSample {
        kind: SampleKind::Surface,
        id: 7,
        depth: dice.between(1.0, 2.0),
        radius,
        extent: dice.between(0.5, 3.0),
        center: Vector2::new(x, y),
        normal: Vector3::new(dice.between(-0.5, 0.5), dice.between(-0.5, 0.5), 1.0),
        tangent: Vector3::new(0.0, 0.0, 0.0),
        color,
    };
    (sample.map(|value| Interval::around(value, 0.02)), sample)
}

#[test]
fn cells_and_centers_have_three_outcomes() {
    let (mut outcomes, mut dice) = (Outcomes::default(), Dice(0));
    for _ in 0..2_000 {
        let four = [0; 4].map(|_| sample(&mut dice));
        let takes = [0; 4].map(|_| dice.between(0.0, 1.0) < 0.5);
        let first = takes.iter().position(|takes| *takes).unwrap_or(0);
        let takes = std::array::from_fn(|j| takes[j] || j == first);

        let (wide, cells) = (
            four.map(|(wide, _)| pyramid::Cell::new(&wide)),
            four.map(|(_, s)| pyramid::Cell::new(&s)),
        );
        let (many, one) = (pull::offsets(&wide, Interval::ONE), pull::offsets(&cells, 1.0));
        let truths = pyramid::Cell::inside(&wide, &many);
        for (truth, inside) in truths.into_iter().zip(pyramid::Cell::inside(&cells, &one)) {
            outcomes.note("inside of a pull", truth, inside);
        }
        let merged = pull::merge(&wide, &many, takes, first);
        let cell = pull::merge(&cells, &one, takes, first);
        assert!(merged.front.holds(cell.front) && merged.normal.x.holds(cell.normal.x));

        let many = push::offsets(&wide, true, false, Interval::from_f32(0.5));
        let one = push::offsets(&cells, true, false, 0.5);
        let truths = pyramid::Cell::inside(&wide, &many);
        for (truth, inside) in truths.into_iter().zip(pyramid::Cell::inside(&cells, &one)) {
            outcomes.note("inside of a push", truth, inside);
        }
        let merged = push::merge(&wide, &many, Weights::Gaussian, takes, first);
        let cell = push::merge(&cells, &one, Weights::Gaussian, takes, first);
        assert!(merged.extent.holds(cell.extent) && merged.back.holds(cell.back));
        let truth = push::occluded(&wide[0], &wide[1], Occlusion::Outside);
        outcomes.note("occluded", truth, push::occluded(&cells[0], &cells[1], Occlusion::Outside));

        let wide = four.map(|(wide, _)| template::Center::new(&wide));
        let centers = four.map(|(_, s)| template::Center::new(&s));
        for (truth, near) in
            propagation::near(&wide, 0).into_iter().zip(propagation::near(&centers, 0))
        {
            outcomes.note("near", truth, near);
        }
        let reach = 1.5;
        let truth = propagation::moves(&wide[0], Interval::point(reach));
        outcomes.note("moves", truth, propagation::moves(&centers[0], reach));
        let merged = propagation::merge(&wide, takes, first);
        assert!(merged.depth.holds(propagation::merge(&centers, takes, first).depth));
        let mean = mean::Mean::plain(takes);
        assert!(
            mean.average(wide.map(|c| c.extent))
                .holds(mean::Mean::plain(takes).average(centers.map(|c| c.extent)))
        );
    }
    outcomes.are_complete();
}
