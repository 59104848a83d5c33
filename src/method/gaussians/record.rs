//! Export projected Gaussians as bytes for a backend to upload, and read a client's own.

use super::Settings;
use super::order::Splats;
use super::splats::{Projected, Source};
use crate::method::algorithm::Job;
use crate::splat::Tally;
use crate::splat::record::little_endian;
use std::mem::size_of;
use std::slice::{from_mut, from_ref};

/// A visible splat in 128 bytes of `f32` and `u32`: all stages of the projection, see
/// [`ProjectedGaussian`](crate::splat::gaussian::ProjectedGaussian).
///
/// | offset | size | field | meaning |
/// |---|---|---|---|
/// | 0 | 12 | `place` | the centre in the camera frame: x right, y down, t into the picture |
/// | 12 | 4 | `key` | what the order compares: depth, distance, or its step |
/// | 16 | 12 | `color` | after the spherical harmonics, bounded, in the space of blending |
/// | 28 | 4 | `alpha` | o, the opacity times the compensation |
/// | 32 | 12 | `conic` | V^-1: xx, xy, yy, in 1 / px^2 |
/// | 44 | 4 | `compensation` | the factor of the opacity |
/// | 48 | 12 | `ellipse` | V: xx, xy, yy, in px^2 |
/// | 60 | 4 | `distance` | from the camera's centre; t under an orthographic camera |
/// | 64 | 12 | `unfiltered` | V0, the ellipse without the low-pass filter: xx, xy, yy, in px^2 |
/// | 76 | 4 | `index` | its index in the scene |
/// | 80 | 24 | `covariance` | S' in the camera frame: xx, xy, xz, yy, yz, zz, in world units^2 |
/// | 104 | 8 | `center` | column and row of the centre, px |
/// | 112 | 16 | `bounds` | the pixels that may have fragments: first column and row, and the ones after the last |
///
/// WGSL gives the same struct in a storage buffer these offsets, and so does std430:
///
/// ```wgsl
/// struct GaussianRecord {
///     place: vec3<f32>, key: f32, color: vec3<f32>, alpha: f32, conic: vec3<f32>, compensation: f32,
///     ellipse: vec3<f32>, distance: f32, unfiltered: vec3<f32>, index: u32,
///     covariance: array<f32, 6>, center: vec2<f32>, bounds: vec4<u32>,
/// }
/// ```
///
/// With discs that meet rays, `alpha` is the opacity. V, its inverse, V0, S' and `compensation` then
/// describe the ellipse of the Gaussian, which no fragment uses.
///
/// numpy reads them with `dtype=[("place", "<f4", 3), ("key", "<f4"), ...]`.
///
/// A client may hand in its own records, see [`crate::verdict::gaussians`]. There the numbers are
/// balls, so that the record is generic.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct GaussianRecord<R = f32> {
    /// The centre in the camera frame: x right, y down, t into the picture.
    pub place: [R; 3],
    /// What the order compares.
    pub key: R,
    /// The colour, in the space of blending.
    pub color: [R; 3],
    /// o, the opacity times the compensation.
    pub alpha: R,
    /// V^-1: (xx, xy, yy), in 1 / px^2.
    pub conic: [R; 3],
    /// The factor of the opacity.
    pub compensation: R,
    /// V: (xx, xy, yy), in px^2.
    pub ellipse: [R; 3],
    /// The distance from the camera's centre; t under an orthographic camera.
    pub distance: R,
    /// V0: (xx, xy, yy), in px^2.
    pub unfiltered: [R; 3],
    /// The index in the scene.
    pub index: u32,
    /// S': (xx, xy, xz, yy, yz, zz), in world units^2.
    pub covariance: [R; 6],
    /// Column and row of the centre, in px.
    pub center: [R; 2],
    /// The pixels that may have fragments: x0, y0, x1, y1, the ends exclusive.
    pub bounds: [u32; 4],
}

/// A field of a record: one row says everything about it.
#[derive(Debug)]
pub(crate) struct RecordField<R> {
    name: &'static str,
    /// What its numbers are called.
    components: &'static [&'static str],
    /// The step of the projection that makes it, if a verdict judges it.
    pub(crate) step: Option<Step>,
    pub(crate) part: RecordPart<R>,
}

