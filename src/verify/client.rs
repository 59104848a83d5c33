//! What somebody hands in: planes by the names of a method's rows, and how exactly each is stored.

use crate::error::{Error, Result};
use crate::frame::image::Values;
use crate::frame::{Frame, Image, NO_ID, Plane, Samples};
use crate::method::stage::numbered;
use crate::method::{Holds, PlaneRow, Stage};
use crate::number::ball::{Ball, Profile};
use crate::setting::Words;
use std::collections::BTreeMap;

/// How far a stored value may lie from the value that was computed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Storage {
    /// `f32`: what was computed.
    #[default]
    Single,
    /// `f16`, rounded to either neighbour: 2^-10 of the value, at least 2^-24.
    Half,
    /// Equal steps of this size, in the unit of the plane, rounded to either neighbour: UNORM of n
    /// bits has steps of 1 / (2^n - 1).
    Steps(f64),
    /// Equal steps of a depth buffer z in \[0, 1\] of a perspective camera,
    /// `z = far (t - near) / (t (far - near))`, or of 1 - z; the plane holds t.
    DepthBuffer {
        /// The step of z.
        step: f64,
        /// The depth of z = 0.
        near: f64,
        /// The depth of z = 1.
        far: f64,
    },
}

impl Storage {
    /// How far from this stored value the computed one may lie, in the unit of the plane.
    #[must_use]
    pub fn radius(self, value: f64) -> f64 {
        match self {
            Self::Single => 0.0,
            _ if !value.is_finite() => 0.0,
            Self::Half => {
                let relative = value.abs() / 1024.0;
                let least = 1.0 / 16_777_216.0;
                if relative > least { relative } else { least }
            }
            Self::Steps(step) => step,
            // dt/dz = t t (far - near) / (far near), at the far end of the step.
            Self::DepthBuffer { step, near, far } => {
                let slope = (far - near) / (far * near);
                let reach = 1.0 - step * value * slope;
                if reach > 0.0 { step * value * value * slope / reach } else { f64::INFINITY }
            }
        }
    }
}

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

/// The planes of a client.
///
/// Depth is t in world units, +inf where a pixel is empty, whatever the client stores; ids are
/// [`NO_ID`] there; rows run from the top.
#[derive(Clone, Debug)]
pub struct Client {
    frame: Frame<f64>,
    storage: BTreeMap<String, Storage>,
    /// What the client promises of its operations.
    pub rounding: Rounding,
    /// How the sums of the attribute pass are stored between two additions.
    pub accumulator: Storage,
    /// The channels of the file that are no planes of the method.
    pub unknown: Vec<String>,
}

/// A plane of a client.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stored<'a, T> {
    /// The name of the row.
    pub(crate) name: &'static str,
    /// What stands for `#` in it.
    pub(crate) number: usize,
    pub(crate) plane: &'a Plane<T>,
    pub(crate) storage: Storage,
}

impl<T> Stored<'_, T> {
    /// The name of the plane.
    pub(crate) fn channel(&self) -> String {
        numbered(self.name, self.number)
    }
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
        self.plane.at(x, y).map(|value| {
            Ball::new(value, if value.is_nan() { f64::NAN } else { self.storage.radius(value) })
        })
    }
}

impl Client {
    /// The planes of a frame, all stored as `f32`.
    #[must_use]
    pub fn new(frame: Frame<f64>) -> Self {
        Self {
            frame,
            storage: BTreeMap::new(),
            rounding: Rounding::default(),
            accumulator: Storage::Single,
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
            // Every number that the digits of a name can be.
            let digits = row.name.bytes().filter(|&c| c == b'#').count();
            for number in 0..10_usize.pow(digits as u32) {
                if let Some(samples) = samples(image, row, number, &mut known)? {
                    frame.push(&row.numbered(number), samples)?;
                }
            }
        }
        let names = image.channels.iter().map(|(name, _)| name);
        let unknown = names.filter(|name| !known.contains(name)).cloned().collect();
        Ok(Self { unknown, ..Self::new(frame) })
    }

    /// Says how a plane is stored; of planes that are numbered the name of their row says it of all.
    #[must_use]
    pub fn stored(mut self, plane: &str, storage: Storage) -> Self {
        self.storage.insert(plane.to_owned(), storage);
        self
    }

