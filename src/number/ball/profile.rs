//! Choose which roundings an implementation may use.

use super::Ball;
use crate::number::lanes::LANES;
use crate::number::{Real, elementary};
use std::marker::PhantomData;

/// What an implementation promises about its operations, in units of u = 2^-24 of the result.
pub trait Profile: Copy + Send + Sync + 'static {
    /// What a ball must remember of the sum that produced it, so that its terms may be added in
    /// another order.
    type Terms: Copy + Send + Sync;
    /// The terms of a number that is not a sum.
    const NO_SUM: Self::Terms;

    /// Whether a sum or a product is the `f32` nearest to the exact result, so that a result that
    /// needs no rounding is exact.
    const ROUNDS_TO_NEAREST: bool;
    /// Whether the result of every other operation is, too.
    const ROUNDS_ALL_TO_NEAREST: bool;
    /// Whether numbers below the normal ones may become 0.
    const FLUSHES: bool;
    /// Rounding of a product.
    const PRODUCT: f64;
    /// Rounding of a quotient.
    const QUOTIENT: f64;
    /// The largest divisor for which a quotient keeps its promise; the least is the least normal
    /// number.
    const LARGEST_DIVISOR: f64;
    /// Rounding of a square root.
    const ROOT: f64;
    /// The most that an operation loses below the normal numbers.
    const TINY: f64;
    /// Whether the results of rare operations are unknown, see `common.rs`.
    const COMMON_ONLY: bool = false;

    /// Rounding of the exponential of a number of at most this absolute value.
    fn exponential(argument: f64) -> f64;
    /// Rounding of a power whose base lies between these two.
    fn power(bases: [f64; 2], exponent: f64) -> f64;
    /// The sum of bounded terms, of midpoint `middle`. The radius is valid only if the sum is
    /// bounded too.
    fn sum(middle: f64, terms: [&Ball<Self>; 2]) -> Ball<Self>;
    /// Whether the terms of a sum may be added in any order.
    const ADDS_IN_ANY_ORDER: bool = false;
    /// Where terms may be added in any order: the sum, of midpoint `middle`, of terms that are not
    /// sums. The triple holds the magnitude of all terms, their number, and the radius that they
    /// bring along. The radius is valid only if every partial sum is bounded.
    fn total(middle: f64, _terms: [f64; 3]) -> Ball<Self> {
        Ball::new(middle, f64::NAN)
    }
    /// Chooses the terms of one of two sums, number by number, because a choice between wholes does
    /// not vectorize.
    fn choose(truth: bool, yes: Self::Terms, no: Self::Terms) -> Self::Terms;
    /// The terms of [`LANES`] numbers side by side, number by number for the same reason.
    type TermLanes: Copy + Send + Sync;
    /// The terms of lanes that are not sums.
    const NO_SUMS: Self::TermLanes;
    /// Puts the terms of a number into a lane.
    fn put_terms(lanes: &mut Self::TermLanes, lane: usize, terms: Self::Terms);
    /// Reads the terms of a lane.
    fn terms_of(lanes: &Self::TermLanes, lane: usize) -> Self::Terms;
}

/// The parts of a [`Profile`] that adds terms in the written order: a ball remembers none of them.
macro_rules! no_terms {
    () => {
        type Terms = ();
        const NO_SUM: () = ();
        #[inline(always)]
        fn choose(_truth: bool, _yes: (), _no: ()) {}
        type TermLanes = ();
        const NO_SUMS: () = ();
        #[inline(always)]
        fn put_terms(_lanes: &mut (), _lane: usize, _terms: ()) {}
        #[inline(always)]
        fn terms_of(_lanes: &(), _lane: usize) {}
    };
}
#[cfg(test)]
pub(super) use no_terms;

/// IEEE 754, the definition of the crate: each operation rounds once, to nearest. A product may be
/// fused with the sum that it goes into.
#[derive(Clone, Copy, Debug)]
pub struct Ieee;

/// Half the distance of neighbouring denormal `f32`, 2^-150, and a little more.
const HALF_DENORMAL: f64 = f32::from_bits(1) as f64 * 0.500_001;

