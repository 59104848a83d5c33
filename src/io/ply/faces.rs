//! Read the element `face`: polygons, cut into triangles.

use super::header::{Element, PropertyKind, quote};
use super::values::{BodyValues, Event};
use crate::scene::{Cloud, Coordinates};
use glam::Vec2;

/// Reads all faces and appends their triangles, and the texture coordinates of their corners if
/// there are any. Each index must be below `vertices`.
pub(super) fn read(
    element: &Element,
    values: &mut BodyValues<'_>,
    vertices: u64,
    cloud: &mut Cloud,
) -> Result<(), String> {
    if element.count == 0 {
        return Ok(());
    }
    let indices = indices(element)?;
    let coordinates = coordinates(element)?;
    let (mut corners, mut numbers) = (Vec::new(), Vec::new());
    let mut of_corners = Vec::new();
    values.walk(element, |event| {
        match event {
            Event::Value(property, value) if property == indices => {
                corners.push(corner(value, vertices)?);
            }
            Event::Value(property, value) if Some(property) == coordinates => {
                numbers.push(value as f32);
            }
            Event::Value(..) => {}
            Event::End => {
                // Fan both alike, so that coordinates stay with their corners.
                if coordinates.is_some() {
                    let at = places(&numbers, corners.len())?;
                    of_corners.extend(fan(at));
                }
                cloud.triangles.extend(fan(&corners));
                corners.clear();
                numbers.clear();
            }
        }
        Ok(())
    })?;
    if coordinates.is_some() {
        let corners = |at: [[f32; 2]; 3]| at.map(Vec2::from_array);
        cloud.coordinates =
            Some(Coordinates::Corners(of_corners.into_iter().map(corners).collect()));
    }
    Ok(())
}

/// Cuts a polygon a b c d ... into the fan abc, acd, ...
fn fan<T: Copy>(corners: &[T]) -> impl Iterator<Item = [T; 3]> {
    let pairs = corners.get(1..).unwrap_or_default().windows(2);
    pairs.map(|pair| [corners[0], pair[0], pair[1]])
}

/// Groups numbers into coordinates; there must be one pair for each corner.
fn places(numbers: &[f32], corners: usize) -> Result<&[[f32; 2]], String> {
    if numbers.len() == 2 * corners {
        return Ok(numbers.as_chunks().0);
    }
    let (found, needed) = (numbers.len(), 2 * corners);
    Err(format!("texcoord has {found} numbers, but {corners} corners need {needed}"))
}

/// The index of the property that lists the texture coordinates of corners, if there is one.
pub(super) fn coordinates(element: &Element) -> Result<Option<usize>, String> {
    let found = element.properties.iter().position(|p| p.name == "texcoord");
    match found.map(|index| element.properties[index].kind) {
        Some(PropertyKind::One(_)) => {
            Err("element face: property `texcoord` must be a list of numbers".into())
        }
        Some(PropertyKind::List { .. }) | None => Ok(found),
    }
}

/// Turns a number into the index of an existing vertex.
pub(super) fn corner(value: f64, vertices: u64) -> Result<u32, String> {
    if value >= 0.0 && value < vertices as f64 {
        Ok(value as u32)
    } else {
        Err(format!("vertex {value} does not exist; vertices are 0 to {}", vertices - 1))
    }
}

/// The index of the property that lists the corners.
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
