//! Write a frame to an EXR file.

use super::{ATTRIBUTE, Compression, Window, batch, zip};
use crate::error::{Error, Result};
use crate::frame::named::LONGEST_NAME;
use crate::frame::{Channel, ChannelData, Exec, Frame, Rect};
use crate::io::replace::Pending;
use exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock};
use exr::block::lines::LineRefMut;
use exr::block::writer::ChunksWriter;
use exr::block::{self, BlockIndex, UncompressedBlock};
use exr::error::UnitResult;
use exr::meta::attribute::{
    AttributeValue, ChannelDescription, LineOrder, SampleType, Text as ExrText,
};
use exr::meta::header::{Header, LayerAttributes};
use exr::meta::{BlockDescription, Headers, MetaData};
use exr::prelude::{Compression as Codec, IntegerBounds, Vec2};
use std::io::{self, Seek, Write};
use std::ops::Range;
use std::path::Path;

/// Writes all channels of `frame` to the file at `path`, and `text` as the attribute [`ATTRIBUTE`].
/// It uses one thread and the default [`Compression`].
///
/// The file has one part of scan lines, without loss: [`ChannelData::Float`] as `FLOAT`,
/// [`ChannelData::Index`] and [`ChannelData::Count`] as `UINT`.
///
/// # Errors
/// [`Error::Invalid`] if the frame has no channel, no pixel, a plane of another size, or a channel
/// name that is empty, longer than 31 bytes or given twice. [`Error::Io`] if the file cannot be
/// written; then nothing of it is left.
pub fn write(path: &Path, frame: &Frame<f32>, text: &str) -> Result<()> {
    pending(path, frame, text, Compression::default(), &Exec::sequential())?.put()
}

/// Does all of [`write()`] except to put the file in its place, for files that belong together.
///
/// The bytes of the file are a function of `frame`, `text` and `compression`. The planes are not
/// copied. Beside them, memory holds two batches of a few blocks a thread: one is compressed while
/// the other is written.
///
/// # Errors
/// As [`write()`].
pub fn pending(
    path: &Path,
    frame: &Frame<f32>,
    text: &str,
    compression: Compression,
    exec: &Exec,
) -> Result<Pending> {
    pending_part(path, frame, Window::whole(frame), text, compression, exec)
}

/// As [`pending()`], for a frame that holds a part of a picture: the part is the data window of the
/// file, the picture its display window.
///
/// # Errors
/// As [`write()`], and [`Error::Invalid`] if the frame does not have the size of its part, or if the
/// part is not inside the picture.
pub fn pending_part(
    path: &Path,
    frame: &Frame<f32>,
    window: Window,
    text: &str,
    compression: Compression,
    exec: &Exec,
) -> Result<Pending> {
    let channels = frame.channels();
    check(frame, &channels)?;
    window.check([frame.width, frame.height])?;
    let headers = headers(&window, &channels, text, compression)?;
    let lines = 0..frame.height as usize;
    Pending::write(path, |file| {
        encode(file, headers, exec, |put| put(&channels, lines)).map_err(of_io)
    })
}

/// The most lines of a block, over all compressions: bands have a multiple of it.
pub const BLOCK_LINES: u32 = 32;

/// As [`pending()`], for a picture of this width and height that is drawn in bands of about `rows`
/// rows, from the top. `draw` returns the planes of a band; memory holds one band at a time.
///
/// # Errors
/// As [`write()`]; those of `draw`; [`Error::Invalid`] if a band has other channels than the first, or
/// does not have the size of its rectangle.
pub fn pending_bands(
    path: &Path,
    picture: [u32; 2],
    rows: u32,
    text: &str,
    compression: Compression,
    exec: &Exec,
    draw: &mut dyn FnMut(Rect) -> Result<Frame<f32>>,
) -> Result<Pending> {
    let [width, height] = picture;
    // Each block is written at once, so no band may end within a block.
    let rows = rows.clamp(1, height.max(1)).next_multiple_of(BLOCK_LINES);
    let band = |y: u32| Rect { x0: 0, y0: y, x1: width, y1: height.min(y + rows) };
    let mut checked = |rect: Rect| {
        let frame = draw(rect)?;
        check(&frame, &frame.channels())?;
        Window { region: rect, picture }.check([frame.width, frame.height])?;
        Ok(frame)
    };
    let first = checked(band(0))?;
    let whole = Window { region: Rect::of_size(picture), picture };
    let headers = headers(&whole, &first.channels(), text, compression)?;
    let names = names(&first);
    let (mut first, mut failed) = (Some(first), None);
    let pending = Pending::write(path, |file| {
        let bands = |put: &mut Put<'_>| {
            for band in (0..height).step_by(rows as usize).map(band) {
                let frame = first.take().map_or_else(|| checked(band), Ok).and_then(|frame| {
                    let what = "the bands of a picture have different channels";
                    let same = self::names(&frame) == names;
                    if same { Ok(frame) } else { Err(Error::Invalid(what.into())) }
                });
                match frame {
                    Ok(frame) => put(&frame.channels(), band.y0 as usize..band.y1 as usize)?,
                    Err(error) => {
                        failed = Some(error);
                        return Err(exr::error::Error::Aborted);
                    }
                }
            }
            Ok(())
        };
        encode(file, headers, exec, bands).map_err(of_io)
    });
    failed.map_or(pending, Err)
}

