//! Order points along a surface instead of through it: the greedy permutation with distances on a
//! graph \[BJFM19, 6\].
//!
//! "Since our sampling method currently does not incorporate the normal of a sampling point, it
//! might happen that we incorectly distribute the surfels on the surface of such objects \[thin
//! walls\], which results in holes \[...\] we want to include (approximate) geodetic distances in
//! our generation of greedy permutations". With straight distances, the two sides of a wall that is
//! thinner than the distance of picks share the picks. Each side then has holes, because the picks
//! of one side keep picks of the other side away. Here a path from side to side leads around the
//! wall.
//!
//! # Definition
//!
//! Given are n finite points with finite normals of length above 0, a reach h > 0, a start and a
//! count. Squared distances d2 are those of [`super::greedy`], in `f32`.
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
//! The order is defined by the steps 1 to 5 of [`super::greedy`], with D(q, i) in place of the
//! squared distance, so that m is a distance. [`Order::distance`] has its square m m, rounded,
//! because all orders have squares.
//!
//! Points that no path connects to a pick are infinitely far away, and ties go to the lower index.
//! So each *part* of the graph, in the order of lowest indices, has a pick before any part has two.
//!
//! # Decided
//!
//! - Normals face alike if they are less than 120 degrees apart. So a right angle is no border,
//!   rounded or not, but the two sides of a wall are apart. No path leads across the edge of a
//!   wedge of less than 60 degrees.
//! - 16 neighbours are all within about 1.1 pixels where four directions saw a surface, and two
//!   rings of a raster where one direction did. A reach of two pixels then has neighbours along
//!   every slope, because the direction that sees a surface best stretches a pixel to at most
//!   sqrt(3) of its side.
//! - Paths along edges are longer than the surface is, by some per cent and in every direction
//!   alike.
//! - Parts come first, however small, because no other pick can stand for them. A mesh of many
//!   small visible parts spends as many picks on them.
//!
//! # How it is computed
//!
//! After each pick, a search for shortest paths (Dijkstra's) begins at the pick, and ends where it
//! comes no nearer than an earlier pick. This is exact: adding a length and rounding is monotone
//! and never shortens, so that a path that is no shorter at a point is no shorter behind it. The m
//! only fall. Therefore a heap of m's finds the next pick: an m on top that is too large is
//! corrected and put back.

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
/// The most bytes that both heaps and the distances take for a point.
const BYTES_A_POINT: u64 = 64;

impl Greedy {
    /// The first `count` picks along a graph, or all points if there are fewer; see the
    /// [module](crate::source::sampler::geodesic). `progress` gets the name of a step, the number
    /// of picks, and their total.
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
                progress("picking points", order.index.len() as u64, count as u64);
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
        progress("picking points", count as u64, count as u64);
        Ok(order)
    }
}

/// A point in the heap: the larger distance first, of equal ones the lower index. The bits of
/// non-negative numbers are in the order of the numbers.
fn key(distance: f32, id: u32) -> u64 {
    u64::from(distance.to_bits()) << 32 | u64::from(!id)
}

/// The distances to the picks so far, by ranks in the graph.
struct Front<'a> {
    graph: &'a Graph,
    least: Vec<f32>,
    /// Distances, which may be outdated and too large, and ranks; the least first.
    heap: BinaryHeap<Reverse<u64>>,
}

impl Front<'_> {
    /// Lowers the distances to the distances from one more pick.
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

    /// The index of the farthest point. The heap holds all points, at no less than their distances.
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
