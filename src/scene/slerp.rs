//! Rotations between two rotations, as [`crate::scene::objects::motion`] writes them out.

use crate::number::MapInline;
use crate::number::elementary;
use glam::{DMat3, DVec3};

/// Spherical linear interpolation of two rotations.
pub(crate) fn slerp(a: &DMat3, b: &DMat3, s: f64) -> DMat3 {
    let (p, mut q) = (quaternion(a), quaternion(b));
    let mut c = dot(p, q);
    // q and -q are the same rotation; the closer one gives the shorter way.
    if c < 0.0 {
        (q, c) = (q.map_inline(|part| -part), -c);
    }
    // Between nearly equal rotations the division by k would lose the digits.
    let turned: [f64; 4] = if c >= 1.0 - 1.0 / 1_099_511_627_776.0 {
        std::array::from_fn(|i| p[i] + s * (q[i] - p[i]))
    } else {
        let k = (1.0 - c * c).sqrt();
        let h = elementary::atan2(k, c);
        let [of_p, of_q] = [elementary::sin((1.0 - s) * h) / k, elementary::sin(s * h) / k];
        std::array::from_fn(|i| p[i] * of_p + q[i] * of_q)
    };
    let length = dot(turned, turned).sqrt();
    matrix(turned.map_inline(|part| part / length))
}

fn dot(p: [f64; 4], q: [f64; 4]) -> f64 {
    ((p[0] * q[0] + p[1] * q[1]) + p[2] * q[2]) + p[3] * q[3]
}

/// The unit quaternion of a rotation.
fn quaternion(m: &DMat3) -> [f64; 4] {
    let [[m00, m10, m20], [m01, m11, m21], [m02, m12, m22]] = m.to_cols_array_2d();
    let squares = [
        ((1.0 + m00) + m11) + m22,
        ((1.0 + m00) - m11) - m22,
        ((1.0 - m00) + m11) - m22,
        ((1.0 - m00) - m11) + m22,
    ];
    let greatest = (1..4).fold(0, |most, i| if squares[i] > squares[most] { i } else { most });
    let g = 2.0 * squares[greatest].sqrt();
    let (own, [x, y, z]) = (g / 4.0, [m21 - m12, m02 - m20, m10 - m01].map_inline(|part| part / g));
    let [xy, xz, yz] = [m10 + m01, m02 + m20, m21 + m12].map_inline(|part| part / g);
    match greatest {
        0 => [own, x, y, z],
        1 => [x, own, xy, xz],
        2 => [y, xy, own, yz],
        _ => [z, xz, yz, own],
    }
}

/// The rotation of a unit quaternion.
fn matrix([w, x, y, z]: [f64; 4]) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)),
        DVec3::new(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)),
        DVec3::new(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::transform::rotation;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn turns_are_even(
            axis in prop::array::uniform3(-1.0..1.0_f64), start in -180.0..180.0_f64,
            turn in -179.0..179.0_f64, s in 0.0..1.0_f64,
        ) {
            let axis = DVec3::from_array(axis);
            prop_assume!(axis.length() > 0.1);
            // About one axis, a part of the way is a part of the angle.
            let [a, b] = [start, start + turn].map(|degrees| rotation(axis, degrees));
            let truth = rotation(axis, start + s * turn);
            let off = (slerp(&a, &b, s) - truth).to_cols_array();
            prop_assert!(off.iter().all(|part| part.abs() < 1e-14), "{off:?}");
        }

        #[test]
        fn quaternions_go_there_and_back(
            axis in prop::array::uniform3(-1.0..1.0_f64), degrees in -360.0..360.0_f64,
        ) {
            let axis = DVec3::from_array(axis);
            prop_assume!(axis.length() > 0.1);
            let m = rotation(axis, degrees);
            let off = (matrix(quaternion(&m)) - m).to_cols_array();
            prop_assert!(off.iter().all(|part| part.abs() < 2e-15), "{off:?}");
        }
    }
}
