//! A picture as files hold it: the form that is compared, measured and hashed.

use super::{ChannelData, Frame, Plane, Rect};
use crate::error::Result;

/// A picture as files hold it: channels by name, without the planes that the channels belong to.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width in pixels, at least 1.
    pub width: u32,
    /// Height in pixels, at least 1.
    pub height: u32,
    /// The channels and their names, sorted by name, no name twice.
    pub channels: Vec<(String, Values)>,
    /// The text attribute [`crate::io::exr::ATTRIBUTE`].
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

impl From<&Frame<f32>> for Image {
    /// Takes what a file of the frame would hold, except the text.
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
    /// The pixels of a region of the picture.
    ///
    /// # Errors
    /// As [`Rect::check_inside`].
    pub fn region(&self, region: &Rect) -> Result<Self> {
        region.check_inside([self.width, self.height])?;
        let Rect { x0, y0, x1, y1 } = *region;
        let rows = || (y0..y1).map(|y| y as usize * self.width as usize);
        let row = |first: usize| first + x0 as usize..first + x1 as usize;
        let channels = self.channels.iter().map(|(name, values)| {
            let values = match values {
                Values::Float(all) => {
                    Values::Float(rows().flat_map(|first| &all[row(first)]).copied().collect())
                }
                Values::Index(all) => {
                    Values::Index(rows().flat_map(|first| &all[row(first)]).copied().collect())
                }
            };
            (name.clone(), values)
        });
        let ([width, height], channels) = (region.size(), channels.collect());
        Ok(Self { width, height, channels, text: self.text.clone() })
    }

    /// The values of the channel called `name`.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<&Values> {
        self.channels.iter().find(|(of, _)| of == name).map(|(_, values)| values)
    }

    /// The channels `R`, `G` and `B` together; none unless all three are floats.
    #[must_use]
    pub fn color(&self) -> Option<Plane<[f32; 3]>> {
        let channel = |name| match self.channel(name)? {
            Values::Float(values) => Some(values),
            Values::Index(_) => None,
        };
        let (r, g, b) = (channel("R")?, channel("G")?, channel("B")?);
        let pixels = r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]);
        Some(Plane::from_values(self.width, self.height, pixels.collect()))
    }
}
