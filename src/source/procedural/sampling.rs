//! Rebuild the surfels of each shape bit by bit: this page has every step.
//!
//! All numbers are f64. Each operation is rounded, in the order written; a product or quotient
//! without brackets is computed from the left. PI and TAU are the f64 nearest to pi and 2 pi. Sin
//! and cos are the functions of [`crate::number::elementary`] in f64. N is the requested count, and
//! u(i) is [`random::unit`] of the seed and i, as f64. Surfels are numbered s = 0, 1, ... over the
//! whole shape, in the order in which they are made. Each component of position, normal and colour,
//! and the radius, is rounded to `f32` once at the end. Nothing is dropped: see
//! [`Surfels::new`](crate::scene::Surfels::new).
//!
//! ```text
//!   round(x)       = floor(x + 1/2)
//!   e(s), f(s)     = 1/2 + (u(2 s) - 1/2) / 4, and so with u(2 s + 1)
//!   cell(a, b)     = sqrt((a a + b b) / 2)                the radius in a cell of sides a and b
//!   pattern(p)     = (1/2 + 3/8 sin(9 p.x), 1/2 + 3/8 sin(11 p.y + 1), 1/2 + 3/8 sin(7 p.z + 2))
//! ```
//!
//! | k | colour k of the palette |
//! |---|---|
//! | 0 | 0.875, 0.25, 0.0625 |
//! | 1 | 0.0625, 0.25, 0.75 |
//! | 2 | 0.875, 0.625, 0.0625 |
//! | 3 | 0.125, 0.5, 0.25 |
//! | 4 | 0.625, 0.0625, 0.375 |
//! | 5 | 0.125, 0.625, 0.75 |
//! | 6 | 0.75, 0.75, 0.6875 |
//! | 7 | 0.375, 0.1875, 0.625 |
//!
//! # Sphere and cluster
//!
//! The sphere is one ball of centre c = 0 and radius r = 1. The cluster is 32 balls. Let v(i) be
//! [`random::unit`] of seed 6 and i, whatever the seed of the surfels. Then ball k has
//!
//! ```text
//!   c = (v(4 k) 2 - 1, v(4 k + 1) 2 - 1, v(4 k + 2) 2 - 1)      r = 1/8 + 1/4 v(4 k + 3)
//! ```
//!
//! The surfels are made ball by ball. S is the sum of r r over all balls, and B is the sum over the
//! balls up to and including this one. Both are added in the order of the balls. The first ball has
//! first = 0.
//!
//! ```text
//!   end    = round(N (B / S))       n = end - first if end > first, else 1       first += n
//!   radius = r sqrt(4 PI / n)
//!   for i = 0 to n - 1:
//!     y = 1 - (2 i + 1) / n         ring = sqrt(1 - y y)
//!     angle = floor(T / 2^11) (TAU / 2^53)
//!     T = (bits + i G) modulo 2^64  bits: random::bits of the seed and 0; G: random::GOLDEN
//!     normal = (ring cos(angle), y, ring sin(angle))
//!     position = c + normal r
//!     colour = pattern(position), of the cluster colour k modulo 8
//! ```
//!
//! # Torus
//!
//! ```text
//!   spacing = sqrt(TAU TAU (3/8) / N)
//!   rows    = round(TAU (3/8) / spacing), at least 1        h = TAU / rows        first = 0
//!   for row = 0 to rows - 1:
//!     edge   = (row + 1) h
//!     end    = round(N ((edge + (3/8) sin(edge)) / TAU))    n = end - first       first = end
//!     around = TAU (1 + (3/8) cos(edge - h / 2))
//!     radius = cell((3/8) h, around / n)
//!     for i = 0 to n - 1:
//!       a = (i + e(s)) (TAU / n)    b = (row + f(s)) h      out = 1 + (3/8) cos(b)
//!       normal   = (cos(b) cos(a), sin(b), cos(b) sin(a))
//!       position = (out cos(a), (3/8) sin(b), out sin(a))
//!       colour   = pattern(position)
//! ```
//!
//! # Checkerboard
//!
//! ```text
//!   half = round(sqrt(N / 8.5) / 2), at least 1
//!   for ring = 0 to 10:
//!     side = 4 2^ring / half        radius = cell(side, side)
//!     for row = 0 to 2 half - 1, for column = 0 to 2 half - 1:
//!       left out if ring > 0 and both row and column are in the hole:
//!         i is in the hole if 2 i >= half and 2 i + 2 <= 3 half
//!       position = (((column - half) + e(s)) side, 0, ((row - half) + f(s)) side)
//!       normal   = (0, 1, 0)
//! ```
//!
//! The colour depends on the position p after rounding to `f32`. With
//! m = floor(p.x / square) + floor(p.z / square), it is light, (0.875, 0.84375, 0.75), if m is
//! even, else dark, (0.0625, 0.09375, 0.1875).
//!
//! # Sheets and staircase
//!
//! Plates, each low <= (x, y) <= high at one z, one after the other:
//!
//! | shape | plate | low | high | z | normal | colour |
//! |---|---|---|---|---|---|---|
//! | sheets | front | (-1, -1) | (1, 1) | 0 | (0, 0, 1) | 0 |
//! | | back | (-3/2, -3/2) | (3/2, 3/2) | -gap | (0, 0, 1) | 1 |
//! | staircase, k = 0 to 7 | front k | (-1, k/4 - 9/8) | (1, (k/4 - 9/8) + 1/2) | (-k) step | (0, 0, 1) | k |
//! | | back k, after front k | the same | the same | (-k) step - thickness | (-0, -0, -1) | 1 - colour k |
//!
//! The z of front 0 is -0.
//!
//! ```text
//!   spacing = sqrt(A / N)           A: the sum of width height over the plates in their order,
//!                                   width = high.x - low.x, height = high.y - low.y
//!   for each plate:
//!     columns = round(width / spacing), at least 1       rows = round(height / spacing), likewise
//!     dx = width / columns          dy = height / rows          radius = cell(dx, dy)
//!     for row = 0 to rows - 1, for column = 0 to columns - 1:
//!       position = (low.x + (column + e(s)) dx, low.y + (row + f(s)) dy, z)
//! ```

