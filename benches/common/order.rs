//! Surfels in the order of a space-filling curve.

use glam::{UVec3, Vec3};
use splatref::Result;
use splatref::scene::{Cloud, Sphere, Surfels};

/// The surfels in the order of their cells along the curve of Morton, 1024 cells a side of the cube
/// around them: consecutive surfels are neighbours.
pub(crate) fn along_a_curve(surfels: Surfels) -> Result<Surfels> {
    let Sphere { center, radius } = surfels.bounding_sphere();
    let cell = |p: &Vec3| {
        let from_corner = (p.as_dvec3() - center) / (2.0 * radius) + 0.5;
        (from_corner * 1023.0).as_uvec3()
    };
    let mut order: Vec<(u32, usize)> =
        surfels.position().iter().enumerate().map(|(i, p)| (code(cell(p)), i)).collect();
    order.sort_unstable();
    let cloud = surfels.into_cloud();
    Ok(Surfels::new(Cloud {
        position: picked(&cloud.position, &order),
        normal: cloud.normal.map(|all| picked(&all, &order)),
        radius: cloud.radius.map(|all| picked(&all, &order)),
        color: cloud.color.map(|all| picked(&all, &order)),
        ..Cloud::default()
    })?
    .0)
}

fn picked<T: Copy>(all: &[T], order: &[(u32, usize)]) -> Vec<T> {
    order.iter().map(|&(_, i)| all[i]).collect()
}

/// The lowest ten bits of three numbers by turns.
fn code(cell: UVec3) -> u32 {
    let spread = |v: u32| (0..10).fold(0, |sum, bit| sum | (v >> bit & 1) << (3 * bit));
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
}
