//! The graph of section 4.1: which surfels may not share a group.

use super::budget::Budget;
use super::disc::dot;
use super::disc_tree::DiscTree;
use super::rules::{Coplanar, Rules};
use crate::error::Result;
use crate::frame::Exec;
use crate::scene::Surfels;
use std::ops::Range;

/// The neighbours of every place of a tree, as one array.
#[derive(Debug, Default)]
pub(super) struct Graph {
    /// Where the neighbours of each place start, and last how many there are in all.
    start: Vec<usize>,
    neighbour: Vec<u32>,
}

impl Graph {
    /// Of the pairs of places that are [near](DiscTree::near) and are kept.
    pub(super) fn new(
        tree: &DiscTree,
        factor: f64,
        keep: impl Fn(usize, usize) -> bool + Sync,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Self> {
        let n = tree.surfel.len();
        let budget = Budget::new(n, factor);
        let job = |blocks: Range<usize>| {
            let first = tree.places(blocks.start).start;
            let mut degree = vec![0_u32; tree.places(blocks.end - 1).end - first];
            let mut neighbour = Vec::new();
            for block in blocks {
                let mut seen = 0;
                tree.near(block, factor, |i, j| {
                    seen += 1;
                    if keep(i, j) {
                        degree[i - first] += 1;
                        neighbour.push(j as u32);
                    }
                    true
                });
                budget.spend(seen)?;
            }
            Ok((degree, neighbour))
        };
        let mut graph = Self { start: Vec::with_capacity(n + 1), neighbour: Vec::new() };
        graph.start.push(0);
        let mut end = 0;
        let show = |done, of| progress("finding overlaps", done, of);
        tree.parts(exec, &show, job, |(degrees, neighbours): (Vec<u32>, Vec<u32>)| {
            graph.start.extend(degrees.into_iter().map(|degree| {
                end += degree as usize;
                end
            }));
            graph.neighbour.extend(neighbours);
        })?;
        Ok(graph)
    }

    /// The neighbours of a place, ascending.
    #[inline]
    pub(super) fn of(&self, place: usize) -> &[u32] {
        &self.neighbour[self.start[place]..self.start[place + 1]]
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
    let keep = |i: usize, j: usize| {
        let [i, j] = [i, j].map(|place| tree.surfel[place] as usize);
        !relaxed(surfels, rules, i, j)
    };
    let all = |_, _| true;
    if rules.opposite || rules.coplanar.is_some() {
        Graph::new(tree, overlap.into(), keep, exec, progress)
    } else {
        Graph::new(tree, overlap.into(), all, exec, progress)
    }
}

/// Whether modification 1 or 2 takes the edge of two surfels away.
pub(super) fn relaxed(surfels: &Surfels, rules: &Rules, i: usize, j: usize) -> bool {
    let [a, b] = [i, j].map(|i| surfels.normal()[i].as_dvec3());
    let cosine = dot(a, b);
    if rules.opposite && cosine < 0.0 {
        return true;
    }
    rules.coplanar.is_some_and(|rule| {
        cosine >= f64::from(rule.cosine)
            && within_planes(surfels, &rule, i, j)
            && of_one_color(surfels, &rule, i, j)
    })
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
