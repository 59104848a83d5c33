//! Files: everything that touches the disk. Only this module, `cli` and `main` know of them.
//!
//! - [`client`]: planes that somebody else drew, and the TOML file that describes them.
//! - [`environment`]: environment maps from EXR files.
//! - [`hierarchy`]: surfel approximations of a whole scene, in and out.
//! - `input`: the files that are read.
//! - [`exr`]: every plane of a frame, exactly; reading guards against lying files.
//! - [`npy`]: arrays of `NumPy` as planes.
//! - [`obj`]: meshes and points as text, in.
//! - [`ply`]: point clouds and meshes, in and out.
//! - `png`: an 8-bit preview; needs the feature `cli`.
//! - [`provenance`]: the text that a picture carries.
//! - [`replace`]: output files that are whole or not there.
//! - [`scene_file`]: scenes as TOML: models, lights, camera, settings.
//! - [`state`]: what a frame saw.
//! - [`texture`]: textures of models.

pub mod client;
pub mod environment;
pub mod exr;
pub mod hierarchy;
mod input;
pub mod npy;
pub mod obj;
pub mod ply;
#[cfg(feature = "cli")]
pub mod png;
pub mod provenance;
pub mod replace;
pub mod scene_file;
pub mod state;
pub mod texture;

use std::path::Path;

/// The extension of a file's name, in lower case.
#[must_use]
pub fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_string_lossy().to_ascii_lowercase())
}

/// A result or the reason why not, without the file's name.
type Reason<T> = Result<T, String>;
