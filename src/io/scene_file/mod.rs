//! Describe a scene in TOML, and get from its name to a picture: models and shapes, lights, camera,
//! method and settings.
//!
//! [`SceneFile::open`] has an example that loads and draws a scene. A [`SceneFile`] holds the contents
//! of such a file; one PLY or OBJ file or one shape alone makes one too: [`SceneFile::of_model`]. This
//! is a complete file:
//!
//! ```toml
#![doc = include_str!("example.toml")]
//! ```
//!
//! # A tree as a model
//!
//! The tree of [`crate::source::plant`] is a model too, drawn by the method `pyramid`:
//!
//! ```toml
//! [[model]]
//! shape = "tree"
//! draw = "lines"                  # the default: ribbons, tubes, and triangles of the trunk; or
//!                                 # "polygons", all as triangles
//! leaves = 2000                   # 50124 if absent
//! seed = 1                        # 0 if absent
//! [method]
//! name = "pyramid"
//! ```
//!
//! # 3D Gaussians
//!
//! A scene may have one model whose file holds [3D Gaussians](crate::io::gaussians), and then no other
//! model and no object. It may have a `transform`, but no choice that applies to surfels: `radius`, `prefix`, `texture`,
//! `color_range`, `color_by`, `draw`, `color`, `opacity`, `mipmaps`, `progressive`, lights or a material.
//!
//! # Objects that move over a sequence of frames
//!
//! A scene of objects has frames (see [`crate::scene::objects`]):
//!
//! ```toml
#![doc = include_str!("objects.toml")]
//! ```
//!
//! A scene with a geometry, or with a progressive model, is a scene of objects. Its models become
//! objects too. They come first, in order, each with a geometry of its own, and do not move. The
//! geometries are the models' geometries, then the named ones. An object without a place is where
//! its geometry is. Frames are counted from 0; keys may lie beyond the last frame. Without a chosen
//! camera, every frame uses the camera that shows the scene of frame 0.
//!
//! # Points that move
//!
//! A geometry may have a file for each frame: with `%d` or `%04d` in its name, for the number of the
//! frame. `%04d` puts zeros in front, up to 4 digits; 1 to 9 digits are possible.
//!
//! ```toml
//! [[geometry]]
//! name = "cloud"
//! file = "cloud.%04d.ply"         # cloud.0000.ply in frame 0, cloud.0001.ply in frame 1
//! [[object]]
//! of = "cloud"
//! [sequence]
//! frames = 60
//! ```
//!
//! Each file is read when its frame is drawn, with the choices of the geometry. All files must have the
//! same points in the same order, because the method `deferred` remembers the points that the last frame
//! saw by their numbers, and [states](crate::io::state) name them by these numbers too. A file with
//! another number of surfels is refused, and so is one with a point that cannot be a surfel. `color_by`
//! finds the least and the greatest number of each file anew, so a colour may stand for another number in
//! another frame. `Decided:` a scene has the [hash](crate::scene::Scene::sha256) of its frame; a state has
//! the hash of frame 0. A `[[model]]` and a name on the command line always name one file.
//!
//! # Cameras of other programs
//!
//! The table `[camera]` takes intrinsics in place of `fov`, and a matrix in place of `eye`, `target`
//! and `up`; or a file that has both. [`crate::scene::camera::convention`] and
//! [`crate::scene::camera::clip`] have the formulas.
//!
//! ```toml
//! [camera]
//! size = [640, 480]
//! fx = 600                        # pixels; the intrinsics belong to this size
//! fy = 610                        # fx if absent
//! cx = 310.5                      # the middle if absent
//! cy = 245
//! near = 0.01                     # any camera may have it
//! convention = "opencv"           # or "opengl", "blender"
//! world_to_camera = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 4]] # by rows; or camera_to_world
//! # projection_matrix = [[...], [...], [...], [...]] in place of the intrinsics, beside a pose; the
//! # convention is then "opengl", "vulkan" or "d3d"
//! # far = 100                     # of another renderer; changes no picture
//! # turntable = 60                # frames of one turn around the scene
//! ```
//!
//! ```toml
//! [camera]
//! file = "transforms.json"        # or a COLMAP folder, or an .exr: see [`crate::io::cameras`]
//! view = "r_12"                   # or a number; without it, each view is a frame
//! ```
//!
//! The table that [`crate::io::provenance::camera`] writes, with `projection`, `f`, `c`,
//! `view_from_world` and, for an eye of a stereo pair, `other_eye`, gives the same camera bit for bit.
//!
//! # Numbers and keys
//!
//! Numbers are read as f64, and rounded to f32 where the scene holds f32; any decimal that `f32`
//! prints comes back with its bits. Unknown keys are refused, so that a misspelt key does not
//! become a default.
//!
//! The tables of settings follow from the rows of [`crate::setting`], here, on the command line and
//! in the text of a picture.

