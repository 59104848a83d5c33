//! The index of a file of blocks, and the bytes of a surfel; see the [module](super).

use super::SURFELS;
use crate::io::hierarchy::bytes::{Reader, Writer};
use crate::io::{Reason, checksum};
use crate::number::Real;
use crate::scene::{Cloud, Sphere, Surfels};
use glam::{DVec3, Vec3};
use sha2::Sha256;
use sha2::digest::common::hazmat::{SerializableState, SerializedState};

const MAGIC: &[u8; 16] = b"splatref tile 1\n";
/// Bytes up to the state of the hash.
pub(super) const START: usize = 116;
/// Bytes of a block in the index.
const OF_A_BLOCK: u64 = 32;

/// Which attributes surfels have beside position, normal and radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kind {
    pub(super) color: bool,
    pub(super) opacity: bool,
    pub(super) tangents: bool,
}

/// A block: how many surfels it has, and where they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Block {
    pub(super) count: u32,
    pub(super) bounds: [Vec3; 2],
    pub(super) reach: f32,
}

/// What is known of a scene without reading a block.
#[derive(Clone, Debug)]
pub(super) struct Index {
    pub(super) count: u32,
    pub(super) kind: Kind,
    pub(super) median_radius: f32,
    pub(super) bounds: (Vec3, Vec3),
    pub(super) sphere: Sphere,
    pub(super) offset: DVec3,
    pub(super) hash: Sha256,
    pub(super) blocks: Vec<Block>,
    /// The checksum, which tells this file from another one.
    pub(super) sum: [u8; checksum::BYTES],
}

impl Index {
    /// The bytes, with the checksum.
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let mut to = Writer::default();
        let state = self.hash.serialize();
        let Kind { color, opacity, tangents } = self.kind;
        let kind = u32::from(color) + 2 * u32::from(opacity) + 4 * u32::from(tangents);
        to.bytes(MAGIC);
        to.words(&[self.count, self.blocks.len() as u32, kind, state.len() as u32]);
        to.float(self.median_radius);
        to.vector(self.bounds.0);
        to.vector(self.bounds.1);
        let sphere = self.sphere.center.to_array().into_iter().chain([self.sphere.radius]);
        sphere.chain(self.offset.to_array()).for_each(|number| to.double(number));
        to.bytes(&state);
        for Block { count, bounds: [low, high], reach } in &self.blocks {
            to.words(&[*count]);
            to.vector(*low);
            to.vector(*high);
            to.float(*reach);
        }
        checksum::seal(to.0)
    }

    /// How many bytes the index has, from its first [`START`] bytes.
    pub(super) fn size(start: &[u8]) -> Reason<u64> {
        if start.first_chunk() != Some(MAGIC) {
            return Err("not a file of blocks of splatref".into());
        }
        let [_, blocks, _, state] = Reader(&start[MAGIC.len()..]).words()?;
        let sum = checksum::BYTES as u64;
        Ok(START as u64 + u64::from(state) + u64::from(blocks) * OF_A_BLOCK + sum)
    }

    /// Reads the index of a file of `length` bytes.
    pub(super) fn from_bytes(bytes: &[u8], length: u64) -> Reason<Self> {
        let mut from = Reader(checksum::open(bytes).ok_or(DAMAGED)?);
        from.take::<16>()?;
        let [count, blocks, kind, state] = from.words()?;
        let kind = Kind { color: kind & 1 != 0, opacity: kind & 2 != 0, tangents: kind & 4 != 0 };
        let median_radius = from.float()?;
        let bounds = (from.vector()?, from.vector()?);
        let sphere = Sphere { center: from.position()?, radius: from.double()? };
        let offset = from.position()?;
        let (state, rest) = from.0.split_at_checked(state as usize).ok_or(DAMAGED)?;
        from = Reader(rest);
        let hash = SerializedState::<Sha256>::try_from(state)
            .ok()
            .and_then(|state| Sha256::deserialize(&state).ok())
            .ok_or("another version of splatref wrote this file; rerun `splatref tile`")?;
        let blocks = (0..blocks).map(|_| block(&mut from)).collect::<Reason<Vec<_>>>()?;
        let sum = bytes.last_chunk().copied().unwrap_or_default();
        let index = Self { count, kind, median_radius, bounds, sphere, offset, hash, blocks, sum };
        index.check(bytes.len() as u64, length)?;
        Ok(index)
    }

    fn check(&self, own: u64, length: u64) -> Reason<()> {
        let total: u64 = self.blocks.iter().map(|block| u64::from(block.count)).sum();
        let sound = |block: &Block| (1..=SURFELS as u32).contains(&block.count);
        let numbers = [self.sphere.radius, f64::from(self.median_radius)];
        let finite = numbers.iter().all(|n| n.is_finite())
            && self.sphere.center.is_finite()
            && self.offset.is_finite()
            && self.bounds.0.is_finite()
            && self.bounds.1.is_finite();
        if total != u64::from(self.count) || total == 0 || !finite || !self.blocks.iter().all(sound)
        {
            return Err("the index contradicts itself; rerun `splatref tile`".into());
        }
        let expected = own + self.blocks.iter().map(|block| self.bytes(block)).sum::<u64>();
        if expected != length {
            return Err(format!(
                "{total} surfels need {expected} bytes, but the file has {length}: it is truncated, or \
                 a part of another file; rerun `splatref tile`"
            ));
        }
        Ok(())
    }

    /// The bytes of a block in the file.
    pub(super) fn bytes(&self, block: &Block) -> u64 {
        u64::from(block.count) * self.kind.size() as u64 + checksum::BYTES as u64
    }
}

