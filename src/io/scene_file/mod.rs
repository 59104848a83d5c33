//! Scenes as TOML: models and shapes, lights, camera, method and settings.
//!
//! A complete file:
//!
//! ```toml
#![doc = include_str!("example.toml")]
//! ```
//!
//! The tree of [`crate::source::plant`] is a model too, which the method `pyramid` draws:
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
//! A scene of objects, over a sequence of frames (see [`crate::scene::objects`]):
//!
//! ```toml
#![doc = include_str!("objects.toml")]
//! ```
//!
//! A scene with a geometry, or with a progressive model, is one of objects: its models are objects too, which come first, in order,
//! each of a geometry of its own, at rest. Its geometries are those of the models and then the named
//! ones. Where objects have no place of their own they are where their geometry is. Frames are
//! counted from 0; keys may lie beyond the last frame. A camera that is not chosen shows the scene as
//! it is in frame 0, in every frame.
//!
//! Numbers are read as f64 and rounded to f32 where the scene holds f32; any decimal that `f32`
//! prints comes back with its bits. Keys that are in none of these are refused, so that a typing
//! error is not a default.
//!
//! [`SceneFile`] is what such a file says; [`SceneFile::open`] leads from a name to a picture. One
//! PLY or OBJ file or one shape alone makes a scene file too: [`SceneFile::of_model`]. The tables of
//! settings follow from the rows of [`crate::setting`], here, on the command line and in the text of a
//! picture.

mod approximate;
mod choice;
mod draw;
mod load;
mod model;
mod objects;
mod open;
pub mod places;
mod ready;
#[cfg(test)]
mod tests;
mod text;

pub use choice::{Choice, GroupChoice, MethodChoice, Number, OutputSettings};
pub use draw::Draw;
pub use load::{Loaded, ModelReport};
pub use objects::{Geometry, MOST_FRAMES, ObjectChoice, Places};
pub use open::{FileKind, TREE, read_model, shapes};
pub use ready::Ready;

use crate::error::{Error, Result};
use crate::index::grouping::Grouping;
use crate::io::input;
use crate::method::Method;
use crate::scene::mipmap::MOST_LEVELS;
use crate::scene::objects::detail::refine::Refinement;
use crate::scene::{Camera, CameraMotion, Lens, Light, Phong, Pose, Scene, Similarity};
use crate::source::Shape;
use glam::{DVec3, Vec3};
use std::path::{Path, PathBuf};

/// How many surfels cover a shape if nobody says; a tree has [`crate::source::plant::LEAVES`].
pub const DEFAULT_COUNT: usize = 200_000;
/// The size of a picture if nobody says.
pub const DEFAULT_SIZE: [u32; 2] = [1024, 768];
/// The lens if neither a person nor a shape says: the vertical field of view in degrees.
pub const DEFAULT_FIELD_OF_VIEW: f64 = 34.0;
/// The side from which a scene is framed if nobody says: from the front, the right and above.
pub const DEFAULT_SIDE: DVec3 = DVec3::new(0.5, 0.375, 1.0);

/// What a scene file says: nothing is loaded, and what it leaves open is still open.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFile {
    /// What the scene is called: the name of the file without its extension, or of the shape.
    pub name: String,
    /// The folder of a [hierarchy](crate::io::hierarchy), which is all that the scene shows, if there is one: then there are
    /// neither models nor objects.
    pub hierarchy: Option<PathBuf>,
    /// The models; at least one if there are neither objects nor a hierarchy.
    pub models: Vec<Model>,
    /// What objects are copies of.
    pub geometries: Vec<Geometry>,
    /// The objects beside the models.
    pub objects: Vec<ObjectChoice>,
    /// How many frames there are, 1 to [`MOST_FRAMES`].
    pub frames: u32,
    /// The frame that is pictured: 0, unless somebody asks for another.
    pub frame: u32,
    /// What is drawn of progressive models.
    pub refinement: Refinement,
    /// Where it is seen from.
    pub camera: CameraChoice,
    /// The lights; none at all shows the colours unlit.
    pub lights: Vec<Light>,
    /// How surfaces answer the lights.
    pub material: Phong,
    /// What surrounds the scene; black if absent.
    pub environment: Option<EnvironmentChoice>,
    /// What is computed.
    pub method: MethodChoice,
    /// The groups, for a method that draws them.
    pub groups: GroupChoice,
    /// What is kept.
    pub output: OutputSettings,
}

