//! Clipped(p, r, k): how much of a disc others cover \[ZP06, section 4.2.2\].

use super::budget::Budget;
use super::disc::SpaceDisc;
use super::disc_tree::{DiscTree, NearBlocks};
use super::parts::Parts;
use super::samples::{DiscSamples, SAMPLES};
use crate::error::Result;
use crate::frame::Exec;
use crate::number::lanes::vectorized;
use std::ops::Range;

/// For each place, the samples that surfels of a lower index cover, with all radii times `scale`.
pub(super) fn by_lower(
    tree: &DiscTree,
    scale: f64,
    exec: &Exec,
    progress: &dyn Fn(u64, u64),
) -> Result<Parts<Vec<u64>>> {
    let budget = Budget::new(tree.surfel.len(), scale);
    Parts::compute(tree, exec, progress, |places| covered_by_lower(tree, places, scale, &budget))
}

vectorized!(
    /// [`by_lower`] for some places.
    fn covered_by_lower(
        tree: &DiscTree,
        places: Range<usize>,
        scale: f64,
        budget: &Budget,
    ) -> Result<Vec<u64>> {
        let disc = |place: usize| {
            let disc = tree.discs[place];
            SpaceDisc { radius: scale * disc.radius, ..disc }
        };
        let mut covered = Vec::with_capacity(places.len());
        let (mut room, mut seen) = (NearBlocks::default(), 0);
        for i in places {
            let (mut mask, samples) = (0, DiscSamples::new(disc(i), tree.surfel[i]));
            tree.near(i, scale, &mut room, |near, so_many| {
                near[..so_many].iter().all(|&j| {
                    seen += 1;
                    if tree.surfel[j as usize] < tree.surfel[i] {
                        mask |= samples.covered_by(&disc(j as usize));
                    }
                    mask != u64::MAX
                })
            });
            covered.push(mask);
            budget.spend_many(&mut seen)?;
        }
        budget.spend(seen)?;
        Ok(covered)
    }
);

/// The covered area of eq. 7 with all radii times `scale`, divided by pi scale^2, and the sum of
/// the squared radii: sums in ascending index.
pub(super) fn area(tree: &DiscTree, covered: &Parts<Vec<u64>>) -> (f64, f64) {
    let [area] = areas(tree, |place| [covered.at(place).count_zeros() as u8]);
    (area, tree.square.iter().fold(0.0, |sum, square| sum + square))
}

/// The area of each of several sets, divided by pi, summed in ascending index. `open` tells how
/// many samples of a place each set leaves uncovered.
pub(super) fn areas<const SETS: usize>(
    tree: &DiscTree,
    open: impl Fn(usize) -> [u8; SETS],
) -> [f64; SETS] {
    let mut areas = [0.0; SETS];
    for (open, square) in by_rank(tree, [0; SETS], open).into_iter().zip(&tree.square) {
        for (area, open) in areas.iter_mut().zip(open) {
            *area += open_area(*square, open);
        }
    }
    areas
}

/// [`areas`] for each of `count` groups; each rank is in one group.
pub(super) fn areas_of_groups(
    tree: &DiscTree,
    count: usize,
    group: impl Fn(usize) -> usize,
    open: impl Fn(usize) -> u8,
) -> Vec<f64> {
    let mut areas = vec![0.0; count];
    for (rank, (open, square)) in by_rank(tree, 0, open).into_iter().zip(&tree.square).enumerate() {
        areas[group(rank)] += open_area(*square, open);
    }
    areas
}

/// The uncovered area of a disc, divided by pi.
fn open_area(square: f64, open: u8) -> f64 {
    square * (f64::from(open) / SAMPLES as f64)
}

/// Reorders a value of each place by rank.
fn by_rank<T: Copy>(tree: &DiscTree, none: T, of: impl Fn(usize) -> T) -> Vec<T> {
    let mut all = vec![none; tree.rank.len()];
    for (place, &rank) in tree.rank.iter().enumerate() {
        all[rank as usize] = of(place);
    }
    all
}
