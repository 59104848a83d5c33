//! Read vertices as rows of numbers, whatever the names of their properties.

use super::header::{self, PropertyKind, quote};
use super::values::{BodyValues, Event};
use super::vertex;
use crate::io::Reason;
use crate::memory;

/// The names of the vertex properties, and the numbers of all vertices, row by row.
///
/// # Errors
/// As [`super::parse`]; also if a property is a list.
pub(in crate::io) fn numbers(bytes: &[u8]) -> Reason<(Vec<String>, Vec<f64>)> {
    let header = header::parse(bytes)?;
    let vertex = vertex(&header)?;
    if let Some(list) =
        vertex.properties.iter().find(|p| matches!(p.kind, PropertyKind::List { .. }))
    {
        return Err(format!("element vertex: property {} is a list", quote(&list.name)));
    }
    // Each number takes at least one byte of the file.
    memory::try_ask(8 * bytes.len() as u64, || format!("{} rows", vertex.count))?;
    let mut rows = Vec::new();
    let mut values = BodyValues::new(bytes, &header);
    for element in &header.elements {
        let keep = element.name == vertex.name;
        values.walk(element, |event| {
            if let (Event::Value(_, value), true) = (event, keep) {
                rows.push(value);
            }
            Ok(())
        })?;
    }
    values.finish()?;
    Ok((vertex.properties.iter().map(|property| property.name.clone()).collect(), rows))
}
