//! Surfels from back to front: a BSP tree that is built once and walked for every view.
//!
//! \[ZP06, section 5.2.1\] takes it from \[Sam89\] (Samet: *The Design and Analysis of Spatial Data
//! Structures*, 1989). The tree splits the **centres** of the surfels; their radii and normals do
//! not matter.
//!
//! **The tree**, a function of the positions and their indices:
//!
//! 1. A node is a set of surfels; the root has all of them. A node of one surfel is not split.
//! 2. Its axis is the one with the largest extent: largest minus smallest coordinate, in f64. Ties:
//!    the first of x, y, z.
//! 3. Sort its surfels by (coordinate along the axis, surfel index). Coordinates compare as
//!    numbers: -0 = +0. The surfel of rank floor(len/2), counted from 0, is the node's own; those
//!    before it are the low half, those after it the high half, which may be empty. Its coordinate
//!    is the plane.
//!
//! So surfels that lie in the plane may be in either half, and coincident ones cost nothing extra:
//! the tree of n surfels is floor(log2 n) deep whatever they are.
//!
//! **The walk**, at each node: the far half, the node's own surfel, the near half. The high half is
//! the near one if `e > plane` in f64, else the low half is, with e the eye along the node's axis:
//!
//! - perspective: the coordinate of [`Camera::eye`]. `Decided:` if the eye lies in the plane, the
//!   low half is the near one: no ray passes from one half into the other.
//! - orthographic: +inf if the component along the axis of the direction towards the eye, which is
//!   the third row of the view matrix, is > 0, else -inf. `Decided:` a component of 0 counts as
//!   negative, for the same reason.
//!
//! **The law**: of two surfels of a node whose centres lie strictly on different sides of its
//! plane, the one on the side away from the eye comes first. No ray from the eye meets the near
//! side after the far one, so that one order is right for all pixels, and exactly so for surfels
//! that reach across no plane.
//!
//! `Decided:` where centres coincide along the axis, the index decides which is low, and so it is
//! the eye that decides which comes first. If all surfels are at one place every axis is x: they
//! come in ascending order of index if `e > plane`, and in descending order if not.
//!
//! `Decided:` surfels that reach across a plane are not cut, as a BSP tree of polygons would cut
//! them: each is ordered as a whole, by its centre. What goes wrong: of two surfels that overlap on
//! the screen and both reach across the plane between their centres, one is drawn before the other
//! at every pixel, although it may be the nearer one at some. Each is then closer to the plane than
//! its own radius. It is seen when the eye passes the plane, and the pair swaps at once over the
//! whole overlap. Within one sheet the two have nearly the same depth, and nearly the same colour;
//! where two sheets cut each other, a fringe as wide as a radius flickers along the cut.

use super::point_tree::PointTree;
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::scene::{Camera, Projection, Surfels};
use std::ops::Range;

/// The surfels of a scene, ready to be ordered for any view; see the module.
#[derive(Debug)]
pub struct BackToFront {
    tree: PointTree,
}

impl BackToFront {
    /// Builds the tree. `exec` cannot change it.
    #[must_use]
    pub fn new(surfels: &Surfels, exec: &Exec) -> Self {
        Self { tree: PointTree::new(surfels.position(), 1, exec) }
    }

    /// Whether this can be the order of these surfels: there must be as many.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are not.
    pub fn check(&self, surfels: &Surfels) -> Result<()> {
        let (ordered, there) = (self.tree.entries().len(), surfels.len());
        if ordered == there {
            Ok(())
        } else {
            Err(Error::Invalid(format!("an order of {ordered} surfels for a scene of {there}")))
        }
    }

    /// The indices of all surfels, each once, the farthest first.
    #[must_use]
    pub fn walk(&self, camera: &Camera) -> Vec<u32> {
        let eye = match camera.projection {
            Projection::Perspective => camera.eye().to_array(),
            Projection::Orthographic => {
                let towards = camera.view_from_world.row(2).truncate().to_array();
                towards.map(|c| if c > 0.0 { f64::INFINITY } else { f64::NEG_INFINITY })
            }
        };
        let mut order = Vec::with_capacity(self.tree.entries().len());
        self.visit(0..self.tree.entries().len(), eye, &mut order);
        order
    }

    /// Appends the surfels of a range.
    fn visit(&self, range: Range<usize>, eye: [f64; 3], order: &mut Vec<u32>) {
        let entries = self.tree.entries();
        if range.len() <= 1 {
            order.extend(entries[range].iter().map(|entry| entry.id));
            return;
        }
        let (middle, axis) = self.tree.node(&range);
        let own = entries[middle];
        let (low, high) = (range.start..middle, middle + 1..range.end);
        let high_is_near = eye[axis] > f64::from(own.point[axis]);
        let (far, near) = if high_is_near { (low, high) } else { (high, low) };
        self.visit(far, eye, order);
        order.push(own.id);
        self.visit(near, eye, order);
    }
}

#[cfg(test)]
mod tests;
