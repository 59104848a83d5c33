//! Makes text of files, names and arguments safe for a terminal.

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

#[cfg(test)]
mod tests {
    use super::*;

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
