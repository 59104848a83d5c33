//! Lanes: [`LANES`] values side by side, one for each pixel, cell or surfel; never partial sums.
//!
//! Write a kernel as straight loops over lanes, and the compiler turns each loop into vector
//! instructions. Their width is the width of the function that the loop is inlined into. So
//! everything here is inlined, and `vectorized` compiles each kernel for several widths. Read lanes
//! into local arrays, change them there and write them back, because a loop that writes to memory
//! that it may read again does not vectorize. In every lane the operations are those of the
//! definition, in its order.
//!
//! Nothing forces a closure to be inlined. A closure that the kernel itself makes is compiled for
//! the kernel's vectors anyway. A closure that an inlined function makes is not: once it is long
//! enough to stay a function, its loops are scalar. So such closures are short, or are functions.

#![expect(
    clippy::needless_range_loop,
    reason = "a lane is an index into several arrays, and such a loop becomes vectors"
)]

use super::{Real, Vector3};

/// How many values are treated side by side: 16 numbers of 32 bits are one register of AVX-512.
pub const LANES: usize = 16;

/// One number for each lane.
pub(crate) type Lanes<R = f32> = [R; LANES];

/// A choice of lanes: all bits set in a chosen lane, none in another.
pub(crate) type Mask = [u32; LANES];

/// Compiles a function for every vector width: AVX-512, AVX2 with FMA, and what every target has.
/// The running program chooses among them; the bits are the same.
///
/// In the function, `target_cfg_f!(target_feature = "fma")` tells whether this version multiplies
/// and adds in one instruction.
///
/// Write it with parentheses, `vectorized!(fn kernel() {})`, because rustfmt leaves braces alone.
macro_rules! vectorized {
    ($($item:tt)+) => {
        #[multiversion::multiversion(
            targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+fma", "x86_64+avx2+fma")
        )]
        $($item)+
    };
}
pub(crate) use vectorized;

/// [`vectorized`] for AVX2 with FMA and for what every target has: for kernels in `f64` that are long to compile
/// and that AVX-512 makes no faster.
macro_rules! vectorized_avx2 {
    ($($item:tt)+) => {
        #[multiversion::multiversion(targets("x86_64+avx2+fma"))]
        $($item)+
    };
}
pub(crate) use vectorized_avx2;

/// Makes a value for each lane.
#[inline(always)]
pub(crate) fn each<T: Copy + Default>(value: impl Fn(usize) -> T) -> [T; LANES] {
    let mut lanes = [T::default(); LANES];
    for i in 0..LANES {
        lanes[i] = value(i);
    }
    lanes
}

// -- Choices

/// The lanes in which a condition holds.
///
/// The mask holds integers, not `bool`, because a select of integers by a comparison of floats
/// would not vectorize.
#[inline(always)]
pub(crate) fn mask(holds: impl Fn(usize) -> bool) -> Mask {
    each(|i| u32::from(holds(i)).wrapping_neg())
}

/// Whether a lane is chosen. It reads all lanes, so that they are read at once.
#[inline(always)]
pub(crate) fn any(mask: &Mask) -> bool {
    mask.iter().fold(0, |any, lane| any | lane) != 0
}

/// Whether one of these is above 0. It reads all of them, so that they are read at once.
#[inline(always)]
pub(crate) fn any_above_0(values: &[f32]) -> bool {
    let mut found = false;
    for &value in values {
        found |= value > 0.0;
    }
    found
}

/// The numbers of `chosen` where a lane is chosen, of `others` elsewhere.
///
/// It selects bits, because LLVM turns a choice by a condition into a choice of what to load, lane
/// by lane, and not into a vector.
#[inline(always)]
pub(crate) fn select(mask: &Mask, chosen: &Lanes, others: &Lanes) -> Lanes {
    each(|i| f32::from_bits((chosen[i].to_bits() & mask[i]) | (others[i].to_bits() & !mask[i])))
}

/// [`select`] for integers.
#[inline(always)]
pub(crate) fn select_u32(
    mask: &Mask,
    chosen: &[u32; LANES],
    others: &[u32; LANES],
) -> [u32; LANES] {
    each(|i| (chosen[i] & mask[i]) | (others[i] & !mask[i]))
}

// -- Rows in memory
//
// Chunks are assigned, because `copy_from_slice` is a call where a crate is compiled in several
// units.

/// Reads the values of a row from an index on.
#[inline(always)]
pub(crate) fn load<T: Copy>(row: &[T], at: usize) -> [T; LANES] {
    row[at..at + LANES].as_chunks().0[0]
}

