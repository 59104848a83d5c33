//! Scenes: from files and shapes, or from arrays.

use crate::arrays::{check, numbers, vectors};
use crate::call::{How, call};
use crate::choose::{parsed, read_views};
use crate::error::raised;
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use splatref::frame::Exec;
use splatref::io::scene_file::{EnvironmentChoice, Loaded, SceneFile};
use splatref::io::{environment, surface};
use splatref::memory;
use splatref::scene::gaussians::{Encoding, UNDRAWABLE, coefficients};
use splatref::scene::{self, Cloud, Environment, GaussianArrays, Gaussians, Groups, Sphere};
use splatref::source::derive::{self, Derive};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// What was loaded or given.
pub(crate) enum Content {
    File(Box<Loaded>),
    Arrays(Box<scene::Scene>),
}

impl Content {
    pub(crate) fn scene(&self) -> &scene::Scene {
        match self {
            Self::File(loaded) => &loaded.scene,
            Self::Arrays(scene) => scene,
        }
    }
}

/// A scene in memory, and its file.
#[pyclass(frozen, module = "splatref._splatref")]
pub(crate) struct Scene {
    pub(crate) file: SceneFile,
    pub(crate) content: Arc<Content>,
    /// All of a scene in parts, once a method needs it.
    whole: Mutex<Option<Arc<Content>>>,
    /// The groups of the last method that drew groups, and how they were made.
    pub(crate) groups: Mutex<Option<(String, Groups)>>,
    #[pyo3(get)]
    warnings: Vec<String>,
    #[pyo3(get)]
    dropped: String,
}

/// The bytes of a point in the arrays of a scene, and in those of the work that checks it.
const POINT: u64 = 3 * (12 + 12 + 4);

/// The arrays of points.
#[derive(FromPyObject)]
pub(crate) struct Points<'py> {
    positions: PyReadonlyArray2<'py, f32>,
    normals: Option<PyReadonlyArray2<'py, f32>>,
    radii: Option<PyReadonlyArray1<'py, f32>>,
    colors: Option<PyReadonlyArray2<'py, f32>>,
    opacities: Option<PyReadonlyArray1<'py, f32>>,
    tangents: Option<PyReadonlyArray3<'py, f32>>,
}

impl Points<'_> {
    /// Copies the arrays, the one copy that is made.
    fn cloud(&self) -> PyResult<Cloud> {
        let count = self.positions.shape()[0];
        let what = || format!("a scene of {count} points");
        memory::ask((count as u64).saturating_mul(POINT), what).map_err(raised)?;
        let tangents = self.tangents.as_ref().map(|tangents| {
            check(tangents)?;
            let tangents = tangents.as_array();
            let half = |i, j| glam::Vec3::from_array([0, 1, 2].map(|k| tangents[[i, j, k]]));
            Ok::<_, PyErr>((0..tangents.shape()[0]).map(|i| [half(i, 0), half(i, 1)]).collect())
        });
        let tangents = tangents.transpose()?;
        Ok(Cloud {
            position: vectors(&self.positions)?,
            normal: self.normals.as_ref().map(vectors).transpose()?,
            radius: self.radii.as_ref().map(numbers).transpose()?,
            color: self.colors.as_ref().map(vectors).transpose()?,
            opacity: self.opacities.as_ref().map(numbers).transpose()?,
            tangents,
            ..Cloud::default()
        })
    }
}

/// The arrays of Gaussians.
#[derive(FromPyObject)]
pub(crate) struct Splats<'py> {
    positions: PyReadonlyArray2<'py, f32>,
    scales: PyReadonlyArray2<'py, f32>,
    rotations: PyReadonlyArray2<'py, f32>,
    opacities: PyReadonlyArray1<'py, f32>,
    harmonics: PyReadonlyArray2<'py, f32>,
    degree: u32,
    linear: bool,
}

