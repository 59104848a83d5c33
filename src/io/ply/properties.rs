//! Read further numbers of the vertices by their names.

use super::header::{self, PlyHeader, PropertyKind, quote};
use super::layout::{Layout, PropertyUse};
use super::values::{BodyValues, Event};
use super::{ask, groups, vertex};
use crate::error::{Error, Result};
use crate::io::{Reason, input};
use crate::scene::Property;
use std::path::Path;

/// Reads vertex properties that [`super::read`] skips, in the order of `names`. They may have any
/// type; each number is rounded to `f32` once. Meanwhile the whole file is in memory.
///
/// `Decided:` integers are kept as they are, like `radius` and unlike `opacity`, because only the
/// author of the file knows what 1 means. `Decided:` only named properties are read, because files
/// hold times, confidences and the like, which would make every copy of a file larger.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read. [`Error::Format`] as [`super::parse`], and if a name
/// belongs to no property, to a list, to a property that is read anyway, or occurs twice.
pub fn properties(path: &Path, names: &[String]) -> Result<Vec<Property>> {
    if names.is_empty() {
        return Ok(Vec::new());
    }
    read(&whole(path)?, names).map_err(|what| Error::format(path, what))
}

/// Checks that the header of a file has all properties that [`properties`] would read.
///
/// # Errors
/// As [`properties`].
pub(in crate::io) fn check_properties(path: &Path, names: &[String]) -> Result<()> {
    let places = header::parse(&whole(path)?).and_then(|header| places(&header, names));
    places.map(|_| ()).map_err(|what| Error::format(path, what))
}

/// Reads one number of each vertex, whatever else it is read for.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read. [`Error::Format`] as [`super::parse`], and if there is
/// no such property, or if it is a list.
pub(in crate::io) fn number(path: &Path, name: &str) -> Result<Property> {
    let one = |bytes: &[u8]| {
        let header = header::parse(bytes)?;
        let vertices = vertex(&header)?;
        let all = || vertices.properties.iter().filter(|p| matches!(p.kind, PropertyKind::One(_)));
        let Some(_) = all().find(|p| p.name == name) else {
            let all: Vec<&str> = all().map(|p| p.name.as_str()).collect();
            let (name, all) = (quote(name), all.join(", "));
            return Err(format!("element vertex has no number {name}; it has {all}"));
        };
        let places = vertices.properties.iter().map(|p| (p.name == name).then_some(0)).collect();
        values(bytes, &header, &[name.to_owned()], places)
    };
    let found = one(&whole(path)?).map_err(|what| Error::format(path, what))?;
    Ok(found.into_iter().next().unwrap_or_default())
}

fn whole(path: &Path) -> Result<Vec<u8>> {
    let io = |source| Error::io(path, source);
    let (file, length) = input::open(path).map_err(io)?;
    input::rest(file, length).map_err(io)
}

/// For each property of the vertices, its place among the names.
fn places(header: &PlyHeader, names: &[String]) -> Reason<Vec<Option<usize>>> {
    let vertices = vertex(header)?;
    let layout = Layout::new(vertices, &groups::Reader::new(vertices), None)?;
    let mut places = vec![None; vertices.properties.len()];
    for (place, name) in names.iter().enumerate() {
        let at = vertices.properties.iter().position(|property| property.name == *name);
        let at = at.ok_or_else(|| format!("element vertex has no property {}", quote(name)))?;
        let wrong = |what: &str| Err(format!("element vertex: property {} {what}", quote(name)));
        if matches!(vertices.properties[at].kind, PropertyKind::List { .. }) {
            return wrong("is a list, but must be one number");
        }
        if !matches!(layout.slots[at], PropertyUse::Skip) {
            return wrong("is read anyway; do not name it");
        }
        if places[at].replace(place).is_some() {
            return wrong("is named twice");
        }
    }
    Ok(places)
}

/// Reads the properties of these names from the bytes of a file.
pub(super) fn read(bytes: &[u8], names: &[String]) -> Reason<Vec<Property>> {
    let header = header::parse(bytes)?;
    let places = places(&header, names)?;
    values(bytes, &header, names, places)
}

/// Reads the properties for which `places` has the place among the names.
fn values(
    bytes: &[u8],
    header: &PlyHeader,
    names: &[String],
    places: Vec<Option<usize>>,
) -> Reason<Vec<Property>> {
    let vertices = vertex(header)?;
    let vertex_bytes = vertices.count.min(bytes.len() as u64) * names.len() as u64 * BYTES;
    ask(header, bytes.len() as u64, vertex_bytes)?;
    let mut values = BodyValues::new(bytes, header);
    let mut found: Vec<Vec<f32>> = vec![Vec::new(); names.len()];
    for element in &header.elements {
        let is_vertices = std::ptr::eq(element, vertices);
        values.walk(element, |event| {
            if let (true, Event::Value(property, value)) = (is_vertices, event)
                && let Some(place) = places[property]
            {
                found[place].push(value as f32);
            }
            Ok(())
        })?;
        // Later elements cannot change the vertices.
        if is_vertices {
            break;
        }
    }
    let all = names.iter().zip(found);
    Ok(all.map(|(name, values)| Property { name: name.clone(), values }).collect())
}

/// Bytes that a number takes while its array grows.
const BYTES: u64 = 8;

#[cfg(test)]
mod tests {
    use super::*;

    /// Two vertices behind another element.
    const FILE: &str = "ply\nformat ascii 1.0\nelement other 1\nproperty list uchar int some\n\
                        element vertex 2\nproperty float x\nproperty float y\nproperty uchar metallic\n\
                        property float z\nproperty double roughness\nproperty list uchar int more\n\
                        property float s\nend_header\n2 7 8\n1 2 200 3 0.1 1 9 4\n5 6 3 7 -0.5 0 nan\n";

    fn named(names: &[&str]) -> Reason<Vec<Property>> {
        read(FILE.as_bytes(), &names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn numbers_come_by_name_in_the_order_of_the_names() {
        let found = named(&["roughness", "s", "metallic"]).unwrap();
        let names: Vec<_> = found.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["roughness", "s", "metallic"]);
        assert_eq!(
            (&found[0].values[..], &found[2].values[..]),
            (&[0.1, -0.5][..], &[200.0, 3.0][..])
        );
        assert!(found[1].values[0] == 4.0 && found[1].values[1].is_nan());
        let none = super::super::parse(FILE.as_bytes()).unwrap();
        assert!(none.properties.is_empty(), "nothing is read that nobody named");
    }

    #[test]
    fn what_is_no_number_of_its_own_is_refused() {
        for (name, what) in [
            ("gloss", "element vertex has no property `gloss`"),
            ("more", "element vertex: property `more` is a list, but must be one number"),
            ("y", "element vertex: property `y` is read anyway; do not name it"),
        ] {
            assert_eq!(named(&["metallic", name]).unwrap_err(), what);
        }
        let twice = named(&["metallic", "metallic"]).unwrap_err();
        assert_eq!(twice, "element vertex: property `metallic` is named twice");
    }
}
