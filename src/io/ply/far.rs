//! Shift positions that `f32` would merge, see [`super`].

use super::header::{Element, PropertyKind, Scalar};
use super::layout::{Layout, POSITION, PropertyUse};
use super::values::{BodyValues, Event};
use crate::io::{Reason, far};
use glam::DVec3;

/// Finds the offset of the positions, gives it to the layout, and says whether `f32` still merges
/// places. `None` if the types of the file fit `f32`.
pub(super) fn shift(
    element: &Element,
    values: &BodyValues<'_>,
    layout: &mut Layout,
    keep_place: bool,
) -> Reason<Option<(DVec3, Option<String>)>> {
    let Some(properties) = wide(element, layout) else { return Ok(None) };
    let walk = |visit: &mut dyn FnMut([f64; 3])| walk(element, values, properties, visit);
    let found = far::shift(element.count, &walk, keep_place)?;
    if let Some((offset, _)) = found {
        layout.shift(offset);
    }
    Ok(found)
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
    visit: &mut dyn FnMut([f64; 3]),
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