/// The names of a frame's channels, and whether they hold floats.
fn names(frame: &Frame<f32>) -> Vec<(String, bool)> {
    let kind = |data: &ChannelData<'_>| matches!(data, ChannelData::Float { .. });
    frame.channels().into_iter().map(|one| (one.name, kind(&one.data))).collect()
}

/// An error of the exr crate as one of a file.
fn of_io(error: exr::error::Error) -> io::Error {
    match error {
        exr::error::Error::Io(error) => error,
        other => io::Error::other(other.to_string()),
    }
}

/// The headers of a file with one part.
fn headers(
    window: &Window,
    channels: &[Channel<'_>],
    text: &str,
    compression: Compression,
) -> Result<Headers> {
    let headers: Headers = std::iter::once(header(window, channels, text, compression)).collect();
    MetaData::validate(&headers, true).map_err(|e| Error::Invalid(format!("no EXR: {e}")))?;
    Ok(headers)
}

/// Refuses frames that would make the exr crate panic, or write a file that other readers refuse.
fn check(frame: &Frame<f32>, channels: &[Channel<'_>]) -> Result<()> {
    let (width, height) = (frame.width, frame.height);
    if width == 0 || height == 0 || channels.is_empty() {
        let count = channels.len();
        return Err(Error::Invalid(format!(
            "an EXR cannot hold {width} x {height} pixels in {count} channels; render at least one \
             of each"
        )));
    }
    for Channel { name, data } in channels {
        if name.is_empty() || name.len() > LONGEST_NAME {
            return Err(Error::Invalid(format!(
                "channel `{name}`: an EXR channel name has 1 to {LONGEST_NAME} bytes"
            )));
        }
        let (len, stride) = match data {
            ChannelData::Float { values, stride, .. } => (values.len(), *stride),
            ChannelData::Index(values) => (values.len(), 1),
            ChannelData::Count(values) => (values.len(), 1),
        };
        if len != width as usize * height as usize * stride {
            return Err(Error::Invalid(format!(
                "channel `{name}`: its plane does not have the {width} x {height} pixels of the \
                 frame"
            )));
        }
    }
    Ok(())
}

/// The header of the only part.
fn header(
    Window { region, picture }: &Window,
    channels: &[Channel<'_>],
    text: &str,
    compression: Compression,
) -> Header {
    let described = channels.iter().map(|channel| {
        let sample_type = match channel.data {
            ChannelData::Float { .. } => SampleType::F32,
            ChannelData::Index(_) | ChannelData::Count(_) => SampleType::U32,
        };
        ChannelDescription::named(bytes(&channel.name), sample_type)
    });
    let pixels = |[width, height]: [u32; 2]| (width as usize, height as usize);
    // In 31 bits, as the window has been checked.
    let position = Vec2(region.x0 as i32, region.y0 as i32);
    // Only one custom attribute, because the exr crate keeps them in a HashMap, whose order is
    // random.
    let attributes = LayerAttributes {
        other: std::iter::once((bytes(ATTRIBUTE), AttributeValue::Text(bytes(text)))).collect(),
        layer_position: position,
        ..LayerAttributes::default()
    };
    let codec = match compression {
        Compression::Rle => Codec::RLE,
        Compression::Zip => Codec::ZIP16,
        Compression::Piz => Codec::PIZ,
        Compression::None => Codec::Uncompressed,
    };
    Header::new(bytes(""), pixels(region.size()), described.collect())
        .with_display_window(IntegerBounds::new((0, 0), pixels(*picture)))
        .with_encoding(codec, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(attributes)
}

/// A text as UTF-8 bytes, which EXR expects since version 3.
fn bytes(text: &str) -> ExrText {
    ExrText::from_slice_unchecked(text.as_bytes())
}

/// Writes the blocks of these lines of the data window, from channels that hold these lines alone.
type Put<'a> = dyn FnMut(&[Channel<'_>], Range<usize>) -> UnitResult + 'a;

/// Writes header and blocks, in the order of lines: one batch is written while the next is
/// compressed. `bands` puts all lines, band after band.
fn encode(
    write: &mut (impl Write + Seek + Send),
    headers: Headers,
    exec: &Exec,
    bands: impl FnOnce(&mut Put<'_>) -> UnitResult,
) -> UnitResult {
    block::write(write, headers, true, |meta, chunks| {
        let mut places = meta.enumerate_ordered_header_block_indices().peekable();
        let size = batch::blocks(&meta.headers[0], exec) as usize;
        bands(&mut |channels, lines| {
            let mut compressed = Vec::new();
            loop {
                let is_in_band = |place: &BlockIndex| place.pixel_position.y() < lines.end;
                let next = || places.next_if(|(_, place)| is_in_band(place));
                let batch: Vec<_> = std::iter::from_fn(next).take(size).collect();
                let is_last = batch.is_empty();
                let (written, next) = exec.join(
                    || compressed.into_iter().try_for_each(|(i, c)| chunks.write_chunk(i, c)),
                    || compress(batch, &meta, channels, lines.start, exec),
                );
                written?;
                compressed = next?;
                if is_last {
                    return Ok(());
                }
            }
        })
    })
}

/// Compresses the blocks of a batch, each with its index. The channels begin at line `first`.
fn compress(
    batch: Vec<(usize, BlockIndex)>,
    meta: &MetaData,
    channels: &[Channel<'_>],
    first: usize,
    exec: &Exec,
) -> exr::error::Result<Vec<(usize, Chunk)>> {
    let compressed = exec.ordered(batch, |(index, place)| {
        let list = &meta.headers[0].channels;
        let block = UncompressedBlock::from_lines(list, place, |line| fill(line, channels, first));
        let chunk = match meta.headers[0].compression {
            Codec::ZIP16 => zip_chunk(block, meta.headers[0].own_attributes.layer_position.y())?,
            _ => block.compress_to_chunk(&meta.headers)?,
        };
        Ok((index, chunk))
    });
    compressed.into_iter().collect()
}

/// Makes the same chunk as the exr crate, except for the level of compression; `top` is the first
/// line of the data window.
fn zip_chunk(
    UncompressedBlock { index, data }: UncompressedBlock,
    top: i32,
) -> exr::error::Result<Chunk> {
    let lines = CompressedScanLineBlock {
        y_coordinate: i32::try_from(index.pixel_position.y())
            .map(|line| top + line)
            .map_err(|_| exr::error::Error::Invalid("the picture has too many lines".into()))?,
        compressed_pixels_le: zip::compress(data),
    };
    Ok(Chunk { layer_index: 0, compressed_block: CompressedBlock::ScanLine(lines) })
}

/// Fills one line of one channel, in the byte order of this machine; the exr crate swaps bytes if
/// necessary.
fn fill(line: LineRefMut<'_>, channels: &[Channel<'_>], first: usize) {
    let place = line.location;
    // The blocks are as wide as the data window: the line starts at its first column.
    let first = (place.position.y() - first) * place.sample_count;
    let bytes = line.value.as_chunks_mut::<4>().0;
    match channels[place.channel].data {
        ChannelData::Float { values, stride, offset } => {
            let line = values[stride * first + offset..].iter().step_by(stride);
            bytes.iter_mut().zip(line).for_each(|(to, value)| *to = value.to_ne_bytes());
        }
        ChannelData::Index(values) => {
            bytes.iter_mut().zip(&values[first..]).for_each(|(to, v)| *to = v.to_ne_bytes());
        }
        ChannelData::Count(values) => {
            let line = values[first..].iter().map(|&v| u32::from(v));
            bytes.iter_mut().zip(line).for_each(|(to, v)| *to = v.to_ne_bytes());
        }
    }
}
