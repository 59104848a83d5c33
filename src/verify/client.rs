//! What somebody hands in: planes by the names of a method's rows, and how exactly each is stored.

mod storage;

pub use storage::Storage;

use crate::error::{Error, Result};
use crate::frame::image::Values;
use crate::frame::{Frame, Image, NO_ID, Plane, Samples};
use crate::method::{Holds, PlaneRow, Stage};
use crate::number::ball::{Ball, Profile};
use crate::setting::Words;
use std::collections::BTreeMap;

/// What a client promises of its operations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rounding {
    /// What shading languages publish, see [`Gpu`](crate::number::ball::Gpu).
    #[default]
    Gpu,
    /// One rounding an operation, to nearest, see [`Ieee`](crate::number::ball::Ieee); sums in
    /// ascending surfel index.
    Ieee,
}

impl Words for Rounding {
    const WORDS: &'static [(&'static str, Self)] = &[("gpu", Self::Gpu), ("ieee", Self::Ieee)];
}

/// Which of the fragments that are equally near a client has as the nearest one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ties {
    /// That of the lowest surfel index, as this crate does.
    #[default]
    Lowest,
    /// That which was drawn last: of the highest surfel index.
    Last,
    /// Any, another one in every run.
    Any,
}

impl Words for Ties {
    const WORDS: &'static [(&'static str, Self)] =
        &[("lowest", Self::Lowest), ("last", Self::Last), ("any", Self::Any)];
}

/// The planes of a client.
///
/// Depth is t in world units, +inf where a pixel is empty, whatever the client stores; ids are
/// [`NO_ID`] there; rows run from the top.
#[derive(Clone, Debug)]
pub struct Client {
    frame: Frame<f64>,
    storage: BTreeMap<String, Storage>,
    radii: BTreeMap<String, Plane<[f64; 3]>>,
    /// What the client promises of its operations.
    pub rounding: Rounding,
    /// How the sums of the attribute pass are stored between two additions.
    pub accumulator: Storage,
    /// Which of equally near fragments is the nearest one.
    pub ties: Ties,
    /// The channels of the file that are no planes of the method.
    pub unknown: Vec<String>,
}

/// A plane of a client.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stored<'a, T> {
    pub(crate) name: &'static str,
    pub(crate) plane: &'a Plane<T>,
    pub(crate) storage: Storage,
    /// How far each number may be off, in place of what the storage says.
    radii: Option<&'a Plane<[f64; 3]>>,
}

impl Stored<'_, f64> {
    /// The number at a pixel, as far as it is known.
    pub(crate) fn ball<P: Profile>(&self, (x, y): (u32, u32)) -> Ball<P> {
        let value = *self.plane.at(x, y);
        Ball::new(value, if value.is_nan() { f64::NAN } else { self.storage.radius(value) })
    }
}

impl Stored<'_, [f64; 3]> {
    /// The numbers at a pixel, as far as they are known.
    pub(crate) fn balls<P: Profile>(&self, (x, y): (u32, u32)) -> [Ball<P>; 3] {
        let values = *self.plane.at(x, y);
        let radii = self.radii.map_or_else(
            || values.map(|value| self.storage.radius(value)),
            |radii| *radii.at(x, y),
        );
        [0, 1, 2]
            .map(|i| Ball::new(values[i], if values[i].is_nan() { f64::NAN } else { radii[i] }))
    }
}

impl Client {
    /// The planes of a frame, all stored as `f32`.
    #[must_use]
    pub fn new(frame: Frame<f64>) -> Self {
        Self {
            frame,
            storage: BTreeMap::new(),
            radii: BTreeMap::new(),
            rounding: Rounding::default(),
            accumulator: Storage::Single,
            ties: Ties::default(),
            unknown: Vec::new(),
        }
    }

    /// The channels of a picture that are planes of these stages, by name.
    ///
    /// A plane whose components are not all there is no plane. Indices and counts may come as floats
    /// that are whole numbers.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a channel of indices or counts holds something else.
    pub fn of_image(image: &Image, stages: &[Stage]) -> Result<Self> {
        let mut frame = Frame::new(image.width, image.height);
        let mut known = Vec::new();
        for row in stages.iter().flat_map(|stage| stage.leaves) {
            if let Some(samples) = samples(image, row, &mut known)? {
                frame.push(row.name, samples)?;
            }
        }
        let names = image.channels.iter().map(|(name, _)| name);
        let unknown = names.filter(|name| !known.contains(name)).cloned().collect();
        Ok(Self { unknown, ..Self::new(frame) })
    }

    /// Says how a plane is stored.
    #[must_use]
    pub fn stored(mut self, plane: &str, storage: Storage) -> Self {
        self.storage.insert(plane.to_owned(), storage);
        self
    }

