//! Check which arrays are read, and what the refusal of the others says.

use super::*;
use crate::frame::image::Values;
use std::fs;
use tempfile::TempDir;

/// A file of version 1.0, as numpy.save writes it.
fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    with_header(&text, data)
}

fn with_header(text: &str, data: &[u8]) -> Vec<u8> {
    let padded = format!("{text}{}\n", " ".repeat((64 - (text.len() + 11) % 64) % 64));
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend((padded.len() as u16).to_le_bytes());
    bytes.extend(padded.as_bytes());
    bytes.extend(data);
    bytes
}

fn read_bytes(bytes: &[u8], name: &str) -> Result<Image> {
    let at = TempDir::new().unwrap();
    let path = at.path().join("a.npy");
    fs::write(&path, bytes).unwrap();
    read(&path, name)
}

fn le<T: Copy, const N: usize>(values: &[T], bytes: fn(T) -> [u8; N]) -> Vec<u8> {
    values.iter().flat_map(|&v| bytes(v)).collect()
}

#[test]
fn floats_and_indices_of_every_type_are_read() {
    let floats = [1.0, -0.0, f32::INFINITY, f32::NAN, 1e-45, 3.5];
    let image = read_bytes(&npy("<f4", "(2, 3)", &le(&floats, f32::to_le_bytes)), "Z").unwrap();
    assert_eq!((image.width, image.height, image.channels.len()), (3, 2, 1));
    let Some(Values::Float(found)) = image.channel("Z") else { panic!("no floats") };
    assert_eq!(found.iter().map(|v| v.to_bits()).collect::<Vec<_>>(), floats.map(f32::to_bits));

    let doubles = [0.1, 1e300, 16_777_217.0];
    let image = read_bytes(&npy("<f8", "(1, 3, 1)", &le(&doubles, f64::to_le_bytes)), "Z");
    let rounded = vec![0.1, f32::INFINITY, 16_777_216.0];
    assert_eq!(image.unwrap().channel("Z"), Some(&Values::Float(rounded)));

    let bytes = npy("|u1", "(1, 2)", &[7, 255]);
    let known = Values::Index(vec![7, 255]);
    assert_eq!(read_bytes(&bytes, "count").unwrap().channel("count"), Some(&known));
    let bytes = npy("<u2", "(1, 2)", &le(&[7_u16, 65_535], u16::to_le_bytes));
    let known = Values::Index(vec![7, 65_535]);
    assert_eq!(read_bytes(&bytes, "id").unwrap().channel("id"), Some(&known));
    let known = Values::Index(vec![7, crate::frame::NO_ID]);
    let bytes = npy("<u4", "(1, 2)", &le(&[7, u32::MAX], u32::to_le_bytes));
    assert_eq!(read_bytes(&bytes, "id").unwrap().channel("id"), Some(&known));
    let bytes = npy("<i4", "(1, 2)", &le(&[7, -1], i32::to_le_bytes));
    assert_eq!(read_bytes(&bytes, "id").unwrap().channel("id"), Some(&known));
}

#[test]
fn three_components_are_a_vector_or_a_color() {
    let numbers: Vec<f32> = (0..6).map(|i| i as f32).collect();
    let bytes = npy("<f4", "(1, 2, 3)", &le(&numbers, f32::to_le_bytes));
    for (name, names) in [
        ("normal", ["normal.X", "normal.Y", "normal.Z"]),
        ("RGB", ["R", "G", "B"]),
        ("attributes.RGB", ["attributes.R", "attributes.G", "attributes.B"]),
    ] {
        let image = read_bytes(&bytes, name).unwrap();
        for (i, name) in names.iter().enumerate() {
            let known = Values::Float(vec![i as f32, i as f32 + 3.0]);
            assert_eq!(image.channel(name), Some(&known), "{name}");
        }
        assert!(image.channels.is_sorted_by(|a, b| a.0 < b.0), "{name}");
    }
}

#[test]
fn later_versions_and_other_spellings_are_read() {
    let text = "{\"shape\":(1,2,), \"fortran_order\":False, \"descr\":\"|u1\"}";
    let mut bytes = b"\x93NUMPY\x02\0".to_vec();
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.extend([3, 4]);
    assert_eq!(read_bytes(&bytes, "a").unwrap().channel("a"), Some(&Values::Index(vec![3, 4])));
}

