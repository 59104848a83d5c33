//! Rectangles of constant z: the sheets and the staircase.

use super::sampling::{Sampler, cell_radius};
use super::{Hit, PALETTE};
use crate::number::MapInline;
use glam::DVec3;

/// A rectangle: low <= (x, y) <= high in a plane of constant z.
pub(super) struct Plate {
    low: [f64; 2],
    high: [f64; 2],
    z: f64,
    normal: DVec3,
    color: DVec3,
}

/// The front sheet, then the back one.
pub(super) fn sheets(gap: f32) -> Vec<Plate> {
    let sheet = |half: f64, z: f64, color: [f64; 3]| Plate {
        low: [-half; 2],
        high: [half; 2],
        z,
        normal: DVec3::Z,
        color: color.into(),
    };
    vec![sheet(1.0, 0.0, PALETTE[0]), sheet(1.5, -f64::from(gap), PALETTE[1])]
}

/// Front and back of each plate, from the nearest to the farthest.
pub(super) fn staircase(step: f32, thickness: f32) -> Vec<Plate> {
    let plate = |k: usize, back: bool| {
        let bottom = k as f64 / 4.0 - 1.125;
        let front = -(k as f64) * f64::from(step);
        let color = DVec3::from(PALETTE[k]);
        Plate {
            low: [-1.0, bottom],
            high: [1.0, bottom + 0.5],
            z: if back { front - f64::from(thickness) } else { front },
            normal: if back { -DVec3::Z } else { DVec3::Z },
            color: if back { 1.0 - color } else { color },
        }
    };
    (0..PALETTE.len()).flat_map(|k| [plate(k, false), plate(k, true)]).collect()
}

/// Adds about `count` surfels, in grids. Their cells are as close to squares of one size as whole
/// numbers of rows and columns allow.
pub(super) fn sample(plates: &[Plate], count: usize, sampler: &mut Sampler) {
    let area: f64 = plates.iter().map(|p| (p.high[0] - p.low[0]) * (p.high[1] - p.low[1])).sum();
    let spacing = (area / count as f64).sqrt();
    for plate in plates {
        let [width, height] = [0, 1].map_inline(|axis| plate.high[axis] - plate.low[axis]);
        let [columns, rows] = [width, height].map_inline(|side| {
            let cells = (side / spacing + 0.5).floor();
            if cells < 1.0 { 1.0 } else { cells }
        });
        let (dx, dy) = (width / columns, height / rows);
        for row in 0..rows as usize {
            for column in 0..columns as usize {
                let [x, y] = sampler.displaced();
                let p = DVec3::new(
                    plate.low[0] + (column as f64 + x) * dx,
                    plate.low[1] + (row as f64 + y) * dy,
                    plate.z,
                );
                sampler.push(p, plate.normal, cell_radius(dx, dy), plate.color);
            }
        }
    }
}

impl Plate {
    /// The hit, if its parameter is > `beyond`; the edges belong to the plate.
    pub(super) fn trace(&self, origin: DVec3, direction: DVec3, beyond: f64) -> Option<Hit> {
        let t = (self.z - origin.z) / direction.z;
        let inside = |v: f64, axis: usize| self.low[axis] <= v && v <= self.high[axis];
        // A ray within the plane has a parameter that is infinite or NaN, and NaN coordinates.
        let hit = t > beyond
            && inside(origin.x + direction.x * t, 0)
            && inside(origin.y + direction.y * t, 1);
        hit.then_some(Hit { t, normal: self.normal, color: self.color })
    }
}
