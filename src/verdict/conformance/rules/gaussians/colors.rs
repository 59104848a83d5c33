//! Rules about spherical harmonics and colours.

use super::{OF, three};
use crate::verdict::conformance::rules::Row;
use crate::verdict::conformance::sketch::Sketch;
use glam::{DVec3, Vec3};

/// Splats that look different from every side, all around the axis of view.
fn look(s: &mut Sketch, degree: u8) {
    for i in 0..5_u8 {
        let step = f32::from(i) - 2.0;
        s.blob([0.9 * step, 0.6 * step * (1.0 - 0.4 * step), 0.3 * step], [0.35; 3]).look(degree);
    }
}

pub(super) const ROWS: &[Row] = &[
    Row {
        name: "look-of-degree-0",
        tests: "Colours are harmonics of degree 0.",
        of: OF,
        draw: |s| {
            look(s, 0);
        },
        otherwise: |s| s.blobs[0].harmonics[0].x += 0.05,
    },
    Row {
        name: "look-of-degree-1",
        tests: "Colours are harmonics of degree 1.",
        of: OF,
        draw: |s| {
            look(s, 1);
        },
        otherwise: |s| s.set("degree", "0"),
    },
    Row {
        name: "look-of-degree-2",
        tests: "Colours are harmonics of degree 2.",
        of: OF,
        draw: |s| {
            look(s, 2);
        },
        otherwise: |s| s.set("degree", "1"),
    },
    Row {
        name: "look-of-degree-3",
        tests: "Colours are harmonics of degree 3.",
        of: OF,
        draw: |s| {
            look(s, 3);
        },
        otherwise: |s| s.set("degree", "2"),
    },
    Row {
        name: "direction",
        tests: "Harmonics are taken in the direction from the camera to the splat.",
        of: OF,
        draw: |s| {
            look(s, 3);
        },
        otherwise: |s| {
            for blob in &mut s.blobs {
                for i in (1..4).chain(9..16) {
                    blob.harmonics[i] = -blob.harmonics[i];
                }
            }
        },
    },
    Row {
        name: "direction-of-world",
        tests: "Harmonics are taken in the axes of the world.",
        of: OF,
        draw: |s| {
            look(s, 3);
            s.pose.eye = DVec3::new(4.0, 3.0, 6.0);
        },
        otherwise: |s| {
            for blob in &mut s.blobs {
                blob.harmonics.swap(1, 3);
            }
        },
    },
    Row {
        name: "colors-below-0",
        tests: "A colour below 0 becomes 0, and one above 1 stays.",
        of: OF,
        draw: |s| {
            s.blob([0.1, 0.1, 0.0], [0.6; 3]).harmonics[0] = Vec3::new(-3.0, 4.0, 1.0);
        },
        otherwise: |s| s.set("color_bounds", "none"),
    },
    Row {
        name: "linear",
        tests: "The scene stores linear light.",
        of: OF,
        draw: |s| {
            three(s);
            s.linear = true;
        },
        otherwise: |s| s.linear = false,
    },
];
