//! Rules about settings: each at a value that is not its default; and the large scenes.

use super::gaussians::turn;
use super::layers::layers;
use super::meshes::square;
use super::{Of, Row, SettingRow};
use crate::source::Shape;
use crate::verdict::conformance::sketch::Sketch;
use glam::Vec3;

const VORONOI: Of = Of::Only(&["single-pass", "transparent-hq"]);
const LAYERS: Of = Of::Only(&["transparent", "transparent-hq"]);
const HQ: Of = Of::Only(&["transparent-hq"]);
const PEELING: Of = Of::Only(&["peeling"]);
const PYRAMID: Of = Of::Only(&["pyramid"]);
const GAUSSIANS: Of = Of::Only(&["gaussians"]);
const TEMPLATE: Of = Of::Only(&["template"]);

/// Three tilted discs under a wide lens, at different depths.
fn tilts(s: &mut Sketch) {
    s.tilted([-1.4, 0.9, 1.0], 0.8, [0.8, 0.3, 0.7]);
    s.tilted([1.1, 0.7, 0.5], 1.0, [-0.9, 0.6, 0.6]);
    s.tilted([0.2, -1.0, -0.5], 1.1, [0.2, -0.9, 0.5]);
}

/// Discs in steps of depth.
fn steps(s: &mut Sketch) {
    for i in 0..6_u8 {
        let step = f32::from(i);
        s.tilted([0.5 * step - 1.3, 0.2 * step - 0.6, -0.3 * step], 0.8, [0.3, 0.1, 1.0]);
    }
}

fn ball(s: &mut Sketch) {
    s.shape(Shape::Sphere, 80, 2.0);
}

fn veiled_ball(s: &mut Sketch) {
    ball(s);
    s.veil(0.5);
}

fn glass(s: &mut Sketch) {
    veiled_ball(s);
    s.sky = true;
}

fn mesh(s: &mut Sketch) {
    square(s, [[-1.71, -1.23, 0.5], [1.37, -1.09, -0.5], [1.63, 1.11, -0.4], [-1.43, 1.31, 0.6]]);
    s.disc([0.3, 0.2, 0.1], 0.9);
}

/// Splats of all sizes and looks.
fn blobs(s: &mut Sketch) {
    s.scatter_blobs(40, 0.2);
}

/// Opaque splats, one behind the other.
fn opaque(s: &mut Sketch) {
    s.scatter_blobs(60, 0.5);
    s.blobs.iter_mut().for_each(|blob| blob.opacity = 1.0);
}

/// Splats so close that their order shows.
fn crowd(s: &mut Sketch) {
    s.scatter_blobs(80, 0.4);
    s.blobs.iter_mut().for_each(|blob| blob.at.z *= 0.02);
}

/// Splats of colours below 0 and above 1.
fn bright(s: &mut Sketch) {
    blobs(s);
    s.blobs.iter_mut().for_each(|blob| blob.harmonics[0] *= 3.0);
}

/// Long splats beside the picture.
fn beside(s: &mut Sketch) {
    s.blob([-5.5, 0.4, 1.0], [0.6, 0.3, 1.5]);
    s.blob([0.3, 4.6, 1.0], [0.3, 0.6, 1.5]);
}

/// Large discs near the camera, where a projected ellipse is not the picture of a disc.
fn near_flakes(s: &mut Sketch) {
    s.blob([-0.6, 0.4, 5.0], [1.1, 0.7, 0.0]).rotation = turn(Vec3::new(0.2, 1.0, 0.1), 60.0);
    s.blob([0.5, -0.3, 4.6], [0.8, 1.2, 0.0]).rotation = turn(Vec3::new(1.0, 0.2, 0.3), 70.0);
}

/// A splat whose square ends just before a tile, and whose least alpha does not.
fn rim(s: &mut Sketch) {
    s.blob([-0.006_25, 0.0, 0.0], [0.3184; 3]).opacity = 1.0;
}