/// Surfels, polygons or lines from one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Where they come from.
    pub source: Source,
    /// As what they are drawn; shapes as points, a tree as lines or polygons.
    pub draw: Draw,
    /// Where they are put.
    pub transform: Similarity,
    /// Linear RGB for all of them, in place of their own, and of a texture that their file names.
    pub color: Option<Vec3>,
    /// Opacity in [0, 1] for all of them, in place of their own; for points alone.
    pub opacity: Option<f32>,
    /// Levels of prefiltered colours that are made on loading, of the [texture](crate::source::derive) if there is one, else
    /// of [neighbours](crate::index::mipmap), of surfels as they are read, before any transform; 0 drops those of the file, which are kept if absent.
    pub mipmaps: Option<usize>,
    /// Whether the surfels are in an order of which a view draws a
    /// [prefix](crate::scene::objects::detail::prefix). A scene with such a model is one of objects.
    pub progressive: bool,
}

/// Where a model comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A PLY or an OBJ file.
    File {
        /// Where it is.
        path: PathBuf,
        /// The radius of points without one, in the file's units; derived if absent.
        radius: Option<f32>,
        /// How many of its points, the first ones; all if absent, or if there are fewer. Of an order of
        /// which every prefix is spread over the whole ([`crate::source::sampler`]), a level of detail: what is
        /// derived is derived of these points alone.
        prefix: Option<usize>,
        /// The texture, see [`crate::io::texture`]; that of the file if absent.
        texture: Option<PathBuf>,
    },
    /// A procedural shape.
    Shape {
        /// Which.
        shape: Shape,
        /// About how many surfels.
        count: usize,
        /// Of the random displacements.
        seed: u64,
    },
    /// [`crate::source::plant::apple_tree`].
    Tree {
        /// How many.
        leaves: usize,
        /// What decides its growth.
        seed: u64,
    },
}

/// A camera as far as it was chosen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraChoice {
    /// Width and height in pixels.
    pub size: Option<[u32; 2]>,
    /// See [`Pose`].
    pub eye: Option<DVec3>,
    /// See [`Pose`].
    pub target: Option<DVec3>,
    /// See [`Pose`].
    pub up: Option<DVec3>,
    /// Keys over frames, in place of these three.
    pub motion: Option<CameraMotion>,
    /// The opening.
    pub lens: Option<Lens>,
}

/// An environment as it was chosen; nothing is read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EnvironmentChoice {
    /// [`crate::scene::Environment::Sky`].
    Sky,
    /// A latitude-longitude map, see [`crate::io::environment::read`].
    File(PathBuf),
}

impl EnvironmentChoice {
    /// `sky`, or else the name of a file.
    #[must_use]
    pub fn from_text(text: &str) -> Self {
        match text {
            "sky" => Self::Sky,
            file => Self::File(file.into()),
        }
    }
}

