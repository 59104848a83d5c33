//! Read the element `face`: polygons, cut into triangles.

use super::colors;
use super::decode::Decode;
use super::header::{Element, PropertyKind, quote};
use super::values::{BodyValues, Event};
use crate::io::polygon;
use crate::scene::{Cloud, Coordinates};
use glam::{Vec2, Vec3};

/// The first triangle and the corners of each polygon of more than 3 corners.
pub(super) type Polygons = Vec<[u32; 2]>;

/// Reads all faces and appends their triangles, and the texture coordinates of their corners and
/// their colours if there are any. Each index must be below `vertices`. `color_range` is the code
/// of white, if the caller knows it. Returns the polygons that
/// [`cut`] looks at.
pub(super) fn read(
    element: &Element,
    values: &mut BodyValues<'_>,
    vertices: u64,
    color_range: Option<f64>,
    cloud: &mut Cloud,
) -> Result<Polygons, String> {
    let mut polygons = Vec::new();
    if element.count == 0 {
        return Ok(polygons);
    }
    let indices = indices(element)?;
    let coordinates = coordinates(element)?;
    let channels = channels(element, color_range)?;
    let (mut color, mut colors) = (Vec3::ZERO, Vec::new());
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
            Event::Value(property, value) => {
                let channels = channels.iter().flatten().enumerate();
                for (channel, (_, decode)) in channels.filter(|(_, (at, _))| *at == property) {
                    color[channel] = decode.apply(value);
                }
            }
            Event::End => {
                // Fan both alike, so that coordinates stay with their corners.
                if coordinates.is_some() {
                    let at = places(&numbers, corners.len())?;
                    of_corners.extend(fan(at));
                }
                if channels.is_some() {
                    colors.extend(fan(&corners).map(|_| color));
                }
                if corners.len() > 3 {
                    polygons.push([cloud.triangles.len() as u32, corners.len() as u32]);
                }
                cloud.triangles.extend(fan(&corners));
                corners.clear();
                numbers.clear();
            }
        }
        Ok(())
    })?;
    cloud.triangle_color = channels.map(|_| colors);
    if coordinates.is_some() {
        let corners = |at: [[f32; 2]; 3]| at.map(Vec2::from_array);
        cloud.coordinates =
            Some(Coordinates::Corners(of_corners.into_iter().map(corners).collect()));
    }
    Ok(polygons)
}

/// Cuts polygons into ears where the fan leaves them, as soon as all vertices are read.
pub(super) fn cut(polygons: &Polygons, cloud: &mut Cloud) {
    let mut budget = polygon::Budget::new();
    for &[start, corners] in polygons {
        let all = start as usize..(start + corners) as usize - 2;
        let fan = &mut cloud.triangles[all.clone()];
        let corners = polygon::corners(fan);
        let positions = corners.iter().map(|&corner| cloud.position[corner as usize]);
        let Some(ears) = polygon::ears(&positions.collect::<Vec<_>>(), &mut budget) else {
            continue;
        };
        polygon::recut(fan, &corners, &ears);
        if let Some(Coordinates::Corners(coordinates)) = &mut cloud.coordinates
            && let Some(fan) = coordinates.get_mut(all)
        {
            let corners = polygon::corners(fan);
            polygon::recut(fan, &corners, &ears);
        }
    }
    cloud.warnings.extend(budget.warning());
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

/// The properties of a face's colour and how they are decoded, if it has all of them.
fn channels(
    element: &Element,
    color_range: Option<f64>,
) -> Result<Option<[(usize, Decode); 3]>, String> {
    let [Some(red), Some(green), Some(blue)] = colors::channels(element) else { return Ok(None) };
    let of = |at| Ok::<_, String>((at, colors::decode(element, at, color_range)?));
    Ok(Some([of(red)?, of(green)?, of(blue)?]))
}

/// The index of the property that lists the corners.
pub(super) fn indices(element: &Element) -> Result<usize, String> {
    let names = ["vertex_indices", "vertex_index"];
    let found = element.properties.iter().position(|p| names.contains(&p.name.as_str()));
    let index = found.ok_or_else(|| {
        format!("element {} has no property list vertex_indices; declare it", element.name)
    })?;
    let property = &element.properties[index];
    match property.kind {
        PropertyKind::List { item, .. } if item.is_integer() => Ok(index),
        PropertyKind::List { .. } | PropertyKind::One(_) => {
            let name = quote(&property.name);
            Err(format!("element {}: property {name} must be a list of integers", element.name))
        }
    }
}
