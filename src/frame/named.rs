//! Named planes: the output of a method, under the names that EXR viewers understand.

use super::Plane;
use crate::error::{Error, Result};
use crate::number::MapInline;
use crate::number::Real;

/// The most bytes of a channel's name: a reader of EXR without its long-names flag takes no more.
pub const LONGEST_NAME: usize = 31;

/// The values of a named plane; the variant decides the names of the channels.
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

impl<R> Samples<R> {
    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        match self {
            Self::Scalar(p) => (p.width(), p.height()),
            Self::Color(p) | Self::Vector(p) => (p.width(), p.height()),
            Self::Index(p) => (p.width(), p.height()),
            Self::Count(p) => (p.width(), p.height()),
        }
    }

    /// The values with their rows in reverse order.
    pub(crate) fn flipped(&self) -> Self
    where
        R: Copy,
    {
        match self {
            Self::Scalar(p) => Self::Scalar(p.flipped()),
            Self::Color(p) => Self::Color(p.flipped()),
            Self::Vector(p) => Self::Vector(p.flipped()),
            Self::Index(p) => Self::Index(p.flipped()),
            Self::Count(p) => Self::Count(p.flipped()),
        }
    }

    /// The kind of the values, in words.
    fn kind(&self) -> &'static str {
        match self {
            Self::Scalar(_) => "scalar",
            Self::Color(_) => "color",
            Self::Vector(_) => "vector",
            Self::Index(_) => "index",
            Self::Count(_) => "count",
        }
    }

    /// The names that the channels of a plane called `name` have in a file.
    fn channel_names(&self, name: &str) -> Vec<String> {
        match self {
            Self::Color(_) => COLOR.map(|letter| component(name, letter)).to_vec(),
            Self::Vector(_) => VECTOR.map(|letter| component(name, letter)).to_vec(),
            Self::Scalar(_) | Self::Index(_) | Self::Count(_) => vec![name.to_owned()],
        }
    }
}

/// A plane and its name; the colour of the picture itself has the empty name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPlane<R> {
    /// The name, layers separated by dots: `attributes.normal`.
    pub name: String,
    /// The values.
    pub samples: Samples<R>,
}

/// The planes that a method produced, all of one size.
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

/// The values of a channel: the value of pixel `i` is `values[offset + stride * i]`.
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

