//! Read projected splats: records as `splatref project` writes them, of 96 bytes or, for 3D
//! Gaussians, of 128.

use crate::error::{Error, Result};
use crate::io::{Reason, input};
use crate::memory;
use crate::method::gaussians::record::GaussianRecord;
use crate::splat::record::SplatRecord;
use std::path::{Path, PathBuf};

/// Where the records are.
#[derive(Clone, Debug)]
pub(super) enum Place {
    File(PathBuf),
    Memory(Vec<u8>),
}

impl Place {
    /// The file that has them.
    pub(super) fn file(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Memory(_) => None,
        }
    }

    /// As [`Place::file`].
    pub(super) fn file_mut(&mut self) -> Option<&mut PathBuf> {
        match self {
            Self::File(path) => Some(path),
            Self::Memory(_) => None,
        }
    }
}

/// Reads the records of surfels, in ascending surfel index.
pub(super) fn splats(place: &Place) -> Result<Vec<SplatRecord>> {
    read(place, SplatRecord::from_bytes, |record| record.surfel)
}

/// Reads the records of 3D Gaussians, in ascending index.
pub(super) fn gaussians(place: &Place) -> Result<Vec<GaussianRecord>> {
    read(place, GaussianRecord::from_bytes, |record| record.index)
}

/// Reads records, each of N bytes.
fn read<T, const N: usize>(
    place: &Place,
    from_bytes: fn(&[u8; N]) -> T,
    surfel: fn(&T) -> u32,
) -> Result<Vec<T>> {
    match place {
        Place::File(path) => {
            let refused = |what: String| Error::format(path, what);
            parse(&bytes::<N>(path)?, from_bytes, surfel).map_err(refused)
        }
        Place::Memory(bytes) => parse(bytes, from_bytes, surfel)
            .map_err(|what| Error::Invalid(format!("records: {what}"))),
    }
}

/// The bytes of a file of records, each of N bytes.
fn bytes<const N: usize>(path: &Path) -> Result<Vec<u8>> {
    let refused = |what: String| Error::format(path, what);
    let (file, length) = input::open(path).map_err(|source| Error::io(path, source))?;
    if !length.is_multiple_of(N as u64) {
        return Err(refused(format!("{length} bytes, but a record has {N}")));
    }
    memory::try_ask(2 * length, || format!("{length} bytes of records")).map_err(refused)?;
    let bytes = input::rest(file, length).map_err(|source| Error::io(path, source))?;
    if bytes.len() as u64 != length {
        return Err(refused("the file became shorter while it was read".into()));
    }
    Ok(bytes)
}

fn parse<T, const N: usize>(
    bytes: &[u8],
    from_bytes: fn(&[u8; N]) -> T,
    surfel: fn(&T) -> u32,
) -> Reason<Vec<T>> {
    let (all, rest) = bytes.as_chunks();
    if !rest.is_empty() {
        return Err(format!("{} bytes, but a record has {N}", bytes.len()));
    }
    let mut records: Vec<_> = all.iter().map(from_bytes).collect();
    records.sort_by_key(surfel);
    match records.windows(2).find(|pair| surfel(&pair[0]) == surfel(&pair[1])) {
        Some(pair) => Err(format!("surfel {} has two records; remove one", surfel(&pair[0]))),
        None => Ok(records),
    }
}
