//! Draw scenes larger than memory: store surfels in spatial order, and read those that a view needs.
//!
//! [`SceneFile::tile`](crate::io::scene_file::SceneFile::tile) reads a PLY in parts and writes a folder.
//! [`SceneFile::open`](crate::io::scene_file::SceneFile::open) opens the folder as it opens the PLY, and
//! gets the same surfels with the same indices, in the same order. So every picture has the same bits.
//! With [`SceneFile::ready_in_parts`](crate::io::scene_file::SceneFile::ready_in_parts), a picture or a
//! region of one reads only blocks that may touch it.
//!
//! # The file
//!
//! The folder holds one file, `blocks`. Numbers are little-endian, without gaps. A *checksum* is as in
//! [`crate::io::hierarchy`]: the CRC-32 of all bytes from the beginning, or from the checksum before
//! it.
//!
//! ```text
//!   "splatref tile 1\n"                                       16 bytes
//!   u32 surfels, blocks, kind, bytes of the state             16
//!   f32 median radius                                          4
//!   f32 low x y z, high x y z: the box around all positions   24
//!   f64 x y z, radius: the bounding sphere                    32
//!   f64 x y z: the offset of the positions                    24
//!   the state of the scene's SHA-256 after all surfels
//!   of each block: u32 surfels                                 4
//!                  f32 low x y z, high x y z                  24
//!                  f32 reach                                   4
//!   u32 checksum                                               4
//!   of each block: of each surfel u32 index in the scene       4
//!                                 f32 position, normal        24
//!                                 f32 radius                   4
//!                                 f32 colour                  12 if the kind has 1
//!                                 f32 opacity                  4 if the kind has 2
//!                                 f32 half axes               24 if the kind has 4
//!                  u32 checksum                                4
//! ```
//!
//! Surfels are as [`crate::scene::Surfels`] holds them: checked, with unit normals. Surfels that would
//! be dropped are not stored. What needs the whole scene is stored: the median radius, the sphere, and
//! the [hash](crate::scene::Scene::sha256). The state of the hash is the 32 bytes of SHA-256 between
//! blocks, then a count and the bytes of a block that is not full, as the crate `sha2` serializes them.
//!
//! Surfels are ordered along a Morton curve, ties by index, and cut into blocks of [`SURFELS`]. The key
//! of a surfel interleaves floor(2^21 (p - low) / side) of the three axes, computed in f64, at most
//! 2^21 - 1, with x in the lowest bit; side is the longest side of the box. The box of a block is
//! around its positions. Its reach is the greatest radius or sqrt(U . U + V . V), rounded up.
//!
//! `Decided:` the file is not a [hierarchy](crate::io::hierarchy), because the surfels of a hierarchy
//! have 16 bits a normal and 8 bits a colour. It shares the checksums and the way of writing.
//!
//! `Decided:` index and blocks are one file, so that it is replaced as a whole. A reader that meets
//! another file than it opened refuses it.
//!
//! # Memory and disk that tiling needs
//!
//! A PLY is read once for each attribute and once more. Surfels are sorted in runs that fit into
//! half of the memory that is left, at most 512 MiB, in a temporary file in the folder. It takes 8
//! bytes a surfel more than the result, and is gone when the command ends, however it ends.

mod build;
mod index;
mod input;
mod read;
mod sort;
#[cfg(test)]
mod tests;

pub use build::Tiled;
pub(in crate::io) use build::build;
pub(in crate::io) use input::Input;
pub use read::Blocks;

/// How many surfels a block has; the last one may have fewer.
pub const SURFELS: usize = 1024;