impl Profile for Ieee {
    no_terms!();
    const ROUNDS_TO_NEAREST: bool = true;
    const ROUNDS_ALL_TO_NEAREST: bool = true;
    const FLUSHES: bool = false;
    const PRODUCT: f64 = 1.0;
    const QUOTIENT: f64 = 1.0;
    const LARGEST_DIVISOR: f64 = f64::INFINITY;
    const ROOT: f64 = 1.0;
    const TINY: f64 = HALF_DENORMAL;

    fn exponential(_argument: f64) -> f64 {
        1.0
    }
    fn power(_bases: [f64; 2], _exponent: f64) -> f64 {
        1.0
    }
    #[inline(always)]
    fn sum(middle: f64, [a, b]: [&Ball<Self>; 2]) -> Ball<Self> {
        // A sum below the normal numbers is exact.
        Ball::new(middle, Ball::<Self>::reach(middle, a.radius + b.radius, 1.0, 0.0))
    }
}

/// IEEE 754 for sums and products, and what a device has for the rest: between [`Ieee`] and [`Gpu`].
///
/// Sums and products round once, to nearest, in the order that is written; a product may be fused
/// with the sum that it goes into. Quotients, square roots, exponentials, powers and angles are as
/// inexact as [`Gpu`] allows. Numbers below the normal ones may be flushed to 0.
#[derive(Clone, Copy, Debug)]
pub struct Precise;

impl Profile for Precise {
    no_terms!();
    const ROUNDS_TO_NEAREST: bool = true;
    const ROUNDS_ALL_TO_NEAREST: bool = false;
    const FLUSHES: bool = true;
    const PRODUCT: f64 = Ieee::PRODUCT;
    const QUOTIENT: f64 = Gpu::QUOTIENT;
    const LARGEST_DIVISOR: f64 = Gpu::LARGEST_DIVISOR;
    const ROOT: f64 = Gpu::ROOT;
    const TINY: f64 = Gpu::TINY;

    fn exponential(argument: f64) -> f64 {
        Gpu::exponential(argument)
    }
    fn power(bases: [f64; 2], exponent: f64) -> f64 {
        Gpu::power(bases, exponent)
    }
    #[inline(always)]
    fn sum(middle: f64, [a, b]: [&Ball<Self>; 2]) -> Ball<Self> {
        Ball::new(middle, Ball::<Self>::reach(middle, a.radius + b.radius, 1.0, Self::TINY))
    }
}

/// What WGSL and Vulkan publish for `f32`. An ulp is at most 2 u of its number.
///
/// | operation | published | here, in u of the result |
/// |---|---|---|
/// | x + y, x - y, x y | correctly rounded, up or down | 2 |
/// | x / y | 2.5 ulp for \|y\| from 2^-126 to 2^126 | 5; unbounded where y may be of another size |
/// | inversesqrt x | 2 ulp | 4 |
/// | sqrt x | as 1 / inversesqrt x | 4 + 5 |
/// | e^x, 2^x | 3 + 2 \|x\| ulp | 6 + 4 \|x\| |
/// | log2 x | 3 ulp, but 2^-21 for x from 0.5 to 2 | used only in x^y |
/// | x^y | as exp2(y log2 x) | 6 + 4 \|z\| + 8 \|z\| + 8 y, z = y log2 x |
/// | atan2(y, x) | 4096 ulp | 8192 |
///
/// The compiler may fuse products with sums, and may add the terms of sums in any order. The GPU
/// may flush numbers below the normal ones to 0, both the numbers that it reads and the ones that
/// it computes. So a number that may be less than 2^-126 may be 0, and a quotient by it has no
/// bounds.
///
/// Source: WGSL (W3C), "Differences from IEEE-754", "Accuracy of Concrete Floating Point
/// Expressions", "Reassociation and Fusion"; Vulkan (Khronos), appendix "Vulkan Environment for
/// SPIR-V", "Precision of Individual Operations". The two agree except about atan2. Vulkan grants
/// its 4096 ulp to every operand. WGSL grants them for a normal y and for |x| from 2^-126 to 2^126,
/// and says nothing about other operands. `Decided:` this profile follows Vulkan. A direction
/// beside a plane of the axes has an operand that may be 0, so by the letter of WGSL no pixel there
/// could be judged. Two published accuracies are not used, because no judged formula has these
/// functions: sin and cos (2^-11, from -pi to pi), and acos (as atan2(sqrt(1 - x x), x), in WGSL at
/// least 6.77e-5).
///
/// A compiler adds the terms of a sum in any order across the functions of a formula, and not every
/// such sum has a name. So a ball carries the magnitude of its terms, the number of additions, and
/// the radius that the terms brought along:
///
/// ```text
///   magnitude = sum of |m| + r       n = additions since the last other operation
///   radius = sum of r + 2 u |midpoint| if n = 1,  + 2 u n magnitude if n > 1;  0 if magnitude = 0
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Gpu;

