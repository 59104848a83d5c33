//! Read JPEG files, as textures.

use super::read::{Codes, reason};
use crate::error::{Error, Result};
use crate::frame::Plane;
use crate::io::guard::guarded;
use crate::io::input;
use image::codecs::jpeg::JpegDecoder;
use std::io::Cursor;
use std::path::Path;

/// Bytes for each pixel that the decoder itself holds.
const COEFFICIENTS: u64 = 16;

/// Reads the colours of the JPEG file at `path` in linear light: each code is decoded as sRGB and
/// rounded once.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read. [`Error::Format`] if it is no JPEG, is damaged or cut
/// off, with the error of `check_size`, or if there is too little memory.
pub(in crate::io) fn read_linear(
    path: &Path,
    check_size: fn(u32, u32) -> Result<()>,
) -> Result<Plane<[f32; 3]>> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    // The decoder fills the rest of a picture that is cut off with grey.
    let last = |marker: [u8; 2]| bytes.windows(2).rposition(|pair| pair == marker);
    if bytes.starts_with(&[0xFF, 0xD8]) && last([0xFF, 0xD9]) < last([0xFF, 0xDA]) {
        return Err(Error::format(path, "the JPEG is cut off; write it again"));
    }
    let decode = || {
        let decoder =
            JpegDecoder::new(Cursor::new(&bytes)).map_err(|error| reason(path, &error))?;
        Codes::decode(decoder, path, check_size, COEFFICIENTS)
    };
    let codes = guarded(decode).map_err(|what| Error::format(path, what))??;
    Ok(codes.linear())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::srgb;
    use crate::scene::Texture;
    use image::ExtendedColorType::{L8, Rgb8};
    use image::codecs::jpeg::JpegEncoder;
    use std::fs;
    use tempfile::TempDir;

    fn jpeg(kind: image::ExtendedColorType, pixel: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let pixels = pixel.repeat(20 * 9);
        JpegEncoder::new_with_quality(&mut file, 100).encode(&pixels, 20, 9, kind).unwrap();
        file
    }

    fn read_bytes(bytes: &[u8]) -> Result<Plane<[f32; 3]>> {
        let at = TempDir::new().unwrap();
        let path = at.path().join("a.jpg");
        fs::write(&path, bytes).unwrap();
        read_linear(&path, Texture::check_size)
    }

    #[test]
    fn codes_of_jpeg_are_decoded_as_srgb() {
        for (kind, pixel) in [(L8, &[130][..]), (Rgb8, &[200, 100, 50])] {
            let found = read_bytes(&jpeg(kind, pixel)).unwrap();
            assert_eq!((found.width(), found.height()), (20, 9));
            for (found, code) in found.values()[0].into_iter().zip(pixel.iter().cycle()) {
                // JPEG loses up to two codes here.
                let near =
                    [-2.0, 2.0].map(|d| srgb::to_linear((f64::from(*code) + d) / 255.0) as f32);
                assert!(near[0] < found && found < near[1], "{found} for {code}");
            }
            assert!(found.values().iter().all(|one| *one == found.values()[0]));
        }
    }

    #[test]
    fn damaged_files_are_one_line() {
        let whole = jpeg(Rgb8, &[200, 100, 50]);
        for bytes in
            [&whole[..whole.len() - 2], &whole[..whole.len() / 2], &whole[2..], b"", b"GIF"]
        {
            let line = read_bytes(bytes).unwrap_err().to_string();
            assert!(line.ends_with("write it again") && !line.contains('\n'), "{line}");
        }
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x55;
            if let Err(error) = read_bytes(&bytes) {
                assert!(!error.to_string().contains('\n'), "{error}");
            }
        }
    }
}
