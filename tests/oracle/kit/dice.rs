//! Random numbers that are few digits long.

use glam::Vec3;

/// Random numbers: a 64-bit congruential generator, upper bits.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    /// In [low, high), in 4096 steps, so that sums stay exact.
    pub(crate) fn within(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * ((self.bits() % 4096) as f32 / 4096.0)
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    pub(crate) fn vector(&mut self, low: Vec3, high: Vec3) -> Vec3 {
        Vec3::new(
            self.within(low.x, high.x),
            self.within(low.y, high.y),
            self.within(low.z, high.z),
        )
    }

    /// A direction, not one of the axes.
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.vector(Vec3::splat(-1.0), Vec3::ONE);
            if v.length() > 0.25 && v.length() < 1.0 {
                return v.normalize();
            }
        }
    }

    pub(crate) fn axis(&mut self) -> Vec3 {
        let sign = if self.below(2) == 0 { 1.0 } else { -1.0 };
        [Vec3::X, Vec3::Y, Vec3::Z][self.below(3)] * sign
    }
}
