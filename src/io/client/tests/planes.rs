//! Check formats, places, indices and colours.

use super::*;
use crate::frame::NO_ID;

fn client(files: &[(&str, &[u8])], toml: &str) -> Client {
    let at = files.iter().fold(Folder::new(), |at, (name, bytes)| at.with(name, bytes));
    at.read(toml).unwrap()
}

/// The weights of a row of raw numbers, and their storage.
fn weights(bytes: &[u8], count: usize, keys: &str) -> (Vec<f64>, Storage) {
    let toml = format!("size = [{count}, 1]\n[planes.weight]\nfile = \"w.bin\"\n{keys}");
    let client = client(&[("w.bin", bytes)], &toml);
    (scalars(&client, "weight"), client.storage("weight"))
}

#[test]
fn every_format_of_numbers() {
    // 1, -2, the largest number, the smallest, infinity of f16.
    let halves = le(&[0x3C00_u16, 0xC000, 0x7BFF, 0x0001, 0x7C00], u16::to_le_bytes);
    let known = vec![1.0, -2.0, 65_504.0, 1.0 / 16_777_216.0, f64::INFINITY];
    assert_eq!(weights(&halves, 5, "format = \"f16\""), (known, Storage::Half));
    let known = (vec![0.0, 0.2, 1.0], Storage::Steps(1.0 / 255.0));
    assert_eq!(weights(&[0, 51, 255], 3, "format = \"unorm8\""), known);
    let codes = le(&[0_u16, 13_107, 65_535], u16::to_le_bytes);
    let known = (vec![0.0, 0.2, 1.0], Storage::Steps(1.0 / 65_535.0));
    assert_eq!(weights(&codes, 3, "format = \"unorm16\""), known);
    let codes = le(&[0_u32, 3_355_443, 0xFFFF_FFFF], u32::to_le_bytes);
    let known = (vec![0.0, 0.2, 1.0], Storage::Steps(1.0 / 16_777_215.0));
    assert_eq!(weights(&codes, 3, "format = \"unorm24\""), known);
    let known = (vec![1.0, -1.0, -1.0, 0.0], Storage::Steps(1.0 / 127.0));
    assert_eq!(weights(&[127, 129, 128, 0], 4, "format = \"snorm8\""), known);
    let codes = le(&[32_767_i16, -32_767, i16::MIN], i16::to_le_bytes);
    let known = (vec![1.0, -1.0, -1.0], Storage::Steps(1.0 / 32_767.0));
    assert_eq!(weights(&codes, 3, "format = \"snorm16\""), known);
    let (values, _) = weights(&floats(&[f32::NAN, -0.0]), 2, "");
    assert!(values[0].is_nan() && values[1].is_sign_negative(), "{values:?}");
}

#[test]
fn normals_in_a_range() {
    // A code v means 2 v / 255 - 1; the fourth byte of a pixel is skipped.
    let bytes = [255, 0, 51, 9, 204, 255, 0, 9];
    let toml = "size = [2, 1]\n[planes.normal]\nfile = \"n.bin\"\nformat = \"unorm8\"\n\
                range = [-1, 1]\npixel_stride = 4";
    let client = client(&[("n.bin", &bytes)], toml);
    near(triples(&client, "normal").as_flattened(), &[1.0, -1.0, -0.6, 0.6, 1.0, -1.0]);
    assert_eq!(client.storage("normal"), Storage::Steps(2.0 / 255.0));
}

#[test]
fn three_numbers_in_one_word() {
    // 1023, 0 and 341 of 1023, whatever the upper two bits are; then 0, 1023 and 682.
    let words = [1023 | 341 << 20 | 3 << 30, 1023 << 10 | 682 << 20].map(u32::to_le_bytes);
    let toml = "size = [2, 1]\n[planes.normal]\nfile = \"n.bin\"\nformat = \"rgb10a2\"\n\
                range = [-1, 1]";
    let normals = client(&[("n.bin", words.as_flattened())], toml);
    let third = 1.0 / 3.0;
    near(triples(&normals, "normal").as_flattened(), &[1.0, -1.0, -third, -1.0, 1.0, third]);
    assert_eq!(normals.storage("normal"), Storage::Steps(2.0 / 1023.0));
    // Floats: exponent 15 is 1, with half of a mantissa 1.5; the least above 0; exponent 17, 4.
    let words =
        [15 << 6 | (15 << 6 | 32) << 11 | (17 << 5) << 22, 1 | 1 << 22].map(u32::to_le_bytes);
    let toml = "size = [2, 1]\n[planes.RGB]\nfile = \"c.bin\"\nformat = \"rg11b10\"";
    let colors = client(&[("c.bin", words.as_flattened())], toml);
    let least = 1.0 / 1_048_576.0;
    assert_eq!(triples(&colors, ""), [[1.0, 1.5, 4.0], [least, 0.0, 2.0 * least]]);
    let lost = Storage::Float { relative: 1.0 / 32.0, least: 2.0 * least };
    assert_eq!(colors.storage(""), lost);
    let folder = Folder::new().with("w.raw", words.as_flattened());
    let line = folder.refusal("[planes.weight]\nfile = \"w.raw\"\nformat = \"rgb10a2\"");
    assert!(line.contains("three numbers a pixel, but the plane holds one"), "{line}");
}

