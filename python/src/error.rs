//! Errors of the library as exceptions.

use pyo3::PyErr;
use pyo3::exceptions::{PyMemoryError, PyOSError, PyValueError};
use splatref::Error;
use std::collections::TryReserveError;

/// An `OSError` of its kind for a file, a `ValueError` for everything else.
pub(crate) fn raised(error: Error) -> PyErr {
    match error {
        Error::Io { path, source } => match source.raw_os_error() {
            Some(code) => {
                let text = source.to_string();
                let end = format!(" (os error {code})");
                let text = text.strip_suffix(&end).unwrap_or(&text).to_owned();
                // Python makes this a FileNotFoundError, a PermissionError and so on.
                PyOSError::new_err((code, text, path.into_os_string()))
            }
            None => PyOSError::new_err(format!("{}: {source}", path.display())),
        },
        // What Python hands over has no path.
        Error::Format { path, what } if path.as_os_str().is_empty() => value(without_line(&what)),
        other => value(&other.to_string()),
    }
}

/// A `ValueError`.
pub(crate) fn value(what: &str) -> PyErr {
    PyValueError::new_err(in_python(what))
}

/// Not enough memory for an array.
pub(crate) fn memory(_: TryReserveError) -> PyErr {
    PyMemoryError::new_err("not enough memory for a copy of the array")
}

/// A text that Python wrote has no lines that its user knows.
fn without_line(what: &str) -> &str {
    let after = what.strip_prefix("line ").and_then(|rest| rest.split_once(": "));
    match after {
        Some((number, rest)) if number.bytes().all(|c| c.is_ascii_digit()) => rest,
        _ => what,
    }
}

/// Options of the command line by their names in Python: `--depth-storage` is `depth_storage`.
pub(crate) fn in_python(what: &str) -> String {
    let mut text = String::with_capacity(what.len());
    let mut rest = what;
    while let Some(at) = rest.find("--") {
        let name = &rest[at + 2..];
        let end = name.find(|c: char| !(c.is_ascii_lowercase() || c == '-'));
        let name = &name[..end.unwrap_or(name.len())];
        text += &rest[..at];
        if name.starts_with(|c: char| c.is_ascii_lowercase()) {
            text += &name.replace('-', "_");
        } else {
            text += &rest[at..at + 2 + name.len()];
        }
        rest = &rest[at + 2 + name.len()..];
    }
    text + rest
}
