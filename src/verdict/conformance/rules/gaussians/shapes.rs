//! Rules about places, rotations and scales of splats.

use super::{OF, turn};
use crate::verdict::conformance::rules::Row;
use crate::verdict::conformance::sketch::Sketch;
use glam::{Quat, Vec3};

/// A tilt that leaves no symmetry.
fn tilt() -> Quat {
    turn(Vec3::new(0.3, 0.5, 0.8), 50.0)
}

/// A splat of three different scales, turned.
fn turned(s: &mut Sketch, axis: Vec3) {
    let blob = s.blob([0.1, 0.05, 0.0], [1.0, 0.4, 0.15]);
    blob.rotation = turn(axis, 40.0) * tilt();
}

pub(super) const ROWS: &[Row] = &[
    Row {
        name: "middle",
        tests: "The centre of a pixel is at half numbers: a splat stands on the centre of one.",
        of: OF,
        draw: |s| {
            s.blob([0.0625, 0.0625, 0.0], [0.4, 0.3, 0.35]);
        },
        otherwise: |s| s.shift = [0.5, 0.5],
    },
    Row {
        name: "rows-run-down",
        tests: "Row 0 is the top of the picture, column 0 its left end.",
        of: OF,
        draw: |s| {
            s.blob([-1.45, 1.2, 0.0], [0.4; 3]);
            s.blob([1.05, -0.45, 0.2], [0.2; 3]);
        },
        otherwise: |s| s.blobs.iter_mut().for_each(|blob| blob.at.y = -blob.at.y),
    },
    Row {
        name: "between-pixels",
        tests: "A centre is not rounded to the centre of a pixel.",
        of: OF,
        draw: |s| {
            s.blob([0.29, 0.2, 0.0], [0.3; 3]);
            s.blob([-1.13, -0.64, 0.0], [0.4; 3]);
        },
        otherwise: |s| {
            for blob in &mut s.blobs {
                blob.at.x = (blob.at.x * 8.0).floor() / 8.0 + 0.0625;
            }
        },
    },
    Row {
        name: "rotation-x",
        tests: "A splat is turned about the x axis, after it was tilted.",
        of: OF,
        draw: |s| {
            turned(s, Vec3::X);
        },
        otherwise: |s| s.blobs[0].rotation = turn(Vec3::X, -40.0) * tilt(),
    },
    Row {
        name: "rotation-y",
        tests: "A splat is turned about the y axis, after it was tilted.",
        of: OF,
        draw: |s| {
            turned(s, Vec3::Y);
        },
        otherwise: |s| s.blobs[0].rotation = turn(Vec3::Y, -40.0) * tilt(),
    },
    Row {
        name: "rotation-z",
        tests: "A splat is turned about the z axis, after it was tilted.",
        of: OF,
        draw: |s| {
            turned(s, Vec3::Z);
        },
        otherwise: |s| s.blobs[0].rotation = turn(Vec3::Z, -40.0) * tilt(),
    },
    Row {
        name: "rotation-inverse",
        tests: "A quaternion turns from the splat's axes to the world, not back.",
        of: OF,
        draw: |s| {
            turned(s, Vec3::new(0.5, 0.7, 0.5));
        },
        otherwise: |s| s.blobs[0].rotation = s.blobs[0].rotation.conjugate(),
    },
    Row {
        name: "quaternion-order",
        tests: "The parts of a quaternion are x, y, z, w in memory, and w first in a PLY.",
        of: OF,
        draw: |s| {
            turned(s, Vec3::new(0.3, 0.9, 0.3));
        },
        otherwise: |s| {
            let q = s.blobs[0].rotation;
            s.blobs[0].rotation = Quat::from_xyzw(q.w, q.x, q.y, q.z);
        },
    },
    Row {
        name: "quaternion-sign",
        tests: "A quaternion and its negative are one rotation.",
        of: OF,
        draw: |s| {
            turned(s, Vec3::new(0.7, 0.2, 0.7));
            s.blobs[0].rotation = -s.blobs[0].rotation;
        },
        otherwise: |s| {
            let q = s.blobs[0].rotation;
            s.blobs[0].rotation = Quat::from_xyzw(q.x, q.y, q.z, -q.w);
        },
    },
    Row {
        name: "scale-axes",
        tests: "The three scales belong to the x, y and z axis of the splat.",
        of: OF,
        draw: |s| {
            turned(s, Vec3::new(0.1, 0.2, 0.9));
        },
        otherwise: |s| {
            let a = s.blobs[0].scale;
            s.blobs[0].scale = Vec3::new(a.y, a.x, a.z);
        },
    },
    Row {
        name: "sizes",
        tests: "No size is clamped: splats of 1 to 20 pixels.",
        of: OF,
        draw: |s| {
            for (i, scale) in [2.5, 1.25, 0.625, 0.3, 0.12].into_iter().enumerate() {
                let i = i as f32;
                s.blob([i - 2.0, 0.5 * i - 1.0, 0.25 * i], [scale, 0.5 * scale, scale]);
            }
        },
        otherwise: |s| {
            for blob in &mut s.blobs {
                blob.scale = blob.scale.min(Vec3::splat(1.0));
            }
        },
    },
    Row {
        name: "huge",
        tests: "A splat is larger than the picture.",
        of: OF,
        draw: |s| {
            s.blob([0.25, -0.25, 0.0], [4.0, 3.0, 1.0]);
        },
        otherwise: |s| s.grow(0.9),
    },
    Row {
        name: "across-the-border",
        tests: "A splat whose centre lies outside the picture is drawn where it reaches into it.",
        of: OF,
        draw: |s| {
            s.blob([-3.25, 0.5, 0.0], [0.5; 3]);
            s.blob([0.5, -2.75, 0.0], [0.4; 3]);
        },
        otherwise: |s| {
            s.blobs.remove(0);
        },
    },
    Row {
        name: "needle",
        tests: "A splat is long and thin.",
        of: OF,
        draw: |s| {
            let blob = s.blob([0.1, 0.1, 0.0], [1.2, 0.15, 0.15]);
            blob.rotation = turn(Vec3::new(0.2, 0.3, 0.9), 35.0);
        },
        otherwise: |s| s.blobs[0].scale.y = 0.2,
    },
    Row {
        name: "flat",
        tests: "A scale of 0 makes a disc, seen obliquely.",
        of: OF,
        draw: |s| {
            let blob = s.blob([0.1, 0.1, 0.0], [0.8, 0.6, 0.0]);
            blob.rotation = turn(Vec3::new(0.7, 0.3, 0.2), 60.0);
        },
        otherwise: |s| s.blobs[0].scale.z = 0.4,
    },
    Row {
        name: "point",
        tests: "All scales are 0: the low-pass filter alone gives a splat its size.",
        of: OF,
        draw: |s| {
            for i in 0..12_u8 {
                let step = f32::from(i);
                s.blob([0.37 * step - 2.0, 0.29 * step - 1.61, 0.1 * step], [0.0; 3]);
            }
            s.blobs[3].scale = Vec3::splat(0.001);
        },
        otherwise: |s| s.set("low_pass", "0.1"),
    },
];
