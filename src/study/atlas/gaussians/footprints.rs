//! Entries about ellipses on the screen.

use super::super::case::both;
use super::{
    BLUE, Blob, Failure, Found, ORANGE, SEEN, ahead, draw, measured, part, scene, truth, turn,
    worst,
};
use crate::error::Result;
use crate::frame::{Exec, Plane};
use crate::method::gaussians::Settings;
use crate::number::Real;
use crate::number::elementary::{cos, exp, ln, sin};
use crate::scene::{Camera, Lens, Pose};
use crate::splat::gaussian::{Clamp, Compensation, GaussianKernel};
use glam::{DQuat, DVec3};

pub(in super::super) const FAILURES: [Failure; 4] = [
    Failure {
        id: "gaussians-far",
        title: "Thin splats become brighter with the distance",
        why: "24 needles, each an opaque Gaussian, become thinner, as they do when the camera moves \
              away. The low-pass filter of 0.3 px^2 widens each ellipse and keeps its opacity. A \
              needle much thinner than a pixel should cover a part of the pixel, but the filter \
              makes it cover the whole pixel [Yu et al. 2024, Mip-Splatting]. The truth is the mean \
              of 8 x 8 rays a pixel, in f64.",
        swept: "standard deviation of a needle, px",
        values: &[4.0, 2.0, 1.0, 0.5, 0.25, 0.125, 0.0625],
        error: "light that is too much or too little, %",
        limit: 10.0,
        cure: "`--compensation ratio`, if the file was trained with it",
        at: far,
    },
    Failure {
        id: "gaussians-beside",
        title: "A splat beside the camera covers the picture",
        why: "A round Gaussian moves out of the picture until it is beside the camera. It stays ten \
              standard deviations away, and three of them never reach into the picture. The ellipse \
              is the projection linearized at the centre [ZPvBG01, section 4], and grows with 1 / \
              cos^2 of the angle. `khr` does not clamp it. The truth is the greatest density along \
              each ray, in f64.",
        swept: "angle to the axis, degrees",
        values: &[50.0, 55.0, 60.0, 65.0, 70.0, 80.0, 85.0],
        error: "greatest error of a pixel, of 255",
        limit: SEEN,
        cure: "`--clamp fov` or `--clamp edges`",
        at: beside,
    },
    Failure {
        id: "gaussians-shift",
        title: "A shifted lens deforms splats within the picture",
        why: "The original program clamps x/t and y/t to 1.3 times half the field of view, as if \
              the principal point were in the middle. A shifted lens draws one part of a large \
              picture, or one eye of a headset, and its picture reaches beyond that bound. Rods \
              along the view are too short there, and turned. The truth is the same part of a \
              larger picture by the same program, with the principal point in the middle.",
        swept: "shift of the principal point, widths of the picture",
        values: &[0.0, 0.2, 0.3, 0.4, 0.5],
        error: "greatest error of a pixel, of 255",
        limit: SEEN,
        cure: "`--clamp edges`",
        at: shift,
    },
    Failure {
        id: "gaussians-near",
        title: "A large splat near the camera leaves its plane",
        why: "A flat Gaussian on the floor grows. It lies 4 units ahead of an eye at height 1. The \
              projection is linearized at its centre, so the ellipse has the scale of the centre \
              everywhere. Perspective makes the near half larger and the far half smaller. A large \
              ellipse also reaches over the horizon. The truth is the greatest density along each \
              ray, in f64. From half the distance on, the parts next to the eye are too large as \
              well.",
        swept: "standard deviation, as a fraction of the distance",
        values: &[0.015625, 0.03125, 0.125, 0.25, 0.5, 1.0],
        error: "greatest error of a pixel, of 255",
        limit: SEEN,
        cure: "split it into splats of an eighth of the size that have the same opacity together",
        at: near,
    },
];

/// A setting of the projection.
fn with_kernel(settings: Settings, change: impl FnOnce(&mut GaussianKernel)) -> Settings {
    let mut kernel = settings.kernel;
    change(&mut kernel);
    Settings { kernel, ..settings }
}

fn far(pixels: f64, exec: &Exec) -> Result<[Found; 2]> {
    // One world unit at the needles is 16 pixels.
    let camera = ahead([160, 120], 160.0)?;
    let needles = (0..24).map(|i| {
        let cell = DVec3::new(f64::from(i % 6) - 2.5, f64::from(i / 6) - 1.5, 0.0) * 1.7;
        Blob {
            scale: DVec3::new(0.5, pixels / 16.0, pixels / 16.0),
            rotation: turn(DVec3::Z, 100.0 * f64::from(i)),
            ..Blob::round(cell - DVec3::Z * 10.0, 0.0, ORANGE)
        }
    });
    let needles: Vec<Blob> = needles.collect();
    let sum = |plane: &Plane<[f32; 3]>| {
        plane.values().as_flattened().iter().map(|part| f64::from(*part)).sum::<f64>()
    };
    let truth = sum(&truth(&needles, &camera, 8, exec));
    let scene = scene(&needles)?;
    both(|cured| {
        let settings = with_kernel(Settings::INRIA, |kernel| {
            kernel.compensation = if cured { Compensation::Ratio } else { Compensation::None };
        });
        let error = |found: &Plane<_>| 100.0 * (sum(found) / truth - 1.0).abs();
        measured(&scene, &camera, settings, error, exec)
    })
}

