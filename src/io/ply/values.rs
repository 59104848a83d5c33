//! Read the body of a PLY file: one number after another, in any of the three formats.

use super::header::{Element, Format, PlyHeader, PropertyKind, Scalar, quote};

/// A position in the body. Errors say what is wrong; [`BodyValues::walk`] adds where.
#[derive(Clone, Debug)]
pub(super) struct BodyValues<'a> {
    bytes: &'a [u8],
    /// How many bytes of the file come before these.
    before: u64,
    format: Format,
    /// The next byte to be read.
    at: usize,
    /// The first byte of the last value.
    last: usize,
    /// The line of the last value, counted from 1; used for ascii only.
    line: u64,
}

/// An event of a walk through an element, in the order of the file.
pub(super) enum Event {
    /// A number of the property with this index: its only number, or the next one in its list.
    Value(usize, f64),
    /// The end of a row: one vertex, one face, ...
    End,
}

impl<'a> BodyValues<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &PlyHeader) -> Self {
        let PlyHeader { format, body, line, .. } = *header;
        Self { bytes, before: 0, format, at: body, last: body, line }
    }

    /// The rest of a binary body, after `before` bytes of the file.
    pub(super) fn rest(bytes: &'a [u8], before: u64, format: Format) -> Self {
        Self { bytes, before, format, at: 0, last: 0, line: 0 }
    }

    pub(super) fn format(&self) -> Format {
        self.format
    }

    /// The bytes of a whole element in a binary body, with `stride` bytes a row.
    pub(super) fn rows(&mut self, element: &Element, stride: usize) -> Result<&'a [u8], String> {
        self.check_room(element)?;
        let (rows, _) = self.bytes[self.at..].split_at(element.count as usize * stride);
        self.at += rows.len();
        Ok(rows)
    }

    /// Reads a whole element and passes each number to `visit`. An error of `visit` gets the same
    /// description of its place as a read error.
    ///
    /// Every number fits `f64` exactly; a number of type float also fits `f32`. Before the walk
    /// reads anything, it compares the count with the bytes that are left, so that `visit` may
    /// trust the count.
    pub(super) fn walk(
        &mut self,
        element: &Element,
        mut visit: impl FnMut(Event) -> Result<(), String>,
    ) -> Result<(), String> {
        if element.properties.is_empty() {
            return Ok(()); // nothing is stored, however many there are
        }
        self.check_room(element)?;
        let name = element.name.escape_debug();
        for row in 0..element.count {
            for (index, property) in element.properties.iter().enumerate() {
                self.property(property.kind, |value| visit(Event::Value(index, value))).map_err(
                    |what| {
                        let (place, property) = (self.place(), quote(&property.name));
                        format!("{name} {row} ({place}), property {property}: {what}")
                    },
                )?;
            }
            self.end_row()
                .and_then(|()| visit(Event::End))
                .map_err(|what| format!("{name} {row} ({}): {what}", self.place()))?;
        }
        Ok(())
    }

    /// Reads one property of one row.
    #[inline]
    fn property(
        &mut self,
        kind: PropertyKind,
        mut visit: impl FnMut(f64) -> Result<(), String>,
    ) -> Result<(), String> {
        match kind {
            PropertyKind::One(scalar) => visit(self.next(scalar)?),
            PropertyKind::List { count, item } => {
                let count = self.next(count)?;
                if count < 0.0 {
                    return Err(format!("a list of {count} values; a count is at least 0"));
                }
                // Every count type is an integer of at most 32 bits.
                let count = count as u64;
                if count > self.room(self.bytes_of(item)) {
                    let left = self.bytes.len() - self.at;
                    return Err(format!(
                        "a list of {count} values, but only {left} bytes are left: the file is \
                         truncated or the count is wrong"
                    ));
                }
                for _ in 0..count {
                    visit(self.next(item)?)?;
                }
                Ok(())
            }
        }
    }

    /// Refuses a count that the rest of the file cannot hold.
    fn check_room(&self, element: &Element) -> Result<(), String> {
        let smallest = element.properties.iter().map(|property| match property.kind {
            PropertyKind::One(scalar) | PropertyKind::List { count: scalar, .. } => {
                self.bytes_of(scalar)
            }
        });
        let most = self.room(smallest.sum());
        if element.count <= most {
            return Ok(());
        }
        Err(format!(
            "element {}: the header declares {}, but the {} bytes from {} on hold at most {most}: \
             the file is truncated or the count is wrong",
            quote(&element.name),
            element.count,
            self.bytes.len() - self.at,
            self.next_place()
        ))
    }

    /// The least bytes that a value takes; in ascii a space and a digit.
    fn bytes_of(&self, scalar: Scalar) -> u64 {
        if self.format == Format::Ascii { 2 } else { scalar.size() }
    }

    /// How many things of `size` bytes > 0 fit at most into the rest of the file.
    fn room(&self, size: u64) -> u64 {
        // The first value of an ascii body needs no space before it.
        let spare = if self.format == Format::Ascii { 1 } else { 0 };
        ((self.bytes.len() - self.at) as u64 + spare) / size
    }

    /// The next number.
    #[inline]
    fn next(&mut self, scalar: Scalar) -> Result<f64, String> {
        if self.format == Format::Ascii {
            return self.next_word(scalar);
        }
        self.last = self.at;
        Ok(match scalar {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.take()?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.take()?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.take()?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// The next bytes of a binary body, in little-endian order.
    #[inline]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let Some(&found) = self.bytes[self.at..].first_chunk::<N>() else {
            return Err(ENDS.into());
        };
        self.at += N;
        let mut found = found;
        if self.format == Format::Big {
            found.reverse();
        }
        Ok(found)
    }

    /// The next number of an ascii body.
    fn next_word(&mut self, scalar: Scalar) -> Result<f64, String> {
        self.skip_space();
        self.last = self.at;
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        if length == 0 {
            return Err(ENDS.into());
        }
        if length == rest.len() {
            return Err(CUT.into());
        }
        self.at += length;
        let word = &rest[..length];
        let number = std::str::from_utf8(word).ok().and_then(|word| parse(word, scalar));
        number.ok_or_else(|| {
            let word = quote(&String::from_utf8_lossy(word));
            format!("{word} is not a number of type {}", scalar.name())
        })
    }

    /// Skips white space before the next ascii word, and counts lines.
    fn skip_space(&mut self) {
        while let Some(byte) = self.bytes.get(self.at).filter(|byte| byte.is_ascii_whitespace()) {
            self.line += u64::from(*byte == b'\n');
            self.at += 1;
        }
    }

    /// Checks that an ascii line ends after the last property of a row.
    ///
    /// `Decided:` a row may span several lines, as in some old files, but two rows never share a
    /// line. This finds the line where the values stop to match the header.
    fn end_row(&self) -> Result<(), String> {
        if self.format != Format::Ascii {
            return Ok(());
        }
        let rest = &self.bytes[self.at..];
        match rest.iter().find(|&&byte| byte == b'\n' || !byte.is_ascii_whitespace()) {
            None | Some(b'\n') => Ok(()),
            Some(_) => Err("the line goes on after the last property; remove the excess values \
                            or declare their property"
                .into()),
        }
    }

    /// Checks that nothing is left after the last element.
    pub(super) fn finish(mut self) -> Result<(), String> {
        if self.format == Format::Ascii {
            self.skip_space();
        }
        let left = self.bytes.len() - self.at;
        if left == 0 {
            return Ok(());
        }
        Err(format!(
            "{}: {left} bytes are left over after the last element: a count in the header is too \
             small, or a property is not declared",
            self.next_place()
        ))
    }

    /// The place of the last value.
    fn place(&self) -> String {
        match self.format {
            Format::Ascii => format!("line {}", self.line),
            Format::Little | Format::Big => format!("byte {}", self.before + self.last as u64),
        }
    }

    /// The place of the next value.
    fn next_place(&self) -> String {
        match self.format {
            Format::Ascii => format!("line {}", self.line),
            Format::Little | Format::Big => format!("byte {}", self.before + self.at as u64),
        }
    }
}

/// A cut number is still a number: 6.125 becomes 6.1.
const CUT: &str = "the file ends inside its last line, so its last number may be cut; if it is \
                   whole, end the line";
const ENDS: &str = "the file ends here: it is truncated, or a count in the header is too large";

/// Parses a word as a number of the given type: an integer must be in range, a float is rounded
/// once to its own type.
fn parse(word: &str, scalar: Scalar) -> Option<f64> {
    let (low, high) = match scalar {
        Scalar::F32 => return word.parse::<f32>().ok().map(f64::from),
        Scalar::F64 => return word.parse().ok(),
        Scalar::I8 => (i64::from(i8::MIN), i64::from(i8::MAX)),
        Scalar::U8 => (0, i64::from(u8::MAX)),
        Scalar::I16 => (i64::from(i16::MIN), i64::from(i16::MAX)),
        Scalar::U16 => (0, i64::from(u16::MAX)),
        Scalar::I32 => (i64::from(i32::MIN), i64::from(i32::MAX)),
        Scalar::U32 => (0, i64::from(u32::MAX)),
    };
    let number: i64 = word.parse().ok()?;
    (low..=high).contains(&number).then_some(number as f64)
}
