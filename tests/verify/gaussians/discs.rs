//! A second renderer of 2D Gaussians, in the order of the authors' program: each ray is the cross product
//! of two planes that a matrix from the disc to the pixels gives.

use glam::{DVec3, Mat3, Quat, Vec3};
use splatref::frame::{Exec, Frame, NO_ID, Plane, Samples};
use splatref::method::gaussians::Settings;
use splatref::method::{Method, Session};
use splatref::number::Real;
use splatref::number::random::unit;
use splatref::scene::gaussians::Encoding;
use splatref::scene::{Camera, GaussianArrays, Gaussians, Lens, Pose, Scene};
use splatref::verdict::client::{Client, Rounding};
use splatref::verdict::{Outcome, Verdict};
use std::f32::consts::FRAC_1_SQRT_2;

/// Mistakes of one line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Bug {
    NoFilter,
    FilterOnce,
    ScalesExchanged,
    FilterAboutCenter,
    DepthOfCenter,
    NearOfFragmentsMissing,
}

/// A disc as the program keeps it.
struct Disc {
    id: u32,
    /// The rows of the matrix from (u, v, 1) to the pixels.
    rows: [Vec3; 3],
    middle: [f32; 2],
    /// The tiles that it touches: first column and row, end of columns and rows.
    tiles: [i32; 4],
    opacity: f32,
    color: Vec3,
    depth: f32,
}

fn project(scene: &Gaussians, camera: &Camera, i: usize, bug: Option<Bug>) -> Option<Disc> {
    let view = camera.view_from_world;
    let turn = Mat3::from_diagonal(Vec3::new(1.0, -1.0, -1.0)) * Mat3::from_mat4(view);
    let at = view.transform_point3(scene.position()[i]) * Vec3::new(1.0, -1.0, -1.0);
    if at.z <= 0.2 {
        return None;
    }
    let mut scale = scene.scale()[i];
    if bug == Some(Bug::ScalesExchanged) {
        scale = Vec3::new(scale.y, scale.x, scale.z);
    }
    let own = Mat3::from_quat(Quat::from_array(scene.rotation()[i]));
    let (a, b) = (turn * (own.x_axis * scale.x), turn * (own.y_axis * scale.y));
    // The centre of a pixel is a whole number here.
    let (cx, cy) = (camera.cx - 0.5, camera.cy - 0.5);
    let deep = Vec3::new(a.z, b.z, at.z);
    let rows = [
        Vec3::new(a.x, b.x, at.x) * camera.fx + deep * cx,
        Vec3::new(a.y, b.y, at.y) * camera.fy + deep * cy,
        deep,
    ];
    let t = Vec3::new(9.0, 9.0, -1.0);
    let f = t / t.dot(deep * deep);
    let middle = [0, 1].map(|k| f.dot(rows[k] * deep));
    let half = [0, 1].map(|k| {
        let square = middle[k] * middle[k] - f.dot(rows[k] * rows[k]);
        square.at_least(1e-4).sqrt()
    });
    let radius = half[0].at_least(half[1]).at_least(3.0 * FRAC_1_SQRT_2).ceil();
    let tile = |at: f32, size: u32| ((at / 16.0) as i32).clamp(0, size.div_ceil(16) as i32);
    let (w, h) = (camera.width, camera.height);
    let tiles = [
        tile(middle[0] - radius, w),
        tile(middle[1] - radius, h),
        tile(middle[0] + radius + 15.0, w),
        tile(middle[1] + radius + 15.0, h),
    ];
    let middle = if bug == Some(Bug::FilterAboutCenter) {
        [rows[0].z / at.z, rows[1].z / at.z]
    } else {
        middle
    };
    let color = (scene.harmonics(i)[0] * 0.282_094_8 + 0.5).max(Vec3::ZERO);
    let opacity = scene.opacity()[i];
    Some(Disc { id: i as u32, rows, middle, tiles, opacity, color, depth: at.z })
}

/// The alpha of a disc at a pixel, and its depth.
fn meet(disc: &Disc, [x, y]: [f32; 2], bug: Option<Bug>) -> Option<(f32, f32)> {
    let [u, v, w] = disc.rows;
    let p = (w * x - u).cross(w * y - v);
    if p.z == 0.0 {
        return None;
    }
    let s = [p.x / p.z, p.y / p.z];
    let rho3d = s[0] * s[0] + s[1] * s[1];
    let d = [disc.middle[0] - x, disc.middle[1] - y];
    let factor = if bug == Some(Bug::FilterOnce) { 1.0 } else { 2.0 };
    let rho2d = factor * (d[0] * d[0] + d[1] * d[1]);
    let rho = if bug == Some(Bug::NoFilter) { rho3d } else { rho3d.at_most(rho2d) };
    let depth = s[0] * w.x + s[1] * w.y + w.z;
    if depth < 0.2 && bug != Some(Bug::NearOfFragmentsMissing) {
        return None;
    }
    let alpha = (disc.opacity * Real::exp(-0.5 * rho)).at_most(0.99);
    let depth = if bug == Some(Bug::DepthOfCenter) { disc.depth } else { depth };
    (alpha >= 1.0 / 255.0).then_some((alpha, depth))
}

