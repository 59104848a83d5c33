//! Rules about depth: the band of the visible surface, layers, opacity and groups.

use super::{Of, Row};
use crate::source::Shape;

/// Methods whose epsilon is a band behind the nearest fragment.
const BANDS: Of = Of::Only(&["ewa", "deferred", "single-pass", "transparent-hq", "peeling"]);
const LAYERED: Of = Of::Only(&["transparent", "transparent-hq"]);

/// Two discs that face the camera, one behind the other.
fn gap(s: &mut super::Sketch, gap: f32) {
    s.disc([0.1, 0.1, 0.0], 0.9);
    s.disc([0.4, -0.1, -gap], 0.9);
    s.set("epsilon", "0.25");
}

/// Layers that face the camera, the farthest first.
fn stack(s: &mut super::Sketch, layers: u8, opacity: f32) {
    for i in 0..layers {
        let step = f32::from(i);
        s.disc([0.2 * step - 0.5, 0.1 * step - 0.3, 0.75 * step - 3.0], 1.25);
    }
    s.veil(opacity);
}

/// The same, with an epsilon smaller than the gaps.
pub(super) fn layers(s: &mut super::Sketch, layers: u8, opacity: f32) {
    stack(s, layers, opacity);
    s.set("epsilon", "0.25");
}

/// A ball in groups.
fn grouped(s: &mut super::Sketch, groups: &[(&'static str, &'static str)]) {
    s.shape(Shape::Sphere, 80, 2.0);
    s.groups = groups.to_vec();
}

/// One group for all.
fn one_group(s: &mut super::Sketch) {
    s.groups = vec![("overlap", "0"), ("count", "any"), ("extend", "none")];
}

pub(super) const ROWS: &[Row] = &[
    Row {
        name: "epsilon-inside",
        tests: "A fragment just nearer than epsilon behind the nearest belongs to the surface.",
        of: BANDS,
        draw: |s| gap(s, 0.2475),
        otherwise: |s| s.set("epsilon", "0.245"),
    },
    Row {
        name: "epsilon-outside",
        tests: "A fragment just farther than epsilon behind the nearest does not belong to it.",
        of: BANDS,
        draw: |s| gap(s, 0.2525),
        otherwise: |s| s.set("epsilon", "0.255"),
    },
    Row {
        name: "epsilon-in-radii",
        tests: "Epsilon may be given in median radii: the lower median of all radii.",
        of: Of::Splats,
        draw: |s| {
            gap(s, 0.375);
            s.disc([-1.5, 1.0, 0.0], 0.25);
            s.disc([-1.5, -1.0, -0.3], 0.25);
            s.set("epsilon", "1r");
        },
        otherwise: |s| s.set("epsilon", "0.575"),
    },
    Row {
        name: "epsilon-on-a-slope",
        tests: "Depths of a steep surface are compared at each pixel.",
        of: Of::Splats,
        draw: |s| {
            for i in 0..6_u8 {
                let step = f32::from(i) - 2.5;
                s.tilted([0.3 * step, 0.1, -0.6 * step], 0.7, [2.0, 0.0, 1.0]);
            }
            s.set("epsilon", "0.5");
        },
        // By the depths of centres, neighbours are too far apart.
        otherwise: |s| {
            s.discs.remove(2);
        },
    },
    Row {
        name: "layers-apart",
        tests: "Layers lie farther apart than epsilon.",
        of: Of::Splats,
        draw: |s| layers(s, 8, 1.0),
        otherwise: |s| s.discs.iter_mut().for_each(|disc| disc.at.z = -3.0 - disc.at.z),
    },
    Row {
        name: "opacity-ignored",
        tests: "A method of opaque surfaces ignores opacities.",
        of: Of::Opaque,
        draw: |s| {
            stack(s, 3, 0.5);
        },
        otherwise: |s| s.discs.iter_mut().for_each(|disc| disc.color *= 0.5),
    },
    Row {
        name: "opacity",
        tests: "Surfels of opacity 1/4, 1/2 and 1 lie one behind the other.",
        of: Of::Blending,
        draw: |s| {
            layers(s, 3, 1.0);
            s.discs[1].opacity = 0.5;
            s.discs[2].opacity = 0.25;
        },
        otherwise: |s| s.veil(1.0),
    },
    Row {
        name: "opacity-0",
        tests: "A surfel of opacity 0 hides nothing.",
        of: Of::Blending,
        draw: |s| {
            layers(s, 2, 0.75);
            s.discs[1].opacity = 0.0;
        },
        otherwise: |s| s.discs[1].opacity = 1.0,
    },
    Row {
        name: "opaque-layer",
        tests: "Nothing shines through a layer of opacity 1.",
        of: Of::Blending,
        draw: |s| {
            layers(s, 3, 0.5);
            s.discs[1].opacity = 1.0;
        },
        otherwise: |s| s.discs[1].opacity = 0.9,
    },
    Row {
        name: "layers",
        tests: "Eight layers of opacity 1/2 are composited in the order of their depths.",
        of: Of::Blending,
        draw: |s| layers(s, 8, 0.5),
        otherwise: |s| s.discs.iter_mut().for_each(|disc| disc.at.z = -3.0 - disc.at.z),
    },
    Row {
        name: "layers-unsorted",
        tests: "The list of surfels is in no order of depth.",
        of: Of::Blending,
        draw: |s| {
            layers(s, 5, 0.5);
            s.discs.swap(0, 3);
            s.discs.swap(1, 4);
        },
        otherwise: |s| {
            let depths = [-3.0, -2.25, -1.5, -0.75, 0.0];
            s.discs.iter_mut().zip(depths).for_each(|(disc, z)| disc.at.z = z);
        },
    },
    Row {
        name: "veiled-ball",
        tests: "The near and the far side of a ball of opacity 1/2 are both seen.",
        of: Of::Blending,
        draw: |s| {
            s.shape(Shape::Sphere, 80, 2.0);
            s.veil(0.5);
        },
        otherwise: |s| s.set("cull", "on"),
    },
    Row {
        name: "sky-behind-layers",
        tests: "The sky shines through layers.",
        of: Of::Blending,
        draw: |s| {
            layers(s, 3, 0.5);
            s.sky = true;
        },
        otherwise: |s| s.sky = false,
    },
    Row {
        name: "groups",
        tests: "Each surfel is drawn into the depth-image of its group.",
        of: Of::Groups,
        draw: |s| grouped(s, &[("overlap", "0.5"), ("count", "any"), ("extend", "none")]),
        otherwise: one_group,
    },
    Row {
        name: "groups-added",
        tests: "A surfel may belong to several groups.",
        of: LAYERED,
        draw: |s| grouped(s, &[("overlap", "1"), ("count", "3"), ("extend", "add")]),
        otherwise: |s| s.groups.push(("extend", "none")),
    },
    Row {
        name: "groups-enlarged",
        tests: "The radii of a group are multiplied by the scale of the group.",
        of: LAYERED,
        draw: |s| grouped(s, &[("overlap", "1"), ("count", "2"), ("extend", "enlarge")]),
        otherwise: |s| s.groups.push(("extend", "none")),
    },
];
