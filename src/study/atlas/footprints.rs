//! Entries about footprints that differ from the projection of a disc.

use super::case::{Case, both, checked, exact, quiet};
use super::{Failure, Found};
use crate::error::Result;
use crate::frame::Exec;
use crate::method::{Method, ewa};
use crate::number::elementary::{cos, sin, tan};
use crate::scene::{Camera, Cloud, Lens, Pose, Scene, Surfels};
use crate::source::Shape;
use crate::splat::{Kernel, Outline};
use crate::study::truth::of_points;
use glam::DVec3;

pub(super) const FAILURES: [Failure; 4] = [
    Failure {
        id: "ewa-grazing",
        title: "The footprint of a tilted disc is not its outline",
        why: "One disc, three radii away, is tilted more and more. It has no low-pass filter and \
              is cut off at its rim. The affine footprint of EWA is a linear map at the disc's \
              centre [ZPvBG01, eq. 8]. Perspective makes the near half of a tilted disc larger and \
              its far half smaller, but the footprint shows neither.",
        swept: "tilt, degrees",
        values: &[0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 80.0, 85.0],
        error: "wrong pixels of the footprint, per mille of the disc",
        limit: 50.0,
        cure: "`--outline raycast`: each pixel's ray meets the disc's plane",
        at: grazing,
    },
    Failure {
        id: "ewa-wide",
        title: "A footprint off the axis of a wide lens is not the disc's outline",
        why: "One disc faces the eye, three radii away along the axis, and moves farther and \
              farther from the axis. The lens stretches the disc and also tilts it against the \
              picture, but the affine footprint assumes the stretch of the centre everywhere \
              [ZRB+04].",
        swept: "angle to the axis, degrees",
        values: &[0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0],
        error: "wrong pixels of the footprint, per mille of the disc",
        limit: 50.0,
        cure: "`--outline perspective` [ZRB+04]",
        at: wide,
    },
    Failure {
        id: "ewa-near",
        title: "Discs close to the eye leave holes and cover the sky",
        why: "The eye comes down to a checked plane of 2,000 surfels. The outline of a disc that \
              reaches behind the camera is no ellipse. An affine footprint ends above the horizon, \
              or before the disc does.",
        swept: "height of the eye over the plane, radii of the nearest discs",
        values: &[16.0, 8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.125],
        error: "wrongly covered or missed pixels, per mille of all",
        limit: 50.0,
        cure: "`--outline raycast`",
        at: near,
    },
    Failure {
        id: "ewa-minify",
        title: "Checks smaller than a pixel alias",
        why: "A sphere of 100,000 surfels has finer and finer checks, and is drawn without the \
              low-pass filter. Splats smaller than a pixel then count only if their centres fall \
              in the right place [ZPvBG01, 4].",
        swept: "side of a check, px",
        values: &[8.0, 4.0, 3.0, 2.0, 1.5, 1.0, 0.75, 0.5],
        error: "RMSE, linear RGB, to 8 x 8 times the pixels",
        limit: 0.15,
        cure: "`--low-pass 0.25`, the default",
        at: minify,
    },
];

const FLOOR: Shape = Shape::Checkerboard { square: 1.0 };

fn splatting(outline: Outline, low_pass: f32) -> Method {
    let kernel = Kernel { outline, low_pass, ..Kernel::DEFAULT };
    ewa::Settings { kernel, ..ewa::Settings::default() }.into()
}

fn grazing(degrees: f64, exec: &Exec) -> Result<[Found; 2]> {
    let found = |cured| {
        let outline = if cured { Outline::RayCast } else { Outline::Affine };
        one_disc(DVec3::Z * -3.0, degrees, outline, exec)
    };
    both(found)
}

fn wide(degrees: f64, exec: &Exec) -> Result<[Found; 2]> {
    let center = DVec3::new(3.0 * tan(degrees.to_radians()), 0.0, -3.0);
    let found = |cured| {
        let outline = if cured { Outline::Perspective } else { Outline::Affine };
        one_disc(center, -degrees, outline, exec)
    };
    both(found)
}

