//! Write vertices of a file in another order, with every property in its own type.

use super::header::{self, Element, Format, PlyHeader, Property, PropertyKind, Scalar};
use super::values::{BodyValues, Event};
use super::write::{offset_line, scaled};
use super::{colors, vertex};
use crate::error::{Error, Result};
use crate::io::replace::write_atomically;
use crate::io::{Reason, input};
use crate::memory;
use crate::scene::Cloud;
use std::io::{self, Write};
use std::path::Path;

/// Writes the vertices of `source` with these indices, in this order, as binary little-endian PLY.
///
/// Every property keeps its name, its type and its value, lists included: a label stays an integer
/// and a double stays a double. Other elements and comments are left out, except groups. `ordered`
/// is the cloud of these points. Its colours replace the file's if `recolored` says so; they become
/// float properties `red green blue` (linear) behind the others.
///
/// # Errors
/// [`Error::Io`] if a file cannot be read or written, [`Error::Format`] as [`super::parse`], and if
/// `source` has no vertex of an index, because it changed meanwhile.
pub fn write_ordered(
    path: &Path,
    source: &Path,
    indices: &[u32],
    ordered: &Cloud,
    recolored: bool,
) -> Result<()> {
    let (file, length) = input::open(source).map_err(|error| Error::io(source, error))?;
    let bytes = input::rest(file, length).map_err(|error| Error::io(source, error))?;
    let read = |bytes: &[u8]| {
        let header = header::parse(bytes)?;
        let rows = Rows::read(&header, bytes, recolored)?;
        Ok::<_, String>((header, rows))
    };
    let (header, rows) = read(&bytes).map_err(|what| Error::format(source, what))?;
    if let Some(&index) = indices.iter().find(|&&index| index as usize >= rows.ends.len()) {
        let what = format!("vertex {index} is gone: the file changed while it was read; run again");
        return Err(Error::format(source, what));
    }
    write_atomically(path, |out| {
        let vertex = vertex(&header).map_err(io::Error::other)?;
        writeln!(out, "ply\nformat binary_little_endian 1.0")?;
        // The rows keep the coordinates of the file, so only an offset of the file itself is needed.
        offset_line(header.offset.unwrap_or_default(), out)?;
        head(vertex, &rows.kept, indices.len(), ordered, recolored, out)?;
        for (at, &index) in indices.iter().enumerate() {
            out.write_all(rows.row(index as usize))?;
            if let (Some(colors), true) = (&ordered.color, recolored) {
                let mut channels = colors[at].to_array().into_iter();
                channels.try_for_each(|channel| out.write_all(&channel.to_le_bytes()))?;
            }
        }
        let mut scales = scaled(ordered).into_iter().flat_map(|groups| groups.scale());
        scales.try_for_each(|scale| out.write_all(&scale.to_le_bytes()))
    })
}

/// The vertices of a file as bytes of a little-endian body.
struct Rows {
    /// Whether each property is kept.
    kept: Vec<bool>,
    bytes: Vec<u8>,
    /// Where each row ends.
    ends: Vec<usize>,
}

impl Rows {
    /// Reads all vertices; without their colours if they will be replaced.
    fn read(header: &PlyHeader, bytes: &[u8], recolored: bool) -> Reason<Self> {
        let vertex = vertex(header)?;
        let channels = colors::channels(vertex);
        let is_kept = |i| !(recolored && channels.contains(&Some(i)));
        let kept: Vec<bool> = (0..vertex.properties.len()).map(is_kept).collect();
        // A word of a text takes two bytes at least, and a number at most eight.
        let factor = if header.format == Format::Ascii { 4 } else { 1 };
        let more = 8 * vertex.count.min(bytes.len() as u64);
        memory::try_ask(bytes.len() as u64 * factor + more, || format!("{} rows", vertex.count))?;
        let mut rows = Self { kept, bytes: Vec::new(), ends: Vec::new() };
        let mut row = vec![Vec::new(); vertex.properties.len()];
        let mut values = BodyValues::new(bytes, header);
        for element in &header.elements {
            if !std::ptr::eq(element, vertex) {
                values.walk(element, |_| Ok(()))?;
                continue;
            }
            values.walk(element, |event| {
                match event {
                    Event::Value(property, value) => row[property].push(value),
                    Event::End => rows.push(vertex, &mut row),
                }
                Ok(())
            })?;
            // Later elements cannot change the vertices.
            break;
        }
        Ok(rows)
    }

    /// Appends a row, and empties it.
    fn push(&mut self, vertex: &Element, row: &mut [Vec<f64>]) {
        let properties = vertex.properties.iter().zip(&self.kept).zip(row);
        for ((property, &is_kept), values) in properties {
            if is_kept {
                let item = match property.kind {
                    PropertyKind::One(scalar) => scalar,
                    PropertyKind::List { count, item } => {
                        encode(count, values.len() as f64, &mut self.bytes);
                        item
                    }
                };
                values.iter().for_each(|&value| encode(item, value, &mut self.bytes));
            }
            values.clear();
        }
        self.ends.push(self.bytes.len());
    }

