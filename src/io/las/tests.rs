//! Check LAS files that are built byte by byte, compressed ones, and damaged ones.

use super::*;
use glam::DVec3;

/// A point: integer coordinates, intensity, classification, colour.
type Record = ([i32; 3], u16, u8, [u16; 3]);

const POINTS: [Record; 3] = [
    ([0, 0, 0], 7, 2, [65535, 0, 32768]),
    ([100, -200, 300], 65535, 5, [1000, 2000, 3000]),
    ([25, 50, 75], 0, 31, [1, 256, 0]),
];

const SCALE: [f64; 3] = [0.01, 0.02, 0.5];

/// The bytes of a record of a point format, with extra bytes of 9.
fn record(format: u8, extra: usize, (place, intensity, class, color): &Record) -> Vec<u8> {
    let strides = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];
    let mut row = vec![0; strides[usize::from(format)]];
    for (axis, value) in place.iter().enumerate() {
        row[4 * axis..][..4].copy_from_slice(&value.to_le_bytes());
    }
    row[12..14].copy_from_slice(&intensity.to_le_bytes());
    // The first of one return; in the upper bits of the old formats, the point is withheld.
    row[14] = if format < 6 { 0b00_001_001 } else { 0x11 };
    row[if format < 6 { 15 } else { 16 }] = if format < 6 { 0x80 | class } else { *class };
    let at = match format {
        2 => Some(20),
        3 | 5 => Some(28),
        7 | 8 | 10 => Some(30),
        _ => None,
    };
    for (c, code) in color.iter().enumerate().filter(|_| at.is_some()) {
        row[at.unwrap() + 2 * c..][..2].copy_from_slice(&code.to_le_bytes());
    }
    row.extend(vec![9; extra]);
    row
}

/// A file of these records, with `variable` between the header and the points.
fn file(format: u8, stride: usize, count: usize, variable: &[u8], points: &[u8]) -> Vec<u8> {
    let minor = if format >= 6 { 4 } else { 2 };
    let size: u16 = if minor == 4 { 375 } else { 227 };
    let mut bytes = vec![0; size.into()];
    let mut put = |at: usize, value: &[u8]| bytes[at..][..value.len()].copy_from_slice(value);
    put(0, b"LASF");
    put(24, &[1, minor]);
    put(94, &size.to_le_bytes());
    put(96, &(u32::from(size) + variable.len() as u32).to_le_bytes());
    put(100, &u32::from(!variable.is_empty()).to_le_bytes());
    put(104, &[format]);
    put(105, &(stride as u16).to_le_bytes());
    if minor == 4 {
        put(247, &(count as u64).to_le_bytes());
    } else {
        put(107, &(count as u32).to_le_bytes());
    }
    for axis in 0..3 {
        put(131 + 8 * axis, &SCALE[axis].to_le_bytes());
        put(155 + 8 * axis, &[1000.0_f64, 0.0, -3.0][axis].to_le_bytes());
    }
    [&bytes, variable, points].concat()
}

fn las(format: u8, extra: usize, points: &[Record]) -> Vec<u8> {
    let rows: Vec<Vec<u8>> = points.iter().map(|point| record(format, extra, point)).collect();
    file(format, rows[0].len(), points.len(), &[], &rows.concat())
}

fn read(bytes: &[u8]) -> Cloud {
    parse(bytes, &ReadOptions::default()).unwrap()
}

/// Checks that a cloud has the points above.
fn check(cloud: &Cloud, format: u8) {
    for (i, (place, intensity, class, color)) in POINTS.iter().enumerate() {
        let exact = DVec3::from_array(
            [0, 1, 2].map(|axis| f64::from(place[axis]) * SCALE[axis] + [1000.0, 0.0, -3.0][axis]),
        );
        let found = cloud.position[i].as_dvec3() + cloud.offset;
        assert!((found - exact).length() < 1e-4, "{format}: {found} for {exact}");
        let numbers: Vec<f32> = cloud.properties.iter().map(|one| one.values[i]).collect();
        assert_eq!(numbers, [f32::from(*intensity), f32::from(*class)], "{format}");
        let linear = color.map(|code| srgb::to_linear(f64::from(code) / 65535.0) as f32);
        let found = cloud.color.as_ref().map(|all| all[i].to_array());
        let colored = matches!(format, 2 | 3 | 5 | 7 | 8 | 10);
        assert_eq!(found, colored.then_some(linear), "{format}");
    }
    assert_eq!(cloud.warnings, [""; 0]);
}

