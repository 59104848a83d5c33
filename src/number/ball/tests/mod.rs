//! The ball holds every lawful value of the crate's formulas, and variants that round too little do
//! not; then each rule of the module's page.

pub(crate) mod lawful;
mod light;
mod scenes;

use super::profile::no_terms;
use super::*;
use crate::frame::Exec;
use crate::number::random::bits;
use crate::number::{Pixel, Truth};
use lawful::{Law, Lawful};
use scenes::{KINDS, Problem, QUANTITIES, Quantities, VALUES, quantity};
use std::ops::Range;

/// For each quantity, how many values escaped, and the worst distance from a midpoint in radii.
struct Found {
    escaped: usize,
    worst: [f64; QUANTITIES.len()],
}

/// Runs `count` problems of every kind of scene, in `f32` as a coin decides its rounding; on all
/// cores.
fn soundness<P: Profile>(law: Law, seed: u64, count: u64) -> Found {
    let exec = Exec::new(0, 32).expect("all cores");
    let jobs = (0..count).step_by(1000).map(|first| first..count.min(first + 1000));
    let found = exec.ordered(jobs.collect(), |indices: Range<u64>| {
        let mut found = Found { escaped: 0, worst: [0.0; QUANTITIES.len()] };
        for (index, kind) in indices.flat_map(|i| KINDS.into_iter().map(move |kind| (i, kind))) {
            found.ask::<P>(law, seed, &Problem::new(kind, seed, index));
        }
        found
    });
    found.into_iter().reduce(Found::and).expect("a job")
}

impl Found {
    fn ask<P: Profile>(&mut self, law: Law, seed: u64, problem: &Problem) {
        lawful::begin(law, bits(seed, problem.index));
        let (client, records) = problem.evaluate::<Lawful>();
        let balls = problem.judge::<P>(client.crosses, &records);
        for (i, (value, ball)) in client.values.iter().zip(&balls.values).enumerate() {
            let (value, worst) = (f64::from(value.value), &mut self.worst[quantity(i)]);
            self.escaped += usize::from(!ball.contains(value));
            let away = (value - ball.middle).abs() / ball.radius;
            if ball.radius.is_finite() && away > *worst {
                *worst = away;
            }
        }
    }

    fn and(mut self, other: Self) -> Self {
        self.escaped += other.escaped;
        for (worst, other) in self.worst.iter_mut().zip(other.worst) {
            *worst = worst.at_least(other);
        }
        self
    }
}

#[test]
fn no_lawful_value_escapes() {
    for (found, least) in [
        (soundness::<Ieee>(Law::Ieee, 1, 5_000), 0.1),
        (soundness::<Precise>(Law::Precise, 1, 5_000), 0.02),
        (soundness::<Gpu>(Law::Gpu, 1, 5_000), 0.02),
    ] {
        assert_eq!(found.escaped, 0, "{:?}", found.worst);
        for (name, worst) in QUANTITIES.iter().zip(found.worst) {
            // A bound that no value comes near would say little; 1 is the end of the ball.
            assert!((least..=1.0 + 1e-9).contains(&worst), "{name}: {worst} of the radius");
        }
    }
}

#[test]
fn what_a_gpu_may_do_escapes_from_balls_that_round_once() {
    assert!(soundness::<Ieee>(Law::Gpu, 1, 1_000).escaped > 100);
    assert!(soundness::<Ieee>(Law::Precise, 1, 1_000).escaped > 100);
    assert!(soundness::<Precise>(Law::Gpu, 1, 1_000).escaped > 100);
}

#[test]
#[ignore = "10^9 values, minutes: longer than .ci/run may take"]
fn no_lawful_value_escapes_of_a_billion() {
    let each = (KINDS.len() * VALUES) as u64;
    let problems = 500_000_000_u64.div_ceil(each);
    assert_eq!(soundness::<Ieee>(Law::Ieee, 2, problems).escaped, 0);
    assert_eq!(soundness::<Gpu>(Law::Gpu, 2, problems).escaped, 0);
}

