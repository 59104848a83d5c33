//! Read an EXR file into an image, and trust nothing in it.

use super::{ATTRIBUTE, ChannelType, PictureHeader, batch, window};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::frame::image::{Image, Values};
use crate::io::guard::guarded;
use crate::io::{Reason, extension, input};
use crate::memory;
use exr::block::UncompressedBlock;
use exr::block::chunk::{
    Chunk, CompressedBlock, CompressedScanLineBlock, CompressedTileBlock, TileCoordinates,
};
use exr::meta::attribute::{AttributeValue, SampleType, Text as ExrText};
use exr::meta::header::Header as PartHeader;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{Compression, Vec2, f16};
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

/// Deflate expands one byte to at most 1032; PXR24 drops one byte in four before deflate: 1376.
const MOST_EXPANSION: u64 = 1376;
/// The least that a block takes: 8 bytes in the table of offsets, and 8 more for its place and
/// size.
const LEAST_BLOCK: u64 = 16;

/// Reads every channel of the flat EXR file at `path`, on one thread. Any program may have written
/// the file.
///
/// The file may have scan lines or tiles, one part or several, and any compression but DWA and
/// HTJ2K. If it has several resolutions, only the full one is read. The picture is the display
/// window: pixels outside the data window are empty, with a depth of +inf, an id of `0xFFFF_FFFF` and 0
/// in all other channels. In a file with several parts, a
/// channel is called `part.channel`. `HALF` values are widened exactly (a signalling NaN becomes
/// quiet); all other bits are kept.
///
/// Memory holds the bytes of the file, the planes, and two batches of a few blocks a thread. If all
/// parts fill the display window, planes take at most 1376 bytes (twice that for `HALF`) for each byte of the file, because no
/// compression of the format can hold more.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read. [`Error::Format`] if the file is not an EXR, is
/// damaged, promises more than its bytes can hold, or has no planes to compare. This last case
/// covers deep data, subsampled channels, a display window of more than 256 MiB and 4096
/// times the pixels of its data, parts with different display windows, and two channels of one name.
pub fn read(path: &Path) -> Result<Image> {
    read_with(path, &Exec::sequential())
}

/// [`read()`] on several threads; the image, or the error, is the same.
///
/// # Errors
/// As [`read()`].
pub fn read_with(path: &Path, exec: &Exec) -> Result<Image> {
    let (file, length) = open(path)?;
    let bytes = input::rest(file, length).map_err(|source| Error::io(path, source))?;
    guarded(|| decode(&bytes, exec, Fit::Picture))
        .flatten()
        .map_err(|what| Error::format(path, what))
}

/// Reads the header of the EXR file at `path`, and no pixel.
///
/// # Errors
/// As [`read()`], as far as the header shows.
pub fn read_header(path: &Path) -> Result<PictureHeader> {
    let (file, length) = open(path)?;
    guarded(|| Ok(summary(&metadata(BufReader::new(file), length)?)))
        .flatten()
        .map_err(|what| Error::format(path, what))
}

/// Opens a file that begins as an EXR does; returns it, rewound, and its length.
pub(super) fn open(path: &Path) -> Result<(File, u64)> {
    let start = || -> std::io::Result<(File, u64, [u8; 4])> {
        let (mut file, length) = input::open(path)?;
        let mut magic = [0; 4];
        let all = file.read(&mut magic)? == magic.len();
        file.rewind()?;
        Ok((file, length, if all { magic } else { [0; 4] }))
    };
    let (file, length, magic) = start().map_err(|source| Error::io(path, source))?;
    if magic != exr::meta::magic_number::BYTES {
        let what = match extension(path).as_deref() {
            Some("exr") | None => {
                "byte 0: not an EXR file; give one that starts 76 2f 31 01".into()
            }
            Some(other @ ("png" | "npy" | "npz")) => {
                format!(
                    "a .{other} is no EXR file, and only those are read here; convert it to .exr"
                )
            }
            Some(other) => format!(
                "pictures of the kind .{} are not read; convert it to .exr, .png, .npy or .npz",
                other.escape_debug()
            ),
        };
        return Err(Error::format(path, what));
    }
    Ok((file, length))
}

