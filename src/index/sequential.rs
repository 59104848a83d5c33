//! Sequential point trees: levels of detail of surfels as a list \[DVS03\]. \[GBP04, 7.2\] uses
//! them to choose the surfels of its second pass.
//!
//! \[DVS03\] is Dachsbacher, Vogelgsang, Stamminger: *Sequential Point Trees*, SIGGRAPH 2003. The
//! paper was not at hand: the idea is the paper's, and every number and order below is `Decided:`
//! here.
//!
//! The leaves of a tree are the surfels, and each inner node is one larger disc that stands for the
//! surfels below it. A node has an error e, a length. At a distance r, with a focal length of f
//! pixels and a threshold of tau pixels, a node is good enough if `e s <= r`, with the *scale*
//! `s = f / tau`. A view draws the first good node on each path from the root to a leaf. Errors
//! grow towards the root, so each node can be tested by itself, and a plain list can replace the
//! tree:
//!
//! ```text
//!   near s <= r < far s        near = e of the node,  far = e of its parent, +inf for the root
//! ```
//!
//! Errors and distances are in the units of the surfels. Under a similarity of scale k a distance
//! in the world is divided by k. (An orthographic camera of f pixels a unit has r = 1 everywhere.)
//!
//! # How the tree is built
//!
//! A node is a set of surfels; the root has all of them, a leaf has one.
//!
//! 1. To *halve* a set of two or more: its axis is the one with the largest extent, largest minus
//!    smallest coordinate, in f64; among equal ones the first of x, y, z. Sort the set by
//!    (coordinate along the axis, index); -0 = +0. The first floor(len/2) are the low half, the
//!    rest the high half.
//! 2. The children of a node are the halves of its low half, then the halves of its high half, low
//!    before high. A half of one surfel is not halved: it is a child.
//!
//! `Decided:` four children, as an octree has them on a surface, by halves and not by cells. The
//! tree is then ceil(log4 n) deep (at most 16) whatever the surfels are, coincident ones included.
//! n surfels have between n/3 and 2n/3 inner nodes, about.
//!
//! # The disc of an inner node
//!
//! All in f64 of the f32 that are given, rounded to f32 once. A dot product is
//! `(x x' + y y') + z z'`, and `|v|` is `sqrt(v . v)`. A surfel weighs w, its area over pi: `r r`,
//! or `|U x V|` for an ellipse. W is the sum of w. A sum over a node is the sum over its first
//! child plus the sum over the second, and so on, unrounded.
//!
//! - Centre, colour, opacity: the sum of w times the surfel's, divided by W.
//! - Normal: N = the sum of w n, divided by its length L. `Decided:` if `L < 2^-16 W`, the normals
//!   cancel: then the node takes the normal of the child with the largest W, among equal ones the
//!   first.
//! - Radius: the largest `|c' - c| + r'` of a child's centre c' and radius r', with c the centre as
//!   it was rounded. The radius of an ellipse here is its longer half axis. Whether its half axes
//!   are perpendicular or not, that is `sqrt(((a + b) + sqrt((a - b) (a - b) + (4 g) g)) / 2)`,
//!   with `a = U . U`, `b = V . V`, `g = U . V`.
//! - Half axes, if the surfels have them: [`half_axes`] of normal and radius. Leaves keep theirs.
//!
//! [`half_axes`]: crate::scene::cloud::half_axes
//!
//! # The error of a node
//!
//! The error of a leaf is 0. `Decided:` the error of an inner node is measured against the surfels
//! below it, not against its children. The children do not show how far their own surfels are from
//! their planes. Along a direction d, surfels reach from the least `m - h` to the largest `m + h`,
//! with `m = (p - c) . d` and `h = r |n x d|`, or `sqrt((U . d) (U . d) + (V . d) (V . d))` for an
//! ellipse; the extent is the difference.
//!
//! ```text
//!   e_p = the extent along the node's normal                                      (perpendicular)
//!   e_t = 2 R - the least extent along u, v, (u + v) q and (u - v) q, at least 0  (tangential)
//!   e   = sqrt(e_p e_p + e_t e_t)
//! ```
//!
//! Here R is the node's radius as it was rounded, u and v are [`half_axes`] of its normal and
//! radius 1, and q = sqrt(1/2). So `e_t` is how much the disc exceeds the tightest of four slabs,
//! and e is the largest `e_p sin a + e_t cos a` over all angles of view a. With a limit on colours,
//! see [`Sequential::with_color`], e is at least `2 R` where a component of some surfel's colour
//! differs from the node's by more. Last, e is at least the error of each child, and at least
//! 2^-149.
//!
//! `Decided:` so an inner node always has an error > 0, and a threshold of 0 pixels (s = +inf)
//! draws the surfels themselves, also where they coincide. An error beyond the range of f32 is
//! +inf.
//!
//! # How numbers are rounded
//!
//! Radii, errors and gaps (below) are rounded to f32 upwards. Radii and gaps are first multiplied
//! by `1 + 2^-48`, which covers the rounding of their own computation. So a disc encloses the
//! surfels that it stands for, and no error is made smaller. `near` of a node and `far` of its
//! children are the same f32.
//!
//! # Choose the nodes to draw: two tests
//!
//! `Decided:` with one distance for all nodes, [`Sequential::cuts`] takes exactly one node on each
//! path, the cut of the tree. Where each node has its own distance, a hole could appear: a parent
//! may be just not good enough at its centre, and its child already too fine at its own. So
//! \[DVS03\] adds the distance between the two centres, the *gap*, to `far s`, and so does
//! [`Sequential::holds`]:
//!
//! ```text
//!   near s <= r  and  (1 - 2^-20) r < far s + gap
//! ```
//!
//! Products and sums are f64, and 0 and +inf times any s are 0 and +inf. The test takes at least
//! one node on each path, and all nodes that the recursion with the same distances draws. What goes
//! wrong: near the change of a level, parent and child may both be drawn. The factor allows for
//! distances that are wrong by up to 2^-22 of themselves.
//!
//! # The order of the list
//!
//! The list is in bands of `far`, descending. A band has all values of one exponent and one pair of
//! highest bits of the mantissa, so that no value is 5/4 of another or more; +inf is a band. Within
//! a band nodes are in the order of the tree, a node before its children, and the children in the
//! order above. `Decided:` \[DVS03\] sorts by `far` itself, which puts neighbours of the surface
//! anywhere in the list. In bands of the tree's order consecutive nodes are neighbours. So boxes
//! around them are small, as \[GBP04, 7.2\] asks for with its clusters by position, and a flag
//! stands for a small piece of the surface \[GBP04, 4.3\].
//!
//! Gaps are not scaled and bands are not sorted, so no order is right for every s. Therefore
//! [`Sequential::prefix`] uses F and G: the largest `far` and the largest gap from a place to the
//! end of the list. It returns the nodes before the first place where `(1 - 2^-20) r < F s + G`
//! fails, for either test. It leaves out nothing that a test takes.

