//! Rules about splats that are discs.

use super::{OF, turn};
use crate::verdict::conformance::rules::Row;
use crate::verdict::conformance::sketch::Sketch;
use glam::Vec3;

/// A splat that is a disc, where rays meet discs.
fn disc(s: &mut Sketch, scale: [f32; 2], axis: Vec3, degrees: f32) {
    s.set("disc", "ray");
    s.set("low_pass", "0.5");
    s.blob([0.13, -0.08, 0.0], [scale[0], scale[1], 0.0]).rotation = turn(axis, degrees);
}

pub(super) const ROWS: &[Row] = &[
    Row {
        name: "disc-tilted",
        tests: "A ray meets a tilted disc: u belongs to the first axis and v to the second.",
        of: OF,
        draw: |s| disc(s, [1.4, 0.5], Vec3::new(0.5, 1.0, 0.4), 65.0),
        otherwise: |s| s.blobs[0].scale = Vec3::new(0.5, 1.4, 0.0),
    },
    Row {
        name: "disc-edge-on",
        tests: "A disc that is nearly edge-on is blurred: rho2d is the lesser of both.",
        of: OF,
        draw: |s| disc(s, [0.9, 0.7], Vec3::new(0.3, 1.0, 0.0), 88.5),
        otherwise: |s| s.set("low_pass", "0"),
    },
    Row {
        name: "disc-small",
        tests: "A disc smaller than a pixel has the low-pass filter: rho2d is 2 times the square of \
                the distance.",
        of: OF,
        draw: |s| disc(s, [0.02, 0.03], Vec3::new(0.3, 1.0, 0.0), 20.0),
        otherwise: |s| s.set("low_pass", "1"),
    },
];
