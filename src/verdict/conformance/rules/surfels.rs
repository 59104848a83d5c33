//! Rules about single surfels: where they lie, how large they are, and which are drawn.

use super::{Of, Row};
use crate::source::Shape;
use glam::Vec3;

/// Methods that draw a surfel only if its centre is in the picture.
const CENTRES: &[&str] = &["deferred", "pyramid", "template"];

pub(super) const ROWS: &[Row] = &[
    Row {
        name: "middle",
        tests: "The centre of a pixel is at half numbers: a disc stands on the centre of one.",
        of: Of::All,
        draw: |s| {
            s.disc([0.0625, 0.0625, 0.0], 0.7);
        },
        otherwise: |s| s.shift = [0.5, 0.5],
    },
    Row {
        name: "rows-run-down",
        tests: "Row 0 is the top of the picture, column 0 its left end.",
        of: Of::All,
        draw: |s| {
            s.disc([-1.45, 1.2, 0.0], 0.7);
            s.disc([1.05, -0.45, 0.2], 0.37);
        },
        otherwise: |s| s.discs.iter_mut().for_each(|disc| disc.at.y = -disc.at.y),
    },
    Row {
        name: "between-pixels",
        tests: "A centre is not rounded to the centre of a pixel.",
        of: Of::But(&["pyramid"]),
        draw: |s| {
            s.disc([0.29, 0.2, 0.0], 0.7);
            s.disc([-1.13, -0.64, 0.0], 0.8);
        },
        otherwise: |s| {
            for disc in &mut s.discs {
                disc.at.x = (disc.at.x * 8.0).floor() / 8.0 + 0.0625;
                disc.at.y = (disc.at.y * 8.0).floor() / 8.0 + 0.0625;
            }
        },
    },
    Row {
        name: "rim",
        tests: "A splat ends where its rim is: discs of several sizes, whose rims pass close by \
                centres of pixels.",
        of: Of::All,
        draw: |s| {
            let places = [
                [-1.9, 1.1, 0.13],
                [-0.4, -1.3, 0.47],
                [0.7, 0.9, -0.29],
                [2.0, -0.6, 0.07],
                [-1.8, -0.9, 0.31],
            ];
            for (i, place) in places.into_iter().enumerate() {
                s.disc(place, 0.61 + 0.053 * i as f32);
            }
        },
        otherwise: |s| s.grow(1.02),
    },
    Row {
        name: "low-pass",
        tests: "The low-pass filter alone gives a splat its size: discs far smaller than a pixel.",
        of: Of::Splats,
        draw: |s| {
            s.disc([0.0625, 0.0625, 0.0], 0.002);
            s.disc([-1.01, 0.77, 0.1], 0.01);
            s.disc([1.37, -1.21, 0.3], 0.03);
        },
        otherwise: |s| s.set("low_pass", "0.6"),
    },
    Row {
        name: "smaller-than-a-pixel",
        tests: "A disc far smaller than a pixel is drawn where the page of the method says.",
        of: Of::Only(&["pyramid", "template", "blue"]),
        draw: |s| {
            s.disc([0.0625, 0.0625, 0.0], 0.01);
            s.disc([-1.0625, 0.6875, 0.0], 0.02);
        },
        otherwise: |s| s.discs.iter_mut().for_each(|disc| disc.at.x += 0.125),
    },
    Row {
        name: "sizes",
        tests: "No size is clamped: discs of 1 to 20 pixels.",
        of: Of::All,
        draw: |s| {
            for (i, radius) in [2.5, 1.25, 0.625, 0.3, 0.12].into_iter().enumerate() {
                s.disc([i as f32 - 2.0, 0.5 * i as f32 - 1.0, 0.25 * i as f32], radius);
            }
        },
        otherwise: |s| {
            for disc in &mut s.discs {
                disc.radius = if disc.radius > 2.0 { 2.0 } else { disc.radius };
            }
        },
    },
    Row {
        name: "larger-than-the-picture",
        tests: "A tilted disc reaches beyond all borders of the picture.",
        of: Of::All,
        draw: |s| {
            s.tilted([0.25, -0.25, 0.0], 3.5, [0.5, 0.25, 1.0]);
        },
        otherwise: |s| s.grow(0.9),
    },
    Row {
        name: "across-the-border",
        tests: "A splat whose centre lies outside the picture is drawn where it reaches into it.",
        of: Of::But(CENTRES),
        draw: |s| {
            s.disc([-3.25, 0.5, 0.0], 0.9);
            s.disc([0.5, -2.75, 0.0], 0.8);
        },
        otherwise: |s| {
            s.discs.remove(0);
        },
    },
    Row {
        name: "last-column",
        tests: "A point in the last column and row is drawn, one beyond it is not.",
        of: Of::Only(CENTRES),
        draw: |s| {
            s.disc([2.94, -2.44, 0.0], 0.47);
            s.disc([3.06, 1.03, 0.0], 0.47);
        },
        otherwise: |s| {
            s.discs.remove(0);
        },
    },
    Row {
        name: "tie",
        tests: "Of two surfels at the same place, the lower index is the nearer one.",
        // Layers of equal depth are blended in either order.
        of: Of::But(&["transparent"]),
        draw: |s| {
            s.disc([0.2, 0.1, 0.0], 0.7);
            s.disc([0.2, 0.1, 0.0], 0.7);
            s.disc([-1.7, 0.9, 0.4], 0.4);
        },
        otherwise: |s| s.discs[0].at.z = -0.001,
    },
    Row {
        name: "overlap",
        tests: "Two discs of nearly one plane overlap.",
        of: Of::All,
        draw: |s| {
            s.disc([-0.35, 0.1, 0.0], 0.9);
            s.disc([0.45, -0.1, -0.1], 0.8);
        },
        otherwise: |s| {
            s.discs.pop();
        },
    },
    Row {
        name: "nearest",
        tests: "The nearer of two surfels is seen, although it is the later one in the list.",
        of: Of::All,
        draw: |s| {
            s.disc([0.11, 0.1, -2.0], 1.5);
            s.disc([0.03, 0.05, 1.0], 0.75);
        },
        otherwise: |s| s.discs.iter_mut().for_each(|disc| disc.at.z = -disc.at.z),
    },
    Row {
        name: "intersecting",
        tests: "Depth is computed at each pixel: two tilted discs intersect.",
        of: Of::All,
        draw: |s| {
            s.tilted([0.0, 0.0, 0.0], 1.4, [1.0, 0.2, 1.0]);
            s.tilted([0.1, 0.1, 0.1], 1.3, [-1.0, 0.1, 1.0]);
        },
        otherwise: |s| {
            for disc in &mut s.discs {
                disc.normal.x *= 0.9;
            }
        },
    },
    Row {
        name: "tilted",
        tests: "Normals point anywhere, along no axis.",
        of: Of::All,
        draw: |s| {
            s.tilted([-1.4, 0.9, 0.0], 0.8, [0.61, 0.37, 0.7]);
            s.tilted([1.1, 0.8, 0.5], 0.9, [-0.42, 0.71, 0.57]);
            s.tilted([0.2, -1.1, -0.5], 1.0, [0.23, -0.79, 0.57]);
        },
        otherwise: |s| s.discs.iter_mut().for_each(|disc| disc.normal.x = -disc.normal.x),
    },
    Row {
        name: "grazing",
        tests: "A disc is seen at 4 degrees from edge-on.",
        of: Of::All,
        draw: |s| {
            s.tilted([0.0, 0.0, 0.0], 1.5, [0.0, 0.9976, 0.0698]);
        },
        otherwise: |s| s.discs[0].normal = Vec3::new(0.0, 0.9945, 0.1045),
    },
    Row {
        name: "ellipse",
        tests: "A surfel has half axes of different lengths.",
        of: Of::Splats,
        draw: |s| {
            s.disc([-1.9, -1.3, 0.4], 0.4);
            let disc = s.disc([0.1, 0.1, 0.0], 1.6);
            disc.axes = Some([Vec3::new(1.5, 0.5, 0.0), Vec3::new(-0.2, 0.6, 0.0)]);
        },
        otherwise: |s| {
            s.discs[1].axes = Some([Vec3::new(0.5, 1.5, 0.0), Vec3::new(-0.6, 0.2, 0.0)]);
        },
    },
    Row {
        name: "tilted-ellipse",
        tests: "Half axes lie in a tilted plane.",
        of: Of::Splats,
        draw: |s| {
            let disc = s.tilted([0.1, 0.1, 0.0], 1.5, [-0.6, 0.0, 0.8]);
            disc.axes = Some([Vec3::new(1.2, 0.0, 0.9), Vec3::new(0.0, 0.5, 0.0)]);
        },
        otherwise: |s| {
            s.discs[0].axes = Some([Vec3::new(0.4, 0.0, 0.3), Vec3::new(0.0, 1.5, 0.0)]);
        },
    },
    Row {
        name: "back-faces-culled",
        tests: "With `cull` on, a surfel that faces away is dropped.",
        of: Of::All,
        draw: |s| {
            s.set("cull", "on");
            s.disc([-0.7, 0.05, 0.0], 0.7);
            s.tilted([0.8, 0.3, 0.0], 0.7, [0.3, 0.2, -1.0]);
        },
        otherwise: |s| s.set("cull", "off"),
    },
    Row {
        name: "back-faces-drawn",
        tests: "With `cull` off, a surfel that faces away is drawn, and its normal is turned.",
        of: Of::All,
        draw: |s| {
            s.set("cull", "off");
            s.disc([-0.7, 0.05, 0.0], 0.7);
            s.tilted([0.8, 0.3, 0.0], 0.7, [0.3, 0.2, -1.0]);
        },
        otherwise: |s| s.set("cull", "on"),
    },
    Row {
        name: "nothing",
        tests: "No surfel is in sight: every plane holds the values of an empty pixel.",
        of: Of::All,
        draw: |s| {
            s.disc([9.0, 0.0, 0.0], 0.5);
        },
        otherwise: |s| s.discs[0].at.x = 0.0,
    },
    Row {
        name: "far",
        tests: "Depths are large: a surface 500 units away.",
        of: Of::All,
        draw: |s| {
            s.tilted([0.0, 0.0, -500.0], 60.0, [0.4, 0.3, 1.0]);
            s.tilted([40.0, 20.0, -505.0], 70.0, [-0.3, 0.2, 1.0]);
        },
        otherwise: |s| s.discs[1].at.z = -495.0,
    },
    Row {
        name: "many",
        tests: "Sums run over many fragments of a pixel: 100 discs overlap.",
        of: Of::All,
        draw: |s| s.scatter(100, 0.7),
        otherwise: |s| {
            s.discs.truncate(90);
        },
    },
    Row {
        name: "ball",
        tests: "A closed surface: a sphere of 96 surfels.",
        of: Of::All,
        draw: |s| s.shape(Shape::Sphere, 96, 2.0),
        otherwise: |s| s.grow(1.05),
    },
    Row {
        name: "torus",
        tests: "A surface hides its own far side: a torus of 100 surfels, from above.",
        of: Of::All,
        draw: |s| {
            s.shape(Shape::Torus, 100, 1.5);
            s.pose.eye = glam::DVec3::new(0.0, 5.0, 6.0);
        },
        otherwise: |s| s.grow(1.05),
    },
];