#[test]
fn numbers_at_distances() {
    // After 3 bytes, rows of 7 bytes: two pixels of 3 bytes, whose first byte counts; the last row
    // is short.
    let bytes = [9, 9, 9, 0, 8, 8, 51, 8, 8, 8, 102, 8, 8, 255];
    let keys =
        "file = \"w.raw\"\nformat = \"unorm8\"\noffset = 3\nrow_stride = 7\npixel_stride = 3";
    let toml = format!("[planes.weight]\n{keys}");
    let upright = client(&[("w.raw", &bytes)], &toml);
    assert_eq!(scalars(&upright, "weight"), [0.0, 0.2, 0.4, 1.0]);
    let toml = format!("origin = \"bottom-left\"\n{toml}");
    let turned = client(&[("w.raw", &bytes)], &toml);
    assert_eq!(scalars(&turned, "weight"), [0.4, 1.0, 0.0, 0.2]);
    let short = Folder::new().with("w.raw", &bytes[..13]);
    let line = short.refusal(&toml);
    assert!(
        line.contains("w.raw: planes.weight: 2 x 2 pixels of unorm8 need at least 14"),
        "{line}"
    );
}

#[test]
fn indices_of_every_format() {
    let read = |bytes: &[u8], keys: &str| {
        let toml = format!("size = [3, 1]\n[planes.id]\nfile = \"id.raw\"\n{keys}");
        ids(&client(&[("id.raw", bytes)], &toml), "id")
    };
    let known = [7, NO_ID, 0];
    assert_eq!(read(&le(&[7_u32, NO_ID, 0], u32::to_le_bytes), ""), known);
    assert_eq!(read(&le(&[7, -1, 0], i32::to_le_bytes), "format = \"i32\""), known);
    assert_eq!(read(&le(&[7_u32, NO_ID, 0], u32::to_le_bytes), "empty = -1"), known);
    assert_eq!(read(&[7, 255, 0], "format = \"u8\"\nempty = 255"), known);
    let short = le(&[7_u16, 9, 0], u16::to_le_bytes);
    assert_eq!(read(&short, "format = \"u16\"\nempty = 9"), known);
    assert_eq!(read(&floats(&[7.0, -1.0, 0.0]), "format = \"f32\"\nempty = -1"), known);
    // 7, infinity, 0 in f16: a clear value of all bits becomes infinity.
    let halves = le(&[0x4700_u16, 0x7C00, 0], u16::to_le_bytes);
    assert_eq!(read(&halves, "format = \"f16\""), known);
    // The first is 1.
    assert_eq!(read(&le(&[8_u32, 0, 1], u32::to_le_bytes), "id_base = 1"), known);
    assert_eq!(read(&le(&[8_u32, 99, 1], u32::to_le_bytes), "id_base = 1\nempty = 99"), known);
    let toml = "size = [3, 1]\n[planes]\n\"attributes.count\" = \"c.raw\"";
    let counts = client(&[("c.raw", &[0, 3, 255])], toml);
    assert_eq!(counts.frame().count("attributes.count").unwrap().values(), [0, 3, 255]);
}

#[test]
fn colors_of_srgb() {
    // From the tables of sRGB: the code 188 is 0.5028865, and 10 lies on the straight part.
    let toml = "size = [1, 1]\n[planes.RGB]\nfile = \"c.raw\"\nformat = \"unorm8\"\n\
                encoding = \"srgb\"";
    let client = client(&[("c.raw", &[188, 10, 255])], toml);
    let [[r, g, b]] = triples(&client, "").try_into().unwrap();
    assert!((r - 0.502_886_5).abs() < 1e-7 && b == 1.0, "{r} {b}");
    near(&[g], &[10.0 / 255.0 / 12.92]);
    assert_eq!(client.storage(""), Storage::Srgb { relative: 0.0, least: 1.0 / 255.0 });
}

#[test]
fn colors_multiplied_by_alpha() {
    let color = floats(&[0.25, 0.5, 0.125, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    let alpha = floats(&[0.5, 1.0, 0.0]);
    let toml = "size = [3, 1]\n[planes]\nA = \"a.raw\"\n\
                RGB = { file = \"c.raw\", premultiplied = true }";
    let straight = client(&[("c.raw", &color), ("a.raw", &alpha)], toml);
    let known = [[0.5, 1.0, 0.25], [0.0, 1.0, 0.0], [0.0; 3]];
    assert_eq!(triples(&straight, ""), known);
    let step = 1.0 / 8_388_608.0;
    let radii = straight.radii("").unwrap().values();
    assert_eq!(radii[0], [0.5 * step, step, 0.25 * step], "the product was rounded");
    assert_eq!(radii[2], [0.0; 3]);

    // Codes 51 with alpha 102: (1/255 + 0.5 / 255) / (101 / 255) = 1.5 / 101.
    let toml = "size = [2, 1]\n[planes]\nA = { file = \"a.raw\", format = \"unorm8\" }\n\
                RGB = { file = \"c.raw\", format = \"unorm8\", premultiplied = true }";
    let codes = client(&[("c.raw", &[51, 0, 102, 1, 0, 0]), ("a.raw", &[102, 1])], toml);
    near(&triples(&codes, "")[0], &[0.5, 0.0, 1.0]);
    let radii = codes.radii("").unwrap().values();
    near(&radii[0], &[1.5 / 101.0, 1.0 / 101.0, 2.0 / 101.0]);
    assert_eq!(radii[1], [f64::INFINITY; 3], "an alpha that may be 0");
}

#[test]
fn names_of_colors() {
    let color = floats(&[0.25; 12]);
    for name in ["attributes", "\"attributes.RGB\""] {
        let toml = format!("[planes]\n{name} = \"c.raw\"");
        assert_eq!(triples(&client(&[("c.raw", &color)], &toml), "attributes"), [[0.25; 3]; 4]);
    }
}
