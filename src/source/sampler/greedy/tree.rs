//! Buckets of points, groups of buckets, and groups of groups; each region is one such tree.
//!
//! Squared distances are never negative, so that their bits compare like the numbers. Minima and
//! maxima use these integers, because they have no rule for NaN, and so the loops become vector
//! code.

#![expect(
    clippy::needless_range_loop,
    reason = "a lane is an index into several arrays, and such a loop becomes vectors"
)]

use crate::number::MapInline;
use crate::number::Real;
use crate::number::lanes::{LANES, each, vectorized};

/// The most points of a bucket.
pub(super) const BUCKET: usize = 64;

/// Neighbouring points, one in each lane. A lane without a point has m = 0, so that it is never the
/// largest.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Bucket {
    pub(super) position: [[f32; BUCKET]; 3],
    /// The bits of m.
    least: [u32; BUCKET],
    id: [u32; BUCKET],
}

impl Bucket {
    /// Without points.
    pub(super) const EMPTY: Self =
        Self { position: [[0.0; BUCKET]; 3], least: [0; BUCKET], id: [u32::MAX; BUCKET] };

    /// Puts a point without a distance into a lane.
    pub(super) fn put(&mut self, lane: usize, point: [f32; 3], id: u32) {
        for axis in 0..3 {
            self.position[axis][lane] = point[axis];
        }
        self.least[lane] = f32::INFINITY.to_bits();
        self.id[lane] = id;
    }

    /// Lowers each m to the distance from `p`; returns the largest m, and the lowest index that has
    /// it.
    #[inline(always)]
    fn relax(&mut self, p: [f32; 3]) -> (u32, u32) {
        let [x, y, z] = &self.position;
        let mut most = 0;
        for i in 0..BUCKET {
            let (dx, dy, dz) = (x[i] - p[0], y[i] - p[1], z[i] - p[2]);
            let least = self.least[i].min(((dx * dx + dy * dy) + dz * dz).to_bits());
            self.least[i] = least;
            most = most.max(least);
        }
        let mut lowest = u32::MAX;
        for i in 0..BUCKET {
            lowest = lowest.min(if self.least[i] == most { self.id[i] } else { u32::MAX });
        }
        (most, lowest)
    }
}

/// Sixteen buckets or groups, one in each lane. A lane without a child has the largest m 0.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Group {
    low: [[f32; LANES]; 3],
    high: [[f32; LANES]; 3],
    /// The bits of the largest m. For groups it is as of the last [`Region::refresh`], or larger.
    most: [u32; LANES],
    /// The lowest index that has the largest m; for buckets only.
    id: [u32; LANES],
    /// The number of the first child; the others follow.
    first: u32,
}

impl Group {
    pub(super) fn new(first: usize) -> Self {
        Self {
            low: [[f32::INFINITY; LANES]; 3],
            high: [[f32::NEG_INFINITY; LANES]; 3],
            most: [0; LANES],
            id: [u32::MAX; LANES],
            first: first as u32,
        }
    }

    /// Puts a child without distances into a lane: its box, and its lowest index.
    pub(super) fn put(&mut self, lane: usize, [low, high]: [[f32; 3]; 2], id: u32) {
        for axis in 0..3 {
            self.low[axis][lane] = low[axis];
            self.high[axis][lane] = high[axis];
        }
        self.most[lane] = f32::INFINITY.to_bits();
        self.id[lane] = id;
    }

    /// The box around all children.
    pub(super) fn bounds(&self) -> [[f32; 3]; 2] {
        let low = self.low.map_inline(|low| low.iter().fold(f32::INFINITY, |a, b| a.at_most(*b)));
        let high =
            self.high.map_inline(|high| high.iter().fold(f32::NEG_INFINITY, |a, b| a.at_least(*b)));
        [low, high]
    }

    /// The children with points to which `p` may be nearer than their m, as bits.
    #[inline(always)]
    fn within_reach(&self, p: [f32; 3]) -> u32 {
        let distance = each(|i| {
            let d = |axis: usize| {
                let below = self.low[axis][i] - p[axis];
                let above = p[axis] - self.high[axis][i];
                let out = if below > above { below } else { above };
                if out > 0.0 { out } else { 0.0 }
            };
            let (dx, dy, dz) = (d(0), d(1), d(2));
            ((dx * dx + dy * dy) + dz * dz).to_bits()
        });
        bits(|i| distance[i] < self.most[i])
    }

    /// The buckets with a larger key, as bits.
    #[inline(always)]
    fn larger(&self, key: Key) -> u32 {
        let (most, id) = (key.most(), key.id());
        bits(|i| (self.most[i] > most) | ((self.most[i] == most) & (self.id[i] < id)))
    }

    /// The largest m.
    #[inline(always)]
    fn most(&self) -> u32 {
        self.most.iter().fold(0, |most, &m| most.max(m))
    }
}

/// The lanes in which a condition holds, as bits.
#[inline(always)]
fn bits(holds: impl Fn(usize) -> bool) -> u32 {
    let lanes = each(|i| u32::from(holds(i)) << i);
    lanes.iter().fold(0, |all, lane| all | lane)
}

/// Visits the set bits in ascending order.
#[inline(always)]
fn set(mut bits: u32, mut each: impl FnMut(u32)) {
    while bits != 0 {
        each(bits.trailing_zeros());
        bits &= bits - 1;
    }
}