pub(super) const ROWS: &[SettingRow] = &[
    SettingRow { of: Of::Splats, name: "outline", value: "perspective", draw: tilts },
    SettingRow { of: Of::Splats, name: "outline", value: "raycast", draw: tilts },
    SettingRow { of: Of::Splats, name: "cutoff", value: "1", draw: tilts },
    SettingRow { of: Of::Splats, name: "cutoff", value: "3", draw: tilts },
    SettingRow { of: Of::Splats, name: "low_pass", value: "0", draw: tilts },
    SettingRow { of: Of::Splats, name: "low_pass", value: "2", draw: tilts },
    SettingRow { of: Of::Splats, name: "epsilon", value: "0.1", draw: steps },
    SettingRow { of: Of::Splats, name: "epsilon", value: "0.2", draw: steps },
    SettingRow { of: Of::Only(&["deferred"]), name: "second", value: "off", draw: ball },
    SettingRow { of: VORONOI, name: "depth", value: "plain", draw: ball },
    SettingRow { of: Of::Groups, name: "bins", value: "3", draw: ball },
    SettingRow { of: Of::Groups, name: "bins", value: "200", draw: ball },
    SettingRow { of: LAYERS, name: "bin_edges", value: "common", draw: veiled_ball },
    SettingRow { of: LAYERS, name: "holes", value: "background", draw: veiled_ball },
    SettingRow { of: HQ, name: "refraction", value: "0.66,0.67,0.68", draw: glass },
    SettingRow {
        of: HQ,
        name: "bends",
        value: "single",
        draw: |s| {
            glass(s);
            s.set("refraction", "0.75");
        },
    },
    SettingRow { of: PEELING, name: "peel", value: "1", draw: |s| layers(s, 5, 0.5) },
    SettingRow { of: PEELING, name: "peel", value: "3", draw: |s| layers(s, 5, 0.5) },
    SettingRow { of: PYRAMID, name: "weights", value: "box", draw: ball },
    SettingRow { of: PYRAMID, name: "occluded", value: "outside", draw: |s| s.scatter(60, 0.5) },
    SettingRow { of: PYRAMID, name: "subpixel_bits", value: "0", draw: mesh },
    SettingRow { of: PYRAMID, name: "subpixel_bits", value: "3", draw: mesh },
    SettingRow { of: TEMPLATE, name: "template", value: "3", draw: |s| s.scatter(60, 0.5) },
    SettingRow { of: TEMPLATE, name: "template", value: "7", draw: ball },
    SettingRow { of: TEMPLATE, name: "levels", value: "radius", draw: ball },
    SettingRow { of: TEMPLATE, name: "levels", value: "covering", draw: ball },
    SettingRow {
        of: TEMPLATE,
        name: "levels",
        value: "diameter",
        draw: |s| {
            ball(s);
            s.set("template", "3");
        },
    },
    SettingRow { of: TEMPLATE, name: "falloff", value: "gaussian", draw: ball },
    SettingRow {
        of: GAUSSIANS,
        name: "near_depth",
        value: "8",
        draw: |s| s.scatter_blobs(60, 0.3),
    },
    SettingRow { of: GAUSSIANS, name: "disc", value: "ray", draw: near_flakes },
    SettingRow { of: GAUSSIANS, name: "disc", value: "ray-box", draw: near_flakes },
    SettingRow { of: GAUSSIANS, name: "clamp", value: "none", draw: beside },
    SettingRow {
        of: GAUSSIANS,
        name: "clamp",
        value: "edges",
        // About the middle both bounds are the same.
        draw: |s| {
            beside(s);
            s.shift = [5.25, -3.5];
        },
    },
    SettingRow { of: GAUSSIANS, name: "low_pass", value: "0", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "low_pass", value: "0.1", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "compensation", value: "ratio", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "compensation", value: "floor", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "compensation", value: "mip", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "degree", value: "0", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "degree", value: "1", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "degree", value: "2", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "color_bounds", value: "none", draw: bright },
    SettingRow { of: GAUSSIANS, name: "color_bounds", value: "unit", draw: bright },
    SettingRow { of: GAUSSIANS, name: "order", value: "distance", draw: crowd },
    SettingRow { of: GAUSSIANS, name: "order", value: "steps", draw: crowd },
    SettingRow { of: GAUSSIANS, name: "order", value: "pixel", draw: crowd },
    SettingRow { of: GAUSSIANS, name: "support", value: "none", draw: rim },
    SettingRow { of: GAUSSIANS, name: "support", value: "ellipse", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "support", value: "boxes", draw: opaque },
    SettingRow { of: GAUSSIANS, name: "cutoff", value: "1", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "cutoff", value: "2", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "least_alpha", value: "0", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "least_alpha", value: "0.05", draw: blobs },
    SettingRow { of: GAUSSIANS, name: "most_alpha", value: "0.999", draw: opaque },
    SettingRow { of: GAUSSIANS, name: "most_alpha", value: "0.5", draw: opaque },
    SettingRow { of: GAUSSIANS, name: "stop", value: "0", draw: opaque },
    SettingRow { of: GAUSSIANS, name: "stop", value: "0.1", draw: opaque },
    SettingRow { of: GAUSSIANS, name: "blend", value: "linear", draw: blobs },
    SettingRow {
        of: GAUSSIANS,
        name: "blend",
        value: "srgb",
        draw: |s| {
            blobs(s);
            s.linear = true;
        },
    },
];

/// The large scenes, which every method has.
pub(super) const LARGE: &[Row] = &[
    Row {
        name: "large-cluster",
        tests: "All rules together: 32 spheres of 5,000 surfels, 320 x 240 pixels.",
        of: Of::All,
        draw: |s| s.large(Shape::Cluster),
        otherwise: |s| s.grow(1.01),
    },
    Row {
        name: "large-torus",
        tests: "All rules together: a torus of 5,000 surfels, 320 x 240 pixels.",
        of: Of::All,
        draw: |s| s.large(Shape::Torus),
        otherwise: |s| s.grow(1.01),
    },
];
