//! Check round trips, files of other programs, and hostile files.

mod window;

use super::*;
use crate::error::Error;
use crate::frame::image::{Image, Values};
use crate::frame::{Exec, Frame, NO_ID, NamedPlane, Plane, Samples};
use exr::math::RoundingMode;
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression as Codec, Encoding, FlatSamples,
    Image as ExrImage, Layer, LayerAttributes, Levels, LineOrder, Vec2, WritableImage, f16,
};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// Bits that a careless file format would change.
const STRANGE: [u32; 8] = [
    0x7F80_0000, // +inf
    0xFF80_0000, // -inf
    0x8000_0000, // -0
    0x0000_0001, // the smallest subnormal
    0x807F_FFFF, // the largest negative one
    0x7F7F_FFFF, // the largest number
    0x7FA0_1234, // a signalling NaN
    0x3F80_0001, // 1 + epsilon
];

/// A frame with every kind of plane; value `i` of a plane is `STRANGE`, then a mix of all bits.
fn frame(width: u32, height: u32) -> Frame<f32> {
    let count = width as usize * height as usize;
    let bits = |i: usize, salt: u32| match STRANGE.get(i) {
        Some(&strange) => strange,
        None => (i as u32 ^ salt).wrapping_mul(0x9E37_79B9) & 0x7EFF_FFFF,
    };
    let floats = |salt: u32| (0..count).map(|i| f32::from_bits(bits(i, salt))).collect::<Vec<_>>();
    let triples = |salt: u32| {
        let channel = |c: u32| floats(salt + c);
        let (x, y, z) = (channel(0), channel(1), channel(2));
        (0..count).map(|i| [x[i], y[i], z[i]]).collect::<Vec<_>>()
    };
    let ids = (0..count).map(|i| if i % 3 == 0 { NO_ID } else { bits(i, 9) }).collect();
    let counts = (0..count).map(|i| (i * 7) as u8).collect();
    let planes = [
        ("", Samples::Color(Plane::from_values(width, height, triples(1)))),
        ("Z", Samples::Scalar(Plane::from_values(width, height, floats(5)))),
        ("id", Samples::Index(Plane::from_values(width, height, ids))),
        ("normal", Samples::Vector(Plane::from_values(width, height, triples(11)))),
        ("attributes.count", Samples::Count(Plane::from_values(width, height, counts))),
    ];
    let planes = planes.map(|(name, samples)| NamedPlane { name: name.into(), samples });
    Frame { width, height, planes: planes.into() }
}

/// The channels as bits, so that NaN compares equal to itself.
fn bits(image: &Image) -> Vec<(&str, Vec<u32>)> {
    let of = |values: &Values| match values {
        Values::Float(values) => values.iter().map(|v| v.to_bits()).collect(),
        Values::Index(values) => values.clone(),
    };
    image.channels.iter().map(|(name, values)| (name.as_str(), of(values))).collect()
}

