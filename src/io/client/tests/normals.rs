//! Check unit vectors in two numbers against independent formulas.

use super::*;
use crate::number::random;
use exr::prelude::f16;

/// The encoding, with a division by the sum of the absolute components.
fn encoded([x, y, z]: [f64; 3]) -> [f64; 2] {
    let sum = x.abs() + y.abs() + z.abs();
    let (u, v) = (x / sum, y / sum);
    if z >= 0.0 { [u, v] } else { [(1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v)] }
}

/// The decoding in the form of Stubbe: the part outside the octahedron is folded back.
fn decoded([u, v]: [f64; 2]) -> [f64; 3] {
    let z = 1.0 - u.abs() - v.abs();
    let out = if z < 0.0 { -z } else { 0.0 };
    let back = |part: f64| if part >= 0.0 { part - out } else { part + out };
    let (x, y) = (back(u), back(v));
    let length = (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|part| part / length)
}

/// Random directions, and those along edges and corners of the octahedron.
fn directions() -> Vec<[f64; 3]> {
    let signs = [-1.0, 0.0, 1.0];
    let all = signs.into_iter().flat_map(|x| signs.into_iter().map(move |y| (x, y)));
    let mut all: Vec<_> =
        all.flat_map(|(x, y)| signs.into_iter().map(move |z| [x, y, z])).collect();
    all.extend(
        (0..2000).map(|i| [0, 1, 2].map(|c| f64::from(2.0 * random::unit(70, 3 * i + c) - 1.0))),
    );
    all.retain(|v| v.iter().map(|part| part * part).sum::<f64>() > 1e-6);
    let unit = |v: [f64; 3]| {
        let length = v.iter().map(|part| part * part).sum::<f64>().sqrt();
        v.map(|part| part / length)
    };
    all.into_iter().map(unit).collect()
}

/// A format, the bytes of a number rounded down or up, and its step.
type Rounding = (&'static str, fn(f64, bool) -> Vec<u8>, f64);

fn side(code: f64, up: bool) -> f64 {
    if up { code.ceil() } else { code.floor() }
}

const FORMATS: [Rounding; 6] = [
    ("snorm8", |v, up| vec![side(v * 127.0, up) as i8 as u8], 1.0 / 127.0),
    ("snorm16", |v, up| (side(v * 32_767.0, up) as i16).to_le_bytes().to_vec(), 1.0 / 32_767.0),
    ("unorm8", |v, up| vec![side((v + 1.0) * 127.5, up) as u8], 2.0 / 255.0),
    (
        "unorm16",
        |v, up| (side((v + 1.0) * 32_767.5, up) as u16).to_le_bytes().to_vec(),
        2.0 / 65_535.0,
    ),
    (
        "f16",
        |v, up| {
            let near = f16::from_f64(v);
            let beyond = (near.to_f64() > v) != up && near.to_f64() != v;
            let away = (v < 0.0) != up;
            let bits = match (beyond, away) {
                (false, _) => near.to_bits(),
                (true, true) => near.to_bits() + 1,
                (true, false) => near.to_bits() - 1,
            };
            bits.to_le_bytes().to_vec()
        },
        1.0 / 1024.0,
    ),
    ("f32", |v, _| (v as f32).to_le_bytes().to_vec(), 0.0),
];

/// The normals of stored pairs; no pixel is empty.
fn read(format: &str, pairs: &[u8], depths: &[f32]) -> Client {
    let size = depths.len();
    let folder = Folder::new().with("n.raw", pairs).with("z.raw", &floats(depths));
    folder
        .read(&format!(
            "size = [{size}, 1]\n[planes]\nZ = \"z.raw\"\n[planes.normal]\nfile = \"n.raw\"\n\
             format = \"{format}\"\nencoding = \"octahedral\""
        ))
        .unwrap()
}

#[test]
fn a_normal_lies_within_the_radii_of_its_two_numbers() {
    let all = directions();
    for (format, bytes, step) in FORMATS {
        for ups in 0..4 {
            let pairs = all.iter().flat_map(|normal| {
                let [u, v] = encoded(*normal);
                [bytes(u, ups & 1 > 0), bytes(v, ups & 2 > 0)].concat()
            });
            let pairs: Vec<u8> = pairs.collect();
            let client = read(format, &pairs, &vec![1.0; all.len()]);
            let found = triples(&client, "normal");
            let radii = client.radii("normal").unwrap().values();
            for ((known, found), radii) in all.iter().zip(&found).zip(radii) {
                let length = found.iter().map(|part| part * part).sum::<f64>();
                assert!((length - 1.0).abs() < 1e-12);
                for c in 0..3 {
                    let off = (known[c] - found[c]).abs();
                    assert!(off <= radii[c], "{format}: {known:?} {found:?} {radii:?}");
                    assert!(radii[c] <= 4.6 * step + 1e-5, "{format}: {radii:?}");
                }
            }
        }
    }
}

#[test]
fn two_numbers_are_decoded_as_another_formula_does() {
    let pairs: Vec<[f32; 2]> = (0..4000)
        .map(|i| [0, 1].map(|c| 2.0 * random::unit(71, 2 * i + c) - 1.0))
        .chain([[0.0, 0.0], [1.0, 1.0], [-1.0, 1.0], [0.5, -0.5], [-1.0, 0.0]])
        .collect();
    let bytes = floats(pairs.as_flattened());
    let client = read("f32", &bytes, &vec![1.0; pairs.len()]);
    for (pair, found) in pairs.iter().zip(triples(&client, "normal")) {
        let known = decoded(pair.map(f64::from));
        assert!((0..3).all(|c| (known[c] - found[c]).abs() < 1e-12), "{pair:?} {found:?}");
    }
}

#[test]
fn where_nothing_is_there_is_no_normal() {
    let codes = floats(&[0.0, 0.0, 0.0, 0.0, 1.5, 0.0]);
    let client = read("f32", &codes, &[1.0, f32::INFINITY, 1.0]);
    let [up, none, outside] = triples(&client, "normal").try_into().unwrap();
    assert_eq!((up, none), ([0.0, 0.0, 1.0], [0.0; 3]));
    assert!(outside.iter().all(|part: &f64| part.is_nan()));
    assert_eq!(client.radii("normal").unwrap().values()[1], [0.0; 3]);
}

#[test]
fn an_encoding_that_does_not_fit_is_refused() {
    let at = || Folder::new().with("n.raw", &floats(&[0.0; 8])).with("c.raw", &floats(&[0.0; 12]));
    for (toml, what) in [
        ("normal = { file = \"n.raw\", encoding = \"octahedral\" }", "needs the plane `Z`"),
        ("\"attributes.normal\" = { file = \"n.raw\", encoding = \"octahedral\" }", "unit vectors"),
        ("RGB = { file = \"n.raw\", encoding = \"octahedral\" }", "unit vectors"),
        ("normal = { file = \"c.raw\", encoding = \"srgb\" }", "encoding is for colours"),
        (
            "normal = { file = \"n.raw\", encoding = \"octahedral\", format = \"rgb10a2\" }",
            "the plane holds two",
        ),
    ] {
        let line = at().refusal(&format!("[planes]\n{toml}"));
        assert!(line.contains(what), "{line}");
    }
}
