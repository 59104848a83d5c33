//! Read PNG files, and encode pictures for comparison with them.

use super::{quantize, straight};
use crate::error::{Error, Result};
use crate::frame::image::Values;
use crate::frame::{Image, Plane};
use crate::io::guard::guarded;
use crate::io::input;
use crate::memory;
use crate::number::srgb;
use image::codecs::png::PngDecoder;
use image::{ColorType, ImageDecoder, ImageError, Limits};
use std::io::Cursor;
use std::path::Path;

/// Deflate expands one byte to at most 1032.
const MOST_EXPANSION: u64 = 1032;

/// The contents of a PNG file.
#[derive(Clone, Debug, PartialEq)]
pub struct Stored {
    /// The channels `R`, `G`, `B` and, if the file has it, `A`: each code divided by the greatest
    /// code.
    pub image: Image,
    /// The greatest code: 255, or 65,535 for a file of 16 bits a channel.
    pub most: u16,
}

/// Reads the PNG file at `path`: its codes as numbers in [0, 1], each `code / most`.
///
/// Grey gives R = G = B, a palette is looked up, and fewer than 8 bits are widened to 8. The codes
/// are taken as sRGB, whatever the file says about gamma or profile.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read. [`Error::Format`] if the file is no PNG, is damaged,
/// or promises more pixels than its bytes can hold; this is found before the pixels are allocated.
pub fn read(path: &Path) -> Result<Stored> {
    Ok(codes_of_size(path, |_, _| Ok(()))?.stored())
}

/// Reads the colours of the PNG file at `path` in linear light: each code is decoded as sRGB and
/// rounded once. Alpha is ignored.
///
/// # Errors
/// As [`read`], and [`Error::Format`] with the error of `check_size`, before any pixel is read.
pub(in crate::io) fn read_linear(
    path: &Path,
    check_size: fn(u32, u32) -> Result<()>,
) -> Result<Plane<[f32; 3]>> {
    Ok(codes_of_size(path, check_size)?.linear())
}

fn codes_of_size(path: &Path, check_size: fn(u32, u32) -> Result<()>) -> Result<Codes> {
    guarded(|| decode(path, check_size)).map_err(|what| Error::format(path, what))?
}

fn decode(path: &Path, check_size: fn(u32, u32) -> Result<()>) -> Result<Codes> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    let length = bytes.len() as u64;
    let most_bytes = length.saturating_mul(MOST_EXPANSION);
    let mut limits = Limits::no_limits();
    // The decoder needs some 100 KB for itself, whatever the file.
    limits.max_alloc = Some(most_bytes.saturating_add(1 << 20));
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits)
        .map_err(|error| reason(path, &error))?;
    let (width, height) = decoder.dimensions();
    if decoder.total_bytes() > most_bytes {
        check_size(width, height).map_err(|error| Error::format(path, error.to_string()))?;
        return Err(Error::format(
            path,
            format!(
                "header: declares {width} x {height} pixels, more than a file of {length} bytes \
                 can hold; write it again"
            ),
        ));
    }
    Codes::decode(decoder, path, check_size, 0)
}

/// The decoder's message as the error of a file. It stays on one line, even if the message has
/// several.
pub(super) fn reason(path: &Path, error: &ImageError) -> Error {
    Error::format(path, format!("{error}; write it again").replace('\n', " "))
}

/// The codes of a file, as many for each pixel as the file has components.
pub(super) struct Codes {
    size: [u32; 2],
    components: usize,
    /// The greatest code.
    most: u16,
    codes: Vec<u16>,
}

impl Codes {
    /// Decodes a picture whose size passes `check_size`, if there is memory for it. The decoder
    /// itself holds `own` bytes for each pixel.
    pub(super) fn decode(
        decoder: impl ImageDecoder,
        path: &Path,
        check_size: fn(u32, u32) -> Result<()>,
        own: u64,
    ) -> Result<Self> {
        let (width, height) = decoder.dimensions();
        check_size(width, height).map_err(|error| Error::format(path, error.to_string()))?;
        // The bytes, their codes in 16 bits, and up to four planes of floats.
        let planes = u64::from(width).saturating_mul(u64::from(height)).saturating_mul(16 + own);
        memory::try_ask(decoder.total_bytes().saturating_mul(3).saturating_add(planes), || {
            format!("a picture of {width} x {height} pixels")
        })
        .map_err(|what| Error::format(path, what))?;
        let kind = decoder.color_type();
        let mut bytes = vec![0; decoder.total_bytes() as usize];
        decoder.read_image(&mut bytes).map_err(|error| reason(path, &error))?;
        Ok(Self::separate([width, height], kind, &bytes))
    }

