//! Numbers of planes as files have them.

use super::format::Format;
use crate::io::Reason;
use crate::memory;

/// The numbers of a plane in the file's order of rows.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    pub(super) size: [u32; 2],
    /// One component, or two or three.
    pub(super) components: Vec<Vec<f64>>,
    /// How the file stores them.
    pub(super) file: Format,
}

impl Numbers {
    /// Turns a PNG's colours back into whole codes, for indices and counts.
    pub(super) fn as_codes(&mut self) {
        if let (true, Some(codes)) = (self.file.is_unorm(), self.file.codes()) {
            let values = self.components.iter_mut().flatten();
            values.for_each(|value| *value = (*value * codes).round());
            self.file = if self.file == Format::Unorm8 { Format::U8 } else { Format::U16 };
        }
    }

    /// Reverses the order of rows.
    pub(super) fn flip(&mut self) {
        let width = self.size[0] as usize;
        for component in &mut self.components {
            *component = component.chunks(width).rev().flatten().copied().collect();
        }
    }
}

/// Checks that the process may hold a plane of this size in `f64` twice: as stored, and converted.
pub(super) fn ask([width, height]: [u32; 2], components: usize) -> Reason<()> {
    let pixels = u64::from(width) * u64::from(height);
    memory::try_ask(pixels.saturating_mul(16 * components as u64), || {
        format!("a plane of {width} x {height} pixels")
    })
}
