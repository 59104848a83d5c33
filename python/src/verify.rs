//! Verdicts on the planes of another renderer.

use crate::arrays::{check, components, scalar, size};
use crate::call::{How, call};
use crate::choose::{CameraChoice, Choices};
use crate::error::{raised, value};
use crate::render::{camera_numbers, explained};
use crate::scene::Scene;
use crate::setup::Setup;
use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyDict;
use splatref::io::client::{Array, Description};
use splatref::io::replace::Pending;
use splatref::io::scene_file::Number;
use splatref::method::Stage;
use splatref::report::{VerdictReport, page};
use splatref::setting::{Word, Words};
use splatref::verdict::causes::likely_cause;
use splatref::verdict::client::{Client, Rounding};
use splatref::verdict::{Causes, Doubt, StageVerdict, Verdict};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;

/// A verdict, and everything that explains it.
#[pyclass(frozen, module = "splatref._splatref")]
pub(crate) struct Judged {
    setup: Setup,
    client: Client,
    verdict: Verdict,
    #[pyo3(get)]
    likely: Option<String>,
    #[pyo3(get)]
    lines: Vec<String>,
    #[pyo3(get)]
    json: String,
}

/// A plane: its name, its numbers, and the type that they had.
type PlaneOfClient<'py> = (String, PyReadonlyArrayDyn<'py, f64>, String);

/// The call that explains a pixel, in the report.
fn replay((x, y): (u32, u32)) -> String {
    format!("verdict.explain({x}, {y})")
}

/// What a call of `verify` asks for beside the scene.
#[derive(FromPyObject)]
pub(crate) struct Asked {
    /// The description of the planes, see `splatref::io::client`.
    text: String,
    /// The renderer's records.
    records: Option<PyBackedBytes>,
    /// Whether planes that the method does not have are left out.
    lenient: bool,
    promise: Option<String>,
    budget: f64,
    cause: bool,
}

/// Judges planes.
#[pyfunction]
pub(crate) fn verify(
    py: Python<'_>,
    how: How,
    scene: &Bound<'_, Scene>,
    camera: Option<Bound<'_, CameraChoice>>,
    choices: Choices,
    planes: Vec<PlaneOfClient<'_>>,
    asked: Asked,
) -> PyResult<Judged> {
    let file = choices.on(&scene.get().file, camera.as_ref().map(Bound::get))?;
    file.output.check_kept("verify describes storage beside the planes").map_err(raised)?;
    if !(0.0..=1.0).contains(&asked.budget) {
        return Err(value(&format!("budget {}; give a fraction from 0 to 1", asked.budget)));
    }
    let promise = asked.promise.as_deref().map(|word| {
        Rounding::named(word)
            .ok_or_else(|| value(&format!("promise {word}; give gpu, precise or ieee")))
    });
    let promise = promise.transpose()?;
    let stages = file.method.method().map_err(raised)?.stages();
    let (mut arrays, mut unknown) = (BTreeMap::new(), Vec::new());
    for (name, numbers, format) in planes {
        if asked.lenient && !is_known(&name, stages) {
            unknown.push(name);
            continue;
        }
        check(&numbers)?;
        let numbers = numbers.as_array();
        let (size, _) = size(&numbers)?;
        let array = Array::new(size, components(&numbers)?, &format);
        arrays.insert(name, array.map_err(raised)?);
    }
    let mut described = Description::of_arrays(&asked.text, arrays).map_err(raised)?;
    if let Some(records) = &asked.records {
        described = described.with_records(records.to_vec());
    }
    let scene = scene.get();
    call(py, &how, |exec, show| {
        let setup = Setup::new(scene, &file, None, exec, show)?;
        let session = setup.session(exec)?;
        let mut client = described.client(setup.method.stages(), setup.camera.size(), exec)?;
        client.rounding = promise.unwrap_or(client.rounding);
        client.unknown.extend(unknown);
        if setup.output.number == Number::F64 {
            client = client.rounded();
        }
        show("judging", 0, 0);
        let verdict = session.verify(&setup.camera, &client, asked.budget)?;
        let likely = match asked.cause {
            true => likely_cause(&session, &setup.camera, &client, &verdict)?,
            false => None,
        };
        let words = likely.clone();
        let report =
            VerdictReport::new(&session, &setup.camera, &client, &verdict, words, &replay)?;
        let (lines, json) = (report.lines(), report.json()?);
        drop(session);
        Ok(Judged { setup, client, verdict, likely, lines, json })
    })
}

