//! PLY: point clouds and meshes, in and out.
//!
//! Read are ascii and binary files of both byte orders, with LF or CR LF in the header. What a
//! [`Cloud`] has no room for (other elements, other properties, comments) is skipped; [`properties`] reads further
//! properties of vertices by their names. A line `comment TextureFile
//! NAME` of the header, which many programs write, names a texture, see [`crate::io::texture`].
//!
//! | element | properties | types | |
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
//! | | `u v`, `s t` or `texture_u texture_v` | any | [texture coordinates](crate::scene::texture); `s` or `t` alone is something else |
//! | | `group` | an integer | the surfel's own [group](crate::index::grouping), 0 to 63 |
//! | | `also` | list of integers | further groups that it was added to, none twice; skipped without `group` |
//! | `group` | `scale` | any | what radii are multiplied by, finite and > 0, for each group; skipped without `group` |
//! | `face` | `vertex_indices` or `vertex_index` | list of integers | a polygon is the fan of its first corner; with fewer than 3 corners it is nothing |
//! | | `texcoord` | list of numbers | texture coordinates, two a corner, in the place of the vertices' |
//! | `edge` | `vertex1` and `vertex2` | integers | a segment of a ribbon or of a tube |
//!
//! To compare with a renderer that takes colours as they are stored, mind that integers here are
//! decoded from sRGB ([`crate::number::srgb`]): a `uchar` of 128 is 0.2159 and not 0.502. Floats are kept.
//!
//! Without an element `group` there are as many groups as the largest number tells, of scale 1;
//! with one there are as many as it has, 64 at most. It may come before or after the vertices.
//!
//! Tangents of tubes and half axes of ellipses are not the same: `t` alone is the direction in
//! which a tube runs, `tu` and `tv` span a disc.
//!
//! All of a vector is declared or nothing of it. Values are not judged: NaN and infinite ones go
//! into the cloud, and are dropped and counted when surfels are made of it. Structure and groups
//! are: every count is held against the bytes that are left before anything is allocated, and must
//! use up the file exactly.
//!
//! The reader is our own because the one well-kept crate that refuses hostile headers, serde-ply
//! 0.2.2, says neither which vertex nor which line or byte is wrong, accepts a property declared
//! twice, ignores what is left over, loops 2^64 times over an element without properties, and does
//! not tell 8-bit colours from float ones without a deserializer of about this size.

mod edges;
mod faces;
mod groups;
mod header;
mod layout;
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

/// What a vertex takes at most while arrays of all attributes grow, and a face of a few corners.
const BYTES_A_VERTEX: u64 = 128;
const BYTES_A_FACE: u64 = 24;
/// What the texture coordinates of a triangle take, once more while their array grows and is handed over.
const BYTES_OF_COORDINATES: u64 = 24;

/// Reads a file, on one thread. It needs memory for the file and the cloud; little-endian ones without
/// lists and groups of vertices need none for the file, and are decoded as they are read. Times are
/// those of the bench `files`.
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
/// One line if they are no PLY file, truncated, or hold other than their header says: the element,
/// the index of the vertex, face or edge, the property, the line (ascii) or byte (binary), what is
/// wrong and what to do.
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

/// The vertices, of which there must be some.
fn vertex(header: &PlyHeader) -> Reason<&Element> {
    let vertex = header.elements.iter().find(|element| element.name == "vertex");
    let vertex = vertex.ok_or("there is no element vertex: the file holds no points")?;
    if vertex.count == 0 {
        return Err("element vertex has count 0: the file holds no points".into());
    }
    Ok(vertex)
}

/// Asks for the memory of a cloud, and of `more` bytes. A count that a file of `length` bytes
/// cannot hold is refused later, before anything is read of it.
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

/// Reads an element that is not the vertices, of which there are `vertices`.
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
