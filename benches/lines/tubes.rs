//! The silhouette of one straight tube, which is two straight lines.
//!
//! An orthographic camera sees the tube across, turned in the picture. In each row of the picture the
//! tube covers the pixels between its first and its last; their outer borders are compared with the
//! exact lines, along the normal of the line, in pixels. *Offset* is the mean, positive outwards;
//! *roughness* the standard deviation, for exact coverage of pixel centres about 0.29 whatever the
//! angle; *worst* the largest distance. The tube's ends are left out. The truth is the same tube as
//! triangles.

use super::tree::scene;
use crate::common::mesh::Mesh;
use crate::common::report::{Arguments, Table};
use crate::common::shot::Shot;
use glam::{DVec3, Vec3};
use splatref::Result;
use splatref::frame::{Exec, Plane};
use splatref::method::{Session, pyramid};
use splatref::number::Real;
use splatref::scene::{Camera, Lens, Polylines, Pose, Primitives, Triangles, Vertices};

const SIDE: u32 = 512;
const RADII: [f32; 12] = [1.3, 2.6, 4.0, 5.2, 6.5, 8.0, 10.4, 13.0, 16.0, 20.8, 26.0, 32.0];
/// Degrees from upright.
const ANGLES: [f64; 5] = [0.0, 5.0, 15.0, 30.0, 45.0];

pub(crate) fn table(arguments: &Arguments, exec: &Exec) -> Result<()> {
    let mut columns = vec!["radius, px".to_owned(), "drawn as".to_owned()];
    columns.extend(ANGLES.map(|angle| format!("{angle} degrees")));
    let mut table = Table::new(&columns.iter().map(String::as_str).collect::<Vec<_>>());
    for radius in RADII.into_iter().filter(|r| format!("tube {r}").contains(&arguments.pattern)) {
        let mut rows = [const { Vec::new() }; 2];
        for angle in ANGLES {
            let camera = camera(angle)?;
            let tube = scene(tube(radius)?);
            let drawn = Session::new(&tube, pyramid::Settings::default().into(), exec)?
                .render(&camera)?
                .frame
                .clone();
            let (mesh, _) = Mesh::of(scene(cylinder(radius)?)).truth(&camera, exec)?;
            for (row, alpha) in rows.iter_mut().zip([Shot::of(drawn).alpha, mesh.alpha]) {
                row.push(outline(&alpha, radius.into(), angle));
            }
        }
        for (kind, row) in ["tube", "triangles"].iter().zip(rows) {
            table.row(&format!("{radius} | {kind} | {}", row.join(" | ")));
        }
    }
    table.publish(arguments, "image-space.md", "tubes")
}

/// One pixel a world unit; up is turned, and the tube with it.
fn camera(angle: f64) -> Result<Camera> {
    let (sin, cos) = sin_cos(angle);
    let pose = Pose {
        eye: DVec3::new(0.0, 0.0, 1000.0),
        target: DVec3::ZERO,
        up: DVec3::new(sin, cos, 0.0),
    };
    Camera::new(SIDE, SIDE, pose, Lens::Orthographic(f64::from(SIDE)))
}

fn sin_cos(degrees: f64) -> (f64, f64) {
    let angle = degrees.to_radians();
    (splatref::number::elementary::sin(angle), splatref::number::elementary::cos(angle))
}

/// A tube of ten segments along y, off the centre of a pixel.
fn tube(radius: f32) -> Result<Primitives> {
    let position: Vec<_> = (0..=10).map(|i| Vec3::new(0.3, (i as f32 - 5.0) * 60.0, 0.0)).collect();
    let vertices = Vertices {
        direction: vec![Vec3::Y; position.len()],
        radius: vec![radius; position.len()],
        position,
        color: None,
        ..Vertices::default()
    };
    let segments = (0..10).map(|i| [i, i + 1]).collect();
    Ok(Primitives { tubes: Polylines::new(vertices, segments)?.0, ..Primitives::default() })
}

/// The same as triangles, 256 around.
fn cylinder(radius: f32) -> Result<Primitives> {
    const SIDES: u32 = 256;
    let ring = |y: f32| {
        (0..SIDES).map(move |i| {
            let (sin, cos) = sin_cos(360.0 * f64::from(i) / f64::from(SIDES));
            let out = Vec3::new(cos as f32, 0.0, sin as f32);
            (out * radius + Vec3::new(0.3, y, 0.0), out)
        })
    };
    let (position, direction): (Vec<_>, Vec<_>) = ring(-300.0).chain(ring(300.0)).unzip();
    let radius = vec![0.0; position.len()];
    let corners = (0..SIDES).flat_map(|i| {
        let next = (i + 1) % SIDES;
        [[i, SIDES + i, next], [next, SIDES + i, SIDES + next]]
    });
    let vertices = Vertices { position, direction, radius, color: None, ..Vertices::default() };
    let triangles = Triangles::new(vertices, corners.collect())?.0;
    Ok(Primitives { triangles, ..Primitives::default() })
}

/// Offset, roughness and worst of both borders in the middle rows.
fn outline(alpha: &Plane<f32>, radius: f64, angle: f64) -> String {
    // The axis passes through world (0.3, 0), and leans to the left where up leans to the right.
    let (sin, cos) = sin_cos(angle);
    let (half, mut away) = (f64::from(SIDE) / 2.0, Vec::new());
    for y in SIDE / 4..SIDE * 3 / 4 {
        let covered = |x: &u32| *alpha.at(*x, y) > 0.0;
        let (Some(first), Some(last)) = ((0..SIDE).find(covered), (0..SIDE).rev().find(covered))
        else {
            away.push(-radius);
            continue;
        };
        // A point of the picture in the world, and its distance from the axis x = 0.3.
        let up = half - (f64::from(y) + 0.5);
        let distance = |column: f64| {
            let right = column - half;
            (right * cos + up * sin) - f64::from(0.3_f32)
        };
        away.push(-distance(first.into()) - radius);
        away.push(distance(f64::from(last) + 1.0) - radius);
    }
    let mean = away.iter().sum::<f64>() / away.len() as f64;
    let square = away.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / away.len() as f64;
    let worst = away.iter().fold(0.0_f64, |worst, d| worst.at_least(d.abs()));
    format!("{mean:.2}, {:.2}, {worst:.1}", square.sqrt())
}
