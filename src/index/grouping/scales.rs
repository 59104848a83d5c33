//! What surfels of a lower index cover at one scale of the radii after the other.
//!
//! The steps of eq. 9 get small long before they end, so that nearly the same discs are near each
//! other at dozens of scales. They are searched for once for a range of scales, and each scale asks
//! those found whether they are near by it.

use super::clipped::{area, by_lower};
use super::disc::SpaceDisc;
use super::disc_tree::DiscTree;
use super::graph::Graph;
use super::parts::Parts;
use super::samples::DiscSamples;
use crate::error::Result;
use crate::frame::Exec;
use crate::number::lanes::vectorized;
use std::ops::Range;

/// How far above a scale is searched: more asks for pairs that are not near yet, less searches
/// more often.
const AHEAD: f64 = 1.1875;

/// Surfels of a tree, all radii times a scale that grows.
pub(super) struct Scales<'a> {
    tree: &'a DiscTree,
    exec: &'a Exec,
    /// Up to which scale there are pairs, and of each place the lower ones that it can be covered by.
    found: Option<(f64, Graph)>,
    /// Whether there are too many of them.
    crowded: bool,
}

impl<'a> Scales<'a> {
    /// Of all surfels of a tree.
    pub(super) fn new(tree: &'a DiscTree, exec: &'a Exec) -> Self {
        Self { tree, exec, found: None, crowded: false }
    }

    /// [`area`] of what [`by_lower`] finds at a scale.
    ///
    /// # Errors
    /// As [`by_lower`].
    pub(super) fn area(&mut self, scale: f64) -> Result<(f64, f64)> {
        Ok(area(self.tree, &self.covered(scale)?))
    }

    /// [`by_lower`] at a scale.
    fn covered(&mut self, scale: f64) -> Result<Parts<Vec<u64>>> {
        let &mut Self { tree, exec, .. } = self;
        if !self.crowded && self.found.as_ref().is_none_or(|found| scale > found.0) {
            self.found = None;
            let most = scale * AHEAD;
            let can_cover = |i: usize, j: usize| {
                tree.surfel[j] < tree.surfel[i] && tree.discs[i].cosine(&tree.discs[j]) >= 0.0
            };
            // Too many at the end of the range need not be too many at this scale.
            let graph = Graph::new(tree, most, can_cover, exec, &|_, _, _| ()).ok();
            self.crowded = graph.is_none();
            self.found = graph.map(|graph| (most, graph));
        }
        // If those up to a larger scale are few enough, so are those near by this one.
        let Some((_, graph)) = &self.found else { return by_lower(tree, scale, exec, &|_, _| ()) };
        let job = |places| Ok(covered_by_found(tree, graph, places, scale));
        Parts::compute(tree, exec, &|_, _| (), job)
    }
}

vectorized!(
    /// [`Scales::covered`] for some places.
    fn covered_by_found(
        tree: &DiscTree,
        graph: &Graph,
        places: Range<usize>,
        scale: f64,
    ) -> Vec<u64> {
        let mut covered = Vec::with_capacity(places.len());
        for i in places {
            let own = tree.discs[i];
            let (mut mask, mut samples) = (0, None);
            for &j in graph.row(i).all {
                let other = &tree.discs[j as usize];
                if !own.is_near(other, scale) {
                    continue;
                }
                let samples = samples.get_or_insert_with(|| {
                    let disc = SpaceDisc { radius: scale * own.radius, ..own };
                    DiscSamples::new(disc, tree.surfel[i])
                });
                mask |= samples.covered_by(&SpaceDisc { radius: scale * other.radius, ..*other });
                if mask == u64::MAX {
                    break;
                }
            }
            covered.push(mask);
        }
        covered
    }
);
