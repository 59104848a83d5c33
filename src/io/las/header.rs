//! Read the header of a LAS file, and find the record of its compression.

use crate::io::Reason;
use std::ops::Range;

/// What the header says about the points.
pub(super) struct Header {
    pub(super) count: u64,
    /// The point format, 0 to 10.
    pub(super) format: u8,
    /// Bytes of a record.
    pub(super) stride: usize,
    /// The first byte of the points.
    pub(super) start: usize,
    pub(super) is_compressed: bool,
    pub(super) scale: [f64; 3],
    pub(super) offset: [f64; 3],
    /// The bytes of the records of variable length.
    #[cfg_attr(not(feature = "cli"), expect(dead_code, reason = "only LAZ is described there"))]
    variable: Range<usize>,
}

/// The bytes of a record of each point format, without extra bytes.
const STRIDES: [usize; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];

impl Header {
    pub(super) fn parse(bytes: &[u8]) -> Reason<Self> {
        if !bytes.starts_with(b"LASF") {
            return Err("byte 0: not a LAS file, which begins with LASF".into());
        }
        let version: [u8; 2] = get(bytes, 24)?;
        let [major, minor] = version;
        if major != 1 || minor > 4 {
            let what =
                format!("byte 24: version {major}.{minor}; give a file of version 1.0 to 1.4");
            return Err(what);
        }
        let size = usize::from(u16::from_le_bytes(get(bytes, 94)?));
        let start = u32::from_le_bytes(get(bytes, 96)?) as usize;
        let [kind] = get(bytes, 104)?;
        let (format, is_compressed) = (kind & 0x3f, kind & 0xc0 != 0);
        let stride = usize::from(u16::from_le_bytes(get(bytes, 105)?));
        let Some(&least) = STRIDES.get(usize::from(format)) else {
            return Err(format!("byte 104: point format {format}; formats 0 to 10 are read"));
        };
        if stride < least {
            return Err(format!(
                "byte 105: records of {stride} bytes, but point format {format} has {least}; write \
                 the file again"
            ));
        }
        let number = |at| get(bytes, at).map(f64::from_le_bytes);
        let three = |at: usize| Ok::<_, String>([number(at)?, number(at + 8)?, number(at + 16)?]);
        let (scale, offset) = (three(131)?, three(155)?);
        if scale.iter().any(|scale| *scale == 0.0 || !scale.is_finite())
            || offset.iter().any(|offset| !offset.is_finite())
        {
            return Err(format!(
                "byte 131: scales {scale:?} and offsets {offset:?} of the coordinates; scales must \
                 be finite and not 0"
            ));
        }
        if start < size || start > bytes.len() {
            let (length, first) = (bytes.len(), size);
            return Err(format!(
                "byte 96: points from byte {start} on, but the header ends at {first} and the file \
                 at {length}: the file is truncated or damaged"
            ));
        }
        let mut count = u64::from(u32::from_le_bytes(get(bytes, 107)?));
        // The long count of version 1.4 replaces the old one, unless a program left it empty.
        if minor == 4 && size >= 255 {
            let long = u64::from_le_bytes(get(bytes, 247)?);
            count = if long > 0 { long } else { count };
        }
        if count == 0 {
            return Err("byte 107: the file has 0 points".into());
        }
        let variable = size..start;
        Ok(Self { count, format, stride, start, is_compressed, scale, offset, variable })
    }

    /// The records of a file that is not compressed.
    pub(super) fn records<'b>(&self, bytes: &'b [u8]) -> Reason<&'b [u8]> {
        let Self { count, stride, start, .. } = *self;
        let there = &bytes[start..];
        let most = (there.len() / stride) as u64;
        if count > most {
            return Err(format!(
                "the header declares {count} points of {stride} bytes, but the {} bytes from \
                 {start} on hold at most {most}: the file is truncated or the count is wrong",
                there.len()
            ));
        }
        Ok(&there[..count as usize * stride])
    }

    /// How many extra bytes a record has.
    #[cfg(feature = "cli")]
    pub(super) fn extra(&self) -> u16 {
        (self.stride - STRIDES[usize::from(self.format)]) as u16
    }

    /// Where the colours of a record are, if its format has colours.
    pub(super) fn color(&self) -> Option<usize> {
        match self.format {
            2 => Some(20),
            3 | 5 => Some(28),
            7 | 8 | 10 => Some(30),
            _ => None,
        }
    }

    /// Where the classification of a record is, and the bits of it.
    pub(super) fn classification(&self) -> (usize, u8) {
        if self.format < 6 { (15, 0x1f) } else { (16, 0xff) }
    }

    /// The data of the record of variable length that describes the compression.
    #[cfg(feature = "cli")]
    pub(super) fn compression<'b>(&self, bytes: &'b [u8]) -> Reason<&'b [u8]> {
        const USER: &[u8] = b"laszip encoded\0\0";
        const RECORD: u16 = 22204;
        const HEADER: usize = 54;
        let mut rest = &bytes[self.variable.clone()];
        while rest.len() >= HEADER {
            let length = usize::from(u16::from_le_bytes(get(rest, 20)?));
            let data = &rest[HEADER..];
            let Some(data) = data.get(..length) else { break };
            if &rest[2..18] == USER && u16::from_le_bytes(get(rest, 18)?) == RECORD {
                return Ok(data);
            }
            rest = &rest[HEADER + length..];
        }
        Err("the points are compressed, but no record says how: the file is damaged".into())
    }
}

/// The bytes at a place of the header.
fn get<const N: usize>(bytes: &[u8], at: usize) -> Reason<[u8; N]> {
    let found = bytes.get(at..).and_then(|rest| rest.first_chunk().copied());
    found.ok_or_else(|| format!("byte {at}: the file ends within its header: it is truncated"))
}
