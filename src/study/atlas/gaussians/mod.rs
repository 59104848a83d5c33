//! Entries about 3D Gaussians: where the programs that draw them leave the truth.
//!
//! Errors are read from the plane `blended`, in steps of 8 bits, because Gaussians are blended as
//! sRGB values and shown with 8 bits. The limit of a pixel is [`SEEN`] of these steps.

pub(super) mod blending;
pub(super) mod footprints;

use super::case::{Case, change};
use super::{Failure, Found};
use crate::error::Result;
use crate::frame::{Exec, Frame, Plane};
use crate::method::gaussians::Settings;
use crate::number::Real;
use crate::number::elementary::{cos, exp, sin};
use crate::scene::gaussians::Encoding;
use crate::scene::{Camera, GaussianArrays, Gaussians, Lens, Pose, Scene};
use glam::{DMat3, DQuat, DVec3, Vec3};
use std::time::Duration;

/// An error of a pixel that is seen beside its neighbours: 3 % of white.
const SEEN: f64 = 8.0;

/// A Gaussian of one colour, in the numbers of a file after activation.
#[derive(Clone, Copy, Debug)]
struct Blob {
    at: DVec3,
    /// Standard deviations along its own axes.
    scale: DVec3,
    rotation: DQuat,
    opacity: f64,
    /// As it is blended.
    color: DVec3,
}

/// Colours that differ in every channel.
const ORANGE: DVec3 = DVec3::new(0.95, 0.6, 0.15);
const BLUE: DVec3 = DVec3::new(0.15, 0.4, 0.9);

impl Blob {
    /// A round and opaque one.
    fn round(at: DVec3, deviation: f64, color: DVec3) -> Self {
        let scale = DVec3::splat(deviation);
        Self { at, scale, rotation: DQuat::IDENTITY, opacity: 1.0, color }
    }
}

/// A rotation about a unit axis.
fn turn(axis: DVec3, degrees: f64) -> DQuat {
    let half = degrees.to_radians() / 2.0;
    let part = axis * sin(half);
    DQuat::from_xyzw(part.x, part.y, part.z, cos(half))
}

/// A camera at the origin that looks along -z.
fn ahead(size: [u32; 2], focal: f64) -> Result<Camera> {
    let pose = Pose { eye: DVec3::ZERO, target: -DVec3::Z, up: DVec3::Y };
    Camera::new(size[0], size[1], pose, Lens::Focal(focal))
}

fn scene(blobs: &[Blob]) -> Result<Scene> {
    // The colour of degree 0 is 0.28209 times the coefficient, plus 1/2.
    let coefficient = |color: DVec3| (color - 0.5) / 0.282_094_791_773_878_1;
    let each = |part: fn(&Blob) -> DVec3| -> Vec<Vec3> {
        blobs.iter().map(|blob| part(blob).as_vec3()).collect()
    };
    let arrays = GaussianArrays {
        position: each(|blob| blob.at),
        scale: each(|blob| blob.scale),
        rotation: blobs.iter().map(|blob| blob.rotation.as_quat().to_array()).collect(),
        opacity: blobs.iter().map(|blob| blob.opacity as f32).collect(),
        degree: 0,
        harmonics: blobs.iter().map(|blob| coefficient(blob.color).as_vec3()).collect(),
        encoding: Encoding::Srgb,
    };
    Ok(Scene::of_gaussians("splats", Gaussians::new(arrays)?.0))
}

fn draw(
    scene: &Scene,
    camera: &Camera,
    settings: Settings,
    exec: &Exec,
) -> Result<(Frame<f32>, Duration)> {
    let (scene, camera) = (scene.clone(), *camera);
    Case { scene, camera, method: settings.into(), grouping: None }.draw(exec)
}

/// Draws a scene, and measures its blended values.
fn measured(
    scene: &Scene,
    camera: &Camera,
    settings: Settings,
    error: impl FnOnce(&Plane<[f32; 3]>) -> f64,
    exec: &Exec,
) -> Result<Found> {
    let (frame, time) = draw(scene, camera, settings, exec)?;
    let picture = frame.color("")?.clone();
    Ok(Found { error: error(frame.color("blended")?), picture, time: Some(time) })
}

