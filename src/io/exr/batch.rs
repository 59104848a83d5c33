//! Blocks that are worked on at once.

use crate::frame::Exec;
use exr::meta::header::Header;
use exr::prelude::Vec2;

/// The blocks of a batch have about so many bytes, if they are small: enough to keep threads busy.
const BYTES: u64 = 4 << 20;
/// A thread has at least so many blocks of a batch, for none to wait long for another.
const BLOCKS_A_THREAD: u64 = 4;

/// How many blocks of a part are worked on at once. What a file holds does not depend on it.
pub(super) fn blocks(header: &Header, exec: &Exec) -> u64 {
    (BYTES / block_bytes(header).max(1)).max(BLOCKS_A_THREAD * exec.threads() as u64)
}

/// The most bytes that the pixels of a block of a part take.
pub(super) fn block_bytes(header: &Header) -> u64 {
    let Vec2(columns, rows) = header.max_block_pixel_size();
    let Vec2(width, height) = header.layer_size;
    let pixels = (columns.min(width) as u64).saturating_mul(rows.min(height) as u64);
    pixels.saturating_mul(header.channels.bytes_per_pixel as u64)
}

/// The most bytes that the blocks of two batches take, one in work and one done.
pub(super) fn most_bytes(header: &Header, exec: &Exec) -> u64 {
    let count = blocks(header, exec).min(header.chunk_count as u64);
    2_u64.saturating_mul(count).saturating_mul(block_bytes(header))
}
