//! Write a file of blocks; see the [module](super).

use super::SURFELS;
use super::index::{Block, Index, Kind, NOWHERE, widened};
use super::input::Input;
use super::read::Blocks;
use super::sort::Sorter;
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::grouping::interleaved;
use crate::io::checksum;
use crate::io::hierarchy::Hierarchy;
use crate::io::hierarchy::bytes::Writer;
use crate::io::replace::{NewFolder, write_atomically};
use crate::memory;
use crate::number::{MapInline, Real};
use crate::progress::Progress;
use crate::scene::{Sphere, hash};
use glam::Vec3;
use sha2::Sha256;
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

/// The report of [`SceneFile::tile`](crate::io::scene_file::SceneFile::tile).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiled {
    /// How many surfels the folder has.
    pub surfels: u64,
    /// How many points of the file are no surfels, and were dropped.
    pub dropped: u64,
    /// How many blocks there are.
    pub blocks: u64,
}

/// Writes surfels into a folder, in spatial order, see
/// [`SceneFile::tile`](crate::io::scene_file::SceneFile::tile). `None` if there are none.
pub(in crate::io) fn build(
    input: &mut Input,
    folder: &Path,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Option<Tiled>> {
    if Hierarchy::is_in(folder) {
        let what = "the folder holds a hierarchy of `splatref surfels`; give another name";
        return Err(Error::format(folder, what));
    }
    let whole = measure(input, exec, progress)?;
    if whole.count == 0 {
        return Ok(None);
    }
    if whole.count >= u64::from(u32::MAX) {
        let what = format!("{} surfels, but ids have 32 bits: split the scene", whole.count);
        return Err(Error::Invalid(what));
    }
    let _goes_if_empty = NewFolder::make(folder)?;
    sort_into(input, whole, folder, exec, progress).map(Some)
}

/// Sorts the surfels in a temporary file in the folder, and writes the blocks.
fn sort_into(
    input: &mut Input,
    whole: Whole,
    folder: &Path,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Tiled> {
    let kind = input.kind();
    let budget = (memory::left() / 2).clamp(LEAST, MOST);
    memory::ask(budget, || "sorting surfels".to_owned())?;
    let mut sorter = Sorter::new(folder, kind.size(), budget as usize)
        .map_err(|source| Error::io(folder, source))?;
    let index = survey(input, whole, &mut sorter, folder, exec, progress)?;
    let index = index.ok_or_else(|| {
        Error::Invalid("the scene changed while it was read; run the command again".into())
    })?;
    let report = Tiled {
        surfels: index.count.into(),
        dropped: input.most() - u64::from(index.count),
        blocks: index.count.div_ceil(SURFELS as u32).into(),
    };
    write_atomically(&Blocks::path(folder), |to| write(to, index, sorter, progress))?;
    Ok(report)
}

/// The least and the most memory for sorting.
const LEAST: u64 = 1 << 21;
const MOST: u64 = 1 << 29;

/// What the first pass finds.
struct Whole {
    count: u64,
    low: Vec3,
    high: Vec3,
    /// How many radii have these 16 highest bits.
    radii: Vec<u64>,
}

/// The first pass: counts surfels and finds their box.
fn measure(input: &mut Input, exec: &Exec, progress: Progress<'_>) -> Result<Whole> {
    let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let mut whole = Whole { count: 0, low: none.0, high: none.1, radii: vec![0; 1 << 16] };
    let total = input.most();
    let mut read = 0;
    input.each(exec, &mut |surfels| {
        progress("reading", read, total);
        if !surfels.is_empty() {
            let (low, high) = surfels.bounds();
            (whole.low, whole.high) = (whole.low.min(low), whole.high.max(high));
        }
        whole.count += surfels.len() as u64;
        read += surfels.len() as u64;
        surfels.radius().iter().for_each(|r| whole.radii[(r.to_bits() >> 16) as usize] += 1);
        Ok(())
    })?;
    Ok(whole)
}

/// The passes after it: sorts the surfels, and finds everything else about the whole. `None` if the
/// file has other surfels than before.
fn survey(
    input: &mut Input,
    whole: Whole,
    sorter: &mut Sorter,
    folder: &Path,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Option<Index>> {
    let Whole { count, low, high, radii } = whole;
    let kind = input.kind();
    let middle = (low.as_dvec3() + high.as_dvec3()) / 2.0;
    let mut hash = hash::begin(count);
    let mut median = Median::new(radii, (count - 1) / 2);
    let (mut far, mut id) = (0.0_f64, 0_u32);
    let mut record = Writer::default();
    input.each(exec, &mut |surfels| {
        progress("sorting", id.into(), count);
        hash::part(&mut hash, 0, &surfels);
        let reach = surfels.reach(middle);
        far = if reach > far { reach } else { far };
        surfels.radius().iter().for_each(|&radius| median.count(radius));
        for (i, position) in surfels.position().iter().enumerate() {
            record.0.clear();
            kind.put(&mut record, &surfels, i, id);
            // The last id fits, because the vertices do.
            id = id.wrapping_add(1);
            let put = |to: &mut Vec<u8>| to.extend_from_slice(&record.0);
            sorter.push(key(*position, low, high), put).map_err(|e| Error::io(folder, e))?;
        }
        Ok(())
    })?;
    if u64::from(id) != count {
        return Ok(None);
    }
    hash_rest(input, &mut hash, kind, exec, progress)?;
    Ok(Some(Index {
        count: id,
        kind,
        median_radius: median.found(),
        bounds: (low, high),
        sphere: Sphere { center: middle, radius: far },
        offset: input.offset(),
        hash,
        blocks: Vec::new(),
        sum: Default::default(),
    }))
}

/// Hashes all attributes after the positions, one after the other, as the hash of a scene does.
fn hash_rest(
    input: &mut Input,
    hash: &mut Sha256,
    kind: Kind,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<()> {
    let there = [kind.color, kind.opacity, kind.tangents];
    for attribute in 1..hash::ATTRIBUTES {
        progress("hashing", attribute as u64, hash::ATTRIBUTES as u64);
        hash::head(hash, attribute, there);
        if attribute < 3 || there[attribute - 3] {
            input.each(exec, &mut |surfels| {
                hash::part(hash, attribute, &surfels);
                Ok(())
            })?;
        }
    }
    Ok(())
}

/// The place of a position on the Morton curve of a box.
fn key(position: Vec3, low: Vec3, high: Vec3) -> u64 {
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    let side = (high - low).max_element();
    let cell = |v: f64| {
        // All positions may be one place.
        let at = if side > 0.0 { (v / side * f64::from(1 << BITS)).floor() } else { 0.0 };
        // The cast turns numbers below 0 into 0.
        (at as u64).min((1 << BITS) - 1)
    };
    interleaved((position.as_dvec3() - low).to_array().map_inline(cell))
}

/// Bits of a key for each axis.
const BITS: u32 = 21;

/// The number of a rank among positive floats, of which every one is seen twice: once by its highest
/// 16 bits, then by its lowest.
struct Median {
    high: u32,
    rank: u64,
    low: Vec<u64>,
}

impl Median {
    /// The number of this rank; `high` has how many numbers have which highest bits.
    fn new(high: Vec<u64>, rank: u64) -> Self {
        let (high, rank) = at_rank(&high, rank);
        Self { high, rank, low: vec![0; 1 << 16] }
    }

    fn count(&mut self, number: f32) {
        let bits = number.to_bits();
        if bits >> 16 == self.high {
            self.low[(bits & 0xFFFF) as usize] += 1;
        }
    }

    fn found(&self) -> f32 {
        f32::from_bits(self.high << 16 | at_rank(&self.low, self.rank).0)
    }
}

/// The class in which the number of a rank is, and its rank there.
fn at_rank(counts: &[u64], mut rank: u64) -> (u32, u64) {
    for (class, &count) in (0..).zip(counts) {
        if rank < count {
            return (class, rank);
        }
        rank -= count;
    }
    (0, 0)
}

/// Writes the blocks behind room for the index, and then the index.
fn write(
    to: &mut BufWriter<File>,
    mut index: Index,
    sorter: Sorter,
    progress: Progress<'_>,
) -> io::Result<()> {
    let count = index.count.div_ceil(SURFELS as u32) as usize;
    let none = Block { count: 0, bounds: [Vec3::ZERO; 2], reach: 0.0 };
    index.blocks = vec![none; count];
    let room = index.to_bytes().len();
    index.blocks.clear();
    to.write_all(&vec![0; room])?;
    let size = index.kind.size();
    let mut block = Vec::with_capacity(SURFELS * size);
    let kind = index.kind;
    let blocks = &mut index.blocks;
    let mut end = |block: &mut Vec<u8>| {
        progress("writing", (blocks.len() * SURFELS) as u64, index.count.into());
        blocks.push(around(block, kind));
        to.write_all(block)?;
        to.write_all(&checksum::of(block))?;
        block.clear();
        Ok(())
    };
    sorter.finish(|record| {
        block.extend_from_slice(record);
        if block.len() == SURFELS * size { end(&mut block) } else { Ok(()) }
    })?;
    if !block.is_empty() {
        end(&mut block)?;
    }
    to.seek(SeekFrom::Start(0))?;
    to.write_all(&index.to_bytes())
}

/// The bounds of the surfels of a block.
fn around(bytes: &[u8], kind: Kind) -> Block {
    let none = Block { count: 0, bounds: NOWHERE, reach: 0.0 };
    kind.records(bytes).fold(none, |block, one| Block {
        count: block.count + 1,
        bounds: widened(block.bounds, one.position()),
        reach: block.reach.at_least((one.reach() as f32).next_up()),
    })
}
