//! The documented formulas, operation by operation, give the bits of the cameras.

use super::*;
use crate::number::{elementary, random};
use crate::scene::Sphere;

type V = [f64; 3];

fn dot(a: V, b: V) -> f64 {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

fn unit(a: V) -> V {
    let inverse = 1.0 / dot(a, a).sqrt();
    a.map(|c| c * inverse)
}

fn minus(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The rows of the view matrix and the near plane.
fn looking(eye: V, target: V, up: V) -> ([[f32; 4]; 3], f32) {
    let to = minus(target, eye);
    let distance = dot(to, to).sqrt();
    let back = minus(eye, target).map(|c| c / distance);
    let largest =
        up.into_iter().fold(0.0, |most: f64, c| if c.abs() > most { c.abs() } else { most });
    let up = if (1e-100..=1e100).contains(&largest) { up } else { up.map(|c| c / largest) };
    let right = unit(cross(up, back));
    let rows = [right, cross(back, right), back].map(|a| {
        let last = ((a[0] * -eye[0] + a[1] * -eye[1]) + a[2] * -eye[2]) + 0.0;
        [a[0] + 0.0, a[1] + 0.0, a[2] + 0.0, last].map(|c| c as f32)
    });
    (rows, (distance / 1024.0) as f32)
}

fn scale(height: f64, lens: Lens) -> f32 {
    (match lens {
        Lens::FieldOfView(degrees) => {
            let half = (degrees * (std::f64::consts::PI / 180.0)) / 2.0;
            (height / 2.0) / elementary::tan(half)
        }
        Lens::Focal(pixels) => pixels,
        Lens::Orthographic(units) => height / units,
    }) as f32
}

/// The eye, from the rows of the view matrix.
fn eye(v: [[f64; 4]; 3]) -> V {
    let a = v[1][2] * v[2][3] - v[1][3] * v[2][2];
    let b = v[0][2] * v[2][3] - v[0][3] * v[2][2];
    let c = v[0][2] * v[1][3] - v[0][3] * v[1][2];
    let d = v[1][1] * v[2][3] - v[1][3] * v[2][1];
    let e = v[0][1] * v[2][3] - v[0][3] * v[2][1];
    let f = v[0][1] * v[1][3] - v[0][3] * v[1][1];
    let x = -((v[0][1] * a - v[1][1] * b) + v[2][1] * c);
    let y = (v[0][0] * a - v[1][0] * b) + v[2][0] * c;
    let z = -((v[0][0] * d - v[1][0] * e) + v[2][0] * f);
    let first = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]);
    let second = v[1][0] * -(v[0][1] * v[2][2] - v[2][1] * v[0][2]);
    let whole = (first + second) + v[2][0] * (v[0][1] * v[1][2] - v[1][1] * v[0][2]);
    [x, y, z].map(|c| c * (1.0 / whole))
}

/// The rows of a camera's view matrix, except the last.
fn rows(camera: &Camera) -> [[f32; 4]; 3] {
    [0, 1, 2].map(|i| camera.view_from_world.row(i).to_array())
}

/// Numbers in [-1, 1), some of them 0.
fn numbers(i: u64, k: u64) -> V {
    [0, 1, 2].map(|c| {
        let at = 64 * i + 4 * k + c;
        let zero = random::unit(2, at) < 0.125;
        if zero { 0.0 } else { f64::from(random::unit(1, at)) * 2.0 - 1.0 }
    })
}

fn lens(i: u64) -> Lens {
    let size = f64::from(random::unit(3, i)) + 0.125;
    match i % 3 {
        0 => Lens::FieldOfView(size * 90.0),
        1 => Lens::Focal(size * 100.0),
        _ => Lens::Orthographic(size * 3.0),
    }
}

fn same(camera: &Camera, expected: [[f32; 4]; 3], near: f32, scale: f32) {
    // Compares bits, because -0 is not +0.
    let bits = |rows: [[f32; 4]; 3]| rows.map(|row| row.map(f32::to_bits));
    assert_eq!(bits(rows(camera)), bits(expected));
    assert_eq!(camera.view_from_world.row(3).to_array(), [0.0, 0.0, 0.0, 1.0]);
    assert_eq!((camera.near, camera.fx, camera.fy), (near, scale, scale));
    let [width, height] = camera.size().map(|side| (f64::from(side) / 2.0) as f32);
    assert_eq!((camera.cx, camera.cy), (width, height));
    let found = camera.eye().to_array().map(f64::to_bits);
    assert_eq!(found, eye(rows(camera).map(|row| row.map(f64::from))).map(f64::to_bits));
}

#[test]
fn a_camera_has_the_bits_of_its_formulas() {
    let mut cameras = 0;
    for i in 0..500 {
        let tiny = if i % 7 == 0 { 1e-150 } else { 1.0 };
        let (place, target) = (numbers(i, 0).map(|c| c * 9.0), numbers(i, 1));
        let up = numbers(i, 2).map(|c| c * tiny);
        let pose = Pose { eye: place.into(), target: target.into(), up: up.into() };
        // Some poses have an up along the view.
        let Ok(camera) = Camera::new(33, 24, pose, lens(i)) else { continue };
        let (expected, near) = looking(place, target, up);
        same(&camera, expected, near, scale(24.0, lens(i)));
        cameras += 1;
    }
    assert!(cameras > 400, "{cameras}");
}

#[test]
fn a_framing_camera_has_the_bits_of_its_formulas() {
    for i in 0..500 {
        let (center, from) =
            (numbers(i, 0), if i % 9 == 0 { [0.0, 1.5, 0.0] } else { numbers(i, 1) });
        if from == [0.0; 3] {
            continue;
        }
        let radius = if i % 5 == 0 { 0.0 } else { 3.0 * f64::from(random::unit(4, i)) };
        let (width, height) = if i % 2 == 0 { (33_u32, 24_u32) } else { (20, 31) };
        let sphere = Sphere { center: DVec3::from(center), radius };
        let camera = Camera::framing(width, height, sphere, from.into(), lens(i)).unwrap();

        let scale = scale(f64::from(height), lens(i));
        let large = if radius > 0.0 { radius * 1.05 } else { 1.0 };
        let half = f64::from(width.min(height)) / 2.0 / f64::from(scale);
        let distance = match lens(i) {
            Lens::Orthographic(_) => 2.0 * large,
            _ => (large * (1.0 + half * half).sqrt()) / half,
        };
        let up =
            if from[0] == 0.0 && from[2] == 0.0 { [-0.0, -0.0, -1.0] } else { [0.0, 1.0, 0.0] };
        let direction = unit(from);
        let place = [0, 1, 2].map(|c| center[c] + direction[c] * distance);
        let (expected, near) = looking(place, center, up);
        same(&camera, expected, near, scale);
    }
}
