//! Files are built from bytes, and the numbers that they mean are written down beside them.

use super::*;
use crate::scene::Gaussians;
use flate2::{Compression, write::GzEncoder};
use std::io::Write;

/// A gzip stream that holds some bytes as they are, in a block of at most 64 KiB.
fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let length = u16::try_from(bytes.len()).unwrap();
    let head = [0x1F, 0x8B, 8, 0, 0, 0, 0, 0, 0, 255, 1];
    let lengths = [length.to_le_bytes(), (!length).to_le_bytes()].concat();
    let end = [crc32fast::hash(bytes), length.into()].map(u32::to_le_bytes).concat();
    [&head[..], &lengths, bytes, &end].concat()
}

/// A header: version, count, degree, binary places of positions, flags.
fn header(version: u32, count: u32, [degree, places, flags]: [u8; 3]) -> Vec<u8> {
    let words = [version, count].map(u32::to_le_bytes).concat();
    [&b"NGSP"[..], &words, &[degree, places, flags, 0]].concat()
}

/// Two Gaussians of degree 0, with these rotations.
fn two(version: u32, flags: u8, rotations: &[u8]) -> Vec<u8> {
    let positions: &[u8] = match version {
        1 => &[0x00, 0x3C, 0x00, 0xC0, 0x00, 0x38, 0x00, 0x00, 0x00, 0x7C, 0x01, 0x00],
        _ => &[0, 16, 0, 0, 0xE8, 0xFF, 1, 0, 0, 0xFF, 0xFF, 0x7F, 0, 0, 0x80, 0, 0, 0],
    };
    let opacities = [255, 51];
    let colors = [255, 0, 128, 127, 51, 204];
    let scales = [160, 176, 144, 0, 255, 100];
    let parts = [positions, &opacities, &colors, &scales, rotations];
    [header(version, 2, [0, 12, flags]), parts.concat()].concat()
}

const FIRST_THREE: [u8; 6] = [255, 0, 255, 191, 64, 127];
/// 256, -128 and 0 beside w; then 511, 511 and -511 beside x, which no writer leaves.
const SMALLEST_THREE: [u8; 8] = [0x00, 0x00, 0x0A, 0xD0, 0xFF, 0xFF, 0xF7, 0x1F];

fn near(found: impl AsRef<[f32]>, wanted: &[f64]) {
    let found = found.as_ref();
    assert_eq!(found.len(), wanted.len());
    for (found, wanted) in found.iter().zip(wanted) {
        assert!((f64::from(*found) - wanted).abs() <= 1e-7 * wanted.abs(), "{found} for {wanted}");
    }
}

#[test]
fn bytes_of_every_array_have_their_numbers() {
    for (version, rotations) in [(2, &FIRST_THREE[..]), (3, &SMALLEST_THREE)] {
        let file = parse(&gzipped(&two(version, 0, rotations))).unwrap();
        assert_eq!((file.offset, file.warnings.len()), (DVec3::ZERO, 0));
        let found = file.arrays;
        assert_eq!((found.degree, found.encoding), (0, Encoding::Srgb));
        let far = Vec3::new(2048.0 - 1.0 / 4096.0, -2048.0, 0.0);
        assert_eq!(found.position, [Vec3::new(1.0, -1.5, 1.0 / 4096.0), far]);
        assert_eq!(found.opacity, [1.0, 0.2]);
        near(found.scale[0].to_array(), &[1.0, std::f64::consts::E, 0.36787944117144233]);
        near(
            found.scale[1].to_array(),
            &[4.5399929762484854e-05, 378.98627852215554, 0.023517745856009107],
        );
        let color = |byte: f64| (byte / 255.0 - 0.5) / 0.15;
        near(found.harmonics[0].to_array(), &[1.0 / 0.3, -1.0 / 0.3, color(128.0)]);
        near(found.harmonics[1].to_array(), &[color(127.0), -2.0, 2.0]);
    }
}

