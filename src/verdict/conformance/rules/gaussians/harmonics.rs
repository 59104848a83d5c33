//! Rules about each function of the spherical harmonics alone.

use super::OF;
use crate::verdict::conformance::rules::Row;
use crate::verdict::conformance::sketch::Sketch;
use glam::{DVec3, Vec3};

/// A splat with one function alone, off the axis of view, so that no function is 0 there.
fn harmonic(s: &mut Sketch, index: usize) {
    s.pose.eye = DVec3::new(3.1, 4.2, 5.3);
    s.blob([0.2, 0.1, 0.3], [0.7, 0.5, 0.6]).harmonics = alone(index);
}

fn alone(index: usize) -> Vec<Vec3> {
    let mut all = vec![Vec3::ZERO; 16];
    all[index] = Vec3::new(0.5, -0.3, 0.8);
    all
}

/// A rule for the coefficient of one function.
macro_rules! harmonic {
    ($index:literal, $name:literal) => {
        Row {
            name: $name,
            tests: concat!("The coefficient ", $index, " of the spherical harmonics alone."),
            of: OF,
            draw: |s| harmonic(s, $index),
            otherwise: |s| s.blobs[0].harmonics[$index] *= -1.0,
        }
    };
}

pub(super) const ROWS: &[Row] = &[
    harmonic!(1, "harmonics-1"),
    harmonic!(2, "harmonics-2"),
    harmonic!(3, "harmonics-3"),
    harmonic!(4, "harmonics-4"),
    harmonic!(5, "harmonics-5"),
    harmonic!(6, "harmonics-6"),
    harmonic!(7, "harmonics-7"),
    harmonic!(8, "harmonics-8"),
    harmonic!(9, "harmonics-9"),
    harmonic!(10, "harmonics-10"),
    harmonic!(11, "harmonics-11"),
    harmonic!(12, "harmonics-12"),
    harmonic!(13, "harmonics-13"),
    harmonic!(14, "harmonics-14"),
    harmonic!(15, "harmonics-15"),
];
