//! Arrays of `numpy` as vectors and planes, and back.

use crate::error::{memory, raised, value};
use glam::Vec3;
use numpy::ndarray::{ArrayViewD, Axis, Dimension};
use numpy::{
    Element, IntoPyArray, PyArray, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use splatref::frame::{Frame, Image, NamedPlane, Plane, Samples};

/// A vector with room for so many values. An array may claim more numbers than there is memory.
fn room<T>(count: usize) -> PyResult<Vec<T>> {
    let bytes = (count as u64).saturating_mul(size_of::<T>() as u64);
    splatref::memory::ask(bytes, || format!("a copy of {count} values")).map_err(raised)?;
    let mut all = Vec::new();
    all.try_reserve_exact(count).map_err(memory)?;
    Ok(all)
}

/// Refuses an array whose numbers lie across the borders of their type: Rust reads no such numbers.
/// The modules of Python align arrays, so that this is a mistake of theirs.
pub(crate) fn check<T: Element, D: Dimension>(array: &Bound<'_, PyArray<T, D>>) -> PyResult<()> {
    let aligned = |stride: &isize| stride.unsigned_abs().is_multiple_of(align_of::<T>());
    let strides = array.strides();
    if array.data().is_aligned() && strides.iter().all(aligned) {
        return Ok(());
    }
    Err(value("an array is not aligned; give a copy of it"))
}

/// Points or colours, n x 3.
pub(crate) fn vectors(array: &PyReadonlyArray2<'_, f32>) -> PyResult<Vec<Vec3>> {
    check(array)?;
    let array = array.as_array();
    if array.ncols() != 3 {
        return Err(value("vectors have three components"));
    }
    let mut all = room(array.nrows())?;
    match array.as_slice() {
        Some(numbers) => {
            all.extend(numbers.as_chunks::<3>().0.iter().map(|&v| Vec3::from_array(v)));
        }
        None => all.extend(array.rows().into_iter().map(|v| Vec3::new(v[0], v[1], v[2]))),
    }
    Ok(all)
}

/// Numbers, one a point.
pub(crate) fn numbers<T: Element + Copy>(array: &PyReadonlyArray1<'_, T>) -> PyResult<Vec<T>> {
    check(array)?;
    let array = array.as_array();
    let mut all = room(array.len())?;
    all.extend(array.iter().copied());
    Ok(all)
}

/// The size of a plane, height x width or height x width x components, and the number of components.
pub(crate) fn size<T>(array: &ArrayViewD<'_, T>) -> PyResult<([u32; 2], usize)> {
    let (height, width, components) = match *array.shape() {
        [height, width] => (height, width, 1),
        [height, width, components] => (height, width, components),
        _ => return Err(value("a plane has the shape (height, width) or (height, width, 3)")),
    };
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(width), Ok(height)) if width > 0 && height > 0 => Ok(([width, height], components)),
        _ => Err(value("a plane has at least one pixel, and fewer than 2^32 a side")),
    }
}

/// The components of a plane, each row by row.
pub(crate) fn components(array: &ArrayViewD<'_, f64>) -> PyResult<Vec<Vec<f64>>> {
    let (_, count) = size(array)?;
    if array.ndim() == 2 {
        return Ok(vec![array.iter().copied().collect()]);
    }
    let part = |i| array.index_axis(Axis(2), i).iter().copied().collect();
    Ok((0..count).map(part).collect())
}

/// The name of a plane in a frame, and whether it is a colour: `RGB` is the picture.
fn name_of(name: &str) -> (&str, bool) {
    match name {
        "RGB" => ("", true),
        _ => name.strip_suffix(".RGB").map_or((name, false), |layer| (layer, true)),
    }
}

/// The name of a plane in Python.
fn name_in_python(name: &str, is_color: bool) -> String {
    match (name, is_color) {
        ("", _) => "RGB".into(),
        (_, true) => format!("{name}.RGB"),
        (_, false) => name.into(),
    }
}

