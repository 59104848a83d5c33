//! Draw surfels from back to front: a BSP tree that is built once and walked for every view.
//!
//! \[ZP06, section 5.2.1\] takes it from \[Sam89\] (Samet: *The Design and Analysis of Spatial Data
//! Structures*, 1989). The tree splits the **centres** of the surfels; their radii and normals do
//! not matter.
//!
//! **The tree** is a function of the positions and their indices:
//!
//! 1. A node is a set of surfels; the root has all of them. A node of one surfel is not split.
//! 2. Its axis is the one with the largest extent: largest minus smallest coordinate, in f64. Ties:
//!    the first of x, y, z.
//! 3. Sort its surfels by (coordinate along the axis, surfel index). Coordinates compare as
//!    numbers: -0 = +0. The surfel of rank floor(len/2), counted from 0, is the node's own surfel.
//!    The surfels before it are the low half; the surfels after it are the high half, which may be
//!    empty. The coordinate of the node's own surfel is the plane.
//!
//! So surfels that lie in the plane may be in either half, and coincident surfels cost nothing
//! extra: the tree of n surfels is floor(log2 n) deep whatever they are.
//!
//! **The walk**, at each node: the far half, the node's own surfel, the near half. The high half is
//! the near one if `e > plane` in f64, else the low half is. e is the eye along the node's axis:
//!
//! - perspective: the coordinate of [`Camera::eye`]. `Decided:` if the eye lies in the plane, the
//!   low half is the near one, because no ray passes from one half into the other.
//! - orthographic: +inf or -inf, by the direction towards the eye, which is the third row of the
//!   view matrix. +inf if its component along the axis is > 0, else -inf. `Decided:` a component of
//!   0 counts as negative, for the same reason.
//!
//! **The law**: take two surfels of a node whose centres lie strictly on different sides of its
//! plane. The one on the side away from the eye comes first. No ray from the eye meets the near
//! side after the far one. So one order is right for all pixels, and exactly so for surfels that
//! reach across no plane.
//!
//! `Decided:` where centres coincide along the axis, the index decides which half is low, and so
//! the eye decides which surfel comes first. If all surfels are at one place, every axis is x: they
//! come in ascending order of index if `e > plane`, and in descending order if not.
//!
//! `Decided:` surfels that reach across a plane are not cut, as a BSP tree of polygons would cut
//! them. Each is ordered as a whole, by its centre. What goes wrong: take two surfels that overlap
//! on the screen and both reach across the plane between their centres. One is drawn before the
//! other at every pixel, although it may be the nearer one at some. Each of them is then closer to
//! the plane than its own radius. You see the error when the eye passes the plane, because the pair
//! swaps at once over the whole overlap. Within one sheet the two have nearly the same depth, and
//! nearly the same colour. Where two sheets cut each other, a fringe as wide as a radius flickers
//! along the cut.

use super::point_tree::PointTree;
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::number::MapInline;
use crate::scene::{Camera, Projection, Surfels};
use std::ops::Range;

/// The surfels of a scene, ready to be ordered for any view; see the module.
#[derive(Debug)]
pub struct BackToFront {
    tree: PointTree,
}

impl BackToFront {
    /// Builds the tree. `exec` cannot change the result.
    #[must_use]
    pub fn new(surfels: &Surfels, exec: &Exec) -> Self {
        Self { tree: PointTree::new(surfels.position(), 1, exec) }
    }

    /// Checks that this can be the order of these surfels: there must be as many.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are not.
    pub fn check(&self, surfels: &Surfels) -> Result<()> {
        let (ordered, there) = (self.tree.entries().len(), surfels.len());
        if ordered == there {
            Ok(())
        } else {
            Err(Error::Invalid(format!(
                "the order has {ordered} surfels, but the scene has {there}"
            )))
        }
    }

    /// The indices of all surfels, each once, the farthest first.
    #[must_use]
    pub fn walk(&self, camera: &Camera) -> Vec<u32> {
        let (entries, eye) = (self.tree.entries(), eye(camera));
        let mut order = Vec::with_capacity(entries.len());
        self.visit(0..entries.len(), eye, &mut |place| order.push(entries[place].id));
        order
    }

    /// The order of a view in consecutive parts, each a subtree of at most `most` surfels or a
    /// single surfel, so that threads can walk the parts separately.
    pub(crate) fn parts(&self, camera: &Camera, most: usize) -> Vec<Part> {
        let mut parts = Vec::new();
        self.divide(0..self.tree.entries().len(), eye(camera), most.max(1), &mut parts);
        parts
    }

    /// Calls `visit` for the place in the tree of each surfel of a part, the farthest first.
    pub(crate) fn walk_part(&self, part: &Part, mut visit: impl FnMut(usize)) {
        self.visit(part.places.clone(), part.eye, &mut visit);
    }

    /// The index of the surfel at a place in the tree.
    pub(crate) fn index(&self, place: usize) -> u32 {
        self.tree.entries()[place].id
    }

    /// The indices of the surfels in the order of the tree.
    pub(crate) fn indices(&self) -> impl ExactSizeIterator<Item = u32> {
        self.tree.entries().iter().map(|entry| entry.id)
    }

    /// Appends the parts of a range.
    fn divide(&self, range: Range<usize>, eye: [f64; 3], most: usize, parts: &mut Vec<Part>) {
        if range.len() <= most {
            parts.extend((!range.is_empty()).then_some(Part { places: range, eye }));
            return;
        }
        let (far, own, near) = self.halves(&range, eye);
        self.divide(far, eye, most, parts);
        parts.push(Part { places: own..own + 1, eye });
        self.divide(near, eye, most, parts);
    }

    /// Calls `visit` for the places of a range.
    fn visit(&self, range: Range<usize>, eye: [f64; 3], visit: &mut impl FnMut(usize)) {
        if range.len() <= 1 {
            range.for_each(visit);
            return;
        }
        let (far, own, near) = self.halves(&range, eye);
        self.visit(far, eye, visit);
        visit(own);
        self.visit(near, eye, visit);
    }

    /// The far half of a node, its own surfel, and the near half.
    fn halves(&self, range: &Range<usize>, eye: [f64; 3]) -> (Range<usize>, usize, Range<usize>) {
        let (middle, axis) = self.tree.node(range);
        let (low, high) = (range.start..middle, middle + 1..range.end);
        let high_is_near = eye[axis] > f64::from(self.tree.entries()[middle].point[axis]);
        if high_is_near { (low, middle, high) } else { (high, middle, low) }
    }
}

/// Consecutive surfels of the order of a view, see [`BackToFront::parts`].
#[derive(Clone, Debug)]
pub(crate) struct Part {
    /// Their places in the tree.
    places: Range<usize>,
    /// The eye coordinates that decide the order.
    eye: [f64; 3],
}

impl Part {
    /// How many surfels there are.
    pub(crate) fn len(&self) -> usize {
        self.places.len()
    }
}

/// The coordinates that planes are compared with.
fn eye(camera: &Camera) -> [f64; 3] {
    match camera.projection {
        Projection::Perspective => camera.eye().to_array(),
        Projection::Orthographic => {
            let towards = camera.view_from_world.row(2).truncate().to_array();
            towards.map_inline(|c| if c > 0.0 { f64::INFINITY } else { f64::NEG_INFINITY })
        }
    }
}

#[cfg(test)]
mod tests;
