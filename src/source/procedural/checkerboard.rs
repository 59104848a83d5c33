//! The checkerboard plane, up to the horizon.

use super::Hit;
use super::sampling::{Sampler, cell_radius};
use glam::DVec3;

/// Half the side of the inner grid.
const INNER: f64 = 4.0;
/// Square rings around the inner grid, each twice as large as the one before: they end at
/// 4 * 2^10 = 4096.
const RINGS: u32 = 10;

const LIGHT: DVec3 = DVec3::new(0.875, 0.84375, 0.75);
const DARK: DVec3 = DVec3::new(0.0625, 0.09375, 0.1875);

/// Adds about `count` surfels: an inner grid of n x n cells, n even, and in each ring the cells of
/// an n x n grid of the ring's size. Cells wholly in the middle half of a ring are left out,
/// because the smaller grids fill it.
pub(super) fn sample(square: f32, count: usize, sampler: &mut Sampler) {
    let grids = 1.0 + 0.75 * f64::from(RINGS);
    let half = ((count as f64 / grids).sqrt() / 2.0 + 0.5).floor() as usize;
    let half = if half < 1 { 1 } else { half };
    for ring in 0..=RINGS {
        let cell = INNER * f64::from(1_u32 << ring) / half as f64;
        // From a quarter to three quarters of the 2 half cells.
        let hole = |i: usize| ring > 0 && 2 * i >= half && 2 * i + 2 <= 3 * half;
        for row in 0..2 * half {
            for column in 0..2 * half {
                if hole(row) && hole(column) {
                    continue;
                }
                let [x, z] = sampler.displaced();
                let place = |i: usize, v: f64| (i as f64 - half as f64 + v) * cell;
                let p = DVec3::new(place(column, x), 0.0, place(row, z));
                // Use the rounded position, so that the colour matches the side of an edge where
                // the surfel is.
                let color = color(square, p.as_vec3().as_dvec3());
                sampler.push(p, DVec3::Y, cell_radius(cell, cell), color);
            }
        }
    }
}

/// The hit with the infinite plane, if its parameter is > `beyond`.
pub(super) fn trace(square: f32, origin: DVec3, direction: DVec3, beyond: f64) -> Option<Hit> {
    let t = -origin.y / direction.y;
    let p = origin + direction * t;
    let hit = t > beyond && p.is_finite();
    hit.then(|| Hit { t, normal: DVec3::Y, color: color(square, p) })
}

/// The light colour on squares whose column and row add up to an even number.
fn color(square: f32, p: DVec3) -> DVec3 {
    let sum = (p.x / f64::from(square)).floor() + (p.z / f64::from(square)).floor();
    if sum - 2.0 * (sum / 2.0).floor() == 0.0 { LIGHT } else { DARK }
}
