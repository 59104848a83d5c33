//! Open a scene by its name.

use super::{DEFAULT_COUNT, SceneFile, Source};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::io::blocks::Blocks;
use crate::io::hierarchy::Hierarchy;
use crate::io::ply::ReadOptions;
use crate::io::{extension, input, las, obj, ply};
use crate::scene::{Cloud, Property};
use crate::source::{Shape, plant};
use std::path::Path;

/// The name of the tree of [`crate::source::plant`].
pub const TREE: &str = "tree";

/// The names of everything that needs no file: [`Shape::ALL`] and [`TREE`].
#[must_use]
pub fn shapes() -> String {
    let names: Vec<&str> = Shape::ALL.iter().map(Shape::name).chain([TREE]).collect();
    names.join(", ")
}

/// The kind of a file, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A point cloud or a mesh.
    Ply,
    /// A mesh or points as text.
    Obj,
    /// A point cloud, LAS or LAZ.
    Las,
    /// Scans.
    E57,
    /// 3D Gaussians: glTF, GLB, .splat and SPZ. A PLY may hold them too.
    Gaussians,
    /// A folder of [blocks](crate::io::blocks).
    Blocks,
    /// A scene file.
    Toml,
    /// A picture.
    Exr,
}

/// Reads the model at `path` by its extension; without a known one, as a PLY. Its texture is not
/// read, see [`crate::io::texture::paint`]. An OBJ takes no options, and an E57 no colour range.
///
/// # Errors
/// As [`obj::read`], [`las::read`], `e57::read`, [`Blocks::read`] and [`ply::read_with`]; [`Error::Format`] for files of
/// 3D Gaussians.
pub fn read_model(path: &Path, options: &ReadOptions, exec: &Exec) -> Result<Cloud> {
    match FileKind::from_extension(path) {
        Ok(FileKind::Obj) => obj::read(path),
        Ok(FileKind::Las) => las::read(path, options),
        Ok(FileKind::E57) => e57(path, options),
        Ok(FileKind::Blocks) => Blocks::open(path)?.read(),
        Ok(FileKind::Gaussians) => Err(Error::format(
            path,
            "the file holds 3D Gaussians, which only `--method gaussians` draws; give a point cloud \
             or a mesh",
        )),
        Ok(FileKind::Ply | FileKind::Toml | FileKind::Exr) | Err(_) => {
            ply::read_with(path, options, exec)
        }
    }
}

#[cfg(feature = "cli")]
fn e57(path: &Path, options: &ReadOptions) -> Result<Cloud> {
    crate::io::e57::read(path, options)
}

#[cfg(not(feature = "cli"))]
fn e57(path: &Path, _: &ReadOptions) -> Result<Cloud> {
    Err(Error::format(path, "E57 is read with the feature `cli` of this crate only"))
}

/// Gives the cloud that [`read_model`] read from `path` exactly the further properties with these
/// names, in this order.
///
/// # Errors
/// [`Error::Format`] as [`ply::properties`] for a PLY; for other files, if they have no such
/// property.
pub fn read_properties(path: &Path, names: &[String], cloud: &mut Cloud) -> Result<()> {
    let there = std::mem::take(&mut cloud.properties);
    cloud.properties = match FileKind::from_extension(path) {
        Ok(
            FileKind::Obj | FileKind::Las | FileKind::E57 | FileKind::Gaussians | FileKind::Blocks,
        ) => names.iter().map(|name| named(path, name, &there)).collect::<Result<_>>()?,
        Ok(FileKind::Ply | FileKind::Toml | FileKind::Exr) | Err(_) => {
            ply::properties(path, names)?
        }
    };
    Ok(())
}

/// The property with this name.
fn named(path: &Path, name: &str, there: &[Property]) -> Result<Property> {
    let found = there.iter().find(|property| property.name == name).cloned();
    found.ok_or_else(|| {
        let all: Vec<&str> = there.iter().map(|property| property.name.as_str()).collect();
        let all = if all.is_empty() { "no properties".into() } else { all.join(", ") };
        let name = name.escape_debug();
        Error::format(path, format!("there is no property `{name}`; the file has {all}"))
    })
}

/// The number of each point by which [`Source::File`] colours a model: a coordinate of the file for
/// `x`, `y` and `z`, otherwise a property of the cloud that [`read_model`] read from `path`. Also
/// what is to be added to the numbers.
///
/// # Errors
/// [`Error::Format`] if there is no such number.
pub(super) fn read_number(path: &Path, name: &str, cloud: &Cloud) -> Result<(Vec<f32>, f64)> {
    if let Some(axis) = ["x", "y", "z"].iter().position(|axis| *axis == name) {
        return Ok((cloud.position.iter().map(|p| p[axis]).collect(), cloud.offset[axis]));
    }
    let property = match FileKind::from_extension(path) {
        Ok(
            FileKind::Obj | FileKind::Las | FileKind::E57 | FileKind::Gaussians | FileKind::Blocks,
        ) => named(path, name, &cloud.properties)?,
        Ok(FileKind::Ply | FileKind::Toml | FileKind::Exr) | Err(_) => ply::number(path, name)?,
    };
    Ok((property.values, 0.0))
}

impl FileKind {
    /// Whether files of this kind hold a model.
    #[must_use]
    pub fn is_model(self) -> bool {
        match self {
            Self::Ply | Self::Obj | Self::Las | Self::E57 | Self::Gaussians | Self::Blocks => true,
            Self::Toml | Self::Exr => false,
        }
    }

