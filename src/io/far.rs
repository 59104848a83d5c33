//! Shift positions that `f32` would merge; [`super::ply`] has the rule.

use super::Reason;
use crate::memory;
use crate::number::{MapInline, Real};
use glam::{DVec3, Vec3};

/// A centre at least so many times as far from 0 as the box reaches around it is shifted.
/// `Decided:` by 16, a shift gains four bits; nearer files keep their coordinates.
const FAR: f64 = 16.0;

/// Calls a function with the position of every point of a file, in order.
pub(super) type Walk<'w> = dyn Fn(&mut dyn FnMut([f64; 3])) -> Reason<()> + 'w;

/// Finds the offset of the positions, and says whether `f32` still merges places. `None` if `f32`
/// holds all coordinates. With `keep_place`, the offset is 0.
pub(super) fn shift(
    count: u64,
    walk: &Walk<'_>,
    keep_place: bool,
) -> Reason<Option<(DVec3, Option<String>)>> {
    let mut extent = Extent::new();
    walk(&mut |p| extent.add(p))?;
    if extent.exact == [true; 3] {
        return Ok(None);
    }
    let offset = if keep_place { DVec3::ZERO } else { extent.offset() };
    Ok(Some((offset, merged(count, walk, offset)?)))
}

/// Positions in f64 as a cloud holds them: less an offset, and rounded to `f32` once.
pub(super) struct Settled {
    pub(super) position: Vec<Vec3>,
    pub(super) offset: DVec3,
    pub(super) warning: Option<String>,
}

/// Applies [`shift`] to positions that are all in memory.
pub(super) fn settle(positions: &[[f64; 3]], keep_place: bool) -> Reason<Settled> {
    let walk = |visit: &mut dyn FnMut([f64; 3])| {
        positions.iter().for_each(|position| visit(*position));
        Ok(())
    };
    let (offset, warning) =
        shift(positions.len() as u64, &walk, keep_place)?.unwrap_or((DVec3::ZERO, None));
    let near = |position: &[f64; 3]| (DVec3::from_array(*position) - offset).as_vec3();
    Ok(Settled { position: positions.iter().map(near).collect(), offset, warning })
}

/// The box around the finite positions.
struct Extent {
    low: [f64; 3],
    high: [f64; 3],
    /// Whether `f32` holds every coordinate along an axis.
    exact: [bool; 3],
}

impl Extent {
    fn new() -> Self {
        Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3], exact: [true; 3] }
    }

    fn add(&mut self, position: [f64; 3]) {
        if position.iter().any(|value| !value.is_finite()) {
            return;
        }
        for (axis, value) in position.into_iter().enumerate() {
            self.low[axis] = self.low[axis].at_most(value);
            self.high[axis] = self.high[axis].at_least(value);
            self.exact[axis] &= f64::from(value as f32) == value;
        }
    }

    /// The offset to subtract; see [`super::ply`].
    fn offset(&self) -> DVec3 {
        let half = |axis: usize| self.high[axis] / 2.0 - self.low[axis] / 2.0;
        let reach = half(0).at_least(half(1)).at_least(half(2));
        // The greatest power of two that is not above the reach: its exponent bits alone.
        let unit = f64::from_bits(reach.to_bits() & 0x7ff0_0000_0000_0000);
        if !(unit > 0.0 && unit.is_finite()) {
            return DVec3::ZERO;
        }
        let mut offset = [0.0; 3];
        let mut gains = false;
        for (axis, offset) in offset.iter_mut().enumerate() {
            let middle = self.low[axis] / 2.0 + self.high[axis] / 2.0;
            if middle.abs() >= FAR * reach {
                *offset = (middle / unit).floor() * unit;
                gains |= !self.exact[axis];
            }
        }
        if gains { DVec3::from_array(offset) } else { DVec3::ZERO }
    }
}

/// Says how many places of the file are one in `f32`, if any, and what mends it.
fn merged(count: u64, walk: &Walk<'_>, offset: DVec3) -> Reason<Option<String>> {
    // Without room for the count, the file is read without it.
    if memory::try_ask(count.saturating_mul(16), || "the places of the file".into()).is_err() {
        return Ok(None);
    }
    let (mut own, mut stored) = (Vec::new(), Vec::new());
    let mut most = 0.0_f32;
    walk(&mut |p| {
        let [x, y, z] = p;
        if p.iter().all(|value| value.is_finite()) {
            // Adding 0 turns -0 into 0.
            let bits = |value: f64| ((value as f32) + 0.0).to_bits();
            let p = DVec3::new(x, y, z) - offset;
            most = most.at_least(p.abs().max_element() as f32);
            stored.push(hash(p.to_array().map_inline(|value| u64::from(bits(value)))));
            own.push(hash([x, y, z].map_inline(|value| (value + 0.0).to_bits())));
        }
    })?;
    let count = |hashes: &mut Vec<u64>| {
        hashes.sort_unstable();
        hashes.dedup();
        hashes.len()
    };
    let (places, left) = (count(&mut own), count(&mut stored));
    if left >= places {
        return Ok(None);
    }
    let step = most.next_up() - most;
    Ok(Some(format!(
        "of {places} places, only {left} are left in f32, because coordinates reach {most} and f32 \
         has steps of {step} there; remove points that are far from the others, or split the file"
    )))
}

/// Mixes three numbers into one; equal hashes of different places are as good as impossible.
fn hash(numbers: [u64; 3]) -> u64 {
    numbers.into_iter().fold(0, |hash, number| {
        let mixed = (hash ^ number).wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ mixed >> 31
    })
}
