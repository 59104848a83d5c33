//! Nodes of a sequential point tree \[GBP04, 7.2\].
//!
//! A geometry has the nodes of a [sequential point tree](crate::index::sequential) in the
//! place of its surfels, in the order of the list, and a threshold tau in pixels. Of an object of scale k,
//! rotation R and translation T, seen by a camera at the eye E with the focal lengths fx and fy, in f64:
//!
//! ```text
//!   e    = (transpose(R) (E - T)) / k           the eye in the coordinates of the geometry, sums (a + b) + c
//!   s    = f / tau                              f the greater of fx and fy; +inf where tau = 0
//!   r(p) = |p - e|                              of a node at p, sqrt((dx dx + dy dy) + dz dz)
//!   r    = 1 / k                                of every node, orthographic
//! ```
//!
//! A perspective camera draws the nodes that [`Sequential::holds`] at r(p) and s, an orthographic one
//! those that [`Sequential::cuts`] at r and s. Before a camera is known the surfels are drawn that
//! the geometry was made of.
//!
//! Only the first so many nodes of the list are looked at, and have [ids](crate::scene::objects::ids) in that view:
//! [`Sequential::prefix`] of s and the least distance, `|c - e| - R - (|c| + R) / 2^20`, at least 0,
//! with c and R of the sphere around the surfels that the geometry was made of, and its primitives, in its
//! own coordinates; r of an orthographic camera. Discs of inner nodes reach beyond the surfels by tau at most.

use super::sequential::Sequential;
use super::{Detail, Eye, Mask};
use crate::error::{Error, Result};
use crate::number::Real;
use crate::scene::objects::Geometry;
use crate::scene::{Projection, Similarity, Surfels, bounds};
use glam::DVec3;
use std::sync::Arc;

/// The largest threshold in pixels.
pub const MOST_PIXELS: f64 = 4096.0;

/// The tree of a geometry.
#[derive(Clone, Debug)]
pub struct Tree {
    list: Sequential,
    threshold: f64,
    leaves: Arc<Mask>,
    /// Of the surfels that the geometry was made of: how many, their median radius, and a sphere.
    pub(super) count: u32,
    pub(super) median_radius: f32,
    pub(super) sphere: (DVec3, f64),
}

impl Tree {
    /// When each node is drawn.
    #[must_use]
    pub fn list(&self) -> &Sequential {
        &self.list
    }

    /// tau: the error that a node may have on the screen, in pixels.
    #[must_use]
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// The surfels that the geometry was made of.
    pub(super) fn leaves(&self) -> Arc<Mask> {
        Arc::clone(&self.leaves)
    }

    /// How many nodes of an object in its place are looked at, and which of them are drawn.
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
        let (middle, radius) = self.sphere;
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
