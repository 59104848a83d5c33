//! Studies: the errors and the times of all candidates of a scene.

use crate::call::{How, call, locked};
use crate::choose::{CameraChoice, Choices};
use crate::error::{in_python, raised, value};
use crate::scene::{Content, Scene};
use pyo3::prelude::*;
use splatref::Result;
use splatref::frame::Exec;
use splatref::io::scene_file::SceneFile;
use splatref::progress::Progress;
use splatref::study::front;
use splatref::study::run::measure::{loss, measure};
use splatref::study::run::truths::Truths;
use splatref::study::run::{Setup, Subject, time};
use std::path::PathBuf;
use std::sync::Mutex;

/// A scene that the study loads by itself: by its name, or by the file of a scene in memory.
#[derive(FromPyObject)]
pub(crate) enum Source<'py> {
    Scene(Bound<'py, Scene>),
    Name(PathBuf),
}

impl Source<'_> {
    fn file(&self) -> PyResult<SceneFile> {
        match self {
            Self::Name(name) => SceneFile::open(name).map_err(raised),
            Self::Scene(scene) => match &*scene.get().content {
                Content::File(_) => Ok(scene.get().file.clone()),
                Content::Arrays(_) => Err(value(
                    "a study loads its scenes from files, and this one came from arrays; give a file or a shape",
                )),
            },
        }
    }
}

/// The loaded candidates of a scene.
#[pyclass(frozen, module = "splatref._splatref")]
pub(crate) struct Study {
    setup: Mutex<Setup>,
    /// Made by the first call of `run`, because only that call needs it.
    truth: Mutex<Option<(Truths, Subject)>>,
    /// Options and method of each candidate.
    #[pyo3(get)]
    candidates: Vec<(String, &'static str)>,
    /// The methods that cannot draw the scene, and why.
    #[pyo3(get)]
    left_out: Vec<(&'static str, String)>,
    #[pyo3(get)]
    warnings: Vec<String>,
}

/// The surfels of a candidate, its errors by name, and the times of its pictures in ms.
type Row = (u64, Vec<(String, f64)>, Vec<f64>);
/// The scene, the camera and the truth, with hashes; the truth in words; the machine; and the rows.
type Ran = (Vec<String>, String, String, Vec<Row>);

#[pymethods]
impl Study {
    /// Loads the candidates.
    #[new]
    fn new(
        py: Python<'_>,
        how: How,
        scene: Source<'_>,
        camera: Option<Bound<'_, CameraChoice>>,
        choices: Choices,
        truth: Option<Source<'_>>,
    ) -> PyResult<Self> {
        let file = choices.on(&scene.file()?, camera.as_ref().map(Bound::get))?;
        let truth = truth.map(|truth| truth.file()).transpose()?;
        let only = choices.named()?;
        let setup =
            call(py, &how, |exec, show| Setup::load(&file, only, truth.as_ref(), exec, show))?;
        let said = |(method, why): &(&'static str, String)| (*method, in_python(why));
        Ok(Self {
            candidates: setup
                .candidates
                .iter()
                .map(|one| (one.options.clone(), one.method))
                .collect(),
            left_out: setup.left_out.iter().map(said).collect(),
            warnings: setup.warnings.clone(),
            setup: Mutex::new(setup),
            truth: Mutex::new(None),
        })
    }

    /// Measures the candidates with these indices, then times them by turns.
    fn run(&self, py: Python<'_>, how: How, indices: Vec<usize>) -> PyResult<Ran> {
        if indices.iter().any(|i| *i >= self.candidates.len()) {
            return Err(value("no such candidate"));
        }
        call(py, &how, |exec, show| {
            let (mut setup, mut truth) = (locked(&self.setup), locked(&self.truth));
            let (truths, of) = match &mut *truth {
                Some(known) => known,
                none => {
                    let truths = setup.known.pictures(&setup.camera, exec, show)?;
                    let of = setup.subject(&truths, exec)?;
                    none.insert((truths, of))
                }
            };
            let mut rows = measured(&mut setup, &indices, truths, exec, show)?;
            timed(&mut setup, &indices, &mut rows, exec, show)?;
            let subject = [&of.scene_sha256, &of.camera, &of.truth_sha256].map(Clone::clone);
            Ok((subject.to_vec(), of.truth.clone(), time::machine(exec), rows))
        })
    }
}

/// The errors of candidates, without times.
fn measured(
    setup: &mut Setup,
    indices: &[usize],
    truths: &Truths,
    exec: &Exec,
    show: Progress<'_>,
) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for (done, &i) in indices.iter().enumerate() {
        show("measuring", done as u64, indices.len() as u64);
        let (found, _) = measure(&mut setup.bench, &setup.candidates[i], truths, exec)?;
        rows.push((found.surfels, found.figures.into_iter().collect(), Vec::new()));
    }
    Ok(rows)
}

/// Times candidates by turns, except those whose times mean nothing.
fn timed(
    setup: &mut Setup,
    indices: &[usize],
    rows: &mut [Row],
    exec: &Exec,
    show: Progress<'_>,
) -> Result<()> {
    let count = indices.len() as u64;
    for round in 0..time::ROUNDS {
        for (done, i) in time::order(round, indices.len()).into_iter().enumerate() {
            let candidate = &setup.candidates[indices[i]];
            if candidate.imitates {
                continue;
            }
            show("timing", round * count + done as u64, time::ROUNDS * count);
            time::turn(&mut setup.bench, candidate, round, &mut rows[i].2, exec)?;
        }
    }
    Ok(())
}

/// The front of candidates: each is a time in ms and a figure of this name; NaN if unknown.
#[pyfunction]
#[pyo3(name = "front")]
pub(crate) fn front_of(metric: &str, points: Vec<(f64, f64)>) -> PyResult<Vec<usize>> {
    let loss = loss(metric).map_err(|error| value(&format!("metric {metric}; {error}")))?;
    let points: Vec<[f64; 2]> =
        points.into_iter().map(|(time, figure)| [time, (loss.of)(figure)]).collect();
    Ok(front::front(&points))
}
