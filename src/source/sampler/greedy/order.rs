//! Points in their order, and how the work to order them is divided.

use crate::frame::Exec;

/// Many regions have much border, and what is within reach of it is left to one thread.
const MOST_REGIONS: usize = 16;

/// Points in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Order {
    /// The index of each pick; none comes twice.
    pub index: Vec<u32>,
    /// For each pick, the squared distance to the nearest pick before it; +inf for the first.
    pub distance: Vec<f32>,
}

/// How the work is divided, which changes nothing of the result.
#[derive(Clone, Copy, Debug)]
pub(super) struct Division {
    /// The most regions.
    pub(super) regions: usize,
    /// Points of a leaf of the tree, on the average.
    pub(super) leaf: usize,
    /// The least picks before regions are treated in parallel: the first ones reach everything.
    pub(super) warm: usize,
    /// The floor, in largest m.
    pub(super) floor: f32,
}

impl Division {
    pub(super) fn among(exec: &Exec) -> Self {
        Self { regions: exec.threads().min(MOST_REGIONS), leaf: 896, warm: 1000, floor: 0.95 }
    }
}