/// Parses the header, and checks that a file of `length` bytes can hold what the header promises.
pub(super) fn metadata(read: impl Read, length: u64) -> Reason<MetaData> {
    let meta = MetaData::read_from_buffered(read, true).map_err(|e| reason("header", e))?;
    MetaData::validate(&meta.headers, true).map_err(|e| reason("header", e))?;
    let mut blocks: u64 = 0;
    let mut needed: u64 = 0;
    for header in &meta.headers {
        let Vec2(width, height) = header.layer_size;
        let pixels = (width as u64).saturating_mul(height as u64);
        let bytes = pixels.saturating_mul(header.channels.bytes_per_pixel as u64);
        let expansion = match header.compression {
            Compression::Uncompressed => 1,
            _ => MOST_EXPANSION,
        };
        // A lower bound of the bytes that these pixels take in the file.
        needed = needed.saturating_add(bytes.div_ceil(expansion));
        blocks = blocks.saturating_add(header.chunk_count as u64);
    }
    if needed > length || blocks.saturating_mul(LEAST_BLOCK) > length {
        let Vec2(width, height) = meta.headers[0].layer_size;
        return Err(format!(
            "header: declares {width} x {height} pixels in {blocks} blocks, more than a file of \
             {length} bytes can hold; write it again"
        ));
    }
    window::check(&meta.headers)?;
    let names = summary(&meta).channels;
    match names.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(format!("header: two channels are called `{}`; rename one", pair[0].0)),
        None => Ok(meta),
    }
}

/// The part of a checked header that this crate uses.
fn summary(meta: &MetaData) -> PictureHeader {
    let mut channels = Vec::new();
    for part in &meta.headers {
        channels.extend(part.channels.list.iter().map(|channel| {
            let kind = match channel.sample_type {
                SampleType::F16 => ChannelType::Half,
                SampleType::F32 => ChannelType::Float,
                SampleType::U32 => ChannelType::Uint,
            };
            (full_name(meta, part, &channel.name), kind)
        }));
    }
    channels.sort_by(|a, b| a.0.cmp(&b.0));
    let first = &meta.headers[0];
    let size = first.shared_attributes.display_window.size;
    PictureHeader {
        // Both are less than 2^31, because the exr crate has checked the windows.
        width: size.width() as u32,
        height: size.height() as u32,
        data: window::region(&meta.headers),
        channels,
        compressions: meta.headers.iter().map(|part| part.compression.to_string()).collect(),
        text: text(first),
    }
}

/// The text of this crate's attribute.
fn text(part: &PartHeader) -> Option<String> {
    match part.own_attributes.other.get(&ExrText::from_slice_unchecked(ATTRIBUTE.as_bytes()))? {
        AttributeValue::Text(text) => Some(utf8(text)),
        _ => None,
    }
}

/// `channel`, or `part.channel` in a file of several parts.
fn full_name(meta: &MetaData, part: &PartHeader, channel: &ExrText) -> String {
    match &part.own_attributes.layer_name {
        Some(name) if meta.headers.len() > 1 => format!("{}.{}", utf8(name), utf8(channel)),
        _ => utf8(channel),
    }
}

/// A text of a file as UTF-8; the file may hold any bytes.
fn utf8(text: &ExrText) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

/// Describes an error of the exr crate: where, what, and the remedy.
fn reason(place: &str, error: exr::error::Error) -> String {
    match error {
        exr::error::Error::NotSupported(what) => {
            format!("{place}: {what}; save it as a flat EXR with ZIP compression")
        }
        exr::error::Error::Invalid(what) if what == "reference to missing bytes" => {
            ends_early(place)
        }
        exr::error::Error::Invalid(what) => format!("{place}: {what}; write the file again"),
        other => format!("{place}: {other}"),
    }
}

/// The pixels of a decoded image.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Fit {
    /// The display window; pixels without data are empty.
    Picture,
    /// The data window, which all parts share.
    Data,
}