    /// The planes.
    #[must_use]
    pub fn frame(&self) -> &Frame<f64> {
        &self.frame
    }

    /// One number a pixel, if the plane was handed in.
    pub(crate) fn scalar(&self, row: &PlaneRow) -> Option<Stored<'_, f64>> {
        self.scalar_of(row, 0)
    }

    /// The same of a row that has numbers.
    pub(crate) fn scalar_of(&self, row: &PlaneRow, number: usize) -> Option<Stored<'_, f64>> {
        match self.samples(row, number)? {
            Samples::Scalar(plane) => Some(self.of(row, number, plane)),
            _ => None,
        }
    }

    /// Colours or vectors, if the plane was handed in.
    pub(crate) fn triple(&self, row: &PlaneRow) -> Option<Stored<'_, [f64; 3]>> {
        self.triple_of(row, 0)
    }

    /// The same of a row that has numbers.
    pub(crate) fn triple_of(&self, row: &PlaneRow, number: usize) -> Option<Stored<'_, [f64; 3]>> {
        match self.samples(row, number)? {
            Samples::Color(plane) | Samples::Vector(plane) => Some(self.of(row, number, plane)),
            _ => None,
        }
    }

    /// Indices, if the plane was handed in.
    pub(crate) fn index(&self, row: &PlaneRow) -> Option<Stored<'_, u32>> {
        self.index_of(row, 0)
    }

    /// The same of a row that has numbers.
    pub(crate) fn index_of(&self, row: &PlaneRow, number: usize) -> Option<Stored<'_, u32>> {
        match self.samples(row, number)? {
            Samples::Index(plane) => Some(self.of(row, number, plane)),
            _ => None,
        }
    }

    /// Small counts, if the plane was handed in.
    pub(crate) fn count(&self, row: &PlaneRow) -> Option<Stored<'_, u8>> {
        self.count_of(row, 0)
    }

    /// The same of a row that has numbers.
    pub(crate) fn count_of(&self, row: &PlaneRow, number: usize) -> Option<Stored<'_, u8>> {
        match self.samples(row, number)? {
            Samples::Count(plane) => Some(self.of(row, number, plane)),
            _ => None,
        }
    }

    fn samples(&self, row: &PlaneRow, number: usize) -> Option<&Samples<f64>> {
        self.frame.plane(&row.numbered(number))
    }

    fn of<'a, T>(&self, row: &PlaneRow, number: usize, plane: &'a Plane<T>) -> Stored<'a, T> {
        let own = self.storage.get(&row.numbered(number));
        let storage = own.or_else(|| self.storage.get(row.name)).copied().unwrap_or_default();
        Stored { name: row.name, number, plane, storage }
    }
}

/// The channels of a row of this number, if all are there.
fn samples(
    image: &Image,
    row: &PlaneRow,
    number: usize,
    known: &mut Vec<String>,
) -> Result<Option<Samples<f64>>> {
    let names: Vec<_> = row.channels().iter().map(|name| numbered(name, number)).collect();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_format_may_lose() {
        assert_eq!(Storage::Single.radius(0.7), 0.0);
        // Of f16 in [1, 2) neighbours are 2^-10 apart, denormals 2^-24.
        assert_eq!(Storage::Half.radius(1.0), 1.0 / 1024.0);
        assert_eq!(Storage::Half.radius(1e-9), 1.0 / 16_777_216.0);
        assert_eq!(Storage::Steps(1.0 / 255.0).radius(0.3), 1.0 / 255.0);
        assert_eq!(Storage::Half.radius(f64::INFINITY), 0.0, "an empty pixel");
    }

    #[test]
    fn a_step_of_a_depth_buffer_holds_the_depths_beside_it() {
        let (near, far, step) = (0.5, 20.0, 1.0 / 65_535.0);
        let z = |t: f64| far * (t - near) / (t * (far - near));
        let t = |z: f64| far * near / (far - z * (far - near));
        for depth in [0.5, 1.0, 3.0, 19.0] {
            let radius = Storage::DepthBuffer { step, near, far }.radius(depth);
            let beside = t(z(depth) + step) - depth;
            assert!(beside <= radius * (1.0 + 1e-9) && radius < 1.01 * beside, "{depth}");
            assert!(depth - t(z(depth) - step) <= radius);
        }
    }
}
