//! Rules about 3D Gaussian splats.

mod blending;
mod colors;
mod discs;
mod harmonics;
mod pictures;
mod shapes;

use super::{Of, Row};
use crate::number::elementary;
use crate::verdict::conformance::sketch::Sketch;
use glam::{Quat, Vec3};

const OF: Of = Of::Only(&["gaussians"]);

/// The rules, in the order of the suite.
pub(super) const TABLES: [&[Row]; 6] =
    [shapes::ROWS, blending::ROWS, colors::ROWS, pictures::ROWS, discs::ROWS, harmonics::ROWS];

/// A turn about an axis of any length.
pub(super) fn turn(axis: Vec3, degrees: f32) -> Quat {
    let axis = axis.as_dvec3().normalize();
    let half = f64::from(degrees).to_radians() / 2.0;
    let (sin, cos) = (elementary::sin(half), elementary::cos(half));
    let [x, y, z] = (axis * sin).to_array().map(|part| part as f32);
    Quat::from_xyzw(x, y, z, cos as f32)
}

/// Three splats away from the middle.
fn three(s: &mut Sketch) {
    s.blob([-1.1, 0.6, 0.5], [0.5, 0.2, 0.3]).rotation = turn(Vec3::new(0.2, 0.4, 1.0), 30.0);
    s.blob([1.0, 0.5, -0.5], [0.3, 0.6, 0.2]).rotation = turn(Vec3::new(1.0, 0.4, 0.1), 50.0);
    s.blob([0.2, -0.8, 0.0], [0.4, 0.3, 0.7]).rotation = turn(Vec3::new(0.3, 1.0, 0.3), 70.0);
}