fn samples(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Samples<f32>> {
    let (_, is_color) = name_of(name);
    if let Ok(array) = array.cast::<PyArrayDyn<f32>>() {
        check(array)?;
        return floats(array.try_readonly()?.as_array(), is_color, |v| v);
    }
    if let Ok(array) = array.cast::<PyArrayDyn<f64>>() {
        check(array)?;
        // As files hold pictures of f64: rounded once.
        return floats(array.try_readonly()?.as_array(), is_color, |v| v as f32);
    }
    if let Ok(array) = array.cast::<PyArrayDyn<u32>>() {
        check(array)?;
        return Ok(Samples::Index(whole(array.try_readonly()?.as_array())?));
    }
    if let Ok(array) = array.cast::<PyArrayDyn<u8>>() {
        check(array)?;
        return Ok(Samples::Count(whole(array.try_readonly()?.as_array())?));
    }
    Err(value(&format!("{name}: a plane holds float32, float64, uint32 or uint8")))
}

fn floats<T: Copy>(
    array: ArrayViewD<'_, T>,
    is_color: bool,
    single: impl Fn(T) -> f32,
) -> PyResult<Samples<f32>> {
    let ([width, height], components) = size(&array)?;
    let values: Vec<f32> = array.iter().map(|&v| single(v)).collect();
    if array.ndim() == 2 {
        return Ok(Samples::Scalar(Plane::from_values(width, height, values)));
    }
    if components != 3 {
        return Err(value("a plane has the shape (height, width) or (height, width, 3)"));
    }
    let plane = Plane::from_values(width, height, values.as_chunks::<3>().0.to_vec());
    Ok(if is_color { Samples::Color(plane) } else { Samples::Vector(plane) })
}

fn whole<T: Copy>(array: ArrayViewD<'_, T>) -> PyResult<Plane<T>> {
    let ([width, height], _) = size(&array)?;
    if array.ndim() != 2 {
        return Err(value("a plane of whole numbers has the shape (height, width)"));
    }
    Ok(Plane::from_values(width, height, array.iter().copied().collect()))
}

/// Named planes from Python.
pub(crate) type Planes<'py> = Vec<(String, Bound<'py, PyAny>)>;

/// The planes as a frame.
pub(crate) fn frame(planes: &Planes<'_>) -> PyResult<Frame<f32>> {
    let mut frame: Option<Frame<f32>> = None;
    for (name, array) in planes {
        let samples = samples(name, array)?;
        let (width, height) = samples.size();
        let frame = frame.get_or_insert_with(|| Frame::new(width, height));
        frame.push(name_of(name).0, samples).map_err(raised)?;
    }
    frame.ok_or_else(|| value("no planes; give at least one"))
}

/// The planes as a file holds them.
pub(crate) fn image(planes: &Planes<'_>) -> PyResult<Image> {
    frame(planes).map(|frame| Image::from(&frame))
}

/// One number a pixel as an array.
pub(crate) fn scalar<T: Element>(py: Python<'_>, plane: Plane<T>) -> PyResult<Bound<'_, PyAny>> {
    let shape = [plane.height() as usize, plane.width() as usize];
    Ok(plane.into_values().into_pyarray(py).reshape(shape)?.into_any())
}

/// Three numbers a pixel as an array.
pub(crate) fn triple<T: Element>(
    py: Python<'_>,
    plane: Plane<[T; 3]>,
) -> PyResult<Bound<'_, PyAny>> {
    let shape = [plane.height() as usize, plane.width() as usize, 3];
    Ok(plane.into_values().into_flattened().into_pyarray(py).reshape(shape)?.into_any())
}

/// The planes of a frame as arrays, without a copy.
pub(crate) fn arrays<R: Element>(py: Python<'_>, frame: Frame<R>) -> PyResult<Planes<'_>> {
    let of = |NamedPlane { name, samples }: NamedPlane<R>| {
        let is_color = matches!(samples, Samples::Color(_));
        let array = match samples {
            Samples::Scalar(plane) => scalar(py, plane)?,
            Samples::Color(plane) | Samples::Vector(plane) => triple(py, plane)?,
            Samples::Index(plane) => scalar(py, plane)?,
            Samples::Count(plane) => scalar(py, plane)?,
        };
        Ok((name_in_python(&name, is_color), array))
    };
    frame.planes.into_iter().map(of).collect()
}