    /// Says how far each number of a plane of colours or vectors may be off, where the value alone
    /// does not tell; in place of its [`Storage`].
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no such plane of this size.
    pub fn within(mut self, plane: &str, radii: Plane<[f64; 3]>) -> Result<Self> {
        let size = match self.frame.plane(plane) {
            Some(Samples::Color(p) | Samples::Vector(p)) => (p.width(), p.height()),
            _ => return Err(Error::Invalid(format!("no colours or vectors are called `{plane}`"))),
        };
        if size != (radii.width(), radii.height()) {
            let what = format!("the radii of the plane `{plane}` have another size than it");
            return Err(Error::Invalid(what));
        }
        self.radii.insert(plane.to_owned(), radii);
        Ok(self)
    }

    /// How far each number of a plane may be off, where [`Client::within`] said so.
    #[must_use]
    pub fn radii(&self, plane: &str) -> Option<&Plane<[f64; 3]>> {
        self.radii.get(plane)
    }

    /// How a plane is stored.
    #[must_use]
    pub fn storage(&self, plane: &str) -> Storage {
        self.storage.get(plane).copied().unwrap_or_default()
    }

    /// The planes.
    #[must_use]
    pub fn frame(&self) -> &Frame<f64> {
        &self.frame
    }

    /// One number a pixel, if the plane was handed in.
    pub(crate) fn scalar(&self, row: &PlaneRow) -> Option<Stored<'_, f64>> {
        match self.samples(row)? {
            Samples::Scalar(plane) => Some(self.of(row, plane)),
            _ => None,
        }
    }

    /// Colours or vectors, if the plane was handed in.
    pub(crate) fn triple(&self, row: &PlaneRow) -> Option<Stored<'_, [f64; 3]>> {
        match self.samples(row)? {
            Samples::Color(plane) | Samples::Vector(plane) => Some(self.of(row, plane)),
            _ => None,
        }
    }

    /// Indices, if the plane was handed in.
    pub(crate) fn index(&self, row: &PlaneRow) -> Option<Stored<'_, u32>> {
        match self.samples(row)? {
            Samples::Index(plane) => Some(self.of(row, plane)),
            _ => None,
        }
    }

    /// Small counts, if the plane was handed in.
    pub(crate) fn count(&self, row: &PlaneRow) -> Option<Stored<'_, u8>> {
        match self.samples(row)? {
            Samples::Count(plane) => Some(self.of(row, plane)),
            _ => None,
        }
    }

    fn samples(&self, row: &PlaneRow) -> Option<&Samples<f64>> {
        self.frame.plane(row.name)
    }

    fn of<'a, T>(&'a self, row: &PlaneRow, plane: &'a Plane<T>) -> Stored<'a, T> {
        Stored {
            name: row.name,
            plane,
            storage: self.storage(row.name),
            radii: self.radii(row.name),
        }
    }
}

/// The channels of a row, if all are there.
fn samples(image: &Image, row: &PlaneRow, known: &mut Vec<String>) -> Result<Option<Samples<f64>>> {
    let names = row.channels();
    let found: Option<Vec<&Values>> = names.iter().map(|name| image.channel(name)).collect();
    let Some(found) = found else { return Ok(None) };
    let plane = |values| Plane::from_values(image.width, image.height, values);
    let whole = |most: u32| integers(&names[0], found[0], most);
    let samples = match row.holds {
        Holds::Scalar => Samples::Scalar(plane(floats(found[0]))),
        Holds::Color => Samples::Color(triples(image, &found)),
        Holds::Vector => Samples::Vector(triples(image, &found)),
        Holds::Index => {
            Samples::Index(Plane::from_values(image.width, image.height, whole(NO_ID)?))
        }
        Holds::Count => {
            let counts = whole(255)?.into_iter().map(|count| count as u8).collect();
            Samples::Count(Plane::from_values(image.width, image.height, counts))
        }
    };
    known.extend(names);
    Ok(Some(samples))
}

/// The numbers of a channel.
fn floats(values: &Values) -> Vec<f64> {
    match values {
        Values::Float(values) => values.iter().map(|&v| v.into()).collect(),
        Values::Index(values) => values.iter().map(|&v| v.into()).collect(),
    }
}

/// Three channels as one plane.
fn triples(image: &Image, channels: &[&Values]) -> Plane<[f64; 3]> {
    let parts: Vec<_> = channels.iter().map(|channel| floats(channel)).collect();
    let pixels = 0..parts[0].len();
    let triples = pixels.map(|i| [parts[0][i], parts[1][i], parts[2][i]]).collect();
    Plane::from_values(image.width, image.height, triples)
}

/// The whole numbers of a channel.
fn integers(name: &str, values: &Values, most: u32) -> Result<Vec<u32>> {
    let refused = |value: &dyn std::fmt::Display| {
        let what = format!("the plane `{name}` holds {value}; give whole numbers from 0 to {most}");
        Error::Invalid(what)
    };
    match values {
        Values::Index(values) => match values.iter().find(|value| **value > most) {
            Some(value) => Err(refused(value)),
            None => Ok(values.clone()),
        },
        Values::Float(values) => {
            let whole = |value: &f32| {
                let integer = *value as u32;
                let same = integer as f32 == *value && integer <= most;
                if same { Ok(integer) } else { Err(refused(value)) }
            };
            values.iter().map(whole).collect()
        }
    }
}
