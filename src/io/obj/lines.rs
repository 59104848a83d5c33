//! Split OBJ and MTL files into lines, words and names.
//!
//! - A line ends in LF, in CR, in both (CR LF), or with the file.
//! - A backslash before the end of a line joins the next line to it, with one blank between them.
//!   Blanks may follow the backslash. `Decided:` a backslash within a comment joins nothing, because
//!   comments contain folders of Windows and drawings, and the next line would be lost.
//! - Text is UTF-8, and a byte order mark before it is skipped. `Decided:` a line that is not UTF-8
//!   is Latin-1, each byte a character, so that different names stay different.
//! - A comment begins at `#` at the start of a line or after white space. After a number, it needs
//!   no white space.
//!
//! `Decided:` a name reaches to the end of its line, `#` included, because programs write names such
//! as `Material #1`. The name without its comment is tried second: [`uncommented`] ends it at the
//! first `#` after white space.

use crate::io::Reason;
use std::borrow::Cow;

/// The lines of a file, each with its number; the first is line 1. A joined line has the number of
/// its first part.
///
/// # Errors
/// If the file is UTF-16.
pub(super) fn lines(bytes: &[u8]) -> Reason<Lines<'_>> {
    // The first character of an OBJ or an MTL is ASCII; in UTF-16 a zero byte is beside it.
    if matches!(bytes, [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] | [0, ..] | [_, 0, ..]) {
        return Err("the text is UTF-16 or not text at all; save it as UTF-8".into());
    }
    Ok(Lines { rest: bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes), number: 0 })
}

/// See [`lines`].
pub(super) struct Lines<'a> {
    /// The bytes after the last line.
    rest: &'a [u8],
    /// How many lines were read.
    number: u64,
}

impl<'a> Iterator for Lines<'a> {
    type Item = (u64, Cow<'a, str>);

    fn next(&mut self) -> Option<Self::Item> {
        let first = self.part()?;
        let number = self.number;
        let Some(start) = continued(first) else { return Some((number, text(first))) };
        let mut joined = start.to_vec();
        while let Some(part) = self.part() {
            joined.push(b' ');
            let start = continued(part);
            joined.extend(start.unwrap_or(part));
            if start.is_none() {
                break;
            }
        }
        Some((number, Cow::Owned(text(&joined).into_owned())))
    }
}

impl<'a> Lines<'a> {
    /// The bytes up to the next end of a line.
    fn part(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = self.rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let (line, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        self.rest = match rest {
            [b'\r', b'\n', rest @ ..] | [_, rest @ ..] => rest,
            [] => rest,
        };
        Some(line)
    }
}

/// A line without the backslash that joins the next line to it; `None` if there is no such backslash.
fn continued(line: &[u8]) -> Option<&[u8]> {
    let start = line.trim_ascii_end().strip_suffix(b"\\")?;
    let comment = |pair: &[u8]| pair[0].is_ascii_whitespace() && pair[1] == b'#';
    (start.first() != Some(&b'#') && !start.windows(2).any(comment)).then_some(start)
}

fn text(line: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(line) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(line.iter().copied().map(char::from).collect()),
    }
}

/// The first word of a line, and the text after it.
pub(super) fn statement(line: &str) -> (&str, &str) {
    let line = line.trim_ascii();
    let (word, rest) = line.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((line, ""));
    (word, rest.trim_ascii())
}

/// The words before the comment.
pub(super) fn words(text: &str) -> impl Iterator<Item = &str> {
    let mut ended = false;
    text.split_ascii_whitespace().map_while(move |word| {
        let comment = word.match_indices('#').find(|(at, _)| !word[..*at].ends_with('.'));
        let (word, more) = (&word[..comment.map_or(word.len(), |(at, _)| at)], comment.is_none());
        (!std::mem::replace(&mut ended, !more) && !word.is_empty()).then_some(word)
    })
}

/// A name up to its comment.
pub(super) fn uncommented(name: &str) -> &str {
    let mut places = name.match_indices('#').map(|(at, _)| at);
    let blank = |at: usize| name[..at].ends_with(|c: char| c.is_ascii_whitespace());
    let end = places.find(|&at| at == 0 || blank(at));
    name[..end.unwrap_or(name.len())].trim_ascii_end()
}

/// Parses words as numbers.
///
/// The run-time library of MSVC prints NaN as `1.#QNAN`, `1.#SNAN` or `-1.#IND`, and infinity as
/// `1.#INF`, sometimes with further digits.
pub(super) fn numbers<'a>(words: impl Iterator<Item = &'a str>) -> Reason<Vec<f64>> {
    let number = |word: &str| {
        if let Some((sign, what)) = word.split_once(".#") {
            if ["QNAN", "SNAN", "IND"].iter().any(|name| what.starts_with(name)) {
                return Ok(f64::NAN);
            }
            if what.starts_with("INF") {
                return Ok(if sign.starts_with('-') { f64::NEG_INFINITY } else { f64::INFINITY });
            }
        }
        word.parse().map_err(|_| format!("`{}` is not a number", shown(word)))
    };
    // Nine words are enough: no line has more than seven that are read.
    words.take(9).map(number).collect()
}

/// A word of a file as a message shows it.
pub(super) fn shown(word: &str) -> String {
    word.chars().take(40).flat_map(char::escape_debug).collect()
}
