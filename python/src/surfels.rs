//! Samplers, and measures of how evenly they spread points.

use crate::arrays::{numbers, vectors};
use crate::call::{How, call};
use crate::error::value;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use splatref::source::sampler::{
    self, Graph, Greedy, Order, Progressive, Quality, Schedule, Spectrum, Start, shuffled,
};

/// How points are ordered.
#[derive(FromPyObject)]
pub(crate) struct Sampler<'py> {
    name: String,
    count: usize,
    start: Option<u32>,
    seed: u64,
    /// Normals and the reach, for distances along a surface.
    along: Option<(PyReadonlyArray2<'py, f32>, f32)>,
}

type Indices<'py> = Bound<'py, PyArray1<u32>>;
type Numbers<'py> = Bound<'py, PyArray1<f32>>;

/// Orders points: the indices, and the squared distance at which each was picked.
#[pyfunction]
pub(crate) fn order<'py>(
    py: Python<'py>,
    how: How,
    points: PyReadonlyArray2<'py, f32>,
    sampler: Sampler<'py>,
) -> PyResult<(Indices<'py>, Numbers<'py>)> {
    let all = vectors(&points)?;
    drop(points);
    let Sampler { name, count, start, seed, along } = sampler;
    let along = along.map(|(normals, reach)| Ok::<_, PyErr>((vectors(&normals)?, reach)));
    let along = along.transpose()?;
    let start = start.map_or(Start::Seed(seed), Start::Index);
    let schedule = match name.as_str() {
        "progressive-as-shipped" => Schedule::AsShipped,
        _ => Schedule::Paper,
    };
    let Order { index, distance } = call(py, &how, |exec, show| match (name.as_str(), along) {
        ("random", _) => shuffled(&all, seed, count, show),
        ("greedy", None) => Greedy { start }.order(&all, count, exec, show),
        ("greedy", Some((normals, reach))) => {
            let graph = Graph::new(&all, &normals, reach, exec, show)?;
            Greedy { start }.along(&graph, count, show)
        }
        _ => Progressive { start, seed, schedule }.order(&all, count, show),
    })?;
    Ok((index.into_pyarray(py), distance.into_pyarray(py)))
}

/// The least distances within a prefix, and the largest distance from any point to the prefix, all
/// squared.
#[pyfunction]
pub(crate) fn quality<'py>(
    py: Python<'py>,
    how: How,
    points: PyReadonlyArray2<'py, f32>,
    prefix: PyReadonlyArray1<'py, u32>,
) -> PyResult<(Numbers<'py>, f32, f32)> {
    let (all, prefix) = (vectors(&points)?, numbers(&prefix)?);
    let Quality { nearest, packing, covering } =
        call(py, &how, |exec, _| sampler::quality(&all, &prefix, exec))?;
    Ok((nearest.into_pyarray(py), packing, covering))
}

/// Frequencies and powers; the reach, the density and the unit.
#[pyfunction]
pub(crate) fn spectrum<'py>(
    py: Python<'py>,
    how: How,
    points: PyReadonlyArray2<'py, f32>,
) -> PyResult<(Vec<f64>, Vec<f64>, [f64; 3])> {
    let all = vectors(&points)?;
    let found = call(py, &how, |exec, _| sampler::spectrum(&all, exec))?;
    let Spectrum { reach, density, unit, power } = found;
    Ok((Spectrum::frequencies().collect(), power, [reach, density, unit]))
}

/// The mean colours of the first points of an order.
#[pyfunction]
pub(crate) fn average_colors<'py>(
    py: Python<'py>,
    how: How,
    points: PyReadonlyArray2<'py, f32>,
    colors: PyReadonlyArray2<'py, f32>,
    order: PyReadonlyArray1<'py, u32>,
    count: usize,
) -> PyResult<Numbers<'py>> {
    let (all, colors, index) = (vectors(&points)?, vectors(&colors)?, numbers(&order)?);
    if count > index.len() {
        return Err(value(&format!("count {count}, but the order has {} points", index.len())));
    }
    let distance = vec![0.0; index.len()];
    let order = Order { index, distance };
    let new =
        call(py, &how, |exec, show| sampler::averaged(&all, &colors, &order, count, exec, show))?;
    let flat: Vec<f32> = new.iter().flat_map(|color| color.to_array()).collect();
    Ok(flat.into_pyarray(py))
}
