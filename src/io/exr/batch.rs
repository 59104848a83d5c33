//! Choose how many blocks are worked on at once.

use crate::frame::Exec;
use exr::meta::header::Header;
use exr::prelude::Vec2;

/// Small blocks share a batch of about this many bytes: enough to keep all threads busy.
const BYTES: u64 = 1 << 20;
/// Blocks of a batch for each thread, at least; enough that threads rarely wait for each other.
const BLOCKS_A_THREAD: u64 = 4;
/// A batch of more than one block has at most this many bytes, because 16 lines of the widest
/// picture with all stages take 100 MB in each block.
const MOST: u64 = 256 << 20;

/// How many blocks of a part are worked on at once. The contents of a file do not depend on it.
pub(super) fn blocks(header: &Header, exec: &Exec) -> u64 {
    let bytes = block_bytes(header).max(1);
    (BYTES / bytes).max(BLOCKS_A_THREAD * exec.threads() as u64).min((MOST / bytes).max(1))
}

/// The most bytes that the pixels of one block take.
pub(super) fn block_bytes(header: &Header) -> u64 {
    let Vec2(columns, rows) = header.max_block_pixel_size();
    let Vec2(width, height) = header.layer_size;
    let pixels = (columns.min(width) as u64).saturating_mul(rows.min(height) as u64);
    pixels.saturating_mul(header.channels.bytes_per_pixel as u64)
}

/// The most bytes that the blocks of two batches take: one in work and one done.
pub(super) fn most_bytes(header: &Header, exec: &Exec) -> u64 {
    let count = blocks(header, exec).min(header.chunk_count as u64);
    2_u64.saturating_mul(count).saturating_mul(block_bytes(header))
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::meta::BlockDescription;
    use exr::meta::attribute::{ChannelDescription, LineOrder, SampleType, Text};
    use exr::prelude::Compression;

    /// A picture of 24 channels.
    fn header(width: usize, height: usize, compression: Compression) -> Header {
        let name = |i: u8| Text::from_slice_unchecked(&[b'a' + i]);
        let channel = |i| ChannelDescription::named(name(i), SampleType::F32);
        Header::new(name(0), (width, height), (0..24).map(channel).collect()).with_encoding(
            compression,
            BlockDescription::ScanLines,
            LineOrder::Increasing,
        )
    }

    #[test]
    fn batches_feed_every_thread_and_do_not_grow_with_picture_times_threads() {
        for threads in [1, 2, 64] {
            let exec = Exec::new(threads, 32).unwrap();
            for codec in [Compression::RLE, Compression::ZIP16, Compression::PIZ] {
                let small = header(512, 512, codec);
                assert!(blocks(&small, &exec) >= exec.threads() as u64, "{threads}");
                let wide = header(65_536, 4096, codec);
                let most = 2 * MOST.max(block_bytes(&wide));
                assert!(blocks(&wide, &exec) > 0 && most_bytes(&wide, &exec) <= most, "{threads}");
            }
        }
        let (exec, widest) = (Exec::new(64, 32).unwrap(), header(65_536, 4096, Compression::ZIP16));
        assert!(exec.threads() as u64 * block_bytes(&widest) > 4 * MOST, "it matters");
    }
}
