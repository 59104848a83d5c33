//! Rules about counts of splats, surfaces behind them, cameras and sizes of pictures.

use super::{OF, three};
use crate::scene::Lens;
use crate::verdict::conformance::rules::Row;
use glam::DVec3;

/// A surface whose depth grows from this one on, and which no splat touches at a pixel's centre.
fn slope(x: u32, y: u32, from: f32) -> (f32, [f32; 3]) {
    (from + 0.0413 * x as f32, [0.75, 0.5, 0.02 * y as f32])
}

/// A surface of one depth in the left half of the picture.
fn half(x: u32, depth: f32) -> (f32, [f32; 3]) {
    (if x < 24 { depth } else { f32::INFINITY }, [0.75, 0.5, 0.125])
}

pub(super) const ROWS: &[Row] = &[
    Row {
        name: "count-17",
        tests: "The number of splats is no multiple of 16.",
        of: OF,
        draw: |s| {
            s.scatter_blobs(17, 0.25);
        },
        otherwise: |s| {
            let first = s.blobs[0].clone();
            s.blobs.extend([first.clone(), first]);
        },
    },
    Row {
        name: "count-97",
        tests: "The number of splats is no multiple of 32 or 64.",
        of: OF,
        draw: |s| {
            s.scatter_blobs(97, 0.25);
        },
        otherwise: |s| {
            let first = s.blobs[0].clone();
            s.blobs.push(first);
        },
    },
    Row {
        name: "one",
        tests: "One splat alone.",
        of: OF,
        draw: |s| {
            s.blob([0.3, 0.1, 0.0], [0.5, 0.3, 0.2]);
        },
        otherwise: |s| s.blobs[0].opacity = 0.7,
    },
    Row {
        name: "nothing",
        tests: "No splat is in sight: every plane holds the values of an empty pixel.",
        of: OF,
        draw: |s| {
            s.blob([19.0, 0.0, 0.0], [0.3; 3]);
        },
        otherwise: |s| s.blobs[0].at.x = 0.0,
    },
    Row {
        name: "far",
        tests: "Depths are large: splats 500 units away.",
        of: OF,
        draw: |s| {
            s.blob([0.0, 0.0, -500.0], [30.0, 20.0, 10.0]);
            s.blob([40.0, 20.0, -505.0], [30.0; 3]);
        },
        otherwise: |s| s.blobs[1].at.z = -495.0,
    },
    Row {
        name: "many",
        tests: "Sums run over many fragments of a pixel: 100 splats overlap.",
        of: OF,
        draw: |s| {
            s.scatter_blobs(100, 0.5);
        },
        otherwise: |s| s.blobs.truncate(90),
    },
    Row {
        name: "background",
        tests: "An environment is seen behind the splats, as much as they let through.",
        of: OF,
        draw: |s| {
            three(s);
            s.sky = true;
        },
        otherwise: |s| s.sky = false,
    },
    Row {
        name: "surface-cuts",
        tests: "A splat is drawn where the depth of its centre is at most the surface's: a slope cuts \
                through the splats.",
        of: OF,
        draw: |s| {
            three(s);
            s.surface = Some(|x, y| slope(x, y, 7.01));
        },
        otherwise: |s| s.surface = Some(|x, y| slope(x, y, 9.01)),
    },
    Row {
        name: "surface-seen",
        tests: "The surface's colour is seen behind the splats, as much as they let through, and the \
                environment where there is no surface.",
        of: OF,
        draw: |s| {
            three(s);
            s.sky = true;
            s.surface = Some(|x, _| half(x, 20.0));
        },
        otherwise: |s| s.surface = None,
    },
    Row {
        name: "surface-hides",
        tests: "A splat behind the surface counts nowhere: not in the transmittance, the ids or the \
                count.",
        of: OF,
        draw: |s| {
            three(s);
            s.surface = Some(|x, _| half(x, 2.0));
        },
        otherwise: |s| s.surface = Some(|x, _| half(x, 20.0)),
    },
    Row {
        name: "orthographic",
        tests: "The camera is orthographic: size does not depend on depth.",
        of: OF,
        draw: |s| {
            three(s);
            s.lens = Lens::Orthographic(5.0);
        },
        otherwise: |s| s.lens = Lens::Focal(64.0),
    },
    Row {
        name: "principal-point",
        tests: "The principal point is not the middle of the picture.",
        of: OF,
        draw: |s| {
            three(s);
            s.shift = [5.25, -3.5];
        },
        otherwise: |s| s.shift = [0.0; 2],
    },
    Row {
        name: "pixel-aspect",
        tests: "The focal lengths differ: pixels are not square.",
        of: OF,
        draw: |s| {
            three(s);
            s.stretch = 0.75;
        },
        otherwise: |s| s.stretch = 1.0,
    },
    Row {
        name: "rolled",
        tests: "The camera is rolled.",
        of: OF,
        draw: |s| {
            three(s);
            s.pose.up = DVec3::new(0.4, 0.8, 0.1);
        },
        otherwise: |s| s.pose.up = DVec3::new(-0.4, 0.8, 0.1),
    },
    Row {
        name: "from-above",
        tests: "The camera looks from above, along no axis.",
        of: OF,
        draw: |s| {
            three(s);
            s.pose.eye = DVec3::new(2.0, 5.0, 5.0);
        },
        otherwise: |s| s.pose.eye = DVec3::new(2.0, -5.0, 5.0),
    },
    Row {
        name: "wide",
        tests: "The field of view is 110 degrees.",
        of: OF,
        draw: |s| {
            three(s);
            s.lens = Lens::FieldOfView(110.0);
            s.pose.eye.z = 3.0;
        },
        otherwise: |s| s.lens = Lens::FieldOfView(105.0),
    },
    Row {
        name: "odd-size",
        tests: "The picture has 33 x 17 pixels.",
        of: OF,
        draw: |s| {
            three(s);
            s.size = [33, 17];
        },
        otherwise: |s| s.shift = [0.5, 0.0],
    },
    Row {
        name: "one-pixel",
        tests: "The picture has one pixel.",
        of: OF,
        draw: |s| {
            s.blob([0.01, 0.02, 0.0], [0.2, 0.3, 0.1]);
            s.size = [1, 1];
        },
        otherwise: |s| s.blobs[0].opacity = 0.5,
    },
];
