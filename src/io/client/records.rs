//! Read projected splats: records as `splatref project` writes them, of 96 bytes or, for 3D
//! Gaussians, of 128.

use crate::error::{Error, Result};
use crate::io::input;
use crate::memory;
use crate::method::gaussians::record::GaussianRecord;
use crate::splat::record::SplatRecord;
use std::path::Path;

/// Reads the records of surfels, in ascending surfel index.
pub(super) fn splats(path: &Path) -> Result<Vec<SplatRecord>> {
    read(path, SplatRecord::from_bytes, |record| record.surfel)
}

/// Reads the records of 3D Gaussians, in ascending index.
pub(super) fn gaussians(path: &Path) -> Result<Vec<GaussianRecord>> {
    read(path, GaussianRecord::from_bytes, |record| record.index)
}

/// Reads the records of a file, each of N bytes.
fn read<T, const N: usize>(
    path: &Path,
    from_bytes: fn(&[u8; N]) -> T,
    surfel: fn(&T) -> u32,
) -> Result<Vec<T>> {
    let refused = |what: String| Error::format(path, what);
    let (file, length) = input::open(path).map_err(|source| Error::io(path, source))?;
    if !length.is_multiple_of(N as u64) {
        return Err(refused(format!("{length} bytes, but a record has {N}")));
    }
    memory::try_ask(2 * length, || format!("{length} bytes of records")).map_err(refused)?;
    let bytes = input::rest(file, length).map_err(|source| Error::io(path, source))?;
    let (all, rest) = bytes.as_chunks();
    if bytes.len() as u64 != length || !rest.is_empty() {
        return Err(refused("the file became shorter while it was read".into()));
    }
    let mut records: Vec<_> = all.iter().map(from_bytes).collect();
    records.sort_by_key(surfel);
    match records.windows(2).find(|pair| surfel(&pair[0]) == surfel(&pair[1])) {
        Some(pair) => {
            Err(refused(format!("surfel {} has two records; remove one", surfel(&pair[0]))))
        }
        None => Ok(records),
    }
}
