//! Write 8-bit previews for people to look at, and read PNG files to compare them as they are
//! stored.

mod jpeg;
mod read;

pub(super) use jpeg::read_linear as read_jpeg;
pub(super) use read::read_linear;
pub use read::{Stored, read};

use crate::error::{Error, Result};
use crate::frame::{Frame, Plane};
use crate::io::replace::{Pending, write_atomically};
use crate::number::MapInline;
use crate::number::srgb;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageError};
use std::io;
use std::path::Path;

/// Writes the preview of a frame: the colour plane with the empty name, over the coverage `A` if
/// the frame has one. Writes nothing if the frame has no colour.
///
/// PNG stores colours that are not multiplied by alpha, so the colour is divided by alpha where
/// alpha is in (0, 1).
///
/// # Errors
/// As [`write()`].
pub fn write_frame(path: &Path, frame: &Frame<f32>) -> Result<()> {
    pending_frame(path, frame)?.map_or(Ok(()), Pending::put)
}

/// Does all of [`write_frame`] except to put the file in its place, for files that belong together;
/// `None` if the frame has no colour.
///
/// # Errors
/// As [`write()`].
pub fn pending_frame(path: &Path, frame: &Frame<f32>) -> Result<Option<Pending>> {
    let Ok(color) = frame.color("") else { return Ok(None) };
    pending(path, color, frame.scalar("A").ok(), straight).map(Some)
}

/// The bytes of the PNG that [`write_frame`] writes; `None` if the frame has no colour.
///
/// # Errors
/// [`Error::Invalid`] if the frame has no pixel.
pub fn encode_frame(frame: &Frame<f32>) -> Result<Option<Vec<u8>>> {
    let Ok(color) = frame.color("") else { return Ok(None) };
    let preview = Preview::new(color, frame.scalar("A").ok(), straight)?;
    let mut bytes = Vec::new();
    let encoded = preview.encode(&mut bytes);
    encoded.map_err(|error| Error::Invalid(format!("the PNG: {error}")))?;
    Ok(Some(bytes))
}

/// Divides a colour over black by its alpha.
fn straight(value: f32, alpha: f32) -> f32 {
    if alpha > 0.0 && alpha < 1.0 { value / alpha } else { value }
}

/// Writes a plane of linear RGB to the PNG file at `path`, sRGB-encoded, 8 bits a channel.
///
/// With `alpha`, a plane of coverage in [0, 1] of the same size, the file is RGBA. It is not
/// premultiplied, as PNG requires. Alpha is stored linearly, as `floor(255 a + 1/2)`. Values beyond
/// [0, 1] are clipped; NaN becomes 0. The pixels of the file are a function of the arguments; the
/// bytes also depend on the version of the `image` crate.
///
/// # Errors
/// [`Error::Invalid`] if the planes have no pixel or differ in size. [`Error::Io`] if the file
/// cannot be written; then nothing of it is left.
pub fn write(path: &Path, color: &Plane<[f32; 3]>, alpha: Option<&Plane<f32>>) -> Result<()> {
    pending(path, color, alpha, |value, _| value)?.put()
}

/// Does all of [`write()`] except to put the file in its place; `value` as for [`Preview::new`].
fn pending(
    path: &Path,
    color: &Plane<[f32; 3]>,
    alpha: Option<&Plane<f32>>,
    value: impl Fn(f32, f32) -> f32,
) -> Result<Pending> {
    let preview = Preview::new(color, alpha, value)?;
    Pending::write(path, |file| preview.encode(file))
}

/// The codes of a picture.
struct Preview {
    pixels: Vec<u8>,
    size: [u32; 2],
    kind: ExtendedColorType,
}