impl Splats<'_> {
    /// Copies the arrays, the one copy that is made. Coefficients stand one below the other.
    fn arrays(&self) -> PyResult<GaussianArrays> {
        let count = self.positions.shape()[0] as u64;
        let each = 2 * (12 + 12 + 16 + 4 + 12 * coefficients(self.degree) as u64);
        let what = || format!("a scene of {count} Gaussians");
        memory::ask(count.saturating_mul(each), what).map_err(raised)?;
        check(&self.rotations)?;
        let rotations = self.rotations.as_array();
        Ok(GaussianArrays {
            position: vectors(&self.positions)?,
            scale: vectors(&self.scales)?,
            rotation: rotations.rows().into_iter().map(|q| [q[0], q[1], q[2], q[3]]).collect(),
            opacity: numbers(&self.opacities)?,
            degree: self.degree,
            harmonics: vectors(&self.harmonics)?,
            encoding: if self.linear { Encoding::Linear } else { Encoding::Srgb },
        })
    }
}

/// Loads a scene file. In parts, of a folder of blocks nothing is read except its index.
fn of_file(py: Python<'_>, how: &How, file: SceneFile, parts: bool) -> PyResult<Scene> {
    let load = if parts { SceneFile::load_outlined } else { SceneFile::load_for_views };
    let loaded = call(py, how, |exec, show| load(&file, exec, show))?;
    let dropped = loaded.dropped.reasons();
    let warnings = loaded.warnings.clone();
    Ok(Scene::of(file, Content::File(Box::new(loaded)), warnings, dropped))
}

impl Scene {
    fn of(file: SceneFile, content: Content, warnings: Vec<String>, dropped: String) -> Self {
        let (whole, groups) = (Mutex::default(), Mutex::default());
        Self { file, content: Arc::new(content), whole, groups, warnings, dropped }
    }

    /// All of a scene in parts, read once.
    pub(crate) fn whole(&self, exec: &Exec) -> splatref::Result<Arc<Content>> {
        let mut whole = self.whole.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(whole) = &*whole {
            return Ok(whole.clone());
        }
        let loaded = self.file.load_for_views(exec, &|_, _, _| ())?;
        Ok(whole.insert(Arc::new(Content::File(Box::new(loaded)))).clone())
    }
}

/// The environment that a scene file chooses.
fn environment(file: &SceneFile, exec: &Exec) -> splatref::Result<Option<Environment>> {
    match &file.environment {
        None => Ok(None),
        Some(EnvironmentChoice::Sky) => Ok(Some(Environment::Sky)),
        Some(EnvironmentChoice::File(path)) => environment::read(path, exec).map(Some),
    }
}

#[pymethods]
impl Scene {
    /// Opens a scene by its name. In parts, it can only be drawn.
    #[staticmethod]
    fn open(
        py: Python<'_>,
        how: How,
        name: PathBuf,
        count: Option<usize>,
        seed: Option<u64>,
        parts: bool,
    ) -> PyResult<Self> {
        let file = SceneFile::open_with(name, count, seed).map_err(raised)?;
        of_file(py, &how, file, parts)
    }

    /// Parses the text of a scene file; `path` is where it would stand.
    #[staticmethod]
    fn parse(py: Python<'_>, how: How, text: &str, path: PathBuf) -> PyResult<Self> {
        let mut file = SceneFile::parse(text, &path).map_err(raised)?;
        read_views(&mut file).map_err(raised)?;
        of_file(py, &how, file, false)
    }

    /// Takes arrays. `text` has the lights, the material and the environment as a scene file.
    #[staticmethod]
    fn arrays(
        py: Python<'_>,
        how: How,
        text: &str,
        unlit: bool,
        name: String,
        points: Points<'_>,
    ) -> PyResult<Self> {
        let mut file = parsed(text, &PathBuf::new())?;
        if unlit {
            file.lights.clear();
        }
        file.models.clear();
        file.name = name;
        let cloud = points.cloud()?;
        drop(points);
        let (scene, dropped) = call(py, &how, |exec, show| {
            let (surfels, derived) = derive::surfels(cloud, &Derive::default(), exec, show)?;
            let environment = environment(&file, exec)?;
            let scene = scene::Scene {
                lights: file.lights.clone(),
                material: file.material,
                environment,
                ..scene::Scene::unlit(&file.name, surfels)
            };
            Ok((scene, derived.dropped.reasons()))
        })?;
        Ok(Self::of(file, Content::Arrays(Box::new(scene)), Vec::new(), dropped))
    }