/// The bits of m, then the index, inverted so that the lower index is larger: the largest key is
/// picked next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key(u64);

impl Key {
    pub(super) fn new(most: u32, id: u32) -> Self {
        Self(u64::from(most) << 32 | u64::from(!id))
    }

    pub(super) fn most(self) -> u32 {
        (self.0 >> 32) as u32
    }

    pub(super) fn id(self) -> u32 {
        !(self.0 as u32)
    }
}

/// A part of the points that one thread treats.
#[derive(Debug)]
pub(super) struct Region {
    buckets: Vec<Bucket>,
    /// Groups of buckets, groups of these, and so on up to a single group.
    levels: Vec<Vec<Group>>,
    /// The slots found by the last [`Region::reach`] or [`Region::list`]: 16 times the number of a
    /// group of buckets, plus a lane.
    pub(super) found: Vec<u32>,
    /// The groups to visit on one level, and on the next.
    ahead: [Vec<u32>; 2],
}

/// What other regions need to know of a region.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border {
    bounds: [[f32; 3]; 2],
    most: u32,
}

impl Border {
    /// Whether a point may be nearer to points of the region than their m.
    pub(super) fn reached(&self, p: [f32; 3]) -> bool {
        let [low, high] = self.bounds;
        let [x, y, z] =
            [0, 1, 2].map_inline(|i| (low[i] - p[i]).at_least(p[i] - high[i]).at_least(0.0_f32));
        ((x * x + y * y) + z * z).to_bits() < self.most
    }
}

impl Region {
    /// A region of buckets and their groups, at least one.
    pub(super) fn new(buckets: Vec<Bucket>, groups: Vec<Group>) -> Self {
        let mut levels = vec![groups];
        while let Some(below) = levels.last().filter(|below| below.len() > 1) {
            let above = below.chunks(LANES).enumerate().map(|(i, children)| {
                let mut group = Group::new(i * LANES);
                for (lane, child) in children.iter().enumerate() {
                    group.put(lane, child.bounds(), u32::MAX);
                }
                group
            });
            let above = above.collect();
            levels.push(above);
        }
        Self { buckets, levels, found: Vec::new(), ahead: [Vec::new(), Vec::new()] }
    }

    /// Updates the largest m of groups of groups.
    pub(super) fn refresh(&mut self) {
        for level in 1..self.levels.len() {
            let (below, above) = self.levels.split_at_mut(level);
            for (group, children) in above[0].iter_mut().zip(below[level - 1].chunks(LANES)) {
                for (most, child) in group.most.iter_mut().zip(children) {
                    *most = child.most();
                }
            }
        }
    }

    /// What other regions need to know, after [`Region::refresh`].
    pub(super) fn border(&self) -> Border {
        let root = &self.levels[self.levels.len() - 1][0];
        Border { bounds: root.bounds(), most: root.most() }
    }

    /// The largest m, after [`Region::refresh`].
    pub(super) fn most(&self) -> u32 {
        self.levels[self.levels.len() - 1][0].most()
    }

    /// The largest key of a slot.
    #[inline(always)]
    pub(super) fn key(&self, slot: u32) -> Key {
        let (group, lane) = place(slot);
        let group = &self.levels[0][group];
        Key::new(group.most[lane], group.id[lane])
    }

    /// Finds the slots whose largest m is not below a floor, in the order of memory.
    pub(super) fn list(&mut self, floor: u32) {
        self.descend(|group| bits(|i| group.most[i] >= floor));
        for &group in &self.ahead[0] {
            let above = &self.levels[0][group as usize];
            set(bits(|i| above.most[i] >= floor), |lane| {
                self.found.push(group * LANES as u32 + lane);
            });
        }
    }

    /// Walks down to the groups of buckets, through the children that `take` selects.
    #[inline(always)]
    fn descend(&mut self, take: impl Fn(&Group) -> u32) {
        let Self { levels, found, ahead: [ahead, next], .. } = self;
        found.clear();
        ahead.clear();
        ahead.push(0);
        for level in levels[1..].iter().rev() {
            next.clear();
            for &group in ahead.iter() {
                let group = &level[group as usize];
                set(take(group), |lane| next.push(group.first + lane));
            }
            std::mem::swap(ahead, next);
        }
    }
}

/// The group of buckets and the lane of a slot.
#[inline(always)]
fn place(slot: u32) -> (usize, usize) {
    (slot as usize / LANES, slot as usize % LANES)
}

vectorized!(
    /// Finds the slots with points to which `p` may be nearer than their m. Stops and returns false
    /// if one has a larger key.
    pub(super) fn reach(region: &mut Region, p: [f32; 3], key: Key) -> bool {
        region.descend(|group| group.within_reach(p));
        for &number in &region.ahead[0] {
            let group = &region.levels[0][number as usize];
            let within = group.within_reach(p);
            if within & group.larger(key) != 0 {
                return false;
            }
            set(within, |lane| region.found.push(number * LANES as u32 + lane));
        }
        true
    }
);

vectorized!(
    /// Lowers m in the found slots to the distances from `p`.
    pub(super) fn relax(region: &mut Region, p: [f32; 3]) {
        for &slot in &region.found {
            let (group, lane) = place(slot);
            let group = &mut region.levels[0][group];
            let bucket = &mut region.buckets[group.first as usize + lane];
            (group.most[lane], group.id[lane]) = bucket.relax(p);
        }
    }
);
