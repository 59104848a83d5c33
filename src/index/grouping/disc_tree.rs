//! Find which discs are near each other in space.
//!
//! The discs are divided into blocks of [`DISCS`] discs that follow each other along a [curve], and
//! a balanced tree stands over the blocks. The tree works however unevenly the discs are spread. It
//! also works however much their sizes differ, because each box knows the largest radius in it. The
//! tree is searched for a few blocks at a time. Each disc of these blocks then tests the boxes that
//! were found, and the discs in the boxes that it may be near, all lanes at once. The result
//! depends on the discs alone; the tree affects only the order in which neighbours are found.

use super::curve;
use super::disc::{SpaceDisc, are_near};
use super::samples::DiscSamples;
use crate::frame::Exec;
use crate::number::MapInline;
use crate::scene::{Sphere, Surfels};
use glam::{DVec3, Vec3};

/// How many discs a block has. The compiler unrolls loops over fewer lanes before it can vectorize
/// them.
pub(super) const DISCS: usize = 16;

/// Discs in the order of the tree: *places* 0, 1, 2 ...
#[derive(Debug)]
pub(super) struct DiscTree {
    /// The surfel at each place.
    pub(super) surfel: Vec<u32>,
    /// For each place, how many surfels of the tree have a lower index than the surfel there.
    pub(super) rank: Vec<u32>,
    /// The squared radius of each rank.
    pub(super) square: Vec<f64>,
    /// The disc at each place.
    pub(super) discs: Vec<SpaceDisc>,
    blocks: Vec<DiscBlock>,
    /// Boxes around 1, 2, 4 ... blocks, up to the box around all.
    levels: Vec<Vec<Bounds>>,
}

