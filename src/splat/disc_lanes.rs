//! Discs side by side, for loops that vectorize.

use super::Disc;
use crate::number::lanes::{LANES, Lanes};
use crate::number::{Real, Vector3};
use crate::scene::Surfels;
use glam::Vec3;

/// [`LANES`] surfels; each number of the surfels is a vector. With `TANGENTS` the surfels are
/// ellipses.
pub(super) struct DiscLanes<const TANGENTS: bool> {
    /// Position, normal, radius, and both tangents.
    numbers: [Lanes; 13],
}

impl<const TANGENTS: bool> DiscLanes<TANGENTS> {
    /// Reads a surfel for each lane, and multiplies its radius, or tangents, by the factor of the
    /// lane.
    #[inline(always)]
    pub(super) fn new(surfels: &Surfels, item: impl Fn(usize) -> (usize, f32)) -> Self {
        let mut lanes = Self { numbers: [[0.0; LANES]; 13] };
        let (positions, normals) = (surfels.position(), surfels.normal());
        for lane in 0..LANES {
            let (surfel, scale) = item(lane);
            lanes.put(lane, 0, positions[surfel]);
            lanes.put(lane, 3, normals[surfel]);
            lanes.numbers[6][lane] = surfels.radius()[surfel] * scale;
            if let (true, Some(tangents)) = (TANGENTS, surfels.tangents()) {
                let [u, v] = tangents[surfel];
                lanes.put(lane, 7, u * scale);
                lanes.put(lane, 10, v * scale);
            }
        }
        lanes
    }

    #[inline(always)]
    fn put(&mut self, lane: usize, first: usize, v: Vec3) {
        self.numbers[first][lane] = v.x;
        self.numbers[first + 1][lane] = v.y;
        self.numbers[first + 2][lane] = v.z;
    }

    /// The surfel of a lane.
    #[inline(always)]
    pub(super) fn get<R: Real>(&self, lane: usize) -> Disc<R> {
        let n = |field: usize| R::from_f32(self.numbers[field][lane]);
        let vector = |first: usize| Vector3::new(n(first), n(first + 1), n(first + 2));
        Disc {
            position: vector(0),
            normal: vector(3),
            radius: n(6),
            tangents: if TANGENTS { Some([vector(7), vector(10)]) } else { None },
        }
    }
}
