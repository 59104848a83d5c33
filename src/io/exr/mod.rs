//! Store every plane of a frame exactly with [`write()`], and read any flat EXR with [`read()`].
//!
//! The `exr` crate handles the format itself: the header and the blocks. This module adds four
//! things:
//!
//! - A frame is written directly from where it lies in memory.
//! - The bytes of a file are a function of the frame.
//! - A header that promises too much is refused before anything is allocated.
//! - Blocks are compressed and decompressed in parallel, on the threads of an
//!   [`Exec`](crate::frame::Exec).

mod batch;
mod parts;
mod read;
mod region;
#[cfg(test)]
mod tests;
mod window;
mod write;
mod zip;

use crate::error::{Error, Result};
use crate::frame::{Frame, Rect};
use crate::setting::Words;

pub use parts::{Assembled, assemble};
pub use read::{read, read_header, read_with};
pub use region::{Region, read_region};
pub use write::{BLOCK_LINES, pending, pending_bands, pending_part, write};

/// The name of the one text attribute in files of this crate.
pub const ATTRIBUTE: &str = "splatref";

/// The contents of an EXR file's header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PictureHeader {
    /// Width in pixels, at least 1.
    pub width: u32,
    /// Height in pixels, at least 1.
    pub height: u32,
    /// The pixels of the picture that the file holds, its data window; none if its parts have
    /// different data windows, or if they are not inside the picture.
    pub data: Option<Rect>,
    /// The channels and their types, sorted by name, no name twice.
    pub channels: Vec<(String, ChannelType)>,
    /// The compression of each part of the file, in words.
    pub compressions: Vec<String>,
    /// The text attribute [`ATTRIBUTE`].
    pub text: Option<String>,
}

/// The place of a frame in a picture, which an EXR holds as its data window and its display window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// The pixels of the frame.
    pub region: Rect,
    /// Width and height of the picture.
    pub picture: [u32; 2],
}

impl Window {
    /// The window of a frame that is the whole picture.
    #[must_use]
    pub fn whole(frame: &Frame<f32>) -> Self {
        let picture = [frame.width, frame.height];
        Self { region: Rect::of_size(picture), picture }
    }

    /// Checks that a frame of this size is the region, and that the region is inside the picture.
    fn check(&self, size: [u32; 2]) -> Result<()> {
        let Self { region, picture } = *self;
        let inside = region.intersection(&Rect::of_size(picture)) == region;
        // Headers hold coordinates in 31 bits.
        let small = picture.iter().all(|&side| side <= i32::MAX as u32);
        if !region.is_empty() && inside && small && region.size() == size {
            return Ok(());
        }
        let (Rect { x0, y0, x1, y1 }, [w, h]) = (region, picture);
        Err(Error::Invalid(format!(
            "a frame of {} x {} pixels is not the region {x0},{y0},{x1},{y1} of a picture of {w} x {h} pixels",
            size[0], size[1]
        )))
    }
}

/// How the blocks of a written file are compressed; every way is lossless.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// Runs of equal bytes, line by line. Deflate saves little and takes long, because the
    /// mantissas of a picture are noise. In the bench `files`, one scene of one size, this file is
    /// 10 % larger than by deflate, 17 % with all stages, and written sooner.
    #[default]
    Rle,
    /// Deflate, 16 lines at a time, as most programs write EXR files.
    Zip,
    /// Wavelets and Huffman codes, 32 lines at a time: the smallest file, the slowest to read.
    Piz,
    /// Nothing is compressed.
    None,
}

impl Words for Compression {
    const WORDS: &'static [(&'static str, Self)] =
        &[("rle", Self::Rle), ("zip", Self::Zip), ("piz", Self::Piz), ("none", Self::None)];
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