/// Why a part of a file is refused.
pub(super) const DAMAGED: &str = "damaged: a checksum is wrong; rerun `splatref tile`";

fn block(from: &mut Reader<'_>) -> Reason<Block> {
    let count = from.word()?;
    Ok(Block { count, bounds: [from.vector()?, from.vector()?], reach: from.float()? })
}

impl Kind {
    /// The bytes of a surfel.
    pub(super) fn size(self) -> usize {
        let Self { color, opacity, tangents } = self;
        32 + 12 * usize::from(color) + 4 * usize::from(opacity) + 24 * usize::from(tangents)
    }

    /// Writes surfel `i` of `surfels`, which has the index `id` in the scene.
    pub(super) fn put(self, to: &mut Writer, surfels: &Surfels, i: usize, id: u32) {
        to.words(&[id]);
        to.vector(surfels.position()[i]);
        to.vector(surfels.normal()[i]);
        to.float(surfels.radius()[i]);
        surfels.color().into_iter().for_each(|all| to.vector(all[i]));
        surfels.opacity().into_iter().for_each(|all| to.float(all[i]));
        surfels.tangents().into_iter().flat_map(|all| all[i]).for_each(|half| to.vector(half));
    }

    /// The surfels in these bytes; a part of one at the end is left out.
    pub(super) fn records(self, bytes: &[u8]) -> impl Iterator<Item = Record<'_>> {
        let words = bytes.as_chunks().0.chunks_exact(self.size() / 4);
        words.map(move |words| Record { words, kind: self })
    }

    /// Appends the surfels in these bytes to the arrays that `cloud` has, one array after the other, and
    /// their indices to `ids`.
    pub(super) fn append(self, bytes: &[u8], cloud: &mut Cloud, ids: &mut Vec<u32>) {
        let all = || self.records(bytes);
        let opacity = 8 + 3 * usize::from(self.color);
        ids.extend(all().map(Record::id));
        cloud.position.extend(all().map(Record::position));
        cloud.normal.iter_mut().for_each(|to| to.extend(all().map(|one| one.vector(4))));
        cloud.radius.iter_mut().for_each(|to| to.extend(all().map(Record::radius)));
        cloud.color.iter_mut().for_each(|to| to.extend(all().map(|one| one.vector(8))));
        cloud.opacity.iter_mut().for_each(|to| to.extend(all().map(|one| one.float(opacity))));
        cloud.tangents.iter_mut().for_each(|to| to.extend(all().map(Record::tangents)));
    }

    /// Arrays for surfels of this kind, with room for `count`.
    pub(super) fn arrays(self, count: usize) -> Cloud {
        Cloud {
            position: Vec::with_capacity(count),
            normal: Some(Vec::with_capacity(count)),
            radius: Some(Vec::with_capacity(count)),
            color: self.color.then(|| Vec::with_capacity(count)),
            opacity: self.opacity.then(|| Vec::with_capacity(count)),
            tangents: self.tangents.then(|| Vec::with_capacity(count)),
            ..Cloud::default()
        }
    }
}

/// The bounds of no surfel.
pub(super) const NOWHERE: [Vec3; 2] = [Vec3::INFINITY, Vec3::NEG_INFINITY];

/// Bounds around a position, too.
#[inline]
pub(super) fn widened([low, high]: [Vec3; 2], position: Vec3) -> [Vec3; 2] {
    [low.min(position), high.max(position)]
}

/// A surfel of a block: numbers of four bytes.
#[derive(Clone, Copy)]
pub(super) struct Record<'a> {
    words: &'a [[u8; 4]],
    kind: Kind,
}

impl Record<'_> {
    #[inline]
    fn float(self, at: usize) -> f32 {
        f32::from_le_bytes(self.words[at])
    }

    #[inline]
    fn vector(self, at: usize) -> Vec3 {
        Vec3::new(self.float(at), self.float(at + 1), self.float(at + 2))
    }

    #[inline]
    fn id(self) -> u32 {
        u32::from_le_bytes(self.words[0])
    }

    #[inline]
    pub(super) fn position(self) -> Vec3 {
        self.vector(1)
    }

    #[inline]
    fn radius(self) -> f32 {
        self.float(7)
    }

    #[inline]
    fn tangents(self) -> [Vec3; 2] {
        let at = self.words.len() - 6;
        [self.vector(at), self.vector(at + 3)]
    }

    /// How far it reaches in any method: some draw an ellipse as a disc.
    #[inline]
    pub(super) fn reach(self) -> f64 {
        let radius = f64::from(self.radius());
        if !self.kind.tangents {
            return radius;
        }
        let [u, v] = self.tangents();
        let [u, v] = [u.as_dvec3(), v.as_dvec3()];
        radius.at_least((u.length_squared() + v.length_squared()).sqrt())
    }
}