fn beside(degrees: f64, exec: &Exec) -> Result<[Found; 2]> {
    // Half the width is 30 degrees.
    let camera = ahead([240, 180], 208.0)?;
    let angle = degrees.to_radians();
    let grey = DVec3::splat(0.7);
    let blobs = [
        Blob::round(DVec3::new(-1.0, 0.2, -8.0), 0.4, ORANGE),
        Blob::round(DVec3::new(1.5, -0.4, -8.0), 0.4, BLUE),
        Blob::round(DVec3::new(sin(angle), 0.0, -cos(angle)), 0.1, grey),
    ];
    let truth = truth(&blobs, &camera, 1, exec);
    let scene = scene(&blobs)?;
    both(|cured| {
        let settings = with_kernel(Settings::KHR, |kernel| {
            kernel.clamp = if cured { Clamp::Fov } else { Clamp::None };
        });
        measured(&scene, &camera, settings, |found| worst(found, &truth), exec)
    })
}

fn shift(widths: f64, exec: &Exec) -> Result<[Found; 2]> {
    const SIZE: [u32; 2] = [160, 120];
    let whole = ahead([2 * SIZE[0], SIZE[1]], 160.0)?;
    // The first column of the part; whole tiles of 16 pixels, on which the program depends.
    let first = SIZE[0] / 2 + (widths * f64::from(SIZE[0])) as u32;
    let shifted = Camera { width: SIZE[0], cx: whole.cx - first as f32, ..whole };
    // Rods over the right half of the larger picture.
    let rods = (0..24).map(|i| {
        let (x, y) = (f64::from(i % 8) * 0.12, f64::from(i / 8) * 0.2 - 0.2);
        Blob {
            scale: DVec3::new(0.04, 0.04, 0.3),
            ..Blob::round(DVec3::new(x, y, -1.0) * 4.0, 0.0, if i % 2 == 0 { ORANGE } else { BLUE })
        }
    });
    let scene = scene(&rods.collect::<Vec<_>>())?;
    both(|cured| {
        let settings = with_kernel(Settings::INRIA, |kernel| {
            kernel.clamp = if cured { Clamp::Edges } else { Clamp::Fov };
        });
        let larger = draw(&scene, &whole, settings, exec)?.0;
        let same = part(larger.color("blended")?, [first, 0], SIZE);
        measured(&scene, &shifted, settings, |found| worst(found, &same), exec)
    })
}

fn near(size: f64, exec: &Exec) -> Result<[Found; 2]> {
    const DISTANCE: f64 = 4.0;
    let pose = Pose { eye: DVec3::Y, target: DVec3::new(0.0, 0.8, -1.0), up: DVec3::Y };
    let camera = Camera::new(240, 180, pose, Lens::FieldOfView(45.0))?;
    let deviation = size * DISTANCE;
    let whole = Blob {
        opacity: 0.75,
        scale: DVec3::new(deviation, 0.001, deviation),
        rotation: DQuat::IDENTITY,
        ..Blob::round(DVec3::new(0.0, 0.0, -DISTANCE), 0.0, ORANGE)
    };
    let truth = truth(&[whole], &camera, 1, exec);
    let found = |blobs: &[Blob]| {
        let settings = with_kernel(Settings::KHR, |kernel| kernel.low_pass = 0.0);
        measured(&scene(blobs)?, &camera, settings, |found| worst(found, &truth), exec)
    };
    Ok([found(&[whole])?, found(&split(&whole))?])
}

/// Many splats with an eighth of the standard deviations along x and z, which let through the same
/// light together.
fn split(whole: &Blob) -> Vec<Blob> {
    // In standard deviations of the whole: that of a part, the distance between parts, the reach.
    const PART: f64 = 0.125;
    const STEP: f64 = 0.1;
    const REACH: i32 = 36;
    let mut parts = Vec::new();
    for i in -REACH..=REACH {
        for j in -REACH..=REACH {
            let at = DVec3::new(f64::from(i), 0.0, f64::from(j)) * STEP;
            // Of sums of Gaussians variances add up.
            let density = exp(-at.length_squared() / (2.0 * (1.0 - PART * PART)));
            let depth = -ln(1.0 - whole.opacity * density);
            let share = STEP * STEP / (std::f64::consts::TAU * PART * PART);
            let scale = whole.scale * DVec3::new(PART, 1.0, PART);
            let opacity = (depth * share).at_most(1.0);
            parts.push(Blob { at: whole.at + at * whole.scale, scale, opacity, ..*whole });
        }
    }
    parts
}