/// Overwrites the values of a row from an index on.
#[inline(always)]
pub(crate) fn store<T: Copy>(row: &mut [T], at: usize, lanes: &[T; LANES]) {
    row[at..at + LANES].as_chunks_mut().0[0] = *lanes;
}

/// Overwrites a row with the first lanes, as many as the row has: a whole copy is one instruction.
#[inline(always)]
pub(crate) fn store_first<T: Copy>(row: &mut [T], lanes: &[T; LANES]) {
    if row.len() == LANES {
        store(row, 0, lanes);
    } else {
        for (value, lane) in row.iter_mut().zip(lanes) {
            *value = *lane;
        }
    }
}

/// Reads twice [`LANES`] values of a row from an index on, and separates the even and the odd ones.
#[inline(always)]
pub(crate) fn load_halves<T: Copy + Default>(row: &[T], at: usize) -> [[T; LANES]; 2] {
    let pairs: [T; 2 * LANES] = row[at..at + 2 * LANES].as_chunks().0[0];
    let (mut even, mut odd) = ([T::default(); LANES], [T::default(); LANES]);
    for i in 0..LANES {
        even[i] = pairs[2 * i];
        odd[i] = pairs[2 * i + 1];
    }
    [even, odd]
}

/// Overwrites what [`load_halves`] reads.
#[inline(always)]
pub(crate) fn store_halves<T: Copy + Default>(
    row: &mut [T],
    at: usize,
    [even, odd]: &[[T; LANES]; 2],
) {
    let mut pairs = [T::default(); 2 * LANES];
    for i in 0..LANES {
        (pairs[2 * i], pairs[2 * i + 1]) = (even[i], odd[i]);
    }
    row[at..at + 2 * LANES].as_chunks_mut().0[0] = pairs;
}

// -- Vectors, component by component

/// The vector of a lane.
#[inline(always)]
pub(crate) fn vector<R: Real>(lanes: &[Lanes<R>; 3], i: usize) -> Vector3<R> {
    Vector3::new(lanes[0][i], lanes[1][i], lanes[2][i])
}

/// Replaces the vector of a lane.
#[inline(always)]
pub(crate) fn put_vector<R: Real>(lanes: &mut [Lanes<R>; 3], i: usize, v: Vector3<R>) {
    (lanes[0][i], lanes[1][i], lanes[2][i]) = (v.x, v.y, v.z);
}

/// Turns values with several components into lanes, one component after the other.
#[inline(always)]
pub(crate) fn transposed<R: Copy, const N: usize>(values: &[[R; N]; LANES]) -> [Lanes<R>; N] {
    let mut lanes = [[values[0][0]; LANES]; N];
    for i in 0..LANES {
        for k in 0..N {
            lanes[k][i] = values[i][k];
        }
    }
    lanes
}

/// The components of a lane.
#[inline(always)]
pub(crate) fn components<R: Copy>(lanes: &[Lanes<R>; 3], i: usize) -> [R; 3] {
    [lanes[0][i], lanes[1][i], lanes[2][i]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_keeps_every_bit() {
        let chosen = each(|i| if i == 3 { f32::NAN } else { -(i as f32) });
        let others = [f32::NEG_INFINITY; LANES];
        let odd = mask(|i| i % 2 == 1);
        let expected = each(|i| if i % 2 == 1 { chosen[i].to_bits() } else { others[i].to_bits() });
        assert_eq!(select(&odd, &chosen, &others).map(f32::to_bits), expected);
        let (a, b) = (chosen.map(f32::to_bits), others.map(f32::to_bits));
        assert_eq!(select_u32(&odd, &a, &b), expected);
    }

    #[test]
    fn any_asks_every_lane() {
        assert!(!any(&mask(|_| false)) && !any_above_0(&[0.0, -0.0, -1.0, f32::NAN]));
        for lane in 0..LANES {
            assert!(any(&mask(|i| i == lane)));
            assert!(any_above_0(&each(|i| if i == lane { f32::MIN_POSITIVE } else { 0.0 })));
        }
    }

    #[test]
    fn what_is_stored_is_loaded() {
        let mut row: [u32; 40] = std::array::from_fn(|i| i as u32);
        let halves = load_halves(&row, 5);
        assert_eq!((halves[0][1], halves[1][15]), (7, 36));
        store_halves(&mut row, 5, &[halves[1], halves[0]]);
        assert_eq!(row[4..8], [4, 6, 5, 8]);
        store(&mut row, 0, &[9; LANES]);
        assert_eq!(load(&row, 1)[13..], [9, 9, 15], "the pair of 15 and 16 is exchanged");
        store_first(&mut row[..2], &[1; LANES]);
        assert_eq!(row[..3], [1, 1, 9]);
    }
}
