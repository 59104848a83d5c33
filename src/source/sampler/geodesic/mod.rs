//! The greedy permutation along a surface: distances on a graph of the points \[BJFM19, 6\].
//!
//! "Since our sampling method currently does not incorporate the normal of a sampling point, it might happen
//! that we incorectly distribute the surfels on the surface of such objects \[thin walls\], which results in holes
//! \[...\] we want to include (approximate) geodetic distances in our generation of greedy permutations". Two sides of
//! a wall that is thinner than the distance of picks share the picks if distances are straight: each side has
//! holes, as one side's picks keep picks of the other away. Here a path from side to side leads around the wall.
//!
//! # Definition
//!
//! Given are n finite points with finite normals of length above 0, a reach h > 0, a start and a count. Squared
//! distances d2 are those of [`super::greedy`], in `f32`.
//!
//! ```text
//!   a, b face alike   if  s >= 0  or  4 s s < (a . a)(b . b),  s = a . b      of normals, in f64,
//!                                                       a . b = (ax bx + ay by) + az bz
//!   near(i)           of all j other than i with d2(i, j) <= h h in f32 whose normals face alike, the 16 of the
//!                     least (d2, index)
//!   edges             i, j where j is in near(i) or i in near(j); of the length sqrt(d2), in f32
//!   D(q, i)           the least, over all paths from q to i, of the sum of lengths, added from q on, each
//!                     addition rounded to f32; +inf if there is no path
//! ```
//!
//! The order is that of [`super::greedy`], its steps 1 to 5, with D(q, i) in the place of the squared distance,
//! so that m is a distance. [`Order::distance`] has its square m m, rounded, as all orders have squares.
//!
//! Points that no path connects with a pick are infinitely far, and equal distances go to the lower index: so
//! each *part* of the graph, in the order of lowest indices, has a pick before any has two.
//!
//! # Decided
//!
//! - Normals face alike if they are less than 120 degrees apart: a right angle is no border, rounded or not, and
//!   both sides of a wall are. Across the edge of a wedge of less than 60 degrees no path leads.
//! - 16 neighbours are all within about 1.1 pixels where four directions saw a surface, and two rings of a
//!   raster where one did. A reach of two pixels then has neighbours along every slope: a pixel of the direction
//!   that sees a surface best is stretched to at most sqrt(3) of its side.
//! - Paths along edges are longer than the surface is, by some per cent and in every direction alike.
//! - Parts come first, however small: a pick that nobody else can stand for. A mesh of many small visible parts
//!   spends as many picks on them.
//!
//! # How
//!
//! After each pick a search of shortest paths (Dijkstra's) begins at it and ends where it comes no nearer than an
//! earlier pick. That is exact: adding a length and rounding is monotone and never shortens, so that a path that
//! is no shorter at a point is no shorter behind it. The m only fall: the next pick is found by a heap of m's that
//! may be too large, which are put back as they are.

mod graph;
#[cfg(test)]
mod tests;

pub use graph::Graph;
pub(super) use graph::alike;

use super::greedy::{Greedy, Order};
use crate::error::Result;
use crate::memory;
use crate::progress::Progress;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Picks between two reports of progress.
const REPORT: usize = 256;
/// What both heaps and the distances take for a point, at most.
const BYTES_A_POINT: u64 = 64;

impl Greedy {
    /// The first `count` picks along a graph, or all points if there are fewer; see the
    /// [module](crate::source::sampler::geodesic). `progress` is told the name of a step, how many picks there
    /// are, and how many there will be.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the start is not the index of a point.
    pub fn along(&self, graph: &Graph, count: usize, progress: Progress<'_>) -> Result<Order> {
        let n = graph.len();
        let mut next = self.start.among(n)?;
        memory::ask(n as u64 * BYTES_A_POINT, || format!("distances along {n} points"))?;
        let count = count.min(n);
        let mut front = Front { graph, least: vec![f32::INFINITY; n], heap: BinaryHeap::new() };
        let mut farthest: BinaryHeap<u64> =
            (0..n as u32).map(|id| key(f32::INFINITY, id)).collect();
        let mut order = Order::default();
        while order.index.len() < count {
            if order.index.len().is_multiple_of(REPORT) {
                progress("picks", order.index.len() as u64, count as u64);
            }
            let rank = graph.rank(next);
            let distance = front.least[rank as usize];
            if distance == 0.0 {
                order.finish(n, count);
                break;
            }
            order.index.push(next);
            order.distance.push(distance * distance);
            front.spread(rank);
            next = front.farthest(&mut farthest);
        }
        progress("picks", count as u64, count as u64);
        Ok(order)
    }
}

/// A point in the heap: the larger distance first, of equal ones the lower index. Bits of numbers that are not
/// negative are in the order of the numbers.
fn key(distance: f32, id: u32) -> u64 {
    u64::from(distance.to_bits()) << 32 | u64::from(!id)
}

/// The distances to what has been picked, by ranks in the graph.
struct Front<'a> {
    graph: &'a Graph,
    least: Vec<f32>,
    /// Distances, which may have become less since, and ranks: the least first.
    heap: BinaryHeap<Reverse<u64>>,
}

impl Front<'_> {
    /// Lowers the distances to those from one more pick.
    fn spread(&mut self, pick: u32) {
        self.offer(0.0, pick);
        while let Some(Reverse(entry)) = self.heap.pop() {
            let (distance, at) = (f32::from_bits((entry >> 32) as u32), entry as u32);
            if distance > self.least[at as usize] {
                continue;
            }
            for &(to, length) in self.graph.edges(at) {
                self.offer(distance + length, to);
            }
        }
    }

    #[inline(always)]
    fn offer(&mut self, distance: f32, to: u32) {
        let least = &mut self.least[to as usize];
        if distance < *least {
            *least = distance;
            self.heap.push(Reverse(u64::from(distance.to_bits()) << 32 | u64::from(to)));
        }
    }

    /// The index of the farthest point. The heap has all points, at no less than their distances.
    fn farthest(&self, heap: &mut BinaryHeap<u64>) -> u32 {
        while let Some(mut top) = heap.peek_mut() {
            let id = !(*top as u32);
            let now = key(self.least[self.graph.rank(id) as usize], id);
            if *top == now {
                return id;
            }
            *top = now;
        }
        0
    }
}
