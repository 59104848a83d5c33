//! The graph of section 4.1: which surfels may not share a group.

use super::budget::Budget;
use super::disc::dot;
use super::disc_tree::{DISCS, DiscTree, NearBlocks};
use super::rules::{Coplanar, Rules};
use crate::error::Result;
use crate::frame::Exec;
use crate::number::lanes::vectorized;
use crate::scene::Surfels;
use std::ops::Range;

/// The neighbours of every place of a tree, as one array.
#[derive(Debug)]
pub(super) struct Graph {
    /// Where the neighbours of each place start, and last how many there are in all.
    start: Vec<usize>,
    neighbour: Vec<u32>,
}

/// The rows of some places: how many neighbours each has, and all of them.
type Rows = (Vec<u32>, Vec<u32>);

vectorized!(
    /// The rows of some blocks.
    fn near_rows<K: Fn(usize, usize) -> bool>(
        tree: &DiscTree,
        blocks: Range<usize>,
        factor: f64,
        keep: &K,
        budget: &Budget,
    ) -> Result<Rows> {
        let (mut degree, mut neighbour) = (Vec::new(), Vec::new());
        let (mut room, mut rows) = (NearBlocks::default(), [const { Vec::new() }; DISCS]);
        for block in blocks {
            let mut seen = 0;
            tree.near(block, factor, &mut room, |i, j| {
                seen += 1;
                if keep(i, j) {
                    rows[i % DISCS].push(j as u32);
                }
                true
            });
            budget.spend(seen)?;
            for (_, row) in tree.places(block).zip(&mut rows) {
                degree.push(row.len() as u32);
                neighbour.append(row);
            }
        }
        Ok((degree, neighbour))
    }
);

impl Graph {
    /// Without edges.
    pub(super) fn empty(places: usize) -> Self {
        Self { start: vec![0; places + 1], neighbour: Vec::new() }
    }

    /// Of the pairs of places that are [near](DiscTree::near) and are kept.
    pub(super) fn new(
        tree: &DiscTree,
        factor: f64,
        keep: impl Fn(usize, usize) -> bool + Sync,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Self> {
        let budget = Budget::new(tree.surfel.len(), factor);
        let rows = |blocks| near_rows(tree, blocks, factor, &keep, &budget);
        Self::of_rows(tree, rows, exec, progress)
    }

    /// Of rows that are made of some blocks at a time.
    pub(super) fn of_rows(
        tree: &DiscTree,
        rows: impl Fn(Range<usize>) -> Result<Rows> + Sync + Send,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Self> {
        let start = Vec::with_capacity(tree.surfel.len() + 1);
        let mut graph = Self { start, neighbour: Vec::new() };
        graph.start.push(0);
        let mut end = 0;
        let show = |done, of| progress("finding overlaps", done, of);
        tree.parts(exec, &show, rows, |(degrees, neighbours): Rows| {
            graph.start.extend(degrees.into_iter().map(|degree| {
                end += degree as usize;
                end
            }));
            graph.neighbour.extend(neighbours);
        })?;
        Ok(graph)
    }

    /// The neighbours of a place.
    #[inline]
    pub(super) fn of(&self, place: usize) -> &[u32] {
        &self.neighbour[self.start[place]..self.start[place + 1]]
    }

    /// Where all neighbours of some places are, counted from the first of the first place on.
    #[inline]
    pub(super) fn entries(&self, places: Range<usize>) -> Range<usize> {
        self.start[places.start]..self.start[places.end]
    }

    pub(super) fn degree(&self, place: usize) -> u32 {
        (self.start[place + 1] - self.start[place]) as u32
    }

    /// How many edges there are, each counted once.
    pub(super) fn edges(&self) -> u64 {
        self.neighbour.len() as u64 / 2
    }
}

/// The graph of some rules, at their c or another.
pub(super) fn conflicts(
    surfels: &Surfels,
    tree: &DiscTree,
    rules: &Rules,
    overlap: f32,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<Graph> {
    let keep = |i: usize, j: usize| !relaxed(surfels, tree, rules, i, j);
    Graph::new(tree, f64::from(overlap), keep, exec, progress)
}

/// Whether modification 1 or 2 takes the edge of two places away.
#[inline(always)]
pub(super) fn relaxed(
    surfels: &Surfels,
    tree: &DiscTree,
    rules: &Rules,
    i: usize,
    j: usize,
) -> bool {
    if !rules.opposite && rules.coplanar.is_none() {
        return false;
    }
    let cosine = tree.discs[i].cosine(&tree.discs[j]);
    if rules.opposite && cosine < 0.0 {
        return true;
    }
    let Some(rule) = &rules.coplanar else { return false };
    let [i, j] = [i, j].map(|place| tree.surfel[place] as usize);
    cosine >= f64::from(rule.cosine)
        && within_planes(surfels, rule, i, j)
        && of_one_color(surfels, rule, i, j)
}

fn within_planes(surfels: &Surfels, rule: &Coplanar, i: usize, j: usize) -> bool {
    let [p, q] = [i, j].map(|i| surfels.position()[i].as_dvec3());
    let d = p - q;
    let radius = super::disc_tree::radii(surfels);
    let most = f64::from(rule.offset) * (radius(i as u32) + radius(j as u32));
    [i, j].into_iter().all(|i| dot(d, surfels.normal()[i].as_dvec3()).abs() <= most)
}

fn of_one_color(surfels: &Surfels, rule: &Coplanar, i: usize, j: usize) -> bool {
    surfels.color().is_none_or(|color| {
        let [a, b] = [i, j].map(|i| color[i].as_dvec3().to_array());
        a.into_iter().zip(b).all(|(a, b)| (a - b).abs() <= f64::from(rule.color))
    })
}
