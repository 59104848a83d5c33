//! Rules about triangles, ribbons, tubes and prefiltered colours.

use super::{Of, Row};
use crate::scene::Cloud;
use crate::source::Shape;
use crate::verdict::conformance::Draws;
use crate::verdict::conformance::sketch::Sketch;
use glam::Vec3;

const POLYGONS: &[&str] = &["deferred", "pyramid", "blue"];
const PYRAMID: &[&str] = &["pyramid"];

/// Vertices with colours and normals.
fn vertices(position: &[[f32; 3]]) -> Cloud {
    let count = position.len();
    Cloud {
        position: position.iter().map(|at| (*at).into()).collect(),
        normal: Some(
            (0..count).map(|i| Vec3::new(0.25 * i as f32 - 0.4, 0.25, 1.0).normalize()).collect(),
        ),
        color: Some((0..count).map(|i| Vec3::new(0.25 * i as f32, 0.75, 0.5)).collect()),
        ..Cloud::default()
    }
}

/// Adds a square of two triangles.
pub(super) fn square(s: &mut Sketch, corners: [[f32; 3]; 4]) {
    let cloud = Cloud { triangles: vec![[0, 1, 2], [0, 2, 3]], ..vertices(&corners) };
    s.meshes.push((cloud, Draws::Polygons));
}

/// Adds a line of three segments.
fn line(s: &mut Sketch, radius: f32, draws: Draws) {
    let places = [[-2.2, -1.1, 0.3], [-0.6, 0.9, -0.2], [0.8, -0.5, 0.4], [2.1, 1.2, 0.0]];
    let cloud = Cloud {
        radius: Some((0..4_u8).map(|i| radius * (1.0 + 0.25 * f32::from(i))).collect()),
        edges: vec![[0, 1], [1, 2], [2, 3]],
        ..vertices(&places)
    };
    s.meshes.push((cloud, draws));
}

/// Moves every mesh to the right.
fn moved(s: &mut Sketch) {
    let places = s.meshes.iter_mut().flat_map(|(cloud, _)| &mut cloud.position);
    places.for_each(|at| at.x += 0.125);
}

pub(super) const ROWS: &[Row] = &[
    Row {
        name: "triangles",
        tests: "Two triangles share an edge, and intersect a disc.",
        of: Of::Only(POLYGONS),
        draw: |s| {
            square(s, [[-1.7, -1.2, 0.5], [1.3, -1.0, -0.5], [1.6, 1.1, -0.4], [-1.4, 1.3, 0.6]]);
            s.disc([0.3, 0.2, 0.1], 0.9);
        },
        otherwise: moved,
    },
    Row {
        name: "triangles-across-the-border",
        tests: "Triangles reach beyond the picture, and their corners lie outside.",
        of: Of::Only(POLYGONS),
        draw: |s| {
            square(s, [[-5.0, -1.2, 0.5], [4.3, -4.0, -0.5], [6.0, 2.1, -0.4], [-1.4, 3.9, 0.6]]);
            s.disc([0.3, 0.2, 1.0], 0.9);
        },
        otherwise: moved,
    },
    Row {
        name: "triangles-across-the-near-plane",
        tests: "Triangles are cut by the near plane.",
        of: Of::Only(POLYGONS),
        draw: |s| {
            s.near = Some(6.0);
            square(s, [[-1.7, -1.2, 3.5], [1.3, -1.0, -1.5], [1.6, 1.1, -1.4], [-1.4, 1.3, 3.6]]);
            s.disc([0.9, 0.2, -0.5], 0.4);
        },
        otherwise: |s| s.near = Some(5.0),
    },
    Row {
        name: "ribbons",
        tests: "A ribbon of three segments is drawn one pixel wide and reconstructed.",
        of: Of::Only(PYRAMID),
        draw: |s| {
            line(s, 0.25, Draws::Ribbons);
            s.disc([0.0, -1.5, -0.5], 0.5);
        },
        otherwise: moved,
    },
    Row {
        name: "tubes",
        tests: "A tube of three segments is drawn one pixel wide and reconstructed.",
        of: Of::Only(PYRAMID),
        draw: |s| {
            line(s, 0.25, Draws::Tubes);
            s.disc([0.0, -1.5, -0.5], 0.5);
        },
        otherwise: moved,
    },
    Row {
        name: "prefiltered-colours",
        tests: "A surfel that stands for several has the prefiltered colour of their area.",
        of: Of::Only(&["deferred"]),
        draw: |s| {
            s.shape(Shape::Cluster, 100, 1.0);
            s.mipmaps = 3;
        },
        otherwise: |s| s.mipmaps = 0,
    },
];
