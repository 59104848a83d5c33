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
use crate::scene::{Geometry, Surfels};

pub use crate::scene::objects::detail::sequential::Sequential;

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
}

impl Geometry {
    /// The geometry with the nodes of a tree, which are its surfels from here on. `threshold` is tau of
    /// [`crate::scene::objects::detail::tree`], in [0, 4096]. Prefiltered colours are left out: those of inner nodes are averages.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the threshold is out of range, if there are no surfels, or levels of detail
    /// already, and as [`Sequential::new`].
    pub fn with_detail(self, threshold: f64, exec: &Exec) -> Result<Self> {
        self.check_tree(threshold)?;
        let (nodes, list) = Sequential::new(&self.surfels, exec)?;
        Ok(self.with_tree(threshold, nodes, list))
    }
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