impl SceneFile {
    /// Reads a scene file; model files are looked for in its directory.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be read, [`Error::Format`] as [`SceneFile::parse`].
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
        let text = String::from_utf8(bytes)
            .map_err(|_| Error::format(path, "not text; a scene file is TOML, which is UTF-8"))?;
        Self::parse(&text, path)
    }

    /// What the text of the scene file at `path` says; nothing is read.
    ///
    /// # Errors
    /// [`Error::Format`] with the line if it is no TOML, has an unknown key, a value of the wrong
    /// type, no model, or a number that no picture can be made with.
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        text::parse(text, path)
    }

    /// The text of a scene file at `path` that draws the same, with a line for each thing that is not as if
    /// nobody had said it. Files that are named lie beside it, or have their whole path. Which frame is pictured is not
    /// in it.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`MethodChoice::method`], or if a path is not Unicode, which TOML cannot say.
    pub fn text(&self, path: &Path) -> Result<String> {
        text::write(self, path)
    }

    /// The scene of one model, everything else left open.
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

    /// The scene of a [hierarchy](crate::io::hierarchy), everything else left open.
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
            method: MethodChoice::default(),
            groups: GroupChoice::default(),
            output: OutputSettings::default(),
        }
    }

    /// The files that loading reads, but for those that models name.
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
        let index = self.hierarchy.as_deref();
        models.chain(tables).chain(environment).chain(index)
    }

    /// Whether the scene is one of objects.
    #[must_use]
    pub fn has_objects(&self) -> bool {
        self.hierarchy.is_some()
            || !self.geometries.is_empty()
            || self.models.iter().any(|model| model.progressive)
    }

    /// The models, and those of the geometries.
    pub fn all_models(&self) -> impl Iterator<Item = &Model> {
        self.models.iter().chain(self.geometries.iter().map(|geometry| &geometry.model))
    }

    /// The same, to be changed.
    pub fn all_models_mut(&mut self) -> impl Iterator<Item = &mut Model> {
        let of_geometries = self.geometries.iter_mut().map(|geometry| &mut geometry.model);
        self.models.iter_mut().chain(of_geometries)
    }

    /// Whether there is such a frame.
    ///
    /// # Errors
    /// [`Error::Usage`] if not.
    pub fn check_frame(&self, frame: u32) -> Result<()> {
        if frame < self.frames {
            return Ok(());
        }
        Err(Error::Usage(match self.frames {
            1 => format!("frame {frame} of {}, which has no [sequence]: give 0", self.name),
            frames => format!("frame {frame} of {}: give 0 to {}", self.name, frames - 1),
        }))
    }

    /// The camera in the frame that is pictured: what was chosen, and for the rest what shows `scene`, this one when loaded.
    ///
    /// A scene of one shape that is not transformed has the shape's own pose and lens. Any other is
    /// framed from [`DEFAULT_SIDE`], see [`Camera::framing`]; where only the eye was chosen it
    /// looks at the middle of [`Scene::bounding_sphere`], where only the target was chosen it looks
    /// from [`DEFAULT_SIDE`] at a sphere of that radius around it.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Camera::new`].
    pub fn camera(&self, scene: &Scene) -> Result<Camera> {
        let CameraChoice { size, eye, target, up, ref motion, .. } = self.camera;
        let [width, height] = size.unwrap_or(DEFAULT_SIZE);
        let (shape, lens) = (self.shape(), self.lens());
        if let Some(motion) = motion {
            return Camera::new(width, height, motion.at(self.frame), lens);
        }
        if let (Some(eye), Some(target)) = (eye, target) {
            return Camera::new(
                width,
                height,
                Pose { eye, target, up: up.unwrap_or(DVec3::Y) },
                lens,
            );
        }
        let pose = match shape {
            Some(shape) => shape.default_pose(),
            None => {
                let (middle, radius) = scene.bounding_sphere();
                let target = target.unwrap_or(middle);
                let framed = Camera::framing(width, height, (target, radius), DEFAULT_SIDE, lens)?;
                if eye.is_none() && up.is_none() {
                    return Ok(framed);
                }
                Pose { eye: framed.eye(), target, up: DVec3::Y }
            }
        };
        let pose = Pose {
            eye: eye.unwrap_or(pose.eye),
            target: target.unwrap_or(pose.target),
            up: up.unwrap_or(pose.up),
        };
        Camera::new(width, height, pose, lens)
    }
}

impl SceneFile {
    /// The shape that is all there is, where it is.
    fn shape(&self) -> Option<&Shape> {
        match self.models.as_slice() {
            [Model { source: Source::Shape { shape, .. }, transform, .. }]
                if *transform == Similarity::IDENTITY && self.objects.is_empty() =>
            {
                Some(shape)
            }
            _ => None,
        }
    }

    /// The lens, see [`SceneFile::camera`].
    fn lens(&self) -> Lens {
        let own = || self.shape().map(Shape::default_lens);
        self.camera.lens.or_else(own).unwrap_or(Lens::FieldOfView(DEFAULT_FIELD_OF_VIEW))
    }

    /// The grouping that was chosen for a method; none: that of the file, or of the method.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`GroupChoice::grouping`].
    pub fn grouping(&self, method: &Method) -> Result<Option<Grouping>> {
        let default = method.grouping().filter(|_| !self.groups.settings.is_empty());
        default.map(|default| self.groups.grouping(default)).transpose()
    }
}

/// Whether an opacity for a whole model is in [0, 1].
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

/// Whether so many levels of prefiltered colours can be made for a model, or none.
///
/// # Errors
/// [`Error::Invalid`] if they cannot.
pub fn check_mipmaps(levels: usize) -> Result<()> {
    if levels <= MOST_LEVELS {
        return Ok(());
    }
    Err(Error::Invalid(format!("mipmaps of {levels} levels; give 0 to {MOST_LEVELS}")))
}

/// Whether so many points of a file can be drawn.
///
/// # Errors
/// [`Error::Invalid`] if they cannot.
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
