//! Shift positions that `f32` would merge, see [`super`].

use super::header::{Element, PropertyKind, Scalar};
use super::layout::{Layout, POSITION, PropertyUse};
use super::values::{BodyValues, Event};
use crate::io::Reason;
use crate::memory;
use crate::number::{MapInline, Real};
use glam::DVec3;

/// A centre at least so many times as far from 0 as the box reaches around it is shifted.
/// `Decided:` by 16, a shift gains four bits; nearer files keep their coordinates.
const FAR: f64 = 16.0;

/// Finds the offset of the positions, gives it to the layout, and says whether `f32` still merges
/// places. `None` if the types of the file fit `f32`.
pub(super) fn shift(
    element: &Element,
    values: &BodyValues<'_>,
    layout: &mut Layout,
    keep_place: bool,
) -> Reason<Option<(DVec3, Option<String>)>> {
    let Some(properties) = wide(element, layout) else { return Ok(None) };
    let mut extent = Extent::new();
    walk(element, values, properties, |p| extent.add(p))?;
    if extent.exact == [true; 3] {
        return Ok(None);
    }
    let offset = if keep_place { DVec3::ZERO } else { extent.offset() };
    layout.shift(offset);
    let merged = merged(element, values, properties, offset)?;
    Ok(Some((offset, merged)))
}

/// The properties of the three coordinates, if one has a type with more digits than `f32`.
pub(super) fn wide(element: &Element, layout: &Layout) -> Option<[usize; 3]> {
    let at = |coordinate: usize| {
        layout.slots.iter().position(|slot| {
            matches!(slot, PropertyUse::Number(place, _) if *place == POSITION.start + coordinate)
        })
    };
    let properties = [at(0)?, at(1)?, at(2)?];
    let is_wide = |&property: &usize| {
        let kind = element.properties[property].kind;
        matches!(kind, PropertyKind::One(Scalar::F64 | Scalar::I32 | Scalar::U32))
    };
    properties.iter().any(is_wide).then_some(properties)
}

/// Visits the position of every vertex.
fn walk(
    element: &Element,
    values: &BodyValues<'_>,
    properties: [usize; 3],
    mut visit: impl FnMut([f64; 3]),
) -> Reason<()> {
    let mut position = [0.0; 3];
    values.clone().walk(element, |event| {
        match event {
            Event::Value(property, value) => {
                if let Some(at) = properties.iter().position(|&other| other == property) {
                    position[at] = value;
                }
            }
            Event::End => visit(position),
        }
        Ok(())
    })
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

    /// The offset to subtract; see [`super`].
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
fn merged(
    element: &Element,
    values: &BodyValues<'_>,
    properties: [usize; 3],
    offset: DVec3,
) -> Reason<Option<String>> {
    // Without room for the count, the file is read without it.
    if memory::try_ask(16 * element.count, || "the places of the file".into()).is_err() {
        return Ok(None);
    }
    let (mut own, mut stored) = (Vec::new(), Vec::new());
    let mut most = 0.0_f32;
    walk(element, values, properties, |p| {
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
