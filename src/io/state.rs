//! Store what a frame saw in a file, so that you can draw the next frame without the frames before
//! it.
//!
//! The file is little-endian, without gaps:
//!
//! ```text
//!   "splatref state 3\n"
//!   64 hexadecimal digits: the SHA-256 of the scene, of objects in frame 0, see Scene::sha256
//!   u32  the frame that saw
//!   u32  m, how many surfels share a flag
//!   u64  how many objects there are, each: u32 its surfels, u32 how many of them were selected, u32 how
//!     many u64 its flags take
//!   the flags of each object, a bit a group, the lowest bit of a u64 first; each object begins with a
//!     u64, and its last u64 is not 0
//!   u32  the CRC-32 of all bytes before, as `zlib.crc32` gives it
//! ```
//!
//! `Decided:` a scene of points that [move](crate::io::scene_file#points-that-move) has the hash of its
//! points in frame 0.
//!
//! `Decided:` a state of an older version, without a checksum, is refused, because nobody can tell
//! whether it is damaged. Write it again.

use super::replace::Pending;
use super::{checksum, input};
use crate::error::{Error, Result};
use crate::index::seen::Seen;
use crate::scene::objects::Ids;
use std::io::Write;
use std::path::Path;

const MAGIC: &[u8] = b"splatref state 3\n";
/// How earlier versions began, without a checksum.
const OLDER: &[u8] = b"splatref state 2\n";
const DIGITS: usize = 64;
const NO_STATE: &str = "not a state of splatref; give one that render --keep-state wrote";

/// The surfels that a frame saw, and the number of the frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct State {
    /// The number of the frame.
    pub frame: u32,
    /// The surfels that it saw.
    pub seen: Seen,
}

/// Writes the state of a scene to a file beside `path`, for [`Pending::put`].
///
/// # Errors
/// As [`Pending::write`].
pub fn pending(path: &Path, state: &State, scene: &str) -> Result<Pending> {
    let bytes = checksum::seal(bytes(state, scene));
    Pending::write(path, |to| to.write_all(&bytes))
}

/// The file without its checksum.
fn bytes(State { frame, seen }: &State, scene: &str) -> Vec<u8> {
    let mut to = [MAGIC, scene.as_bytes()].concat();
    to.extend(frame.to_le_bytes());
    to.extend(seen.group().to_le_bytes());
    to.extend((seen.counts().len() as u64).to_le_bytes());
    let objects = 0..seen.counts().len() as u32;
    for object in objects.clone() {
        let [count, selected] = [seen.counts(), seen.selected()].map(|of| of[object as usize]);
        for number in [count, selected, seen.words(object).len() as u32] {
            to.extend(number.to_le_bytes());
        }
    }
    objects.flat_map(|object| seen.words(object)).for_each(|word| to.extend(word.to_le_bytes()));
    to
}

/// Reads the state of a scene whose surfels have these ids.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read; [`Error::Format`] if it is no state, is damaged, or
/// belongs to another scene.
pub fn read(path: &Path, scene: &str, ids: &Ids) -> Result<State> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    let found = check(&bytes).and_then(|bytes| parse(bytes, scene, ids));
    found.map_err(|what| Error::format(path, what))
}

/// The file without its checksum, if this version wrote it and it is undamaged.
fn check(bytes: &[u8]) -> std::result::Result<&[u8], String> {
    if bytes.starts_with(OLDER) {
        let what = "an older version wrote this state, without a checksum; write it again with \
                    render --keep-state";
        return Err(what.into());
    }
    if !bytes.starts_with(MAGIC) {
        return Err(NO_STATE.into());
    }
    let checked = checksum::open(bytes);
    checked.ok_or_else(|| "damaged: its checksum is wrong; write the state again".into())
}

fn parse(bytes: &[u8], scene: &str, ids: &Ids) -> std::result::Result<State, String> {
    let rest = bytes.strip_prefix(MAGIC).ok_or(NO_STATE)?;
    let mut rest = Numbers(rest);
    if rest.take::<DIGITS>()? != scene.as_bytes() {
        return Err(
            "the state belongs to another scene; give the scene that it was made with".into()
        );
    }
    let [frame, group] = [rest.word()?, rest.word()?];
    let objects = u64::from_le_bytes(rest.take()?);
    if group == 0 || objects != ids.order().len() as u64 {
        return Err(
            "the state belongs to another scene; give the scene that it was made with".into()
        );
    }
    let (mut selected, mut lengths) = (Vec::new(), Vec::new());
    for object in 0..ids.order().len() as u32 {
        if rest.word()? != ids.all(object) {
            return Err(
                "the state belongs to another scene; give the scene that it was made with".into()
            );
        }
        selected.push(rest.word()?);
        lengths.push(rest.word()? as usize);
    }
    let mut words = Vec::with_capacity(rest.0.len() / 8);
    while !rest.0.is_empty() {
        words.push(u64::from_le_bytes(rest.take()?));
    }
    let seen = Seen::restored(ids, group, selected, &lengths, words);
    let seen = seen.ok_or("the state is damaged; write it again")?;
    Ok(State { frame, seen })
}

