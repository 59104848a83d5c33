//! Discs in space, and which of them are near each other.
//!
//! A balanced tree over blocks of [`DISCS`] discs that follow each other along a [curve]: it does
//! not care how unevenly they are spread, and as each box knows the largest radius in it, nor how
//! their sizes differ. One block is searched for at a time, and pairs are tested a block at a time.
//! What is found depends on the discs alone; the tree leaves no trace but the order in which it is
//! found.

use super::clipped::DiscSamples;
use super::curve;
use super::disc::SpaceDisc;
use crate::error::Result;
use crate::frame::Exec;
use crate::memory;
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
    /// How many surfels of the tree have a lower index than that at each place.
    pub(super) rank: Vec<u32>,
    /// The squared radius of each rank.
    pub(super) square: Vec<f64>,
    /// The disc at each place.
    pub(super) discs: Vec<SpaceDisc>,
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

/// Bytes of a surfel in the trees, its neighbours in two graphs, what is covered of it: 250 where it overlaps 12
/// others.
const OF_A_SURFEL: u64 = 512;

impl DiscTree {
    /// Of all surfels, for groups of them.
    pub(super) fn of_all(
        surfels: &Surfels,
        exec: &Exec,
        progress: &dyn Fn(&str, u64, u64),
    ) -> Result<Self> {
        let count = surfels.len();
        memory::ask(count as u64 * OF_A_SURFEL, || format!("groups of {count} surfels"))?;
        progress("sorting surfels", 0, 1);
        Ok(Self::new(surfels, 0..count as u32, exec))
    }

