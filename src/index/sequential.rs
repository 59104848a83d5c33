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
//! a band nodes are in the order of the tree, in preorder: a node, then all of its first child's
//! subtree, then all of the second's, and so on, with the children in the order above. `Decided:` \[DVS03\] sorts by `far` itself, which puts neighbours of the surface
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
use crate::scene::{Geometry, Surfels};

pub use crate::scene::objects::detail::sequential::Sequential;

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
}

impl Geometry {
    /// Replaces the surfels of the geometry by the nodes of a tree. `threshold` is tau of
    /// [`crate::scene::objects::detail::tree`], in [0, 4096]. Prefiltered colours are left out,
    /// because the colours of inner nodes are averages already.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the threshold is out of range, if there are no surfels, or levels
    /// of detail already, and as [`Sequential::new`].
    pub fn with_detail(self, threshold: f64, exec: &Exec) -> Result<Self> {
        self.check_tree(threshold)?;
        let (nodes, list) = Sequential::new(&self.surfels, exec)?;
        Ok(self.with_tree(threshold, nodes, list))
    }
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