impl<R> Frame<R> {
    /// Makes a frame of this many pixels without planes: [`Frame::push`] adds planes.
    ///
    /// ```
    /// use splatref::frame::{Frame, Image, Plane, Samples};
    ///
    /// // What a client has read back from its GPU, row by row from the top left.
    /// let (depth, id) = (vec![1.5_f32; 12], vec![7_u32; 12]);
    /// let frame = Frame::new(4, 3)
    ///     .with("Z", Samples::Scalar(Plane::from_values(4, 3, depth)))?
    ///     .with("id", Samples::Index(Plane::from_values(4, 3, id)))?;
    /// assert_eq!(*frame.scalar("Z")?.at(3, 2), 1.5);
    /// let image = Image::from(&frame); // to be compared
    /// # assert_eq!(image.channels.len(), 2);
    /// # Ok::<(), splatref::Error>(())
    /// ```
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, planes: Vec::new() }
    }

    /// Adds a plane.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the plane has another size than the frame, or if a channel of the
    /// plane could not have its name in a file; the frame then stays as it was. Such a name is
    /// empty, longer than [`LONGEST_NAME`], contains a control character, or is already taken.
    /// (Only a colour may have the empty name, because its channels are `R`, `G` and `B`.)
    pub fn push(&mut self, name: &str, samples: Samples<R>) -> Result<()> {
        let ((width, height), size) = (samples.size(), (self.width, self.height));
        if (width, height) != size {
            return Err(Error::Invalid(format!(
                "plane `{name}` has {width} x {height} pixels, but the frame has {} x {}",
                size.0, size.1
            )));
        }
        let is_color = matches!(samples, Samples::Color(_));
        // Only the channels of a colour have names of their own: R, G and B.
        if name.is_empty() && !is_color {
            let kind = samples.kind();
            let what = format!("a {kind} plane has no name; only the colour may have none");
            return Err(Error::Invalid(what));
        }
        for channel in samples.channel_names(name) {
            if channel.len() > LONGEST_NAME || channel.chars().any(char::is_control) {
                return Err(Error::Invalid(format!(
                    "channel {channel:?}: a name has at most {LONGEST_NAME} bytes and no control \
                     characters"
                )));
            }
            // Two planes may share a channel: a vector `a` and a scalar `a.X`.
            let mut others = self.planes.iter().map(|p| p.samples.channel_names(&p.name));
            if others.any(|names| names.contains(&channel)) {
                return Err(Error::Invalid(format!(
                    "two channels are called `{channel}`; rename one"
                )));
            }
        }
        self.planes.push(NamedPlane { name: name.to_owned(), samples });
        Ok(())
    }

    /// Returns the frame with one more plane.
    ///
    /// # Errors
    /// As [`Frame::push`].
    pub fn with(mut self, name: &str, samples: Samples<R>) -> Result<Self> {
        self.push(name, samples)?;
        Ok(self)
    }

    /// Replaces the planes that have the same names, and appends the others.
    pub(crate) fn put(&mut self, planes: Self) {
        for plane in planes.planes {
            match self.planes.iter_mut().find(|own| own.name == plane.name) {
                Some(own) => *own = plane,
                None => self.planes.push(plane),
            }
        }
    }

    /// The samples of the plane called `name`.
    #[must_use]
    pub fn plane(&self, name: &str) -> Option<&Samples<R>> {
        self.planes.iter().find(|plane| plane.name == name).map(|plane| &plane.samples)
    }

    /// The plane called `name` with one number a pixel.
    ///
    /// # Errors
    /// [`Error::Invalid`], which lists the frame's planes, if no plane of this kind has the name.
    pub fn scalar(&self, name: &str) -> Result<&Plane<R>> {
        match self.plane(name) {
            Some(Samples::Scalar(plane)) => Ok(plane),
            _ => Err(self.missing("scalar", name)),
        }
    }

    /// The plane of linear RGB called `name`; the picture itself has the empty name.
    ///
    /// # Errors
    /// As [`Frame::scalar`].
    pub fn color(&self, name: &str) -> Result<&Plane<[R; 3]>> {
        match self.plane(name) {
            Some(Samples::Color(plane)) => Ok(plane),
            _ => Err(self.missing("color", name)),
        }
    }

    /// The plane of vectors called `name`.
    ///
    /// # Errors
    /// As [`Frame::scalar`].
    pub fn vector(&self, name: &str) -> Result<&Plane<[R; 3]>> {
        match self.plane(name) {
            Some(Samples::Vector(plane)) => Ok(plane),
            _ => Err(self.missing("vector", name)),
        }
    }

    /// The plane of surfel indices called `name`.
    ///
    /// # Errors
    /// As [`Frame::scalar`].
    pub fn index(&self, name: &str) -> Result<&Plane<u32>> {
        match self.plane(name) {
            Some(Samples::Index(plane)) => Ok(plane),
            _ => Err(self.missing("index", name)),
        }
    }

    /// The plane of counts called `name`.
    ///
    /// # Errors
    /// As [`Frame::scalar`].
    pub fn count(&self, name: &str) -> Result<&Plane<u8>> {
        match self.plane(name) {
            Some(Samples::Count(plane)) => Ok(plane),
            _ => Err(self.missing("count", name)),
        }
    }

    /// The error of a lookup that found nothing.
    fn missing(&self, kind: &str, name: &str) -> Error {
        let there = self.planes.iter().map(|p| format!("`{}` ({})", p.name, p.samples.kind()));
        let there: Vec<String> = there.collect();
        let there = if there.is_empty() { "none".into() } else { there.join(", ") };
        Error::Invalid(format!("no {kind} plane is called `{name}`; the frame has: {there}"))
    }
}

impl<R: Real> Frame<R> {
    /// The frame with every number rounded once to `f32`, as files hold it.
    #[must_use]
    pub fn to_f32(&self) -> Frame<f32> {
        let planes = self.planes.iter().map(|plane| NamedPlane {
            name: plane.name.clone(),
            samples: match &plane.samples {
                Samples::Scalar(p) => Samples::Scalar(p.map(|v| v.to_f32())),
                Samples::Color(p) => Samples::Color(p.map(|v| v.map_inline(R::to_f32))),
                Samples::Vector(p) => Samples::Vector(p.map(|v| v.map_inline(R::to_f32))),
                Samples::Index(p) => Samples::Index(p.clone()),
                Samples::Count(p) => Samples::Count(p.clone()),
            },
        });
        Frame { width: self.width, height: self.height, planes: planes.collect() }
    }
}