/// A profile that rounds as [`Ieee`] except for one number.
macro_rules! twin {
    ($name:ident, $sum:expr, $product:expr, $quotient:expr, $root:expr, $tiny:expr) => {
        #[derive(Clone, Copy)]
        struct $name;
        impl Profile for $name {
            no_terms!();
            const ROUNDS_TO_NEAREST: bool = true;
            const ROUNDS_ALL_TO_NEAREST: bool = true;
            const FLUSHES: bool = false;
            const PRODUCT: f64 = $product;
            const QUOTIENT: f64 = $quotient;
            const LARGEST_DIVISOR: f64 = f64::INFINITY;
            const ROOT: f64 = $root;
            const TINY: f64 = $tiny;
            fn exponential(argument: f64) -> f64 {
                Ieee::exponential(argument)
            }
            fn power(bases: [f64; 2], exponent: f64) -> f64 {
                Ieee::power(bases, exponent)
            }
            fn sum(middle: f64, [a, b]: [&Ball<Self>; 2]) -> Ball<Self> {
                Ball::rounded(middle, a.radius + b.radius, $sum, 0.0)
            }
        }
    };
}

twin!(HalfSum, 0.5, 1.0, 1.0, 1.0, Ieee::TINY);
twin!(HalfProduct, 1.0, 0.5, 1.0, 1.0, Ieee::TINY);
twin!(HalfQuotient, 1.0, 1.0, 0.5, 1.0, Ieee::TINY);
twin!(HalfRoot, 1.0, 1.0, 1.0, 0.5, Ieee::TINY);
twin!(NoUnderflow, 1.0, 1.0, 1.0, 1.0, 0.0);

#[test]
fn a_ball_that_rounds_too_little_is_caught() {
    // One operation at a time, because in a long formula the slack of the others hides half a
    // rounding.
    fn escapes<P: Profile>() -> bool {
        (0..20_000).any(|i| {
            let [a, b] = scenes::operands(i);
            let [x, y] = [a, b].map(Ball::<P>::from_f32);
            let pairs =
                [(x + y, a + b), (x * y, a * b), (x / y, a / b), (x.abs().sqrt(), a.abs().sqrt())];
            pairs.iter().any(|(ball, value)| !ball.contains((*value).into()))
        })
    }
    assert!(!escapes::<Ieee>());
    assert!(escapes::<HalfSum>(), "half a rounding of sums");
    assert!(escapes::<HalfProduct>(), "half a rounding of products");
    assert!(escapes::<HalfQuotient>(), "half a rounding of quotients");
    assert!(escapes::<HalfRoot>(), "half a rounding of roots");
    assert!(escapes::<NoUnderflow>(), "nothing lost below the normal numbers");
    assert!(soundness::<HalfSum>(Law::Ieee, 1, 10_000).escaped > 0, "in the formulas of the crate");
}

#[test]
fn the_midpoint_is_the_value_in_f64_bit_for_bit() {
    for kind in KINDS {
        for index in 0..500 {
            let problem = Problem::new(kind, 3, index);
            let (truth, records) = problem.evaluate::<f64>();
            let balls: Quantities<Ball> = problem.judge::<Ieee>(truth.crosses, &records);
            for (i, (value, ball)) in truth.values.iter().zip(&balls.values).enumerate() {
                let name = QUANTITIES[quantity(i)];
                let same = value.to_bits() == ball.middle.to_bits();
                assert!(same || value.is_nan() && ball.middle.is_nan(), "{kind:?} {index} {name}");
            }
        }
    }
}

fn ball(middle: f64, radius: f64) -> Ball {
    Ball::new(middle, radius)
}

#[test]
fn what_needs_no_rounding_is_exact() {
    let [a, b, three] = [0.75_f32, 4.0, 3.0].map(Ball::<Ieee>::from_f32);
    for (exact, value) in [(a + b, 4.75), (a * b, 3.0), (a / b, 0.1875), (b.sqrt(), 2.0)] {
        assert_eq!((exact.middle, exact.radius), (value, 0.0));
    }
    let third = a / (b * three * three);
    assert!(third.radius > 0.0 && third.radius < 1e-8, "{third:?}");
    assert_eq!((Ball::ZERO * third).radius, 0.0, "0 times anything");
    assert_eq!((Ball::ZERO / third).radius, 0.0);
    // 1 + 2^-60 is no f64, but rounds to 1 in both.
    let sum = Ball::<Ieee>::ONE + Ball::from_f32(f32::from_bits((127 - 60) << 23));
    assert_eq!((sum.middle, sum.radius), (1.0, 0.0));
    let depth_of_nothing: Ball = Ball::ONE / Ball::ZERO;
    assert_eq!((depth_of_nothing.middle, depth_of_nothing.radius), (f64::INFINITY, 0.0));
}