    /// Reads the decoder's bytes; 16-bit codes are in this machine's order.
    fn separate(size: [u32; 2], kind: ColorType, bytes: &[u8]) -> Self {
        let components = usize::from(kind.channel_count());
        let (codes, most) = if kind.bytes_per_pixel() as usize > components {
            let pairs = bytes.as_chunks().0.iter();
            (pairs.map(|&pair| u16::from_ne_bytes(pair)).collect(), u16::MAX)
        } else {
            (bytes.iter().map(|&code| u16::from(code)).collect(), 255)
        };
        Self { size, components, most, codes }
    }

    /// The colours in linear light: each code is decoded as sRGB and rounded once.
    pub(super) fn linear(&self) -> Plane<[f32; 3]> {
        let Self { size: [width, height], components, most, ref codes } = *self;
        let table = srgb::table(most);
        let linear = |code: u16| table[usize::from(code)];
        // Grey, with or without alpha, is one colour three times.
        let pixels = codes.chunks_exact(components).map(|pixel| match *pixel {
            [r, g, b, ..] => [linear(r), linear(g), linear(b)],
            [grey, ..] => [linear(grey); 3],
            [] => [0.0; 3],
        });
        Plane::from_values(width, height, pixels.collect())
    }

    /// The channels of the picture.
    fn stored(&self) -> Stored {
        let Self { size: [width, height], components, most, ref codes } = *self;
        // Places of the components in a pixel: grey, grey and alpha, colour, colour and alpha.
        let places: &[(&str, usize)] = match components {
            1 => &[("B", 0), ("G", 0), ("R", 0)],
            2 => &[("A", 1), ("B", 0), ("G", 0), ("R", 0)],
            3 => &[("B", 2), ("G", 1), ("R", 0)],
            _ => &[("A", 3), ("B", 2), ("G", 1), ("R", 0)],
        };
        let channels = places.iter().map(|&(name, place)| {
            let codes = codes.iter().skip(place).step_by(components);
            let values = codes.map(|&code| f32::from(code) / f32::from(most)).collect();
            (name.to_owned(), Values::Float(values))
        });
        let channels = channels.collect();
        Stored { image: Image { width, height, channels, text: None }, most }
    }
}