/// The terms of a sum. With 0 additions the number is not a sum.
#[derive(Clone, Copy, Debug)]
pub struct SumTerms {
    magnitude: f64,
    additions: f64,
    radius: f64,
}

impl SumTerms {
    #[inline(always)]
    fn from_ball(ball: &Ball<Gpu>) -> Self {
        let Ball { middle, radius, terms } = *ball;
        let one = Self { magnitude: middle.abs() + radius, additions: 0.0, radius };
        Gpu::choose(terms.additions == 0.0, one, terms)
    }

    /// The sum of these terms, with one addition or more.
    #[inline(always)]
    fn ball(self, middle: f64) -> Ball<Gpu> {
        let radius = if self.additions == 1.0 {
            Ball::<Gpu>::reach(middle, self.radius, 2.0, Gpu::TINY)
        } else {
            let lost = 2.0 * self.additions * super::U * self.magnitude;
            Ball::<Gpu>::reach(middle, self.radius + lost, 0.0, self.additions * Gpu::TINY)
        };
        // Terms that are exactly 0 leave nothing to round or to flush.
        let radius = if self.magnitude == 0.0 { 0.0 } else { radius };
        Ball { middle, radius, terms: self }
    }
}

/// The least normal `f32`, 2^-126.
const LEAST_NORMAL: f64 = f32::MIN_POSITIVE as f64;

impl Profile for Gpu {
    type Terms = SumTerms;
    const NO_SUM: SumTerms = SumTerms { magnitude: 0.0, additions: 0.0, radius: 0.0 };
    const ROUNDS_TO_NEAREST: bool = false;
    const ROUNDS_ALL_TO_NEAREST: bool = false;
    const FLUSHES: bool = true;
    const PRODUCT: f64 = 2.0;
    const QUOTIENT: f64 = 5.0;
    const LARGEST_DIVISOR: f64 = 1.0 / LEAST_NORMAL;
    const ROOT: f64 = 9.0;
    const TINY: f64 = LEAST_NORMAL;

