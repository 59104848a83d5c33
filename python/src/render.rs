//! Pictures: drawn, explained, written and read.

use crate::arrays::{Planes, arrays, frame, scalar};
use crate::call::{How, call};
use crate::choose::{CameraChoice, Choices};
use crate::error::{raised, value};
use crate::scene::{Content, Scene};
use crate::setup::Setup;
use glam::DVec3;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use splatref::frame::image::Values;
use splatref::frame::{Frame, Plane, Rect};
use splatref::index::seen::Seen;
use splatref::io::scene_file::{Number, OutputSettings, SceneFile, projection};
use splatref::io::{exr, extension, npy, npz, png as png_file, provenance};
use splatref::method::{Picture, Session};
use splatref::scene::{Camera, Projection};
use splatref::setting::{Fields, Word};
use splatref::splat::Tally;
use splatref::study::run::truths::Known;
use splatref::study::truth::of_points;
use std::borrow::Cow;
use std::path::PathBuf;
use std::sync::Arc;

/// What a frame saw, for the next frame of a method with temporal state.
#[pyclass(frozen, module = "splatref._splatref")]
pub(crate) struct State(Seen);

/// A picture without its planes, which are arrays of Python.
#[pyclass(frozen, module = "splatref._splatref")]
pub(crate) struct Drawn {
    setup: Arc<Setup>,
    camera: Camera,
    /// The pixels that the planes hold.
    window: Rect,
    /// Whether the planes are the projection of a region alone.
    projects: bool,
    seen: Option<Seen>,
    tally: Tally,
    times: Vec<(&'static str, f64)>,
}

/// The planes of a picture in the arithmetic that drew them.
enum Numbers {
    Single(Frame<f32>),
    Double(Frame<f64>),
}

fn draw(
    setup: &Arc<Setup>,
    session: &mut Session<'_>,
    camera: Camera,
) -> splatref::Result<(Numbers, Drawn)> {
    let (output, window) = (setup.output, session.window(&camera)?);
    output.check_part(session, &camera)?;
    let projects = session.projects(&camera);
    if output.number == Number::F64 && output.formats.keep_all() {
        let picture = session.define::<f64>(&camera, output.stages)?;
        session.resume(picture.seen.clone());
        let (frame, drawn) = parted(setup, (camera, window), projects, picture);
        return Ok((Numbers::Double(frame), drawn));
    }
    let own = match output.draw(session, &camera)? {
        Cow::Owned(picture) => Some(picture),
        Cow::Borrowed(_) => None,
    };
    // A definition leaves the state as it was; the next camera is the next frame.
    if let Some(picture) = &own {
        session.resume(picture.seen.clone());
    }
    let picture = own.or_else(|| session.take_picture());
    let picture = picture.ok_or_else(|| splatref::Error::Invalid("no picture".into()))?;
    let (frame, drawn) = parted(setup, (camera, window), projects, picture);
    Ok((Numbers::Single(frame), drawn))
}

fn parted<R>(
    setup: &Arc<Setup>,
    (camera, window): (Camera, Rect),
    projects: bool,
    picture: Picture<R>,
) -> (Frame<R>, Drawn) {
    let Picture { frame, tally, timings, seen } = picture;
    let times = timings.iter().map(|(stage, time)| (*stage, time.as_secs_f64())).collect();
    (frame, Drawn { setup: setup.clone(), camera, window, projects, seen, tally, times })
}

/// Renders a scene from each camera: the planes, and what is known about them.
#[pyfunction]
pub(crate) fn render<'py>(
    py: Python<'py>,
    how: How,
    scene: &Bound<'py, Scene>,
    cameras: Vec<Option<Bound<'py, CameraChoice>>>,
    choices: Choices,
    state: Option<Bound<'py, State>>,
    region: Option<[u32; 4]>,
) -> PyResult<Vec<(Planes<'py>, Drawn)>> {
    let cameras =
        cameras.iter().map(|one| choices.on(&scene.get().file, one.as_ref().map(Bound::get)));
    let files: Vec<SceneFile> = cameras.collect::<PyResult<_>>()?;
    let (scene, mut seen) = (scene.get(), state.map(|state| state.get().0.clone()));
    let region = region.map(|[x0, y0, x1, y1]| Rect { x0, y0, x1, y1 });
    let drawn = call(py, &how, |exec, show| {
        let mut all = Vec::new();
        let mut files = files.iter().enumerate().peekable();
        while let Some((done, file)) = files.next() {
            let setup = Arc::new(Setup::new(scene, file, region, exec, show)?);
            show("rendering", done as u64, 0);
            let mut session = setup.session(exec)?;
            session.set_region(region)?;
            session.resume(seen.take());
            all.push(draw(&setup, &mut session, setup.camera)?);
            // Further cameras use the same session if they see the same scene.
            while setup.is_shared()
                && let Some((done, file)) = files.next()
            {
                show("rendering", done as u64, 0);
                all.push(draw(&setup, &mut session, file.camera(setup.scene())?)?);
            }
            seen = all.last().and_then(|(_, drawn): &(_, Drawn)| drawn.seen.clone());
        }
        Ok(all)
    })?;
    let of = |(numbers, drawn)| {
        let planes = match numbers {
            Numbers::Single(frame) => arrays(py, frame)?,
            Numbers::Double(frame) => arrays(py, frame)?,
        };
        Ok((planes, drawn))
    };
    drawn.into_iter().map(of).collect()
}

