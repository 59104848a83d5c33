//! Find what surfels of a lower index cover, at one scale of the radii after the other.
//!
//! The steps of eq. 9 get small long before they end, so at dozens of scales nearly the same discs
//! are near each other. The neighbours are searched for once for a range of scales, and each scale
//! tests which of the found neighbours are near by it.

use super::clipped::{DiscSamples, area, by_lower};
use super::disc::SpaceDisc;
use super::disc_tree::DiscTree;
use super::graph::Graph;
use super::parts::Parts;
use crate::error::Result;
use crate::frame::Exec;
use crate::number::lanes::vectorized;
use std::ops::Range;

/// How far above a scale the search goes. A larger factor tests pairs that are not near yet; a
/// smaller one searches more often.
const AHEAD: f64 = 1.1875;

/// Surfels of a tree, with all radii times a growing scale.
pub(super) struct Scales<'a> {
    tree: &'a DiscTree,
    exec: &'a Exec,
    /// The largest scale that was searched, and for each place the lower surfels that may cover it.
    found: Option<(f64, Graph)>,
    /// Whether there are too many such pairs.
    crowded: bool,
}

impl<'a> Scales<'a> {
    /// Starts with all surfels of a tree.
    pub(super) fn new(tree: &'a DiscTree, exec: &'a Exec) -> Self {
        Self { tree, exec, found: None, crowded: false }
    }

    /// The [`area`] of the result of [`by_lower`] at a scale.
    ///
    /// # Errors
    /// As [`by_lower`].
    pub(super) fn area(&mut self, scale: f64) -> Result<(f64, f64)> {
        Ok(area(self.tree, &self.covered(scale)?))
    }

    /// The result of [`by_lower`] at a scale.
    fn covered(&mut self, scale: f64) -> Result<Parts<Vec<u64>>> {
        let &mut Self { tree, exec, .. } = self;
        if !self.crowded && self.found.as_ref().is_none_or(|found| scale > found.0) {
            self.found = None;
            let most = scale * AHEAD;
            let can_cover = |i: usize, j: usize| {
                tree.surfel[j] < tree.surfel[i] && tree.discs[i].cosine(&tree.discs[j]) >= 0.0
            };
            // Too many pairs at the end of the range need not be too many at this scale.
            let graph = Graph::new(tree, most, can_cover, exec, &|_, _, _| ()).ok();
            self.crowded = graph.is_none();
            self.found = graph.map(|graph| (most, graph));
        }
        // If the pairs up to a larger scale are few enough, the pairs at this scale are too.
        let Some((_, graph)) = &self.found else { return by_lower(tree, scale, exec, &|_, _| ()) };
        let job = |places| Ok(covered_by_found(tree, graph, places, scale));
        Parts::of(tree, exec, &|_, _| (), job)
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
            for &j in graph.of(i).all {
                let other = &tree.discs[j as usize];
                // The list goes up to a larger scale than this one.
                if !own.is_near(other, scale) {
                    continue;
                }
                let samples = samples.get_or_insert_with(|| {
                    let disc = SpaceDisc { radius: scale * own.radius, ..own };
                    DiscSamples::of(disc, tree.surfel[i])
                });
                mask |= samples.covered_by(&SpaceDisc { radius: scale * other.radius, ..*other });
                // All samples are covered: no other disc can change that.
                if mask == u64::MAX {
                    break;
                }
            }
            covered.push(mask);
        }
        covered
    }
);
