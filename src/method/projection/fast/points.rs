//! Turn every surfel that is seen into a point, sorted by bands.

#![expect(
    clippy::needless_range_loop,
    reason = "a lane is an index into several arrays, and such a loop becomes vectors"
)]

use crate::frame::Exec;
use crate::method::clock::{Work, spend};
use crate::method::projection::surfels::PointProjector;
use crate::number::lanes::{LANES, Lanes, vectorized};
use crate::number::{MapInline, Real, Vector3};
use crate::scene::Surfels;
use crate::scene::camera::MAX_EXTENT;
use crate::splat::{Fate, Tally};
use glam::Vec3;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Surfels of a chunk; an index in a chunk has [`SURFEL_BITS`].
pub(super) const CHUNK: usize = 1 << SURFEL_BITS;
const SURFEL_BITS: u32 = 14;
/// Maximum number of pixels of a band that has more than two rows. Depths and slots of a band fit a
/// second-level cache.
const BAND: usize = 65_536;
const _: () =
    assert!((2 * MAX_EXTENT) >> (32 - SURFEL_BITS) == 0, "two rows of the widest picture");
/// Minimum number of bands of a picture, if it has as many rows, so that there is work for every
/// thread.
const BANDS: usize = 16;

/// The place, the surfel and the depth of a point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PointKey {
    /// The surfel of the chunk in the lower [`SURFEL_BITS`]; above them the pixel of the band, counted
    /// row by row.
    place: u32,
    /// See [`order`].
    pub(super) order: u32,
}

impl PointKey {
    /// The pixel of the band.
    pub(super) fn pixel(self) -> usize {
        (self.place >> SURFEL_BITS) as usize
    }

    /// The surfel of the chunk.
    pub(super) fn surfel(self) -> u32 {
        self.place % CHUNK as u32
    }
}

