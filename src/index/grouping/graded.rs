//! Make the graphs of all c that are multiples of 1/64 from one graph that has all their edges.

use super::disc::{are_near, dot};
use super::disc_tree::{DISCS, DiscBlock, DiscTree};
use super::graph::{Graph, relaxed};
use super::parts::Parts;
use super::rules::Rules;
use crate::error::Result;
use crate::frame::Exec;
use crate::number::lanes::vectorized;
use crate::progress::Progress;
use crate::scene::{Sphere, Surfels};
use std::borrow::Cow;
use std::ops::Range;

/// c is tried in multiples of one in this many.
pub(super) const STEPS: u8 = 64;

/// A graph, and for each of its edges the least multiple of 1/64 by which its discs are near, or
/// [`NEVER`].
pub(super) struct Graded<'a> {
    graph: Cow<'a, Graph>,
    /// The grades, in the order of the rows of each part.
    least: Parts<Vec<u8>>,
}

/// An edge that the rules remove, or whose discs are not near by 1.
const NEVER: u8 = u8::MAX;

impl<'a> Graded<'a> {
    /// Grades a graph that has the edges of every c that may be asked for, and maybe some that the
    /// rules remove.
    pub(super) fn new(
        graph: Cow<'a, Graph>,
        surfels: &Surfels,
        tree: &DiscTree,
        rules: &Rules,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Self> {
        let away = |i: usize, j: usize| relaxed(surfels, tree, rules, i, j);
        let job = |places| Ok(least_steps(tree, &graph, places, &away));
        let show = |done, of| progress("finding overlaps", done, of);
        let least = Parts::compute(tree, exec, &show, job)?;
        Ok(Self { graph, least })
    }

    /// The graph of c = `most` / 64, in the memory of another graph.
    pub(super) fn upto(
        &self,
        most: u8,
        room: Graph,
        tree: &DiscTree,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Graph> {
        let rows = |places: Range<usize>, room| {
            Ok(self.graph.part(places.start).upto(most, self.least.with(places.start).0, room))
        };
        Graph::of_rows(room, tree, rows, exec, progress)
    }
}

vectorized!(
    /// The grades of the edges of some places.
    fn least_steps(
        tree: &DiscTree,
        graph: &Graph,
        places: Range<usize>,
        away: &impl Fn(usize, usize) -> bool,
    ) -> Vec<u8> {
        let rows = graph.part(places.start);
        let mut least = Vec::with_capacity(rows.len());
        for (row, i) in places.enumerate() {
            for others in rows.row(row).all.chunks(DISCS) {
                let block = DiscBlock::of(others.iter().map(|&j| &tree.discs[j as usize]));
                let steps = steps_of(&block, tree.discs[i].sphere());
                for (lane, &j) in others.iter().enumerate() {
                    least.push(if away(i, j as usize) { NEVER } else { steps[lane] as u8 });
                }
            }
        }
        least
    }
);

/// For each disc of a block, the least multiple of 1/64 by which it is near another disc, see
/// [`super`], or [`NEVER`].
///
/// Two discs are near by a multiple well above |d| / (r + r'), and are not near by one well below.
/// Rounding cannot move that border by half a multiple, so only the multiple closest to it is
/// tested.
#[inline(always)]
fn steps_of(block: &DiscBlock, one: Sphere) -> [u32; DISCS] {
    // Adding this to a number from 0 to 64 and subtracting it again leaves the closest whole
    // number, and the lower bits of the sum hold that number. (A conversion that saturates does not
    // vectorize.)
    const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;
    let mut least = [0; DISCS];
    for (lane, least) in least.iter_mut().enumerate() {
        let other = block.sphere(lane);
        let d = one.center - other.center;
        let border = f64::from(STEPS) * (dot(d, d).sqrt() / (one.radius + other.radius));
        let border = if border < f64::from(STEPS) { border } else { f64::from(STEPS) };
        let closest = border + WHOLE;
        let is_near = are_near(one, other, (closest - WHOLE) / f64::from(STEPS));
        let step = closest.to_bits() as u32 + u32::from(!is_near);
        *least = if step > u32::from(STEPS) { u32::from(NEVER) } else { step };
    }
    least
}
