//! The torus: its surfels, and its intersections with rays.

use super::sampling::{Sampler, cell_radius};
use super::{Hit, pattern};
use crate::number::elementary::{cos, sin};
use glam::DVec3;
use std::f64::consts::TAU;

/// Radius of the circle that the tube follows, in the plane y = 0.
const RING: f64 = 1.0;
/// Radius of the tube.
const TUBE: f64 = 0.375;

/// Adds `count` surfels in rows around +y, one in each cell of a row.
///
/// The tube is cut into rows of one width, about the spacing. Row j spans the angles TAU j/rows to
/// TAU (j + 1)/rows around the tube, where 0 is the outside. The area up to angle v is
/// v + (TUBE/RING) sin v of TAU. The number of surfels before v is `count` times that, rounded.
/// Thus the cells are nearly square, and their total is exact.
pub(super) fn sample(count: usize, sampler: &mut Sampler) {
    let spacing = (TAU * RING * TAU * TUBE / count as f64).sqrt();
    let rows = (TAU * TUBE / spacing + 0.5).floor() as usize;
    let rows = if rows < 1 { 1 } else { rows };
    let angle = TAU / rows as f64;
    let mut first = 0;
    for row in 0..rows {
        let edge = (row + 1) as f64 * angle;
        let end = (count as f64 * ((edge + TUBE / RING * sin(edge)) / TAU) + 0.5).floor() as usize;
        let n = end - first;
        first = end;
        let around = TAU * (RING + TUBE * cos(edge - angle / 2.0));
        let radius = cell_radius(TUBE * angle, around / n as f64);
        for i in 0..n {
            let [x, y] = sampler.displaced();
            let u = (i as f64 + x) * (TAU / n as f64);
            let v = (row as f64 + y) * angle;
            let (cos_u, sin_u, cos_v, sin_v) = (cos(u), sin(u), cos(v), sin(v));
            let normal = DVec3::new(cos_v * cos_u, sin_v, cos_v * sin_u);
            let out = RING + TUBE * cos_v;
            let p = DVec3::new(out * cos_u, TUBE * sin_v, out * sin_u);
            sampler.push(p, normal, radius, pattern(p));
        }
    }
}

/// The nearest hit at a parameter > `beyond`.
///
/// The torus is (|p|^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + z^2). Let s be the length along the ray from
/// the point c closest to the centre. Then |p|^2 is s^2 + |c|^2, so that the quartic has no cubic
/// term.
pub(super) fn trace(origin: DVec3, direction: DVec3, beyond: f64) -> Option<Hit> {
    let length = direction.length();
    let d = direction / length;
    let middle = -origin.dot(d);
    let c = origin + d * middle;
    let square = c.dot(c);
    // Half the chord through the ball that encloses the torus.
    let reach = ((RING + TUBE) * (RING + TUBE) - square).sqrt();
    // NaN if the ray misses the ball, or has no direction.
    if reach.is_nan() {
        return None;
    }
    let k = square + RING * RING - TUBE * TUBE;
    let four = 4.0 * RING * RING;
    let quartic = Quartic {
        square: 2.0 * k - four * (d.x * d.x + d.z * d.z),
        linear: -2.0 * four * (c.x * d.x + c.z * d.z),
        constant: k * k - four * (c.x * c.x + c.z * c.z),
    };
    let s = quartic.roots(reach).find(|s| (s + middle) / length > beyond)?;
    let p = c + d * s;
    let ring = (p.x * p.x + p.z * p.z).sqrt();
    let on_ring = DVec3::new(p.x / ring, 0.0, p.z / ring) * RING;
    let normal = (p - on_ring).normalize();
    Some(Hit { t: (s + middle) / length, normal, color: pattern(p) })
}

/// s^4 + `square` s^2 + `linear` s + `constant`.
struct Quartic {
    square: f64,
    linear: f64,
    constant: f64,
}

impl Quartic {
    fn value(&self, s: f64) -> f64 {
        ((s * s + self.square) * s + self.linear) * s + self.constant
    }

    fn slope(&self, s: f64) -> f64 {
        (4.0 * s * s + 2.0 * self.square) * s + self.linear
    }

