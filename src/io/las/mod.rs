//! Read point clouds of laser scanners: LAS 1.0 to 1.4, and LAZ with the feature `cli`.
//!
//! | field | becomes | details |
//! |---|---|---|
//! | `X`, `Y`, `Z` | positions | scale times the integer, plus the offset, in f64; then as the `double` coordinates of a [`PLY`](super::ply), less an offset and rounded to `f32` once |
//! | red, green, blue | colours | of the point formats 2, 3, 5, 7, 8 and 10; **sRGB** of 16 bits, decoded in `f64` and rounded once |
//! | intensity | the property `intensity` | as it is stored, 0 to 65535 |
//! | classification | the property `classification` | as it is stored, 0 to 31 in the formats 0 to 5 |
//!
//! The reader skips everything else: returns, angles, times, waveforms, extra bytes, and records of
//! variable length. It keeps all points, also those that are marked as withheld.
//!
//! - Many programs write 8-bit codes where white is 65535. The reader leaves a
//!   [warning](Cloud::warnings) where no colour is above 255, and
//!   [`ReadOptions::color_range`] mends it.
//! - `Decided:` if all colours are 0, the file has none. Programs choose a point format for other
//!   fields, and leave its colours empty.
//!
//! The reader compares every count with the length of the file before it allocates anything.
//! LAZ is decompressed by the crate laz, whose memory is bounded by checks here. A LAZ file may be
//! chunked or not, of the versions 1 to 4, with chunks of equal or of different sizes.
//!
//! The reader of the header is our own. The crate las brings six crates more, among them chrono and
//! uuid, allocates what a record of variable length claims, and gives no byte with an error.

mod header;
#[cfg(feature = "cli")]
mod laz;
#[cfg(test)]
mod tests;

use super::far::{self, Settled};
use super::guard::guarded;
use super::ply::ReadOptions;
use super::{Reason, input};
use crate::error::{Error, Result};
use crate::memory;
use crate::number::{MapInline, srgb};
use crate::scene::{Cloud, Property};
use glam::Vec3;
use header::Header;
use std::borrow::Cow;
use std::path::Path;

/// The most memory that a point takes beside its record: its position in f64 and in `f32`, two
/// hashes of it or its colour, and two properties.
const BYTES_A_POINT: u64 = 64;

/// Reads a file.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, [`Error::Format`] as [`parse`].
pub fn read(path: &Path, options: &ReadOptions) -> Result<Cloud> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    parse(&bytes, options).map_err(|what| Error::format(path, what))
}

/// Reads the bytes of a file.
///
/// # Errors
/// One line if the bytes are no LAS, are truncated, have no points, or cannot be decompressed.
pub fn parse(bytes: &[u8], options: &ReadOptions) -> std::result::Result<Cloud, String> {
    let header = Header::parse(bytes)?;
    let record = header.stride as u64 * u64::from(header.is_compressed);
    memory::try_ask(header.count.saturating_mul(BYTES_A_POINT + record), || {
        format!("a cloud of {} points", header.count)
    })?;
    let records = match header.is_compressed {
        false => Cow::Borrowed(header.records(bytes)?),
        true => Cow::Owned(guarded(|| decompress(bytes, &header)).flatten()?),
    };
    cloud(&header, &records, options)
}

#[cfg(feature = "cli")]
fn decompress(bytes: &[u8], header: &Header) -> Reason<Vec<u8>> {
    laz::decompress(bytes, header)
}

#[cfg(not(feature = "cli"))]
fn decompress(_: &[u8], _: &Header) -> Reason<Vec<u8>> {
    Err("LAZ is read with the feature `cli` of this crate only; give a LAS file".into())
}

/// Makes the cloud from the records.
fn cloud(header: &Header, records: &[u8], options: &ReadOptions) -> Reason<Cloud> {
    let rows = || records.chunks_exact(header.stride);
    let whole = |row: &[u8], axis: usize| f64::from(i32::from_le_bytes(bytes_at(row, 4 * axis)));
    let place = |row: &[u8]| {
        [0, 1, 2].map_inline(|axis| whole(row, axis) * header.scale[axis] + header.offset[axis])
    };
    let positions: Vec<[f64; 3]> = rows().map(place).collect();
    let Settled { position, offset, warning } = far::settle(&positions, options.keep_place)?;
    drop(positions);
    let intensity = rows().map(|row| f32::from(u16_at(row, 12))).collect();
    let (at, bits) = header.classification();
    let class = rows().map(|row| f32::from(row[at] & bits)).collect();
    let property = |name: &str, values| Property { name: name.into(), values };
    let mut cloud = Cloud {
        position,
        offset,
        properties: vec![property("intensity", intensity), property("classification", class)],
        warnings: warning.into_iter().collect(),
        ..Cloud::default()
    };
    if let Some(at) = header.color() {
        colors(
            rows().map(|row| [0, 2, 4].map_inline(|c| u16_at(row, at + c))),
            options,
            &mut cloud,
        );
    }
    Ok(cloud)
}

/// Decodes the colours, unless all are 0.
fn colors(codes: impl Iterator<Item = [u16; 3]> + Clone, options: &ReadOptions, cloud: &mut Cloud) {
    let most = codes.clone().flatten().fold(0, u16::max);
    if most == 0 {
        return;
    }
    let white = options.color_range.unwrap_or(u16::MAX.into());
    let table: Vec<f32> =
        (0..=most).map(|code| srgb::to_linear(f64::from(code) / white) as f32).collect();
    let linear = |code: u16| table[usize::from(code)];
    cloud.color = Some(codes.map(|all| Vec3::from_array(all.map_inline(linear))).collect());
    let doubt = match options.color_range {
        None if most <= 255 => Some(
            "no colour is above 255, where white is 65535: all is almost black; if they are codes \
             of 0 to 255, write `color_range = 255` in a scene file"
                .to_owned(),
        ),
        Some(range) if f64::from(most) > range => {
            Some(format!("colours are greater than their color_range of {range}"))
        }
        _ => None,
    };
    cloud.warnings.extend(doubt);
}

/// The bytes at a place of a record, which [`Header::parse`] has found long enough.
fn bytes_at<const N: usize>(row: &[u8], at: usize) -> [u8; N] {
    row.get(at..).and_then(|rest| rest.first_chunk().copied()).unwrap_or([0; N])
}

fn u16_at(row: &[u8], at: usize) -> u16 {
    u16::from_le_bytes(bytes_at(row, at))
}
