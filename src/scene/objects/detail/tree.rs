//! Draw nodes of a sequential point tree as a level of detail \[GBP04, 7.2\].
//!
//! A geometry has the nodes of a [sequential point tree](crate::index::sequential) instead of its
//! surfels, in the order of the list, and a threshold tau in pixels. An object of scale k, rotation
//! R and translation T is seen by a camera at the eye E with the focal lengths fx and fy. In f64:
//!
//! ```text
//!   e    = (transpose(R) (E - T)) / k           the eye in the coordinates of the geometry, sums (a + b) + c
//!   s    = f / tau                              f the greater of fx and fy; +inf where tau = 0
//!   r(p) = |p - e|                              of a node at p, sqrt((dx dx + dy dy) + dz dz)
//!   r    = 1 / k                                of every node, orthographic
//! ```
//!
//! A perspective camera draws the nodes that [`Sequential::holds`] at r(p) and s, an orthographic
//! one the nodes that [`Sequential::cuts`] at r and s. Before a camera is known, the surfels that
//! the geometry was made of are drawn.
//!
//! A view looks only at a beginning of the list, and only these nodes have
//! [ids](crate::scene::objects::ids) in that view. The beginning is [`Sequential::prefix`] of s and
//! the least distance, `|c - e| - R - (|c| + R) / 2^20`, at least 0; for an orthographic camera the
//! distance is r. c and R belong to the sphere around the surfels that the geometry was made of,
//! and its primitives, in the geometry's own coordinates. Discs of inner nodes reach beyond the
//! surfels by tau at most.

use super::sequential::Sequential;
use super::{Detail, Eye, Mask};
use crate::error::{Error, Result};
use crate::number::Real;
use crate::scene::objects::Geometry;
use crate::scene::{Projection, Similarity, Sphere, Surfels, bounds};
use std::sync::Arc;

/// The largest threshold in pixels.
pub const MOST_PIXELS: f64 = 4096.0;

/// The tree of a geometry.
#[derive(Clone, Debug)]
pub struct Tree {
    list: Sequential,
    threshold: f64,
    leaves: Arc<Mask>,
    /// For the surfels that the geometry was made of: their number, their median radius, and a
    /// sphere.
    pub(super) count: u32,
    pub(super) median_radius: f32,
    pub(super) sphere: Sphere,
}

impl Tree {
    /// The list, which tells when each node is drawn.
    #[must_use]
    pub fn list(&self) -> &Sequential {
        &self.list
    }

    /// tau: the error that a node may have on the screen, in pixels.
    #[must_use]
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// A mask of the surfels that the geometry was made of.
    pub(super) fn leaves(&self) -> Arc<Mask> {
        Arc::clone(&self.leaves)
    }

    /// How many nodes of an object in its place the view looks at, and which of them it draws.
    pub(super) fn drawn(&self, geometry: &Geometry, place: &Similarity, eye: &Eye) -> (u32, Mask) {
        let scale = eye.focal() / self.threshold;
        if eye.camera.projection == Projection::Orthographic {
            let distance = 1.0 / place.scale;
            let count = self.list.prefix(distance, scale);
            return (
                count as u32,
                Mask::from_fn(count, |node| self.list.cuts(node, distance, scale)),
            );
        }
        let eye = eye.before(place);
        let Sphere { center: middle, radius } = self.sphere;
        let lost = (middle.length() + radius) / 1_048_576.0;
        let least = ((middle - eye).length() - radius - lost).at_least(0.0);
        let count = self.list.prefix(least, scale);
        if scale == f64::INFINITY {
            return (count as u32, (*self.leaves).clone());
        }
        let points = geometry.surfels.position();
        let word = |first| self.list.holding(first..count.min(first + 64), points, eye, scale);
        (count as u32, Mask { words: (0..count).step_by(64).map(word).collect() })
    }
}

impl Geometry {
    /// Whether the geometry may get a tree with a threshold in pixels.
    pub(crate) fn check_tree(&self, threshold: f64) -> Result<()> {
        if !(0.0..=MOST_PIXELS).contains(&threshold) {
            let what = format!("levels of detail of {threshold} pixels; give 0 to {MOST_PIXELS}");
            return Err(Error::Invalid(what));
        }
        self.check_plain()
    }

    /// The geometry with nodes in the place of its surfels, and the list that says when each is drawn.
    pub(crate) fn with_tree(self, threshold: f64, nodes: Surfels, list: Sequential) -> Self {
        let tree = Tree {
            leaves: Arc::new(Mask::from_fn(nodes.len(), |node| list.surfel(node).is_some())),
            list,
            threshold,
            count: self.surfels.len() as u32,
            median_radius: self.surfels.median_radius(),
            sphere: bounds::sphere(&self.surfels, &self.primitives),
        };
        Self { surfels: nodes, detail: Some(Detail::Tree(tree)), ..self }
    }
}