mod approximate;
mod camera;
mod choice;
mod draw;
mod file_sequence;
mod gaussians;
mod geometries;
mod load;
mod model;
mod objects;
mod offset;
mod open;
mod parts;
pub mod places;
pub mod projection;
mod ready;
#[cfg(test)]
mod tests;
mod text;
mod views;

pub use camera::{CameraChoice, Matrices};
pub use choice::{Choice, GroupChoice, MethodChoice, Number, OutputSettings};
pub use draw::Draw;
pub use load::{GaussianReport, Loaded, ModelReport};
pub use model::Colored;
pub use objects::{Geometry, ObjectChoice, Places};
pub use open::{FileKind, TREE, read_model, read_properties, shapes};
pub use ready::Ready;
pub use views::Views;

use crate::error::{Error, Result};
use crate::index::grouping::Grouping;
pub use crate::io::cameras::MOST_FRAMES;
use crate::io::input;
use crate::method::Method;
use crate::scene::mipmap::MOST_LEVELS;
use crate::scene::objects::detail::refine::Refinement;
use crate::scene::{Light, Phong, Similarity};
use crate::source::Shape;
use glam::{DVec3, Vec3};
use std::path::{Path, PathBuf};

/// The default number of surfels of a shape; a tree has [`crate::source::plant::LEAVES`] leaves.
pub const DEFAULT_COUNT: usize = 200_000;
/// The default size of a picture.
pub const DEFAULT_SIZE: [u32; 2] = [1024, 768];
/// The default lens for scenes other than a single shape: the vertical field of view in degrees.
pub const DEFAULT_FIELD_OF_VIEW: f64 = 34.0;
/// The default side from which a scene is framed: from the front, the right and above.
pub const DEFAULT_SIDE: DVec3 = DVec3::new(0.5, 0.375, 1.0);

/// The contents of a scene file. Nothing is loaded yet, and defaults are still open.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFile {
    /// The name of the scene: the name of the file without its extension, or of the shape.
    pub name: String,
    /// The folder of a [hierarchy](crate::io::hierarchy). If there is one, the scene has neither
    /// models nor objects.
    pub hierarchy: Option<PathBuf>,
    /// The models; at least one if there are neither objects nor a hierarchy.
    pub models: Vec<Model>,
    /// The geometries that objects are copies of.
    pub geometries: Vec<Geometry>,
    /// The objects beside the models.
    pub objects: Vec<ObjectChoice>,
    /// The number of frames, 1 to [`MOST_FRAMES`].
    pub frames: u32,
    /// The frame to draw; 0 by default.
    pub frame: u32,
    /// Which levels of progressive models are drawn.
    pub refinement: Refinement,
    /// The camera.
    pub camera: CameraChoice,
    /// The lights; without any, colours are shown unlit.
    pub lights: Vec<Light>,
    /// How surfaces reflect the lights.
    pub material: Phong,
    /// The surroundings of the scene; black if absent.
    pub environment: Option<EnvironmentChoice>,
    /// The EXR with the opaque geometry of the view, see [`crate::io::surface::read`].
    pub surface: Option<PathBuf>,
    /// The method and its settings.
    pub method: MethodChoice,
    /// How groups are made, for a method that draws groups.
    pub groups: GroupChoice,
    /// What is stored of a picture.
    pub output: OutputSettings,
}

/// Surfels, polygons or lines from one source.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The source.
    pub source: Source,
    /// The primitives to draw; shapes are drawn as points, a tree as lines or polygons.
    pub draw: Draw,
    /// The place of the model.
    pub transform: Similarity,
    /// Linear RGB for all of it, in place of its own colours and of a texture that its file names.
    pub color: Option<Vec3>,
    /// Opacity in [0, 1] for all of it, in place of its own; only for points.
    pub opacity: Option<f32>,
    /// Number of levels of prefiltered colours to make on loading. They come from the
    /// [texture](crate::source::derive) if there is one, else from
    /// [neighbours](crate::index::mipmap), for the surfels as they are read, before any transform.
    /// 0 drops the levels of the file; `None` keeps them.
    pub mipmaps: Option<usize>,
    /// Whether the surfels are ordered so that a view can draw a
    /// [prefix](crate::scene::objects::detail::prefix) of them. A scene with such a model is a
    /// scene of objects.
    pub progressive: bool,
}