    fn exponential(argument: f64) -> f64 {
        6.0 + 4.0 * argument
    }
    fn power(bases: [f64; 2], exponent: f64) -> f64 {
        // 0 times the logarithm of 0 would be NaN.
        if exponent == 0.0 {
            return Self::exponential(0.0);
        }
        // A result below 2^-150 is flushed, so the argument of exp2 needs no larger bound.
        let argument = |base| {
            let logarithm = elementary::ln(base) / std::f64::consts::LN_2;
            (exponent * logarithm).abs().at_most(150.0)
        };
        // The base farthest from 1 has the largest logarithm; it is one of the two ends.
        let argument = if bases[1] <= 1.0 {
            argument(bases[0])
        } else if bases[0] >= 1.0 {
            argument(bases[1])
        } else {
            argument(bases[0]).at_least(argument(bases[1]))
        };
        // The logarithm is 3 ulp or 2^-21 = 8 u off, times the exponent; the product adds 2 u.
        let lost = 8.0 * exponent + 8.0 * argument;
        Self::exponential(argument) + lost
    }
    #[inline(always)]
    fn sum(middle: f64, [a, b]: [&Ball<Self>; 2]) -> Ball<Self> {
        let (a, b) = (SumTerms::from_ball(a), SumTerms::from_ball(b));
        let terms = SumTerms {
            magnitude: a.magnitude + b.magnitude,
            additions: a.additions + b.additions + 1.0,
            radius: a.radius + b.radius,
        };
        terms.ball(middle)
    }
    const ADDS_IN_ANY_ORDER: bool = true;
    #[inline(always)]
    fn total(middle: f64, [magnitude, additions, radius]: [f64; 3]) -> Ball<Self> {
        // Each term is an addition; the first one is added to 0.
        let ball = SumTerms { magnitude, additions, radius }.ball(middle);
        Ball { radius: if additions == 0.0 { 0.0 } else { ball.radius }, ..ball }
    }
    #[inline(always)]
    fn choose(truth: bool, yes: SumTerms, no: SumTerms) -> SumTerms {
        SumTerms {
            magnitude: if truth { yes.magnitude } else { no.magnitude },
            additions: if truth { yes.additions } else { no.additions },
            radius: if truth { yes.radius } else { no.radius },
        }
    }
    /// Magnitudes, additions and radii.
    type TermLanes = [[f64; LANES]; 3];
    const NO_SUMS: Self::TermLanes = [[0.0; LANES]; 3];
    #[inline(always)]
    fn put_terms(lanes: &mut Self::TermLanes, lane: usize, terms: SumTerms) {
        lanes[0][lane] = terms.magnitude;
        lanes[1][lane] = terms.additions;
        lanes[2][lane] = terms.radius;
    }
    #[inline(always)]
    fn terms_of(lanes: &Self::TermLanes, lane: usize) -> SumTerms {
        SumTerms { magnitude: lanes[0][lane], additions: lanes[1][lane], radius: lanes[2][lane] }
    }
}

/// Rounds as `P`, without a branch, so that a loop over balls vectorizes.
///
/// A result is unknown if it is not bounded, if an operand is infinite, or if a choice is
/// undecided. An unknown result has the radius NaN, which is sound. Every other ball equals the
/// ball of `P`, bit for bit. A comparison that is decided here is decided the same way by `P`,
/// because NaN decides nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Common<P>(PhantomData<P>);

impl<P: Profile> Profile for Common<P> {
    type Terms = P::Terms;
    const NO_SUM: P::Terms = P::NO_SUM;
    const ROUNDS_TO_NEAREST: bool = P::ROUNDS_TO_NEAREST;
    const ROUNDS_ALL_TO_NEAREST: bool = P::ROUNDS_ALL_TO_NEAREST;
    const FLUSHES: bool = P::FLUSHES;
    const PRODUCT: f64 = P::PRODUCT;
    const QUOTIENT: f64 = P::QUOTIENT;
    const LARGEST_DIVISOR: f64 = P::LARGEST_DIVISOR;
    const ROOT: f64 = P::ROOT;
    const TINY: f64 = P::TINY;
    const COMMON_ONLY: bool = true;

    fn exponential(argument: f64) -> f64 {
        P::exponential(argument)
    }
    fn power(bases: [f64; 2], exponent: f64) -> f64 {
        P::power(bases, exponent)
    }
    #[inline(always)]
    fn sum(middle: f64, [a, b]: [&Ball<Self>; 2]) -> Ball<Self> {
        P::sum(middle, [&a.rounding_as(), &b.rounding_as()]).rounding_as()
    }
    const ADDS_IN_ANY_ORDER: bool = P::ADDS_IN_ANY_ORDER;
    #[inline(always)]
    fn total(middle: f64, terms: [f64; 3]) -> Ball<Self> {
        P::total(middle, terms).rounding_as()
    }
    #[inline(always)]
    fn choose(truth: bool, yes: P::Terms, no: P::Terms) -> P::Terms {
        P::choose(truth, yes, no)
    }
    type TermLanes = P::TermLanes;
    const NO_SUMS: P::TermLanes = P::NO_SUMS;
    #[inline(always)]
    fn put_terms(lanes: &mut P::TermLanes, lane: usize, terms: P::Terms) {
        P::put_terms(lanes, lane, terms);
    }
    #[inline(always)]
    fn terms_of(lanes: &P::TermLanes, lane: usize) -> P::Terms {
        P::terms_of(lanes, lane)
    }
}