/// Whether a method has a plane of this name.
fn is_known(name: &str, stages: &[Stage]) -> bool {
    let color = if name == "RGB" { Some("") } else { name.strip_suffix(".RGB") };
    let has = |name: &str| stages.iter().any(|stage| stage.row(name).is_some());
    has(name) || color.is_some_and(has)
}

#[pymethods]
impl Judged {
    #[getter]
    fn outcome(&self) -> &'static str {
        self.verdict.outcome().word()
    }

    #[getter]
    fn promise(&self) -> &'static str {
        self.client.rounding.word()
    }

    #[getter]
    fn method(&self) -> &'static str {
        self.setup.method.name()
    }

    #[getter]
    fn covered(&self) -> u64 {
        self.verdict.covered
    }

    #[getter]
    fn camera<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        camera_numbers(py, &self.setup.camera, self.setup.scene().offset)
    }

    /// The stages: names, planes, errors in bounds, and undecided decisions.
    fn stages<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        self.verdict.stages.iter().map(|stage| described(py, stage)).collect()
    }

    /// The decisions that a bit of a mask stands for.
    #[staticmethod]
    fn doubts() -> Vec<(&'static str, u8)> {
        Doubt::ALL.iter().map(|doubt| (doubt.name(), *doubt as u8)).collect()
    }

    /// The decisions at a pixel, in words.
    fn explain(&self, py: Python<'_>, how: How, pixel: (u32, u32)) -> PyResult<String> {
        let setup = &self.setup;
        call(py, &how, |exec, _| explained(setup, &setup.session(exec)?, pixel))
    }

    /// Writes the page of the verdict.
    fn report(&self, py: Python<'_>, how: How, path: PathBuf) -> PyResult<()> {
        let Self { setup, client, verdict, likely, .. } = self;
        call(py, &how, |exec, show| {
            show("writing", 0, 0);
            let session = setup.session(exec)?;
            let words = likely.clone();
            let report =
                VerdictReport::new(&session, &setup.camera, client, verdict, words, &replay)?;
            let page = report.page(&session, &setup.camera, setup.output.number, exec)?;
            let text = page::html(&page, exec)?;
            Pending::write(&path, |file| file.write_all(text.as_bytes()))?.put()
        })
    }
}

fn described<'py>(py: Python<'py>, stage: &StageVerdict) -> PyResult<Bound<'py, PyDict>> {
    let one = PyDict::new(py);
    one.set_item("name", stage.stage)?;
    let names = stage.planes.iter().map(|name| if name.is_empty() { "RGB" } else { name });
    one.set_item("planes", names.collect::<Vec<_>>())?;
    one.set_item("missing", stage.missing.clone())?;
    one.set_item("unjudged", stage.unjudged.clone())?;
    one.set_item("wrong", stage.wrong)?;
    one.set_item("errors", scalar(py, stage.errors.clone())?)?;
    one.set_item("doubts", scalar(py, stage.doubts.clone())?)?;
    if let Some(worst) = &stage.worst {
        one.set_item("worst", (worst.pixel, worst.error, worst.fault.to_string()))?;
    }
    let Causes { left_out, outside, absent, ties, strays, below, nan, others, .. } = &stage.causes;
    let counts = [
        ("left_out", left_out.values().sum()),
        ("outside", *outside),
        ("absent", *absent),
        ("ties", *ties),
        ("strays", *strays),
        ("below", *below),
        ("nan", *nan),
        ("others", *others),
    ];
    one.set_item("causes", counts.into_iter().filter(|(_, count)| *count > 0).collect::<Vec<_>>())?;
    Ok(one)
}