/// The source of a model.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A PLY, OBJ, LAS, LAZ or E57 file, or a folder of [blocks](crate::io::blocks).
    File {
        /// The path of the file.
        path: PathBuf,
        /// The radius of points without one, in the file's units; derived if absent.
        radius: Option<f32>,
        /// How many of its points to use, from the first on; all if absent, or if there are fewer.
        /// If every prefix of the order covers the whole ([`crate::source::sampler`]), this is a
        /// level of detail. Derived attributes are derived from these points alone.
        prefix: Option<usize>,
        /// The texture, see [`crate::io::texture`]; the file's own if absent.
        texture: Option<PathBuf>,
        /// The code of white of the colours in a PLY or LAS, see
        /// [`crate::io::ply::ReadOptions::color_range`].
        color_range: Option<f64>,
        /// The number of each point that replaces its colour by a colour of
        /// [viridis](crate::source::viridis): `x`, `y`, `z` or a property of the file.
        color_by: Option<String>,
    },
    /// A procedural shape.
    Shape {
        /// The shape.
        shape: Shape,
        /// Approximate number of surfels.
        count: usize,
        /// Random seed of the displacements.
        seed: u64,
    },
    /// [`crate::source::plant::apple_tree`].
    Tree {
        /// Number of leaves.
        leaves: usize,
        /// Random seed of its growth.
        seed: u64,
    },
}

/// The chosen environment; nothing is read yet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EnvironmentChoice {
    /// [`crate::scene::Environment::Sky`].
    Sky,
    /// A latitude-longitude map, see [`crate::io::environment::read`].
    File(PathBuf),
}

impl EnvironmentChoice {
    /// `sky`, or the name of a file.
    #[must_use]
    pub fn from_text(text: &str) -> Self {
        match text {
            "sky" => Self::Sky,
            file => Self::File(file.into()),
        }
    }
}

