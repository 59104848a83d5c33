//! Put Gaussians where a node stretches them by a different factor along each of its axes.
//!
//! Such a node turns an ellipsoid into another one, with other axes. Its half axes are the columns of
//! `M R S`, with M the 3 x 3 matrix of the node, R the rotation of the Gaussian and S its scales. One-sided
//! Jacobi rotations, which leave the ellipsoid as it is, make the columns perpendicular. Their lengths
//! are the new scales, and their directions the new rotation.

use crate::number::MapInline;
use glam::{DMat3, DQuat, DVec3, Vec3};

/// Sweeps over the three pairs of columns; they converge quadratically, after about four.
const SWEEPS: usize = 30;
/// Columns whose directions have a smaller cosine are perpendicular.
const PERPENDICULAR: f64 = 1e-15;

/// The scale and the rotation (x, y, z, w) of a stretched Gaussian.
pub(super) fn stretch(matrix: DMat3, scale: Vec3, rotation: [f32; 4]) -> (Vec3, [f32; 4]) {
    let own = DQuat::from_array(rotation.map_inline(f64::from));
    let length = own.length();
    // A rotation of no length stays so, to be dropped.
    if !(length > 0.0 && length.is_finite()) {
        return (scale, rotation);
    }
    let half = matrix * DMat3::from_quat(own / length) * DMat3::from_diagonal(scale.as_dvec3());
    let mut half = [half.x_axis, half.y_axis, half.z_axis];
    for _ in 0..SWEEPS {
        let turned = [(0, 1), (0, 2), (1, 2)].map(|(i, j)| turn(&mut half, i, j));
        if turned == [false; 3] {
            break;
        }
    }
    let lengths = half.map(DVec3::length);
    let axes = frame(half, lengths);
    let turned = DQuat::from_mat3(&axes).normalize();
    let [x, y, z] = lengths.map_inline(|length| length as f32);
    (Vec3::new(x, y, z), turned.to_array().map_inline(|part| part as f32))
}

/// Makes two columns perpendicular; false if they are.
fn turn(columns: &mut [DVec3; 3], i: usize, j: usize) -> bool {
    let (a, b) = (columns[i], columns[j]);
    let (aa, bb, ab) = (a.dot(a), b.dot(b), a.dot(b));
    if !(ab.abs() > PERPENDICULAR * (aa * bb).sqrt()) {
        return false;
    }
    let zeta = (bb - aa) / (2.0 * ab);
    let tangent = 1.0 / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
    let tangent = if zeta < 0.0 { -tangent } else { tangent };
    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
    let sine = cosine * tangent;
    (columns[i], columns[j]) = (a * cosine - b * sine, a * sine + b * cosine);
    true
}

/// A right-handed frame whose axes lie along the half axes; where these have no length, along
/// anything perpendicular.
fn frame(half: [DVec3; 3], lengths: [f64; 3]) -> DMat3 {
    let mut axes = [DVec3::ZERO; 3];
    let mut known = Vec::new();
    for i in 0..3 {
        if lengths[i] > 0.0 {
            axes[i] = half[i] / lengths[i];
            known.push(i);
        }
    }
    for i in 0..3 {
        if lengths[i] > 0.0 {
            continue;
        }
        axes[i] = match known[..] {
            [] => DVec3::X,
            [a] => axes[a].any_orthonormal_vector(),
            [a, b, ..] => axes[a].cross(axes[b]).normalize(),
        };
        known.push(i);
    }
    if DMat3::from_cols(axes[0], axes[1], axes[2]).determinant() < 0.0 {
        // An axis and its opposite are one axis of the ellipsoid.
        axes[2] = -axes[2];
    }
    DMat3::from_cols(axes[0], axes[1], axes[2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::random::unit;
    use crate::scene::transform::rotation;

    #[test]
    fn the_covariance_is_the_stretched_one() {
        let mut next = 0..;
        let mut number = || f64::from(2.0 * unit(3, next.next().unwrap()) - 1.0);
        for step in 0..200 {
            let mut vector = || DVec3::new(number(), number(), number());
            let factors = vector().abs() + 0.01;
            let matrix = rotation(vector(), 70.0) * DMat3::from_diagonal(factors);
            let mut scale = vector().abs().as_vec3();
            // Discs, needles and points too.
            (0..step % 4).for_each(|axis| scale[axis] = 0.0);
            let own = DQuat::from_mat3(&rotation(vector(), 130.0)).to_array().map(|q| q as f32);
            let covariance = |matrix: DMat3, scale: Vec3, turn: [f32; 4]| {
                let turn = DMat3::from_quat(DQuat::from_array(turn.map(f64::from)).normalize());
                let half = matrix * turn * DMat3::from_diagonal(scale.as_dvec3());
                half * half.transpose()
            };
            let (new, turn) = stretch(matrix, scale, own);
            let off = covariance(DMat3::IDENTITY, new, turn) - covariance(matrix, scale, own);
            assert!(off.to_cols_array().iter().all(|off| off.abs() < 2e-6), "{step}: {off}");
        }
    }
}