#[test]
fn the_part_of_a_quaternion_that_is_left_out_makes_its_length_1() {
    let found = parse(&gzipped(&two(2, 0, &FIRST_THREE))).unwrap().arrays;
    assert_eq!(found.rotation[0], [1.0, -1.0, 1.0, 0.0], "longer than 1: w is 0");
    let [x, y, z] = [191.0, 64.0, 127.0].map(|byte: f64| byte / 127.5 - 1.0);
    near(found.rotation[1], &[x, y, z, (1.0 - x * x - y * y - z * z).sqrt()]);
    let (all, dropped) = Gaussians::new(found).unwrap();
    assert_eq!((all.len(), dropped), (2, 0));

    let found = parse(&gzipped(&two(3, 0, &SMALLEST_THREE))).unwrap().arrays;
    let unit = 0.5_f64.sqrt() / 511.0;
    let [x, y] = [256.0 * unit, -128.0 * unit];
    near(found.rotation[0], &[x, y, 0.0, (1.0 - x * x - y * y).sqrt()]);
    let (all, dropped) = Gaussians::new(found).unwrap();
    assert_eq!((all.len(), dropped), (1, 1), "three parts of 1/sqrt(2) are too long");
}

/// What the format's own library does, in its words: the greatest part by its index, and the others
/// as a sign and nine bits, the first one highest.
fn smallest_three(q: [f64; 4]) -> [u8; 4] {
    let greatest = (0..4).fold(0, |best, i| if q[i].abs() > q[best].abs() { i } else { best });
    let mut bits = greatest as u32;
    for i in (0..4).filter(|&i| i != greatest) {
        let negative = u32::from((q[i] < 0.0) != (q[greatest] < 0.0));
        bits = bits << 10 | negative << 9 | (511.0 * q[i].abs() * 2.0_f64.sqrt() + 0.5) as u32;
    }
    bits.to_le_bytes()
}

#[test]
fn the_greatest_part_may_have_any_place_and_sign() {
    for turn in 0..4 {
        for sign in [1.0, -1.0] {
            let mut q = [0.8, -0.4, 0.4, -0.2].map(|part| sign * part);
            q.rotate_right(turn);
            let found = rotation(&smallest_three(q));
            for (found, part) in found.iter().zip(q) {
                let off = f64::from(*found) - sign * part;
                assert!(off.abs() < 0.002, "{found} for {part}, turned by {turn}");
            }
        }
    }
}

#[test]
fn coefficients_come_one_by_one_in_three_colours() {
    for degree in 1..=3 {
        let others = 3 * (coefficients(degree) - 1);
        let arrays = [&[0; 9][..], &[255], &[0, 255, 0], &[160; 3], &[128; 3]].concat();
        let more: Vec<u8> = (0..others as u8).map(|i| 5 * i).collect();
        let bytes = [header(2, 1, [degree as u8, 12, 0]), arrays, more].concat();
        let found = parse(&gzipped(&bytes)).unwrap().arrays;
        assert_eq!((found.degree, found.harmonics.len()), (degree, coefficients(degree)));
        for (k, color) in found.harmonics[1..].iter().enumerate() {
            let byte = |c: usize| ((15 * k + 5 * c) as f32 - 128.0) / 128.0;
            assert_eq!(*color, Vec3::new(byte(0), byte(1), byte(2)), "coefficient {k}");
        }
    }
}

#[test]
fn version_1_has_half_floats() {
    let found = parse(&gzipped(&two(1, 0, &FIRST_THREE))).unwrap();
    assert!(found.convention.contains("SPZ version 1: positions of half floats"));
    let positions = found.arrays.position.clone();
    assert_eq!(positions[0], Vec3::new(1.0, -2.0, 0.5));
    assert_eq!(positions[1].to_array(), [0.0, f32::INFINITY, 5.960_464_5e-8]);
    assert_eq!(Gaussians::new(found.arrays).unwrap().1, 1, "the infinite one is dropped");
}

#[test]
fn flags_are_said_and_what_they_announce_is_skipped() {
    let read = |flags, more: &[u8]| {
        let bytes = [two(3, flags, &SMALLEST_THREE), more.to_vec()].concat();
        parse(&gzipped(&bytes)).unwrap()
    };
    assert!(read(0, &[]).convention.ends_with("trained without antialiasing"));
    let found = read(1, &[]);
    assert!(found.convention.contains("trained with antialiasing: draw it with --compensation"));
    assert!(found.warnings.is_empty());
    let found = read(3, &[2, 0, 0xBE, 0xAD, 0, 0, 0, 0]);
    assert!(found.warnings[0].starts_with("the flags 0x02 announce extensions"));
    assert_eq!(found.arrays.position.len(), 2);
}

