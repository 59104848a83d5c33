//! Choices of a call: the camera, the method and its settings.

use crate::error::{raised, value};
use pyo3::prelude::*;
use splatref::Error;
use splatref::io::scene_file::{
    self, Choice, GroupChoice, MethodChoice, OutputSettings, SceneFile, Views,
};
use splatref::method::Method;
use splatref::setting::{Fields, Setting, Value};
use std::path::{Path, PathBuf};

/// The chosen parts of a camera, from a table `[camera]` of a scene file.
#[pyclass(frozen, module = "splatref._splatref")]
pub(crate) struct CameraChoice(pub(crate) scene_file::CameraChoice);

#[pymethods]
impl CameraChoice {
    /// Reads the text of a scene file with nothing but a camera; a camera file is read too.
    #[new]
    fn new(text: &str) -> PyResult<Self> {
        let mut file = parsed(text, Path::new(""))?;
        read_views(&mut file).map_err(raised)?;
        Ok(Self(file.camera))
    }
}

/// The number of views of a camera file.
#[pyfunction]
pub(crate) fn views(path: PathBuf) -> PyResult<usize> {
    Ok(Views::read(&path, None).map_err(raised)?.count())
}

/// A scene file with this text, and a model that does not count.
pub(crate) fn parsed(text: &str, path: &Path) -> PyResult<SceneFile> {
    // Behind the text, which may begin with keys above all tables.
    let text = format!("{text}\n[[model]]\nshape = \"sphere\"\n");
    SceneFile::parse(&text, path).map_err(|error| named(error, &text))
}

/// The error of a text that Python wrote names the key in place of the line.
fn named(error: Error, text: &str) -> PyErr {
    let Error::Format { path, what } = &error else { return raised(error) };
    let after = what.strip_prefix("line ").filter(|_| path.as_os_str().is_empty());
    let Some((number, what)) = after.and_then(|rest| rest.split_once(": ")) else {
        return raised(error);
    };
    let line = number.parse().ok().and_then(|line: usize| text.lines().nth(line - 1));
    match line.and_then(|line| line.split_once(" = ")) {
        Some((key, _)) if !what.starts_with("camera: ") => value(&format!("{key}: {what}")),
        _ => value(what),
    }
}

/// Reads the camera file that a parsed text names.
pub(crate) fn read_views(file: &mut SceneFile) -> splatref::Result<()> {
    if let Some(Views { path, view, .. }) = &file.camera.views {
        file.camera.views = Some(Views::read(path, view.clone())?);
    }
    Ok(())
}

/// What a call chooses beside its scene.
#[derive(FromPyObject)]
pub(crate) struct Choices {
    method: Option<String>,
    /// Names of settings as keyword arguments have them, and values as the command line has them.
    settings: Vec<(String, String)>,
    frame: Option<u32>,
}

/// Reads a value of a row; `None` if there is no such row.
type Read<'a> = &'a dyn Fn(&str) -> Option<Result<Value, String>>;

/// Sorts the settings into those of the method, of its groups, and of the picture.
fn sorted(settings: &[(String, String)]) -> PyResult<[Choice; 3]> {
    let mut all = [Choice::default(), Choice::default(), Choice::default()];
    for (name, text) in settings {
        let read_of_method =
            |name: &str| Method::all().into_iter().find_map(|method| method.read(name, text));
        let tables: [(Vec<Setting>, Read<'_>); 3] = [
            (MethodChoice::rows(), &read_of_method),
            (GroupChoice::rows(), &|name| GroupChoice::ALONE.read(name, text)),
            (OutputSettings::rows(), &|name| OutputSettings::default().read(name, text)),
        ];
        let mut found = false;
        for (choice, (rows, read)) in all.iter_mut().zip(tables) {
            let row = rows.into_iter().find(|row| row.option.replace('-', "_") == *name);
            if let Some((row, taken)) = row.and_then(|row| read(row.name).map(|taken| (row, taken)))
            {
                choice.push(row.name, taken.map_err(|what| value(&what))?);
                found = true;
                break;
            }
        }
        if !found {
            return Err(value(&format!("`{name}` is no setting; rows() lists them")));
        }
    }
    Ok(all)
}

impl Choices {
    /// The name of the chosen method, if one is chosen.
    pub(crate) fn named(&self) -> PyResult<Option<&'static str>> {
        let name = self.method.as_deref().map(Method::by_name).transpose().map_err(raised)?;
        Ok(name.map(|method| method.name()))
    }

    /// The scene file with these choices.
    pub(crate) fn on(
        &self,
        file: &SceneFile,
        camera: Option<&CameraChoice>,
    ) -> PyResult<SceneFile> {
        let mut file = file.clone();
        if let Some(camera) = camera {
            file.camera = camera.0.clone();
        }
        if let Some(frame) = self.frame {
            file.check_frame(frame).map_err(raised)?;
            file.frame = frame;
        }
        let name = self.named()?;
        let [method, groups, output] = sorted(&self.settings)?;
        file.choose_method(name, &method, &groups).map_err(raised)?;
        file.output = output.on(file.output, "the output").map_err(raised)?;
        Ok(file)
    }
}
