//! Rules about colours, light, and what lies behind.

use super::{Of, Row};
use crate::scene::{Light, Phong};
use glam::Vec3;

/// Two tilted discs.
fn two(s: &mut super::Sketch) {
    s.tilted([-0.9, 0.4, 0.0], 1.0, [0.4, 0.3, 1.0]);
    s.tilted([0.9, -0.3, 0.3], 1.1, [-0.5, 0.2, 1.0]);
}

/// Another light than the one that a picture has by default.
fn default_light(s: &mut super::Sketch) {
    s.lights = vec![Light::DEFAULT];
}

pub(super) const ROWS: &[Row] = &[
    Row {
        name: "unlit",
        tests: "Without a light, the colours are shown as they are.",
        of: Of::All,
        draw: |s| {
            two(s);
            s.lights.clear();
        },
        otherwise: default_light,
    },
    Row {
        name: "directional-light",
        tests: "A coloured light shines from a direction of the world.",
        of: Of::All,
        draw: |s| {
            two(s);
            s.pose.eye = glam::DVec3::new(3.0, 1.0, 7.0);
            let towards = Vec3::new(2.0, -1.0, 1.5);
            s.lights = vec![Light::Directional { towards, color: Vec3::new(1.0, 0.5, 0.25) }];
        },
        otherwise: |s| {
            let towards = Vec3::new(2.0, -1.0, 1.5);
            s.lights = vec![Light::Headlight { towards, color: Vec3::new(1.0, 0.5, 0.25) }];
        },
    },
    Row {
        name: "headlight",
        tests: "A light moves with the camera: its direction is in view space.",
        of: Of::All,
        draw: |s| {
            two(s);
            s.pose.eye = glam::DVec3::new(-4.0, 2.0, 6.0);
            s.lights =
                vec![Light::Headlight { towards: Vec3::new(0.5, 1.0, 1.0), color: Vec3::ONE }];
        },
        otherwise: |s| {
            let towards = Vec3::new(0.5, 1.0, 1.0);
            s.lights = vec![Light::Directional { towards, color: Vec3::ONE }];
        },
    },
    Row {
        name: "point-light",
        tests: "A light stands near the surface, so that its direction changes from pixel to pixel.",
        of: Of::All,
        draw: |s| {
            two(s);
            s.lights = vec![Light::Point { position: Vec3::new(0.5, 1.0, 1.5), color: Vec3::ONE }];
        },
        otherwise: |s| {
            let towards = Vec3::new(0.5, 1.0, 1.5);
            s.lights = vec![Light::Directional { towards, color: Vec3::ONE }];
        },
    },
    Row {
        name: "two-lights",
        tests: "The light of several lights is added.",
        of: Of::All,
        draw: |s| {
            two(s);
            let color = Vec3::new(0.25, 0.5, 0.75);
            s.lights.push(Light::Directional { towards: Vec3::new(1.0, 2.0, 1.0), color });
        },
        otherwise: default_light,
    },
    Row {
        name: "material",
        tests: "The material has other weights and another shininess.",
        of: Of::All,
        draw: |s| {
            two(s);
            s.material = Phong {
                ambient: 0.25,
                diffuse: 0.5,
                specular: 0.75,
                shininess: 5.0,
                ..Phong::default()
            };
        },
        otherwise: |s| s.material = Phong::default(),
    },
    Row {
        name: "no-colours",
        tests: "Surfels without colours have the colour of the material.",
        of: Of::All,
        draw: |s| {
            two(s);
            s.colored = false;
            s.material.color = Vec3::new(0.25, 0.5, 1.0);
        },
        otherwise: |s| s.material.color = Phong::default().color,
    },
    Row {
        name: "bright",
        tests: "Colours above 1 are not clamped.",
        of: Of::All,
        draw: |s| {
            two(s);
            s.discs[0].color = Vec3::new(4.0, 0.5, 1.5);
            s.lights.clear();
        },
        otherwise: |s| s.discs[0].color = Vec3::new(1.0, 0.5, 1.0),
    },
    Row {
        name: "background",
        tests: "The sky is seen where nothing hides it.",
        of: Of::All,
        draw: |s| {
            two(s);
            s.sky = true;
        },
        otherwise: |s| s.sky = false,
    },
];
