//! Files: everything that touches the disk, besides the command line.
//!
//! - [`ply`]: point clouds and meshes, in and out.
//! - [`replace`]: output files that are whole or not there.
//! - [`srgb`]: the transfer function between stored colours and linear light.

pub mod ply;
pub mod replace;
pub mod srgb;
