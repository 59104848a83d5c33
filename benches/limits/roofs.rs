//! What one thread of this machine can do at most: the roofs that the stages are held against.

use crate::operations::Operations;
use multiversion::multiversion;
use multiversion::target::target_cfg_f;
use splatref::number::elementary::exp_f32_in_range;
use std::hint::black_box;
use std::time::Instant;

/// Seconds for each operation and byte.
pub(crate) struct Roofs {
    pub(crate) short: f64,
    pub(crate) long: f64,
    pub(crate) exp: f64,
    pub(crate) byte: f64,
}

/// What bounds a stage, and the least time that it can take.
pub(crate) struct Bound {
    pub(crate) seconds: f64,
    pub(crate) by: &'static str,
}

impl Roofs {
    pub(crate) fn measure() -> Self {
        Self { short: least(short) / 2.0, long: least(long), exp: least(exp), byte: copied() }
    }

    /// The least time of operations and bytes. Kinds of operations take turns in the same units of
    /// the processor, so their times add up; memory works beside them.
    pub(crate) fn bound(&self, work: &Operations, bytes: f64) -> Bound {
        let parts = [
            (work.short * self.short, "+ - * <"),
            (work.long * self.long, "/ sqrt"),
            (work.exp * self.exp, "exp, pow"),
        ];
        let computing: f64 = parts.iter().map(|(seconds, _)| seconds).sum();
        let moving = bytes * self.byte;
        if moving > computing {
            return Bound { seconds: moving, by: "memory" };
        }
        let most = parts.iter().max_by(|a, b| a.0.total_cmp(&b.0));
        Bound { seconds: computing, by: most.map_or("", |(_, by)| by) }
    }
}

/// Numbers that stay in the registers of AVX2, twice those of one register so that no result is
/// waited for.
const NUMBERS: usize = 64;
const ROUNDS: usize = 100_000;

/// The fewest seconds of several runs for one number of one round.
fn least(run: fn(&mut [f32; NUMBERS])) -> f64 {
    let times = (0..15).map(|_| {
        let mut numbers = black_box([0.75; NUMBERS]);
        let start = Instant::now();
        run(&mut numbers);
        let time = start.elapsed().as_secs_f64();
        black_box(numbers);
        time
    });
    times.fold(f64::INFINITY, |a, b| if b < a { b } else { a }) / (NUMBERS * ROUNDS) as f64
}

/// A multiplication and an addition, rounded each, as the crate's kernels are.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+fma", "x86_64+avx2+fma"))]
fn short(numbers: &mut [f32; NUMBERS]) {
    let [factor, summand] = black_box([0.5_f32, 0.25]);
    let mut own = *numbers;
    for _ in 0..ROUNDS {
        for number in &mut own {
            *number = *number * factor + summand;
        }
    }
    *numbers = own;
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+fma", "x86_64+avx2+fma"))]
fn long(numbers: &mut [f32; NUMBERS]) {
    let dividend = black_box(0.5_f32);
    let mut own = *numbers;
    for _ in 0..ROUNDS {
        for number in &mut own {
            *number = dividend / *number;
        }
    }
    *numbers = own;
}

/// The crate's exp, which evaluates in `f64`.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+fma", "x86_64+avx2+fma"))]
fn exp(numbers: &mut [f32; NUMBERS]) {
    const FUSED: bool = target_cfg_f!(target_feature = "fma");
    for _ in 0..ROUNDS {
        for number in &mut *numbers {
            *number = exp_f32_in_range::<FUSED>(-*number);
        }
    }
}

/// Seconds for a byte that is read or written: a copy of memory that no cache holds.
fn copied() -> f64 {
    const BYTES: usize = 256 << 20;
    let from = black_box(vec![1_u8; BYTES]);
    let mut to = vec![2_u8; BYTES];
    let times = (0..5).map(|_| {
        let start = Instant::now();
        to.copy_from_slice(&from);
        black_box(&mut to);
        start.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, |a, b| if b < a { b } else { a }) / (2 * BYTES) as f64
}