/// Decodes a whole file.
pub(super) fn decode(bytes: &[u8], exec: &Exec, fit: Fit) -> Reason<Image> {
    let mut rest = bytes;
    let meta = metadata(&mut rest, bytes.len() as u64)?;
    let PictureHeader { mut width, mut height, text, .. } = summary(&meta);
    if fit == Fit::Picture {
        window::check_emptiness(&meta.headers)?;
    } else {
        let Vec2(columns, rows) = meta.headers[0].layer_size;
        (width, height) = (columns as u32, rows as u32);
    }
    let planes = meta.headers.iter().map(|part| part.channels.list.len() as u64).sum::<u64>();
    let batches = meta.headers.iter().map(|part| batch::most_bytes(part, exec)).max();
    // A part that is not the whole picture is in memory twice while it is put in its place.
    let of_part =
        |part: &PartHeader| 4 * (part.channels.list.len() * part.layer_size.area()) as u64;
    let is_fit = |part: &PartHeader| fit == Fit::Data || window::is_whole(part);
    let cropped = meta.headers.iter().filter(|part| !is_fit(part));
    let cropped = cropped.map(of_part).max().unwrap_or(0);
    let needed = planes * 4 * u64::from(width) * u64::from(height) + cropped;
    memory::try_ask(needed.saturating_add(batches.unwrap_or(0)), || {
        format!("a picture of {width} x {height} pixels, {planes} channels")
    })?;
    let mut channels = Vec::new();
    for (part, header) in meta.headers.iter().enumerate() {
        let mut planes = decode_part(bytes, &mut rest, &meta, part, exec)?;
        if !is_fit(header) {
            planes = window::fit(planes, header);
        }
        let names = header.channels.list.iter().map(|c| full_name(&meta, header, &c.name));
        channels.extend(names.zip(planes));
    }
    channels.sort_by(|a, b| a.0.cmp(&b.0));
    Ok(Image { width, height, channels, text })
}

/// Decodes the planes of a part; the table of its offsets is next in `rest`. One batch of blocks is
/// copied to the planes while the next is decompressed.
fn decode_part(
    bytes: &[u8],
    rest: &mut &[u8],
    meta: &MetaData,
    part: usize,
    exec: &Exec,
) -> Reason<Vec<Values>> {
    let header = &meta.headers[part];
    let mut planes = empty_planes(header);
    let mut places = header.blocks_increasing_y_order().map(|tile| tile.location).enumerate();
    let size = batch::blocks(header, exec) as usize;
    let mut blocks = Vec::new();
    loop {
        let batch: Vec<_> = places
            .by_ref()
            .take(size)
            .map(|(index, location)| (index, location, take(rest)))
            .collect();
        let is_last = batch.is_empty();
        let (filled, next) = exec.join(
            || -> Reason<()> {
                for block in blocks {
                    if let Some(block) = block? {
                        fill(&mut planes, header, &block);
                    }
                }
                Ok(())
            },
            || {
                exec.ordered(batch, |(index, location, offset)| {
                    decode_block(bytes, meta, part, index, location, offset)
                })
            },
        );
        filled?;
        blocks = next;
        if is_last {
            return Ok(planes);
        }
    }
}

/// Decodes a block from its index, its place and the offset of its bytes; `None` for a lower
/// resolution.
fn decode_block(
    bytes: &[u8],
    meta: &MetaData,
    part: usize,
    index: usize,
    location: TileCoordinates,
    offset: Option<[u8; 8]>,
) -> Reason<Option<UncompressedBlock>> {
    let place = || format!("part {part}, block {index}");
    let offset = offset.ok_or_else(|| ends_early(&place()))?;
    if location.level_index != Vec2(0, 0) {
        return Ok(None);
    }
    let chunk = chunk(bytes, u64::from_le_bytes(offset), meta, part, location)
        .map_err(|what| format!("{}: {what}", place()))?;
    // Guard here too, because this may run on another thread.
    guarded(|| {
        UncompressedBlock::decompress_chunk(chunk, meta, true)
            .map(Some)
            .map_err(|error| reason(&place(), error))
    })
    .flatten()
}