/// The steps of the projection that leave a field, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Step {
    Place,
    Distance,
    Key,
    Center,
    Covariance,
    Unfiltered,
    Ellipse,
    Conic,
    Compensation,
    Alpha,
    Color,
}

/// The place of a field in the record.
#[derive(Debug)]
pub(crate) enum RecordPart<R> {
    Numbers(fn(&GaussianRecord<R>) -> &[R], fn(&mut GaussianRecord<R>) -> &mut [R]),
    Wholes(fn(&GaussianRecord<R>) -> &[u32], fn(&mut GaussianRecord<R>) -> &mut [u32]),
}

impl Step {
    /// Whether discs that meet rays do not need it.
    pub(crate) fn is_of_ellipse(self) -> bool {
        (Self::Covariance..=Self::Compensation).contains(&self)
    }
}

impl<R> RecordField<R> {
    /// The name of one of its numbers.
    pub(crate) fn component(&self, i: usize) -> String {
        match self.components {
            [_] => self.name.to_owned(),
            all => format!("{}.{}", self.name, all[i]),
        }
    }

    /// Its type.
    const fn kind(&self) -> &'static str {
        match (&self.part, self.components.len()) {
            (RecordPart::Numbers(..), 1) => "f32",
            (RecordPart::Numbers(..), 2) => "f32 x 2",
            (RecordPart::Numbers(..), 3) => "f32 x 3",
            (RecordPart::Numbers(..), _) => "f32 x 6",
            (RecordPart::Wholes(..), 1) => "u32",
            (RecordPart::Wholes(..), _) => "u32 x 4",
        }
    }
}

/// A row of the table: name, step, components, place.
macro_rules! numbers {
    ($name:ident, $step:ident, $components:expr) => {
        RecordField {
            name: stringify!($name),
            components: &$components,
            step: Some(Step::$step),
            part: RecordPart::Numbers(|r| &r.$name, |r| &mut r.$name),
        }
    };
    ($name:ident, $step:ident) => {
        RecordField {
            name: stringify!($name),
            components: &[""],
            step: Some(Step::$step),
            part: RecordPart::Numbers(|r| from_ref(&r.$name), |r| from_mut(&mut r.$name)),
        }
    };
}

impl<R> GaussianRecord<R> {
    /// The fields in the order of the bytes: writer, reader and verdict follow from this table.
    pub(crate) const TABLE: [RecordField<R>; 13] = [
        numbers!(place, Place, ["x", "y", "t"]),
        numbers!(key, Key),
        numbers!(color, Color, ["r", "g", "b"]),
        numbers!(alpha, Alpha),
        numbers!(conic, Conic, ["xx", "xy", "yy"]),
        numbers!(compensation, Compensation),
        numbers!(ellipse, Ellipse, ["xx", "xy", "yy"]),
        numbers!(distance, Distance),
        numbers!(unfiltered, Unfiltered, ["xx", "xy", "yy"]),
        RecordField {
            name: "index",
            components: &[""],
            step: None,
            part: RecordPart::Wholes(|r| from_ref(&r.index), |r| from_mut(&mut r.index)),
        },
        numbers!(covariance, Covariance, ["xx", "xy", "xz", "yy", "yz", "zz"]),
        numbers!(center, Center, ["x", "y"]),
        RecordField {
            name: "bounds",
            components: &["x0", "y0", "x1", "y1"],
            step: None,
            part: RecordPart::Wholes(|r| &r.bounds, |r| &mut r.bounds),
        },
    ];
}

impl GaussianRecord {
    /// The number of bytes of a record, and the distance from one to the next.
    pub const SIZE: usize = size_of::<Self>();

    /// Name, offset in bytes and type of each field, in order.
    pub const FIELDS: [(&'static str, usize, &'static str); 13] = {
        let (mut fields, mut i, mut offset) = ([("", 0, ""); 13], 0, 0);
        while i < fields.len() {
            let field = &Self::TABLE[i];
            fields[i] = (field.name, offset, field.kind());
            (i, offset) = (i + 1, offset + 4 * field.components.len());
        }
        fields
    };