mod build;
mod node;
#[cfg(test)]
mod tests;

use crate::error::Result;
use crate::frame::Exec;
use crate::number::Real;
use crate::number::lanes::vectorized;
use crate::scene::Surfels;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// The factor on distances in [`Sequential::holds`]: 1 - 2^-20.
const SHORTER: f64 = 1.0 - 1.0 / 1_048_576.0;

/// Stands for the parent of the root, and for the surfel of an inner node.
const NONE: u32 = u32::MAX;

/// Tells when each node of a list is drawn; nodes are surfels and the discs that stand for them
/// from afar. See the [module](self).
#[derive(Clone, Debug, PartialEq)]
pub struct Sequential {
    near: Vec<f32>,
    far: Vec<f32>,
    gap: Vec<f32>,
    /// The largest `far` from here to the end of the list.
    far_from: Vec<f32>,
    /// The largest gap from here to the end of the list.
    gap_from: Vec<f32>,
    parent: Vec<u32>,
    surfel: Vec<u32>,
}

impl Sequential {
    /// Builds the list, without regard to colours. Returns the discs of all nodes in the order of
    /// the list, and when each is drawn. The median radius and the bounding sphere of the discs
    /// cover all nodes. `exec` cannot change the result.
    ///
    /// Takes O(n log n) time, about a second of one core for a million surfels. It needs up to 420
    /// bytes a surfel while it works; 70 to 160 of these stay. Groups of the surfels are dropped.
    /// Without surfels the list is empty.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if a disc around surfels leaves the range of f32, if there are
    /// more than 2^31 surfels, or if they need more memory than allowed.
    pub fn new(surfels: &Surfels, exec: &Exec) -> Result<(Surfels, Self)> {
        Self::with_color(surfels, f32::INFINITY, exec)
    }

    /// [`Sequential::new`] with a limit on colours. Some surfels of a node may differ from it by
    /// more than `most` in a component of their colours. Such a node is good enough only where its
    /// disc is smaller than the threshold.
    ///
    /// # Errors
    /// As [`Sequential::new`].
    pub fn with_color(surfels: &Surfels, most: f32, exec: &Exec) -> Result<(Surfels, Self)> {
        build::build(surfels, most, exec)
    }

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
        let errors = [&self.near, &self.far, &self.gap].map(|all| &all[nodes.clone()]);
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

/// The least f32 that is not less than a value.
fn up(value: f64) -> f32 {
    let nearest = value as f32;
    if f64::from(nearest) < value { nearest.next_up() } else { nearest }
}

/// Makes a length longer by more than its computation can have lost to rounding, and rounds it up.
fn longer(length: f64) -> f32 {
    const MORE: f64 = 1.0 + 1.0 / 281_474_976_710_656.0;
    up(length * MORE)
}

/// The larger of two numbers.
fn larger<R: Real>(a: R, b: R) -> R {
    a.at_least(b)
}
