//! Comparisons of pictures, and metrics.

use crate::arrays::{Planes, check, frame, image, scalar};
use crate::call::{How, call};
use crate::error::value;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use splatref::compare::metrics::{self, Errors, METRICS};
use splatref::compare::{
    ChannelValue, Criteria, Difference, Relation, Tolerance, Verdict, compare as compare_images,
    digest,
};
use splatref::frame::Samples;

/// The bounds of a tolerance: ulp, abs and pixels.
type Bounds = (Option<u32>, Option<f32>, usize);

fn tolerance((max_ulp, max_abs, pixels): Bounds) -> Tolerance {
    Tolerance { max_ulp, max_abs, pixels }
}

/// The verdict, the lines of the report, and a dictionary for each channel.
type Compared<'py> = (&'static str, Vec<String>, Vec<Bound<'py, PyDict>>);

/// Compares the planes of two pictures.
#[pyfunction]
pub(crate) fn compare<'py>(
    py: Python<'py>,
    how: How,
    pair: (Planes<'py>, Planes<'py>),
    planes: Option<Vec<String>>,
    bounds: Bounds,
    named: Vec<(String, Bounds)>,
) -> PyResult<Compared<'py>> {
    let (first, second) = (image(&pair.0)?, image(&pair.1)?);
    let named = named.into_iter().map(|(name, bounds)| (name, tolerance(bounds)));
    let (named, tolerance) = (named.collect(), tolerance(bounds));
    let criteria = Criteria { planes, tolerance, named, skip_observations: true };
    let found = call(py, &how, |_, _| compare_images(&first, &second, &criteria))?;
    let word = match found.verdict() {
        Verdict::Equal => "equal",
        Verdict::Within => "within",
        Verdict::Different => "different",
    };
    let lines = found.lines();
    let mut channels = Vec::new();
    for (channel, line) in found.channels.iter().zip(&lines) {
        let one = PyDict::new(py);
        one.set_item("name", &channel.name)?;
        one.set_item("line", line)?;
        one.set_item(
            "verdict",
            channel.verdict().map(|verdict| match verdict {
                Verdict::Equal => "equal",
                Verdict::Within => "within",
                Verdict::Different => "different",
            }),
        )?;
        if let Relation::Values(values) = &channel.relation {
            one.set_item("pixels", values.pixels)?;
            one.set_item("differing", values.differing)?;
            one.set_item("failing", values.failing)?;
            one.set_item("nan", values.nan)?;
            one.set_item("max_ulp", values.max_ulp)?;
            one.set_item("max_abs", values.max_abs)?;
            one.set_item("rms", values.rms)?;
            one.set_item("first", values.first.map(both))?;
            one.set_item("worst", values.worst.map(both))?;
        }
        channels.push(one);
    }
    Ok((word, lines, channels))
}

/// The place of a difference, and both values.
fn both(difference: Difference) -> ((u32, u32), f64, f64) {
    let number = |value| match value {
        ChannelValue::Float(value) => f64::from(value),
        ChannelValue::Index(value) => f64::from(value),
    };
    ((difference.x, difference.y), number(difference.first), number(difference.second))
}

/// One hash of many pictures, as `splatref golden` prints it.
#[pyfunction]
pub(crate) fn sha256(pictures: Vec<(String, Planes<'_>)>) -> PyResult<String> {
    let images = pictures.iter().map(|(name, planes)| Ok((name.as_str(), image(planes)?)));
    let images = images.collect::<PyResult<Vec<_>>>()?;
    Ok(digest::sha256(images.iter().map(|(name, image)| (*name, image))))
}

/// The structural similarity of two planes, and its map; `None` if they are smaller than a window.
#[pyfunction]
pub(crate) fn ssim(
    py: Python<'_>,
    how: How,
    first: PyReadonlyArray2<'_, f32>,
    second: PyReadonlyArray2<'_, f32>,
) -> PyResult<Option<f64>> {
    check(&first)?;
    check(&second)?;
    let width = first.as_array().ncols();
    if first.as_array().shape() != second.as_array().shape() {
        return Err(value("two planes of one size are compared"));
    }
    let values = |array: &PyReadonlyArray2<'_, f32>| -> Vec<f32> {
        array.as_array().iter().copied().collect()
    };
    let (first, second) = (values(&first), values(&second));
    call(py, &how, |_, _| Ok(metrics::ssim(&first, &second, width)))
}

/// The mean of FLIP, and its map.
#[pyfunction]
pub(crate) fn flip<'py>(
    py: Python<'py>,
    how: How,
    pair: (Planes<'py>, Planes<'py>),
    pixels_per_degree: f64,
) -> PyResult<(f64, Bound<'py, PyAny>)> {
    let (picture, reference) = (frame(&pair.0)?, frame(&pair.1)?);
    let (Some(Samples::Color(picture)), Some(Samples::Color(reference))) =
        (picture.plane(""), reference.plane(""))
    else {
        return Err(value("FLIP compares colours; give two pictures with RGB"));
    };
    let found =
        call(py, &how, |exec, _| metrics::flip(picture, reference, pixels_per_degree, exec))?;
    Ok((found.mean, scalar(py, found.map)?))
}

/// Every error of a picture against its truth: name, title, unit and number.
#[pyfunction]
#[expect(clippy::type_complexity, reason = "rows of a table")]
pub(crate) fn errors(
    py: Python<'_>,
    how: How,
    pair: (Planes<'_>, Planes<'_>),
) -> PyResult<Vec<(&'static str, &'static str, &'static str, Option<f64>)>> {
    let (picture, truth) = (frame(&pair.0)?, frame(&pair.1)?);
    let found = call(py, &how, |exec, _| Errors::measure(&picture, &truth, exec))?;
    let row =
        |metric: &metrics::Metric| (metric.name, metric.title, metric.unit, (metric.of)(&found));
    Ok(METRICS.iter().map(row).collect())
}
