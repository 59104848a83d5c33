//! Fit a plane to a neighbourhood.

use super::neighbours::Neighbour;
use glam::{DVec3, Vec3};

/// The direction in which a point and its neighbours vary least, of length 1.
///
/// This is the eigenvector of the smallest eigenvalue of their covariance, see the arithmetic of
/// [`super`]. Of equal eigenvalues the first wins, so that collinear points get some direction
/// across the line. The sign of the result has no meaning.
pub(super) fn normal(points: &[Vec3], of: u32, neighbours: &[Neighbour]) -> Vec3 {
    let center = points[of as usize].as_dvec3();
    let mut ids: Vec<u32> = neighbours.iter().map(|n| n.id).chain([of]).collect();
    ids.sort_unstable();
    let offset = |id: u32| points[id as usize].as_dvec3() - center;
    let mut mean = DVec3::ZERO;
    for &id in &ids {
        mean += offset(id);
    }
    mean /= ids.len() as f64;
    let mut covariance = [[0.0; 3]; 3];
    for &id in &ids {
        let d = (offset(id) - mean).to_array();
        for (row, a) in covariance.iter_mut().zip(d) {
            for (sum, b) in row.iter_mut().zip(d) {
                *sum += a * b;
            }
        }
    }
    let (values, vectors) = eigen(covariance);
    let mut least = 0;
    for other in 1..3 {
        if values[other] < values[least] {
            least = other;
        }
    }
    vectors[least].as_vec3()
}

/// Eigenvalues and unit eigenvectors of a symmetric matrix.
///
/// Cyclic Jacobi: eight sweeps of one rotation for each of (0, 1), (0, 2), (1, 2); four sweeps
/// bring any matrix to rounding. The number of sweeps is fixed, and the only operations are
/// `+ - * / sqrt`.
fn eigen(mut m: [[f64; 3]; 3]) -> ([f64; 3], [DVec3; 3]) {
    let mut vectors = [DVec3::X, DVec3::Y, DVec3::Z];
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[p][q] == 0.0 {
                continue;
            }
            // t is the tangent of the smaller angle that makes m[p][q] zero; 0 if theta overflows.
            let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
            let root = theta.abs() + (theta * theta + 1.0).sqrt();
            let t = if theta < 0.0 { -1.0 / root } else { 1.0 / root };
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            let r = 3 - p - q;
            let (mpr, mqr) = (m[p][r], m[q][r]);
            m[p][p] -= t * m[p][q];
            m[q][q] += t * m[p][q];
            (m[p][q], m[q][p]) = (0.0, 0.0);
            (m[p][r], m[q][r]) = (c * mpr - s * mqr, s * mpr + c * mqr);
            (m[r][p], m[r][q]) = (m[p][r], m[q][r]);
            let (vp, vq) = (vectors[p], vectors[q]);
            (vectors[p], vectors[q]) = (c * vp - s * vq, s * vp + c * vq);
        }
    }
    ([m[0][0], m[1][1], m[2][2]], vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn apply(m: [[f64; 3]; 3], v: DVec3) -> DVec3 {
        DVec3::from_array(m.map(|row| DVec3::from_array(row).dot(v)))
    }

    proptest! {
        #[test]
        fn eigenvectors_are_those_of_the_matrix(
            d in prop::array::uniform6(-1.0_f64..1.0),
            degenerate in any::<bool>(),
            exponent in -80_i32..80,
        ) {
            let scale = f64::from_bits(((1023 + exponent) as u64) << 52);
            let [a, b, c, d, e, f] = d.map(|v| v * scale);
            // A rank of one gives two equal eigenvalues, as collinear points do.
            let m = if degenerate {
                let v = [a, b, c].map(|v| v / scale);
                v.map(|x| v.map(|y| x * y * scale))
            } else {
                [[a, d, e], [d, b, f], [e, f, c]]
            };
            let (values, vectors) = eigen(m);
            for (value, vector) in values.into_iter().zip(vectors) {
                prop_assert!((vector.length() - 1.0).abs() < 1e-14);
                prop_assert!((apply(m, vector) - value * vector).length() < 1e-14 * scale * 4.0);
            }
            prop_assert!(vectors[0].dot(vectors[1]).abs() < 1e-14);
            prop_assert!(vectors[0].cross(vectors[1]).dot(vectors[2]).abs() > 1.0 - 1e-14);
        }
    }

    #[test]
    fn a_tilted_plane_gives_its_normal_at_any_scale() {
        let (u, v) = (Vec3::new(2.0, 1.0, 0.0), Vec3::new(-1.0, 2.0, 4.0));
        let truth = u.as_dvec3().cross(v.as_dvec3()).normalize();
        for scale in [1e-30, 1.0, 1e30] {
            let points: Vec<Vec3> =
                (0..9).map(|i| ((i % 3) as f32 * u + (i / 3) as f32 * v) * scale).collect();
            let others: Vec<_> = (1..9).map(|id| Neighbour { distance2: 0.0, id }).collect();
            let found = normal(&points, 0, &others).as_dvec3();
            assert!(found.dot(truth).abs() > 1.0 - 1e-6, "{found} instead of {truth}");
        }
    }
}