/// The planes of blending.
fn draw(scene: &Gaussians, camera: &Camera, bug: Option<Bug>) -> Frame<f32> {
    let mut discs: Vec<_> =
        (0..scene.len()).filter_map(|i| project(scene, camera, i, bug)).collect();
    discs.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    let (w, h) = (camera.width, camera.height);
    let (mut colors, mut through, mut depths) = (Vec::new(), Vec::new(), Vec::new());
    let (mut ids, mut counts) = (Vec::new(), Vec::new());
    for at in 0..w * h {
        let (x, y) = (at % w, at / w);
        let (mut color, mut t, mut first, mut count) = (Vec3::ZERO, 1.0, None, 0);
        for disc in &discs {
            let ([x0, y0, x1, y1], i, j) = (disc.tiles, x as i32 / 16, y as i32 / 16);
            if i < x0 || i >= x1 || j < y0 || j >= y1 {
                continue;
            }
            let Some((alpha, depth)) = meet(disc, [x as f32, y as f32], bug) else { continue };
            if t * (1.0 - alpha) < 1e-4 {
                break;
            }
            color += disc.color * (alpha * t);
            t *= 1.0 - alpha;
            first = first.or(Some((disc.id, depth)));
            count += 1;
        }
        let (id, depth) = first.unwrap_or((NO_ID, f32::INFINITY));
        colors.push(color.to_array());
        through.push(t);
        depths.push(depth);
        ids.push(id);
        counts.push(count);
    }
    let frame = Frame::new(w, h);
    let frame = frame.with("blended", Samples::Color(Plane::from_values(w, h, colors))).unwrap();
    let frame = frame.with("T", Samples::Scalar(Plane::from_values(w, h, through))).unwrap();
    let frame = frame.with("Z", Samples::Scalar(Plane::from_values(w, h, depths))).unwrap();
    let frame = frame.with("id", Samples::Index(Plane::from_values(w, h, ids))).unwrap();
    frame.with("count", Samples::Count(Plane::from_values(w, h, counts))).unwrap()
}

/// Discs of these sizes around a place.
fn scene(count: u64, size: f32, seed: u64) -> Scene {
    let random = |i: u64, k: u64| 2.0 * unit(seed, 31 * i + k) - 1.0;
    let vector = |i: u64, k: u64| Vec3::new(random(i, k), random(i, k + 1), random(i, k + 2));
    let arrays = GaussianArrays {
        position: (0..count).map(|i| vector(i, 0) * Vec3::new(2.0, 1.5, 2.5)).collect(),
        scale: (0..count).map(|i| (vector(i, 3).abs() + 0.1) * size).collect(),
        rotation: (0..count).map(|i| [6, 7, 8, 9].map(|k| random(i, k))).collect(),
        opacity: (0..count).map(|i| 0.05 + 0.95 * random(i, 10).abs()).collect(),
        degree: 0,
        harmonics: (0..count).map(|i| vector(i, 11)).collect(),
        encoding: Encoding::Srgb,
    };
    Scene::of_gaussians("discs", Gaussians::new(arrays).unwrap().0)
}

fn camera() -> Camera {
    let pose = Pose { eye: DVec3::new(0.4, 0.3, 3.5), target: DVec3::ZERO, up: DVec3::Y };
    let mut camera = Camera::new(80, 56, pose, Lens::FieldOfView(60.0)).unwrap();
    (camera.cx, camera.fy) = (camera.cx + 3.25, camera.fy * 1.0625);
    camera
}

/// The same view at the right end of a wide picture, where the authors' squares of half sides cancel most.
fn wide_camera() -> Camera {
    let narrow = camera();
    let mut wide = Camera { width: 4096, height: narrow.height, ..narrow };
    wide.cx += 4096.0 - 80.0;
    wide
}

fn judged((scene, camera): (&Scene, Camera), bug: Option<Bug>) -> Verdict {
    let exec = Exec::sequential();
    let session = Session::new(scene, Method::from(Settings::DISCS), &exec).unwrap();
    let frame = draw(scene.gaussians.as_ref().unwrap(), &camera, bug);
    let mut client = Client::from(&frame);
    client.rounding = Rounding::Gpu;
    session.verify(&camera, &client, Verdict::BUDGET).unwrap()
}

#[test]
fn the_order_of_the_authors_program_is_right() {
    for (count, size, camera) in [
        (300, 0.02, camera()),
        (120, 0.1, camera()),
        (30, 0.6, camera()),
        (3000, 0.1, wide_camera()),
    ] {
        let verdict = judged((&scene(count, size, 5), camera), None);
        let (outcome, undecided) = (verdict.outcome(), verdict.undecided);
        let worst = verdict.first_wrong().map(|stage| &stage.worst);
        assert_eq!(outcome, Outcome::Right, "{count} of {size}: {undecided}, {worst:?}");
    }
}

#[test]
fn mistakes_with_discs_are_found() {
    for (bug, size) in [
        (Bug::NoFilter, 0.02),
        (Bug::FilterOnce, 0.02),
        (Bug::ScalesExchanged, 0.1),
        (Bug::FilterAboutCenter, 0.6),
        (Bug::DepthOfCenter, 0.1),
        (Bug::NearOfFragmentsMissing, 0.6),
    ] {
        let verdict = judged((&scene(120, size, 5), camera()), Some(bug));
        assert_eq!(verdict.outcome(), Outcome::Wrong, "{bug:?}");
    }
}
