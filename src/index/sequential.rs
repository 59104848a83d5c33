//! Sequential point trees: levels of detail of surfels as a list \[DVS03\], which \[GBP04, 7.2\]
//! uses to choose the surfels of its second pass.
//!
//! \[DVS03\] is Dachsbacher, Vogelgsang, Stamminger: *Sequential Point Trees*, SIGGRAPH 2003. It
//! was not at hand: the idea is the paper's, every number and order below is `Decided:` here.
//!
//! The leaves of a tree are the surfels, and each inner node is one larger disc that stands for
//! those below it. A node has an error e, a length. At a distance r, a focal length of f pixels and
//! a threshold of tau pixels it is good enough if `e s <= r`, with the *scale* `s = f / tau`. A
//! view draws the first good node on each path from the root to a leaf. As errors grow towards the
//! root, that is a test of each node by itself, so that a plain list takes the place of the tree:
//!
//! ```text
//!   near s <= r < far s        near = e of the node,  far = e of its parent, +inf for the root
//! ```
//!
//! Errors and distances are in the units of the surfels. Under a similarity of scale k a distance
//! in the world is divided by k. (An orthographic camera of f pixels a unit has r = 1 everywhere.)
//!
//! # The tree
//!
//! A node is a set of surfels; the root has all of them, a leaf has one.
//!
//! 1. To *halve* a set of two or more: its axis is the one with the largest extent, largest minus
//!    smallest coordinate, in f64; of equal ones the first of x, y, z. Sort the set by (coordinate
//!    along the axis, index); -0 = +0. The first floor(len/2) are the low half, the rest the high
//!    half.
//! 2. The children of a node are the halves of its low half, then those of its high half, low
//!    before high. A half of one surfel is not halved: it is a child.
//!
//! `Decided:` four children, as an octree has them on a surface, by halves and not by cells: the
//! tree is ceil(log4 n) deep (at most 16) whatever the surfels are, coincident ones included. n
//! surfels have between n/3 and 2n/3 inner nodes, about.
//!
//! # The disc of an inner node
//!
//! All in f64 of the f32 that are given, rounded to f32 once. A dot product is
//! `(x x' + y y') + z z'`, and `|v|` is `sqrt(v . v)`. A surfel weighs w, its area over pi: `r r`,
//! or `|U x V|` of an ellipse. W is the sum of w, and a sum over a node is the sum over its first
//! child plus that over the second, and so on, unrounded.
//!
//! - Centre, colour, opacity: the sum of w times the surfel's, divided by W.
//! - Normal: N = the sum of w n, divided by its length L. `Decided:` if `L < 2^-16 W`, normals
//!   cancel: then it is the normal of the child with the largest W, of equal ones the first.
//! - Radius: the largest `|c' - c| + r'` of a child's centre c' and radius r', with c the centre as
//!   it was rounded. The radius of an ellipse here is its longer half axis, which is, whether its
//!   half axes are perpendicular or not, `sqrt(((a + b) + sqrt((a - b) (a - b) + (4 g) g)) / 2)`,
//!   `a = U . U`, `b = V . V`, `g = U . V`.
//! - Half axes, if the surfels have them: [`half_axes`] of normal and radius. Leaves keep theirs.
//!
//! [`half_axes`]: crate::scene::cloud::half_axes
//!
//! # Errors
//!
//! The error of a leaf is 0. `Decided:` that of an inner node is measured against the surfels below
//! it, not against its children, as these leave out what their own surfels leave their plane by.
//! Along a direction d, surfels reach from the least `m - h` to the largest `m + h`, with
//! `m = (p - c) . d` and `h = r |n x d|`, or `sqrt((U . d) (U . d) + (V . d) (V . d))` of an
//! ellipse; the extent is the difference.
//!
//! ```text
//!   e_p = the extent along the node's normal                                      (perpendicular)
//!   e_t = 2 R - the least extent along u, v, (u + v) q and (u - v) q, at least 0  (tangential)
//!   e   = sqrt(e_p e_p + e_t e_t)
//! ```
//!
//! Here R is the node's radius as it was rounded, u and v are [`half_axes`] of its normal and
//! radius 1, and q = sqrt(1/2). So `e_t` is what the disc has too much beside the tightest of four
//! slabs, and e is the largest `e_p sin a + e_t cos a` over all angles of view a. With a limit on
//! colours, see [`Sequential::with_color`], e is at least `2 R` where a component of some surfel's
//! colour differs from the node's by more. Last, e is at least that of each child, and at least
//! 2^-149.
//!
//! `Decided:` so an inner node is never without error, and a threshold of 0 pixels (s = +inf) draws
//! the surfels themselves, also where they coincide. An error beyond the range of f32 is +inf.
//!
//! # Rounding
//!
//! Radii, errors and gaps (below) are rounded to f32 upwards: radii and gaps are first multiplied
//! by `1 + 2^-48`, which covers the rounding of their own computation. So a disc encloses what it
//! stands for, and no error is made smaller. `near` of a node and `far` of its children are the
//! same f32.
//!
//! # Two tests
//!
//! `Decided:` with one distance for all nodes, [`Sequential::cuts`] takes exactly one on each path,
//! the cut of the tree. Where each node has its own distance, a parent may be just not good enough
//! at its centre, and its child already too fine at its own, which would leave a hole. So \[DVS03\]
//! adds the distance between the two centres, the *gap*, to `far s`, and so does
//! [`Sequential::holds`]:
//!
//! ```text
//!   near s <= r  and  (1 - 2^-20) r < far s + gap
//! ```
//!
//! Products and sums are f64, and 0 and +inf times any s are 0 and +inf. The test takes at least
//! one on each path, and all that the recursion with the same distances draws. What goes wrong:
//! near the change of a level, parent and child may both be drawn. The factor allows for distances
//! that are wrong by up to 2^-22 of themselves.
//!
//! # The list
//!
//! In bands of `far`, descending: a band has all values of one exponent and one pair of highest bits of
//! the mantissa, so that none is 5/4 of another or more; +inf is a band. Within a band in the order of
//! the tree, a node before its children, and these as above. `Decided:` \[DVS03\] sorts by `far` itself,
//! which puts neighbours of the surface anywhere in the list. In bands of the tree's order consecutive
//! nodes are neighbours, so that boxes around them are small, as \[GBP04, 7.2\] asks for with its
//! clusters by position, and a flag stands for a small piece of the surface \[GBP04, 4.3\].
//!
//! As gaps are not scaled and bands are not sorted, no order is right for every s:
//! [`Sequential::prefix`] takes the largest `far` and the largest gap from a place to the end of the list
//! for those of the place, F and G: it has the nodes before the first place where
//! `(1 - 2^-20) r < F s + G` fails, whichever test is asked. It leaves out nothing that a test takes.

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