#[test]
fn what_is_no_plane_is_refused_in_one_line() {
    let data = [0; 24];
    let fortran = "{'descr': '<f4', 'fortran_order': 1, 'shape': (2, 3), }";
    let mut long = b"\x93NUMPY\x02\0".to_vec();
    long.extend(u32::MAX.to_le_bytes());
    let mut binary = npy("<f4", "(2, 3)", &data);
    binary[12] = 0xFF;
    for (bytes, why) in [
        (b"".to_vec(), "not an NPY file, or truncated"),
        (b"\x93NUMP".to_vec(), "not an NPY file, or truncated"),
        (b"PK\x03\x04 an archive of arrays".to_vec(), "not an NPY file; give one"),
        (b"\x93NUMPY\x09\0\0\0".to_vec(), "version 9"),
        (b"\x93NUMPY\x01\0\x10\0{".to_vec(), "a header of 16 bytes"),
        (long, "a header of 4294967295 bytes"),
        (binary, "not text"),
        (with_header("[]", &data), "not a dictionary"),
        (with_header("{'descr': '<f4', 'fortran_order': False}", &data), "no `shape`"),
        (with_header(fortran, &data), "fortran_order is 1"),
        (npy("<f16", "(1, 3)", &data), "elements `<f16`"),
        (npy("<c8", "(1, 3)", &data), "elements `<c8`"),
        (npy("<i8", "(1, 3)", &[254; 24]), "is no index; give -1 (none)"),
        (npy("<u8", "(1, 3)", &[255; 24]), "18446744073709551615 is no index"),
        (npy("|i1", "(1, 3)", &[0, 1, 0x80]), "-128 is no index"),
        (npy("|O", "(1, 3)", &data), "elements `|O`"),
        (npy("<f4", "(6,)", &data), "the shape (6,)"),
        (npy("<f4", "()", &data), "the shape ()"),
        (npy("<f4", "(2, 3, 2)", &data), "the shape (2, 3, 2)"),
        (npy("<f4", "(0, 3)", b""), "at least one pixel"),
        (npy("<f4", "(-2, -3)", &data), "the shape (-2, -3)"),
        (npy("<f4", "(2, 3)", &data[1..]), "24 bytes, but 23 follow"),
        (npy("<f4", "(2, 2)", &data), "16 bytes, but 24 follow"),
        // A few bytes that ask for more than any memory.
        (npy("<f8", "(4294967295, 4294967295, 3)", b""), "but 0 follow"),
        (npy("<f4", "(4294967296, 1)", b""), "the shape (4294967296, 1)"),
        (npy("<f4", "(60000, 60000)", &data), "14400000000 bytes, but 24 follow"),
    ] {
        let error = read_bytes(&bytes, "a").unwrap_err();
        let line = error.to_string();
        assert!(matches!(error, Error::Format { .. }) && line.contains("a.npy: "), "{line}");
        assert!(line.contains(why) && line.lines().count() == 1, "{why}: {line}");
    }
    assert!(matches!(read(Path::new("no such.npy"), "a"), Err(Error::Io { .. })));
}

/// The numbers 0 to 5 (or to 17 for three components) of a picture of 2 rows, in C order.
#[test]
fn other_orders_shapes_and_types_are_read() {
    let plane = Values::Float((0..6).map(|i| i as f32).collect());
    let numbers = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
    let half = |value: f32| exr::prelude::f16::from_f32(value).to_le_bytes();
    let bytes = le(&numbers, f32::to_le_bytes);
    let by_columns = le(&[0.0, 3.0, 1.0, 4.0, 2.0, 5.0], f32::to_le_bytes);
    let fortran = "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }";
    for file in [
        npy("<f2", "(2, 3)", &le(&numbers, half)),
        npy(">f4", "(2, 3)", &le(&numbers, f32::to_be_bytes)),
        npy("<f4", "(1, 2, 3, 1)", &bytes),
        npy("<f4", "(1, 1, 3, 2)", &bytes),
        with_header(fortran, &by_columns),
    ] {
        assert_eq!(read_bytes(&file, "a").unwrap().channel("a"), Some(&plane));
    }
    let indices = Values::Index(vec![7, crate::frame::NO_ID, 100]);
    for (descr, data) in [
        ("<i8", le(&[7, -1, 100], i64::to_le_bytes)),
        (">i8", le(&[7, -1, 100], i64::to_be_bytes)),
        ("<i2", le(&[7, -1, 100], i16::to_le_bytes)),
        ("|i1", le(&[7, -1, 100], i8::to_le_bytes)),
        ("<u8", le(&[7, u32::MAX.into(), 100], u64::to_le_bytes)),
    ] {
        let file = npy(descr, "(1, 3)", &data);
        assert_eq!(read_bytes(&file, "id").unwrap().channel("id"), Some(&indices), "{descr}");
    }
    assert!(read_bytes(&npy("|b1", "(1, 2)", &[0, 1]), "a").is_ok());

    // Green follows the whole of red.
    let planes: Vec<f32> = (0..12).map(|i| i as f32).collect();
    for shape in ["(3, 1, 4)", "(1, 3, 1, 4)"] {
        let image = read_bytes(&npy("<f4", shape, &le(&planes, f32::to_le_bytes)), "RGB").unwrap();
        assert_eq!((image.width, image.height), (4, 1));
        assert_eq!(image.channel("G"), Some(&Values::Float(vec![4.0, 5.0, 6.0, 7.0])), "{shape}");
    }
    let image = read_bytes(&npy("<f4", "(3, 2, 2)", &le(&planes, f32::to_le_bytes)), "n").unwrap();
    assert_eq!(image.channel("n.Z"), Some(&Values::Float(vec![8.0, 9.0, 10.0, 11.0])));
    let fortran = "{'descr': '<f4', 'fortran_order': True, 'shape': (1, 4, 3), }";
    let image = read_bytes(&with_header(fortran, &le(&planes, f32::to_le_bytes)), "RGB").unwrap();
    assert_eq!(image.channel("G"), Some(&Values::Float(vec![4.0, 5.0, 6.0, 7.0])));
}