impl Frame<f32> {
    /// Every channel, sorted by name, as EXR requires.
    #[must_use]
    pub fn channels(&self) -> Vec<Channel<'_>> {
        let mut channels = Vec::new();
        for NamedPlane { name, samples } in &self.planes {
            match samples {
                Samples::Scalar(p) => {
                    let data = ChannelData::Float { values: p.values(), stride: 1, offset: 0 };
                    channels.push(Channel { name: name.clone(), data });
                }
                Samples::Color(p) => channels.extend(components(name, p, COLOR)),
                Samples::Vector(p) => channels.extend(components(name, p, VECTOR)),
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

/// The components of a colour.
pub(crate) const COLOR: [&str; 3] = ["R", "G", "B"];
/// The components of a vector.
pub(crate) const VECTOR: [&str; 3] = ["X", "Y", "Z"];

/// The channel name of a component of the plane called `name`.
pub(crate) fn component(name: &str, letter: &str) -> String {
    if name.is_empty() { letter.to_owned() } else { format!("{name}.{letter}") }
}

/// The three channels of a colour or a vector.
fn components<'a>(name: &str, plane: &'a Plane<[f32; 3]>, letters: [&str; 3]) -> [Channel<'a>; 3] {
    [0, 1, 2].map(|offset| Channel {
        name: component(name, letters[offset]),
        data: ChannelData::Float { values: plane.values().as_flattened(), stride: 3, offset },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scalar(width: u32, height: u32) -> Samples<f32> {
        Samples::Scalar(Plane::filled(width, height, 1.0))
    }

    #[test]
    fn planes_of_a_client_are_found_by_name_and_kind() {
        let vectors = Plane::filled(3, 2, [0.0, 0.0, 1.0]);
        let frame = Frame::new(3, 2)
            .with("", Samples::Color(Plane::filled(3, 2, [0.5; 3])))
            .and_then(|frame| frame.with("Z", scalar(3, 2)))
            .and_then(|frame| frame.with("normal", Samples::Vector(vectors)))
            .and_then(|frame| frame.with("id", Samples::Index(Plane::filled(3, 2, 7))))
            .and_then(|frame| frame.with("count", Samples::Count(Plane::filled(3, 2, 2))))
            .unwrap();
        assert_eq!(frame.color("").unwrap().values(), [[0.5; 3]; 6]);
        assert_eq!(frame.vector("normal").unwrap().values(), [[0.0, 0.0, 1.0]; 6]);
        assert_eq!(*frame.scalar("Z").unwrap().at(2, 1), 1.0);
        assert_eq!(*frame.index("id").unwrap().at(0, 0), 7);
        assert_eq!(*frame.count("count").unwrap().at(0, 0), 2);
        let names: Vec<_> = frame.channels().into_iter().map(|c| c.name).collect();
        assert_eq!(names, ["B", "G", "R", "Z", "count", "id", "normal.X", "normal.Y", "normal.Z"]);
        assert_eq!(
            frame.scalar("id").unwrap_err().to_string(),
            "no scalar plane is called `id`; the frame has: `` (color), `Z` (scalar), `normal` \
             (vector), `id` (index), `count` (count)"
        );
        let none = Frame::<f32>::new(1, 1).count("z").unwrap_err().to_string();
        assert_eq!(none, "no count plane is called `z`; the frame has: none");
    }

    #[test]
    fn a_plane_that_no_file_could_hold_is_refused() {
        let mut frame = Frame::new(3, 2).with("Z", scalar(3, 2)).unwrap();
        let color = |name: &str| (name.to_owned(), Samples::Color(Plane::filled(3, 2, [0.0; 3])));
        let vector = |name: &str| (name.to_owned(), Samples::Vector(Plane::filled(3, 2, [0.0; 3])));
        let long = "x".repeat(LONGEST_NAME);
        for ((name, samples), why) in [
            (
                ("weight".to_owned(), scalar(2, 3)),
                "plane `weight` has 2 x 3 pixels, but the frame has 3 x 2",
            ),
            (("Z".to_owned(), scalar(3, 2)), "two channels are called `Z`; rename one"),
            ((String::new(), scalar(3, 2)), "only the colour may have none"),
            (vector(""), "only the colour may have none"),
            (("a\nb".to_owned(), scalar(3, 2)), "no control characters"),
            (color(&long), "at most 31 bytes"),
        ] {
            let line = frame.push(&name, samples).unwrap_err().to_string();
            assert!(line.contains(why) && line.lines().count() == 1, "{line}");
        }
        assert_eq!(frame.planes.len(), 1, "what is refused leaves nothing");
        frame.push(&long, scalar(3, 2)).unwrap();
        let (name, samples) = color("");
        frame.push(&name, samples).unwrap();
        let line = frame.push("R", scalar(3, 2)).unwrap_err().to_string();
        assert_eq!(line, "two channels are called `R`; rename one", "a channel of the colour");
    }
}
