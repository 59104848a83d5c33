//! Place one object for each row of a table, from CSV or PLY.
//!
//! | columns | default | meaning |
//! |---|---|---|
//! | `x y z` | required | translation, world units |
//! | `scale` | 1 | finite and > 0 |
//! | `axis_x axis_y axis_z degrees` | no rotation; give all or none | the rotation, see [`transform::rotation`] |
//! | `r g b` | the object's colour; give all or none | linear RGB for the whole object |
//!
//! A CSV file is text. The first line has the names of the columns, in any order. Each further line
//! is a row of numbers between commas. Blanks around names and numbers are skipped, and so are
//! empty lines; there are no quotes. Numbers are read as f64.
//!
//! A PLY file has the columns as properties of its element `vertex`, each a number. Other
//! properties and other elements are skipped.

use crate::error::{Error, Result};
use crate::io::{Reason, extension, input, ply};
use crate::memory;
use crate::scene::light::{MAX_RADIANCE, is_color};
use crate::scene::{Similarity, transform};
use glam::{DMat3, DVec3, Vec3};
use std::path::Path;

/// The columns.
const NAMES: [&str; 11] =
    ["x", "y", "z", "scale", "axis_x", "axis_y", "axis_z", "degrees", "r", "g", "b"];

/// A row of a table: an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) place: Similarity,
    pub(super) color: Option<Vec3>,
}

/// Reads a table of places.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read. [`Error::Format`], with the line or the vertex, if
/// columns are missing, given twice or, in CSV, unknown, if there are no rows, or if a row is no
/// valid place.
pub(super) fn read(path: &Path) -> Result<Vec<Row>> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    let rows = match extension(path).as_deref() {
        Some("csv") => csv(&bytes),
        Some("ply") => of_ply(&bytes),
        _ => Err("a table of places must be a .csv or a .ply".into()),
    };
    rows.map_err(|what| Error::format(path, what))
}

fn of_ply(bytes: &[u8]) -> Reason<Vec<Row>> {
    let (names, rows) = ply::numbers(bytes)?;
    let columns = Columns::new(names.iter().map(String::as_str))?;
    let mut all = room(rows.len() / names.len())?;
    let row =
        |(i, row): (usize, &[f64])| columns.row(row).map_err(|what| format!("vertex {i}: {what}"));
    for row in rows.chunks_exact(names.len()).enumerate().map(row) {
        all.push(row?);
    }
    Ok(all)
}

/// Makes room for the rows of a table, before they are read.
fn room(rows: usize) -> Reason<Vec<Row>> {
    memory::try_ask((rows as u64).saturating_mul(size_of::<Row>() as u64), || {
        format!("a table of {rows} rows")
    })?;
    Ok(Vec::with_capacity(rows))
}

fn csv(bytes: &[u8]) -> Reason<Vec<Row>> {
    let text = std::str::from_utf8(bytes).map_err(|_| "not text; CSV is UTF-8")?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    let (_, header) = lines.next().ok_or("no header; give the columns, such as x,y,z")?;
    let names: Vec<_> = header.split(',').map(str::trim).collect();
    if let Some(name) = names.iter().find(|name| !NAMES.contains(name)) {
        let known = NAMES.join(", ");
        return Err(format!("line 1: unknown column `{name}`; the columns are {known}"));
    }
    let columns = Columns::new(names.iter().copied()).map_err(|what| format!("line 1: {what}"))?;
    let mut rows = room(text.lines().count())?;
    let mut values = Vec::new();
    let read = lines.map(|(number, line): (usize, _)| {
        let row = numbers(line, &names, &mut values).and_then(|()| columns.row(&values));
        row.map_err(|what| format!("line {number}: {what}"))
    });
    for row in read {
        rows.push(row?);
    }
    if rows.is_empty() { Err("no rows below the header; add one".into()) } else { Ok(rows) }
}

/// Parses the numbers of a line.
fn numbers(line: &str, names: &[&str], values: &mut Vec<f64>) -> Reason<()> {
    values.clear();
    for (i, word) in line.split(',').map(str::trim).enumerate() {
        let name = names.get(i).unwrap_or(&"one value too many");
        let value = word.parse().map_err(|_| format!("{name}: `{word}` is not a number"))?;
        values.push(value);
    }
    if values.len() == names.len() {
        return Ok(());
    }
    Err(format!("{} values for {} columns", values.len(), names.len()))
}

/// The column of each of [`NAMES`].
struct Columns([Option<usize>; NAMES.len()]);