/// Discs side by side. The unused lanes of the last block are NaN, which is near nothing.
#[derive(Clone, Debug)]
pub(super) struct DiscBlock {
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
    /// Makes the tree of some surfels, given by ascending indices.
    pub(super) fn new(surfels: &Surfels, members: impl Iterator<Item = u32>, exec: &Exec) -> Self {
        let members: Vec<u32> = members.collect();
        let n = members.len();
        let mut points = Vec::new();
        exec.extend(&mut points, n, |i| surfels.position()[members[i] as usize]);
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
            DiscBlock::of(discs[block * DISCS..n.min((block + 1) * DISCS)].iter())
        });
        let mut square = Vec::new();
        exec.extend(&mut square, n, |rank| {
            let r = radius(members[rank]);
            r * r
        });
        let mut boxes = Vec::new();
        exec.extend(&mut boxes, blocks.len(), |block| Bounds::around(&blocks[block]));
        let mut levels = vec![boxes];
        while let Some(below) = levels.last().filter(|level| level.len() > 1) {
            let pair = |pair: &[Bounds]| pair[1..].iter().fold(pair[0], Bounds::and);
            let level = below.chunks(2).map(pair).collect();
            levels.push(level);
        }
        Self { surfel, rank, square, discs, blocks, levels }
    }

    /// The samples of the disc at a place.
    #[inline(always)]
    pub(super) fn samples(&self, place: usize) -> DiscSamples {
        DiscSamples::new(self.discs[place], self.surfel[place])
    }

    /// Visits the places j that are near a place i: `|p_i - p_j| < factor (r_i + r_j)`, as the
    /// [module](super) evaluates it.
    ///
    /// A visit gets several places at once, and how many of them count. Places that are close by in
    /// the order of the tree come first, until a visit returns false. `room` is memory that is
    /// reused.
    #[inline(always)]
    pub(super) fn near(
        &self,
        i: usize,
        factor: f64,
        room: &mut NearBlocks,
        mut visit: impl FnMut([u32; BYTE], usize) -> bool,
    ) {
        self.search(i / DISCS, factor, room);
        let own = self.blocks[i / DISCS].sphere(i % DISCS);
        for (at, boxes) in room.boxes.iter().enumerate() {
            let mut left = set_of(&boxes.near(own, factor));
            while left != 0 {
                let block = room.found[at * DISCS + left.trailing_zeros() as usize] as usize;
                left &= left - 1;
                let near = set_of(&self.blocks[block].near(own, factor));
                // A disc is not its own neighbour.
                let others = near & !(u32::from(block == i / DISCS) << (i % DISCS));
                let first = (block * DISCS) as u32;
                let [low, high] = [others & 0xFF, others >> BYTE];
                if !visit(members(first, low), low.count_ones() as usize)
                    || !visit(members(first + BYTE as u32, high), high.count_ones() as usize)
                {
                    return;
                }
            }
        }
    }

    /// Searches for the blocks that may hold a disc near a disc of this block.
    ///
    /// Neighbouring blocks have much the same surroundings. So the tree is searched for a few
    /// blocks at a time, from a box around them.
    fn search(&self, block: usize, factor: f64, room: &mut NearBlocks) {
        let level = self.levels.len().min(2) - 1;
        let of = block >> level;
        // The call before has found the surroundings already.
        if room.of == Some((of, factor)) {
            return;
        }
        room.of = Some((of, factor));
        self.blocks_near(&self.levels[level][of], factor, &mut room.found);
        room.found.sort_unstable_by_key(|&other| other.abs_diff(block as u32));
        let boxes =
            |blocks: &[u32]| BoxLanes::of(blocks.iter().map(|&b| &self.levels[0][b as usize]));
        room.boxes.clear();
        room.boxes.extend(room.found.chunks(DISCS).map(boxes));
    }

    /// The blocks that may hold a disc near a disc in a box.
    fn blocks_near(&self, bounds: &Bounds, factor: f64, found: &mut Vec<u32>) {
        found.clear();
        let mut ahead = vec![(self.levels.len() - 1, 0)]; // a caller has a place, so there is a block
        while let Some((level, index)) = ahead.pop() {
            // Nothing below this box can be near.
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

/// The blocks that may hold a disc near a disc of a few blocks, in memory that is reused.
#[derive(Debug, Default)]
pub(super) struct NearBlocks {
    /// The blocks found, closest numbers first.
    found: Vec<u32>,
    /// The boxes around these blocks, as many side by side as a block has discs.
    boxes: Vec<BoxLanes>,
    /// The blocks that the search was for, and the factor.
    of: Option<(usize, f64)>,
}

/// How many lanes one byte describes as a set.
const BYTE: usize = 8;

/// The members of each set of lanes, in ascending order; the caller knows how many there are.
static MEMBERS: [[u8; BYTE]; 1 << BYTE] = {
    let mut members = [[0; BYTE]; 1 << BYTE];
    let mut set = 0;
    while set < members.len() {
        let (mut lane, mut count) = (0, 0);
        while lane < BYTE {
            if set >> lane & 1 == 1 {
                members[set][count] = lane as u8;
                count += 1;
            }
            lane += 1;
        }
        set += 1;
    }
    members
};

/// The places of a set of lanes given by a byte; the first lane is at place `first`.
#[inline(always)]
fn members(first: u32, set: u32) -> [u32; BYTE] {
    let (members, mut places) = (&MEMBERS[set as usize], [0; BYTE]);
    for k in 0..BYTE {
        places[k] = first + u32::from(members[k]);
    }
    places
}

/// The set of the lanes that hold a 1: bit l is lane l.
#[inline(always)]
fn set_of(flags: &[u8; DISCS]) -> u32 {
    // The sum of 2^(56 - 7 l): the multiplication moves the 1 of byte l to bit 56 + l.
    const GATHER: u64 = 0x0102_0408_1020_4080;
    let all = u128::from_le_bytes(*flags);
    let low = (all as u64).wrapping_mul(GATHER) >> 56;
    let high = ((all >> 64) as u64).wrapping_mul(GATHER) >> 56;
    (low | high << BYTE) as u32
}

/// Boxes side by side. The unused lanes are NaN, which is near nothing.
#[derive(Clone, Debug)]
struct BoxLanes {
    low: [[f64; DISCS]; 3],
    high: [[f64; DISCS]; 3],
    r: [f64; DISCS],
}

impl BoxLanes {
    /// Packs boxes into lanes; there must be at most as many boxes as lanes.
    fn of<'a>(boxes: impl Iterator<Item = &'a Bounds>) -> Self {
        let none = [f64::NAN; DISCS];
        let mut lanes = Self { low: [none; 3], high: [none; 3], r: none };
        for (lane, bounds) in boxes.enumerate() {
            for axis in 0..3 {
                lanes.low[axis][lane] = bounds.low[axis];
                lanes.high[axis][lane] = bounds.high[axis];
            }
            lanes.r[lane] = bounds.r;
        }
        lanes
    }

    /// 1 for each box that [may](Bounds::may_be_near) hold a disc near this disc, else 0.
    #[inline(always)]
    fn near(&self, one: Sphere, factor: f64) -> [u8; DISCS] {
        let (one, mut near) = (Bounds::of(one), [0; DISCS]);
        for (lane, near) in near.iter_mut().enumerate() {
            *near = u8::from(self.bounds(lane).may_be_near(&one, factor));
        }
        near
    }

    #[inline(always)]
    fn bounds(&self, lane: usize) -> Bounds {
        let corner = |of: &[[f64; DISCS]; 3]| DVec3::new(of[0][lane], of[1][lane], of[2][lane]);
        Bounds { low: corner(&self.low), high: corner(&self.high), r: self.r[lane] }
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
            let [u, v] = tangents[id as usize].map_inline(length);
            if v > u { v } else { u }
        }
    }
}

