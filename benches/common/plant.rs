//! Meshes of 12 million triangles, as many as the power plant of \[BJFM19\] has.

use glam::DVec3;
use splatref::Result;
use splatref::number::elementary::{cos, sin};
use splatref::number::random;
use splatref::scene::{Triangles, Vertices};
use std::f64::consts::TAU;

/// A torus with bumps, of 12 million triangles: far more than there are pixels.
pub(crate) fn torus() -> Result<Triangles> {
    let at = |a: f64, b: f64| {
        let ring = 1.0 + 0.4 * cos(b) + 0.02 * sin(40.0 * a) * cos(30.0 * b);
        DVec3::new(ring * cos(a), 0.4 * sin(b), ring * sin(a))
    };
    let mut mesh = Vertices::default();
    let mut corners = Vec::new();
    sheet(&mut mesh, &mut corners, [3000, 2000], at);
    Ok(Triangles::new(mesh, corners)?.0)
}

/// 6,000 pipes along the axes in a box, of 2,000 triangles each: most of them hidden, as in the power
/// plant, which has 12 million.
pub(crate) fn pipes() -> Result<Triangles> {
    let mut mesh = Vertices::default();
    let mut corners = Vec::new();
    for pipe in 0..6000 {
        let number = |i: u64| f64::from(random::unit(9, 8 * pipe + i));
        let axis = (3.0 * number(0)) as usize;
        let radius = 0.002 + 0.01 * number(1) * number(1);
        let (length, [u, v, w]) = (0.1 + 0.5 * number(2), [3, 4, 5].map(number));
        sheet(&mut mesh, &mut corners, [20, 50], |a, b| {
            let along = w + length * b / TAU;
            let ring = [u + radius * cos(a), v + radius * sin(a)];
            let mut at = DVec3::ZERO;
            (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (along, ring[0], ring[1]);
            at
        });
    }
    Ok(Triangles::new(mesh, corners)?.0)
}

/// A closed sheet of so many columns and rows over two angles.
fn sheet(
    mesh: &mut Vertices,
    corners: &mut Vec<[u32; 3]>,
    [columns, rows]: [u32; 2],
    at: impl Fn(f64, f64) -> DVec3,
) {
    let first = mesh.position.len() as u32;
    let angle = |i: u32, of: u32| f64::from(i) / f64::from(of) * TAU;
    for i in 0..columns * (rows + 1) {
        let (a, b) = (angle(i % columns, columns), angle(i / columns, rows));
        let (p, step) = (at(a, b), 1e-4);
        let normal = (at(a, b + step) - p).cross(at(a + step, b) - p);
        mesh.position.push(p.as_vec3());
        mesh.direction.push(normal.normalize_or(DVec3::X).as_vec3());
        mesh.radius.push(0.0);
    }
    let at = |i: u32, j: u32| first + j * columns + i % columns;
    for i in 0..columns {
        for j in 0..rows {
            corners.push([at(i, j), at(i, j + 1), at(i + 1, j + 1)]);
            corners.push([at(i, j), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
}
