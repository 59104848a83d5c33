//! Points in their order, and how the work to order them is divided.

use crate::frame::Exec;

/// The most regions, because more regions have more border, and one thread must treat what is near
/// a border.
const MOST_REGIONS: usize = 16;

/// Ordered points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Order {
    /// The index of each pick; none occurs twice.
    pub index: Vec<u32>,
    /// For each pick, the squared distance to the nearest pick before it; +inf for the first.
    pub distance: Vec<f32>,
}

/// How the work is divided; this does not change the result.
#[derive(Clone, Copy, Debug)]
pub(super) struct Division {
    /// The most regions.
    pub(super) regions: usize,
    /// Average number of points in a leaf of the tree.
    pub(super) leaf: usize,
    /// Regions are treated in parallel after this many picks, because the first picks reach
    /// everything.
    pub(super) warm: usize,
    /// The floor, as a fraction of the largest m.
    pub(super) floor: f32,
}

impl Division {
    pub(super) fn among(exec: &Exec) -> Self {
        Self { regions: exec.threads().min(MOST_REGIONS), leaf: 896, warm: 1000, floor: 0.95 }
    }
}