impl SceneFile {
    /// Reads a scene file, and the camera file that it names; paths are relative to its folder.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be read, [`Error::Format`] as [`SceneFile::parse`], and as
    /// [`Views::read`].
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
        let text = String::from_utf8(bytes)
            .map_err(|_| Error::format(path, "not text; a scene file is TOML, which is UTF-8"))?;
        let mut file = Self::parse(&text, path)?;
        if let Some(views) = &mut file.camera.views {
            views.load()?;
        }
        Ok(file)
    }

    /// Parses the text of the scene file at `path`; no other file is read.
    ///
    /// # Errors
    /// [`Error::Format`] with the line if the text is no TOML, has an unknown key, a value of the
    /// wrong type, no model, or a number that no picture can be made with.
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        text::parse(text, path)
    }

    /// The text of a scene file at `path` that draws the same picture. Only settings that differ
    /// from their defaults have a line. Paths are relative if the file lies in the folder of `path`
    /// or below, and absolute otherwise. The frame to draw is not in the text.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`MethodChoice::method`], or if a path is not Unicode, because TOML
    /// cannot hold it.
    pub fn text(&self, path: &Path) -> Result<String> {
        text::write(self, path)
    }

    /// A scene of one model, with all other choices left open.
    #[must_use]
    pub fn of_model(source: Source) -> Self {
        let model = Model {
            draw: Draw::default_for(&source),
            source,
            transform: Similarity::IDENTITY,
            color: None,
            opacity: None,
            mipmaps: None,
            progressive: false,
        };
        Self { models: vec![model.clone()], ..Self::of_nothing(model.source.name()) }
    }

    /// A scene of a [hierarchy](crate::io::hierarchy), with all other choices left open.
    #[must_use]
    pub fn of_hierarchy(folder: &Path) -> Self {
        Self { hierarchy: Some(folder.to_owned()), ..Self::of_nothing(stem(folder)) }
    }

    fn of_nothing(name: String) -> Self {
        Self {
            name,
            hierarchy: None,
            models: Vec::new(),
            geometries: Vec::new(),
            objects: Vec::new(),
            frames: 1,
            frame: 0,
            refinement: Refinement::default(),
            camera: CameraChoice::default(),
            lights: vec![Light::DEFAULT],
            material: Phong::default(),
            environment: None,
            surface: None,
            method: MethodChoice::default(),
            groups: GroupChoice::default(),
            output: OutputSettings::default(),
        }
    }

    /// The files that loading reads, except those that model files name, and except the files of
    /// [frames](SceneFile::reads_in_some_frame).
    pub fn reads(&self) -> impl Iterator<Item = &Path> {
        let models = self.all_models().flat_map(|model| match &model.source {
            Source::File { path, texture, .. } => [Some(path.as_path()), texture.as_deref()],
            Source::Shape { .. } | Source::Tree { .. } => [None; 2],
        });
        let models = models.flatten();
        let tables = self.objects.iter().filter_map(|object| match &object.places {
            Places::Table { path, .. } => Some(path.as_path()),
            Places::One(_) | Places::Scatter { .. } => None,
        });
        let environment = self.environment.iter().filter_map(|environment| match environment {
            EnvironmentChoice::File(path) => Some(path.as_path()),
            EnvironmentChoice::Sky => None,
        });
        let cameras = self.camera.views.iter().map(|views| views.path.as_path());
        let (index, surface) = (self.hierarchy.as_deref(), self.surface.as_deref());
        models.chain(tables).chain(environment).chain(cameras).chain(index).chain(surface)
    }

    /// Whether a canonical path is the file of some frame of a geometry that has a file for each frame.
    #[must_use]
    pub fn reads_in_some_frame(&self, path: &Path) -> bool {
        let files = self.geometries.iter().filter_map(|geometry| geometry.files().ok().flatten());
        files.into_iter().any(|files| files.has(path))
    }

    /// Whether this is a scene of objects.
    #[must_use]
    pub fn has_objects(&self) -> bool {
        self.hierarchy.is_some()
            || !self.geometries.is_empty()
            || self.models.iter().any(|model| model.progressive)
    }

    /// All models, including the models of the geometries.
    pub fn all_models(&self) -> impl Iterator<Item = &Model> {
        self.models.iter().chain(self.geometries.iter().map(|geometry| &geometry.model))
    }

    /// All models, for changes.
    pub fn all_models_mut(&mut self) -> impl Iterator<Item = &mut Model> {
        let of_geometries = self.geometries.iter_mut().map(|geometry| &mut geometry.model);
        self.models.iter_mut().chain(of_geometries)
    }

    /// The number of frames: of the turntable, else one a view of a camera file from which no view
    /// is chosen, else [`SceneFile::frames`].
    #[must_use]
    pub fn frame_count(&self) -> u32 {
        self.camera.frames().unwrap_or(self.frames)
    }

    /// Checks that the scene has a frame with this number.
    ///
    /// # Errors
    /// [`Error::Usage`] if it has not.
    pub fn check_frame(&self, frame: u32) -> Result<()> {
        if frame < self.frame_count() {
            return Ok(());
        }
        Err(Error::Usage(match self.frame_count() {
            1 => format!("frame {frame} of {}, which has no [sequence]: give 0", self.name),
            frames => format!("frame {frame} of {}: give 0 to {}", self.name, frames - 1),
        }))
    }

    /// The chosen grouping for a method. `None` leaves the choice to the scene's file or to the
    /// method.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`GroupChoice::grouping`].
    pub fn grouping(&self, method: &Method) -> Result<Option<Grouping>> {
        let default = method.grouping().filter(|_| !self.groups.settings.is_empty());
        default.map(|default| self.groups.grouping(default)).transpose()
    }
}

/// Checks that an opacity for a whole model is in [0, 1].
///
/// # Errors
/// [`Error::Invalid`] if it is not.
pub fn check_opacity(opacity: f32) -> Result<()> {
    if (0.0..=1.0).contains(&opacity) {
        Ok(())
    } else {
        Err(Error::Invalid(format!("an opacity of {opacity}; give 0 to 1")))
    }
}

/// Checks that a model can have this number of levels of prefiltered colours, or none.
///
/// # Errors
/// [`Error::Invalid`] if it cannot.
pub fn check_mipmaps(levels: usize) -> Result<()> {
    if levels <= MOST_LEVELS {
        return Ok(());
    }
    Err(Error::Invalid(format!("mipmaps of {levels} levels; give 0 to {MOST_LEVELS}")))
}

/// Checks that a prefix of this many points can be drawn.
///
/// # Errors
/// [`Error::Invalid`] if it cannot.
pub fn check_prefix(points: usize) -> Result<()> {
    if points > 0 {
        return Ok(());
    }
    Err(Error::Invalid("a prefix of 0 points; give at least 1".into()))
}

/// The name of a file without its extension.
fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy().into_owned())
}
