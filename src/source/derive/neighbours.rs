//! Find the k nearest neighbours of every point, exactly and in a fixed order.
//!
//! The search uses the k-d tree of [`crate::index::point_tree`], because, unlike a grid, its speed
//! does not depend on how evenly the points are spread.

use crate::frame::Exec;
use crate::index::point_tree::{Entry, PointTree};
use glam::Vec3;

/// Ranges up to this length are searched linearly, because that costs less than a branch for each
/// point.
const LEAF: usize = 8;
/// Points between two reports of progress, and points of one parallel job.
const BATCH: usize = 1 << 16;
const JOB: usize = 1 << 8;

/// Points ordered for the search.
#[derive(Debug)]
pub(super) struct Neighbours {
    tree: PointTree,
}

/// A neighbour and its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Neighbour {
    /// `(dx^2 + dy^2) + dz^2` in f64.
    pub(super) distance2: f64,
    /// The index of the neighbour.
    pub(super) id: u32,
}

impl Neighbours {
    /// Needs fewer than 2^32 finite points.
    pub(super) fn new(points: &[Vec3], exec: &Exec) -> Self {
        Self { tree: PointTree::new(points, LEAF, exec) }
    }

    /// Computes `f(id, neighbours)` for every point; results are in the order of the ids.
    ///
    /// The neighbours are the `k` other points, or all if there are fewer, with the smallest
    /// (squared distance, index), in ascending order. Both are exact properties of the points, so
    /// that neither the tree nor the threads change the result. `progress` gets the points done and
    /// the total.
    pub(super) fn map<T: Copy + Default + Send>(
        &self,
        exec: &Exec,
        k: usize,
        progress: &dyn Fn(u64, u64),
        f: impl Fn(u32, &[Neighbour]) -> T + Sync + Send,
    ) -> Vec<T> {
        let all = self.tree.entries();
        let mut results = vec![T::default(); all.len()];
        let job = |entries: &[Entry]| -> Vec<T> {
            let mut nearest = Nearest { k, found: Vec::with_capacity(k + 1) };
            let each = entries.iter().map(|entry| {
                nearest.found.clear();
                self.search(0..all.len(), entry, [0.0; 3], &mut nearest);
                f(entry.id, &nearest.found)
            });
            each.collect()
        };
        let mut done = 0;
        for batch in all.chunks(BATCH) {
            progress(done, all.len() as u64);
            let jobs = exec.ordered(batch.chunks(JOB).collect(), job);
            for (entry, result) in batch.iter().zip(jobs.into_iter().flatten()) {
                results[entry.id as usize] = result;
            }
            done += batch.len() as u64;
        }
        progress(done, done);
        results
    }

    /// Offers the points of a range to `nearest`, except the query itself.
    ///
    /// `offset` is a lower bound of the distance between the range and the query along each axis.
    /// Rounding is monotone, so that the distance computed from it never exceeds the distance of a
    /// point in the range.
    fn search(
        &self,
        range: std::ops::Range<usize>,
        query: &Entry,
        offset: [f64; 3],
        nearest: &mut Nearest,
    ) {
        let entries = self.tree.entries();
        if range.len() <= LEAF {
            entries[range].iter().for_each(|entry| nearest.offer(query, entry));
            return;
        }
        let (middle, axis) = self.tree.node(&range);
        let entry = &entries[middle];
        let beyond = f64::from(query.point[axis]) - f64::from(entry.point[axis]);
        let (low, high) = (range.start..middle, middle + 1..range.end);
        let (near, far) = if beyond < 0.0 { (low, high) } else { (high, low) };
        self.search(near, query, offset, nearest);
        nearest.offer(query, entry);
        let mut offset = offset;
        offset[axis] = beyond;
        // Search at equal distance too, because a lower index wins.
        if length2(offset) <= nearest.reach() {
            self.search(far, query, offset, nearest);
        }
    }
}

fn length2([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y) + z * z
}

/// The nearest points so far, in ascending order.
struct Nearest {
    k: usize,
    found: Vec<Neighbour>,
}

impl Nearest {
    /// Points farther away than this are not needed.
    fn reach(&self) -> f64 {
        match self.found.last() {
            Some(last) if self.found.len() == self.k => last.distance2,
            _ => f64::INFINITY,
        }
    }

    #[inline]
    fn offer(&mut self, query: &Entry, entry: &Entry) {
        let delta = query.point.as_dvec3() - entry.point.as_dvec3();
        let distance2 = length2(delta.to_array());
        if distance2 > self.reach() || entry.id == query.id {
            return;
        }
        let closer = |n: &Neighbour| {
            n.distance2 < distance2 || (n.distance2 == distance2 && n.id < entry.id)
        };
        let at = self.found.iter().rposition(closer).map_or(0, |last| last + 1);
        self.found.insert(at, Neighbour { distance2, id: entry.id });
        self.found.truncate(self.k);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::index::point_tree::given::points;
    use proptest::prelude::*;

    /// All others by (distance, index), by the definition.
    fn brute_force(points: &[Vec3], of: usize, k: usize) -> Vec<(f64, u32)> {
        let square = |a: f32, b: f32| (f64::from(a) - f64::from(b)) * (f64::from(a) - f64::from(b));
        let mut all = Vec::new();
        for (i, p) in points.iter().enumerate().filter(|(i, _)| *i != of) {
            let q = points[of];
            all.push(((square(p.x, q.x) + square(p.y, q.y)) + square(p.z, q.z), i as u32));
        }
        all.sort_by(|a, b| a.partial_cmp(b).unwrap());
        all.truncate(k);
        all
    }

    proptest! {
        #[test]
        fn the_tree_finds_what_brute_force_finds(points in points(), k in 1_usize..20) {
            let tree = Neighbours::new(&points, &Exec::sequential());
            // The closure may not return a Vec, so it compares in place.
            let same = tree.map(&Exec::sequential(), k, &|_, _| (), |id, found| {
                let found: Vec<_> = found.iter().map(|n| (n.distance2, n.id)).collect();
                found == brute_force(&points, id as usize, k)
            });
            prop_assert!(same.iter().all(|&same| same));
        }
    }

    #[test]
    fn an_outlier_costs_no_quadratic_time() {
        // 100,000 points in a millionth of the whole: a grid would put them into one cell.
        let grid = |i: usize| Vec3::new((i % 311) as f32, (i / 311) as f32, 0.0) * 1e-6;
        let mut points: Vec<Vec3> = (0..100_000).map(grid).collect();
        points.push(Vec3::splat(1e30));
        let nearest = Neighbours::new(&points, &Exec::sequential()).map(
            &Exec::sequential(),
            3,
            &|_, _| (),
            |_, found| found[0].id,
        );
        assert_eq!(nearest[0], 1);
        assert_eq!(nearest[100_000], 0, "all are equally far: the lowest wins");
    }
}