/// A file of these bytes, in a folder that is removed on drop.
fn file(bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

#[test]
fn every_bit_comes_back() {
    for (width, height) in [(1, 1), (7, 5), (33, 17), (16, 48), (65536, 1), (1, 4099)] {
        let (_folder, path) = file(b"an older file, to be replaced");
        let frame = frame(width, height);
        write(&path, &frame, "two\nlines, \u{e9}").unwrap();
        let image = read(&path).unwrap();
        assert_eq!((image.width, image.height), (width, height));
        assert_eq!(image.text.as_deref(), Some("two\nlines, \u{e9}"));

        let component = |samples: &Samples<f32>, c: usize| match samples {
            Samples::Scalar(p) => p.values().iter().map(|v| v.to_bits()).collect::<Vec<_>>(),
            Samples::Color(p) | Samples::Vector(p) => {
                p.values().iter().map(|v| v[c].to_bits()).collect()
            }
            Samples::Index(p) => p.values().to_vec(),
            Samples::Count(p) => p.values().iter().map(|&v| u32::from(v)).collect(),
        };
        let expected = [
            ("B", "", 2),
            ("G", "", 1),
            ("R", "", 0),
            ("Z", "Z", 0),
            ("attributes.count", "attributes.count", 0),
            ("id", "id", 0),
            ("normal.X", "normal", 0),
            ("normal.Y", "normal", 1),
            ("normal.Z", "normal", 2),
        ]
        .map(|(name, plane, c)| (name, component(frame.plane(plane).unwrap(), c)));
        assert_eq!(bits(&image), expected, "{width} x {height}");
        assert!(matches!(image.channel("id"), Some(Values::Index(_))));
        assert!(matches!(image.channel("Z"), Some(Values::Float(_))));
    }
}

/// The bytes of a written file, after checking that its planes come back.
fn written(frame: &Frame<f32>, compression: Compression, exec: &Exec) -> Vec<u8> {
    let (_folder, path) = file(b"");
    pending(&path, frame, "text", compression, exec).unwrap().put().unwrap();
    let back = read_with(&path, exec).unwrap();
    assert_eq!(bits(&back), bits(&Image::from(frame)), "{compression:?}");
    std::fs::read(&path).unwrap()
}

/// The hashes change if a codec gives different bytes, as a new version of a library may.
#[test]
fn bytes_are_a_function_of_frame_text_and_compression() {
    let hashes = Compression::WORDS.iter().map(|(name, compression)| {
        let bytes = written(&frame(40, 70), *compression, &Exec::sequential());
        format!("{name} {}", sha256(&bytes))
    });
    let expected = [
        "rle 83b9d6454ee54a79b537abda389320265e2a1c0527ef9535d01bcd61f3cd2c12",
        "zip fa2117e4a9a4231e02622238725e923fedddcb9d3da3f9959ececefcbbe42852",
        "piz a2f0df38bcbfc89f333044bc46f67eefab5c84ca8f2954790ec39409b440f1f2",
        "none 984d5cb1090d642c186adec71b524ca2868ef75dd337157219e613572d7e975b",
    ];
    assert_eq!(hashes.collect::<Vec<_>>(), expected);
}

#[test]
fn threads_change_neither_bytes_nor_planes() {
    // Enough for more than one batch of every kind.
    let frame = frame(700, 600);
    for (_, compression) in Compression::WORDS {
        let alone = written(&frame, *compression, &Exec::sequential());
        for threads in [2, 5] {
            let exec = Exec::new(threads, 32).unwrap();
            assert!(written(&frame, *compression, &exec) == alone, "{compression:?}, {threads}");
        }
    }
}

#[test]
fn of_several_damaged_blocks_the_first_is_named() {
    let (_folder, path) = file(b"");
    let exec = Exec::new(3, 32).unwrap();
    pending(&path, &frame(64, 512), "", Compression::Zip, &exec).unwrap().put().unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    // From the second eighth on everything is lost; the header and the table stay.
    let from = bytes.len() / 8;
    bytes[from..].fill(0x55);
    let (_folder, path) = file(&bytes);
    let alone = read(&path).unwrap_err().to_string();
    assert!(alone.contains("part 0, block "), "{alone}");
    assert_eq!(read_with(&path, &exec).unwrap_err().to_string(), alone);
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn the_header_alone_tells_the_channels() {
    let (_folder, path) = file(b"");
    write(&path, &frame(40, 30), "text").unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let header = read_header(&path).unwrap();
    assert_eq!((header.width, header.height), (40, 30));
    assert_eq!(header.compressions, ["rle compression"]);
    assert_eq!(header.text.as_deref(), Some("text"));
    assert_eq!(header.channels.len(), 9);
    assert_eq!(header.channels[3], ("Z".into(), ChannelType::Float));
    assert_eq!(header.channels[5], ("id".into(), ChannelType::Uint));
    // `read_header` reads no pixel, so damage to pixels matters only to `read`.
    let middle = bytes.len() * 3 / 4;
    let mut damaged = bytes;
    damaged[middle..].fill(0x55);
    let (_folder, path) = file(&damaged);
    assert_eq!(read_header(&path).unwrap(), header);
    assert!(read(&path).is_err());
}

#[test]
fn what_is_no_picture_is_refused_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let refused = |frame: &Frame<f32>| write(&path, frame, "").unwrap_err().to_string();
    let plane = |name: &str| NamedPlane {
        name: name.into(),
        samples: Samples::Scalar(Plane::filled(2, 2, 0.0_f32)),
    };
    assert!(refused(&Frame { width: 0, height: 4, planes: vec![plane("Z")] }).contains("0 x 4"));
    assert!(refused(&Frame { width: 2, height: 2, planes: vec![] }).contains("0 channels"));
    assert!(refused(&Frame { width: 3, height: 2, planes: vec![plane("Z")] }).contains("`Z`"));
    let twice = Frame { width: 2, height: 2, planes: vec![plane("Z"), plane("Z")] };
    assert!(refused(&twice).contains("unique"));
    let long = "a".repeat(32);
    assert!(refused(&Frame { width: 2, height: 2, planes: vec![plane(&long)] }).contains(&long));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// `tests/data/openexr.exr`, whose script beside it names the reference implementation's version.
#[test]
fn a_file_of_the_reference_implementation_is_read() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/openexr.exr");
    let image = read(&path).unwrap();
    assert_eq!((image.width, image.height), (13, 9));
    assert_eq!(image.text.as_deref(), Some("h\u{e9}llo"));
    let pixels = (0..9_u64).flat_map(|y| (0..13_u64).map(move |x| (x, y)));
    let mut z = Vec::new();
    let mut a = Vec::new();
    let mut id = Vec::new();
    for (x, y) in pixels {
        z.push(((x * x * 7 + y * 13 + x * y * 3) % 256) as f32 / 256.0);
        a.push(((x * 5 + y * 11) % 64) as f32 / 64.0 - 0.5);
        id.push((x * 40503 + y * 2_654_435_761) as u32);
    }
    (z[0], z[8 * 13 + 12], id[0]) = (f32::INFINITY, f32::from_bits(1), NO_ID);
    // 6e-8 is the smallest subnormal of a half: 2^-24.
    (a[1], a[2]) = (f32::NEG_INFINITY, 1.0 / 16_777_216.0);
    let expected = [
        ("lines.A", Values::Float(a)),
        ("lines.Z", Values::Float(z.clone())),
        ("lines.id", Values::Index(id.clone())),
        ("tiles.Z", Values::Float(z)),
        ("tiles.id", Values::Index(id)),
    ];
    let expected = expected.map(|(name, values)| (name.to_owned(), values));
    assert_eq!(image.channels, expected);
    let types = read_header(&path).unwrap().channels;
    assert_eq!(types[0], ("lines.A".into(), ChannelType::Half));
}

/// A file of 20 x 12 pixels by the exr crate's own high-level interface, full resolution or more.
fn by_the_crate(compression: Codec, blocks: Blocks, level_sizes: &[usize]) -> Vec<u8> {
    let levels = |of: fn(usize) -> FlatSamples| match level_sizes {
        [one] => Levels::Singular(of(*one)),
        more => Levels::Mip {
            rounding_mode: RoundingMode::Down,
            level_data: more.iter().map(|&pixels| of(pixels)).collect(),
        },
    };
    let halves = |n| FlatSamples::F16((0..n).map(|i| f16::from_f32(small(i))).collect());
    let floats = |n| FlatSamples::F32((0..n).map(small).collect());
    let indices = |n| FlatSamples::U32((0..n).map(|i| i as u32).collect());
    let list = [
        AnyChannel::new("half", levels(halves)),
        AnyChannel::new("float", levels(floats)),
        AnyChannel::new("uint", levels(indices)),
    ];
    let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
    let channels = AnyChannels::sort(list.into_iter().collect());
    let attributes = LayerAttributes::named("layer");
    let image = ExrImage::from_layer(Layer::new((20, 12), attributes, encoding, channels));
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// Value `i` of [`by_the_crate`]: exact in every type, and in the 24 bits of PXR24.
fn small(i: usize) -> f32 {
    (i % 7) as f32 * 0.25
}

/// Small files of every kind that can be read; all hold the same three channels.
fn of_every_kind() -> Vec<Vec<u8>> {
    use Codec::{PIZ, PXR24, RLE, Uncompressed, ZIP1, ZIP16};
    let tiles = Blocks::Tiles(Vec2(8, 8));
    let mut files = Vec::new();
    for compression in [Uncompressed, RLE, ZIP1, ZIP16, PIZ, PXR24] {
        files.push(by_the_crate(compression, Blocks::ScanLines, &[240]));
        files.push(by_the_crate(compression, tiles, &[240]));
    }
    files.push(by_the_crate(ZIP1, tiles, &[240, 10 * 6, 5 * 3, 2, 1]));
    files
}

#[test]
fn every_compression_and_tiling_is_read() {
    for bytes in of_every_kind() {
        let (_folder, path) = file(&bytes);
        let image = read(&path).unwrap();
        assert_eq!((image.width, image.height, image.text), (20, 12, None));
        let floats = Values::Float((0..240).map(small).collect());
        let expected = [
            ("float", floats.clone()),
            ("half", floats),
            ("uint", Values::Index((0..240).collect())),
        ];
        assert_eq!(image.channels, expected.map(|(name, values)| (name.to_owned(), values)));
    }
}

/// `bytes` with the only `from` in it replaced by `to`.
fn patched(bytes: &[u8], from: &[u8], to: &[u8]) -> Vec<u8> {
    let places: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i..].starts_with(from)).collect();
    let [place] = places[..] else { panic!("{} places", places.len()) };
    [&bytes[..place], to, &bytes[place + from.len()..]].concat()
}

