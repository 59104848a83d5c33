//! Read `.splat`: rows of 32 bytes, without a header.

use super::GaussianFile;
use crate::error::{Error, Result};
use crate::io::{Reason, input};
use crate::memory;
use crate::scene::GaussianArrays;
use crate::scene::gaussians::Encoding;
use glam::{DVec3, Vec3};
use std::path::Path;

const ROW: usize = 32;
/// The first spherical harmonic, 1 / (2 sqrt(pi)).
const FIRST: f64 = 0.282_094_791_773_878_1;

/// Reads a file.
///
/// # Errors
/// As [`super::read`].
pub(super) fn read(path: &Path) -> Result<GaussianFile> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    parse(&bytes).map_err(|what| Error::format(path, what))
}

fn parse(bytes: &[u8]) -> Reason<GaussianFile> {
    let (rows, []) = bytes.as_chunks::<ROW>() else {
        return Err(format!(
            "{} bytes are no whole number of rows of {ROW}: the file is truncated, or no .splat",
            bytes.len()
        ));
    };
    memory::try_ask(rows.len() as u64 * 64, || format!("{} Gaussians", rows.len()))?;
    let mut arrays = GaussianArrays { encoding: Encoding::Srgb, ..GaussianArrays::default() };
    for row in rows {
        let float = |at: usize| {
            f32::from_le_bytes([row[4 * at], row[4 * at + 1], row[4 * at + 2], row[4 * at + 3]])
        };
        arrays.position.push(Vec3::new(float(0), float(1), float(2)));
        arrays.scale.push(Vec3::new(float(3), float(4), float(5)));
        let color = |byte: u8| ((f64::from(byte) / 255.0 - 0.5) / FIRST) as f32;
        arrays.harmonics.push(Vec3::new(color(row[24]), color(row[25]), color(row[26])));
        arrays.opacity.push((f64::from(row[27]) / 255.0) as f32);
        let turn = |byte: u8| (f32::from(byte) - 128.0) / 128.0;
        arrays.rotation.push([turn(row[29]), turn(row[30]), turn(row[31]), turn(row[28])]);
    }
    Ok(GaussianFile {
        arrays,
        offset: DVec3::ZERO,
        convention: ".splat: linear scales, colours and opacities as bytes, quaternion w first"
            .into(),
        warnings: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Gaussians;

    #[test]
    fn rows_of_32_bytes_are_gaussians() {
        let floats = [1.0_f32, 2.0, 3.0, 0.5, 0.25, 0.125];
        let mut row: Vec<u8> = floats.iter().flat_map(|value| value.to_le_bytes()).collect();
        row.extend([255, 0, 51, 204, 192, 128, 64, 128]);
        let found = parse(&row.repeat(2)).unwrap().arrays;
        assert_eq!(found.position[1], Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(found.scale[0], Vec3::new(0.5, 0.25, 0.125));
        assert_eq!(found.rotation[0], [0.0, -0.5, 0.0, 0.5], "w first in the file");
        assert_eq!(found.opacity[0], 0.8);
        let color = found.harmonics[0].as_dvec3() * FIRST + 0.5;
        assert!((color - DVec3::new(1.0, 0.0, 0.2)).length() < 1e-7, "{color}");
        assert_eq!(Gaussians::new(found).unwrap().1, 0);
        assert!(parse(&row[1..]).unwrap_err().contains("31 bytes are no whole number of rows"));
    }
}
