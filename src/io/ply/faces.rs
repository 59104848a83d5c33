//! The element `face`: polygons, cut into triangles.

use super::header::{Element, PropertyKind, quote};
use super::values::{BodyValues, Event};

/// Reads all faces and appends their triangles; each index is held against `vertices`.
pub(super) fn read(
    element: &Element,
    values: &mut BodyValues<'_>,
    vertices: u64,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), String> {
    if element.count == 0 {
        return Ok(());
    }
    let indices = indices(element)?;
    // A polygon a b c d ... is the fan abc, acd, ...: only its first and last corner are kept.
    let (mut corners, mut first, mut previous) = (0_u64, 0, 0);
    values.walk(element, |event| {
        match event {
            Event::Value(property, value) if property == indices => {
                let corner = corner(value, vertices)?;
                match corners {
                    0 => first = corner,
                    1 => {}
                    _ => triangles.push([first, previous, corner]),
                }
                previous = corner;
                corners += 1;
            }
            Event::Value(..) => {}
            Event::End => corners = 0,
        }
        Ok(())
    })
}

/// The vertex that a number names.
pub(super) fn corner(value: f64, vertices: u64) -> Result<u32, String> {
    if value >= 0.0 && value < vertices as f64 {
        Ok(value as u32)
    } else {
        Err(format!("vertex {value} does not exist, they are 0 to {}", vertices - 1))
    }
}

/// Which property lists the corners.
fn indices(element: &Element) -> Result<usize, String> {
    let names = ["vertex_indices", "vertex_index"];
    let found = element.properties.iter().position(|p| names.contains(&p.name.as_str()));
    let index = found.ok_or("element face has no property list vertex_indices; declare it")?;
    let property = &element.properties[index];
    match property.kind {
        PropertyKind::List { item, .. } if item.is_integer() => Ok(index),
        PropertyKind::List { .. } | PropertyKind::One(_) => {
            let name = quote(&property.name);
            Err(format!("element face: property {name} must be a list of integers"))
        }
    }
}