    /// The roots in [-reach, reach] where the sign changes, in ascending order.
    ///
    /// A function crosses zero at most once between neighbouring zeros of its derivative. So the
    /// zeros of the second derivative, +-sqrt(-square / 6), isolate those of the first, and these
    /// isolate the roots. Rounding may make a ray that only touches the torus miss it.
    fn roots(&self, reach: f64) -> impl Iterator<Item = f64> {
        let bend = if self.square < 0.0 { (-self.square / 6.0).sqrt() } else { 0.0 };
        let bend = if bend < reach { bend } else { reach };
        let bends = [-reach, -bend, bend, reach];
        let mut low = -reach;
        // Compute one root at a time, because most rays need only the first.
        (0..4).filter_map(move |i| {
            let slope = |s| self.slope(s);
            let high = match i {
                // Without a zero, an end of the interval serves: it separates nothing.
                0..3 => crossing(slope, bends[i], bends[i + 1]).unwrap_or(bends[i]),
                _ => reach,
            };
            let root = crossing(|s| self.value(s), low, high);
            low = high;
            root
        })
    }
}

/// Finds where a function changes its sign between `low` and `high`, by bisection to the last digit
/// of the interval. If the function is 0 at the low end, that counts as crossed; at the high end it
/// does not.
fn crossing(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> Option<f64> {
    let rising = f(low) < 0.0;
    if (f(high) < 0.0) == rising {
        return None;
    }
    for _ in 0..56 {
        let middle = 0.5 * (low + high);
        if (f(middle) < 0.0) == rising {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::random;

    /// Signed distance to the torus.
    fn distance(p: DVec3) -> f64 {
        let from_ring = DVec3::new((p.x * p.x + p.z * p.z).sqrt() - RING, p.y, 0.0);
        from_ring.length() - TUBE
    }

    /// Sphere tracing: steps of the signed distance, which cannot pass through the surface.
    fn march(origin: DVec3, direction: DVec3) -> Option<f64> {
        let mut t = 0.0;
        for _ in 0..100_000 {
            let step = distance(origin + direction * t);
            t += step;
            if step < 1e-14 {
                return Some(t);
            }
            if t > 20.0 {
                return None;
            }
        }
        panic!("neither hit nor miss from {origin} to {direction}");
    }

    #[test]
    fn hits_agree_with_sphere_tracing() {
        let mut hits = 0;
        for i in 0..2000_u64 {
            let unit = |j: u64| f64::from(random::unit(11, 6 * i + j)) * 2.0 - 1.0;
            let origin = DVec3::new(unit(0), unit(1), unit(2)).normalize() * 5.0;
            let aim = DVec3::new(unit(3), unit(4), unit(5)) * 1.5;
            let direction = (aim - origin).normalize();
            let hit = trace(origin, direction, 0.0);
            let truth = march(origin, direction);
            // Depth is a square root of the distance to a tangent: near one, digits are lost.
            let slant = hit.map_or(1.0, |hit| hit.normal.dot(direction).abs());
            if slant < 1e-3 {
                continue;
            }
            assert_eq!(hit.is_some(), truth.is_some(), "from {origin} along {direction}");
            if let (Some(hit), Some(t)) = (hit, truth) {
                hits += 1;
                assert!((hit.t - t).abs() * slant < 1e-12, "{} instead of {t}", hit.t);
                assert!(distance(origin + direction * hit.t).abs() < 1e-13);
            }
        }
        assert!(hits > 800, "{hits}");
    }

    #[test]
    fn a_ray_along_x_meets_all_four_walls() {
        let walls = [-1.375, -0.625, 0.625, 1.375];
        for (i, wall) in walls.into_iter().enumerate() {
            let beyond = if i == 0 { 0.0 } else { (walls[i - 1] + 4.0 + 1e-9) / 2.0 };
            // A direction of length 2: parameters are half the way.
            let hit = trace(DVec3::new(-4.0, 0.0, 0.0), DVec3::X * 2.0, beyond).unwrap();
            assert!((hit.t - (wall + 4.0) / 2.0).abs() < 1e-14, "wall {i}: {}", hit.t);
            let outward = if i % 2 == 0 { -1.0 } else { 1.0 };
            assert!((hit.normal - DVec3::X * outward).length() < 1e-13);
        }
        assert_eq!(trace(DVec3::Y * 4.0, -DVec3::Y, 0.0), None, "through the hole");
    }
}
