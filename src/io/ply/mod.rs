//! Read and write point clouds and meshes as PLY.
//!
//! [`read`] takes ascii and binary files of both byte orders, with LF or CR LF in the header. It
//! skips everything that a [`Cloud`] has no room for: other elements, other properties, comments.
//! To read further properties of vertices by their names, call [`properties`]. A header line
//! `comment TextureFile NAME`, which many programs write, names a texture, see
//! [`crate::io::texture`].
//!
//! # Properties that are read
//!
//! | element | properties | types | meaning |
//! |---|---|---|---|
//! | `vertex` | `x y z` | any | world units, rounded to `f32` once; far from 0, less an offset |
//! | | `nx ny nz` | any | of any length |
//! | | `radius` | any | world units |
//! | | `red green blue`, `diffuse_red diffuse_green diffuse_blue` or `r g b` | `uchar`, `ushort` | **sRGB**, decoded in `f64` and rounded once, see below |
//! | | | `short`, `int`, `uint` | sRGB from 0 to 255 |
//! | | | `float`, `double` | linear, kept |
//! | | `opacity` or `alpha` | `uchar`, `ushort` | divided by 255 or 65535 |
//! | | | `float`, `double` | kept |
//! | | `mip1_red mip1_green mip1_blue`, `mip2_red` ... | as `red` | [prefiltered colours](crate::scene::Mipmap), level by level from 1 on, 16 levels at most, beside `red green blue` |
//! | | `tux tuy tuz tvx tvy tvz` | any | half axes of an ellipse, world units |
//! | | `tx ty tz` | any | tangent of a tube, of any length |
//! | | `u v`, `s t` or `texture_u texture_v` | any | [texture coordinates](crate::scene::texture); `s` or `t` alone is skipped, because it means something else |
//! | | `group` | an integer | the surfel's own [group](crate::index::grouping), 0 to 63 |
//! | | `also` | list of integers | further groups that the surfel was added to, none twice; skipped without `group` |
//! | `group` | `scale` | any | factor for radii, finite and > 0, one for each group; skipped without `group` |
//! | `face` | `vertex_indices` or `vertex_index` | list of integers | a polygon, [cut into triangles](crate::io::polygon); with fewer than 3 corners it is dropped |
//! | | `red green blue` and the other names | as of `vertex` | the colour of its triangles, [`Cloud::triangle_color`]; colours of vertices win |
//! | | `texcoord` | list of numbers | texture coordinates, two for each corner; they replace the vertices' |
//! | `tristrips` | `vertex_indices` or `vertex_index` | list of integers | triangle strips; -1, or the greatest number of an unsigned type, ends a strip; triangles with two equal corners are left out |
//! | `edge` | `vertex1` and `vertex2` | integers | a segment of a ribbon or of a tube |
//!
//! If you compare with a renderer that takes colours as they are stored, note that splatref decodes
//! integers from sRGB ([`crate::number::srgb`]): a `uchar` of 128 is 0.2159 and not 0.502. Floats are
//! kept. [`ReadOptions::color_range`] replaces the rule of the type: colours of any type are then sRGB
//! codes from 0 to that number. The reader leaves a [warning](Cloud::warnings) where a rule hardly
//! fits: float colours above 8, 16-bit colours of which none is above 255, and integers above 255.
//! The names after `red green blue` count in any case of letters, if all three are there.
//!
//! Without an element `group`, the largest group number decides how many groups there are, each of
//! scale 1. With the element, its count decides, 64 at most. The element may come before or after
//! the vertices.
//!
//! Do not confuse tangents of tubes with half axes of ellipses: `t` alone is the direction in which
//! a tube runs, `tu` and `tv` span a disc.
//!
//! # Positions far from 0
//!
//! Coordinates of maps (UTM and the like) are millions of metres, where `f32` has steps of half a
//! metre. The reader subtracts an offset in f64 before it rounds, and keeps it in [`Cloud::offset`]:
//! a position plus the offset is the position in the file. The rule, over the positions whose
//! coordinates are finite:
//!
//! ```text
//!   middle = low / 2 + high / 2        of each axis
//!   reach  = the greatest of the three high / 2 - low / 2
//!   unit   = the greatest power of two that is not above the reach
//!   offset = floor(middle / unit) unit     of an axis with |middle| >= 16 reach, else 0
//! ```
//!
//! `Decided:` there is an offset only if `x`, `y` or `z` has the type `double`, `int` or `uint`, and if a
//! coordinate along an axis that would get an offset is no `f32`. So files of floats, and files whose
//! coordinates `f32` holds, keep every bit. The difference is exact in f64, because the offset is within
//! a factor of two of every coordinate; it is rounded to `f32` once.
//!
//! The reader counts the places that are still merged, and leaves a [warning](Cloud::warnings). One
//! point at 0 in a file of map coordinates does that: the box is then as large as the distance.
//! [`write()`] stores the offset in a line `comment splatref offset X Y Z`, which the reader takes back.
//!
//! # What the reader refuses
//!
//! A file of 3D Gaussians is refused by name, packed or not: its opacities are logits and its scales
//! are logarithms, so that points drawn from it would be wrong. [`crate::io::gaussians`] reads it.
//!
//! A vector must be declared completely or not at all. The reader does not judge values: NaN and
//! infinite values go into the cloud, and are dropped and counted when surfels are made from the
//! cloud. The reader does check structure and groups. It compares every count with the bytes that
//! are left before it allocates anything, and the elements must use up the file exactly.
//!
//! The reader is our own. The one well-kept crate that refuses hostile headers is serde-ply 0.2.2,
//! and it has these gaps:
//!
//! - It says neither which vertex nor which line or byte is wrong.
//! - It accepts a property that is declared twice, and ignores bytes that are left over.
//! - It loops 2^64 times over an element without properties.
//! - It does not tell 8-bit colours from float colours without a deserializer of about this size.

