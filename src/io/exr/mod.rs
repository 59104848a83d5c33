//! EXR files: [`write()`] stores every plane of a frame exactly, [`read()`] takes any flat EXR.
//!
//! The `exr` crate serves the format: its header and its blocks. What this module adds is that a
//! frame is written from where it lies, that the bytes of a file are a function of the frame, and
//! that a lying header is refused before anything is allocated.

mod read;
#[cfg(test)]
mod tests;
mod write;

pub use read::{read, read_header};
pub use write::{pending, write};

/// The name of the one text attribute that a file of this crate carries.
pub const ATTRIBUTE: &str = "splatref";

/// What the header of an EXR file promises.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureHeader {
    /// Width in pixels, at least 1.
    pub width: u32,
    /// Height in pixels, at least 1.
    pub height: u32,
    /// The channels and their types, sorted by name, no name twice.
    pub channels: Vec<(String, ChannelType)>,
    /// The compression of each part of the file, in words.
    pub compressions: Vec<String>,
    /// The text attribute [`ATTRIBUTE`].
    pub text: Option<String>,
}

/// How a file stores the values of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChannelType {
    /// 16-bit floats.
    Half,
    /// 32-bit floats.
    Float,
    /// 32-bit unsigned integers.
    Uint,
}