#[test]
fn what_may_be_infinite_or_nan_says_so() {
    let [about_zero, one, wide] = [ball(0.1, 0.2), ball(1.0, 0.5), ball(3e38, 1e38)];
    let infinite = |ball: Ball| ball.radius == f64::INFINITY;
    assert!(infinite(one / about_zero), "the divisor may be 0");
    assert!(infinite(wide + wide) && infinite(wide * one), "beyond the largest f32");
    assert!((about_zero / about_zero).radius.is_nan(), "0 / 0");
    assert!((about_zero * (one / about_zero)).radius.is_nan(), "0 times infinity");
    assert!(((one / about_zero) - (one / about_zero)).radius.is_nan(), "infinity - infinity");
    assert!(about_zero.sqrt().radius.is_nan(), "a root below 0");
    assert!(infinite(ball(88.0, 2.0).exp()));
    let nan = Ball::<Ieee>::from_f32(f32::NAN);
    assert!((nan + one).radius.is_nan() && nan.clamped(one, wide).radius.is_nan());
    for unbounded in [one / about_zero, nan] {
        assert!(!unbounded.is_finite().certainly() && !unbounded.lt(one).certainly());
        assert!(unbounded.lt(one).possibly() && unbounded.ge(one).possibly());
    }
}

#[test]
fn bounds_are_taken_of_both_ends() {
    let [low, high] = [1.0, 2.0].map(Ball::<Ieee>::exact);
    let unbounded = ball(1.5, f64::INFINITY).clamped(low, high);
    assert_eq!((unbounded.middle, unbounded.radius <= 0.5 + 1e-9), (1.5, true), "{unbounded:?}");
    let inside = ball(1.5, 0.25).clamped(low, high);
    assert_eq!((inside.middle, inside.radius), (1.5, 0.25));
    let beyond = ball(9.0, 1.0).clamped(low, high);
    assert_eq!((beyond.middle, beyond.radius), (2.0, 0.0));
    let cut = ball(1.9, 0.5).at_most(high);
    assert!(cut.contains(1.4) && cut.contains(2.0) && cut.middle == 1.9, "{cut:?}");
    assert_eq!(Ball::<Ieee>::INFINITY.at_most(high).middle, 2.0);
}

#[test]
fn comparisons_have_three_outcomes() {
    let [one, near, two] = [ball(1.0, 0.1), ball(1.1, 0.1), ball(2.0, 0.0)];
    assert_eq!(one.lt(two).decided(), Some(true));
    assert_eq!(two.le(one).decided(), Some(false));
    assert_eq!((one.lt(near).decided(), one.lt(near).middle()), (None, true));
    assert_eq!((one.ge(near).decided(), one.ge(near).middle()), (None, false));
    let tie = Ball::<Ieee>::exact(1.0);
    assert_eq!([tie.lt(tie), tie.le(tie)].map(Three::decided), [Some(false), Some(true)]);
    let [no, maybe, yes] = [two.lt(one), one.lt(near), one.lt(two)];
    assert_eq!(
        [(maybe & no), (maybe & yes), (maybe | yes), !maybe].map(Three::decided),
        [Some(false), None, Some(true), None]
    );
    let hull = Ball::select(maybe, ball(5.0, 0.5), ball(1.0, 0.25));
    assert!(hull.middle == 5.0 && hull.contains(0.75) && hull.contains(5.5), "{hull:?}");
    let chosen = Ball::select(yes, ball(5.0, 0.5), ball(1.0, 0.25));
    assert_eq!((chosen.middle, chosen.radius), (5.0, 0.5));
}

#[test]
fn a_coordinate_at_a_border_has_the_pixels_of_both_sides() {
    let pixels = |ball: Ball| [ball.to_pixel().least(), ball.to_pixel().greatest()];
    assert_eq!(pixels(ball(7.01, 0.1)), [6, 7]);
    assert_eq!(pixels(ball(7.0, 0.0)), [7, 7]);
    assert_eq!(pixels(ball(0.05, 0.1)), [0, 0]);
    assert_eq!(pixels(ball(7.0, f64::INFINITY)), [0, 1 << 22]);
    let floor = ball(7.01, 0.1).floor();
    assert_eq!((floor.middle, floor.radius), (7.0, 1.0), "6 or 7; a ball holds 8 too");
}
