//! Spheres: a single one, and the cluster.

use super::sampling::Sampler;
use super::{Hit, PALETTE, pattern};
use crate::number::{elementary, random};
use glam::DVec3;
use std::f64::consts::PI;

/// A sphere.
pub(super) struct Ball {
    pub(super) center: DVec3,
    pub(super) radius: f64,
    /// Its single colour; `None` uses [`pattern`].
    pub(super) color: Option<DVec3>,
}

/// The unit sphere.
pub(super) const SPHERE: Ball = Ball { center: DVec3::ZERO, radius: 1.0, color: None };

/// The spheres of the cluster. The random numbers 4k to 4k + 3 of seed 6 give the place and the
/// size of sphere k.
///
/// With this seed no sphere lies inside another, and spheres that overlap differ in colour.
pub(super) fn cluster() -> Vec<Ball> {
    let ball = |k: usize| {
        let unit = |j: u64| f64::from(random::unit(6, 4 * k as u64 + j));
        let center = DVec3::new(unit(0), unit(1), unit(2)) * 2.0 - 1.0;
        let radius = 0.125 + 0.25 * unit(3);
        Ball { center, radius, color: Some(DVec3::from(PALETTE[k % PALETTE.len()])) }
    };
    (0..32).map(ball).collect()
}

/// Adds `count` surfels. Each ball gets a share by its area, but at least one; on each ball they
/// form a golden spiral around +y.
///
/// Surfel i of n on a ball lies at the height 1 - (2i + 1)/n above the centre, in radii, because
/// equal steps in height cut equal areas from a sphere.
pub(super) fn sample(balls: &[Ball], count: usize, sampler: &mut Sampler) {
    let squares: f64 = balls.iter().map(|ball| ball.radius * ball.radius).sum();
    let (mut before, mut first) = (0.0, 0);
    for ball in balls {
        before += ball.radius * ball.radius;
        let end = (count as f64 * (before / squares) + 0.5).floor() as usize;
        let n = if end > first { end - first } else { 1 };
        first += n;
        let spacing = ball.radius * (4.0 * PI / n as f64).sqrt();
        for i in 0..n {
            let y = 1.0 - (2 * i + 1) as f64 / n as f64;
            let ring = (1.0 - y * y).sqrt();
            let angle = sampler.golden_angle(i);
            let normal =
                DVec3::new(ring * elementary::cos(angle), y, ring * elementary::sin(angle));
            let p = ball.center + normal * ball.radius;
            sampler.push(p, normal, spacing, ball.color.unwrap_or_else(|| pattern(p)));
        }
    }
}

impl Ball {
    /// The nearest hit at a parameter > `beyond`.
    ///
    /// The hits are half the chord before and behind the point of the ray that is closest to the
    /// centre. This way the discriminant has no large terms that cancel, however far away the ray
    /// starts.
    pub(super) fn trace(&self, origin: DVec3, direction: DVec3, beyond: f64) -> Option<Hit> {
        let from_center = origin - self.center;
        let squared = direction.dot(direction);
        let middle = -from_center.dot(direction) / squared;
        let closest = from_center + direction * middle;
        let discriminant = self.radius * self.radius - closest.dot(closest);
        let half = (discriminant / squared).sqrt();
        // NaN if the ray misses the ball, or has no direction.
        if half.is_nan() {
            return None;
        }
        let t = [middle - half, middle + half].into_iter().find(|&t| t > beyond)?;
        let offset = closest + direction * (t - middle);
        let color = self.color.unwrap_or_else(|| pattern(self.center + offset));
        Some(Hit { t, normal: offset.normalize(), color })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_of_the_cluster_overlap_in_different_colours() {
        let balls = cluster();
        let mut overlaps = 0;
        for (i, a) in balls.iter().enumerate() {
            for b in &balls[..i] {
                let distance = a.center.distance(b.center);
                assert!(distance > (a.radius - b.radius).abs(), "one swallows another");
                if distance < a.radius + b.radius {
                    overlaps += 1;
                    assert_ne!(a.color, b.color);
                }
            }
        }
        assert!((10..100).contains(&overlaps), "{overlaps}");
    }
}
