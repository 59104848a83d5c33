//! Read the tables of a TOML file key by key; every error names the key in full.

use crate::io::Reason;
use crate::setting::Words;
use std::path::PathBuf;
use toml::{Table, Value};

/// A table whose keys are taken one by one; keys that remain at the end are unknown.
#[derive(Debug)]
pub(super) struct Keys {
    /// The name of the table and a dot; empty for the file itself.
    prefix: String,
    table: Table,
    /// The keys that were asked for, listed if an unknown one is found.
    known: Vec<&'static str>,
}

impl Keys {
    pub(super) fn new(table: Table) -> Self {
        Self { prefix: String::new(), table, known: Vec::new() }
    }

    /// The name of the table and a dot.
    pub(super) fn prefix(&self) -> &str {
        &self.prefix
    }

    fn take(&mut self, key: &'static str) -> Option<Value> {
        self.known.push(key);
        self.table.remove(key)
    }

    /// The value of a key, if `convert` accepts it; otherwise an error that asks for `wanted`.
    fn typed<T>(
        &mut self,
        key: &'static str,
        wanted: &str,
        convert: impl Fn(&Value) -> Option<T>,
    ) -> Reason<Option<T>> {
        let Some(value) = self.take(key) else { return Ok(None) };
        let wrong = || format!("{}{key} is {}; give {wanted}", self.prefix, words(&value));
        convert(&value).map(Some).ok_or_else(wrong)
    }

    pub(super) fn path(&mut self, key: &'static str) -> Reason<Option<PathBuf>> {
        let path =
            |value: &Value| value.as_str().filter(|text| !text.is_empty()).map(PathBuf::from);
        self.typed(key, "the path of a file", path)
    }

    pub(super) fn switch(&mut self, key: &'static str) -> Reason<Option<bool>> {
        self.typed(key, "true or false", Value::as_bool)
    }

    pub(super) fn number(&mut self, key: &'static str) -> Reason<Option<f64>> {
        self.typed(key, "a number", number)
    }

    /// Two different finite numbers.
    pub(super) fn range(&mut self, key: &'static str) -> Reason<Option<[f64; 2]>> {
        self.typed(key, "two different finite numbers: [-1, 1]", |value| {
            let [low, high] = value.as_array()?.as_slice() else { return None };
            let (low, high) = (number(low)?, number(high)?);
            (low.is_finite() && high.is_finite() && low != high).then_some([low, high])
        })
    }

    /// A number of bytes.
    pub(super) fn bytes(&mut self, key: &'static str) -> Reason<Option<u64>> {
        self.typed(key, "a whole number of bytes from 0", |value| {
            value.as_integer().and_then(|bytes| u64::try_from(bytes).ok())
        })
    }

    /// A whole number of 32 bits.
    pub(super) fn whole(&mut self, key: &'static str) -> Reason<Option<u32>> {
        self.typed(key, "a whole number from 0", whole)
    }

    /// Width and height.
    pub(super) fn size(&mut self, key: &'static str) -> Reason<Option<[u32; 2]>> {
        self.typed(key, "width and height, at least 1: [640, 480]", |value| {
            let [width, height] = value.as_array()?.as_slice() else { return None };
            let (width, height) = (whole(width)?, whole(height)?);
            (width > 0 && height > 0).then_some([width, height])
        })
    }

    /// One name, two or three.
    pub(super) fn names(&mut self, key: &'static str) -> Reason<Option<Vec<String>>> {
        let wanted = "the name of a channel, or of two or three: [\"r\", \"g\", \"b\"]";
        self.typed(key, wanted, |value| match value {
            Value::String(name) => Some(vec![name.clone()]),
            Value::Array(names) if (2..=3).contains(&names.len()) => {
                names.iter().map(|name| name.as_str().map(str::to_owned)).collect()
            }
            _ => None,
        })
    }

    pub(super) fn word<T: Words>(&mut self, key: &'static str) -> Reason<Option<T>> {
        let all: Vec<String> = T::WORDS.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        self.typed(key, &format!("one of {}", all.join(", ")), |value| T::named(value.as_str()?))
    }

    /// A table inside this one; empty if there is none.
    pub(super) fn table(&mut self, key: &'static str) -> Reason<Self> {
        let table = self.typed(key, "a table", |value| value.as_table().cloned())?;
        Ok(self.inner(key, table.unwrap_or_default()))
    }

    /// The tables inside this one, whatever their names; a path stands for a table with only
    /// `file`.
    pub(super) fn tables(mut self) -> Reason<Vec<(String, Self)>> {
        let names: Vec<String> = self.table.keys().cloned().collect();
        let tables = names.into_iter().map(|name| {
            let table = match self.table.remove(&name) {
                Some(Value::Table(table)) => table,
                Some(file @ Value::String(_)) => [("file".to_owned(), file)].into_iter().collect(),
                other => {
                    let found = other.as_ref().map_or_else(String::new, words);
                    return Err(format!(
                        "{}{name} is {found}; give a table, or the path of a file",
                        self.prefix
                    ));
                }
            };
            let inner = self.inner(&name, table);
            Ok((name, inner))
        });
        tables.collect()
    }

    fn inner(&self, key: &str, table: Table) -> Self {
        let key = if key.contains('.') { format!("\"{key}\"") } else { key.to_owned() };
        Self { prefix: format!("{}{key}.", self.prefix), table, known: Vec::new() }
    }

    /// Checks that no key is left.
    pub(super) fn done(self) -> Reason<()> {
        let Some((key, value)) = self.table.iter().next() else { return Ok(()) };
        let place = match self.prefix.strip_suffix('.') {
            Some(table) => format!("{table}: "),
            None => String::new(),
        };
        // TOML reads [planes.visibility.Z] as a table `Z` inside a plane `visibility`.
        let quoted = match self.prefix.strip_prefix("planes.").and_then(|of| of.strip_suffix('.')) {
            Some(plane) if value.is_table() => {
                format!("; quote a name that has a dot: [planes.\"{plane}.{key}\"]")
            }
            _ => String::new(),
        };
        let known = self.known.join(", ");
        Err(format!("{place}unknown key `{}`; the keys are {known}{quoted}", key.escape_debug()))
    }
}

/// Accepts an integer as a number too.
fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

fn whole(value: &Value) -> Option<u32> {
    value.as_integer().and_then(|whole| u32::try_from(whole).ok())
}

/// A value in a few words, on one line.
fn words(value: &Value) -> String {
    match value {
        Value::String(text) if text.len() < 80 => format!("{text:?}"),
        Value::Integer(whole) => whole.to_string(),
        Value::Float(number) => number.to_string(),
        Value::Boolean(on) => on.to_string(),
        Value::Array(values) => format!("an array of {}", values.len()),
        Value::Table(_) => "a table".to_owned(),
        other => format!("a {}", other.type_str()),
    }
}