impl Stored {
    /// Encodes a linear picture as this crate would store it in a PNG of the same kind.
    ///
    /// `Decided:` a PNG is compared as it is stored. The linear picture is encoded just as
    /// [`super::write_frame()`] does, with the PNG's number of bits. If the PNG has alpha, colours
    /// are divided by an alpha in (0, 1). Colours are encoded as sRGB, clipped and rounded to a
    /// code; alpha is rounded to a code. Therefore the preview of a picture equals that picture,
    /// and one code of 8 bits is a difference of 1/255. Only the float channels `R`, `G`, `B` and,
    /// if the PNG has it, `A` of `linear` are kept.
    #[must_use]
    pub fn encode(&self, linear: &Image) -> Image {
        let floats = |name: &str| match linear.channel(name) {
            Some(Values::Float(values)) => Some(values),
            _ => None,
        };
        let has_alpha = self.image.channel("A").is_some();
        let alpha = floats("A").filter(|_| has_alpha);
        let most = f64::from(self.most);
        let code = |value: f64| (f64::from(quantize(value, self.most)) / most) as f32;
        let mut channels = Vec::new();
        if let Some(alpha) = alpha {
            let codes = alpha.iter().map(|&a| code(f64::from(a))).collect();
            channels.push(("A".to_owned(), Values::Float(codes)));
        }
        for name in ["B", "G", "R"] {
            let Some(values) = floats(name) else { continue };
            let codes = values.iter().enumerate().map(|(i, &value)| {
                let value = alpha.map_or(value, |alpha| straight(value, alpha[i]));
                code(srgb::from_linear(f64::from(value)))
            });
            channels.push((name.to_owned(), Values::Float(codes.collect())));
        }
        Image { width: linear.width, height: linear.height, channels, text: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::{Criteria, Verdict, compare};
    use crate::frame::{Frame, Samples};
    use image::{ExtendedColorType, ImageEncoder};
    use std::fs;
    use tempfile::TempDir;

    fn png(width: u32, height: u32, kind: ExtendedColorType, bytes: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut file);
        encoder.write_image(bytes, width, height, kind).unwrap();
        file
    }

    fn read_bytes(bytes: &[u8]) -> Result<Stored> {
        let at = TempDir::new().unwrap();
        let path = at.path().join("a.png");
        fs::write(&path, bytes).unwrap();
        read(&path)
    }

    fn floats(image: &Image, name: &str) -> Vec<f32> {
        let Some(Values::Float(values)) = image.channel(name) else { panic!("no {name}") };
        values.clone()
    }

    #[test]
    fn codes_become_parts_of_the_greatest() {
        let found = read_bytes(&png(2, 1, ExtendedColorType::Rgb8, &[0, 51, 255, 1, 2, 3]));
        let found = found.unwrap();
        assert_eq!((found.image.width, found.image.height, found.most), (2, 1, 255));
        assert_eq!(floats(&found.image, "R"), [0.0, 1.0 / 255.0]);
        assert_eq!(floats(&found.image, "G"), [0.2, 2.0 / 255.0]);
        assert_eq!(floats(&found.image, "B"), [1.0, 3.0 / 255.0]);
        assert!(found.image.channel("A").is_none());

        let grey = read_bytes(&png(1, 2, ExtendedColorType::La8, &[51, 255, 102, 0])).unwrap();
        for name in ["R", "G", "B"] {
            assert_eq!(floats(&grey.image, name), [0.2, 0.4], "{name}");
        }
        assert_eq!(floats(&grey.image, "A"), [1.0, 0.0]);

        let deep: Vec<u8> = [0_u16, 13_107, 65_535].map(u16::to_ne_bytes).concat();
        let deep = read_bytes(&png(3, 1, ExtendedColorType::L16, &deep)).unwrap();
        assert_eq!((floats(&deep.image, "G"), deep.most), (vec![0.0, 0.2, 1.0], 65_535));
    }

    /// The preview of a picture is, as a PNG, equal to that picture, alpha included.
    #[test]
    fn a_preview_equals_its_picture() {
        let at = TempDir::new().unwrap();
        let path = at.path().join("a.png");
        let (width, height) = (64, 40);
        let count = width * height;
        let unit = |seed, i| crate::number::random::unit(seed, u64::from(i));
        let colors = (0..count).map(|i| [1, 2, 3].map(|seed| 1.5 * unit(seed, i) - 0.25)).collect();
        let alphas = (0..count).map(|i| [0.0, 1.0, unit(4, i)][i as usize % 3]).collect();
        let color = Samples::Color(Plane::from_values(width, height, colors));
        let alpha = Samples::Scalar(Plane::from_values(width, height, alphas));
        let depth = Samples::Scalar(Plane::filled(width, height, 1.0));
        let mut frame = Frame::new(width, height).with("", color).unwrap();
        for more in [None, Some(("A", alpha)), Some(("Z", depth))] {
            more.into_iter().for_each(|(name, samples)| frame.push(name, samples).unwrap());
            super::super::write_frame(&path, &frame).unwrap();
            let stored = read(&path).unwrap();
            let encoded = stored.encode(&Image::from(&frame));
            let found = compare(&encoded, &stored.image, &Criteria::default()).unwrap();
            assert_eq!(found.verdict(), Verdict::Equal, "{:?}", found.lines());
            assert_eq!(found.channels.len(), 3 + usize::from(frame.planes.len() > 1));
        }
    }

    #[test]
    fn sixteen_bits_are_encoded_as_sixteen() {
        let deep = png(1, 1, ExtendedColorType::Rgb16, &[0; 6]);
        let linear = Image {
            width: 1,
            height: 1,
            channels: ["B", "G", "R"].map(|c| (c.into(), Values::Float(vec![0.18]))).to_vec(),
            text: None,
        };
        let encoded = read_bytes(&deep).unwrap().encode(&linear);
        let code = (srgb::from_linear(f64::from(0.18_f32)) * 65_535.0).round();
        assert_eq!(floats(&encoded, "R"), [(code / 65_535.0) as f32]);
    }

    #[test]
    fn what_is_no_png_is_refused_in_one_line() {
        let good = png(64, 64, ExtendedColorType::Rgb8, &[7; 64 * 64 * 3]);
        let mut huge = good.clone();
        // Width and height of IHDR, and the checksum over type and data.
        huge[16..24].copy_from_slice(&[0, 0, 0xFF, 0xFF, 0, 0, 0xFF, 0xFF]);
        let crc = crc32(&huge[12..29]);
        huge[29..33].copy_from_slice(&crc.to_be_bytes());
        let mut damaged = good.clone();
        let middle = damaged.len() / 2;
        damaged[middle] ^= 0xFF;
        for (bytes, why) in [
            (b"".to_vec(), "write it again"),
            (b"\x76\x2f\x31\x01 an EXR".to_vec(), "write it again"),
            (good[..good.len() - 20].to_vec(), "write it again"),
            (damaged, "write it again"),
            (huge, "declares 65535 x 65535 pixels, more than a file of"),
        ] {
            let line = read_bytes(&bytes).unwrap_err().to_string();
            assert!(line.contains("a.png: ") && line.contains(why), "{line}");
            assert_eq!(line.lines().count(), 1, "{line}");
        }
        assert!(matches!(read(Path::new("no such.png")), Err(Error::Io { .. })));
    }

    /// A chunk with its length and its checksum.
    fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
        let body = [&kind[..], data].concat();
        let crc = crc32(&body);
        [&(data.len() as u32).to_be_bytes()[..], &body, &crc.to_be_bytes()].concat()
    }

