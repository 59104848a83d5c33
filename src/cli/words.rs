//! Makes text of files, names and arguments safe for a terminal.

use std::ffi::OsStr;

/// The longest error, in characters.
const LONGEST: usize = 1000;

/// Escapes every character that is not printable, except line ends: a name from a file must not
/// control the terminal, nor change the reading direction.
pub(super) fn visible(text: &str) -> String {
    let hidden = |c: char| {
        c.is_control() && c != '\n'
            || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if hidden(c) { shown.extend(c.escape_default()) } else { shown.push(c) }
    }
    shown
}

/// Puts text on one visible line of at most about [`LONGEST`] characters. A longer text keeps its
/// start and its end, because these say where and what.
pub(super) fn line(text: &str) -> String {
    let text = visible(&text.replace('\n', " "));
    let count = text.chars().count();
    if count <= LONGEST {
        return text;
    }
    let part = LONGEST / 2;
    let start: String = text.chars().take(part).collect();
    let end: String = text.chars().skip(count - part).collect();
    format!("{start} [{} characters left out] {end}", count - 2 * part)
}

/// Quotes a word for a shell. Bytes that are no text, and characters that would not be printed as
/// they are, become escapes in `$'...'`, which bash, zsh and POSIX shells since 2024 read.
pub(super) fn quoted(word: &OsStr) -> String {
    let text = word.to_str().filter(|text| visible(text) == *text && !text.contains('\n'));
    let Some(text) = text else { return escaped(word) };
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_=./,:+@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

/// A word in `$'...'`, with an escape for each byte that is not plain ASCII.
fn escaped(word: &OsStr) -> String {
    let of = |&byte: &u8| match byte {
        b'\'' | b'\\' => format!("\\{}", char::from(byte)),
        b' '..=b'~' => char::from(byte).into(),
        // Three octal digits, so that a digit may follow.
        _ => format!("\\{byte:03o}"),
    };
    let bytes = word.as_encoded_bytes().iter().map(of);
    format!("$'{}'", bytes.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_reads_the_word_again() {
        let quoted = |word: &str| quoted(OsStr::new(word));
        assert_eq!(quoted("a/b-1.5,2.ply"), "a/b-1.5,2.ply");
        assert_eq!(quoted(""), "''");
        assert_eq!(quoted("it's $HOME"), "'it'\\''s $HOME'");
        assert_eq!(quoted("Räsänen"), "'Räsänen'");
        assert_eq!(quoted("a\nb'\u{1b}2"), "$'a\\012b\\'\\0332'");
    }

    #[cfg(unix)]
    #[test]
    fn bytes_that_are_no_text_are_escaped() {
        use std::os::unix::ffi::OsStrExt;
        assert_eq!(quoted(OsStr::from_bytes(b"a\xff1.ply")), "$'a\\3771.ply'");
    }

    #[test]
    fn nothing_steers_a_terminal() {
        assert_eq!(visible("a\u{1b}[2Jb\tc\r\nd"), "a\\u{1b}[2Jb\\tc\\r\nd");
        assert_eq!(visible("\u{202e}exe.ylp"), "\\u{202e}exe.ylp");
        assert_eq!(visible("Räsänen, 表面"), "Räsänen, 表面");
        assert_eq!(line("a\nb"), "a b");
    }

    #[test]
    fn a_megabyte_is_shortened_in_the_middle() {
        let shown = line(&format!("{}.ply: no such file", "ä".repeat(1_000_000)));
        assert!(shown.chars().count() < LONGEST + 60, "{}", shown.len());
        assert!(shown.starts_with("ää") && shown.ends_with("ä.ply: no such file"), "{shown}");
        assert!(shown.contains("[999018 characters left out]"), "{shown}");
    }
}
