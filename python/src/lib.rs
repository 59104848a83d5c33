//! `splatref._splatref`: the part of the Python package that calls the Rust library.
//!
//! The modules in `splatref/*.py` check what people give, and convert it: every array that comes
//! here is a `numpy` array of a known type, in native byte order, aligned. What comes here is copied
//! while the thread holds the interpreter, and nothing is borrowed afterwards.

mod arrays;
mod call;
mod choose;
mod compare;
mod error;
mod laws;
mod project;
mod render;
mod rows;
mod scene;
mod setup;
mod study;
mod surfels;
mod verify;

use pyo3::prelude::*;

#[pymodule]
fn _splatref(module: &Bound<'_, PyModule>) -> PyResult<()> {
    splatref::memory::set_limit(splatref::memory::usual_limit());
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<choose::CameraChoice>()?;
    module.add_class::<render::Drawn>()?;
    module.add_class::<render::State>()?;
    module.add_class::<verify::Judged>()?;
    module.add_class::<study::Study>()?;
    for function in [
        wrap_pyfunction!(render::render, module)?,
        wrap_pyfunction!(render::finish, module)?,
        wrap_pyfunction!(render::explain, module)?,
        wrap_pyfunction!(render::truth, module)?,
        wrap_pyfunction!(render::save_exr, module)?,
        wrap_pyfunction!(render::save_png, module)?,
        wrap_pyfunction!(render::png, module)?,
        wrap_pyfunction!(render::read, module)?,
        wrap_pyfunction!(project::project, module)?,
        wrap_pyfunction!(project::record_layout, module)?,
        wrap_pyfunction!(verify::verify, module)?,
        wrap_pyfunction!(surfels::order, module)?,
        wrap_pyfunction!(surfels::quality, module)?,
        wrap_pyfunction!(surfels::spectrum, module)?,
        wrap_pyfunction!(surfels::average_colors, module)?,
        wrap_pyfunction!(compare::compare, module)?,
        wrap_pyfunction!(compare::sha256, module)?,
        wrap_pyfunction!(compare::ssim, module)?,
        wrap_pyfunction!(compare::flip, module)?,
        wrap_pyfunction!(compare::errors, module)?,
        wrap_pyfunction!(laws::law, module)?,
        wrap_pyfunction!(rows::rows, module)?,
        wrap_pyfunction!(rows::planes, module)?,
        wrap_pyfunction!(rows::methods, module)?,
        wrap_pyfunction!(call::fail, module)?,
        wrap_pyfunction!(call::ask, module)?,
        wrap_pyfunction!(choose::views, module)?,
        wrap_pyfunction!(render::resolve, module)?,
        wrap_pyfunction!(study::front_of, module)?,
    ] {
        module.add_function(function)?;
    }
    Ok(())
}