/// The line of a file's refusal.
fn refusal(bytes: &[u8]) -> String {
    let (_folder, path) = file(bytes);
    let error = read(&path).unwrap_err();
    assert!(matches!(error, Error::Format { .. }), "{error}");
    let line = error.to_string();
    assert!(!line.contains('\n') && line.contains("a.exr"), "{line}");
    line
}

#[test]
fn kinds_without_planes_are_refused_by_name() {
    let bytes = by_the_crate(Codec::ZIP16, Blocks::ScanLines, &[240]);
    let deep = patched(&bytes, b"\x0d\0\0\0scanlineimage", b"\x0c\0\0\0deepscanline");
    assert!(refusal(&deep).contains("deep data"));
    let one = b"float\0\x02\0\0\0\x01\0\0\0\x01\0\0\0\x01\0\0\0";
    let two = b"float\0\x02\0\0\0\x01\0\0\0\x02\0\0\0\x02\0\0\0";
    assert!(refusal(&patched(&bytes, one, two)).contains("subsampling"));
    let window =
        |right: &[u8]| [b"displayWindow\0box2i\0\x10\0\0\0\0\0\0\0\0\0\0\0", right].concat();
    let huge = patched(&bytes, &window(&[19, 0, 0, 0, 11]), &window(&[0, 0, 0, 32, 11]));
    assert!(refusal(&huge).contains("a display window of 536870913 x 12 pixels around data of 20"));
    let twice = patched(&bytes, b"half\0\x01", b"float\0\x01");
    assert!(refusal(&twice).contains("header"));
    let dwa = patched(&bytes, b"compression\0\x01\0\0\0\x03", b"compression\0\x01\0\0\0\x08");
    assert!(refusal(&dwa).contains("ZIP"));
    assert!(refusal(b"").contains("byte 0"));
    assert!(refusal(b"ply\nformat ascii 1.0\n").contains("byte 0"));
    assert!(refusal(&bytes[..bytes.len() - 1]).contains("is truncated"));
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(read(&folder.path().join("none.exr")), Err(Error::Io { .. })));
    assert!(matches!(read(folder.path()), Err(Error::Io { .. })));
}

