//! Rules about 3D Gaussian splats.

use super::{Of, Row};
use crate::number::elementary;
use crate::scene::Lens;
use crate::verdict::conformance::sketch::Sketch;
use glam::{DVec3, Quat, Vec3};

const OF: Of = Of::Only(&["gaussians"]);

/// A turn about an axis of any length.
pub(super) fn turn(axis: Vec3, degrees: f32) -> Quat {
    let axis = axis.as_dvec3().normalize();
    let half = f64::from(degrees).to_radians() / 2.0;
    let (sin, cos) = (elementary::sin(half), elementary::cos(half));
    let [x, y, z] = (axis * sin).to_array().map(|part| part as f32);
    Quat::from_xyzw(x, y, z, cos as f32)
}

/// A tilt that leaves no symmetry.
fn tilt() -> Quat {
    turn(Vec3::new(0.3, 0.5, 0.8), 50.0)
}

/// A splat of three different scales, turned.
fn turned(s: &mut Sketch, axis: Vec3) {
    let blob = s.blob([0.1, 0.05, 0.0], [1.0, 0.4, 0.15]);
    blob.rotation = turn(axis, 40.0) * tilt();
}

/// Three splats away from the middle.
fn three(s: &mut Sketch) {
    s.blob([-1.1, 0.6, 0.5], [0.5, 0.2, 0.3]).rotation = turn(Vec3::new(0.2, 0.4, 1.0), 30.0);
    s.blob([1.0, 0.5, -0.5], [0.3, 0.6, 0.2]).rotation = turn(Vec3::new(1.0, 0.4, 0.1), 50.0);
    s.blob([0.2, -0.8, 0.0], [0.4, 0.3, 0.7]).rotation = turn(Vec3::new(0.3, 1.0, 0.3), 70.0);
}

/// Splats that face the camera, the farthest first.
fn stack(s: &mut Sketch, layers: u8, opacity: f32) {
    for i in 0..layers {
        let step = f32::from(i);
        s.blob([0.1 * step - 0.3, 0.05 * step - 0.2, 0.6 * step - 3.0], [0.9; 3]).opacity = opacity;
    }
}

/// A surface whose depth grows from this one on, and which no splat touches at a pixel's centre.
fn slope(x: u32, y: u32, from: f32) -> (f32, [f32; 3]) {
    (from + 0.0413 * x as f32, [0.75, 0.5, 0.02 * y as f32])
}

/// A surface of one depth in the left half of the picture.
fn half(x: u32, depth: f32) -> (f32, [f32; 3]) {
    (if x < 24 { depth } else { f32::INFINITY }, [0.75, 0.5, 0.125])
}

/// Two splats of which the nearer by depth is the farther by distance.
fn apart(s: &mut Sketch) {
    s.blob([2.0, 1.2, 0.1], [0.9; 3]);
    s.blob([0.6, 0.5, 0.0], [0.9; 3]);
}

/// Splats that look different from every side, all around the axis of view.
fn look(s: &mut Sketch, degree: u8) {
    for i in 0..5_u8 {
        let step = f32::from(i) - 2.0;
        s.blob([0.9 * step, 0.6 * step * (1.0 - 0.4 * step), 0.3 * step], [0.35; 3]).look(degree);
    }
}

/// A splat with one function alone, off the axis of view, so that no function is 0 there.
fn harmonic(s: &mut Sketch, index: usize) {
    s.pose.eye = DVec3::new(3.1, 4.2, 5.3);
    s.blob([0.2, 0.1, 0.3], [0.7, 0.5, 0.6]).harmonics = alone(index);
}

fn alone(index: usize) -> Vec<Vec3> {
    let mut all = vec![Vec3::ZERO; 16];
    all[index] = Vec3::new(0.5, -0.3, 0.8);
    all
}

/// A splat that is a disc, where rays meet discs.
fn disc(s: &mut Sketch, scale: [f32; 2], axis: Vec3, degrees: f32) {
    s.set("disc", "ray");
    s.set("low_pass", "0.5");
    s.blob([0.13, -0.08, 0.0], [scale[0], scale[1], 0.0]).rotation = turn(axis, degrees);
}

/// A rule for the coefficient of one function.
macro_rules! harmonic {
    ($index:literal, $name:literal) => {
        Row {
            name: $name,
            tests: concat!("The coefficient ", $index, " of the spherical harmonics alone."),
            of: OF,
            draw: |s| harmonic(s, $index),
            otherwise: |s| s.blobs[0].harmonics[$index] *= -1.0,
        }
    };
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
    Row {
        name: "look-of-degree-0",
        tests: "Colours are harmonics of degree 0.",
        of: OF,
        draw: |s| {
            look(s, 0);
        },
        otherwise: |s| s.blobs[0].harmonics[0].x += 0.05,
    },
    Row {
        name: "look-of-degree-1",
        tests: "Colours are harmonics of degree 1.",
        of: OF,
        draw: |s| {
            look(s, 1);
        },
        otherwise: |s| s.set("degree", "0"),
    },
    Row {
        name: "look-of-degree-2",
        tests: "Colours are harmonics of degree 2.",
        of: OF,
        draw: |s| {
            look(s, 2);
        },
        otherwise: |s| s.set("degree", "1"),
    },
    Row {
        name: "look-of-degree-3",
        tests: "Colours are harmonics of degree 3.",
        of: OF,
        draw: |s| {
            look(s, 3);
        },
        otherwise: |s| s.set("degree", "2"),
    },
    Row {
        name: "direction",
        tests: "Harmonics are taken in the direction from the camera to the splat.",
        of: OF,
        draw: |s| {
            look(s, 3);
        },
        otherwise: |s| {
            for blob in &mut s.blobs {
                for i in (1..4).chain(9..16) {
                    blob.harmonics[i] = -blob.harmonics[i];
                }
            }
        },
    },
    Row {
        name: "direction-of-world",
        tests: "Harmonics are taken in the axes of the world.",
        of: OF,
        draw: |s| {
            look(s, 3);
            s.pose.eye = DVec3::new(4.0, 3.0, 6.0);
        },
        otherwise: |s| {
            for blob in &mut s.blobs {
                blob.harmonics.swap(1, 3);
            }
        },
    },
    Row {
        name: "colors-below-0",
        tests: "A colour below 0 becomes 0, and one above 1 stays.",
        of: OF,
        draw: |s| {
            s.blob([0.1, 0.1, 0.0], [0.6; 3]).harmonics[0] = Vec3::new(-3.0, 4.0, 1.0);
        },
        otherwise: |s| s.set("color_bounds", "none"),
    },
    Row {
        name: "linear",
        tests: "The scene stores linear light.",
        of: OF,
        draw: |s| {
            three(s);
            s.linear = true;
        },
        otherwise: |s| s.linear = false,
    },
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
    harmonic!(1, "harmonics-1"),
    harmonic!(2, "harmonics-2"),
    harmonic!(3, "harmonics-3"),
    harmonic!(4, "harmonics-4"),
    harmonic!(5, "harmonics-5"),
    harmonic!(6, "harmonics-6"),
    harmonic!(7, "harmonics-7"),
    harmonic!(8, "harmonics-8"),
    harmonic!(9, "harmonics-9"),
    harmonic!(10, "harmonics-10"),
    harmonic!(11, "harmonics-11"),
    harmonic!(12, "harmonics-12"),
    harmonic!(13, "harmonics-13"),
    harmonic!(14, "harmonics-14"),
    harmonic!(15, "harmonics-15"),
];
