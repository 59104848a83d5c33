//! The shapes of splats as bundles of vectors: no matrix of the world is made.

use crate::oracle::kit::eye::{V3, cross, scaled, wide};
use splatref::scene::{Gaussians, Surfels};

/// A Gaussian in the world. S is the sum of v v^T over `spread`, B over `thin`.
pub(crate) struct Shape {
    pub(crate) center: V3,
    pub(crate) spread: [V3; 3],
    pub(crate) thin: [V3; 3],
}

fn add(a: V3, b: V3) -> V3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

const AXES: [V3; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// p + 2 w (v x p) + 2 v x (v x p): the rotation by a unit quaternion without its matrix.
fn rotated([x, y, z, w]: [f64; 4], p: V3) -> V3 {
    let v = [x, y, z];
    let once = cross(v, p);
    add(p, add(scaled(once, 2.0 * w), scaled(cross(v, once), 2.0)))
}

impl Shape {
    pub(crate) fn gaussian(gaussians: &Gaussians, i: usize) -> Self {
        let s = wide(gaussians.scale()[i]);
        let q = gaussians.rotation()[i].map(f64::from);
        let m = s.iter().copied().fold(0.0, f64::max);
        let ratio = |a: usize, b: usize| if m == 0.0 { 0.0 } else { s[a] * s[b] / (m * m) };
        let b = [ratio(1, 2), ratio(0, 2), ratio(0, 1)];
        let axis = AXES.map(|axis| rotated(q, axis));
        Self {
            center: wide(gaussians.position()[i]),
            spread: [0, 1, 2].map(|k| scaled(axis[k], s[k])),
            thin: [0, 1, 2].map(|k| scaled(axis[k], b[k])),
        }
    }

    /// A disc is spread along what is perpendicular to its normal n: n x e for each axis e.
    pub(crate) fn surfel(surfels: &Surfels, i: usize, cutoff: f64) -> Self {
        let (center, zero) = (wide(surfels.position()[i]), [0.0; 3]);
        if let Some(tangents) = surfels.tangents() {
            let [u, v] = tangents[i].map(|t| scaled(wide(t), 1.0 / cutoff));
            return Self { center, spread: [u, v, zero], thin: [cross(u, v), zero, zero] };
        }
        let (n, s) = (wide(surfels.normal()[i]), f64::from(surfels.radius()[i]) / cutoff);
        let spread = AXES.map(|axis| scaled(cross(n, axis), s));
        Self { center, spread, thin: [n, zero, zero] }
    }
}
