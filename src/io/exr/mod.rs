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
pub use write::write;

use crate::frame::{ChannelData, Frame};

/// The name of the one text attribute that a file of this crate carries.
pub const ATTRIBUTE: &str = "splatref";

/// A picture as an EXR file holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width in pixels, at least 1.
    pub width: u32,
    /// Height in pixels, at least 1.
    pub height: u32,
    /// The channels and their names, sorted by name, no name twice.
    pub channels: Vec<(String, Values)>,
    /// The text attribute [`ATTRIBUTE`].
    pub text: Option<String>,
}

/// The values of a channel, row by row from the top left, one a pixel.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// `FLOAT` channels, with their bits; `HALF` channels, widened exactly.
    Float(Vec<f32>),
    /// `UINT` channels: indices and counts.
    Index(Vec<u32>),
}

/// What the header of an EXR file promises.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
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

impl From<&Frame<f32>> for Image {
    /// What [`read()`] gives after [`write()`], text aside.
    fn from(frame: &Frame<f32>) -> Self {
        let channels = frame.channels().into_iter().map(|channel| {
            let values = match channel.data {
                ChannelData::Float { values, stride, offset } => {
                    Values::Float(values.iter().skip(offset).step_by(stride).copied().collect())
                }
                ChannelData::Index(values) => Values::Index(values.to_vec()),
                ChannelData::Count(values) => {
                    Values::Index(values.iter().map(|&count| u32::from(count)).collect())
                }
            };
            (channel.name, values)
        });
        let channels = channels.collect();
        Self { width: frame.width, height: frame.height, channels, text: None }
    }
}

impl Image {
    /// The values of the channel called `name`.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&Values> {
        self.channels.iter().find(|(of, _)| of == name).map(|(_, values)| values)
    }
}