    /// Takes arrays of Gaussians. `text` has the environment and the surface as a scene file.
    #[staticmethod]
    fn of_gaussians(
        py: Python<'_>,
        how: How,
        text: &str,
        name: String,
        splats: Splats<'_>,
    ) -> PyResult<Self> {
        let mut file = parsed(text, &PathBuf::new())?;
        file.models.clear();
        file.lights.clear();
        file.name = name;
        let arrays = splats.arrays()?;
        drop(splats);
        let (scene, dropped) = call(py, &how, |exec, _| {
            let (gaussians, dropped) = Gaussians::new(arrays)?;
            let environment = environment(&file, exec)?;
            let surface = file.surface.as_deref().map(|path| surface::read(path, exec));
            let surface = surface.transpose()?;
            let bare = scene::Scene::of_gaussians(&file.name, gaussians);
            let scene = scene::Scene { environment, surface, ..bare };
            let reasons = || format!("{dropped} Gaussians with {UNDRAWABLE}");
            Ok((scene, if dropped == 0 { String::new() } else { reasons() }))
        })?;
        Ok(Self::of(file, Content::Arrays(Box::new(scene)), Vec::new(), dropped))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.file.name
    }

    /// The number of surfels or Gaussians; of a scene of objects, those of all objects.
    #[getter]
    fn surfels(&self) -> u64 {
        let scene = self.content.scene();
        let of_objects = scene.objects.as_ref().map(scene::Objects::drawn_total);
        let gaussians = scene.gaussians.as_ref().map(|gaussians| gaussians.len() as u64);
        of_objects.or(gaussians).unwrap_or(scene.surfels.len() as u64)
    }

    /// The number of triangles and lines.
    #[getter]
    fn primitives(&self) -> usize {
        let scene::Counts { triangles, ribbons, tubes } = self.content.scene().primitives.counts();
        triangles + ribbons + tubes
    }

    #[getter]
    fn frames(&self) -> u32 {
        self.file.frame_count()
    }

    /// The middle and the radius of a sphere around the scene.
    #[getter]
    fn bounds(&self) -> ([f64; 3], f64) {
        let Sphere { center: middle, radius } = self.content.scene().bounding_sphere();
        (middle.to_array(), radius)
    }

    #[getter]
    fn median_radius(&self) -> f32 {
        self.content.scene().surfels.median_radius()
    }

    /// The arrays of the surfels as they are drawn; `None` where there are none.
    fn surfel_arrays<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Vec<(&'static str, Bound<'py, PyAny>)>> {
        use numpy::{PyArray1, PyArrayMethods};
        let surfels = &self.content.scene().surfels;
        let vectors = |all: &[glam::Vec3]| -> PyResult<Bound<'py, PyAny>> {
            let flat: Vec<f32> = all.iter().flat_map(|v| v.to_array()).collect();
            Ok(PyArray1::from_vec(py, flat).reshape([all.len(), 3])?.into_any())
        };
        let numbers = |all: &[f32]| PyArray1::from_slice(py, all).into_any();
        let mut all = vec![
            ("positions", vectors(surfels.position())?),
            ("normals", vectors(surfels.normal())?),
            ("radii", numbers(surfels.radius())),
        ];
        if let Some(colors) = surfels.color() {
            all.push(("colors", vectors(colors)?));
        }
        if let Some(opacities) = surfels.opacity() {
            all.push(("opacities", numbers(opacities)));
        }
        if let Some(tangents) = surfels.tangents() {
            let flat: Vec<f32> = tangents.iter().flatten().flat_map(|v| v.to_array()).collect();
            let array = PyArray1::from_vec(py, flat).reshape([tangents.len(), 2, 3])?;
            all.push(("tangents", array.into_any()));
        }
        Ok(all)
    }
}
