//! Inputs for the laws: random numbers from a fixed seed, and the edges between them. Every input
//! is made of draws, so that a case can be run again with simpler ones.

use crate::number::{Exact, random};

/// What an input is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Draw {
    /// One of several, the simplest first.
    Choice(usize),
    /// A number in [0, 1).
    Number(f64),
}

impl Draw {
    /// How hard the draw is to read; 0 is the simplest.
    pub(super) fn complexity(&self) -> u64 {
        match *self {
            Self::Choice(index) => index as u64,
            Self::Number(0.0) => 0,
            // The number of binary digits, then the digits.
            Self::Number(number) => {
                let digits = (number * f64::from(HALF) * f64::from(HALF)) as u64;
                let unused = digits.trailing_zeros().min(48);
                (u64::from(48 - unused) << 48) + (digits >> unused)
            }
        }
    }

    /// Draws that are simpler, the simplest first.
    pub(super) fn simpler(self) -> Vec<Self> {
        let all: Vec<Self> = match self {
            Self::Choice(index) => {
                (0..index.min(8)).chain([index - index.min(1)]).map(Self::Choice).collect()
            }
            Self::Number(number) => {
                let few = [0, 8, 4, 12, 2, 6, 10, 14, 1, 3, 5, 7, 9, 11, 13, 15];
                let few = few.map(|sixteenths: u8| f64::from(sixteenths) / 16.0);
                let cut = [256.0, 4096.0].map(|steps: f64| (number * steps).floor() / steps);
                few.into_iter().chain(cut).map(Self::Number).collect()
            }
        };
        all.into_iter().filter(|other| other.complexity() < self.complexity()).collect()
    }
}

/// 2^24: half of the digits of a number that is drawn.
const HALF: f32 = 16_777_216.0;

/// Where draws come from.
enum Source {
    /// A seed, and the number of draws so far.
    Random(u64, u64),
    /// Draws of another run; the simplest ones after the last.
    Again(std::vec::IntoIter<Draw>),
}

/// A stream of test inputs.
pub(super) struct Inputs {
    source: Source,
    /// The draws of this case.
    drawn: Vec<Draw>,
    /// Whether odd numbers are among the inputs.
    odd: bool,
}

impl Inputs {
    /// The stream for one operator.
    pub(super) fn new(seed: u64, odd: bool) -> Self {
        Self { source: Source::Random(seed, 0), drawn: Vec::new(), odd }
    }

    /// The inputs of one case, from its draws.
    pub(super) fn replay(draws: &[Draw], odd: bool) -> Self {
        Self { source: Source::Again(Vec::from(draws).into_iter()), drawn: Vec::new(), odd }
    }

    /// Begins a case.
    pub(super) fn begin(&mut self) {
        self.drawn.clear();
    }

    /// The draws of this case.
    pub(super) fn drawn(&self) -> &[Draw] {
        &self.drawn
    }

    /// A number in [0, 1) of 48 binary digits.
    fn unit(&mut self) -> f64 {
        let number = match &mut self.source {
            Source::Random(seed, next) => {
                *next += 2;
                let [high, low] = [*next - 1, *next].map(|i| f64::from(random::unit(*seed, i)));
                high + low / f64::from(HALF)
            }
            Source::Again(draws) => match draws.next() {
                Some(Draw::Number(number)) => number,
                _ => 0.0,
            },
        };
        self.drawn.push(Draw::Number(number));
        number
    }

    /// An integer in [0, `count`).
    pub(super) fn below(&mut self, count: usize) -> usize {
        let index = match &mut self.source {
            Source::Random(seed, next) => {
                *next += 1;
                // `unit` is less than 1, so the product is less than the count.
                (f64::from(random::unit(*seed, *next)) * count as f64) as usize
            }
            Source::Again(draws) => match draws.next() {
                Some(Draw::Choice(index)) => index.min(count - 1),
                _ => 0,
            },
        };
        self.drawn.push(Draw::Choice(index));
        index
    }

    /// A number in [low, high), up to rounding, that fills the digits of its type.
    pub(super) fn between<R: Exact>(&mut self, low: f32, high: f32) -> R {
        let half = f64::from(HALF);
        let number = self.unit() * half;
        let [whole, fine] = [number.floor() / half, (number - number.floor()) / half];
        let unit = R::from_f32(whole as f32) + R::from_f32(fine as f32);
        R::from_f32(low) + R::from_f32(high - low) * unit
    }