impl Columns {
    fn new<'n>(names: impl Iterator<Item = &'n str>) -> Reason<Self> {
        let mut found = [None; NAMES.len()];
        for (column, name) in names.enumerate() {
            let Some(known) = NAMES.iter().position(|known| *known == name) else { continue };
            if found[known].replace(column).is_some() {
                return Err(format!("two columns are called {name}; rename one"));
            }
        }
        for (group, needed) in [(0..3, true), (4..8, false), (8..11, false)] {
            let missing = group.clone().find(|i| found[*i].is_none());
            let given = group.clone().find(|i| found[*i].is_some());
            let (Some(missing), true) = (missing, needed || given.is_some()) else { continue };
            let all = NAMES[group].join(", ");
            return Err(format!("no column {}; give {all}", NAMES[missing]));
        }
        Ok(Self(found))
    }

    fn row(&self, values: &[f64]) -> Reason<Row> {
        let get = |i: usize| self.0[i].map(|column| values[column]);
        let three = |first: usize| Some([get(first)?, get(first + 1)?, get(first + 2)?]);
        let rotation = match (three(4), get(7)) {
            (Some(axis), Some(degrees)) => {
                let axis = DVec3::from_array(axis);
                if !(transform::is_axis(axis) && degrees.is_finite()) {
                    return Err("the axis must be finite and not 0".into());
                }
                transform::rotation(axis, degrees)
            }
            _ => DMat3::IDENTITY,
        };
        let place = Similarity {
            rotation,
            scale: get(3).unwrap_or(1.0),
            translation: three(0).unwrap_or_default().into(),
        };
        place.check().map_err(|error| error.to_string())?;
        let color = three(8).map(|color| Vec3::from_array(color.map(|part| part as f32)));
        if !color.is_none_or(is_color) {
            return Err(format!("r, g and b must be in [0, {MAX_RADIANCE}]"));
        }
        Ok(Row { place, color })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        csv(text.as_bytes()).unwrap_err()
    }

    #[test]
    fn columns_may_be_in_any_order_or_absent() {
        let rows = csv(b"z, x,y\r\n3,1,2\r\n\r\n0.5,-1e2,0").unwrap();
        let at = |x, y, z| Row {
            place: Similarity { translation: DVec3::new(x, y, z), ..Similarity::IDENTITY },
            color: None,
        };
        assert_eq!(rows, [at(1.0, 2.0, 3.0), at(-100.0, 0.0, 0.5)]);
        let all = "x,y,z,scale,axis_x,axis_y,axis_z,degrees,r,g,b\n1,2,3,4,0,0,2,90,0.5,0.25,0\n";
        let rows = csv(all.as_bytes()).unwrap();
        let rotation = transform::rotation(DVec3::Z * 2.0, 90.0);
        let place = Similarity { rotation, scale: 4.0, translation: DVec3::new(1.0, 2.0, 3.0) };
        assert_eq!(rows, [Row { place, color: Some(Vec3::new(0.5, 0.25, 0.0)) }]);
    }

    #[test]
    fn a_ply_has_the_columns_as_properties() {
        let header = "ply\nformat ascii 1.0\nelement other 1\nproperty int n\n\
                      element vertex 2\nproperty double y\nproperty float w\nproperty float x\n\
                      property float z\nproperty double scale\nend_header\n";
        let rows = of_ply(format!("{header}7\n0.1 9 1 2 0.5\n0 9 1 2 3\n").as_bytes()).unwrap();
        assert_eq!(rows[0].place.translation, DVec3::new(1.0, 0.1, 2.0), "f64 as it is");
        assert_eq!([rows[0].place.scale, rows[1].place.scale], [0.5, 3.0]);
        let bad = of_ply(format!("{header}7\n0.1 9 1 2 0.5\nnan 9 1 2 3\n").as_bytes());
        assert!(bad.unwrap_err().starts_with("vertex 1: transform"));
        let list = "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar float x\n\
                    end_header\n1 1\n";
        assert!(of_ply(list.as_bytes()).unwrap_err().contains("list"));
    }

    #[test]
    fn tables_that_are_none_are_refused() {
        for (text, what) in [
            ("", "no header"),
            ("x,y,z\n", "no rows"),
            ("x,y\n1,2\n", "line 1: no column z; give x, y, z"),
            ("x,y,z,w\n", "line 1: unknown column `w`; the columns are x, y, z, scale"),
            ("x,y,z,x\n", "line 1: two columns are called x"),
            ("x,y,z,axis_x\n", "no column axis_y; give axis_x, axis_y, axis_z, degrees"),
            ("x,y,z,r,b\n", "no column g"),
            ("x,y,z\n1,2,3\n\n1,two,3\n", "line 4: y: `two` is not a number"),
            ("x,y,z\n1,2\n", "line 2: 2 values for 3 columns"),
            ("x,y,z\n1,2,3,4\n", "line 2: 4 values for 3 columns"),
            ("x,y,z\n1,nan,3\n", "line 2: transform: the translation must be finite"),
            ("x,y,z,scale\n1,2,3,0\n", "line 2: transform: the scale"),
            ("x,y,z,axis_x,axis_y,axis_z,degrees\n1,2,3,0,0,0,4\n", "line 2: the axis"),
            ("x,y,z,r,g,b\n1,2,3,0,0,-1\n", "line 2: r, g and b"),
        ] {
            let found = refused(text);
            assert!(found.contains(what), "{text}: {found}");
        }
        assert!(csv(&[0xFF, 0xFE]).is_err());
    }
}
