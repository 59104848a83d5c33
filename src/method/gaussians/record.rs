//! Export projected Gaussians as bytes for a backend to upload, or to hold its own projection against.

use super::Settings;
use super::order::Splats;
use super::splats::Source;
use crate::method::algorithm::Job;
use crate::number::MapInline;
use crate::splat::Tally;
use crate::splat::record::little_endian;
use std::mem::{offset_of, size_of};

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
/// With discs that meet rays, `alpha` is the opacity. V, its inverse, V0 and `compensation` then
/// describe the ellipse of the Gaussian, which no fragment uses.
///
/// numpy reads them with `dtype=[("place", "<f4", 3), ("key", "<f4"), ...]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct GaussianRecord {
    /// The centre in the camera frame: x right, y down, t into the picture.
    pub place: [f32; 3],
    /// What the order compares.
    pub key: f32,
    /// The colour, in the space of blending.
    pub color: [f32; 3],
    /// o, the opacity times the compensation.
    pub alpha: f32,
    /// V^-1: (xx, xy, yy), in 1 / px^2.
    pub conic: [f32; 3],
    /// The factor of the opacity.
    pub compensation: f32,
    /// V: (xx, xy, yy), in px^2.
    pub ellipse: [f32; 3],
    /// The distance from the camera's centre; t under an orthographic camera.
    pub distance: f32,
    /// V0: (xx, xy, yy), in px^2.
    pub unfiltered: [f32; 3],
    /// The index in the scene.
    pub index: u32,
    /// S': (xx, xy, xz, yy, yz, zz), in world units^2.
    pub covariance: [f32; 6],
    /// Column and row of the centre, in px.
    pub center: [f32; 2],
    /// The pixels that may have fragments: x0, y0, x1, y1, the ends exclusive.
    pub bounds: [u32; 4],
}

impl GaussianRecord {
    /// The number of bytes of a record, and the distance from one to the next.
    pub const SIZE: usize = size_of::<Self>();

    /// Name, offset in bytes and type of each field, in order.
    pub const FIELDS: [(&'static str, usize, &'static str); 13] = [
        ("place", offset_of!(Self, place), "f32 x 3"),
        ("key", offset_of!(Self, key), "f32"),
        ("color", offset_of!(Self, color), "f32 x 3"),
        ("alpha", offset_of!(Self, alpha), "f32"),
        ("conic", offset_of!(Self, conic), "f32 x 3"),
        ("compensation", offset_of!(Self, compensation), "f32"),
        ("ellipse", offset_of!(Self, ellipse), "f32 x 3"),
        ("distance", offset_of!(Self, distance), "f32"),
        ("unfiltered", offset_of!(Self, unfiltered), "f32 x 3"),
        ("index", offset_of!(Self, index), "u32"),
        ("covariance", offset_of!(Self, covariance), "f32 x 6"),
        ("center", offset_of!(Self, center), "f32 x 2"),
        ("bounds", offset_of!(Self, bounds), "u32 x 4"),
    ];

    /// Writes the fields in order, little-endian, without padding.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::SIZE] {
        let mut words = [0; Self::SIZE / 4];
        let mut at = 0;
        let mut put = |bits: &[u32]| {
            words[at..at + bits.len()].copy_from_slice(bits);
            at += bits.len();
        };
        let three = [
            (self.place, self.key),
            (self.color, self.alpha),
            (self.conic, self.compensation),
            (self.ellipse, self.distance),
        ];
        for (vector, last) in three {
            put(&vector.map_inline(f32::to_bits));
            put(&[last.to_bits()]);
        }
        put(&self.unfiltered.map_inline(f32::to_bits));
        put(&[self.index]);
        put(&self.covariance.map_inline(f32::to_bits));
        put(&self.center.map_inline(f32::to_bits));
        put(&self.bounds);
        little_endian(&words)
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
        let (on_screen, b) = (projected.on_screen, splat.bounds);
        GaussianRecord {
            place: [on_screen.place.x, on_screen.place.y, on_screen.place.z],
            key: splat.key,
            color: splat.color,
            alpha: splat.alpha,
            conic: on_screen.conic,
            compensation: on_screen.compensation,
            ellipse: on_screen.ellipse,
            distance: projected.distance,
            unfiltered: on_screen.unfiltered,
            index: splat.index,
            covariance: on_screen.covariance,
            center: [on_screen.center.x, on_screen.center.y],
            bounds: [b.x0, b.y0, b.x1, b.y1],
        }
    };
    ((0..splats.len()).map(record).collect(), splats.tally)
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
    }
}