#[test]
fn a_file_that_promises_more_than_it_can_hold_is_refused() {
    let bytes = by_the_crate(Codec::ZIP16, Blocks::ScanLines, &[240]);
    // Both windows of 2^28 x 12 pixels: 3 GiB a channel, in one block as before.
    let huge = |bytes: &[u8], name: &str| {
        let window = [name.as_bytes(), b"\0box2i\0\x10\0\0\0\0\0\0\0\0\0\0\0"].concat();
        let from = [&window[..], b"\x13\0\0\0"].concat();
        patched(bytes, &from, &[&window[..], b"\xff\xff\xff\x0f"].concat())
    };
    let line = refusal(&huge(&huge(&bytes, "dataWindow"), "displayWindow"));
    assert!(line.contains("268435456 x 12 pixels"), "{line}");
}

/// A small generator with a full period: Steele and Vigna's splitmix64.
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[test]
fn mutated_files_never_panic_and_never_give_more_than_they_hold() {
    let mut files = of_every_kind();
    files.push(include_bytes!("../../../tests/data/openexr.exr").to_vec());
    let exec = Exec::sequential();
    let (mut state, mut good, mut bad) = (1, 0, 0);
    for _ in 0..2000 {
        for bytes in &files {
            let mut bytes = bytes.clone();
            for _ in 0..=random(&mut state) % 3 {
                // Half of the changes are in the first 600 bytes: the header and the table of
                // offsets.
                let end = if random(&mut state).is_multiple_of(2) { 600 } else { bytes.len() };
                let place = random(&mut state) as usize % end.min(bytes.len());
                match random(&mut state) % 5 {
                    0 => bytes[place] ^= 1 << (random(&mut state) % 8),
                    1 => bytes[place] = [0, 1, 0x7F, 0x80, 0xFF][random(&mut state) as usize % 5],
                    2 => bytes.truncate(place + 1),
                    3 => bytes.insert(place, random(&mut state) as u8),
                    _ => drop(bytes.remove(place)),
                }
                if bytes.is_empty() {
                    break;
                }
            }
            match read::decode(&bytes, &exec, read::Fit::Picture) {
                Ok(image) => {
                    good += 1;
                    let pixels = u64::from(image.width) * u64::from(image.height);
                    let planes = pixels * 4 * image.channels.len() as u64;
                    // A display window may be larger than the data.
                    assert!(planes <= (2 * 1376 * bytes.len() as u64).max(256 << 20));
                }
                Err(line) => {
                    bad += 1;
                    assert!(!line.contains('\n'), "{line}");
                }
            }
        }
    }
    assert!(good > 100 && bad > 1000, "the mutations test nothing: {good} good, {bad} bad");
}
