//! Write PLY files.

use crate::error::Result;
use crate::io::replace::write_atomically;
use crate::scene::Cloud;
use crate::scene::{Coordinates, Groups, Mipmap};
use glam::DVec3;
use std::io::{self, Write};
use std::path::Path;

/// Writes a cloud as binary little-endian PLY; a failed write leaves no partial file.
///
/// [`super::read`] gives the same cloud back, bit for bit. The further properties come back from
/// [`super::properties`]. The texture itself is not written, only its name.
///
/// The file holds, in this order, whatever the cloud has:
///
/// - `comment TextureFile` with the name of each texture, unless the name is empty or has a line
///   break;
/// - `comment splatref offset X Y Z` with the [offset](Cloud::offset), unless it is 0;
/// - vertices with float properties `x y z`, `nx ny nz`, `radius`, `red green blue` (linear),
///   `opacity`, `tux tuy tuz tvx tvy tvz`, `tx ty tz`, `u v`, the further
///   [properties](Cloud::properties) under their names, and `mip1_red mip1_green mip1_blue` and so
///   on for each level (linear);
/// - for groups, the vertex properties `uchar group` and, if surfels were added to further groups,
///   `list uchar uchar also`;
/// - triangles as `face` with `list uchar uint vertex_indices`, if corners have texture coordinates
///   `list uchar float texcoord`, and float `red green blue` if triangles have colours (linear);
/// - edges as `edge` with `uint vertex1 vertex2`;
/// - the element `group` with `float scale`, if the vertices alone do not tell how many groups
///   there are, or if radii are scaled.
///
/// # Errors
/// [`crate::Error::Invalid`] if the arrays of the cloud differ in length; [`crate::Error::Io`] as
/// [`write_atomically`].
pub fn write(path: &Path, cloud: &Cloud) -> Result<()> {
    cloud.check()?;
    write_atomically(path, |out| encode(cloud, out))
}

/// Writes the bytes of a checked cloud.
pub(super) fn encode(cloud: &Cloud, out: &mut impl Write) -> io::Result<()> {
    header(cloud, out)?;
    let groups = cloud.groups.as_ref();
    let added = added(cloud);
    for i in 0..cloud.position.len() {
        let mut put = |values: &[f32]| {
            values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))
        };
        put(&cloud.position[i].to_array())?;
        cloud.normal.as_ref().map_or(Ok(()), |normal| put(&normal[i].to_array()))?;
        cloud.radius.as_ref().map_or(Ok(()), |radius| put(&[radius[i]]))?;
        cloud.color.as_ref().map_or(Ok(()), |color| put(&color[i].to_array()))?;
        cloud.opacity.as_ref().map_or(Ok(()), |opacity| put(&[opacity[i]]))?;
        if let Some(tangents) = &cloud.tangents {
            put(&tangents[i][0].to_array())?;
            put(&tangents[i][1].to_array())?;
        }
        cloud.tangent.as_ref().map_or(Ok(()), |tangent| put(&tangent[i].to_array()))?;
        if let Some(Coordinates::Points(all)) = &cloud.coordinates {
            put(&all[i].to_array())?;
        }
        cloud.properties.iter().try_for_each(|one| put(&[one.values[i]]))?;
        let levels = cloud.mipmap.iter().flat_map(|mipmap| mipmap.of_surfel(i));
        levels.into_iter().try_for_each(|color| put(&color.to_array()))?;
        if let Some(groups) = groups {
            out.write_all(&groups.own()[i..=i])?;
        }
        if let Some(groups) = added {
            let also: Vec<u8> = groups.of_surfel(i as u32).skip(1).collect();
            out.write_all(&[also.len() as u8])?;
            out.write_all(&also)?;
        }
    }
    for (i, triangle) in cloud.triangles.iter().enumerate() {
        out.write_all(&[3])?;
        triangle.iter().try_for_each(|index| out.write_all(&index.to_le_bytes()))?;
        if let Some(Coordinates::Corners(all)) = &cloud.coordinates {
            out.write_all(&[6])?;
            let mut numbers = all[i].iter().flat_map(|at| at.to_array());
            numbers.try_for_each(|number| out.write_all(&number.to_le_bytes()))?;
        }
        if let Some(colors) = &cloud.triangle_color {
            let mut numbers = colors[i].to_array().into_iter();
            numbers.try_for_each(|number| out.write_all(&number.to_le_bytes()))?;
        }
    }
    let mut ends = cloud.edges.iter().flatten();
    ends.try_for_each(|index| out.write_all(&index.to_le_bytes()))?;
    let mut scales = scaled(cloud).into_iter().flat_map(Groups::scale);
    scales.try_for_each(|scale| out.write_all(&scale.to_le_bytes()))
}