impl DiscBlock {
    /// Packs discs into lanes; there must be at most as many discs as lanes.
    #[inline(always)]
    pub(super) fn of<'a>(discs: impl Iterator<Item = &'a SpaceDisc>) -> Self {
        let [x, y, z, r] = [[f64::NAN; DISCS]; 4];
        let mut block = Self { x, y, z, r };
        for (lane, disc) in discs.enumerate() {
            let Sphere { center, radius } = disc.sphere();
            (block.x[lane], block.y[lane], block.z[lane]) = (center.x, center.y, center.z);
            block.r[lane] = radius;
        }
        block
    }

    /// The sphere around the disc in a lane.
    #[inline(always)]
    pub(super) fn sphere(&self, lane: usize) -> Sphere {
        let center = DVec3::new(self.x[lane], self.y[lane], self.z[lane]);
        Sphere { center, radius: self.r[lane] }
    }

    /// 1 for each disc that is near this disc, else 0.
    #[inline(always)]
    fn near(&self, one: Sphere, factor: f64) -> [u8; DISCS] {
        let mut near = [0; DISCS];
        for (lane, near) in near.iter_mut().enumerate() {
            *near = u8::from(are_near(one, self.sphere(lane), factor));
        }
        near
    }
}

impl Bounds {
    #[inline(always)]
    fn of(Sphere { center, radius }: Sphere) -> Self {
        Self { low: center, high: center, r: radius }
    }

    fn around(block: &DiscBlock) -> Self {
        let lane = |l: usize| Self::of(block.sphere(l));
        let filled = (1..DISCS).take_while(|&l| !block.r[l].is_nan());
        filled.fold(lane(0), |all, l| all.and(&lane(l)))
    }

    fn and(self, other: &Self) -> Self {
        let r = if other.r > self.r { other.r } else { self.r };
        Self { low: self.low.min(other.low), high: self.high.max(other.high), r }
    }

    /// False only if no two discs of these boxes are near. Rounding is monotone, so the computed
    /// gap is never above the distance of any two discs, and the computed reach is never below
    /// theirs.
    #[inline(always)]
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