    /// The kind of the file at `path`.
    ///
    /// # Errors
    /// [`Error::Usage`] if the extension is unknown.
    pub fn from_extension(path: &Path) -> Result<Self> {
        match extension(path).as_deref() {
            Some("ply") => Ok(Self::Ply),
            Some("obj") => Ok(Self::Obj),
            Some("las" | "laz") => Ok(Self::Las),
            Some("e57") => Ok(Self::E57),
            Some("gltf" | "glb" | "splat" | "spz") => Ok(Self::Gaussians),
            Some("toml") => Ok(Self::Toml),
            Some("exr") => Ok(Self::Exr),
            _ if Blocks::is_in(path) => Ok(Self::Blocks),
            _ => Err(Error::Usage(match input::no_file(path) {
                Some(what) => format!("{}: {what}", path.display()),
                None => format!(
                    "{}: unknown kind of file; give a .ply, .obj, .las, .laz, .e57, .glb, .gltf, \
                     .splat or .spz, a scene .toml, an .exr, or a shape: {}",
                    path.display(),
                    shapes()
                ),
            })),
        }
    }
}

impl Source {
    /// The procedural source with this name: a shape of about [`DEFAULT_COUNT`] surfels, or
    /// [`TREE`].
    #[must_use]
    pub fn procedural(name: &str) -> Option<Self> {
        if name == TREE {
            return Some(Self::Tree { leaves: plant::LEAVES, seed: 0 });
        }
        Shape::by_name(name).map(|shape| Self::Shape { shape, count: DEFAULT_COUNT, seed: 0 })
    }
}

impl SceneFile {
    /// [`SceneFile::open`] with another number of surfels, and another random seed. Only shapes have
    /// these, by name or as the one model of a scene file; the count of a tree is its leaves.
    ///
    /// # Errors
    /// As [`SceneFile::open`], and [`Error::Usage`] if the scene has no count or seed.
    pub fn open_with(
        name: impl AsRef<Path>,
        count: Option<usize>,
        seed: Option<u64>,
    ) -> Result<Self> {
        let mut file = Self::open(name)?;
        if count.is_none() && seed.is_none() {
            return Ok(file);
        }
        let mut models = file.all_models_mut();
        match (models.next().map(|model| &mut model.source), models.next()) {
            (
                Some(
                    Source::Shape { count: items, seed: number, .. }
                    | Source::Tree { leaves: items, seed: number },
                ),
                None,
            ) => {
                *items = count.unwrap_or(*items);
                *number = seed.unwrap_or(*number);
            }
            _ => {
                let what = "--count and --seed apply to a procedural shape, or to a scene file \
                            whose one model is such a shape; remove them";
                return Err(Error::Usage(what.into()));
            }
        }
        drop(models);
        Ok(file)
    }

    /// Opens a scene by its name: a shape, `tree`, a file of a model, a scene .toml or the folder of
    /// a [hierarchy](crate::io::hierarchy) or of [blocks](crate::io::blocks). This example gets from a name to a picture in memory:
    /// ```
    /// use splatref::frame::{Exec, Samples};
    /// use splatref::io::scene_file::SceneFile;
    ///
    /// let exec = Exec::new(0, 32)?;
    /// let mut file = SceneFile::open("torus")?; // or "bunny.ply", or "scene.toml"
    /// file.camera.size = Some([64, 48]);
    /// # file.models[0].source = splatref::io::scene_file::Source::Shape {
    /// #     shape: splatref::source::Shape::Torus, count: 2000, seed: 0 };
    /// let ready = file.ready(&exec, &|_, _, _| ())?;
    /// let (mut session, _) = ready.session(&exec, &|_, _, _| ())?;
    /// let picture = session.render(&ready.camera)?;
    ///
    /// let Some(Samples::Scalar(depth)) = picture.frame.plane("Z") else { unreachable!() };
    /// assert!(depth.values().iter().any(|depth| depth.is_finite()), "the torus is in sight");
    /// # Ok::<(), splatref::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Usage`] if the name is neither a shape nor a scene, or is a shape and a folder of surfels;
    /// else as [`SceneFile::read`]. The model itself is not read yet.
    pub fn open(name: impl AsRef<Path>) -> Result<Self> {
        let path = name.as_ref();
        if let Some(source) = path.to_str().and_then(Source::procedural) {
            if Hierarchy::is_in(path) || Blocks::is_in(path) {
                return Err(Error::Usage(format!(
                    "{0}: this is the name of a shape and of a folder of surfels; give ./{0} for the \
                     folder, or rename it",
                    path.display()
                )));
            }
            return Ok(Self::of_model(source));
        }
        if Hierarchy::is_in(path) {
            return Ok(Self::of_hierarchy(path));
        }
        let kind = FileKind::from_extension(path);
        if kind.is_err() && path.is_dir() {
            return Err(Error::Usage(format!(
                "{}: this is a directory without surfels; give a file, or a folder that `splatref tile` \
                 or `splatref surfels` wrote",
                path.display()
            )));
        }
        match kind? {
            FileKind::Ply
            | FileKind::Obj
            | FileKind::Las
            | FileKind::E57
            | FileKind::Gaussians
            | FileKind::Blocks => Ok(Self::of_model(Source::File {
                path: path.to_owned(),
                radius: None,
                prefix: None,
                texture: None,
                color_range: None,
                color_by: None,
            })),
            FileKind::Toml => Self::read(path),
            FileKind::Exr => Err(Error::Usage(format!(
                "{}: an EXR is a picture, not a scene; `splatref info` describes it",
                path.display()
            ))),
        }
    }
}