/// A disc of radius 1 around a point, with its normal turned about +y from +z, in the middle of a
/// picture whose plane is z = -1.
fn one_disc(center: DVec3, degrees: f64, outline: Outline, exec: &Exec) -> Result<Found> {
    const SIDE: u32 = 256;
    let tilt = degrees.to_radians();
    let normal = DVec3::new(sin(tilt), 0.0, cos(tilt));
    let cloud = Cloud {
        position: vec![center.as_vec3()],
        normal: Some(vec![normal.as_vec3()]),
        radius: Some(vec![1.0]),
        ..Cloud::default()
    };
    let pose = Pose { eye: DVec3::ZERO, target: -DVec3::Z, up: DVec3::Y };
    let mut camera = Camera::new(SIDE, SIDE, pose, Lens::Focal(256.0))?;
    // The camera is shifted, not turned.
    camera.cx -= (f64::from(camera.fx) * center.x / -center.z) as f32;
    let kernel = Kernel { outline, low_pass: 0.0, cutoff: 1.0 };
    let settings = ewa::Settings { kernel, ..ewa::Settings::BOTH_SIDES };
    let scene = Scene::lit("disc", Surfels::new(cloud)?.0);
    let case = Case { scene, camera, method: settings.into(), grouping: None };
    let (frame, time) = case.draw(exec)?;
    let (mut disc, mut wrong) = (0_u32, 0_u32);
    for (i, alpha) in (0..).zip(frame.scalar("A")?.values()) {
        let [x, y] = [i % SIDE, i / SIDE].map(|v| f64::from(v) + 0.5);
        let [cx, cy, fx] = [camera.cx, camera.cy, camera.fx].map(f64::from);
        let ray = DVec3::new((x - cx) / fx, -(y - cy) / fx, -1.0);
        let t = center.dot(normal) / ray.dot(normal);
        let inside = t > 0.0 && (ray * t - center).length() <= 1.0;
        disc += u32::from(inside);
        wrong += u32::from(inside != (*alpha > 0.0));
    }
    let error = 1e3 * f64::from(wrong) / f64::from(disc.max(1));
    Ok(Found { error, picture: frame.color("")?.clone(), time: Some(time) })
}

fn near(radii: f64, exec: &Exec) -> Result<[Found; 2]> {
    let method = |outline| splatting(outline, Kernel::DEFAULT.low_pass);
    let case = Case::of_shape(FLOOR, 2000, method(Outline::Affine))?;
    let radii_of = case.scene.surfels.radius().iter();
    let least = radii_of.fold(f32::INFINITY, |a, b| if *b < a { *b } else { a });
    let eye = DVec3::new(0.0, radii * f64::from(least), 0.0);
    let target = eye + DVec3::new(0.5, -0.2, -1.0);
    let case = case.seen_from(eye, target, 60.0)?;
    let truth = case.truth(&exact(FLOOR), exec)?;
    let covered = truth.scalar("A")?.values();
    let found = |case: &Case| {
        let (frame, time) = case.draw(exec)?;
        let pixels = frame.scalar("A")?.values().iter().zip(covered);
        let wrong = pixels.filter(|(found, truth)| (**found > 0.0) != (**truth > 0.0)).count();
        let error = 1e3 * wrong as f64 / covered.len() as f64;
        Ok(Found { error, picture: frame.color("")?.clone(), time: Some(time) })
    };
    Ok([found(&case)?, found(&Case { method: method(Outline::RayCast), ..case })?])
}

fn minify(pixels: f64, exec: &Exec) -> Result<[Found; 2]> {
    const SIDE: u32 = 80;
    let camera =
        Camera::new(SIDE, SIDE, Shape::Sphere.default_pose(), Shape::Sphere.default_lens())?;
    let side = pixels * 4.0 / f64::from(camera.fy);
    let surfels = checked(Shape::Sphere.surfels(100_000, 0)?, side)?;
    let scene = Scene::unlit("checks", surfels);
    let truth = of_points(&scene, &camera, &[], exec, &quiet)?.frame;
    let method = splatting(Outline::Affine, 0.0);
    let cure = splatting(Outline::Affine, Kernel::DEFAULT.low_pass);
    Case { scene, camera, method, grouping: None }.and_cured(cure, &truth, "rmse", exec)
}
