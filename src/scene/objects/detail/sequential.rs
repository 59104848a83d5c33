//! The list of a sequential point tree: when each node is drawn. [`crate::index::sequential`] builds it.

use crate::number::MapInline;
use crate::number::lanes::vectorized;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// The factor on distances in [`Sequential::holds`]: 1 - 2^-20.
const SHORTER: f64 = 1.0 - 1.0 / 1_048_576.0;

/// Stands for the parent of the root, and for the surfel of an inner node.
pub(crate) const NONE: u32 = u32::MAX;

/// Tells when each node of a list is drawn; nodes are surfels and the discs that stand for them
/// from afar. See [`crate::index::sequential`].
#[derive(Clone, Debug, PartialEq)]
pub struct Sequential {
    pub(crate) near: Vec<f32>,
    pub(crate) far: Vec<f32>,
    pub(crate) gap: Vec<f32>,
    /// The largest `far` from here to the end of the list.
    pub(crate) far_from: Vec<f32>,
    /// The largest gap from here to the end of the list.
    pub(crate) gap_from: Vec<f32>,
    pub(crate) parent: Vec<u32>,
    pub(crate) surfel: Vec<u32>,
}

impl Sequential {
    /// The error of each node: 0 for a surfel.
    #[must_use]
    pub fn near(&self) -> &[f32] {
        &self.near
    }

    /// The error of each node's parent: +inf for the root.
    #[must_use]
    pub fn far(&self) -> &[f32] {
        &self.far
    }

    /// The distance of each node's centre from its parent's centre: 0 for the root.
    #[must_use]
    pub fn gap(&self) -> &[f32] {
        &self.gap
    }

    /// The parent of a node, as its place in the list; none for the root.
    #[must_use]
    pub fn parent(&self, node: usize) -> Option<usize> {
        Some(self.parent[node]).filter(|&parent| parent != NONE).map(|parent| parent as usize)
    }

    /// The index of the surfel that a node is; none for an inner node.
    #[must_use]
    pub fn surfel(&self, node: usize) -> Option<u32> {
        Some(self.surfel[node]).filter(|&surfel| surfel != NONE)
    }

    /// How many nodes at the beginning of the list have to be looked at: [`Sequential::holds`] and
    /// [`Sequential::cuts`] take none of the others at `least_distance` or farther.
    #[must_use]
    pub fn prefix(&self, least_distance: f64, scale: f64) -> usize {
        let at = |i: usize| reaches(self.far_from[i], self.gap_from[i], least_distance, scale);
        // Both values fall along the list, and rounding keeps their order, so bisection works.
        let (mut low, mut high) = (0, self.far.len());
        while low < high {
            let middle = low.midpoint(high);
            if at(middle) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Whether a node is drawn, given the distance of its own centre from the eye. Distances are
    /// finite and >= 0, the scale is in [0, +inf].
    #[must_use]
    pub fn holds(&self, node: usize, distance: f64, scale: f64) -> bool {
        times(self.near[node], scale) <= distance
            && reaches(self.far[node], self.gap[node], distance, scale)
    }

    /// [`Sequential::holds`] for up to 64 consecutive nodes at some points, one bit each. It uses
    /// the distances of the points from an eye, `sqrt((dx dx + dy dy) + dz dz)`. The scale is
    /// finite and > 0.
    pub(crate) fn holding(
        &self,
        nodes: Range<usize>,
        points: &[Vec3],
        eye: DVec3,
        scale: f64,
    ) -> u64 {
        let errors = [&self.near, &self.far, &self.gap].map_inline(|all| &all[nodes.clone()]);
        holding(errors, &points[nodes], eye, scale)
    }

    /// Whether a node is drawn, with one distance for all nodes; the ranges are as for
    /// [`Sequential::holds`].
    #[must_use]
    pub fn cuts(&self, node: usize, distance: f64, scale: f64) -> bool {
        times(self.near[node], scale) <= distance && distance < times(self.far[node], scale)
    }
}

vectorized!(
    /// See [`Sequential::holding`].
    fn holding([near, far, gap]: [&[f32]; 3], points: &[Vec3], eye: DVec3, scale: f64) -> u64 {
        let mut held = [0_u64; 64];
        let count = near.len().min(64);
        let (near, far, gap) = (&near[..count], &far[..count], &gap[..count]);
        for (i, p) in points[..count].iter().enumerate() {
            let d = DVec3::new(p.x.into(), p.y.into(), p.z.into()) - eye;
            let distance = ((d.x * d.x + d.y * d.y) + d.z * d.z).sqrt();
            // The scale is finite and > 0, so 0 and +inf need no case of their own.
            let good = f64::from(near[i]) * scale <= distance;
            let parent = SHORTER * distance < f64::from(far[i]) * scale + f64::from(gap[i]);
            held[i] = u64::from(good & parent);
        }
        held.iter().rev().fold(0, |word, bit| word << 1 | bit)
    }
);

/// Whether a distance is below the one from which the parent is drawn.
fn reaches(far: f32, gap: f32, distance: f64, scale: f64) -> bool {
    SHORTER * distance < times(far, scale) + f64::from(gap)
}

/// An error times a scale; 0 and +inf stay as they are, whatever the scale.
fn times(error: f32, scale: f64) -> f64 {
    let error = f64::from(error);
    if error == 0.0 || error == f64::INFINITY { error } else { error * scale }
}