    fn row(&self, index: usize) -> &[u8] {
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.bytes[start..self.ends[index]]
    }
}

/// Appends the bytes of a number, which has been read from a number of this type.
fn encode(scalar: Scalar, value: f64, to: &mut Vec<u8>) {
    match scalar {
        Scalar::I8 => to.extend((value as i8).to_le_bytes()),
        Scalar::U8 => to.extend((value as u8).to_le_bytes()),
        Scalar::I16 => to.extend((value as i16).to_le_bytes()),
        Scalar::U16 => to.extend((value as u16).to_le_bytes()),
        Scalar::I32 => to.extend((value as i32).to_le_bytes()),
        Scalar::U32 => to.extend((value as u32).to_le_bytes()),
        Scalar::F32 => to.extend((value as f32).to_le_bytes()),
        Scalar::F64 => to.extend(value.to_le_bytes()),
    }
}

/// Writes the elements of the header.
fn head(
    vertex: &Element,
    kept: &[bool],
    count: usize,
    ordered: &Cloud,
    recolored: bool,
    out: &mut impl Write,
) -> io::Result<()> {
    writeln!(out, "element vertex {count}")?;
    let kept = vertex.properties.iter().zip(kept).filter(|(_, is_kept)| **is_kept);
    for (Property { name, kind }, _) in kept {
        match kind {
            PropertyKind::One(scalar) => writeln!(out, "property {} {name}", scalar.name())?,
            PropertyKind::List { count, item } => {
                writeln!(out, "property list {} {} {name}", count.name(), item.name())?;
            }
        }
    }
    if recolored && ordered.color.is_some() {
        writeln!(out, "property float red\nproperty float green\nproperty float blue")?;
    }
    if let Some(groups) = scaled(ordered) {
        writeln!(out, "element group {}\nproperty float scale", groups.len())?;
    }
    writeln!(out, "end_header")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::ply;
    use glam::Vec3;

    const HEADER: &str = "element vertex 3\nproperty double x\nproperty double y\n\
                          property double z\nproperty uchar r\nproperty uchar g\n\
                          property uchar b\nproperty int label\nproperty uint id\n\
                          property list uchar short more\nproperty float scalar_Intensity\n\
                          end_header\n";

    fn rows(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
        let bytes = std::fs::read(path).unwrap();
        let header = header::parse(&bytes).unwrap();
        let vertex = vertex(&header).unwrap();
        let (mut all, mut row) = (Vec::new(), Vec::new());
        let mut values = BodyValues::new(&bytes, &header);
        values
            .walk(vertex, |event| {
                match event {
                    Event::Value(_, value) => row.push(value),
                    Event::End => all.push(std::mem::take(&mut row)),
                }
                Ok(())
            })
            .unwrap();
        values.finish().unwrap();
        let name = |p: &Property| format!("{} {:?}", p.name, p.kind);
        (vertex.properties.iter().map(name).collect(), all)
    }

    #[test]
    fn every_property_keeps_its_type_and_value() {
        let folder = tempfile::tempdir().unwrap();
        let [from, to] = ["from.ply", "to.ply"].map(|name| folder.path().join(name));
        let body = "635000.25 4853000.125 1 255 128 0 16777217 4294967295 2 -7 300 0.5\n\
                    635000.75 4853000.375 2 10 20 30 -2 1 0 nan\n\
                    635001.25 4853000.625 0.1 1 2 3 3 2 1 9 0.1\n";
        std::fs::write(&from, format!("ply\nformat ascii 1.0\n{HEADER}{body}")).unwrap();
        let cloud = ply::read(&from).unwrap();
        write_ordered(&to, &from, &[2, 0], &cloud.some(&[2, 0]), false).unwrap();
        let ((names, given), (new_names, found)) = (rows(&from), rows(&to));
        assert_eq!(new_names, names);
        assert_eq!(found, [given[2].clone(), given[0].clone()]);

        // Colours that were averaged take the place of the file's.
        let mut some = cloud.some(&[0]);
        some.color = Some(vec![Vec3::new(0.25, 0.5, 1.5)]);
        write_ordered(&to, &from, &[0], &some, true).unwrap();
        assert_eq!(ply::read(&to).unwrap().color, some.color);
        let (names, found) = rows(&to);
        assert_eq!(names.len(), 10);
        assert_eq!(found[0][3..5], [16_777_217.0, 4_294_967_295.0]);
        let error = write_ordered(&to, &from, &[3], &some, false).unwrap_err().to_string();
        assert!(error.contains("vertex 3 is gone"), "{error}");
    }
}
