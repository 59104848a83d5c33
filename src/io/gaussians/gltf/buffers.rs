//! Find the bytes of a glTF document: in the GLB itself, in its text, or in files beside it.

use super::json::{Buffer, Document};
use crate::error::{Error, Result};
use crate::io::{Reason, input};
use base64::Engine;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use std::path::Path;

/// The text of a document, and the bytes of a GLB behind it.
pub(super) struct Container<'a> {
    pub(super) text: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
}

/// Splits a file into its text and its bytes. A file that does not begin as a GLB is all text.
pub(super) fn container(bytes: &[u8]) -> Reason<Container<'_>> {
    if !bytes.starts_with(b"glTF") {
        return Ok(Container { text: bytes, binary: None });
    }
    let word = |at: usize| {
        let four = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
        four.map(|four| u32::from_le_bytes(*four))
            .ok_or("the file ends in its header: it is truncated")
    };
    let (version, length) = (word(4)?, word(8)? as usize);
    if version != 2 {
        return Err(format!("a GLB of version {version}; only version 2 is read"));
    }
    if length != bytes.len() {
        return Err(format!(
            "the header of the GLB says {length} bytes, but the file has {}: it is truncated or \
             damaged",
            bytes.len()
        ));
    }
    let (mut text, mut binary) = (None, None);
    let mut at = 12;
    while at < length {
        let (size, kind) = (word(at)? as usize, word(at + 4)?);
        let chunk = bytes.get(at + 8..).and_then(|rest| rest.get(..size));
        let chunk = chunk.ok_or_else(|| {
            format!("byte {at}: a chunk of {size} bytes, but the file has fewer: it is truncated")
        })?;
        match kind {
            JSON if text.is_none() => text = Some(chunk),
            BINARY if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at += 8 + size;
    }
    let text = text.ok_or("the GLB has no chunk of JSON: it is damaged")?;
    Ok(Container { text, binary })
}

/// The kinds of chunks.
pub(super) const JSON: u32 = 0x4E4F_534A;
pub(super) const BINARY: u32 = 0x004E_4942;

/// The bytes of all buffers.
pub(super) struct Buffers<'a> {
    all: Vec<Bytes<'a>>,
}

enum Bytes<'a> {
    Here(&'a [u8]),
    Read(Vec<u8>),
}

impl<'a> Buffers<'a> {
    /// Reads the buffers of the document at `path`.
    pub(super) fn read(document: &Document, binary: Option<&'a [u8]>, path: &Path) -> Result<Self> {
        let buffers = document.buffers.iter().enumerate();
        let all = buffers.map(|(index, buffer)| one(index, buffer, binary, path));
        Ok(Self { all: all.collect::<Result<_>>()? })
    }

    /// How many bytes there are.
    pub(super) fn total(&self) -> u64 {
        self.all.iter().map(|bytes| bytes.get().len() as u64).sum()
    }

    /// The bytes of a view, and its stride.
    pub(super) fn view(&self, document: &Document, index: usize) -> Reason<(&[u8], Option<u64>)> {
        let view = document.buffer_views.get(index).ok_or_else(|| missing("buffer view", index))?;
        let buffer = self.all.get(view.buffer).ok_or_else(|| missing("buffer", view.buffer))?.get();
        let part = part(buffer, view.byte_offset, view.byte_length).ok_or_else(|| {
            format!(
                "buffer view {index} has {} bytes from {} on, but buffer {} has only {}",
                view.byte_length,
                view.byte_offset,
                view.buffer,
                buffer.len()
            )
        })?;
        Ok((part, view.byte_stride))
    }
}

impl Bytes<'_> {
    fn get(&self) -> &[u8] {
        match self {
            Self::Here(bytes) => bytes,
            Self::Read(bytes) => bytes,
        }
    }
}

/// The error for an index that nothing has.
pub(super) fn missing(what: &str, index: usize) -> String {
    format!("there is no {what} {index}, but the file refers to it: it is damaged")
}

/// `length` bytes from `offset` on, if there are so many.
pub(super) fn part(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let (offset, length) = (usize::try_from(offset).ok()?, usize::try_from(length).ok()?);
    bytes.get(offset..)?.get(..length)
}

/// Reads one buffer.
fn one<'a>(
    index: usize,
    buffer: &Buffer,
    binary: Option<&'a [u8]>,
    path: &Path,
) -> Result<Bytes<'a>> {
    let format = |what: String| Error::format(path, what);
    let short = |length: usize| {
        format(format!(
            "buffer {index} has {} bytes by the file, but only {length} are there: it is truncated",
            buffer.byte_length
        ))
    };
    let Some(uri) = &buffer.uri else {
        let here = binary.filter(|_| index == 0);
        let here = here.ok_or_else(|| {
            format(format!(
                "buffer {index} has no uri, and its bytes are not in the file; export it again"
            ))
        })?;
        return match part(here, 0, buffer.byte_length) {
            Some(bytes) => Ok(Bytes::Here(bytes)),
            None => Err(short(here.len())),
        };
    };
    let mut bytes = if let Some(data) = uri.strip_prefix("data:") {
        let encoded = data.split_once(";base64,").map(|(_, encoded)| encoded);
        let decoded = encoded.and_then(|encoded| LENIENT.decode(encoded).ok());
        decoded.ok_or_else(|| format(format!("the uri of buffer {index} is no data in base64")))?
    } else if uri.contains("://") {
        let what = format!("buffer {index} is at another place, {}; download it", shown(uri));
        return Err(format(what));
    } else {
        let beside = path.parent().unwrap_or(Path::new("")).join(decoded(uri));
        let io = |source| Error::io(&beside, source);
        let (file, length) = input::open(&beside).map_err(io)?;
        input::rest(file, length.min(buffer.byte_length)).map_err(io)?
    };
    let length = bytes.len();
    if (length as u64) < buffer.byte_length {
        return Err(short(length));
    }
    bytes.truncate(buffer.byte_length as usize);
    Ok(Bytes::Read(bytes))
}

/// Programs leave out the padding at the end.
const LENIENT: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The beginning of a text of the file, for an error.
fn shown(text: &str) -> String {
    text.chars().take(60).flat_map(char::escape_debug).collect()
}

/// A file name without the percent signs of a URI.
fn decoded(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut name = Vec::new();
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let code = bytes.get(at + 1..at + 3).and_then(|code| std::str::from_utf8(code).ok());
        let code = code.and_then(|code| u8::from_str_radix(code, 16).ok());
        match code.filter(|_| byte == b'%') {
            Some(code) => {
                name.push(code);
                at += 3;
            }
            None => {
                name.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&name).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_decoded() {
        assert_eq!(decoded("a%20b%2Fc.bin"), "a b/c.bin");
        assert_eq!(decoded("50%.bin"), "50%.bin");
        assert_eq!(decoded("%c3%a4%"), "ä%");
    }
}
