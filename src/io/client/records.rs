//! Read projected splats: records of 96 bytes, as `splatref project` writes them.

use crate::error::{Error, Result};
use crate::io::input;
use crate::memory;
use crate::splat::record::SplatRecord;
use std::path::Path;

/// Reads the records of a file, in ascending surfel index.
pub(super) fn read(path: &Path) -> Result<Vec<SplatRecord>> {
    let refused = |what: String| Error::format(path, what);
    let (file, length) = input::open(path).map_err(|source| Error::io(path, source))?;
    if !length.is_multiple_of(SplatRecord::SIZE as u64) {
        let what = format!("{length} bytes, but a record has {}", SplatRecord::SIZE);
        return Err(refused(what));
    }
    memory::try_ask(2 * length, || format!("{length} bytes of records")).map_err(refused)?;
    let bytes = input::rest(file, length).map_err(|source| Error::io(path, source))?;
    let (all, rest) = bytes.as_chunks();
    if bytes.len() as u64 != length || !rest.is_empty() {
        return Err(refused("the file became shorter while it was read".into()));
    }
    let mut records: Vec<_> = all.iter().map(SplatRecord::from_bytes).collect();
    records.sort_by_key(|record| record.surfel);
    match records.windows(2).find(|pair| pair[0].surfel == pair[1].surfel) {
        Some(pair) => {
            Err(refused(format!("surfel {} has two records; remove one", pair[0].surfel)))
        }
        None => Ok(records),
    }
}
