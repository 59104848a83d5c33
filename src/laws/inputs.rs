//! Inputs for the laws: random numbers from a fixed seed, and the edges between them.

use crate::number::{Exact, random};

/// Number of random cases for each law.
pub(super) const CASES: u32 = 1024;

/// A stream of test inputs.
pub(super) struct Inputs {
    seed: u64,
    next: u64,
}

impl Inputs {
    /// The stream for one law.
    pub(super) fn new(seed: u64) -> Self {
        Self { seed, next: 0 }
    }

    /// A number in [0, 1).
    pub(super) fn unit(&mut self) -> f32 {
        self.next += 1;
        random::unit(self.seed, self.next)
    }

    /// A number in [low, high), up to rounding, that fills the digits of its type.
    pub(super) fn between<R: Exact>(&mut self, low: f32, high: f32) -> R {
        let fine = R::from_f32(self.unit()) * R::from_f32(1.0 / 16_777_216.0);
        R::from_f32(low) + R::from_f32(high - low) * (R::from_f32(self.unit()) + fine)
    }

    /// An integer in [0, `count`).
    pub(super) fn below(&mut self, count: usize) -> usize {
        // `unit` is less than 1, so the product is less than the count.
        (f64::from(self.unit()) * count as f64) as usize
    }

    /// One of several.
    pub(super) fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// True half of the time.
    pub(super) fn flag(&mut self) -> bool {
        self.unit() < 0.5
    }

    /// A depth: ordinary, a few ulp from another, denormal, tiny, huge.
    pub(super) fn depth<R: Exact>(&mut self) -> R {
        let ulps = self.below(7) as u32;
        let near = f32::from_bits(3.0_f32.to_bits() - 3 + ulps);
        match self.below(10) {
            0..4 => self.between(0.01, 100.0),
            4..8 => R::from_f32(near),
            8 => R::from_f32(self.of(&[1e-45, 1e-40, f32::MIN_POSITIVE, 1e-30])),
            _ => R::from_f32(self.of(&[1e20, 1e30, f32::MAX])),
        }
    }

    /// An epsilon: 0, infinite, denormal, less than an ulp of most depths, ordinary.
    pub(super) fn band<R: Exact>(&mut self) -> R {
        match self.below(5) {
            0 => R::from_f32(self.of(&[0.0, f32::INFINITY, 1e-45, 1e-40])),
            1 => self.between(0.0, 1e-6),
            _ => self.between(0.0, 10.0),
        }
    }

    /// A weight that a pipeline can make: ordinary, or as small as the kernel's weights become.
    pub(super) fn weight<R: Exact>(&mut self) -> R {
        if self.below(5) == 0 { self.between(1e-30, 1e-20) } else { self.between(1e-4, 1.0) }
    }

    /// An opacity: 0, 1, tiny, nearly 1, ordinary.
    pub(super) fn alpha<R: Exact>(&mut self) -> R {
        match self.below(6) {
            0 => R::from_f32(self.of(&[0.0, 1.0, 1e-40, 1e-7, 1.0 - f32::EPSILON])),
            _ => self.between(0.0, 1.0),
        }
    }

    /// A linear colour, some components 0, some beyond 1.
    pub(super) fn color<R: Exact>(&mut self) -> [R; 3] {
        [(); 3].map(|()| if self.below(5) == 0 { R::ZERO } else { self.between(0.0, 4.0) })
    }

    /// Fewer than `most` layers, each an opacity and a colour.
    pub(super) fn layers<R: Exact>(&mut self, most: usize) -> Vec<(R, [R; 3])> {
        (0..self.below(most)).map(|_| (self.alpha(), self.color())).collect()
    }

    /// The numbers 0 to `count` - 1 in some order.
    pub(super) fn order(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        (1..count).for_each(|last| order.swap(last, self.below(last + 1)));
        order
    }
}