    /// Of some surfels, by index in ascending order.
    pub(super) fn new(surfels: &Surfels, members: impl Iterator<Item = u32>, exec: &Exec) -> Self {
        let members: Vec<u32> = members.collect();
        let n = members.len();
        let points: Vec<Vec3> = members.iter().map(|&id| surfels.position()[id as usize]).collect();
        let rank = curve::along(&points, DISCS, exec);
        let radius = radii(surfels);
        let (mut surfel, mut discs, mut blocks) = (Vec::new(), Vec::new(), Vec::new());
        exec.extend(&mut surfel, n, |place| members[rank[place] as usize]);
        exec.extend(&mut discs, n, |place| {
            let id = surfel[place];
            let (center, normal) = (points[rank[place] as usize], surfels.normal()[id as usize]);
            SpaceDisc { center, normal, radius: radius(id) }
        });
        exec.extend(&mut blocks, n.div_ceil(DISCS), |block| {
            DiscBlock::of(&discs[block * DISCS..n.min((block + 1) * DISCS)])
        });
        let mut square = Vec::new();
        exec.extend(&mut square, n, |rank| {
            let r = radius(members[rank]);
            r * r
        });
        let mut levels = vec![blocks.iter().map(Bounds::of).collect::<Vec<_>>()];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            let pair = |pair: &[Bounds]| pair[1..].iter().fold(pair[0], Bounds::and);
            let level = below.chunks(2).map(pair).collect();
            levels.push(level);
        }
        Self { surfel, rank, square, discs, blocks, levels }
    }

    /// The places of a block.
    pub(super) fn places(&self, block: usize) -> Range<usize> {
        let first = block * DISCS;
        first..self.surfel.len().min(first + DISCS)
    }

    /// The samples of the disc at a place.
    #[inline(always)]
    pub(super) fn samples(&self, place: usize) -> DiscSamples {
        DiscSamples::of(self.discs[place], self.surfel[place])
    }

    /// Visits the pairs of places (i, j), i of the block and j any other, that are near:
    /// `|p_i - p_j| < factor (r_i + r_j)`, as the [module](super) evaluates it.
    ///
    /// Those j first that are close by in the order of the tree. If a visit returns false, the rest
    /// of its i is skipped. `room` is memory that is used again.
    #[inline(always)]
    pub(super) fn near(
        &self,
        block: usize,
        factor: f64,
        room: &mut NearBlocks,
        mut visit: impl FnMut(usize, usize) -> bool,
    ) {
        let places = self.places(block);
        // A bit for each i that is not skipped.
        let mut wanted = (1_u32 << places.len()) - 1;
        self.near_blocks(block, factor, room);
        for blocks in room.found.chunks(PART) {
            let part = DiscPart::of(blocks.iter().map(|&other| &self.blocks[other as usize]));
            for i in places.clone() {
                if wanted >> (i % DISCS) & 1 == 0 {
                    continue;
                }
                let near = part.near(&self.blocks[block], i % DISCS, factor);
                'rest: for (&other, near) in blocks.iter().zip(near.as_chunks::<DISCS>().0) {
                    let mut near = u64::from_le_bytes(*near);
                    while near != 0 {
                        let j = other as usize * DISCS + near.trailing_zeros() as usize / 8;
                        if j != i && !visit(i, j) {
                            wanted &= !(1 << (i % DISCS));
                            break 'rest;
                        }
                        near &= near - 1;
                    }
                }
            }
            if wanted == 0 {
                return;
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

    /// The blocks that may hold a disc near one of a block, those first whose number is close.
    fn near_blocks(&self, block: usize, factor: f64, room: &mut NearBlocks) {
        let NearBlocks { found, around, of } = room;
        // Neighbouring blocks have much the same around them: the tree is searched for a few at a
        // time, from a box around them.
        let level = self.levels.len().min(3) - 1;
        if *of != Some((block >> level, factor)) {
            *of = Some((block >> level, factor));
            self.blocks_near(&self.levels[level][block >> level], factor, around);
        }
        let (own, boxes) = (&self.levels[0][block], &self.levels[0]);
        let near = around.iter().filter(|&&other| boxes[other as usize].may_be_near(own, factor));
        found.clear();
        found.extend(near);
        found.sort_unstable_by_key(|&other| other.abs_diff(block as u32));
    }

    /// The blocks that may hold a disc near one of a box.
    fn blocks_near(&self, bounds: &Bounds, factor: f64, found: &mut Vec<u32>) {
        found.clear();
        let mut ahead = vec![(self.levels.len() - 1, 0)]; // somebody asks: there is a block
        while let Some((level, index)) = ahead.pop() {
            if !self.levels[level][index].may_be_near(bounds, factor) {
                continue;
            }
            if level == 0 {
                found.push(index as u32);
                continue;
            }
            let halves = [2 * index, 2 * index + 1].into_iter();
            let there = halves.filter(|&index| index < self.levels[level - 1].len());
            ahead.extend(there.map(|index| (level - 1, index)));
        }
    }
}

/// The blocks that are searched, in memory that is used again.
#[derive(Debug, Default)]
pub(super) struct NearBlocks {
    found: Vec<u32>,
    /// Near a box of several blocks.
    around: Vec<u32>,
    /// Which box, and near by which factor.
    of: Option<(usize, f64)>,
}

/// Blocks whose discs are tested at once.
const PART: usize = 8;
const LANES: usize = PART * DISCS;

/// The discs of up to [`PART`] blocks, then NaN, which is near nothing.
#[derive(Clone, Debug)]
struct DiscPart {
    x: [f64; LANES],
    y: [f64; LANES],
    z: [f64; LANES],
    r: [f64; LANES],
}

impl DiscPart {
    #[inline(always)]
    fn of<'a>(blocks: impl Iterator<Item = &'a DiscBlock>) -> Self {
        let [x, y, z, r] = [[f64::NAN; LANES]; 4];
        let mut part = Self { x, y, z, r };
        for (at, block) in blocks.enumerate() {
            let lanes = at * DISCS..(at + 1) * DISCS;
            part.x[lanes.clone()].copy_from_slice(&block.x);
            part.y[lanes.clone()].copy_from_slice(&block.y);
            part.z[lanes.clone()].copy_from_slice(&block.z);
            part.r[lanes].copy_from_slice(&block.r);
        }
        part
    }

    /// 1 for each disc here that is near the disc in a lane of a block, else 0.
    #[inline(always)]
    #[expect(clippy::needless_range_loop, reason = "a lane is an index into several arrays")]
    fn near(&self, block: &DiscBlock, lane: usize, factor: f64) -> [u8; LANES] {
        let (x, y, z, r) = (block.x[lane], block.y[lane], block.z[lane], block.r[lane]);
        let mut near = [0; LANES];
        for l in 0..LANES {
            let (dx, dy, dz) = (x - self.x[l], y - self.y[l], z - self.z[l]);
            let reach = factor * (r + self.r[l]);
            near[l] = u8::from((dx * dx + dy * dy) + dz * dz < reach * reach);
        }
        near
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

impl DiscBlock {
    /// Of at most as many discs as there are lanes.
    fn of(discs: &[SpaceDisc]) -> Self {
        let [x, y, z, r] = [[f64::NAN; DISCS]; 4];
        let mut block = Self { x, y, z, r };
        for (lane, disc) in discs.iter().enumerate() {
            let p = disc.center.as_dvec3();
            (block.x[lane], block.y[lane], block.z[lane]) = (p.x, p.y, p.z);
            block.r[lane] = disc.radius;
        }
        block
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
