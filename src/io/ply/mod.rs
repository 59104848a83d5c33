//! PLY: point clouds and meshes, in and out.
//!
//! Read are ascii and binary files of both byte orders, with LF or CR LF in the header. What a
//! [`Cloud`] has no room for (other elements, other properties, comments) is skipped.
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
//! | | `tux tuy tuz tvx tvy tvz` | any | half axes of an ellipse, world units |
//! | | `tx ty tz` | any | tangent of a tube, of any length |
//! | | `group` | an integer | the surfel's own [group](crate::index::grouping), 0 to 63 |
//! | | `also` | list of integers | further groups that it was added to, none twice; skipped without `group` |
//! | `group` | `scale` | any | what radii are multiplied by, finite and > 0, for each group; skipped without `group` |
//! | `face` | `vertex_indices` or `vertex_index` | list of integers | a polygon is the fan of its first corner; with fewer than 3 corners it is nothing |
//! | `edge` | `vertex1` and `vertex2` | integers | a segment of a ribbon or of a tube |
//!
//! To compare with a renderer that takes colours as they are stored, mind that integers here are
//! decoded from sRGB ([`crate::io::srgb`]): a `uchar` of 128 is 0.2159 and not 0.502. Floats are kept.
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
#[cfg(test)]
mod tests;
mod values;
mod vertices;
mod write;

pub use write::write;

use crate::error::{Error, Result};
use crate::io::input;
use crate::memory;
use crate::scene::Cloud;
use std::path::Path;
use values::BodyValues;

/// What a vertex takes at most while arrays of all attributes grow, and a face of a few corners.
const BYTES_A_VERTEX: u64 = 128;
const BYTES_A_FACE: u64 = 24;

/// Reads a file. It needs memory for the file and the cloud, and about 0.1 s for a million points.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, [`Error::Format`] as [`parse`].
pub fn read(path: &Path) -> Result<Cloud> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    parse(&bytes).map_err(|what| Error::format(path, what))
}

/// Reads the bytes of a file.
///
/// # Errors
/// One line if they are no PLY file, truncated, or hold other than their header says: the element,
/// the index of the vertex, face or edge, the property, the line (ascii) or byte (binary), what is
/// wrong and what to do.
pub fn parse(bytes: &[u8]) -> std::result::Result<Cloud, String> {
    let header = header::parse(bytes)?;
    let vertices = header.elements.iter().find(|element| element.name == "vertex");
    let vertex = vertices.ok_or("there is no element vertex: the file holds no points")?;
    let vertices = vertex.count;
    if vertices == 0 {
        return Err("element vertex has count 0: the file holds no points".into());
    }

    // A count that the bytes cannot hold is refused before anything is read of it.
    let faces = header.elements.iter().filter(|element| element.name != "vertex");
    let faces: u64 = faces.map(|element| element.count.min(bytes.len() as u64)).sum();
    let needed = vertices.min(bytes.len() as u64) * BYTES_A_VERTEX + faces * BYTES_A_FACE;
    memory::try_ask(needed, || format!("a cloud of {vertices} points"))?;
    let mut values = BodyValues::new(bytes, &header);
    let mut cloud = Cloud::default();
    let mut groups = groups::Reader::new(vertex);
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => vertices::read(element, &mut values, &mut cloud, &mut groups)?,
            "edge" => edges::read(element, &mut values, vertices, &mut cloud.edges)?,
            "face" => faces::read(element, &mut values, vertices, &mut cloud.triangles)?,
            "group" => groups.scales(element, &mut values)?,
            _ => values.walk(element, |_| Ok(()))?,
        }
    }
    values.finish()?;
    cloud.groups = groups.finish()?;
    Ok(cloud)
}
