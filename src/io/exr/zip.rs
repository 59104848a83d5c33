//! Compress ZIP blocks with the fastest level of deflate.
//!
//! The exr crate offers only level 4, which is slower. The steps before deflate are the format's
//! own, so that every reader can undo them.

use miniz_oxide::deflate::compress_to_vec_zlib;

const LEVEL: u8 = 1;

/// Compresses the block of these lines; each sample has four bytes in the order of this machine.
pub(super) fn compress(mut lines: Vec<u8>) -> Vec<u8> {
    if cfg!(target_endian = "big") {
        lines.as_chunks_mut::<4>().0.iter_mut().for_each(|sample| sample.reverse());
    }
    let packed = compress_to_vec_zlib(&differences(&halves(&lines)), LEVEL);
    // Readers take a block as long as its pixels for an uncompressed one.
    if packed.len() < lines.len() { packed } else { lines }
}

/// The bytes at even places, then the bytes at odd places; their count is even.
fn halves(bytes: &[u8]) -> Vec<u8> {
    let mut halves = vec![0; bytes.len()];
    let (even, odd) = halves.split_at_mut(bytes.len() / 2);
    for ((even, odd), pair) in even.iter_mut().zip(odd).zip(bytes.as_chunks::<2>().0) {
        [*even, *odd] = *pair;
    }
    halves
}

/// Each byte minus the byte before, plus 128; the first byte stays.
fn differences(bytes: &[u8]) -> Vec<u8> {
    let mut differences = bytes.to_vec();
    let after = bytes.iter().skip(1).zip(bytes);
    for (to, (&byte, &before)) in differences.iter_mut().skip(1).zip(after) {
        *to = byte.wrapping_sub(before).wrapping_add(128);
    }
    differences
}