/// The planes of a part, filled with 0.
fn empty_planes(header: &PartHeader) -> Vec<Values> {
    let pixels = header.layer_size.area();
    let plane = |sample_type| match sample_type {
        SampleType::U32 => Values::Index(vec![0; pixels]),
        SampleType::F16 | SampleType::F32 => Values::Float(vec![0.0; pixels]),
    };
    header.channels.list.iter().map(|channel| plane(channel.sample_type)).collect()
}

/// The compressed block at byte `offset`, where the table of offsets places it; an error if another
/// block is there.
///
/// This is not left to the exr crate, because its reader allocates as much as a block claims, loses
/// its place after a small gap between blocks, and accepts a block twice.
fn chunk(
    bytes: &[u8],
    offset: u64,
    meta: &MetaData,
    part: usize,
    expected: TileCoordinates,
) -> Reason<Chunk> {
    let early = || ends_early(&format!("byte {offset}"));
    let mut rest = usize::try_from(offset).ok().and_then(|o| bytes.get(o..)).ok_or_else(early)?;
    let mut number = || take(&mut rest).map(i32::from_le_bytes).ok_or_else(early);
    let header = &meta.headers[part];
    let Vec2(column, row) = expected.tile_index;
    let mut place = Vec::new();
    if meta.requirements.has_multiple_layers {
        place.push(part as i64);
    }
    match header.blocks {
        BlockDescription::ScanLines => {
            let line = header.compression.scan_lines_per_block() * row;
            place.push(i64::from(header.own_attributes.layer_position.y()) + line as i64);
        }
        BlockDescription::Tiles(_) => place.extend([column as i64, row as i64, 0, 0]),
    }
    for expected in place {
        let found = number()?;
        if i64::from(found) != expected {
            return Err(format!(
                "byte {offset}: found block {found} instead of {expected}; write the file again"
            ));
        }
    }
    let size = usize::try_from(number()?).map_err(|_| early())?;
    if size as u64 > batch::block_bytes(header) {
        // Each thread holds the bytes of a block, so a false size must not pass.
        return Err(format!(
            "byte {offset}: a block of {size} bytes, more than its pixels need; write the file \
             again"
        ));
    }
    let compressed_pixels_le = rest.get(..size).ok_or_else(early)?.to_vec();
    let compressed_block = match header.blocks {
        BlockDescription::ScanLines => CompressedBlock::ScanLine(CompressedScanLineBlock {
            y_coordinate: header.own_attributes.layer_position.y()
                + (header.compression.scan_lines_per_block() * row) as i32,
            compressed_pixels_le,
        }),
        BlockDescription::Tiles(_) => CompressedBlock::Tile(CompressedTileBlock {
            coordinates: expected,
            compressed_pixels_le,
        }),
    };
    Ok(Chunk { layer_index: part, compressed_block })
}

/// The next `N` bytes.
fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (first, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(*first)
}

/// The error for a file that was cut.
fn ends_early(place: &str) -> String {
    format!("{place}: the file is truncated; write it again")
}

/// Copies a block to its place in the planes.
fn fill(planes: &mut [Values], header: &PartHeader, block: &UncompressedBlock) {
    for line in block.lines(&header.channels) {
        let place = line.location;
        let first = place.position.y() * header.layer_size.width() + place.position.x();
        let pixels = first..first + place.sample_count;
        match &mut planes[place.channel] {
            Values::Index(values) => {
                let line = line.value.as_chunks().0.iter().map(|&b| u32::from_ne_bytes(b));
                values[pixels].iter_mut().zip(line).for_each(|(to, v)| *to = v);
            }
            Values::Float(values) if line.value.len() == 2 * place.sample_count => {
                let line = line.value.as_chunks().0.iter().map(|&b| f16::from_ne_bytes(b).to_f32());
                values[pixels].iter_mut().zip(line).for_each(|(to, v)| *to = v);
            }
            Values::Float(values) => {
                let line = line.value.as_chunks().0.iter().map(|&b| f32::from_ne_bytes(b));
                values[pixels].iter_mut().zip(line).for_each(|(to, v)| *to = v);
            }
        }
    }
}
