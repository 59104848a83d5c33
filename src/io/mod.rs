//! Read and write every file format of the crate. Only this module, `cli` and `main` touch the
//! disk.
//!
//! Read a scene and its parts:
//!
//! - [`scene_file`]: read scenes from TOML: models, lights, camera, settings. Start here to get a
//!   picture from a name.
//! - [`cameras`]: read cameras from files of other programs.
//! - [`ply`]: read and write point clouds and meshes.
//! - [`gaussians`]: read 3D Gaussians.
//! - [`obj`]: read meshes and points as text.
//! - [`las`]: read point clouds of laser scanners, LAS and LAZ.
//! - `e57`: read scans; needs the feature `cli`.
//! - [`polygon`]: how the polygons of PLY and OBJ are cut into triangles.
//! - [`texture`]: read textures of models.
//! - [`environment`]: read environment maps from EXR files.
//! - [`surface`]: read the opaque geometry of a view from EXR files.
//! - [`blocks`]: write surfels in spatial order, and read those that a view needs.
//! - [`hierarchy`]: write and read surfel approximations of a whole scene.
//!
//! Store pictures and compare them:
//!
//! - [`exr`]: write and read every plane of a frame, exactly; reading guards against files that
//!   lie.
//! - `png`: write an 8-bit preview; needs the feature `cli`.
//! - [`npy`], [`npz`]: read arrays of `NumPy` as planes; write arrays.
//! - [`client`]: read another renderer's planes, and the TOML file that describes them.
//! - `conformance`: write the cases of the suite as folders of files; needs the feature `cli`.
//! - [`provenance`]: write the text that a picture carries.
//! - [`state`]: store the surfels that a frame saw, to resume a sequence.
//!
//! Shared by all:
//!
//! - `far`: shift positions that `f32` would merge.
//! - `guard`: turn a panic of a decoder into an error of its file.
//! - `input`: open files to read.
//! - `checksum`: notice damage in files of this crate.
//! - [`replace`]: write files that are complete or absent.

mod activation;
pub mod blocks;
pub mod cameras;
mod checksum;
pub mod client;
#[cfg(feature = "cli")]
pub mod conformance;
#[cfg(feature = "cli")]
pub mod e57;
pub mod environment;
pub mod exr;
mod far;
pub mod gaussians;
mod guard;
pub mod hierarchy;
mod input;
pub mod las;
pub mod npy;
pub mod npz;
pub mod obj;
pub mod ply;
#[cfg(feature = "cli")]
pub mod png;
pub mod polygon;
pub mod provenance;
pub mod replace;
pub mod scene_file;
pub mod state;
pub mod surface;
pub mod texture;

use std::path::Path;

/// The extension of a file's name, in lower case.
#[must_use]
pub fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_string_lossy().to_ascii_lowercase())
}

/// A result, or the reason for the failure without the file's name.
type Reason<T> = Result<T, String>;