mod colors;
mod decode;
mod edges;
mod faces;
mod far;
mod gaussians;
mod groups;
mod header;
mod layout;
mod numbers;
mod order;
mod properties;
mod rows;
mod slabs;
mod stream;
mod strips;
#[cfg(test)]
mod tests;
mod values;
mod vertices;
mod write;

pub(in crate::io) use gaussians::{holds_gaussians, read_gaussians};
pub(in crate::io) use numbers::numbers;
pub use order::write_ordered;
pub(in crate::io) use properties::check_properties;
pub(in crate::io) use properties::number;
pub use properties::properties;
pub(in crate::io) use stream::Stream;
pub use write::write;

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::io::{Reason, input};
use crate::memory;
use crate::scene::Cloud;
use header::{Element, PlyHeader};
use std::io::Seek;
use std::path::Path;
use values::BodyValues;

/// The most memory that a vertex takes while arrays of all attributes grow, and a face of a few
/// corners.
const BYTES_A_VERTEX: u64 = 128;
const BYTES_A_FACE: u64 = 32;
/// Memory for the texture coordinates of a triangle; they are in memory twice while their array
/// grows and is handed over.
const BYTES_OF_COORDINATES: u64 = 24;

/// What the caller knows about a file that the file does not say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The code of white, > 0: colours are sRGB from 0 to this number, whatever their type. Without
    /// it, the type of a colour decides.
    pub color_range: Option<f64>,
    /// Whether positions stay where they are, even if `f32` merges them.
    pub keep_place: bool,
}

/// Reads a file, on one thread.
///
/// Memory holds the file and the cloud. A little-endian file whose vertices have no lists, no
/// groups and no double or 32-bit integer coordinates is decoded while it is read, so that memory holds only the cloud. For times, see the
/// bench `files`.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, [`Error::Format`] as [`parse`].
pub fn read(path: &Path) -> Result<Cloud> {
    read_with(path, &ReadOptions::default(), &Exec::sequential())
}

/// [`read`] with options and on several threads; threads change neither the cloud nor the error.
///
/// # Errors
/// As [`read`].
pub fn read_with(path: &Path, options: &ReadOptions, exec: &Exec) -> Result<Cloud> {
    let io = |source| Error::io(path, source);
    let format = |what| Error::format(path, what);
    let (mut file, length) = input::open(path).map_err(io)?;
    let of_slabs = |error| match error {
        slabs::Error::Io(source) => io(source),
        slabs::Error::Format(what) => format(what),
    };
    if let Some(rows) = slabs::start(&mut file, length, options).map_err(of_slabs)? {
        return rows.read(file, length, exec).map_err(of_slabs);
    }
    file.rewind().map_err(io)?;
    let bytes = input::rest(file, length).map_err(io)?;
    parse_with(&bytes, options, exec).map_err(format)
}

/// Reads the bytes of a file.
///
/// # Errors
/// One line if the bytes are no PLY file, are truncated, or differ from the header. It names the
/// element, the index of the vertex, face or edge, the property, the line (ascii) or byte (binary),
/// the problem and the remedy.
pub fn parse(bytes: &[u8]) -> std::result::Result<Cloud, String> {
    parse_with(bytes, &ReadOptions::default(), &Exec::sequential())
}