    /// A PNG of 3 x 3 pixels of this colour type and depth, as chunks.
    fn chunks(kind: u8, depth: u8) -> Vec<([u8; 4], Vec<u8>)> {
        let samples = match kind {
            2 => 3,
            4 => 2,
            6 => 4,
            _ => 1,
        };
        let row = 1 + (3 * samples * usize::from(depth)).div_ceil(8);
        let rows: Vec<u8> =
            (0..3 * row).map(|i| if i % row == 0 { 0 } else { (37 * i) as u8 }).collect();
        let mut all = vec![(*b"IHDR", vec![0, 0, 0, 3, 0, 0, 0, 3, depth, kind, 0, 0, 0])];
        if kind == 3 {
            all.push((*b"PLTE", (0..3_usize << depth).map(|i| (7 * i) as u8).collect()));
            all.push((*b"tRNS", vec![9, 200]));
        }
        let data = miniz_oxide::deflate::compress_to_vec_zlib(&rows, 6);
        all.extend([(*b"IDAT", data), (*b"IEND", Vec::new())]);
        all
    }

    fn joined(chunks: &[([u8; 4], Vec<u8>)]) -> Vec<u8> {
        let each = chunks.iter().flat_map(|(kind, data)| chunk(kind, data));
        b"\x89PNG\r\n\x1a\n".iter().copied().chain(each).collect()
    }

    const KINDS: [(u8, &[u8]); 5] =
        [(0, &[1, 2, 4, 8, 16]), (2, &[8, 16]), (3, &[1, 2, 4, 8]), (4, &[8, 16]), (6, &[8, 16])];

    /// Whatever the decoder does, the reader returns; an error is one line.
    fn returns(bytes: &[u8]) {
        if let Err(error) = read_bytes(bytes) {
            assert_eq!(error.to_string().lines().count(), 1, "{error}");
        }
    }

    #[test]
    fn no_mutation_of_any_colour_type_makes_it_panic() {
        for (kind, depths) in KINDS {
            for &depth in depths {
                let whole = chunks(kind, depth);
                let good = joined(&whole);
                read_bytes(&good).unwrap();
                (0..good.len()).step_by(3).for_each(|end| returns(&good[..end]));
                for at in (8..good.len()).step_by(2) {
                    let mut flipped = good.clone();
                    flipped[at] ^= 1 << (at % 8);
                    returns(&flipped);
                }
                // The checksums are right, so that the damage gets through to the decoder.
                for (i, (_, data)) in whole.iter().enumerate() {
                    for byte in 0..data.len() {
                        let mut other = whole.clone();
                        other[i].1[byte] ^= 1 << (byte % 8);
                        returns(&joined(&other));
                        other[i].1.truncate(byte);
                        returns(&joined(&other));
                    }
                    let mut without = whole.clone();
                    without.remove(i);
                    returns(&joined(&without));
                    let mut twice = whole.clone();
                    twice.insert(i, whole[i].clone());
                    returns(&joined(&twice));
                    let mut longer = whole.clone();
                    longer[i].1.push(7);
                    returns(&joined(&longer));
                }
            }
        }
    }

    #[test]
    fn a_palette_that_is_none_is_an_error() {
        for length in [0, 1, 4, 5] {
            let mut broken = chunks(3, 8);
            broken[1].1.truncate(length);
            let line = read_bytes(&joined(&broken)).unwrap_err().to_string();
            assert!(line.contains("a.png: ") && line.contains("write it again"), "{line}");
        }
    }

    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0, |crc: u32, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
                (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 }
            })
        })
    }
}
