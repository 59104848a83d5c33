//! Read `.spz`, versions 1 to 3: a gzip stream with a header of 16 bytes, and one array after the
//! other.

use super::GaussianFile;
use crate::error::{Error, Result};
use crate::io::activation;
use crate::io::{Reason, input};
use crate::memory;
use crate::scene::GaussianArrays;
use crate::scene::gaussians::{Encoding, MAX_DEGREE, coefficients};
use exr::prelude::f16;
use flate2::bufread::GzDecoder;
use glam::{DVec3, Vec3};
use std::io::{self, Read};
use std::path::Path;

const MAGIC: &[u8] = b"NGSP";
/// Deflate writes 258 equal bytes as 2 bits at best.
const MOST_BYTES_OF_ONE: u64 = 1032;
/// The colours 0 to 1 become first coefficients of -1/2 to 1/2, divided by this.
const COLOR: f64 = 0.15;
/// The flag of Gaussians that were trained with a filter that keeps the light of small ones.
const ANTIALIASED: u8 = 1;

/// Reads a file.
///
/// # Errors
/// As [`super::read`].
pub(super) fn read(path: &Path) -> Result<GaussianFile> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    parse(&bytes).map_err(|what| Error::format(path, what))
}

fn parse(file: &[u8]) -> Reason<GaussianFile> {
    if file.starts_with(MAGIC) {
        return Err(match file.get(4) {
            Some(version @ 1..=3) => {
                format!("SPZ version {version} is compressed, but this file is not: gzip it")
            }
            _ => "SPZ version 4 is compressed with Zstandard, which is not read: write it \
                  as version 3, as PLY or as GLB"
                .into(),
        });
    }
    if !file.starts_with(&[0x1F, 0x8B]) {
        return Err("this is no SPZ, which begins as a gzip stream does".into());
    }
    let mut stream = GzDecoder::new(file);
    let mut header = [0; 16];
    stream.read_exact(&mut header).map_err(damage)?;
    let header = Header::new(&header)?;
    let body = header.body(&mut stream, file.len() as u64)?;
    match stream.into_inner().len() {
        0 => Ok(header.file(&body)),
        more => Err(format!("{more} bytes follow the gzip stream: the file is damaged")),
    }
}

/// Why a gzip stream cannot be read.
fn damage(error: io::Error) -> String {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => "the gzip stream ends early: the file is truncated".into(),
        _ => format!("the gzip stream is damaged: {error}"),
    }
}

struct Header {
    version: u32,
    count: u32,
    degree: u32,
    /// How many binary digits a position has behind the point.
    places: u8,
    flags: u8,
}

impl Header {
    fn new(bytes: &[u8; 16]) -> Reason<Self> {
        let word = |at: usize| {
            u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
        };
        if !bytes.starts_with(MAGIC) {
            return Err("the gzip stream holds no SPZ, which begins with NGSP".into());
        }
        let [version, count] = [word(4), word(8)];
        let [degree, places, flags] = [bytes[12], bytes[13], bytes[14]];
        if !(1..=3).contains(&version) {
            return Err(format!("SPZ version {version} is not read: give version 1, 2 or 3"));
        }
        if count == 0 {
            return Err("the header promises no Gaussians: give a file with some".into());
        }
        if u32::from(degree) > MAX_DEGREE {
            return Err(format!(
                "spherical harmonics of degree {degree} are not drawn: write the file with degree \
                 {MAX_DEGREE} or less"
            ));
        }
        if places > 30 {
            return Err(format!(
                "the header has positions with {places} binary places, but at most 30 are \
                 possible: the file is damaged"
            ));
        }
        Ok(Self { version, count, degree: degree.into(), places, flags })
    }

    /// The bytes of a Gaussian in each array: position, opacity, colour, scale, rotation, and the
    /// other coefficients.
    fn widths(&self) -> [usize; 6] {
        let [position, rotation] = match self.version {
            1 => [6, 3],
            2 => [9, 3],
            _ => [9, 4],
        };
        [position, 1, 3, 3, rotation, 3 * (coefficients(self.degree) - 1)]
    }

    /// Reads all arrays, from a file of `length` bytes, and the end of the stream, which has a
    /// checksum.
    fn body(&self, stream: &mut impl Read, length: u64) -> Reason<Vec<u8>> {
        let (count, each) = (u64::from(self.count), self.widths().iter().sum::<usize>() as u64);
        let wanted = count * each;
        if wanted > length.saturating_mul(MOST_BYTES_OF_ONE) {
            return Err(format!(
                "the header promises {count} Gaussians, which is more than {length} bytes can \
                 hold: the file is truncated or damaged"
            ));
        }
        let held = each + 44 + 12 * coefficients(self.degree) as u64;
        memory::try_ask(count * held, || format!("{count} Gaussians"))?;
        let mut body = Vec::new();
        stream.take(wanted).read_to_end(&mut body).map_err(damage)?;
        if (body.len() as u64) < wanted {
            return Err(format!(
                "the header promises {count} Gaussians, which are {wanted} bytes, but {} follow: \
                 the file is truncated or damaged",
                body.len()
            ));
        }
        let more = io::copy(stream, &mut io::sink()).map_err(damage)?;
        if more > 0 && !self.has_more() {
            return Err(format!("{more} bytes follow the {count} Gaussians: the file is damaged"));
        }
        Ok(body)
    }