/// What a distance is multiplied by in [`Sequential::holds`]: 1 - 2^-20.
const SHORTER: f64 = 1.0 - 1.0 / 1_048_576.0;

/// The parent of the root, and the surfel of an inner node.
const NONE: u32 = u32::MAX;

/// When each of a list of nodes is drawn, surfels and the discs that stand for them from afar; see the
/// [module](self).
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
    /// Builds the list, without regard to colours: the discs of all nodes in its order, whose median radius
    /// and bounding sphere are those of all nodes, and when each is drawn. `exec` cannot change it.
    ///
    /// Takes O(n log n) time, about a second of one core for a million surfels, and up to 420 bytes
    /// a surfel while it works, of which 70 to 160 stay. Groups of the surfels are dropped. Of no
    /// surfels it is the empty list.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if a disc around surfels leaves the range of f32, if there are
    /// more than 2^31 surfels, or if they need more memory than there may be.
    pub fn new(surfels: &Surfels, exec: &Exec) -> Result<(Surfels, Self)> {
        Self::with_color(surfels, f32::INFINITY, exec)
    }

    /// [`Sequential::new`]; but a node some of whose surfels differ from it by more than `most` in
    /// a component of their colours is good enough only where its disc is smaller than the
    /// threshold.
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

    /// How far each node's centre is from that of its parent: 0 for the root.
    #[must_use]
    pub fn gap(&self) -> &[f32] {
        &self.gap
    }

    /// The parent of a node, by its place in the list; none for the root.
    #[must_use]
    pub fn parent(&self, node: usize) -> Option<usize> {
        Some(self.parent[node]).filter(|&parent| parent != NONE).map(|parent| parent as usize)
    }

    /// The surfel that a node is, by its index; none if it is an inner node.
    #[must_use]
    pub fn surfel(&self, node: usize) -> Option<u32> {
        Some(self.surfel[node]).filter(|&surfel| surfel != NONE)
    }

    /// How many nodes of the list are to be looked at: [`Sequential::holds`] and
    /// [`Sequential::cuts`] take none of the others at `least_distance` or farther.
    #[must_use]
    pub fn prefix(&self, least_distance: f64, scale: f64) -> usize {
        let at = |i: usize| reaches(self.far_from[i], self.gap_from[i], least_distance, scale);
        // Both fall along the list, and rounding keeps their order.
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

    /// Whether a node is drawn, with the distance of its own centre from the eye. Distances are
    /// finite and >= 0, the scale is in [0, +inf].
    #[must_use]
    pub fn holds(&self, node: usize, distance: f64, scale: f64) -> bool {
        times(self.near[node], scale) <= distance
            && reaches(self.far[node], self.gap[node], distance, scale)
    }

    /// [`Sequential::holds`] of up to 64 consecutive nodes at some points, a bit each: with the distances of
    /// these from an eye, `sqrt((dx dx + dy dy) + dz dz)`. The scale is finite and > 0.
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

    /// Whether a node is drawn, with one distance for all nodes; ranges as for
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
            // Neither 0 nor +inf times a scale that is finite and > 0 needs a case of its own.
            let good = f64::from(near[i]) * scale <= distance;
            let parent = SHORTER * distance < f64::from(far[i]) * scale + f64::from(gap[i]);
            held[i] = u64::from(good & parent);
        }
        held.iter().rev().fold(0, |word, bit| word << 1 | bit)
    }
);

/// Whether a distance is below that from which on the parent is drawn.
fn reaches(far: f32, gap: f32, distance: f64, scale: f64) -> bool {
    SHORTER * distance < times(far, scale) + f64::from(gap)
}

/// An error times a scale; 0 and +inf whatever the scale.
fn times(error: f32, scale: f64) -> f64 {
    let error = f64::from(error);
    if error == 0.0 || error == f64::INFINITY { error } else { error * scale }
}

/// The least f32 that is not less.
fn up(value: f64) -> f32 {
    let nearest = value as f32;
    if f64::from(nearest) < value { nearest.next_up() } else { nearest }
}

/// A length, made longer by more than the rounding of its computation took away, and rounded up.
fn longer(length: f64) -> f32 {
    const MORE: f64 = 1.0 + 1.0 / 281_474_976_710_656.0;
    up(length * MORE)
}

/// The larger of two numbers.
fn larger<R: Real>(a: R, b: R) -> R {
    a.at_least(b)
}
