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
//! | `vertex` | `x y z` | any | world units, rounded to `f32` once |
//! | | `nx ny nz` | any | of any length |
//! | | `radius` | any | world units |
//! | | `red green blue` | `uchar`, `ushort` | **sRGB**, decoded in `f64` and rounded once, see below |
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
//! | `face` | `vertex_indices` or `vertex_index` | list of integers | a polygon becomes a triangle fan around its first corner; with fewer than 3 corners it is dropped |
//! | | `texcoord` | list of numbers | texture coordinates, two for each corner; they replace the vertices' |
//! | `edge` | `vertex1` and `vertex2` | integers | a segment of a ribbon or of a tube |
//!
//! If you compare with a renderer that takes colours as they are stored, note that splatref decodes
//! integers from sRGB ([`crate::io::srgb`]): a `uchar` of 128 is 0.2159 and not 0.502. Floats are
//! kept.
//!
//! Without an element `group`, the largest group number decides how many groups there are, each of
//! scale 1. With the element, its count decides, 64 at most. The element may come before or after
//! the vertices.
//!
//! Do not confuse tangents of tubes with half axes of ellipses: `t` alone is the direction in which
//! a tube runs, `tu` and `tv` span a disc.
//!
//! # What the reader refuses
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

mod edges;
mod faces;
mod groups;
mod header;
mod numbers;
mod properties;
mod rows;
mod slabs;
#[cfg(test)]
mod tests;
mod values;
mod vertices;
mod write;

pub(in crate::io) use numbers::numbers;
pub(in crate::io) use properties::check_properties;
pub use properties::properties;
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
const BYTES_A_FACE: u64 = 24;
/// Memory for the texture coordinates of a triangle; they are in memory twice while their array
/// grows and is handed over.
const BYTES_OF_COORDINATES: u64 = 24;

/// Reads a file, on one thread.
///
/// Memory holds the file and the cloud. A little-endian file whose vertices have no lists and no
/// groups is decoded while it is read, so that memory holds only the cloud. For times, see the
/// bench `files`.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, [`Error::Format`] as [`parse`].
pub fn read(path: &Path) -> Result<Cloud> {
    read_with(path, &Exec::sequential())
}

/// [`read`] on several threads; the cloud, or the error, is the same.
///
/// # Errors
/// As [`read`].
pub fn read_with(path: &Path, exec: &Exec) -> Result<Cloud> {
    let io = |source| Error::io(path, source);
    let format = |what| Error::format(path, what);
    let (mut file, length) = input::open(path).map_err(io)?;
    if let Some(rows) = slabs::start(&mut file, length).map_err(io)? {
        return rows.read(file, length, exec).map_err(|error| match error {
            slabs::Error::Io(source) => io(source),
            slabs::Error::Format(what) => format(what),
        });
    }
    file.rewind().map_err(io)?;
    let bytes = input::rest(file, length).map_err(io)?;
    parse_with(&bytes, exec).map_err(format)
}

/// Reads the bytes of a file.
///
/// # Errors
/// One line if the bytes are no PLY file, are truncated, or differ from the header. It names the
/// element, the index of the vertex, face or edge, the property, the line (ascii) or byte (binary),
/// the problem and the remedy.
pub fn parse(bytes: &[u8]) -> std::result::Result<Cloud, String> {
    parse_with(bytes, &Exec::sequential())
}

fn parse_with(bytes: &[u8], exec: &Exec) -> Reason<Cloud> {
    let header = header::parse(bytes)?;
    let vertex = vertex(&header)?;
    ask(&header, bytes.len() as u64, 0)?;
    let mut cloud = Cloud { textures: header.textures.clone(), ..Cloud::default() };
    let mut groups = groups::Reader::new(vertex);
    let mut values = BodyValues::new(bytes, &header);
    for element in &header.elements {
        if element.name == "vertex" {
            vertices::read(element, &mut values, &mut cloud, &mut groups, exec)?;
        } else {
            other(element, &mut values, vertex.count, &mut cloud, &mut groups)?;
        }
    }
    values.finish()?;
    cloud.groups = groups.finish()?;
    Ok(cloud)
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
    let vertex = vertex(header)?.properties.iter();
    let prefiltered = vertex.filter(|property| property.name.starts_with("mip")).count() as u64;
    let a_vertex = BYTES_A_VERTEX + 8 * prefiltered.min(48);
    let needed = vertices.min(length) * a_vertex + faces;
    memory::try_ask(needed.saturating_add(more), || format!("a cloud of {vertices} points"))
}

/// Reads any element except the vertices; the file has `vertices` of them.
fn other(
    element: &Element,
    values: &mut BodyValues<'_>,
    vertices: u64,
    cloud: &mut Cloud,
    groups: &mut groups::Reader,
) -> Reason<()> {
    match element.name.as_str() {
        "edge" => edges::read(element, values, vertices, &mut cloud.edges),
        "face" => faces::read(element, values, vertices, cloud),
        "group" => groups.scales(element, values),
        _ => values.walk(element, |_| Ok(())),
    }
}