/// The bits of a depth, which is finite and not -0, as an integer of the same order.
#[inline(always)]
pub(super) fn order(depth: f32) -> u32 {
    let bits = depth.to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

/// The depth of this [`order`].
#[inline(always)]
pub(super) fn depth(order: u32) -> f32 {
    f32::from_bits(if order >> 31 == 0 { !order } else { order & !(1 << 31) })
}

/// The points of a picture; the memory can be used for many pictures.
///
/// A **slot** is the index of a point in both arrays. The points of a chunk of surfels have the
/// first slots from the slot of its first surfel on, by bands, and in each band in the order of the
/// surfels. A point carries the normal, towards the viewer and in view space, and the radius.
#[derive(Debug, Default)]
pub(crate) struct Points {
    pub(super) keys: Vec<PointKey>,
    pub(super) carried: Vec<[f32; 4]>,
    /// For each chunk: the start of each band, from its first slot on, and the end of the last
    /// band.
    starts: Vec<u32>,
    bands: Bands,
    spare: Mutex<Vec<Chunk>>,
}

/// The division of a picture into bands; every band has the same number of rows, an even power of
/// two, so that pairs of rows that meet in a coarser level are in one band.
#[derive(Clone, Copy, Debug, Default)]
struct Bands {
    shift: u32,
    count: usize,
}

impl Bands {
    fn new(width: usize, height: usize) -> Self {
        let rows = (BAND / width).min(height / BANDS).max(2);
        let shift = rows.ilog2();
        Self { shift, count: height.div_ceil(1 << shift) }
    }

    fn rows(&self) -> usize {
        1 << self.shift
    }
}

impl Points {
    /// Finds and sorts the points of a scene's surfels.
    pub(crate) fn find(
        &mut self,
        surfels: &Surfels,
        lens: &PointProjector<f32>,
        exec: &Exec,
    ) -> Tally {
        let n = surfels.len();
        let [width, height] =
            [lens.view.width, lens.view.height].map_inline(|n| n.to_pixel() as usize);
        self.bands = Bands::new(width, height);
        let bounds = self.bands.count + 1;
        // The arrays may be longer than needed, so that they need not be cleared for every picture.
        if self.keys.len() < n {
            self.keys.resize(n, PointKey::default());
            self.carried.resize(n, [0.0; 4]);
        }
        self.starts.resize(n.div_ceil(CHUNK) * bounds, 0);
        let slots = self.keys[..n].chunks_mut(CHUNK).zip(self.carried[..n].chunks_mut(CHUNK));
        let jobs = slots.zip(self.starts.chunks_mut(bounds)).enumerate().collect();
        let (bands, spare) = (self.bands, &self.spare);
        let spare = || spare.lock().unwrap_or_else(PoisonError::into_inner);
        let tallies = exec.ordered(jobs, |(index, ((keys, carried), starts))| {
            spend(Work::Project);
            let mut chunk = spare().pop().unwrap_or_else(Chunk::new);
            let range = index * CHUNK..n.min((index + 1) * CHUNK);
            let (count, tally) = points(surfels, lens, range, bands, &mut chunk);
            chunk.sort(count, starts);
            // Copied in order, which is faster than sorting into far memory.
            keys[..count].copy_from_slice(&chunk.keys[..count]);
            carried[..count].copy_from_slice(&chunk.carried[..count]);
            spare().push(chunk);
            tally
        });
        tallies.iter().fold(Tally::default(), |sum, tally| sum.plus(tally))
    }

    /// Rows of a band.
    pub(super) fn rows(&self) -> usize {
        self.bands.rows()
    }

    /// The slots of the points of a band, chunk by chunk.
    pub(super) fn slots(&self, band: usize) -> impl Iterator<Item = Range<usize>> {
        let chunks = self.starts.chunks(self.bands.count + 1);
        (0..).step_by(CHUNK).zip(chunks).map(move |(first, starts)| {
            first + starts[band] as usize..first + starts[band + 1] as usize
        })
    }
}

/// A chunk of surfels while it becomes points; it fits a second-level cache.
#[derive(Debug)]
struct Chunk {
    /// The blocks of all surfels, seen or not.
    blocks: Vec<PointBlock>,
    /// The surfels that are seen, ascending; the rest is ignored.
    seen: Vec<u16>,
    /// The next slot of each band.
    next: Vec<u32>,
    /// The points that [`Chunk::sort`] has sorted.
    keys: Vec<PointKey>,
    carried: Vec<[f32; 4]>,
}

/// [`LANES`] surfels.
#[derive(Clone, Copy, Debug)]
struct PointBlock {
    place: [u32; LANES],
    order: [u32; LANES],
    band: [u32; LANES],
    carried: [Lanes; 4],
}

impl Chunk {
    fn new() -> Self {
        let empty = PointBlock {
            place: [0; LANES],
            order: [0; LANES],
            band: [0; LANES],
            carried: [[0.0; LANES]; 4],
        };
        Self {
            blocks: vec![empty; CHUNK / LANES],
            seen: vec![0; CHUNK + LANES],
            next: Vec::new(),
            keys: vec![PointKey::default(); CHUNK],
            carried: vec![[0.0; 4]; CHUNK],
        }
    }

    /// Sorts the first `count` seen surfels by bands, and writes the start of each band, and the
    /// end of the last.
    fn sort(&mut self, count: usize, starts: &mut [u32]) {
        let place = |&i: &u16| (usize::from(i) / LANES, usize::from(i) % LANES);
        let seen = self.seen[..count].iter().map(place);
        // Counting sort: the counts are stored one place late, so that their sums become starts.
        starts.fill(0);
        for (block, lane) in seen.clone() {
            starts[self.blocks[block].band[lane] as usize + 1] += 1;
        }
        for band in 1..starts.len() {
            starts[band] += starts[band - 1];
        }
        self.next.clear();
        self.next.extend_from_slice(starts);
        for (block, lane) in seen {
            let block = &self.blocks[block];
            let next = &mut self.next[block.band[lane] as usize];
            let (key, carried) =
                (&mut self.keys[*next as usize], &mut self.carried[*next as usize]);
            *key = PointKey { place: block.place[lane], order: block.order[lane] };
            for (to, from) in carried.iter_mut().zip(&block.carried) {
                *to = from[lane];
            }
            *next += 1;
        }
    }
}

vectorized!(
    /// Decides the fates of a range of surfels: fills `chunk` except for the sorted points, and
    /// returns how many are seen.
    fn points(
        surfels: &Surfels,
        lens: &PointProjector<f32>,
        range: Range<usize>,
        bands: Bands,
        chunk: &mut Chunk,
    ) -> (usize, Tally) {
        // A copy, so that the compiler knows that no write changes it.
        let lens = &{ *lens };
        let (p, last_p) = surfels.position()[range.clone()].as_chunks();
        let (n, last_n) = surfels.normal()[range.clone()].as_chunks();
        let (r, last_r) = surfels.radius()[range.clone()].as_chunks();
        let (mut count, mut fates) = (0, Fates::default());
        for (index, block) in chunk.blocks[..p.len()].iter_mut().enumerate() {
            let surfels = SurfelLanes { position: &p[index], normal: &n[index], radius: &r[index] };
            let visible = block.fill(surfels, index, lens, bands, &mut fates);
            count += note(&visible, index, &mut chunk.seen[count..]);
        }
        let rest = last_p.len();
        if rest > 0 {
            // Lanes without a surfel repeat the last surfel, and are not counted.
            let (index, at) = (p.len(), std::array::from_fn(|i: usize| i.min(rest - 1)));
            let last = SurfelLanes {
                position: &at.map_inline(|i| last_p[i]),
                normal: &at.map_inline(|i| last_n[i]),
                radius: &at.map_inline(|i| last_r[i]),
            };
            let mut own = Fates::default();
            let mut visible = chunk.blocks[index].fill(last, index, lens, bands, &mut own);
            visible[rest..].fill(0);
            fates.add(&own, rest);
            count += note(&visible, index, &mut chunk.seen[count..]);
        }
        (count, fates.tally(range.len(), count))
    }
);

/// Notes the surfels of a block that are visible, and returns how many.
#[inline(always)]
fn note(visible: &[u32; LANES], block: usize, seen: &mut [u16]) -> usize {
    // Written whether the surfel is seen or not, and kept only if it is, so that there is no branch
    // to mispredict.
    let seen = &mut seen[..LANES];
    let mut count = 0;
    for i in 0..LANES {
        seen[count] = (block * LANES + i) as u16;
        count += visible[i] as usize;
    }
    count
}

/// The surfels of a block, lane by lane.
#[derive(Clone, Copy)]
struct SurfelLanes<'a> {
    position: &'a [Vec3; LANES],
    normal: &'a [Vec3; LANES],
    radius: &'a Lanes,
}

