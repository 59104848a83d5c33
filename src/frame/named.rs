//! Named planes: what a method leaves, in the names that EXR viewers understand.

use super::Plane;
use crate::number::Real;

/// The values of a named plane; the variant decides the channel names.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples<R> {
    /// One number a pixel; the name is the channel: `Z`, `visibility.Z`, `weight`.
    Scalar(Plane<R>),
    /// Linear RGB; channels `R`, `G`, `B` after the name: `R`, `attributes.R`.
    Color(Plane<[R; 3]>),
    /// A vector; channels `X`, `Y`, `Z` after the name: `normal.X`.
    Vector(Plane<[R; 3]>),
    /// Surfel indices; [`super::NO_ID`] where there is none.
    Index(Plane<u32>),
    /// The stencil, or a small count.
    Count(Plane<u8>),
}

/// A plane and its name; the colour of the picture itself has the empty name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPlane<R> {
    /// The name, layers separated by dots: `attributes.normal`.
    pub name: String,
    /// The values.
    pub samples: Samples<R>,
}

/// The planes that a method left, all of one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame<R> {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The planes, in the order of the stages that made them.
    pub planes: Vec<NamedPlane<R>>,
}

/// One channel of a frame, borrowed: what a file holds under one name.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel<'a> {
    /// The full channel name: `R`, `Z`, `visibility.Z`, `normal.X`.
    pub name: String,
    /// The values.
    pub data: ChannelData<'a>,
}

/// The values of a channel: that of pixel `i` is `values[offset + stride * i]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChannelData<'a> {
    /// `f32`, strided.
    Float {
        /// The plane's values.
        values: &'a [f32],
        /// Distance from pixel to pixel: 1 or 3.
        stride: usize,
        /// Component: 0, 1 or 2.
        offset: usize,
    },
    /// Indices, stride 1.
    Index(&'a [u32]),
    /// Counts, stride 1.
    Count(&'a [u8]),
}

impl<R: Real> Frame<R> {
    /// The frame with every number rounded once to `f32`, as files hold it.
    #[must_use]
    pub fn to_f32(&self) -> Frame<f32> {
        let planes = self.planes.iter().map(|plane| NamedPlane {
            name: plane.name.clone(),
            samples: match &plane.samples {
                Samples::Scalar(p) => Samples::Scalar(p.map(|v| v.to_f32())),
                Samples::Color(p) => Samples::Color(p.map(|v| v.map(R::to_f32))),
                Samples::Vector(p) => Samples::Vector(p.map(|v| v.map(R::to_f32))),
                Samples::Index(p) => Samples::Index(p.clone()),
                Samples::Count(p) => Samples::Count(p.clone()),
            },
        });
        Frame { width: self.width, height: self.height, planes: planes.collect() }
    }

    /// The samples of the plane called `name`.
    #[must_use]
    pub fn plane(&self, name: &str) -> Option<&Samples<R>> {
        self.planes.iter().find(|plane| plane.name == name).map(|plane| &plane.samples)
    }
}

impl Frame<f32> {
    /// Every channel, sorted by name as EXR wants them.
    #[must_use]
    pub fn channels(&self) -> Vec<Channel<'_>> {
        let mut channels = Vec::new();
        for NamedPlane { name, samples } in &self.planes {
            match samples {
                Samples::Scalar(p) => {
                    let data = ChannelData::Float { values: p.values(), stride: 1, offset: 0 };
                    channels.push(Channel { name: name.clone(), data });
                }
                Samples::Color(p) => channels.extend(components(name, p, ["R", "G", "B"])),
                Samples::Vector(p) => channels.extend(components(name, p, ["X", "Y", "Z"])),
                Samples::Index(p) => {
                    let data = ChannelData::Index(p.values());
                    channels.push(Channel { name: name.clone(), data });
                }
                Samples::Count(p) => {
                    let data = ChannelData::Count(p.values());
                    channels.push(Channel { name: name.clone(), data });
                }
            }
        }
        channels.sort_by(|a, b| a.name.cmp(&b.name));
        channels
    }
}

/// The three channels of a colour or a vector.
fn components<'a>(name: &str, plane: &'a Plane<[f32; 3]>, letters: [&str; 3]) -> [Channel<'a>; 3] {
    [0, 1, 2].map(|offset| Channel {
        name: match name {
            "" => letters[offset].to_owned(),
            _ => format!("{name}.{}", letters[offset]),
        },
        data: ChannelData::Float { values: plane.values().as_flattened(), stride: 3, offset },
    })
}