#[cfg(test)]
mod rebuilt;

use crate::error::Result;
use crate::number::MapInline;
use crate::number::random;
use crate::scene::{Cloud, Surfels};
use glam::DVec3;

/// Surfels in the making; each number is rounded to `f32` as it is pushed.
pub(super) struct Sampler {
    seed: u64,
    cloud: Cloud,
    normal: Vec<glam::Vec3>,
    radius: Vec<f32>,
    color: Vec<glam::Vec3>,
}

impl Sampler {
    /// No surfels yet, with room for `count`.
    pub(super) fn new(count: usize, seed: u64) -> Self {
        Self {
            seed,
            cloud: Cloud { position: Vec::with_capacity(count), ..Cloud::default() },
            normal: Vec::with_capacity(count),
            radius: Vec::with_capacity(count),
            color: Vec::with_capacity(count),
        }
    }

    /// Adds one surfel.
    pub(super) fn push(&mut self, position: DVec3, normal: DVec3, radius: f64, color: DVec3) {
        self.cloud.position.push(position.as_vec3());
        self.normal.push(normal.as_vec3());
        self.radius.push(radius as f32);
        self.color.push(color.as_vec3());
    }

    /// The place of the next surfel in its cell, a unit square: at most 1/8 from the middle in each
    /// direction, by the random numbers 2i and 2i + 1 of the seed for surfel i.
    pub(super) fn displaced(&self) -> [f64; 2] {
        let index = 2 * self.radius.len() as u64;
        [index, index + 1].map_inline(|i| 0.5 + (f64::from(random::unit(self.seed, i)) - 0.5) / 4.0)
    }

    /// The azimuth in radians of point `i` of a golden spiral: 2 pi times the fractional part of
    /// i / golden ratio, turned by the bits of the seed.
    ///
    /// Fractions are 64-bit integers, which wrap as angles do, so that no digit is lost however
    /// large `i` is.
    pub(super) fn golden_angle(&self, i: usize) -> f64 {
        let start = random::bits(self.seed, 0);
        let turn = start.wrapping_add((i as u64).wrapping_mul(random::GOLDEN));
        (turn >> 11) as f64 * (std::f64::consts::TAU / 9_007_199_254_740_992.0)
    }

    /// The surfels.
    pub(super) fn finish(self) -> Result<Surfels> {
        let cloud = Cloud {
            normal: Some(self.normal),
            radius: Some(self.radius),
            color: Some(self.color),
            ..self.cloud
        };
        Surfels::new(cloud).map(|(surfels, _)| surfels)
    }
}

/// The radius of a disc that covers a cell of these sides from anywhere near its middle. It is the
/// root mean square of the sides, which is sqrt(2) times half the diagonal.
pub(super) fn cell_radius(a: f64, b: f64) -> f64 {
    ((a * a + b * b) / 2.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_angles_are_fractions_of_a_turn() {
        let sampler = Sampler::new(0, 3);
        let golden_ratio = (1.0 + 5.0_f64.sqrt()) / 2.0;
        let first = sampler.golden_angle(0);
        for i in [1, 2, 1000] {
            let expected = std::f64::consts::TAU * (i as f64 / golden_ratio);
            let turns = (sampler.golden_angle(i) - first - expected) / std::f64::consts::TAU;
            assert!((turns - turns.round()).abs() < 1e-12, "{i}: {turns}");
        }
    }

    #[test]
    fn a_displaced_surfel_covers_its_cell() {
        let mut sampler = Sampler::new(0, 5);
        for _ in 0..1000 {
            let [x, y] = sampler.displaced();
            assert!((x - 0.5).abs() <= 0.125 && (y - 0.5).abs() <= 0.125);
            let farthest = |v: f64| if v < 0.5 { 1.0 - v } else { v };
            // A cell of 3 x 1: the worst of its corners.
            let corner = (9.0 * farthest(x) * farthest(x) + farthest(y) * farthest(y)).sqrt();
            assert!(corner < 0.89 * cell_radius(3.0, 1.0));
            sampler.push(DVec3::ZERO, DVec3::Z, 1.0, DVec3::ZERO);
        }
    }
}