impl Preview {
    /// The codes of a picture. `value` maps each value of `color` and its alpha, if there is alpha.
    fn new(
        color: &Plane<[f32; 3]>,
        alpha: Option<&Plane<f32>>,
        value: impl Fn(f32, f32) -> f32,
    ) -> Result<Self> {
        let (width, height) = (color.width(), color.height());
        if width == 0 || height == 0 {
            return Err(Error::Invalid(format!(
                "a PNG cannot hold {width} x {height} pixels; render at least one"
            )));
        }
        if alpha.is_some_and(|a| (a.width(), a.height()) != (width, height)) {
            return Err(Error::Invalid(format!(
                "the alpha of a PNG must be {width} x {height} pixels"
            )));
        }
        let srgb = Srgb::new();
        let (pixels, kind) = match alpha {
            None => {
                let pixels =
                    color.values().as_flattened().iter().map(|&v| srgb.encode(v)).collect();
                (pixels, ExtendedColorType::Rgb8)
            }
            Some(alpha) => {
                let mut pixels = vec![0; 4 * color.values().len()];
                let values = color.values().iter().zip(alpha.values());
                for (pixel, (color, &a)) in pixels.as_chunks_mut().0.iter_mut().zip(values) {
                    let [r, g, b] = color.map_inline(|v| srgb.encode(value(v, a)));
                    *pixel = [r, g, b, quantize(f64::from(a), 255) as u8];
                }
                (pixels, ExtendedColorType::Rgba8)
            }
        };
        Ok(Self { pixels, size: [width, height], kind })
    }

    fn encode(&self, file: &mut impl io::Write) -> io::Result<()> {
        encode(file, &self.pixels, self.size, self.kind)
    }
}

/// Writes codes of 8 bits as they are: red, green and blue of each pixel, from the top row on.
///
/// # Errors
/// [`Error::Io`] if there are no codes or not `3 width height` of them, or if the file cannot be
/// written; then nothing of it is left.
pub fn write_codes(path: &Path, size: [u32; 2], codes: &[u8]) -> Result<()> {
    let wanted = size.map(u64::from).iter().product::<u64>() * 3;
    if wanted == 0 || codes.len() as u64 != wanted {
        let [width, height] = size;
        let what = format!("{} codes do not fill {width} x {height} pixels", codes.len());
        return Err(Error::io(path, io::Error::other(what)));
    }
    write_atomically(path, |file| encode(file, codes, size, ExtendedColorType::Rgb8))
}

/// Writes grey codes of 16 bits as they are, from the top row on.
///
/// # Errors
/// As [`write_codes`], with `width height` codes.
pub fn write_grey(path: &Path, size: [u32; 2], codes: &[u16]) -> Result<()> {
    if codes.is_empty() || codes.len() as u64 != size.map(u64::from).iter().product::<u64>() {
        let [width, height] = size;
        let what = format!("{} codes do not fill {width} x {height} pixels", codes.len());
        return Err(Error::io(path, io::Error::other(what)));
    }
    // The encoder takes the bytes of this machine.
    let bytes: Vec<u8> = codes.iter().flat_map(|code| code.to_ne_bytes()).collect();
    write_atomically(path, |file| encode(file, &bytes, size, ExtendedColorType::L16))
}

fn encode(
    file: &mut impl io::Write,
    pixels: &[u8],
    [width, height]: [u32; 2],
    kind: ExtendedColorType,
) -> io::Result<()> {
    let written = PngEncoder::new(file).write_image(pixels, width, height, kind);
    written.map_err(|error| match error {
        ImageError::IoError(error) => error,
        other => io::Error::other(other),
    })
}

/// The code `floor(most v + 1/2)` for v clipped to [0, 1]; 0 for NaN.
fn quantize(value: f64, most: u16) -> u16 {
    // The cast truncates, saturates, and turns NaN into 0.
    ((f64::from(most) * value + 0.5) as u16).min(most)
}

/// The 8-bit code of a linear value.
fn exact(linear: f32) -> u8 {
    quantize(srgb::from_linear(f64::from(linear)), 255) as u8
}

/// The function [`exact`] as a table.
struct Srgb {
    /// The smallest `f32` of each code except 0.
    least: [f32; 255],
    /// For each pattern of upper 16 bits from [`Srgb::FIRST`] to 1, the code of the `f32` with only
    /// these bits.
    codes: Vec<u8>,
}

impl Srgb {
    /// 2^-12: only the codes 0 and 1 lie below. From here on, two numbers with the same upper 16
    /// bits are at most one code apart.
    const FIRST: f32 = 1.0 / 4096.0;