    /// Whether a flag announces that something follows.
    fn has_more(&self) -> bool {
        self.flags & !ANTIALIASED != 0
    }

    fn file(&self, body: &[u8]) -> GaussianFile {
        let count = self.count as usize;
        let mut rest = body;
        let widths = self.widths();
        let [positions, opacities, colors, scales, rotations, others] = widths.map(|width| {
            let (own, more) = rest.split_at(width * count);
            rest = more;
            (0..count).map(move |i| &own[width * i..][..width])
        });
        let harmonics = colors.zip(others).flat_map(|(color, others)| {
            let others = others.chunks_exact(3).map(|bytes| three(bytes, coefficient));
            std::iter::once(three(color, first_coefficient)).chain(others)
        });
        let arrays = GaussianArrays {
            position: positions.map(|bytes| self.position(bytes)).collect(),
            scale: scales.map(|bytes| three(bytes, scale)).collect(),
            rotation: rotations.map(rotation).collect(),
            opacity: opacities.map(|byte| (f64::from(byte[0]) / 255.0) as f32).collect(),
            degree: self.degree,
            harmonics: harmonics.collect(),
            encoding: Encoding::Srgb,
        };
        GaussianFile {
            arrays,
            offset: DVec3::ZERO,
            convention: self.convention(),
            warnings: self.warnings(),
        }
    }

    fn position(&self, bytes: &[u8]) -> Vec3 {
        if self.version == 1 {
            return Vec3::from_array(
                [0, 2, 4].map(|at| f16::from_le_bytes([bytes[at], bytes[at + 1]]).to_f32()),
            );
        }
        let unit = 1.0 / (1_u32 << self.places) as f32;
        Vec3::from_array([0, 3, 6].map(|at| {
            // The shift repeats the sign of 24 bits.
            let fixed = i32::from_le_bytes([0, bytes[at], bytes[at + 1], bytes[at + 2]]) >> 8;
            fixed as f32 * unit
        }))
    }

    fn convention(&self) -> String {
        let positions = if self.version == 1 { "half floats" } else { "24 bits" };
        let trained = match self.flags & ANTIALIASED {
            0 => "without antialiasing",
            _ => "with antialiasing: draw it with --compensation ratio or --preset mip",
        };
        format!(
            "SPZ version {}: positions of {positions}, other numbers of bytes, axes right, up, back; \
             trained {trained}",
            self.version
        )
    }

    fn warnings(&self) -> Vec<String> {
        let unknown = self.flags & !ANTIALIASED;
        if unknown == 0 {
            return Vec::new();
        }
        vec![format!(
            "the flags {unknown:#04x} announce extensions, which are skipped; they may name other \
             axes than right, up, back: turn the scene with a `transform` if it is on its side"
        )]
    }
}

/// Three bytes as numbers.
fn three(bytes: &[u8], number: fn(u8) -> f32) -> Vec3 {
    Vec3::new(number(bytes[0]), number(bytes[1]), number(bytes[2]))
}

fn scale(byte: u8) -> f32 {
    activation::scale(f64::from(byte) / 16.0 - 10.0)
}

fn first_coefficient(byte: u8) -> f32 {
    ((f64::from(byte) / 255.0 - 0.5) / COLOR) as f32
}

fn coefficient(byte: u8) -> f32 {
    (f32::from(byte) - 128.0) / 128.0
}

/// A quaternion x, y, z, w whose length is 1.
fn rotation(bytes: &[u8]) -> [f32; 4] {
    if let &[x, y, z] = bytes {
        let [x, y, z] = [x, y, z].map(|byte| f64::from(byte) / 127.5 - 1.0);
        let square = 1.0 - (x * x + y * y + z * z);
        // Rounded bytes may be a little longer than 1.
        let w = if square > 0.0 { square.sqrt() } else { 0.0 };
        return [x, y, z, w].map(|part| part as f32);
    }
    let mut bits = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    let greatest = (bits >> 30) as usize;
    let mut parts = [0.0; 4];
    let mut square = 1.0;
    for i in (0..4).rev().filter(|&i| i != greatest) {
        let part = f64::from(bits & 511) / 511.0 * std::f64::consts::FRAC_1_SQRT_2;
        parts[i] = if bits & 512 == 0 { part } else { -part };
        square -= part * part;
        bits >>= 10;
    }
    // NaN if the others are longer than 1, which no writer leaves: such a Gaussian is dropped.
    parts[greatest] = square.sqrt();
    parts.map(|part| part as f32)
}

#[cfg(test)]
mod tests;