#[test]
fn every_point_format_gives_positions_colours_and_numbers() {
    for format in 0..=10 {
        for extra in [0, 3] {
            check(&read(&las(format, extra, &POINTS)), format);
        }
    }
    let names: Vec<String> =
        read(&las(0, 0, &POINTS)).properties.into_iter().map(|one| one.name).collect();
    assert_eq!(names, ["intensity", "classification"]);
}

#[test]
fn map_coordinates_are_shifted_as_those_of_a_ply() {
    let mut bytes = las(0, 0, &POINTS);
    bytes[155..163].copy_from_slice(&635_000.1_f64.to_le_bytes());
    let cloud = read(&bytes);
    assert!(cloud.offset.x > 634_000.0, "{}", cloud.offset);
    let found = cloud.position[1].as_dvec3() + cloud.offset;
    assert!((found - DVec3::new(635_001.1, -4.0, 147.0)).length() < 1e-5, "{found}");
    let kept = parse(&bytes, &ReadOptions { keep_place: true, ..ReadOptions::default() }).unwrap();
    assert_eq!(kept.offset, DVec3::ZERO);
}

#[test]
fn colours_of_8_bits_are_doubted_and_mended_and_no_colours_are_none() {
    let with = |color| POINTS.map(|(place, intensity, class, _)| (place, intensity, class, color));
    let dark = las(2, 0, &with([255, 128, 0]));
    assert!(read(&dark).warnings[0].contains("write `color_range = 255`"));
    let options = ReadOptions { color_range: Some(255.0), ..ReadOptions::default() };
    let mended = parse(&dark, &options).unwrap();
    assert_eq!(mended.color.unwrap()[0], Vec3::new(1.0, srgb::table(255)[128], 0.0));
    assert_eq!(mended.warnings, [""; 0]);
    assert_eq!(read(&las(2, 0, &with([0; 3]))).color, None);
}

#[test]
fn what_is_wrong_is_one_line_with_the_place() {
    let good = las(3, 0, &POINTS);
    let with = |at: usize, value: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..][..value.len()].copy_from_slice(value);
        bytes
    };
    for (bytes, what) in [
        (b"LAS".to_vec(), "byte 0: not a LAS file"),
        (good[..100].to_vec(), "byte 104: the file ends within its header"),
        (with(24, &[2, 0]), "byte 24: version 2.0"),
        (with(104, &[11]), "byte 104: point format 11"),
        (with(105, &[33, 0]), "byte 105: records of 33 bytes, but point format 3 has 34"),
        (with(107, &[0; 4]), "byte 107: the file has 0 points"),
        (with(107, &[0xff; 4]), "declares 4294967295 points of 34 bytes, but the 102 bytes from"),
        (with(131, &f64::NAN.to_le_bytes()), "byte 131: scales"),
        (with(96, &[0xff; 4]), "byte 96: points from byte 4294967295 on"),
        (good[..good.len() - 1].to_vec(), "hold at most 2: the file is truncated"),
    ] {
        let found = parse(&bytes, &ReadOptions::default()).unwrap_err();
        assert!(found.contains(what) && !found.contains('\n'), "{found}");
    }
}

#[cfg(feature = "cli")]
mod compressed {
    use super::*;
    use ::laz::{LasZipCompressor, LazItemRecordBuilder, LazVlr, LazVlrBuilder};
    use std::io::Cursor;

    /// Many points that vary.
    fn many() -> Vec<Record> {
        let point = |i: i32| {
            let n = i as u16;
            ([i * 3, -i, i % 7], n.wrapping_mul(31), (i % 32) as u8, [n, n.wrapping_mul(77), 9])
        };
        (0..500).map(point).collect()
    }

