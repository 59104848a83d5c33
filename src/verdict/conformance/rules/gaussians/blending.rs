//! Rules about cut-offs, opacities and the order of splats.

use super::OF;
use crate::verdict::conformance::rules::Row;
use crate::verdict::conformance::sketch::Sketch;

/// Splats that face the camera, the farthest first.
fn stack(s: &mut Sketch, layers: u8, opacity: f32) {
    for i in 0..layers {
        let step = f32::from(i);
        s.blob([0.1 * step - 0.3, 0.05 * step - 0.2, 0.6 * step - 3.0], [0.9; 3]).opacity = opacity;
    }
}

/// Two splats of which the nearer by depth is the farther by distance.
fn apart(s: &mut Sketch) {
    s.blob([2.0, 1.2, 0.1], [0.9; 3]);
    s.blob([0.6, 0.5, 0.0], [0.9; 3]);
}

pub(super) const ROWS: &[Row] = &[
    Row {
        name: "low-pass",
        tests: "The low-pass filter widens small splats.",
        of: OF,
        draw: |s| {
            s.blob([0.1, 0.1, 0.0], [0.1; 3]);
            s.blob([-1.0, 0.7, 0.1], [0.05, 0.2, 0.1]);
        },
        otherwise: |s| s.set("low_pass", "0.1"),
    },
    Row {
        name: "compensation-off",
        tests: "Opacities are not compensated for the low-pass filter.",
        of: OF,
        draw: |s| {
            s.blob([0.1, 0.1, 0.0], [0.05; 3]);
            s.blob([-1.0, 0.7, 0.1], [0.02; 3]);
        },
        otherwise: |s| s.set("compensation", "ratio"),
    },
    Row {
        name: "support",
        tests: "A splat ends with the tiles that its square touches.",
        of: OF,
        draw: |s| {
            s.blob([-0.3, 0.2, 0.0], [0.5, 0.3, 0.3]).opacity = 1.0;
        },
        otherwise: |s| s.set("cutoff", "2"),
    },
    Row {
        name: "least-alpha",
        tests: "A fragment of less than 1/255 is skipped.",
        of: OF,
        draw: |s| {
            s.blob([0.1, 0.2, 0.0], [0.6; 3]).opacity = 0.1;
            s.blob([-0.9, 0.2, 0.3], [0.6; 3]).opacity = 0.03;
        },
        otherwise: |s| s.set("least_alpha", "0.005"),
    },
    Row {
        name: "most-alpha",
        tests: "No alpha exceeds 0.99.",
        of: OF,
        draw: |s| {
            s.blob([0.1, 0.2, 1.0], [0.9; 3]).opacity = 1.0;
            s.blob([0.3, -0.2, -0.3], [0.9; 3]);
        },
        otherwise: |s| s.set("most_alpha", "1"),
    },
    Row {
        name: "stop",
        tests: "Blending ends before the fragment that takes the transmittance below 1/10,000.",
        of: OF,
        draw: |s| {
            stack(s, 6, 1.0);
        },
        otherwise: |s| s.set("stop", "0"),
    },
    Row {
        name: "opacity",
        tests: "Splats of opacity 1/4, 1/2 and 1 lie one behind the other.",
        of: OF,
        draw: |s| {
            stack(s, 3, 1.0);
            s.blobs[1].opacity = 0.5;
            s.blobs[2].opacity = 0.25;
        },
        otherwise: |s| s.blobs.iter_mut().for_each(|blob| blob.opacity = 1.0),
    },
    Row {
        name: "opacity-0",
        tests: "A splat of opacity 0 hides nothing.",
        of: OF,
        draw: |s| {
            stack(s, 2, 0.75);
            s.blobs[1].opacity = 0.0;
        },
        otherwise: |s| s.blobs[1].opacity = 0.75,
    },
    Row {
        name: "premultiplied",
        tests: "Colours are multiplied by alpha once.",
        of: OF,
        draw: |s| {
            s.blob([0.1, 0.1, 0.0], [0.6; 3]).opacity = 0.5;
        },
        otherwise: |s| s.blobs[0].opacity = 0.25,
    },
    Row {
        name: "order",
        tests: "The nearer of two splats is in front, although it is the later one in the list.",
        of: OF,
        draw: |s| {
            s.blob([0.11, 0.1, -2.0], [0.9; 3]);
            s.blob([0.03, 0.05, 1.0], [0.4; 3]);
        },
        otherwise: |s| s.blobs.iter_mut().for_each(|blob| blob.at.z = -blob.at.z),
    },
    Row {
        name: "order-by-depth",
        tests: "Splats are sorted by depth, not by distance from the camera.",
        of: OF,
        draw: |s| {
            apart(s);
        },
        otherwise: |s| s.set("order", "distance"),
    },
    Row {
        name: "tie",
        tests: "Of two splats of one depth, the lower index is in front.",
        of: OF,
        draw: |s| {
            s.blob([0.1, 0.1, 0.0], [0.6; 3]);
            s.blob([0.3, 0.2, 0.0], [0.6; 3]);
        },
        otherwise: |s| s.blobs[1].at.z = 0.001,
    },
    Row {
        name: "overlap",
        tests: "Two splats lie at one place.",
        of: OF,
        draw: |s| {
            s.blob([0.1, 0.1, 0.0], [0.6; 3]);
            s.blob([0.1, 0.1, 0.0], [0.6; 3]);
        },
        otherwise: |s| s.blobs.truncate(1),
    },
    Row {
        name: "near",
        tests: "A splat nearer than 0.2 is dropped, one just beyond is drawn.",
        of: OF,
        draw: |s| {
            s.blob([0.01, 0.01, 7.81], [0.01; 3]);
            s.blob([0.02, 0.0, 7.79], [0.01; 3]);
        },
        otherwise: |s| s.set("near_depth", "0.15"),
    },
    Row {
        name: "behind",
        tests: "A splat behind the camera is dropped.",
        of: OF,
        draw: |s| {
            s.blob([0.3, 0.1, 0.0], [0.5; 3]);
            s.blob([0.3, 0.1, 9.0], [0.5; 3]);
        },
        otherwise: |s| s.blobs[1].at.z = 1.0,
    },
    Row {
        name: "beside",
        tests: "The Jacobian is bounded beside the picture.",
        of: OF,
        draw: |s| {
            s.blob([-5.5, 0.4, 1.0], [0.6, 0.3, 1.5]);
            s.blob([0.3, 4.6, 1.0], [0.3, 0.6, 1.5]);
        },
        otherwise: |s| s.set("clamp", "none"),
    },
];
