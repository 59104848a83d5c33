//! The k nearest neighbours of every point, exactly and in a fixed order.
//!
//! An implicit k-d tree: the points are permuted so that the middle of each range splits it along
//! its widest axis. Unlike a grid it does not care how unevenly the points are spread, and its
//! depth is the logarithm of their number whatever they are.

use glam::Vec3;
use rayon::prelude::*;

/// Ranges up to this length are searched through: so few points cost less than a branch for each.
const LEAF: usize = 8;
/// Points between two reports of progress, and points of one parallel job.
const BATCH: usize = 1 << 16;
const JOB: usize = 1 << 8;

/// Points ordered for the search.
#[derive(Debug)]
pub(super) struct Neighbours {
    entries: Vec<Entry>,
    /// For the middle of a range longer than [`LEAF`], the axis along which it splits it.
    axis: Vec<u8>,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    point: Vec3,
    id: u32,
}

/// A point and how far it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Neighbour {
    /// `(dx^2 + dy^2) + dz^2` in f64.
    pub(super) distance2: f64,
    /// Its index.
    pub(super) id: u32,
}

impl Neighbours {
    /// Of fewer than 2^32 finite points.
    pub(super) fn new(points: &[Vec3]) -> Self {
        let entries = points.iter().zip(0..).map(|(&point, id)| Entry { point, id });
        let mut tree = Self { entries: entries.collect(), axis: vec![0; points.len()] };
        split(&mut tree.entries, &mut tree.axis);
        tree
    }

    /// `f(id, neighbours)` for every point, in the order of the ids.
    ///
    /// The neighbours are the `k` other points, or all if there are fewer, with the smallest
    /// (squared distance, index), ascending; both are exact properties of the points, so that the
    /// tree and the threads leave no trace. `progress` gets points done and points in all.
    pub(super) fn map<T: Copy + Default + Send>(
        &self,
        k: usize,
        progress: &dyn Fn(u64, u64),
        f: impl Fn(u32, &[Neighbour]) -> T + Sync,
    ) -> Vec<T> {
        let mut results = vec![T::default(); self.entries.len()];
        let job = |entries: &[Entry]| -> Vec<T> {
            let mut nearest = Nearest { k, found: Vec::with_capacity(k + 1) };
            let each = entries.iter().map(|entry| {
                nearest.found.clear();
                self.search(0..self.entries.len(), entry, [0.0; 3], &mut nearest);
                f(entry.id, &nearest.found)
            });
            each.collect()
        };
        let mut done = 0;
        for batch in self.entries.chunks(BATCH) {
            progress(done, self.entries.len() as u64);
            for (entry, result) in batch.iter().zip(ordered(batch, job).into_iter().flatten()) {
                results[entry.id as usize] = result;
            }
            done += batch.len() as u64;
        }
        progress(done, done);
        results
    }

    /// Offers the points of a range to `nearest`, except the one that asks.
    ///
    /// `offset` is how far the range is from the query along each axis, at least. Rounding is
    /// monotone, so that the distance made of it never exceeds that of a point in the range.
    fn search(
        &self,
        range: std::ops::Range<usize>,
        query: &Entry,
        offset: [f64; 3],
        nearest: &mut Nearest,
    ) {
        if range.len() <= LEAF {
            self.entries[range].iter().for_each(|entry| nearest.offer(query, entry));
            return;
        }
        let middle = range.start + range.len() / 2;
        let axis = usize::from(self.axis[middle]);
        let entry = &self.entries[middle];
        let beyond = f64::from(query.point[axis]) - f64::from(entry.point[axis]);
        let (low, high) = (range.start..middle, middle + 1..range.end);
        let (near, far) = if beyond < 0.0 { (low, high) } else { (high, low) };
        self.search(near, query, offset, nearest);
        nearest.offer(query, entry);
        let mut offset = offset;
        offset[axis] = beyond;
        // At the same distance a lower index may still win.
        if length2(offset) <= nearest.reach() {
            self.search(far, query, offset, nearest);
        }
    }
}

/// The one parallel loop here: the results of all jobs in order, whatever the threads.
fn ordered<T: Send>(
    entries: &[Entry],
    job: impl Fn(&[Entry]) -> Vec<T> + Sync + Send,
) -> Vec<Vec<T>> {
    entries.par_chunks(JOB).map(job).collect()
}

/// Puts the median of a range into its middle, lower ones before and higher ones after it.
fn split(entries: &mut [Entry], axes: &mut [u8]) {
    if entries.len() <= LEAF {
        return;
    }
    let (mut low, mut high) = (entries[0].point, entries[0].point);
    for entry in entries.iter() {
        low = low.min(entry.point);
        high = high.max(entry.point);
    }
    let extent = high.as_dvec3() - low.as_dvec3();
    let mut axis = 0;
    for other in 1..3 {
        if extent[other] > extent[axis] {
            axis = other;
        }
    }
    let middle = entries.len() / 2;
    entries.select_nth_unstable_by(middle, |a, b| {
        a.point[axis].total_cmp(&b.point[axis]).then(a.id.cmp(&b.id))
    });
    axes[middle] = axis as u8;
    let ((low, high), (low_axes, high_axes)) =
        (entries.split_at_mut(middle), axes.split_at_mut(middle));
    split(low, low_axes);
    split(&mut high[1..], &mut high_axes[1..]);
}

fn length2([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y) + z * z
}

/// The best points so far, ascending.
struct Nearest {
    k: usize,
    found: Vec<Neighbour>,
}

impl Nearest {
    /// No point farther than this is of interest.
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

    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![
            4 => (-3_i8..=3).prop_map(f32::from),
            4 => -1.0_f32..1.0,
            1 => prop::sample::select(vec![-0.0, f32::MIN_POSITIVE, 1e-45, -1e-40]),
            1 => prop::sample::select(vec![f32::MAX, -f32::MAX, 1e30, 3e38, 16_777_216.0]),
            2 => (0_u32..4).prop_map(|ulps| f32::from_bits(1.0_f32.to_bits() + ulps)),
        ]
    }

    fn points() -> impl Strategy<Value = Vec<Vec3>> {
        let point = prop_oneof![
            6 => [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from_array),
            2 => coordinate().prop_map(|t| Vec3::new(t, 2.0, -1.0)),
            1 => Just(Vec3::ONE),
        ];
        prop::collection::vec(point, 1..120)
    }

    proptest! {
        #[test]
        fn the_tree_finds_what_brute_force_finds(points in points(), k in 1_usize..20) {
            let tree = Neighbours::new(&points);
            // The closure may not return a Vec, so it compares in place.
            let same = tree.map(k, &|_, _| (), |id, found| {
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
        let nearest = Neighbours::new(&points).map(3, &|_, _| (), |_, found| found[0].id);
        assert_eq!(nearest[0], 1);
        assert_eq!(nearest[100_000], 0, "all are equally far: the lowest wins");
    }
}
