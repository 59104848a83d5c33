//! Order points so that each is the farthest from all before it: the greedy permutation, also
//! called farthest-point sampling \[BJFM19, 3.2\].
//!
//! \[BJFM19\] takes this order as the ideal that its random method approximates, and calls it too
//! slow to compute. Here it is computed: call [`Greedy::order`].
//!
//! # Definition
//!
//! Given are n finite points `p_0` to `p_(n-1)`, a start s below n, and a count k. All arithmetic
//! is `f32`, and each operation is rounded. The squared distance of two points is
//!
//! ```text
//!   d(a, b) = (dx dx + dy dy) + dz dz        (dx, dy, dz) = b - a
//! ```
//!
//! Every point has a squared distance `m_i` to the nearest pick; it begins at +inf.
//!
//! 1. The first pick is s, at the squared distance +inf.
//! 2. After a pick q, each `m_i` becomes `d(p_q, p_i)` if that is less.
//! 3. The next pick is the point of the largest `m_i`, at the squared distance `m_i`; of equal
//!    ones, the lowest index. If all `m_i` are 0, step 4 follows instead.
//! 4. If all are 0, the points not yet picked follow in ascending index, at the squared distance 0.
//! 5. The order ends after k picks, or after n if there are fewer points: no index occurs twice.
//!
//! `Decided:` the paper chooses a random start, and does not mention ties and equal points. If no
//! start is given, it is `floor(b n / 2^64)`, where b is [`random::bits`] of the seed and 0.
//!
//! Distances are in `f32`. Points whose squared distance rounds to 0 (below about 2.6e-23) are
//! equal. Squared distances beyond the range are all +inf, and tie. So points should be neither
//! that close nor beyond about 1e19.
//!
//! # Laws that every order obeys
//!
//! With `r_j` the squared distance of pick j, and d as it is rounded:
//!
//! - `r_j` never increases.
//! - Packing: two of the first j picks are at least `r_(j-1)` apart.
//! - Covering: every point is at most `r_j` away from one of the first j picks. So every prefix is
//!   a net of its own radius, and no other j points cover all points with less than half of that
//!   radius.
//! - The first j of k picks are the j picks.
//! - Another order of the given points changes the result only where distances tie.
//!
//! # Why it is fast
//!
//! [`Greedy::define`] is the definition, with n distances for each pick. [`Greedy::order`] has the
//! same bits and is faster by orders of magnitude. It computes few distances, and takes picks out
//! of their turn:
//!
//! - Points lie in buckets with boxes, and buckets in groups. A box is skipped if the new pick is
//!   at least as far from it as its largest m. This is exact without a margin: rounding is
//!   monotone, so that the rounded distance to a box is never above the rounded distance to a point
//!   in it.
//! - The *key* of a point is (m, lower index first). Keys only fall, and the next pick has the
//!   largest. So the order is the points by falling keys, as the keys were when the points were
//!   picked.
//! - A point c may be picked before its turn if no point q with a larger key has d(q, c) below its
//!   own m. Then neither changes the other, nor the key at which the other is picked. This holds if
//!   no box within reach of c holds a larger key.
//! - A round picks all points whose m is not below a floor. First a thread for each region of the
//!   points picks all but the points that another region could reach; then one thread picks the
//!   rest. The keys above a floor are a function of the points, so that threads, regions and floors
//!   do not change the result.
//!
//! [`random::bits`]: crate::number::random::bits

mod build;
mod order;
mod rounds;
#[cfg(test)]
mod tests;
mod tree;

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::memory;
use crate::number::random;
use crate::progress::Progress;
use glam::Vec3;
use order::Division;
pub use order::Order;

/// The most bytes that the tree and the picks take for a point.
const BYTES_A_POINT: u64 = 80;

/// The sampler, see the [module](self).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Greedy {
    /// The first pick.
    pub start: Start,
}

/// The choice of the first point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// The point of this index.
    Index(u32),
    /// A random point, a function of this seed and of the number of points.
    Seed(u64),
}

impl Greedy {
    /// The first `count` picks, or all points if there are fewer; see the [module](self).
    ///
    /// `progress` gets the name of a step, the number of picks, and their total.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a point is not finite (the first such index is named), if the start is
    /// not the index of a point, if there is no point, or if there are 2^32 or more.
    pub fn order(
        &self,
        points: &[Vec3],
        count: usize,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Order> {
        let start = self.start.first_pick(points)?;
        let bytes = points.len() as u64 * BYTES_A_POINT;
        memory::ask(bytes, || format!("the order of {} points", points.len()))?;
        let count = count.min(points.len());
        Ok(rounds::order(points, start, count, &Division::among(exec), exec, progress))
    }

    /// The definition: [`Greedy::order`] as the module describes it, with n distances for each
    /// pick.
    ///
    /// # Errors
    /// As [`Greedy::order`].
    pub fn define(&self, points: &[Vec3], count: usize) -> Result<Order> {
        let mut next = self.start.first_pick(points)?;
        let mut least = vec![f32::INFINITY; points.len()];
        let mut order = Order::default();
        while order.index.len() < count.min(points.len()) {
            if least[next as usize] == 0.0 {
                order.finish(points.len(), count);
                break;
            }
            order.index.push(next);
            order.distance.push(least[next as usize]);
            let from = points[next as usize];
            next = 0;
            for (i, to) in (0..).zip(points) {
                let distance = squared_distance(from, *to);
                if distance < least[i as usize] {
                    least[i as usize] = distance;
                }
                if least[i as usize] > least[next as usize] {
                    next = i;
                }
            }
        }
        Ok(order)
    }
}

impl Start {
    /// The index of the first pick; an error if the points cannot be ordered.
    pub(super) fn first_pick(&self, points: &[Vec3]) -> Result<u32> {
        if let Some(at) = points.iter().position(|point| !point.is_finite()) {
            let what =
                format!("point {at} is not finite, so it has no distance to others; remove it");
            return Err(Error::Invalid(what));
        }
        self.among(points.len())
    }

    /// The index of the first pick among `n` points; an error if it does not exist.
    pub(super) fn among(&self, n: usize) -> Result<u32> {
        let invalid = |what| Err(Error::Invalid(what));
        let Ok(count) = u32::try_from(n) else {
            return invalid(format!("{n} points, but indices have 32 bits: split the model"));
        };
        if n == 0 {
            return invalid("there are no points to order".into());
        }
        match *self {
            Self::Seed(seed) => Ok(random::below(seed, 0, u64::from(count)) as u32),
            Self::Index(start) if start < count => Ok(start),
            Self::Index(start) => {
                let last = count - 1;
                invalid(format!("start {start}, but the points are 0 to {last}; give one of them"))
            }
        }
    }
}

impl Order {
    /// Appends the other points in ascending index, once all distances are 0.
    pub(super) fn finish(&mut self, points: usize, count: usize) {
        let mut picked = vec![false; points];
        self.index.iter().for_each(|&i| picked[i as usize] = true);
        let rest = (0..).zip(&picked).filter(|(_, picked)| !**picked).map(|(i, _)| i);
        self.index.extend(rest.take(count.saturating_sub(self.index.len())));
        self.distance.resize(self.index.len(), 0.0);
    }
}

/// The squared distance, in the order of the definition.
#[inline(always)]
pub(super) fn squared_distance(from: Vec3, to: Vec3) -> f32 {
    let (dx, dy, dz) = (to.x - from.x, to.y - from.y, to.z - from.z);
    (dx * dx + dy * dy) + dz * dz
}
