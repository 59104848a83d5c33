//! Projected splats, as records.

use crate::call::{How, call};
use crate::choose::{CameraChoice, Choices};
use crate::error::{raised, value};
use crate::scene::Scene;
use crate::setup::Setup;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use splatref::Error;
use splatref::io::scene_file::Number;

/// Name, offset in bytes and type of a field.
type Field = (&'static str, usize, &'static str);

/// The bytes and the fields of a record of the chosen method; none: it draws no splats.
#[pyfunction]
pub(crate) fn record_layout(
    scene: &Bound<'_, Scene>,
    choices: Choices,
) -> PyResult<Option<(usize, Vec<Field>)>> {
    let file = choices.on(&scene.get().file, None)?;
    let layout = file.method.method().map_err(raised)?.record_layout();
    Ok(layout.map(|layout| (layout.size, layout.fields.to_vec())))
}

/// The visible splats of a picture, one record after the other.
#[pyfunction]
pub(crate) fn project<'py>(
    py: Python<'py>,
    how: How,
    scene: &Bound<'py, Scene>,
    camera: Option<Bound<'py, CameraChoice>>,
    choices: Choices,
) -> PyResult<Bound<'py, PyArray1<u8>>> {
    let file = choices.on(&scene.get().file, camera.as_ref().map(Bound::get))?;
    file.output.check_kept("records are f32").map_err(raised)?;
    if file.output.number != Number::F32 {
        return Err(value("records are f32; give number=\"f32\""));
    }
    let scene = scene.get();
    let bytes = call(py, &how, |exec, show| {
        let setup = Setup::placed(scene, &file, None, exec)?;
        setup.method.check_scene(setup.scene())?;
        show("projecting", 0, 0);
        let records = setup.method.records(setup.scene(), &setup.camera, exec);
        let records = records.ok_or_else(|| {
            Error::Usage(format!("{} draws no splats; give another method", setup.method.name()))
        })?;
        let size = records.tally.visible * records.layout.size as u64;
        splatref::memory::ask(size, || format!("{size} bytes of records"))?;
        let mut bytes = Vec::with_capacity(size as usize);
        records.write(&mut bytes).map_err(|error| Error::Invalid(error.to_string()))?;
        Ok(bytes)
    })?;
    Ok(bytes.into_pyarray(py))
}
