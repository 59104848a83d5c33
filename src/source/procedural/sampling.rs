//! Collecting surfels: cells of a grid and golden spirals.

use crate::error::Result;
use crate::number::random;
use crate::scene::{Cloud, Surfels};
use glam::DVec3;

/// Surfels in the making, each number rounded to `f32` as it is pushed.
pub(super) struct Sampler {
    seed: u64,
    cloud: Cloud,
    normal: Vec<glam::Vec3>,
    radius: Vec<f32>,
    color: Vec<glam::Vec3>,
}

impl Sampler {
    /// None yet, room for `count`.
    pub(super) fn new(count: usize, seed: u64) -> Self {
        Self {
            seed,
            cloud: Cloud { position: Vec::with_capacity(count), ..Cloud::default() },
            normal: Vec::with_capacity(count),
            radius: Vec::with_capacity(count),
            color: Vec::with_capacity(count),
        }
    }

    /// One more surfel.
    pub(super) fn push(&mut self, position: DVec3, normal: DVec3, radius: f64, color: DVec3) {
        self.cloud.position.push(position.as_vec3());
        self.normal.push(normal.as_vec3());
        self.radius.push(radius as f32);
        self.color.push(color.as_vec3());
    }

    /// Where in its cell, a unit square, the next surfel lies: at most 1/8 from the middle in
    /// either direction, by random numbers 2i and 2i + 1 of the seed for surfel i.
    pub(super) fn displaced(&self) -> [f64; 2] {
        let index = 2 * self.radius.len() as u64;
        [index, index + 1].map(|i| 0.5 + (f64::from(random::unit(self.seed, i)) - 0.5) / 4.0)
    }

    /// Azimuth in radians of point `i` of a golden spiral: 2 pi times the fractional part of
    /// i / golden ratio, turned by the bits of the seed.
    ///
    /// Fractions are kept in 64-bit integers, which wrap as angles do, so that no digit is lost
    /// however large `i` is.
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

/// The radius of a disc that covers a cell of these sides from anywhere near its middle: the root
/// mean square of the sides, which is sqrt(2) times half the diagonal.
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