    /// Writes the fields in order, little-endian, without padding.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::SIZE] {
        let mut words = Vec::with_capacity(Self::SIZE / 4);
        for field in &Self::TABLE {
            match field.part {
                RecordPart::Numbers(of, _) => words.extend(of(self).iter().map(|n| n.to_bits())),
                RecordPart::Wholes(of, _) => words.extend(of(self)),
            }
        }
        little_endian(&words)
    }

    /// Reads a record from bytes that [`GaussianRecord::to_bytes`] wrote.
    #[must_use]
    pub fn from_bytes(bytes: &[u8; Self::SIZE]) -> Self {
        let mut record = Self::default();
        let mut words = bytes.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word));
        for field in &Self::TABLE {
            match field.part {
                RecordPart::Numbers(_, of) => {
                    let numbers = of(&mut record).iter_mut();
                    numbers.zip(&mut words).for_each(|(n, word)| *n = f32::from_bits(word));
                }
                RecordPart::Wholes(_, of) => {
                    let wholes = of(&mut record).iter_mut();
                    wholes.zip(&mut words).for_each(|(n, word)| *n = word);
                }
            }
        }
        record
    }
}

impl<R: Copy> GaussianRecord<R> {
    /// The record of a projected item.
    pub(crate) fn new(
        index: u32,
        Projected { on_screen, alpha, distance, .. }: &Projected<R>,
        key: R,
        color: [R; 3],
        bounds: [u32; 4],
    ) -> Self {
        Self {
            place: [on_screen.place.x, on_screen.place.y, on_screen.place.z],
            key,
            color,
            alpha: *alpha,
            conic: on_screen.conic,
            compensation: on_screen.compensation,
            ellipse: on_screen.ellipse,
            distance: *distance,
            unfiltered: on_screen.unfiltered,
            index,
            covariance: on_screen.covariance,
            center: [on_screen.center.x, on_screen.center.y],
            bounds,
        }
    }
}

/// Projects the visible splats of a scene, in the order in which they are blended, and counts the
/// fates of all. If each pixel has an order of its own, they ascend by index.
#[must_use]
pub fn project_records(job: &Job<'_>, settings: &Settings) -> (Vec<GaussianRecord>, Tally) {
    let source = Source::<f32>::new(job.scene, job.camera, settings);
    let splats = Splats::new(job, &job.grid(), &source);
    let record = |place: usize| {
        let splat = splats.at(place);
        let projected = source.project(splat.index as usize);
        let b = splat.bounds;
        let bounds = [b.x0, b.y0, b.x1, b.y1];
        GaussianRecord::new(splat.index, &projected, splat.key, splat.color, bounds)
    };
    (splats.all_places().into_iter().map(record).collect(), splats.tally)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_follow_each_other_and_are_found_in_the_bytes() {
        let record = GaussianRecord {
            place: [1.0, 2.0, 3.0],
            key: 4.0,
            color: [5.0, 6.0, 7.0],
            alpha: 8.0,
            conic: [9.0, 10.0, 11.0],
            compensation: 12.0,
            ellipse: [13.0, 14.0, 15.0],
            distance: 16.0,
            unfiltered: [17.0, 18.0, 19.0],
            index: 20,
            covariance: [21.0, 22.0, 23.0, 24.0, 25.0, 26.0],
            center: [27.0, 28.0],
            bounds: [29, 30, 31, 32],
        };
        assert_eq!((GaussianRecord::SIZE, align_of::<GaussianRecord>()), (128, 4));
        let (bytes, mut at) = (record.to_bytes(), 0);
        for (name, offset, kind) in GaussianRecord::FIELDS {
            assert_eq!(offset, at, "{name}");
            let count: usize = kind[3..].trim_start_matches(" x ").parse().unwrap_or(1);
            for i in at / 4..at / 4 + count {
                let value = i as u32 + 1;
                let bits = if kind.starts_with('f') { (value as f32).to_bits() } else { value };
                assert_eq!(bytes[4 * i..4 * i + 4], bits.to_le_bytes(), "{name}");
            }
            at += 4 * count;
        }
        assert_eq!(at, GaussianRecord::SIZE);
        assert_eq!(GaussianRecord::from_bytes(&bytes), record);
    }
}
