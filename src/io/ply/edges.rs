//! Read the element `edge`: segments between two vertices.

use super::faces::corner;
use super::header::{Element, PropertyKind};
use super::values::{BodyValues, Event};

/// Reads all edges; each end must be below `vertices`.
pub(super) fn read(
    element: &Element,
    values: &mut BodyValues<'_>,
    vertices: u64,
    edges: &mut Vec<[u32; 2]>,
) -> Result<(), String> {
    if element.count == 0 {
        return Ok(());
    }
    let ends = [end(element, "vertex1")?, end(element, "vertex2")?];
    let mut edge = [0; 2];
    values.walk(element, |event| {
        match event {
            Event::Value(property, value) => {
                if let Some(which) = ends.iter().position(|&end| end == property) {
                    edge[which] = corner(value, vertices)?;
                }
            }
            Event::End => edges.push(edge),
        }
        Ok(())
    })
}

/// The index of the property that holds an end.
fn end(element: &Element, name: &str) -> Result<usize, String> {
    let found = element.properties.iter().position(|property| property.name == name);
    let index = found.ok_or_else(|| format!("element edge has no property {name}; declare it"))?;
    match element.properties[index].kind {
        PropertyKind::One(scalar) if scalar.is_integer() => Ok(index),
        _ => Err(format!("element edge: property `{name}` must be one integer")),
    }
}