/// Bytes, read from the front.
struct Numbers<'a>(&'a [u8]);

impl Numbers<'_> {
    fn take<const N: usize>(&mut self) -> std::result::Result<[u8; N], String> {
        let (first, rest) =
            self.0.split_first_chunk::<N>().ok_or("the state is truncated; write it again")?;
        self.0 = rest;
        Ok(*first)
    }

    fn word(&mut self) -> std::result::Result<u32, String> {
        self.take().map(u32::from_le_bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SCENE: &str = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";

    fn ids(counts: &[u32]) -> Ids {
        Ids::new(counts.to_vec(), |_| String::new()).unwrap()
    }

    fn file(folder: &Path, counts: &[u32], group: u32) -> (State, Vec<u8>) {
        let ids = ids(counts);
        let some = (0..counts[0]).step_by(7).map(|surfel| ids.id(0, surfel));
        let seen = Seen::from_selected(&ids, group, &some.collect::<Vec<_>>());
        let (state, path) = (State { frame: 56, seen }, folder.join("s.bin"));
        pending(&path, &state, SCENE).unwrap().put().unwrap();
        assert_eq!(read(&path, SCENE, &ids).unwrap(), state);
        let sealed = std::fs::read(&path).unwrap();
        let bytes = check(&sealed).unwrap().to_vec();
        (state, bytes)
    }

    #[test]
    fn a_state_that_is_none_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let counts = [1000, 3, 0, 65];
        let (_, bytes) = file(folder.path(), &counts, 5);
        let words = |bytes: &[u8], scene: &str, counts: &[u32]| {
            parse(bytes, scene, &ids(counts)).unwrap_err()
        };
        let other = SCENE.replace('0', "1");
        assert_eq!(
            words(&bytes, &other, &counts),
            "the state belongs to another scene; give the scene that it was made with"
        );
        for counts in [&counts[..3], &[1000, 3, 1, 65], &[999, 3, 0, 65]] {
            assert_eq!(
                words(&bytes, SCENE, counts),
                "the state belongs to another scene; give the scene that it was made with"
            );
        }
        assert_eq!(
            words(b"splatref state 1\n", SCENE, &counts),
            "not a state of splatref; give one that render --keep-state wrote"
        );
        for end in 0..bytes.len() {
            parse(&bytes[..end], SCENE, &ids(&counts)).unwrap_err();
        }
        assert_eq!(
            words(&[&bytes[..], &[0; 8]].concat(), SCENE, &counts),
            "the state is damaged; write it again"
        );
        // A flag of a group that does not exist.
        let mut high = bytes.clone();
        *high.last_mut().unwrap() |= 0x80;
        assert_eq!(words(&high, SCENE, &counts), "the state is damaged; write it again");
        // More surfels selected than there are.
        let mut many = bytes;
        many[MAGIC.len() + DIGITS + 16 + 12 + 4] = 200;
        assert_eq!(words(&many, SCENE, &counts), "the state is damaged; write it again");
    }

    #[test]
    fn a_flipped_bit_is_never_a_state() {
        let folder = tempfile::tempdir().unwrap();
        let counts = [100, 3];
        let (_, bytes) = file(folder.path(), &counts, 5);
        let sealed = checksum::seal(bytes);
        let path = folder.path().join("flipped.bin");
        for bit in 0..8 * sealed.len() {
            let mut flipped = sealed.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            std::fs::write(&path, flipped).unwrap();
            let line = read(&path, SCENE, &ids(&counts)).unwrap_err().to_string();
            let known = ["damaged", "not a state", "an older version"];
            assert!(known.iter().any(|why| line.contains(why)), "{bit}: {line}");
        }
        let older = [OLDER, &sealed[MAGIC.len()..]].concat();
        std::fs::write(&path, older).unwrap();
        let line = read(&path, SCENE, &ids(&counts)).unwrap_err().to_string();
        assert!(line.contains("an older version"), "{line}");
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(mut noise in prop::collection::vec(any::<u8>(), 0..80), at in 0..120_usize) {
            let folder = tempfile::tempdir().unwrap();
            let (_, mut bytes) = file(folder.path(), &[90, 3], 1);
            let at = at.min(bytes.len());
            bytes.truncate(at);
            bytes.append(&mut noise);
            if let Ok(state) = parse(&bytes, SCENE, &ids(&[90, 3])) {
                prop_assert!(state.seen.check(&ids(&[90, 3]), state.seen.group()).is_ok());
            }
        }
    }
}
