//! Decompress the points of a LAZ file with the crate laz.
//!
//! The crate allocates as much as the table of chunks and the sizes of layers claim. Both are
//! compared with the length of the file first.

use super::header::Header;
use crate::io::Reason;
use laz::{LasZipDecompressor, LasZipError, LazItem, LazItemRecordBuilder, LazItemType, LazVlr};
use std::io::{Cursor, Seek, SeekFrom};

/// So many records are decompressed at once. A count that is too large is found out before memory
/// for all of it is taken.
const BATCH: u64 = 1 << 16;

/// The records of all points.
pub(super) fn decompress(bytes: &[u8], header: &Header) -> Reason<Vec<u8>> {
    let vlr = LazVlr::from_buffer(header.compression(bytes)?).map_err(|error| reason(&error))?;
    let Header { format, stride, .. } = *header;
    let expected = LazItemRecordBuilder::default_for_point_format_id(format, header.extra());
    let kinds = |items: &[LazItem]| {
        items.iter().map(|item| (item.item_type(), item.size())).collect::<Vec<_>>()
    };
    // The crate trusts the sizes of the fields.
    if kinds(vlr.items()) != kinds(&expected.map_err(|error| reason(&error))?) {
        return Err(format!(
            "the compressed fields are not those of point format {format} with records of {stride} \
             bytes: the file is damaged"
        ));
    }
    check_chunks(bytes, header)?;
    // The fields of these formats are compressed in layers.
    if format >= 6 {
        check_layers(bytes, header, vlr.items())?;
    }
    let mut source = Cursor::new(bytes);
    source.seek(SeekFrom::Start(header.start as u64)).map_err(|error| error.to_string())?;
    let mut decompressor = LasZipDecompressor::new(source, vlr).map_err(|error| reason(&error))?;
    let mut records = Vec::new();
    let mut done = 0;
    while done < header.count {
        let batch = BATCH.min(header.count - done);
        let from = records.len();
        records.resize(from + batch as usize * stride, 0);
        decompressor.decompress_many(&mut records[from..]).map_err(|error| {
            format!(
                "points {done} to {}: {error}: the file is truncated or damaged",
                done + batch - 1
            )
        })?;
        done += batch;
    }
    Ok(records)
}

fn reason(error: &LasZipError) -> String {
    format!("the compression of the points: {error}; write the file again as LAS")
}

/// Checks that the table of chunks, if there is one, has no more chunks than the file has bytes.
fn check_chunks(bytes: &[u8], header: &Header) -> Reason<()> {
    let number = |at: Option<usize>| Some(i64::from_le_bytes(*bytes.get(at?..)?.first_chunk()?));
    // A program that could not go back wrote the place of the table at the end.
    let place = number(Some(header.start))
        .filter(|place| *place > header.start as i64)
        .or_else(|| number(bytes.len().checked_sub(8)));
    let count = place.and_then(|place| usize::try_from(place).ok()?.checked_add(4));
    let count = count.and_then(|at| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?)));
    match count {
        Some(count) if u64::from(count) > bytes.len() as u64 => Err(format!(
            "{count} chunks of points in a file of {} bytes: the file is damaged",
            bytes.len()
        )),
        _ => Ok(()),
    }
}

/// Checks that the layers of all chunks are within the file: a chunk is its first record, its number
/// of points, the size of each layer, and the layers.
fn check_layers(bytes: &[u8], header: &Header, items: &[LazItem]) -> Reason<()> {
    let layers: usize = items.iter().map(|item| layers(item.item_type())).sum();
    let mut at = header.start + 8;
    let mut points = 0;
    while points < header.count {
        let ends = || format!("byte {at}: the file ends within a chunk of points: it is truncated");
        let head = bytes.get(at + header.stride..).ok_or_else(ends)?;
        let numbers = head.get(..4 * (layers + 1)).ok_or_else(ends)?.as_chunks::<4>().0;
        let number = |&number: &[u8; 4]| u64::from(u32::from_le_bytes(number));
        let size = numbers[1..].iter().map(number).sum::<u64>();
        let left = (head.len() - 4 * (layers + 1)) as u64;
        let count = number(&numbers[0]);
        if size > left || count == 0 {
            return Err(format!(
                "byte {at}: a chunk of {count} points in {size} bytes, of which the file has \
                 {left}: it is truncated or damaged"
            ));
        }
        points += count;
        at += header.stride + 4 * (layers + 1) + size as usize;
    }
    Ok(())
}

/// How many layers a field has.
fn layers(item: LazItemType) -> usize {
    match item {
        LazItemType::Point14 => 9,
        LazItemType::RGB14 | LazItemType::WavePacket14 => 1,
        LazItemType::RGBNIR14 => 2,
        LazItemType::Byte14(count) => count.into(),
        _ => 0,
    }
}
