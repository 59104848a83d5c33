//! The rows of settings and of planes, as Python lists them.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use splatref::io::scene_file::{GroupChoice, MethodChoice, OutputSettings};
use splatref::method::Method;
use splatref::setting::{Setting, Value};

/// The settings: those of methods, of groups, and of pictures.
#[pyfunction]
pub(crate) fn rows(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
    let all = PyList::empty(py);
    let tables = [
        ("method", MethodChoice::rows()),
        ("groups", GroupChoice::rows()),
        ("output", OutputSettings::rows()),
    ];
    for (table, rows) in tables {
        for row in rows {
            all.append(described(py, table, &row)?)?;
        }
    }
    Ok(all)
}

fn described<'py>(py: Python<'py>, table: &str, row: &Setting) -> PyResult<Bound<'py, PyDict>> {
    let one = PyDict::new(py);
    one.set_item("table", table)?;
    one.set_item("key", row.name)?;
    one.set_item("name", row.option.replace('-', "_"))?;
    one.set_item("option", &row.option)?;
    one.set_item("help", row.help)?;
    one.set_item("unit", row.unit)?;
    one.set_item("range", row.range)?;
    one.set_item("form", &row.form)?;
    one.set_item("words", row.words.clone())?;
    one.set_item("description", row.description())?;
    let defaults = PyDict::new(py);
    for (owner, default) in &row.owners {
        defaults.set_item(owner, default.as_ref().map(Value::text))?;
    }
    one.set_item("defaults", defaults)?;
    Ok(one)
}

/// The name and the summary of each method.
#[pyfunction]
pub(crate) fn methods() -> Vec<(&'static str, &'static str)> {
    Method::all().iter().map(|method| (method.name(), method.summary())).collect()
}

/// The planes of a method: stage, name, unit and meaning.
#[pyfunction]
pub(crate) fn planes(
    method: &str,
) -> PyResult<Vec<(&'static str, String, &'static str, &'static str)>> {
    let method = Method::by_name(method).map_err(crate::error::raised)?;
    let rows = method.stages().iter().flat_map(|stage| {
        stage.leaves.iter().map(|row| {
            let name = match (row.name, row.holds.channels(row.name).first()) {
                ("", _) => "RGB".to_owned(),
                (name, Some(first)) if *first == format!("{name}.R") => format!("{name}.RGB"),
                (name, _) => name.to_owned(),
            };
            (stage.name, name, row.unit, row.meaning)
        })
    });
    Ok(rows.collect())
}
