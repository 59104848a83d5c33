//! Discs in space, and which of them are near each other.
//!
//! A balanced tree over blocks of [`DISCS`] discs: like a k-d tree it does not care how unevenly
//! they are spread, and as each box knows the largest radius in it, nor how their sizes differ. One
//! block is searched for at a time, and pairs are tested a block at a time. What is found depends
//! on the discs alone; the tree leaves no trace but the order in which it is found.

use super::disc::SpaceDisc;
use crate::error::Result;
use crate::frame::Exec;
use crate::index::point_tree::widest;
use crate::scene::Surfels;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Discs of one block.
pub(super) const DISCS: usize = 8;

/// Discs in the order of the tree: *places* 0, 1, 2 ...
#[derive(Debug)]
pub(super) struct DiscTree {
    /// The surfel at each place.
    pub(super) surfel: Vec<u32>,
    normal: Vec<Vec3>,
    blocks: Vec<DiscBlock>,
    /// Boxes around 1, 2, 4 ... blocks, up to the one around all.
    levels: Vec<Vec<Bounds>>,
}

/// Discs side by side; what is left of the last block is NaN, which is near nothing.
#[derive(Clone, Debug)]
struct DiscBlock {
    x: [f64; DISCS],
    y: [f64; DISCS],
    z: [f64; DISCS],
    r: [f64; DISCS],
}

/// A box around centres, and the largest of their radii.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: DVec3,
    high: DVec3,
    r: f64,
}

impl DiscTree {
    /// Of some surfels, by index, each once.
    pub(super) fn new(surfels: &Surfels, members: impl Iterator<Item = u32>) -> Self {
        let position = surfels.position();
        let mut entries: Vec<_> = members.map(|id| (position[id as usize], id)).collect();
        split(&mut entries);
        let radius = radii(surfels);
        let block = |entries: &[(Vec3, u32)]| {
            let [x, y, z, r] = [[f64::NAN; DISCS]; 4];
            let mut block = DiscBlock { x, y, z, r };
            for (lane, &(p, id)) in entries.iter().enumerate() {
                let p = p.as_dvec3();
                (block.x[lane], block.y[lane], block.z[lane]) = (p.x, p.y, p.z);
                block.r[lane] = radius(id);
            }
            block
        };
        let blocks: Vec<DiscBlock> = entries.chunks(DISCS).map(block).collect();
        let mut levels = vec![blocks.iter().map(Bounds::of).collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            let pair = |pair: &[Bounds]| pair[1..].iter().fold(pair[0], Bounds::and);
            let level = below.chunks(2).map(pair).collect();
            levels.push(level);
        }
        let normal = entries.iter().map(|&(_, id)| surfels.normal()[id as usize]).collect();
        Self { surfel: entries.into_iter().map(|(_, id)| id).collect(), normal, blocks, levels }
    }

    /// The places of a block.
    pub(super) fn places(&self, block: usize) -> Range<usize> {
        let first = block * DISCS;
        first..self.surfel.len().min(first + DISCS)
    }

    /// The disc at a place.
    #[inline]
    pub(super) fn disc(&self, place: usize) -> SpaceDisc {
        let (block, lane) = (&self.blocks[place / DISCS], place % DISCS);
        SpaceDisc {
            surfel: self.surfel[place],
            center: DVec3::new(block.x[lane], block.y[lane], block.z[lane]),
            normal: self.normal[place].as_dvec3(),
            radius: block.r[lane],
        }
    }