/// Writes the header: elements, their counts and properties.
fn header(cloud: &Cloud, out: &mut impl Write) -> io::Result<()> {
    let names = [
        (true, "x y z"),
        (cloud.normal.is_some(), "nx ny nz"),
        (cloud.radius.is_some(), "radius"),
        (cloud.color.is_some(), "red green blue"),
        (cloud.opacity.is_some(), "opacity"),
        (cloud.tangents.is_some(), "tux tuy tuz tvx tvy tvz"),
        (cloud.tangent.is_some(), "tx ty tz"),
        (matches!(cloud.coordinates, Some(Coordinates::Points(_))), "u v"),
    ];
    let properties = cloud.properties.iter().map(|one| one.name.as_str());
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    let is_line = |name: &&String| !(name.is_empty() || name.contains(['\n', '\r']));
    for name in cloud.textures.iter().filter(is_line) {
        writeln!(out, "comment TextureFile {name}")?;
    }
    offset_line(cloud.offset, out)?;
    writeln!(out, "element vertex {}", cloud.position.len())?;
    let names = names.iter().filter(|n| n.0).flat_map(|n| n.1.split(' '));
    for name in names.chain(properties) {
        writeln!(out, "property float {name}")?;
    }
    for level in 1..=cloud.mipmap.as_ref().map_or(0, Mipmap::levels) {
        for channel in ["red", "green", "blue"] {
            writeln!(out, "property float mip{level}_{channel}")?;
        }
    }
    if cloud.groups.is_some() {
        writeln!(out, "property uchar group")?;
    }
    if added(cloud).is_some() {
        writeln!(out, "property list uchar uchar also")?;
    }
    if !cloud.triangles.is_empty() {
        writeln!(out, "element face {}", cloud.triangles.len())?;
        writeln!(out, "property list uchar uint vertex_indices")?;
        if matches!(cloud.coordinates, Some(Coordinates::Corners(_))) {
            writeln!(out, "property list uchar float texcoord")?;
        }
        if cloud.triangle_color.is_some() {
            writeln!(out, "property float red\nproperty float green\nproperty float blue")?;
        }
    }
    if !cloud.edges.is_empty() {
        writeln!(out, "element edge {}", cloud.edges.len())?;
        writeln!(out, "property uint vertex1\nproperty uint vertex2")?;
    }
    if let Some(groups) = scaled(cloud) {
        writeln!(out, "element group {}\nproperty float scale", groups.len())?;
    }
    writeln!(out, "end_header")
}

/// Writes what was subtracted from positions, unless it is 0.
pub(super) fn offset_line(offset: DVec3, out: &mut impl Write) -> io::Result<()> {
    let DVec3 { x, y, z } = offset;
    match offset == DVec3::ZERO {
        true => Ok(()),
        false => writeln!(out, "comment splatref offset {x} {y} {z}"),
    }
}

/// The groups, if surfels were added to some.
fn added(cloud: &Cloud) -> Option<&Groups> {
    cloud.groups.as_ref().filter(|groups| !groups.added().is_empty())
}

/// The groups, if the vertices alone do not describe them.
pub(super) fn scaled(cloud: &Cloud) -> Option<&Groups> {
    cloud.groups.as_ref().filter(|groups| !tell(groups))
}

/// Whether the vertices alone describe the groups: the last group has a surfel, and no radius is
/// scaled.
fn tell(groups: &Groups) -> bool {
    let numbers = groups.own().iter().chain(groups.added().iter().map(|pair| &pair.1));
    let last = numbers.fold(0, |last, &group| last.max(group));
    usize::from(last) + 1 == groups.len() && groups.scale().iter().all(|&scale| scale == 1.0)
}
