//! Numbers of planes as files have them.

use super::format::Format;
use crate::io::Reason;
use crate::memory;

/// The numbers of a plane as a file has them, row by row as they lie there.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    pub(super) size: [u32; 2],
    /// One, or three.
    pub(super) components: Vec<Vec<f64>>,
    /// How the file stores them.
    pub(super) file: Format,
}

impl Numbers {
    /// What a PNG has as the codes of colours, as whole numbers.
    pub(super) fn as_codes(&mut self) {
        if let (true, Some(codes)) = (self.file.is_unorm(), self.file.codes()) {
            let values = self.components.iter_mut().flatten();
            values.for_each(|value| *value = (*value * codes).round());
            self.file = if self.file == Format::Unorm8 { Format::U8 } else { Format::U16 };
        }
    }

    /// The other row first.
    pub(super) fn flip(&mut self) {
        let width = self.size[0] as usize;
        for component in &mut self.components {
            *component = component.chunks(width).rev().flatten().copied().collect();
        }
    }
}

/// Whether there may be planes of so many numbers in `f64`, as a file has them and as they mean it.
pub(super) fn ask([width, height]: [u32; 2], components: usize) -> Reason<()> {
    let pixels = u64::from(width) * u64::from(height);
    memory::try_ask(pixels.saturating_mul(16 * components as u64), || {
        format!("a plane of {width} x {height} pixels")
    })
}