#[test]
fn every_damage_has_a_line_of_its_own() {
    let good = two(2, 0, &FIRST_THREE);
    let packed = gzipped(&good);
    let with = |at: usize, byte: u8| {
        let mut bytes = good.clone();
        bytes[at] = byte;
        gzipped(&bytes)
    };
    let mut flipped = packed.clone();
    let at = flipped.len() - 6;
    flipped[at] ^= 1;
    let version_4 = [header(4, 2, [0, 12, 0]), vec![0; 40]].concat();
    for (bytes, what) in [
        (version_4, "SPZ version 4 is compressed with Zstandard"),
        (good.clone(), "SPZ version 2 is compressed, but this file is not: gzip it"),
        (b"NGSP".to_vec(), "Zstandard"),
        (b"ply\n".to_vec(), "this is no SPZ"),
        (Vec::new(), "this is no SPZ"),
        (gzipped(b"ply\nformat ascii 1.0\n"), "holds no SPZ"),
        (gzipped(&good[..15]), "the gzip stream ends early"),
        (with(4, 0), "version 0 is not read: give version 1, 2 or 3"),
        (with(4, 4), "version 4 is not read"),
        (with(8, 0), "promises no Gaussians"),
        (with(8, 3), "promises 3 Gaussians, which are 57 bytes, but 38 follow"),
        (with(8, 1), "19 bytes follow the 1 Gaussians"),
        (with(11, 255), "promises 4278190082 Gaussians, which is more than "),
        (with(12, 4), "degree 4 are not drawn: write the file with degree 3 or less"),
        (with(12, 1), "promises 2 Gaussians, which are 56 bytes, but 38 follow"),
        (with(13, 31), "31 binary places, but at most 30"),
        (packed[..packed.len() - 9].to_vec(), "the gzip stream ends early"),
        (packed[..packed.len() - 1].to_vec(), "the gzip stream ends early"),
        (flipped, "the gzip stream is damaged: "),
        ([&packed[..], &[0]].concat(), "1 bytes follow the gzip stream"),
        ([&packed[..], &packed[..]].concat(), "bytes follow the gzip stream"),
    ] {
        let line = parse(&bytes).unwrap_err();
        assert!(line.contains(what) && !line.contains('\n'), "{line}: {what}");
    }
}

/// A stream that would fill the memory is not kept beyond what its header promises.
#[test]
fn a_stream_of_zeros_is_no_memory() {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(&two(2, 0, &FIRST_THREE)).unwrap();
    encoder.write_all(&vec![0; 1 << 24]).unwrap();
    let bomb = encoder.finish().unwrap();
    assert!(bomb.len() < 1 << 15);
    let line = parse(&bomb).unwrap_err();
    assert_eq!(line, "16777216 bytes follow the 2 Gaussians: the file is damaged");
}

#[test]
fn no_mutation_of_a_file_panics_or_gives_more_than_it_holds() {
    let seeds = [
        two(1, 0, &FIRST_THREE),
        two(2, 1, &FIRST_THREE),
        two(3, 2, &SMALLEST_THREE),
        [header(3, 1, [3, 12, 0]), vec![200; 65]].concat(),
    ];
    let (mut state, mut good, mut bad) = (1_u64, 0, 0);
    let mut below = |end: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as usize % end
    };
    for round in 0..20_000 {
        let mut bytes = seeds[round % seeds.len()].clone();
        // Half of the mutations are of the stream, half of what it holds.
        let inside = (round / seeds.len()).is_multiple_of(2);
        if !inside {
            bytes = gzipped(&bytes);
        }
        for _ in 0..=below(2) {
            let at = below(bytes.len());
            match below(4) {
                0 => bytes[at] = below(256) as u8,
                1 => bytes[at] ^= 1 << below(8),
                2 => bytes.truncate(at + 1),
                _ => bytes.insert(at, below(256) as u8),
            }
        }
        let held = bytes.len();
        match parse(&if inside { gzipped(&bytes) } else { bytes }) {
            Ok(file) => {
                good += 1;
                assert!(!inside || file.arrays.position.len() * 16 <= held);
                let _ = Gaussians::new(file.arrays);
            }
            Err(line) => {
                bad += 1;
                assert!(!line.contains('\n'), "{line}");
            }
        }
    }
    assert!(good > 1000 && bad > 1000, "the mutations test nothing: {good} good, {bad} bad");
}