    fn vlr(format: u8, extra: u16, chunk: u32) -> LazVlr {
        let items = LazItemRecordBuilder::default_for_point_format_id(format, extra).unwrap();
        LazVlrBuilder::new(items).with_fixed_chunk_size(chunk).build()
    }

    /// A LAZ file of these points.
    fn laz(format: u8, extra: usize, points: &[Record], chunk: u32) -> Vec<u8> {
        let rows: Vec<Vec<u8>> = points.iter().map(|point| record(format, extra, point)).collect();
        let vlr = vlr(format, extra as u16, chunk);
        let mut data = Vec::new();
        vlr.write_to(&mut data).unwrap();
        let mut variable = vec![0; 54];
        variable[2..16].copy_from_slice(b"laszip encoded");
        variable[18..20].copy_from_slice(&22204_u16.to_le_bytes());
        variable[20..22].copy_from_slice(&(data.len() as u16).to_le_bytes());
        variable.extend(data);
        let mut bytes = file(format, rows[0].len(), points.len(), &variable, &[]);
        bytes[104] |= 0x80;
        let mut out = Cursor::new(bytes);
        out.set_position(out.get_ref().len() as u64);
        let mut compressor = LasZipCompressor::new(&mut out, vlr).unwrap();
        compressor.compress_many(&rows.concat()).unwrap();
        compressor.done().unwrap();
        drop(compressor);
        out.into_inner()
    }

    #[test]
    fn a_compressed_file_is_the_file_itself() {
        for format in [0, 1, 2, 3, 6, 7, 8] {
            for (extra, chunk) in [(0, 50_000), (3, 128)] {
                let (plain, packed) =
                    (las(format, extra, &many()), laz(format, extra, &many(), chunk));
                assert!(packed.len() < plain.len());
                assert_eq!(read(&packed), read(&plain), "{format}, chunks of {chunk}");
            }
        }
    }

    /// Bytes are changed, and the file is cut: an error or other points, and no panic.
    #[test]
    fn damage_is_an_error_or_other_points() {
        for format in [3, 7] {
            let good = laz(format, 0, &many()[..20], 8);
            for at in (format as usize % 5..good.len()).step_by(5) {
                for value in [0xff, good[at] ^ 0x10] {
                    let mut bytes = good.clone();
                    bytes[at] = value;
                    if let Err(what) = parse(&bytes, &ReadOptions::default()) {
                        assert!(!what.contains('\n') && !what.is_empty(), "{what}");
                    }
                }
            }
            for length in (0..good.len() / 2).step_by(11) {
                assert!(parse(&good[..length], &ReadOptions::default()).is_err(), "{length}");
            }
        }
    }

    #[test]
    fn counts_that_the_file_cannot_hold_are_refused_before_memory_is_taken() {
        let good = laz(7, 0, &many(), 100);
        let start = u32::from_le_bytes(*good[96..].first_chunk().unwrap()) as usize;
        // The size of the first layer of the first chunk, behind the first record and the count.
        let mut layers = good.clone();
        layers[start + 8 + 36 + 4..][..4].copy_from_slice(&[0xff; 4]);
        let found = parse(&layers, &ReadOptions::default()).unwrap_err();
        assert!(found.contains("a chunk of 100 points in 42949"), "{found}");
        // The number of chunks in the table.
        let table = u64::from_le_bytes(*good[start..].first_chunk().unwrap()) as usize;
        let mut chunks = good.clone();
        chunks[table + 4..][..4].copy_from_slice(&[0xff; 4]);
        let found = parse(&chunks, &ReadOptions::default()).unwrap_err();
        assert!(found.starts_with("4294967295 chunks of points in a file"), "{found}");
        // More points than there are: an error, and not so much memory.
        let mut count = laz(3, 0, &many(), 100);
        count[107..111].copy_from_slice(&100_000_000_u32.to_le_bytes());
        assert!(parse(&count, &ReadOptions::default()).is_err());
    }
}