    /// One of several, the simplest first.
    pub(super) fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// True half of the time.
    pub(super) fn flag(&mut self) -> bool {
        self.below(2) == 1
    }

    /// A number from 1/8 to 16.
    pub(super) fn scaled<R: Exact>(&mut self) -> R {
        let scale = self.of(&[1.0, 2.0, 0.5, 4.0, 0.25, 8.0, 0.125]);
        self.between::<R>(1.0, 2.0) * R::from_f32(scale)
    }

    /// A number in (-most, most).
    pub(super) fn signed<R: Exact>(&mut self, most: f32) -> R {
        let size: R = self.between(0.0, most);
        if self.flag() { -size } else { size }
    }

    // Below, every input is made of as many draws, whichever its kind is. So a simpler draw leaves
    // the inputs after it as they are.

    /// A depth: ordinary, a few ulp from another, tiny, huge; of odd ones denormal, or the largest
    /// number.
    pub(super) fn depth<R: Exact>(&mut self) -> R {
        let kind = self.below(10);
        let ordinary = self.scaled::<R>() * R::from_f32(self.of(&[1.0, 8.0, 0.0625]));
        let edge = f32::from_bits(3.0_f32.to_bits() - 3 + self.below(7) as u32);
        let second = self.flag();
        match kind {
            0..4 => ordinary,
            4..8 => R::from_f32(edge),
            8 if self.odd => R::from_f32(if second { 1e-40 } else { 1e-45 }),
            8 => R::from_f32(if second { 1e-30 } else { f32::MIN_POSITIVE }),
            _ if self.odd => R::from_f32(f32::MAX),
            _ => R::from_f32(if second { 1e30 } else { 1e20 }),
        }
    }

    /// An epsilon: 0, less than an ulp of most depths, ordinary; of odd ones infinite or denormal.
    pub(super) fn band<R: Exact>(&mut self) -> R {
        let (kind, odd) = (self.below(5), self.of(&[f32::INFINITY, 1e-45, 1e-40]));
        let ordinary: R = self.between(0.0, 8.0);
        match kind {
            0 if self.odd => R::from_f32(odd),
            0 => R::ZERO,
            1..4 => ordinary,
            _ => ordinary * R::from_f32(1e-7),
        }
    }

    /// A weight that a pipeline can make: ordinary, or as small as the kernel's weights become.
    pub(super) fn weight<R: Exact>(&mut self) -> R {
        let (kind, less) = (self.below(5), self.between::<R>(0.0, 1.0));
        let ordinary = (R::ONE - less).at_least(R::from_f32(1.0 / 8192.0));
        if kind < 4 { ordinary } else { ordinary * R::from_f32(1e-20) }
    }

    /// An opacity: 0, 1, small, nearly 1, ordinary; of odd ones denormal.
    pub(super) fn alpha<R: Exact>(&mut self) -> R {
        let (kind, end) = (self.below(6), self.of(&[0.0, 1.0, 1e-7, 1.0 - f32::EPSILON]));
        let ordinary = self.between(0.0, 1.0);
        match kind {
            0 => R::from_f32(end),
            5 if self.odd => R::from_f32(1e-40),
            _ => ordinary,
        }
    }

    /// A ratio of Voronoi-enhanced depth: 0, 1, ordinary; of odd ones denormal.
    pub(super) fn ratio<R: Exact>(&mut self) -> R {
        let (kind, end) = (self.below(4), self.of(&[0.0, 1.0]));
        let ordinary = self.between(0.0, 1.25);
        match kind {
            0 => R::from_f32(end),
            3 if self.odd => R::from_f32(1e-40),
            _ => ordinary,
        }
    }

    /// A linear colour, some components 0, some beyond 1.
    pub(super) fn color<R: Exact>(&mut self) -> [R; 3] {
        [(); 3].map(|()| {
            let (some, value) = (self.below(5) > 0, self.between(0.0, 4.0));
            if some { value } else { R::ZERO }
        })
    }

    /// Fewer than `most` layers, each an opacity and a colour.
    pub(super) fn layers<R: Exact>(&mut self, most: usize) -> Vec<(R, [R; 3])> {
        (0..self.below(most)).map(|_| (self.alpha(), self.color())).collect()
    }

    /// The numbers 0 to `count` - 1 in some order.
    pub(super) fn order(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        // Choice 0 leaves the order as it is.
        (1..count).for_each(|last| order.swap(last, last - self.below(last + 1)));
        order
    }
}
