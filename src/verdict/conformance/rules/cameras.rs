//! Rules about the camera.

use super::{Of, Row};
use crate::scene::Lens;
use crate::source::Shape;
use glam::DVec3;

/// Three tilted discs away from the middle.
fn three(s: &mut super::Sketch) {
    s.tilted([-1.6, 1.0, 0.5], 0.8, [0.3, 0.2, 1.0]);
    s.tilted([1.5, 0.9, -0.5], 0.9, [-0.4, 0.3, 1.0]);
    s.tilted([0.4, -1.2, 0.0], 0.7, [0.1, -0.5, 1.0]);
}

pub(super) const ROWS: &[Row] = &[
    Row {
        name: "orthographic",
        tests: "The camera is orthographic: size does not depend on depth.",
        of: Of::All,
        draw: |s| {
            three(s);
            s.lens = Lens::Orthographic(5.0);
        },
        otherwise: |s| s.lens = Lens::Focal(64.0),
    },
    Row {
        name: "orthographic-oblique",
        tests: "An orthographic camera looks obliquely at a ball.",
        of: Of::All,
        draw: |s| {
            s.shape(Shape::Sphere, 80, 1.5);
            s.lens = Lens::Orthographic(4.0);
            s.pose.eye = DVec3::new(3.0, 4.0, 5.0);
        },
        otherwise: |s| s.pose.eye = DVec3::new(3.1, 4.0, 5.0),
    },
    Row {
        name: "principal-point",
        tests: "The principal point is not the middle of the picture.",
        of: Of::All,
        draw: |s| {
            three(s);
            s.shift = [5.25, -3.5];
        },
        otherwise: |s| s.shift = [0.0; 2],
    },
    Row {
        name: "pixel-aspect",
        tests: "The focal lengths differ: pixels are not square.",
        of: Of::All,
        draw: |s| {
            three(s);
            s.stretch = 0.75;
        },
        otherwise: |s| s.stretch = 1.0,
    },
    Row {
        name: "wide",
        tests: "The field of view is 110 degrees, and discs lie far from the middle.",
        of: Of::All,
        draw: |s| {
            s.lens = Lens::FieldOfView(110.0);
            s.pose.eye = DVec3::new(0.0, 0.0, 2.0);
            three(s);
        },
        otherwise: |s| s.lens = Lens::FieldOfView(109.0),
    },
    Row {
        name: "oblique",
        tests: "The camera looks along no axis.",
        of: Of::All,
        draw: |s| {
            s.shape(Shape::Sphere, 80, 1.5);
            s.pose.eye = DVec3::new(3.0, 2.0, 7.0);
        },
        otherwise: |s| s.pose.eye = DVec3::new(-3.0, 2.0, 7.0),
    },
    Row {
        name: "rolled",
        tests: "The direction that is up in the picture is not +y.",
        of: Of::All,
        draw: |s| {
            three(s);
            s.pose.up = DVec3::new(1.0, 2.0, 0.5);
        },
        otherwise: |s| s.pose.up = DVec3::Y,
    },
    Row {
        name: "odd-size",
        tests: "The picture has an odd number of columns and rows.",
        of: Of::All,
        draw: |s| {
            three(s);
            s.size = [37, 29];
        },
        otherwise: |s| s.shift = [-0.5, -0.5],
    },
    Row {
        name: "one-row",
        tests: "The picture has one row.",
        of: Of::All,
        draw: |s| {
            s.size = [45, 1];
            s.tilted([-1.3, 0.0, 0.0], 0.8, [0.4, 0.1, 1.0]);
            s.disc([1.2, 0.0, 0.5], 0.9);
        },
        otherwise: |s| s.shift = [1.0, 0.0],
    },
    Row {
        name: "inside",
        tests: "The camera stands inside a ball: surfels lie behind it and beside the view.",
        of: Of::All,
        draw: |s| {
            s.shape(Shape::Sphere, 100, 3.0);
            s.set("cull", "off");
            s.lens = Lens::FieldOfView(80.0);
            (s.pose.eye, s.pose.target) = (DVec3::new(0.2, 0.1, 0.3), DVec3::new(1.0, 0.3, -0.6));
        },
        otherwise: |s| s.pose.eye = DVec3::new(0.2, 0.1, 0.5),
    },
    Row {
        name: "behind-the-camera",
        tests: "A surfel behind the camera is not drawn.",
        of: Of::All,
        draw: |s| {
            s.disc([0.2, 0.1, 9.0], 0.2);
            s.disc([-0.5, 0.2, 0.0], 0.8);
        },
        otherwise: |s| s.discs[0].at.z = 7.0,
    },
    Row {
        name: "before-the-near-plane",
        tests: "A surfel nearer than the near plane is not drawn.",
        of: Of::All,
        draw: |s| {
            s.near = Some(6.0);
            s.disc([0.5, 0.1, 3.0], 0.5);
            s.disc([-0.5, 0.2, 0.0], 0.8);
        },
        otherwise: |s| s.near = Some(1.0),
    },
    Row {
        name: "across-the-near-plane",
        tests: "A tilted disc reaches through the near plane.",
        of: Of::Splats,
        draw: |s| {
            s.near = Some(6.0);
            s.tilted([0.0, 0.0, 1.5], 1.4, [0.9, 0.1, 0.5]);
            s.disc([-0.5, 0.2, 0.0], 0.8);
        },
        otherwise: |s| s.near = Some(1.0),
    },
];
