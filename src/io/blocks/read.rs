//! Read a file of blocks; see the [module](super).

use super::index::{Block, DAMAGED, Index, Kind, NOWHERE, Record, START, widened};
use crate::error::{Error, Result};
use crate::frame::{Exec, Rect};
use crate::io::{checksum, input};
use crate::memory;
use crate::method::part::{Nearby, Part};
use crate::scene::{Camera, Cloud, Excerpt, Surfels};
use glam::{DVec3, Vec3};
use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Why a file is refused that is not the one whose index was read.
const CHANGED: &str =
    "the file was replaced or truncated since it was opened; run the command again";

/// A folder of blocks. Its index is in memory; blocks are read on demand.
#[derive(Clone, Debug)]
pub struct Blocks {
    path: PathBuf,
    length: u64,
    pub(super) index: Index,
}

impl Blocks {
    /// The file in a folder.
    pub(super) fn path(folder: &Path) -> PathBuf {
        folder.join("blocks")
    }

    /// Whether a folder holds blocks.
    #[must_use]
    pub fn is_in(folder: &Path) -> bool {
        Self::path(folder).is_file()
    }

    /// Reads the index of a folder.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be read; [`Error::Format`] if the file is damaged or truncated, or if
    /// the process may not hold its index.
    pub fn open(folder: &Path) -> Result<Self> {
        let path = Self::path(folder);
        let io = |source| Error::io(&path, source);
        let format = |what: String| Error::format(&path, what);
        let (mut file, length) = input::open(&path).map_err(io)?;
        let mut bytes = vec![0; START];
        if length < START as u64 {
            return Err(format(format!("the file is truncated after {length} bytes")));
        }
        file.read_exact(&mut bytes).map_err(io)?;
        let size = Index::size(&bytes).map_err(format)?;
        if size > length {
            return Err(format(format!("the file is truncated after {length} bytes")));
        }
        memory::try_ask(3 * size, || "the index".to_owned()).map_err(format)?;
        bytes.resize(size as usize, 0);
        file.read_exact(&mut bytes[START..]).map_err(io)?;
        let index = Index::from_bytes(&bytes, length).map_err(format)?;
        Ok(Self { path, length, index })
    }

    /// How many surfels there are.
    #[must_use]
    pub fn surfels(&self) -> u64 {
        self.index.count.into()
    }

    /// How many blocks there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.index.blocks.len()
    }

    /// What was subtracted from the positions, see [`Cloud::offset`].
    pub(in crate::io) fn offset(&self) -> DVec3 {
        self.index.offset
    }

    /// The corners of the box around all positions.
    pub(in crate::io) fn bounds(&self) -> (Vec3, Vec3) {
        self.index.bounds
    }

    /// Reads all surfels, in the order of the file that was tiled.
    ///
    /// # Errors
    /// [`Error::Io`] if they cannot be read; [`Error::Format`] if a block is damaged, if the file was
    /// replaced since it was opened, or if the process may not hold them.
    pub fn read(&self) -> Result<Cloud> {
        let (cloud, ids) = self.some(None)?;
        // The ids ascend, so the first and the last tell that all are there.
        if ids.last().is_none_or(|&last| u64::from(last) + 1 != self.surfels()) {
            return Err(Error::format(&self.path, DAMAGED));
        }
        Ok(Cloud { offset: self.index.offset, ..cloud })
    }

    /// No surfels, of a scene with all surfels.
    pub(in crate::io) fn nothing(&self, exec: &Exec) -> Result<(Surfels, Excerpt)> {
        self.excerpt(self.index.kind.arrays(0), Vec::new(), exec)
    }

    /// The surfels that may touch a region of a camera's picture, and more; `skirt` is
    /// [`Method::skirt`](crate::method::Method::skirt).
    pub(in crate::io) fn near(
        &self,
        camera: &Camera,
        region: Rect,
        skirt: f64,
        exec: &Exec,
    ) -> Result<(Surfels, Excerpt)> {
        let pieces = [(0, region)];
        let nearby =
            Nearby::new(Part { pieces: &pieces, spread: 1.0, around: None }, camera, skirt);
        let (cloud, ids) = self.some(Some(&nearby))?;
        self.excerpt(cloud, ids, exec)
    }

    /// The most surfels that [`Blocks::near`] reads, and the bytes that it needs for them.
    pub(in crate::io) fn most_near(&self, camera: &Camera, region: Rect, skirt: f64) -> (u64, u64) {
        let pieces = [(0, region)];
        let nearby =
            Nearby::new(Part { pieces: &pieces, spread: 1.0, around: None }, camera, skirt);
        let count = self.most(Some(&nearby));
        (count, count * self.of_a_surfel())
    }

    /// How many surfels the blocks have that may hold any that is near, or all blocks.
    fn most(&self, nearby: Option<&Nearby<'_>>) -> u64 {
        let blocks = self.index.blocks.iter().filter(|block| may_hold(nearby, block));
        blocks.map(|block| u64::from(block.count)).sum()
    }

    /// Bytes of a surfel, of its place in the order, and of one more array while it is sorted.
    fn of_a_surfel(&self) -> u64 {
        self.index.kind.size() as u64 + 32
    }

    /// The surfels with these indices, as a part of the whole.
    fn excerpt(&self, cloud: Cloud, ids: Vec<u32>, exec: &Exec) -> Result<(Surfels, Excerpt)> {
        let Index { median_radius, sphere, bounds, hash, .. } = &self.index;
        let surfels = Surfels::part_of(cloud, *median_radius, *sphere, exec)?;
        let surfels = surfels.ok_or_else(|| {
            Error::format(
                &self.path,
                "a block holds a point that is no surfel; rerun `splatref tile`",
            )
        })?;
        let (total, hash) = (self.surfels(), hash.clone());
        Ok((surfels, Excerpt { ids, total, bounds: *bounds, hash }))
    }

    /// The surfels that are near, or all, and their indices, which ascend.
    fn some(&self, nearby: Option<&Nearby<'_>>) -> Result<(Cloud, Vec<u32>)> {
        let format = |what: &str| Error::format(&self.path, what);
        let Index { kind, blocks, .. } = &self.index;
        let most = self.most(nearby);
        let cure = "draw smaller parts (--bands auto or --region)";
        memory::try_ask_or(most * self.of_a_surfel(), || format!("a part of {most} surfels"), cure)
            .map_err(Error::Invalid)?;
        // Arrays that grow would take up to three times as much while they are copied.
        let mut cloud = kind.arrays(most as usize);
        let mut ids = Vec::with_capacity(most as usize);
        let mut file = self.reopened()?;
        let mut at = self.length - self.body();
        let mut bytes = Vec::new();
        for block in blocks {
            let size = self.index.bytes(block);
            if may_hold(nearby, block) {
                bytes.resize(size as usize, 0);
                let read = file.seek(SeekFrom::Start(at)).and_then(|_| file.read_exact(&mut bytes));
                read.map_err(|source| match source.kind() {
                    // The length was right when the file was opened.
                    ErrorKind::UnexpectedEof => format(CHANGED),
                    _ => Error::io(&self.path, source),
                })?;
                let surfels = checksum::open(&bytes).ok_or_else(|| format(DAMAGED))?;
                let put = &mut |some: &[u8]| kind.append(some, &mut cloud, &mut ids);
                match nearby {
                    Some(nearby) => choose(nearby, surfels, block, *kind, put),
                    None => put(surfels),
                }
            }
            at += size;
        }
        drop(bytes);
        let ids = sort(&mut cloud, ids);
        if !ids.is_sorted_by(|a, b| a < b) || ids.last().is_some_and(|&id| id >= self.index.count) {
            return Err(format(DAMAGED));
        }
        Ok((cloud, ids))
    }

    /// Bytes of all blocks.
    fn body(&self) -> u64 {
        self.index.blocks.iter().map(|block| self.index.bytes(block)).sum()
    }

    /// Opens the file again, and checks that it is the same one.
    fn reopened(&self) -> Result<File> {
        let io = |source| Error::io(&self.path, source);
        let (mut file, length) = input::open(&self.path).map_err(io)?;
        let mut sum = [0; checksum::BYTES];
        if length == self.length {
            file.seek(SeekFrom::Start(length - self.body() - checksum::BYTES as u64))
                .map_err(io)?;
            file.read_exact(&mut sum).map_err(io)?;
        }
        if length != self.length || sum != self.index.sum {
            return Err(Error::format(&self.path, CHANGED));
        }
        Ok(file)
    }
}