fn parse_with(bytes: &[u8], options: &ReadOptions, exec: &Exec) -> Reason<Cloud> {
    let header = header::parse(bytes)?;
    gaussians::check(&header)?;
    let vertex = vertex(&header)?;
    ask(&header, bytes.len() as u64, 0)?;
    let mut cloud = empty(&header);
    let mut groups = groups::Reader::new(vertex);
    let mut values = BodyValues::new(bytes, &header);
    let mut polygons = Vec::new();
    for element in &header.elements {
        if element.name == "vertex" {
            vertices::read(element, &mut values, &mut cloud, &mut groups, options, exec)?;
        } else {
            let more = other(element, &mut values, vertex.count, &mut cloud, &mut groups, options)?;
            polygons.extend(more);
        }
    }
    values.finish()?;
    faces::cut(&polygons, &mut cloud);
    cloud.groups = groups.finish()?;
    doubts(&header, options, &mut cloud);
    Ok(cloud)
}

/// A cloud that has only what the header says.
fn empty(header: &PlyHeader) -> Cloud {
    let PlyHeader { textures, offset, .. } = header;
    Cloud { textures: textures.clone(), offset: offset.unwrap_or_default(), ..Cloud::default() }
}

/// Notes what is to be doubted about the colours of a cloud.
fn doubts(header: &PlyHeader, options: &ReadOptions, cloud: &mut Cloud) {
    for (name, colors) in [("vertex", &cloud.color), ("face", &cloud.triangle_color)] {
        let element = header.elements.iter().find(|element| element.name == name);
        if let (Some(element), Some(colors)) = (element, colors) {
            cloud.warnings.extend(colors::doubt(element, options.color_range, colors));
        }
    }
}

/// Finds the element of vertices; there must be at least one vertex.
fn vertex(header: &PlyHeader) -> Reason<&Element> {
    let vertex = header.elements.iter().find(|element| element.name == "vertex");
    let vertex = vertex.ok_or("there is no element vertex: the file holds no points")?;
    if vertex.count == 0 {
        return Err("element vertex has count 0: the file holds no points".into());
    }
    Ok(vertex)
}

/// Asks for the memory of a cloud, and for `more` bytes. If a file of `length` bytes cannot hold a
/// count, the reader refuses it later, before it reads the element.
fn ask(header: &PlyHeader, length: u64, more: u64) -> Reason<()> {
    let vertices = vertex(header)?.count;
    let faces = header.elements.iter().filter(|element| element.name != "vertex");
    let a_face = |of: &Element| match faces::coordinates(of) {
        Ok(Some(_)) if of.name == "face" => BYTES_A_FACE + 2 * BYTES_OF_COORDINATES,
        _ => BYTES_A_FACE,
    };
    let faces: u64 = faces.map(|element| element.count.min(length) * a_face(element)).sum();
    let strips = header.elements.iter().any(|e| strips::NAMES.contains(&e.name.as_str()));
    // Each index of a strip makes a triangle, and takes at least two bytes of the file, or one.
    let strips = if strips { length.saturating_sub(vertices * 3) / 2 * BYTES_A_FACE } else { 0 };
    let vertex = vertex(header)?.properties.iter();
    let prefiltered = vertex.filter(|property| property.name.starts_with("mip")).count() as u64;
    let a_vertex = BYTES_A_VERTEX + 8 * prefiltered.min(48);
    let needed = vertices.min(length) * a_vertex + faces + strips;
    memory::try_ask(needed.saturating_add(more), || format!("a cloud of {vertices} points"))
}

/// Reads any element except the vertices; the file has `vertices` of them. Returns its polygons.
fn other(
    element: &Element,
    values: &mut BodyValues<'_>,
    vertices: u64,
    cloud: &mut Cloud,
    groups: &mut groups::Reader,
    options: &ReadOptions,
) -> Reason<faces::Polygons> {
    match element.name.as_str() {
        "edge" => edges::read(element, values, vertices, &mut cloud.edges)?,
        "face" => return faces::read(element, values, vertices, options.color_range, cloud),
        name if strips::NAMES.contains(&name) => {
            strips::read(element, values, vertices, &mut cloud.triangles)?;
        }
        "group" => groups.scales(element, values)?,
        _ => values.walk(element, |_| Ok(()))?,
    }
    Ok(Vec::new())
}
