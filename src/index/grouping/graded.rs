//! The graphs of all c that are multiples of 1/64, from one that has the edges of all of them.

use super::color::STEPS;
use super::disc::dot;
use super::disc_tree::DiscTree;
use super::graph::{Graph, relaxed};
use super::rules::Rules;
use crate::error::Result;
use crate::frame::Exec;
use crate::scene::Surfels;
use std::ops::Range;

/// A graph, and of each of its edges the least multiple of 1/64 by which its discs are near, or
/// [`NEVER`].
pub(super) struct Graded<'a> {
    graph: &'a Graph,
    least: Vec<u8>,
}

/// An edge that the rules take away, or whose discs are not near by 1.
const NEVER: u8 = u8::MAX;

impl<'a> Graded<'a> {
    /// Of a graph that has the edges of all c that are asked for, and maybe some that the rules take
    /// away.
    pub(super) fn new(
        graph: &'a Graph,
        surfels: &Surfels,
        tree: &DiscTree,
        rules: &Rules,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Self> {
        let mut least = Vec::with_capacity(2 * graph.edges() as usize);
        let job = |blocks: Range<usize>| {
            let places = tree.places(blocks.start).start..tree.places(blocks.end - 1).end;
            let mut part = Vec::new();
            for i in places {
                part.extend(graph.of(i).iter().map(|&j| {
                    let j = j as usize;
                    if relaxed(surfels, tree, rules, i, j) { NEVER } else { step(tree, i, j) }
                }));
            }
            Ok(part)
        };
        let show = |done, of| progress("finding overlaps", done, of);
        tree.parts(exec, &show, job, |part: Vec<u8>| least.extend(part))?;
        Ok(Self { graph, least })
    }

    /// The graph of c = `most` / 64.
    pub(super) fn upto(
        &self,
        most: u8,
        tree: &DiscTree,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Graph> {
        let rows = |blocks: Range<usize>| {
            let places = tree.places(blocks.start).start..tree.places(blocks.end - 1).end;
            // Written where the next one goes, kept or not: whether it is cannot be foreseen.
            let mut kept = vec![0; self.graph.entries(places.clone()).len() + 1];
            let (mut degree, mut end) = (Vec::with_capacity(places.len()), 0);
            for i in places {
                let before = end;
                for (&j, &least) in
                    self.graph.of(i).iter().zip(&self.least[self.graph.entries(i..i + 1)])
                {
                    kept[end] = j;
                    end += usize::from(least <= most);
                }
                degree.push((end - before) as u32);
            }
            kept.truncate(end);
            Ok((degree, kept))
        };
        Graph::of_rows(tree, rows, exec, progress)
    }
}

/// The least multiple of 1/64 by which two discs are near, see [`super`], or [`NEVER`].
///
/// Discs that are near by a c are near by every larger one, as rounding is monotone. So the search
/// may begin anywhere; it begins beside where it ends.
#[inline(always)]
fn step(tree: &DiscTree, i: usize, j: usize) -> u8 {
    let (a, b) = (&tree.discs[i], &tree.discs[j]);
    let near = |step: u8| a.is_near(b, f64::from(step) / f64::from(STEPS));
    let d = a.center.as_dvec3() - b.center.as_dvec3();
    let guess = f64::from(STEPS) * (dot(d, d).sqrt() / (a.radius + b.radius));
    let mut step = if guess < f64::from(STEPS) { guess as u8 } else { STEPS };
    while step > 0 && near(step - 1) {
        step -= 1;
    }
    while step < STEPS && !near(step) {
        step += 1;
    }
    if near(step) { step } else { NEVER }
}