/// The part of a plane from a pixel on.
fn part(plane: &Plane<[f32; 3]>, [left, top]: [u32; 2], size: [u32; 2]) -> Plane<[f32; 3]> {
    Plane::from_pixels(size, |x, y| *plane.at(x + left, y + top))
}

/// The greatest difference of a channel, in steps of 8 bits.
fn worst(found: &Plane<[f32; 3]>, truth: &Plane<[f32; 3]>) -> f64 {
    let parts = change(found, truth);
    let parts = parts.as_flattened().iter().map(|part| f64::from(part.abs()));
    255.0 * parts.fold(0.0, Real::at_least)
}

/// The pixels whose greatest difference is above [`SEEN`], per mille of those that are not black.
fn share(found: &Plane<[f32; 3]>, truth: &Plane<[f32; 3]>) -> f64 {
    let seen = |pixel: &[f32; 3], least: f64| {
        pixel.iter().any(|part| 255.0 * f64::from(part.abs()) > least)
    };
    let wrong = change(found, truth).iter().filter(|pixel| seen(pixel, SEEN)).count();
    let drawn = truth.values().iter().filter(|pixel| seen(pixel, SEEN)).count();
    1e3 * wrong as f64 / drawn.max(1) as f64
}

/// The truth: along each ray a Gaussian has the opacity of its greatest density there, without any
/// filter, bound or cut-off. They are blended in the order of these places. A pixel is the mean of
/// `samples` x `samples` rays. In f64.
fn truth(blobs: &[Blob], camera: &Camera, samples: u32, exec: &Exec) -> Plane<[f32; 3]> {
    let turned = DMat3::from_mat4(camera.view_from_world.as_dmat4()).transpose();
    let eye = camera.eye();
    // The scene where the Gaussian is the unit one: the eye, what turns rays, the Gaussian.
    let units = blobs.iter().map(|blob| {
        let own = DMat3::from_diagonal(1.0 / blob.scale)
            * DMat3::from_quat(blob.rotation.normalize()).transpose();
        (own * (eye - blob.at), own * turned, *blob)
    });
    let units: Vec<_> = units.collect();
    let [fx, fy, cx, cy] = [camera.fx, camera.fy, camera.cx, camera.cy].map(f64::from);
    let step = 1.0 / f64::from(samples);
    let pixel = |x: u32, y: u32| {
        let rays = (0..samples * samples).map(|i| {
            let [x, y] = [(x, i % samples), (y, i / samples)]
                .map(|(at, i)| f64::from(at) + (f64::from(i) + 0.5) * step);
            along(&units, DVec3::new((x - cx) / fx, (cy - y) / fy, -1.0))
        });
        (rays.sum::<DVec3>() * (step * step)).as_vec3().to_array()
    };
    let row = |y| (0..camera.width).map(|x| pixel(x, y)).collect::<Vec<_>>();
    let rows = exec.ordered((0..camera.height).collect(), row);
    Plane::from_values(camera.width, camera.height, rows.concat())
}

/// The values that arrive along a ray, which has z = -1 in view space.
fn along(units: &[(DVec3, DMat3, Blob)], ray: DVec3) -> DVec3 {
    // An alpha of e^-15 is not seen.
    const FAR: f64 = 30.0;
    let fragment = |(eye, turned, blob): &(DVec3, DMat3, Blob)| {
        let ray = *turned * ray;
        let depth = (-eye.dot(ray) / ray.length_squared()).at_least(0.0);
        let square = (*eye + ray * depth).length_squared();
        (square < FAR).then(|| (depth, blob.opacity * exp(-square / 2.0), blob.color))
    };
    let mut fragments: Vec<_> = units.iter().filter_map(fragment).collect();
    fragments.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut sum, mut through) = (DVec3::ZERO, 1.0);
    for (_, alpha, color) in fragments {
        sum += color * (alpha * through);
        through *= 1.0 - alpha;
    }
    sum
}
