//! Read the element `vertex`.

use super::header::Element;
use super::layout::{
    COLOR, COORDINATE, Layout, MIPMAP, NORMAL, OPACITY, POSITION, PropertyUse, RADIUS, TANGENT,
    TANGENTS,
};
use super::rows::Rows;
use super::values::{BodyValues, Event};
use super::{ReadOptions, far, groups};
use crate::frame::Exec;
use crate::scene::{Cloud, Coordinates};
use glam::{Vec2, Vec3};
use std::ops::Range;

/// Reads all vertices into the empty arrays of `cloud`.
pub(super) fn read(
    element: &Element,
    values: &mut BodyValues<'_>,
    cloud: &mut Cloud,
    groups: &mut groups::Reader,
    options: &ReadOptions,
    exec: &Exec,
) -> Result<(), String> {
    let mut layout = Layout::new(element, groups, options.color_range)?;
    if let Some((offset, warning)) = far::shift(element, values, &mut layout, options.keep_place)? {
        cloud.offset += offset;
        cloud.warnings.extend(warning);
    }
    layout.arrays(cloud)?;
    // Rows of one length are decoded in parallel, and cannot fail.
    if let Some(rows) = Rows::new(element, &layout, values.format()) {
        let bytes = values.rows(element, rows.stride())?;
        rows.append(bytes, cloud, exec);
        return Ok(());
    }
    let mut row = vec![0.0; layout.width()];
    values.walk(element, |event| {
        match event {
            Event::Value(property, value) => match layout.slots[property] {
                PropertyUse::Skip => {}
                PropertyUse::Number(place, decode) => row[place] = decode.apply(value),
                PropertyUse::Group(part) => groups.put(part, value)?,
            },
            Event::End => {
                push(cloud, &row);
                groups.end();
            }
        }
        Ok(())
    })
}

/// Adds one vertex.
fn push(cloud: &mut Cloud, row: &[f32]) {
    let vector = |group: Range<usize>| Vec3::from_slice(&row[group]);
    cloud.position.push(vector(POSITION));
    if let Some(normals) = &mut cloud.normal {
        normals.push(vector(NORMAL));
    }
    if let Some(radii) = &mut cloud.radius {
        radii.push(row[RADIUS.start]);
    }
    if let Some(colors) = &mut cloud.color {
        colors.push(vector(COLOR));
    }
    if let Some(opacities) = &mut cloud.opacity {
        opacities.push(row[OPACITY.start]);
    }
    if let Some(tangents) = &mut cloud.tangents {
        let middle = TANGENTS.start + 3;
        tangents.push([vector(TANGENTS.start..middle), vector(middle..TANGENTS.end)]);
    }
    if let Some(tangents) = &mut cloud.tangent {
        tangents.push(vector(TANGENT));
    }
    if let Some(Coordinates::Points(all)) = &mut cloud.coordinates {
        all.push(Vec2::from_slice(&row[COORDINATE]));
    }
    if let Some(mipmap) = &mut cloud.mipmap {
        mipmap.colors_mut().extend(row[MIPMAP..].chunks_exact(3).map(Vec3::from_slice));
    }
}
