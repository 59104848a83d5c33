//! Read raw files: little-endian numbers at fixed distances.

use super::format::Format;
use super::numbers::{Numbers, ask};
use super::parse::PlaneKeys;
use crate::error::{Error, Result};
use crate::io::{Reason, input};
use std::io::{Seek, SeekFrom};
use std::path::Path;

/// Where the numbers of a plane lie in a file.
#[derive(Clone, Copy, Debug)]
struct Layout {
    size: [u32; 2],
    components: usize,
    format: Format,
    offset: u64,
    row: u64,
    pixel: u64,
    /// Whether the file must hold nothing else.
    alone: bool,
}

/// Reads a plane of this size; `name` is its name in the TOML file.
pub(super) fn read(
    path: &Path,
    name: &str,
    keys: &PlaneKeys,
    format: Format,
    components: usize,
    size: [u32; 2],
) -> Result<Numbers> {
    let refused = |what: String| Error::format(path, format!("planes.{name}: {what}"));
    let layout = Layout::new(keys, format, components, size).map_err(refused)?;
    let (mut file, length) = input::open(path).map_err(|source| Error::io(path, source))?;
    let span = layout.span(length).map_err(refused)?;
    ask(size, components).map_err(refused)?;
    file.seek(SeekFrom::Start(layout.offset)).map_err(|source| Error::io(path, source))?;
    let bytes = input::rest(file, span).map_err(|source| Error::io(path, source))?;
    if bytes.len() as u64 != span {
        return Err(Error::format(path, "the file became shorter while it was read"));
    }
    let components = (0..components).map(|component| layout.component(&bytes, component));
    Ok(Numbers { size, components: components.collect(), file: format })
}

/// How many bytes the numbers of one pixel take.
fn pixel_bytes(format: Format, components: usize) -> u64 {
    if format.is_packed() { format.bytes() } else { format.bytes() * components as u64 }
}

impl Layout {
    fn new(keys: &PlaneKeys, format: Format, components: usize, size: [u32; 2]) -> Reason<Self> {
        if format.is_packed() && components != 3 {
            let word = format.word();
            let holds = if components == 1 { "one" } else { "two" };
            return Err(format!("{word} has three numbers a pixel, but the plane holds {holds}"));
        }
        let least = pixel_bytes(format, components);
        let pixel = keys.pixel_stride.unwrap_or(least);
        if pixel < least {
            return Err(format!("pixel_stride is {pixel}, but a pixel has {least} bytes"));
        }
        let least = pixel.saturating_mul(u64::from(size[0]) - 1).saturating_add(least);
        let row = keys.row_stride.unwrap_or(pixel.saturating_mul(size[0].into()));
        if row < least {
            return Err(format!("row_stride is {row}, but a row has {least} bytes"));
        }
        let places = [keys.offset, keys.row_stride, keys.pixel_stride];
        let alone = places.iter().all(Option::is_none);
        let offset = keys.offset.unwrap_or(0);
        Ok(Self { size, components, format, offset, row, pixel, alone })
    }

    /// How many bytes lie between the first number and the end of the last; an error if the file's
    /// length does not fit.
    fn span(&self, length: u64) -> Reason<u64> {
        let Self { size: [width, height], components, format, offset, .. } = *self;
        let pixel = pixel_bytes(format, components);
        let down = self.row.saturating_mul(u64::from(height) - 1);
        let across = self.pixel.saturating_mul(u64::from(width) - 1);
        let span = down.saturating_add(across).saturating_add(pixel);
        let needed = offset.saturating_add(span);
        if needed <= length && (needed == length || !self.alone) {
            return Ok(span);
        }
        let each = if components == 1 { String::new() } else { format!("{components} ") };
        let exactly = if self.alone { "" } else { "at least " };
        Err(format!(
            "{width} x {height} pixels of {each}{} need {exactly}{needed} bytes, but the file has \
             {length}; give `size`, `format`, `offset` and strides as it was written",
            format.word()
        ))
    }

    /// One component of every pixel; the caller has checked that all bytes are there.
    fn component(&self, bytes: &[u8], component: usize) -> Vec<f64> {
        let step = self.format.bytes() as usize;
        let [width, height] = self.size.map(u64::from);
        let first = if self.format.is_packed() { 0 } else { component * step };
        let at = |x: u64, y: u64| (y * self.row + x * self.pixel) as usize + first;
        let number = |start: usize| {
            let mut word = [0; 4];
            let number = bytes.get(start..start + step).unwrap_or_default();
            word.iter_mut().zip(number).for_each(|(to, byte)| *to = *byte);
            self.format.number(u32::from_le_bytes(word), component)
        };
        (0..height).flat_map(|y| (0..width).map(move |x| number(at(x, y)))).collect()
    }
}