    /// Finds each code's smallest value by bisection over the bits of `f32` in [0, 1], which
    /// ascend; first near the inverse, because each step computes a power.
    fn new() -> Self {
        let exact_of = |bits: u32| usize::from(exact(f32::from_bits(bits)));
        let least = std::array::from_fn(|i| {
            let near = srgb::to_linear((i as f64 + 0.5) / 255.0) as f32;
            let (mut below, mut above) = (near.to_bits() - 4, near.to_bits() + 4);
            if !(exact_of(below) <= i && i < exact_of(above)) {
                (below, above) = (0.0_f32.to_bits(), 1.0_f32.to_bits());
            }
            while above - below > 1 {
                let middle = below + (above - below) / 2;
                if exact_of(middle) > i {
                    above = middle;
                } else {
                    below = middle;
                }
            }
            f32::from_bits(above)
        });
        let upper = Self::upper(Self::FIRST)..=Self::upper(1.0);
        let code = |upper: u32| {
            let value = f32::from_bits(upper << 16);
            least.partition_point(|&smallest| smallest <= value) as u8
        };
        Self { least, codes: upper.map(code).collect() }
    }

    fn upper(value: f32) -> u32 {
        value.to_bits() >> 16
    }

    /// The code of a linear value.
    fn encode(&self, linear: f32) -> u8 {
        if linear >= 1.0 {
            return 255;
        }
        // Also true for NaN, which then fails the comparison below and becomes 0.
        if !(linear >= Self::FIRST) {
            return u8::from(linear >= self.least[0]);
        }
        let code = self.codes[(Self::upper(linear) - Self::upper(Self::FIRST)) as usize];
        code + u8::from(self.least.get(usize::from(code)).is_some_and(|&next| next <= linear))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::elementary;

    #[test]
    fn codes_are_those_of_the_standard() {
        let srgb = Srgb::new();
        // Code, and linear values of published conversion tables: 18 % grey is 118, half is 188.
        for (linear, code) in [(0.18, 118), (0.5, 188), (0.25, 137), (0.05, 63), (0.002, 7)] {
            assert_eq!(srgb.encode(linear), code, "{linear}");
        }
        // The decoding formula, the standard's own inverse, leads back to every code.
        for code in 0..=255_u8 {
            let v = f64::from(code) / 255.0;
            let linear =
                if v <= 0.04045 { v / 12.92 } else { elementary::pow((v + 0.055) / 1.055, 2.4) };
            assert_eq!(srgb.encode(linear as f32), code);
        }
    }

    #[test]
    fn what_lies_outside_is_clipped() {
        let srgb = Srgb::new();
        let outside = [-1.0, -0.0, f32::NEG_INFINITY, f32::NAN, 1.5, f32::INFINITY];
        assert_eq!(outside.map(|v| srgb.encode(v)), [0, 0, 0, 0, 255, 255]);
        assert_eq!(outside.map(|v| quantize(f64::from(v), 255)), [0, 0, 0, 0, 255, 255]);
    }

    #[test]
    fn the_table_is_the_formula() {
        let srgb = Srgb::new();
        let sample = (0..=1.0_f32.to_bits()).step_by(9973);
        let edges =
            srgb.least.iter().flat_map(|v| v.to_bits() - 2..=v.to_bits().min(0x3F7F_FFFE) + 1);
        for bits in sample.chain(edges) {
            let linear = f32::from_bits(bits);
            assert_eq!(srgb.encode(linear), exact(linear), "{linear:e}");
        }
    }

    #[test]
    fn pixels_come_back_in_order() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let color = Plane::from_values(3, 1, vec![[0.0, 0.5, 1.0], [0.18, 2.0, -1.0], [0.25; 3]]);
        write(&path, &color, None).unwrap();
        let back = image::open(&path).unwrap();
        assert_eq!(back.as_rgb8().unwrap().as_raw(), &[0, 188, 255, 118, 255, 0, 137, 137, 137]);
        let alpha = Plane::from_values(3, 1, vec![0.0, 0.5, 7.0]);
        write(&path, &color, Some(&alpha)).unwrap();
        let back = image::open(&path).unwrap();
        let expected = [0, 188, 255, 0, 118, 255, 0, 128, 137, 137, 137, 255];
        assert_eq!(back.as_rgba8().unwrap().as_raw(), &expected);
    }

    #[test]
    fn what_is_no_picture_is_refused_and_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        assert!(write(&path, &Plane::filled(0, 4, [0.0; 3]), None).is_err());
        let alpha = Plane::filled(4, 2, 1.0);
        assert!(write(&path, &Plane::filled(4, 4, [0.0; 3]), Some(&alpha)).is_err());
        let missing = folder.path().join("no such folder").join("a.png");
        let error = write(&missing, &Plane::filled(1, 1, [0.0; 3]), None).unwrap_err();
        assert!(matches!(error, Error::Io { .. }), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
