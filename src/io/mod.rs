//! Files: everything that touches the disk. Only this module, `cli` and `main` know of them.
//!
//! - [`exr`]: every plane of a frame, exactly; reading guards against lying files.
//! - [`png`]: an 8-bit preview.
//! - [`ply`]: point clouds and meshes, in and out.
//! - [`replace`]: output files that are whole or not there.
//! - [`srgb`]: the transfer function between stored colours and linear light.

pub mod exr;
pub mod ply;
pub mod png;
pub mod replace;
pub mod srgb;