/// The numbers of a camera.
pub(crate) fn camera_numbers<'py>(
    py: Python<'py>,
    camera: &Camera,
    offset: DVec3,
) -> PyResult<Bound<'py, PyDict>> {
    let Camera { width, height, fx, fy, cx, cy, near, .. } = *camera;
    let numbers = PyDict::new(py);
    numbers.set_item("size", (width, height))?;
    for (name, number) in [("fx", fx), ("fy", fy), ("cx", cx), ("cy", cy), ("near", near)] {
        numbers.set_item(name, f64::from(number))?;
    }
    let rows = camera.view_from_world.transpose().to_cols_array_2d();
    numbers.set_item("view_from_world", rows.map(|row| row.map(f64::from)))?;
    numbers.set_item("offset", offset.to_array())?;
    numbers.set_item("eye", (camera.eye() + offset).to_array())?;
    let perspective = matches!(camera.projection, Projection::Perspective);
    numbers.set_item("perspective", perspective)?;
    numbers.set_item("text", provenance::camera(camera, offset))?;
    Ok(numbers)
}

/// The numbers of a camera as it sees a scene.
#[pyfunction]
pub(crate) fn resolve<'py>(
    py: Python<'py>,
    how: How,
    scene: &Bound<'py, Scene>,
    camera: Option<Bound<'py, CameraChoice>>,
    choices: Choices,
) -> PyResult<Bound<'py, PyDict>> {
    let file = choices.on(&scene.get().file, camera.as_ref().map(Bound::get))?;
    let scene = scene.get();
    // The scene is not placed, which would read all surfels of a scene in parts.
    let scene = scene.content.scene();
    let camera = call(py, &how, |_, _| file.camera(scene))?;
    camera_numbers(py, &camera, scene.offset)
}

#[pymethods]
impl Drawn {
    #[getter]
    fn method(&self) -> &'static str {
        self.setup.method.name()
    }

    /// The settings of the method, and what they give in this scene, as the command line writes them.
    #[getter]
    fn settings(&self) -> Vec<(&'static str, String)> {
        let values = self.setup.method.values().into_iter();
        let mut all: Vec<_> = values.map(|(name, value)| (name, value.text())).collect();
        all.extend(self.setup.method.settings_in_scene(self.setup.scene(), &self.camera));
        all
    }

    #[getter]
    fn number(&self) -> &'static str {
        self.setup.output.number.word()
    }

    #[getter]
    fn compression(&self) -> &'static str {
        self.setup.output.compression.word()
    }

    /// Seconds of each stage.
    #[getter]
    fn times(&self) -> Vec<(&'static str, f64)> {
        self.times.clone()
    }

    /// How many surfels were drawn or not, and why.
    #[getter]
    fn tally(&self) -> [(&'static str, u64); 5] {
        let Tally { visible, behind, degenerate, back_facing, outside } = self.tally;
        [
            ("drawn", visible),
            ("behind", behind),
            ("degenerate", degenerate),
            ("back_facing", back_facing),
            ("outside", outside),
        ]
    }

    #[getter]
    fn state(&self) -> Option<State> {
        self.seen.clone().map(State)
    }

    #[getter]
    fn camera<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        camera_numbers(py, &self.camera, self.setup.scene().offset)
    }

    /// The pixels that the planes hold, x0, y0, x1, y1, and the size of the picture.
    #[getter]
    fn window(&self) -> ([u32; 4], [u32; 2]) {
        let Rect { x0, y0, x1, y1 } = self.window;
        ([x0, y0, x1, y1], self.camera.size())
    }

    /// Whether the planes are the projection of a region alone.
    #[getter]
    fn projects(&self) -> bool {
        self.projects
    }

    /// The text that a file of the picture carries.
    fn text(&self, py: Python<'_>, how: How) -> PyResult<String> {
        let Self { setup, camera, .. } = self;
        call(py, &how, |_, _| {
            let (scene, output) = (setup.scene(), setup.output);
            let whole = provenance::text(scene, setup.groups(), camera, &setup.method, output);
            Ok(match self.projects {
                true => provenance::text_of_projection(&whole, scene, output),
                false => whole,
            })
        })
    }
}

/// Makes the picture of the joined planes of a projection: its planes and its text.
#[pyfunction]
pub(crate) fn finish<'py>(
    py: Python<'py>,
    how: How,
    planes: Planes<'_>,
    text: &str,
) -> PyResult<(Planes<'py>, String)> {
    let frame = frame(&planes)?;
    let (frame, text) = call(py, &how, |exec, _| projection::finish(frame, text, exec))?;
    Ok((arrays(py, frame)?, text))
}