/// Whether a block may hold surfels that are near.
fn may_hold(nearby: Option<&Nearby<'_>>, block: &Block) -> bool {
    nearby.is_none_or(|near| near.holds_any(block.bounds, block.reach.into()))
}

/// How many surfels of a block are looked at together; they lie near each other.
const RUN: usize = 64;

/// Puts the surfels of a block that are near, and more: surfels one by one only where a run of them is
/// neither inside nor beside the region.
fn choose(
    nearby: &Nearby<'_>,
    surfels: &[u8],
    block: &Block,
    kind: Kind,
    put: &mut dyn FnMut(&[u8]),
) {
    if nearby.covers(block.bounds) {
        return put(surfels);
    }
    let size = kind.size();
    for run in surfels.chunks(RUN * size) {
        let positions = kind.records(run).map(Record::position);
        let bounds = positions.fold(NOWHERE, widened);
        if nearby.covers(bounds) {
            put(run);
        } else if nearby.holds_any(bounds, block.reach.into()) {
            let records = kind.records(run).zip(run.chunks(size));
            let near = records.filter(|(one, _)| nearby.holds_one(one.position(), one.reach()));
            near.for_each(|(_, bytes)| put(bytes));
        }
    }
}

/// Sorts surfels by their indices, one array after the other.
fn sort(cloud: &mut Cloud, mut ids: Vec<u32>) -> Vec<u32> {
    fn sorted<T: Copy>(values: &mut Vec<T>, order: &[u32]) {
        *values = order.iter().map(|&i| values[i as usize]).collect();
    }
    // Each number holds an index and its place, so that sorting looks at no other array.
    let pair = |(&id, place): (&u32, u64)| u64::from(id) << 32 | place;
    let mut pairs: Vec<u64> = ids.iter().zip(0..).map(pair).collect();
    pairs.sort_unstable();
    let order: Vec<u32> = pairs.iter().map(|pair| *pair as u32).collect();
    drop(pairs);
    sorted(&mut ids, &order);
    sorted(&mut cloud.position, &order);
    cloud.normal.iter_mut().for_each(|all| sorted(all, &order));
    cloud.radius.iter_mut().for_each(|all| sorted(all, &order));
    cloud.color.iter_mut().for_each(|all| sorted(all, &order));
    cloud.opacity.iter_mut().for_each(|all| sorted(all, &order));
    cloud.tangents.iter_mut().for_each(|all| sorted(all, &order));
    ids
}