impl PointBlock {
    /// Fills the block with this index from surfels. Returns which surfels are
    /// visible: 1, else 0.
    #[inline(always)]
    fn fill(
        &mut self,
        SurfelLanes { position: p, normal: n, radius }: SurfelLanes<'_>,
        index: usize,
        lens: &PointProjector<f32>,
        bands: Bands,
        fates: &mut Fates,
    ) -> [u32; LANES] {
        let (width, shift, row) =
            (lens.view.width.to_pixel(), bands.shift, bands.rows() as u32 - 1);
        let (mut visible, mut place) = ([0; LANES], [0; LANES]);
        let (mut orders, mut band) = ([0; LANES], [0; LANES]);
        let mut carried = [[0.0; LANES]; 4];
        for i in 0..LANES {
            let n = lens.view.direction(Vector3::from_glam(n[i]));
            let (placed, g, fate) = lens.fate(Vector3::from_glam(p[i]), n);
            visible[i] = u32::from(fate == Fate::Visible);
            fates.behind[i] += u32::from(fate == Fate::Behind);
            fates.degenerate[i] += u32::from(fate == Fate::Degenerate);
            fates.back_facing[i] += u32::from(fate == Fate::BackFacing);
            let sample = lens.sample(0, &placed, n, g, radius[i], [0.0; 3]);
            let (x, y) = (sample.center.x.to_pixel(), sample.center.y.to_pixel());
            place[i] = ((y & row) * width + x) << SURFEL_BITS | (index * LANES + i) as u32;
            orders[i] = order(sample.depth);
            band[i] = y >> shift;
            (carried[0][i], carried[1][i]) = (sample.normal.x, sample.normal.y);
            (carried[2][i], carried[3][i]) = (sample.normal.z, sample.radius);
        }
        (self.place, self.order) = (place, orders);
        (self.band, self.carried) = (band, carried);
        visible
    }
}

/// How many surfels of each lane are not seen, by reason.
#[derive(Clone, Copy, Debug, Default)]
struct Fates {
    behind: [u32; LANES],
    degenerate: [u32; LANES],
    back_facing: [u32; LANES],
}

impl Fates {
    /// Adds the counts of the first lanes.
    fn add(&mut self, other: &Self, lanes: usize) {
        for i in 0..lanes {
            self.behind[i] += other.behind[i];
            self.degenerate[i] += other.degenerate[i];
            self.back_facing[i] += other.back_facing[i];
        }
    }

    /// The tally of `all` surfels, of which `visible` are visible.
    fn tally(&self, all: usize, visible: usize) -> Tally {
        let sum = |of: &[u32; LANES]| of.iter().map(|&n| u64::from(n)).sum::<u64>();
        let visible = visible as u64;
        let [behind, degenerate, back_facing] =
            [sum(&self.behind), sum(&self.degenerate), sum(&self.back_facing)];
        let outside = all as u64 - (visible + behind + degenerate + back_facing);
        Tally { visible, behind, degenerate, back_facing, outside }
    }
}
