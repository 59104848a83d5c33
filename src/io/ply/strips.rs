//! Read the element `tristrips`: triangle strips, taken apart into triangles.

use super::faces::{corner, indices};
use super::header::{Element, PropertyKind, Scalar};
use super::values::{BodyValues, Event};

/// The names of the element.
pub(super) const NAMES: [&str; 2] = ["tristrips", "tristrip"];

/// Reads all strips and appends their triangles. Each index must be below `vertices`, except the
/// one that ends a strip.
pub(super) fn read(
    element: &Element,
    values: &mut BodyValues<'_>,
    vertices: u64,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), String> {
    if element.count == 0 {
        return Ok(());
    }
    let indices = indices(element)?;
    let end = end(element.properties[indices].kind);
    let mut strip = Strip::default();
    values.walk(element, |event| {
        match event {
            Event::Value(property, value) if property == indices => {
                // A vertex may have the number that ends strips of an unsigned type.
                if value == end && !(value >= 0.0 && value < vertices as f64) {
                    strip = Strip::default();
                } else {
                    triangles.extend(strip.push(corner(value, vertices)?));
                }
            }
            Event::Value(..) => {}
            Event::End => strip = Strip::default(),
        }
        Ok(())
    })
}

/// The index that ends a strip: -1, which unsigned types store as their greatest number.
fn end(kind: PropertyKind) -> f64 {
    match kind {
        PropertyKind::List { item: Scalar::U8, .. } => u8::MAX.into(),
        PropertyKind::List { item: Scalar::U16, .. } => u16::MAX.into(),
        PropertyKind::List { item: Scalar::U32, .. } => u32::MAX.into(),
        PropertyKind::List { .. } | PropertyKind::One(_) => -1.0,
    }
}

/// The vertices of a strip so far.
#[derive(Default)]
struct Strip {
    count: u64,
    /// The last two vertices.
    last: [u32; 2],
}

impl Strip {
    /// Adds a vertex; returns the triangle that it completes, unless two of its corners are one
    /// vertex. Programs join strips by such triangles.
    fn push(&mut self, vertex: u32) -> Option<[u32; 3]> {
        let [a, b] = self.last;
        // Every other triangle runs the other way round; turn it, so that all have one front.
        let corners = if self.count.is_multiple_of(2) { [a, b, vertex] } else { [b, a, vertex] };
        let complete = self.count >= 2 && a != b && a != vertex && b != vertex;
        (self.count, self.last) = (self.count + 1, [b, vertex]);
        complete.then_some(corners)
    }
}