    /// Visits the pairs of places (i, j), i of the block and j any other, that are near:
    /// `|p_i - p_j| < factor (r_i + r_j)`, as the [module](super) evaluates it.
    ///
    /// Ascending by i, for one i by j. If a visit returns false, the rest of its i is skipped.
    pub(super) fn near(
        &self,
        block: usize,
        factor: f64,
        mut visit: impl FnMut(usize, usize) -> bool,
    ) {
        let near = self.near_blocks(block, factor);
        for i in self.places(block) {
            'rest: for &other in &near {
                let other = other as usize;
                let mut hits = self.blocks[other].hits(&self.blocks[block], i % DISCS, factor);
                if other == block {
                    hits &= !(1 << (i % DISCS));
                }
                while hits != 0 {
                    let j = other * DISCS + hits.trailing_zeros() as usize;
                    if !visit(i, j) {
                        break 'rest;
                    }
                    hits &= hits - 1;
                }
            }
        }
    }

    /// Runs a job for ranges of blocks, in parallel, and hands on the results in their order.
    ///
    /// `progress` gets how many places are done, and of how many.
    pub(super) fn parts<T: Send>(
        &self,
        exec: &Exec,
        progress: &dyn Fn(u64, u64),
        job: impl Fn(Range<usize>) -> Result<T> + Sync + Send,
        mut take: impl FnMut(T),
    ) -> Result<()> {
        const JOB: usize = 128;
        const BATCH: usize = 128 * JOB;
        let (blocks, places) = (self.blocks.len(), self.surfel.len() as u64);
        for batch in (0..blocks).step_by(BATCH) {
            progress((batch * DISCS) as u64, places);
            let starts = (batch..blocks.min(batch + BATCH)).step_by(JOB);
            let ranges = starts.map(|start| start..blocks.min(start + JOB)).collect();
            for result in exec.ordered(ranges, &job) {
                take(result?);
            }
        }
        progress(places, places);
        Ok(())
    }

    /// The blocks that may hold a disc near one of a block, ascending.
    fn near_blocks(&self, block: usize, factor: f64) -> Vec<u32> {
        let bounds = &self.levels[0][block];
        let mut found = Vec::new();
        let mut ahead = vec![(self.levels.len() - 1, 0)]; // a block is asked for: there is one
        while let Some((level, index)) = ahead.pop() {
            if !self.levels[level][index].may_be_near(bounds, factor) {
                continue;
            }
            if level == 0 {
                found.push(index as u32);
                continue;
            }
            let (below, left) = (level - 1, 2 * index);
            if left + 1 < self.levels[below].len() {
                ahead.push((below, left + 1));
            }
            ahead.push((below, left));
        }
        found
    }
}

/// The radius of a surfel by index, see the [module](super).
pub(super) fn radii(surfels: &Surfels) -> impl Fn(u32) -> f64 {
    let length = |v: Vec3| {
        let v = v.as_dvec3();
        ((v.x * v.x + v.y * v.y) + v.z * v.z).sqrt()
    };
    move |id| match surfels.tangents() {
        None => f64::from(surfels.radius()[id as usize]),
        Some(tangents) => {
            let [u, v] = tangents[id as usize].map(length);
            if v > u { v } else { u }
        }
    }
}

/// Orders points so that blocks, pairs of blocks, pairs of those ... are close together: the first
/// 2^k blocks, k as large as can be, lie below the others along the widest axis; so again in both.
fn split(entries: &mut [(Vec3, u32)]) {
    if entries.len() <= DISCS {
        return;
    }
    let axis = widest(entries.iter().map(|(point, _)| *point));
    let middle = DISCS * (entries.len().div_ceil(DISCS).next_power_of_two() / 2);
    entries.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]));
    let (below, above) = entries.split_at_mut(middle);
    split(below);
    split(above);
}

impl DiscBlock {
    /// A bit for each disc here that is near the disc in a lane of another block.
    #[inline]
    fn hits(&self, of: &Self, lane: usize, factor: f64) -> u32 {
        let (x, y, z, r) = (of.x[lane], of.y[lane], of.z[lane], of.r[lane]);
        let mut hits = [0; DISCS];
        for (l, hit) in hits.iter_mut().enumerate() {
            let (dx, dy, dz) = (x - self.x[l], y - self.y[l], z - self.z[l]);
            let reach = factor * (r + self.r[l]);
            *hit = u32::from((dx * dx + dy * dy) + dz * dz < reach * reach) << l;
        }
        hits.iter().fold(0, |all, hit| all | hit)
    }
}

impl Bounds {
    fn of(block: &DiscBlock) -> Self {
        let lane = |l: usize| Self {
            low: DVec3::new(block.x[l], block.y[l], block.z[l]),
            high: DVec3::new(block.x[l], block.y[l], block.z[l]),
            r: block.r[l],
        };
        let filled = (1..DISCS).take_while(|&l| !block.r[l].is_nan());
        filled.fold(lane(0), |all, l| all.and(&lane(l)))
    }

    fn and(self, other: &Self) -> Self {
        let r = if other.r > self.r { other.r } else { self.r };
        Self { low: self.low.min(other.low), high: self.high.max(other.high), r }
    }

    /// False only if no two discs of these boxes are near: rounding is monotone, so that neither is
    /// the distance below that of any two discs exceeded, nor the reach above theirs missed.
    #[inline]
    fn may_be_near(&self, other: &Self, factor: f64) -> bool {
        let gap = |axis: usize| {
            let (below, above) =
                (self.low[axis] - other.high[axis], other.low[axis] - self.high[axis]);
            let gap = if below > above { below } else { above };
            if gap > 0.0 { gap } else { 0.0 }
        };
        let (x, y, z) = (gap(0), gap(1), gap(2));
        let reach = factor * (self.r + other.r);
        (x * x + y * y) + z * z < reach * reach
    }
}