/// Explains every decision at a pixel.
#[pyfunction]
pub(crate) fn explain(
    py: Python<'_>,
    how: How,
    scene: &Bound<'_, Scene>,
    camera: Option<Bound<'_, CameraChoice>>,
    choices: Choices,
    pixel: (u32, u32),
) -> PyResult<String> {
    let file = choices.on(&scene.get().file, camera.as_ref().map(Bound::get))?;
    let scene = scene.get();
    call(py, &how, |exec, show| {
        let setup = Setup::new(scene, &file, None, exec, show)?;
        setup.check_kept("explain computes in f32 or f64")?;
        explained(&setup, &setup.session(exec)?, pixel)
    })
}

/// The decisions at a pixel in words.
pub(crate) fn explained(
    setup: &Setup,
    session: &Session<'_>,
    pixel: (u32, u32),
) -> splatref::Result<String> {
    match setup.output.number {
        Number::F32 => session.explain::<f32>(&setup.camera, pixel),
        Number::F64 => session.explain::<f64>(&setup.camera, pixel),
    }
}

/// The true picture of a scene, and how it was computed.
#[pyfunction]
pub(crate) fn truth<'py>(
    py: Python<'py>,
    how: How,
    scene: &Bound<'py, Scene>,
    camera: Option<Bound<'py, CameraChoice>>,
    choices: Choices,
) -> PyResult<(Planes<'py>, String)> {
    let file = choices.on(&scene.get().file, camera.as_ref().map(Bound::get))?;
    let scene = scene.get();
    let truth = call(py, &how, |exec, show| {
        let setup = Setup::new(scene, &file, None, exec, show)?;
        let camera = &setup.camera;
        match &*scene.content {
            Content::Arrays(scene) => of_points(scene, camera, &[], exec, show),
            Content::File(_) => {
                Known::about(&file, setup.scene(), exec, show)?.still(camera, exec, show)
            }
        }
    })?;
    Ok((arrays(py, truth.frame)?, truth.how.to_string()))
}

/// Writes planes into an EXR, as a part of a picture if `window` says so.
#[pyfunction]
pub(crate) fn save_exr(
    py: Python<'_>,
    how: How,
    path: PathBuf,
    planes: Planes<'_>,
    text: String,
    compression: &str,
    window: Option<([u32; 4], [u32; 2])>,
) -> PyResult<()> {
    let mut output = OutputSettings::default();
    let chosen =
        output.read("compression", compression).unwrap_or_else(|| Err("compression".into()));
    let chosen = chosen.map_err(|what| value(&what))?;
    if output.set("compression", &chosen).is_err() {
        return Err(value("compression"));
    }
    let frame = frame(&planes)?;
    let window = window.map_or_else(
        || exr::Window::whole(&frame),
        |([x0, y0, x1, y1], picture)| exr::Window { region: Rect { x0, y0, x1, y1 }, picture },
    );
    let compression = output.compression;
    call(py, &how, |exec, _| {
        exr::pending_part(&path, &frame, window, &text, compression, exec)?.put()
    })
}

/// Writes the preview of planes into a PNG.
#[pyfunction]
pub(crate) fn save_png(
    py: Python<'_>,
    how: How,
    path: PathBuf,
    planes: Planes<'_>,
) -> PyResult<()> {
    let frame = frame(&planes)?;
    call(py, &how, |_, _| png_file::write_frame(&path, &frame))
}

/// The bytes of a preview; `None` without a colour.
#[pyfunction]
pub(crate) fn png<'py>(
    py: Python<'py>,
    planes: Planes<'py>,
) -> PyResult<Option<Bound<'py, PyBytes>>> {
    let bytes = png_file::encode_frame(&frame(&planes)?).map_err(raised)?;
    Ok(bytes.map(|bytes| PyBytes::new(py, &bytes)))
}

/// The channels of a file, each as an array, and the text of an EXR.
#[pyfunction]
pub(crate) fn read<'py>(
    py: Python<'py>,
    how: How,
    path: PathBuf,
    name: &str,
) -> PyResult<(Planes<'py>, Option<String>)> {
    let image = call(py, &how, |exec, _| match extension(&path).as_deref() {
        Some("npy") => npy::read(&path, name),
        Some("npz") => npz::read(&path),
        Some("exr") => exr::read_with(&path, exec),
        _ => Err(splatref::Error::Format {
            path: path.clone(),
            what: "give an .exr, .npy or .npz".into(),
        }),
    })?;
    let (width, height) = (image.width, image.height);
    let channels = image.channels.into_iter().map(|(name, values)| {
        let array = match values {
            Values::Float(values) => scalar(py, Plane::from_values(width, height, values))?,
            Values::Index(values) => scalar(py, Plane::from_values(width, height, values))?,
        };
        Ok((name, array))
    });
    Ok((channels.collect::<PyResult<_>>()?, image.text))
}
