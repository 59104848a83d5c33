//! Check what is read, what is refused and how, and that no bytes make the reader panic.

mod coordinates;
mod far;
mod foreign;
mod gaussians;
mod refused;
mod rows;

use super::*;
use crate::scene::{Groups, Mipmap};
use glam::Vec3;

/// An ascii file: header lines, then body lines.
fn ascii(header: &[&str], body: &str) -> Vec<u8> {
    let header = header.join("\n");
    let end = if body.is_empty() || body.ends_with('\n') { "" } else { "\n" };
    format!("ply\nformat ascii 1.0\n{header}\nend_header\n{body}{end}").into_bytes()
}

const XYZ: [&str; 3] = ["property float x", "property float y", "property float z"];

/// As [`ascii`], with vertices that have x, y, z and the given properties.
fn vertices(count: &str, more: &[&str], body: &str) -> Vec<u8> {
    let element = format!("element vertex {count}");
    let header: Vec<&str> =
        [element.as_str()].into_iter().chain(XYZ).chain(more.iter().copied()).collect();
    ascii(&header, body)
}

/// Three points and a face.
fn faces(more: &[&str], face: &str) -> Vec<u8> {
    let more: Vec<&str> = ["element face 1"].into_iter().chain(more.iter().copied()).collect();
    vertices("3", &more, &format!("0 0 0\n1 0 0\n0 1 0\n{face}\n"))
}

const INDICES: &str = "property list uchar int vertex_indices";

/// Three points with tangents and two edges.
fn edges(more: &[&str], edges: &str) -> Vec<u8> {
    let tangent = ["property float tx", "property double ty", "property char tz"];
    let more = [&tangent[..], &["element edge 2"], more].concat();
    vertices("3", &more, &format!("0 0 0 1 0 0\n1 0 0 0 2 0\n0 1 0 0 0 -1\n{edges}\n"))
}

const ENDS: [&str; 2] = ["property int vertex1", "property ushort vertex2"];

/// One vertex of all types and a face with a list before the indices, in binary.
fn binary(big: bool) -> Vec<u8> {
    let header = "ply\nformat binary_FORMAT 1.0\ncomment \u{e4}\nelement vertex 3\n\
        property double x\nproperty int y\nproperty float z\nproperty char skipped\n\
        property uchar red\nproperty ushort green\nproperty float blue\n\
        property list ushort short more\nproperty uchar alpha\n\
        element other 1\nproperty uint a\n\
        element face 1\nproperty list int double uv\nproperty list uint ushort vertex_index\n\
        end_header\n";
    let header = header.replace("FORMAT", if big { "big_endian" } else { "little_endian" });
    let mut body = Vec::new();
    let mut put = |little: &[u8]| {
        let mut value = little.to_vec();
        if big {
            value.reverse();
        }
        body.extend(value);
    };
    for i in 0..3_u8 {
        put(&(0.5 + f64::from(i)).to_le_bytes());
        put(&(-7_i32).to_le_bytes());
        put(&1.25_f32.to_le_bytes());
        put(&(-1_i8).to_le_bytes());
        put(&[255]);
        put(&0_u16.to_le_bytes());
        put(&0.75_f32.to_le_bytes());
        put(&u16::from(i).to_le_bytes());
        (0..i).for_each(|_| put(&(-2_i16).to_le_bytes()));
        put(&[51]);
    }
    put(&u32::MAX.to_le_bytes());
    put(&1_i32.to_le_bytes());
    put(&f64::NAN.to_le_bytes());
    put(&3_u32.to_le_bytes());
    (0..3_u16).for_each(|i| put(&i.to_le_bytes()));
    let mut bytes = header.into_bytes();
    bytes.extend(body);
    bytes
}

/// The same in ascii, with CR LF, a wrapped row and blank lines.
fn text() -> Vec<u8> {
    let header = binary(false);
    let end = header.windows(11).position(|w| w == b"end_header\n").unwrap();
    let header = String::from_utf8(header[..end].to_vec()).unwrap();
    let header = header.replace("binary_little_endian", "ascii");
    let body = "0.5 -7 1.25 -1 255 0 0.75 0 51\n1.5 -7 125e-2 -1 255 0 .75 1 -2 51 \n\n\
        2.5 -7 1.25 -1 255\n\t+0 0.75 2 -2 -2 51\n4294967295\n1 nan 3 0 1 2\n";
    format!("{header}obj_info none\nend_header\n{body}").replace('\n', "\r\n").into_bytes()
}

#[test]
fn the_three_formats_of_one_content_are_equal() {
    let expected = Cloud {
        position: [0.5, 1.5, 2.5].map(|x| Vec3::new(x, -7.0, 1.25)).to_vec(),
        color: Some(vec![Vec3::new(1.0, 0.0, 0.75); 3]),
        opacity: Some(vec![0.2; 3]),
        triangles: vec![[0, 1, 2]],
        ..Cloud::default()
    };
    assert_eq!(parse(&binary(false)).unwrap(), expected);
    assert_eq!(parse(&binary(true)).unwrap(), expected);
    assert_eq!(parse(&text()).unwrap(), expected);
}

#[test]
fn stored_colours_are_decoded_and_float_ones_kept() {
    let colors = |kind: &str, value: &str| {
        let properties = ["red", "green", "blue"].map(|c| format!("property {kind} {c}"));
        let body = format!("0 0 0 {value} {value} {value}");
        parse(&vertices("1", &properties.each_ref().map(String::as_str), &body)).unwrap()
    };
    let red = |cloud: Cloud| cloud.color.unwrap()[0].x;
    // ((127/255 + 0.055)/1.055)^2.4 by an independent calculator.
    assert!((f64::from(red(colors("uchar", "127"))) - 0.212_230_757).abs() < 1e-7);
    assert_eq!(red(colors("ushort", "32639")), red(colors("uchar", "127")), "127 * 257");
    assert_eq!(red(colors("float", "0.5")), 0.5);
    assert_eq!(red(colors("double", "1.5")), 1.5);
}

#[test]
fn prefiltered_colours_are_read_as_colours_are() {
    let text = |names: [&str; 7], kind: &str, value: &str| {
        let properties = names.map(|name| format!("property {kind} {name}"));
        let body = format!("0 0 0 {}", [value; 7].join(" "));
        parse(&vertices("1", &properties.each_ref().map(String::as_str), &body)).unwrap()
    };
    let names = ["red", "green", "blue", "mip1_red", "mip1_green", "mip1_blue", "mip01_red"];
    for (kind, value) in [("uchar", "127"), ("ushort", "32639"), ("float", "0.25")] {
        let cloud = text(names, kind, value);
        let mipmap = cloud.mipmap.unwrap();
        assert_eq!(
            (mipmap.levels(), mipmap.of_surfel(0)),
            (1, &cloud.color.unwrap()[..]),
            "{kind}"
        );
    }
    // Properties with other names are skipped, as by any reader that does not know them.
    let others = ["red", "green", "blue", "mip_red", "mip1_alpha", "mip0_red", "mipa_red"];
    assert_eq!(text(others, "float", "0.25").mipmap, None);
}

#[test]
fn polygons_are_fans_and_short_ones_nothing() {
    let polygon = |face: &str| parse(&faces(&[INDICES], face)).unwrap().triangles;
    assert_eq!(polygon("5 0 1 2 1 0"), [[0, 1, 2], [0, 2, 1], [0, 1, 0]]);
    assert!(polygon("2 0 1").is_empty());
    assert!(polygon("0").is_empty());
    // Faces may come before their vertices.
    let first = ascii(
        &["element face 2", INDICES, "element vertex 3", XYZ[0], XYZ[1], XYZ[2]],
        "3 2 1 0\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n",
    );
    assert_eq!(parse(&first).unwrap().triangles, [[2, 1, 0], [0, 1, 2]]);
}

#[test]
fn edges_join_two_vertices() {
    let more = ["property list uchar float uv", ENDS[1], "property uchar red", ENDS[0]];
    let cloud = parse(&edges(&more, "0 1 255 0\n1 9.5 2 0 2")).unwrap();
    assert_eq!(cloud.edges, [[0, 1], [2, 2]], "whatever the order of the properties");
    assert_eq!(cloud.tangent.unwrap(), [Vec3::X, 2.0 * Vec3::Y, Vec3::NEG_Z]);
    assert!(cloud.tangents.is_none(), "the half axes of an ellipse are something else");
    let none = vertices("1", &["element edge 0", "property float length"], "0 0 0\n");
    assert!(parse(&none).unwrap().edges.is_empty());
}

#[test]
fn values_that_are_no_numbers_go_into_the_cloud() {
    let cloud = parse(&vertices("2", &[], "nan inf -inf\n1e999 -1e-999 NaN\n")).unwrap();
    assert!(cloud.position[0].x.is_nan() && cloud.position[0].y == f32::INFINITY);
    assert_eq!(cloud.position[1].x, f32::INFINITY);
}

#[test]
fn an_ascii_float_is_rounded_once() {
    // Just above the middle of two floats, but the nearest f64 is the middle itself.
    let cloud = parse(&vertices("1", &[], "1.000000059604644775390626 0 0")).unwrap();
    assert_eq!(cloud.position[0].x, 1.0 + f32::EPSILON);
}

#[test]
fn elements_without_properties_take_no_time() {
    let bytes = vertices("1", &["element ghost 18446744073709551615"], "1 2 3\n");
    assert_eq!(parse(&bytes).unwrap().position, [Vec3::new(1.0, 2.0, 3.0)]);
}

#[test]
fn a_truncated_file_is_refused_wherever_it_ends() {
    // The text ends in CR LF; without the LF, its last number is still whole.
    for (whole, spared) in [(binary(false), 0), (binary(true), 0), (text(), 1)] {
        for end in 0..whole.len() - spared {
            assert!(parse(&whole[..end]).is_err(), "the first {end} bytes");
        }
    }
    assert!(parse(&text()).is_ok());
    let cut = parse(text().trim_ascii_end()).unwrap_err();
    assert!(cut.contains("may be cut"), "{cut}");
}

#[test]
fn binary_errors_name_the_byte() {
    let bytes = binary(false);
    let body = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let message = parse(&bytes[..bytes.len() - 1]).unwrap_err();
    let at = bytes.len() - 10;
    let list =
        format!("face 0 (byte {at}), property `vertex_index`: a list of 3 values, but only 5");
    assert!(message.starts_with(&list), "{message} should start with {list}");
    let mut longer = bytes.clone();
    longer.push(0);
    let left = format!("byte {}: 1 bytes are left over", bytes.len());
    assert!(parse(&longer).unwrap_err().starts_with(&left));
    let few = parse(&bytes[..body + 30]).unwrap_err();
    assert!(few.contains(&format!("the 30 bytes from byte {body} on hold at most 1")), "{few}");
}

#[test]
fn what_is_written_is_read_back_bit_for_bit() {
    let n = 300;
    let value = |i: usize| f32::from_bits((i as u32).wrapping_mul(2_654_435_761) & 0xFF7F_FFFF);
    let vector = |i: usize| Vec3::new(value(3 * i), value(3 * i + 1), value(3 * i + 2));
    let vectors = |from: usize| (from..from + n).map(vector).collect::<Vec<_>>();
    let plain = Cloud { position: vectors(0), ..Cloud::default() };
    let full = Cloud {
        normal: Some(vectors(1000)),
        radius: Some((0..n).map(value).collect()),
        color: Some(vectors(2000)),
        opacity: Some((n..2 * n).map(value).collect()),
        tangents: Some(vectors(3000).into_iter().zip(vectors(4000)).map(|(u, v)| [u, v]).collect()),
        tangent: Some(vectors(5000)),
        triangles: (0..n as u32 - 2).map(|i| [i, i + 2, i + 1]).collect(),
        edges: (1..n as u32).map(|i| [i, i / 2]).collect(),
        ..plain.clone()
    };
    let leveled =
        |levels| Some(Mipmap::new(levels, (0..n * levels).map(vector).collect()).unwrap());
    let groups = |added: Vec<(u32, u8)>, scale: &[f32]| {
        let own = (0..n).map(|i| (i % 3) as u8).collect();
        Some(Groups::new(own, added, scale.to_vec()).unwrap())
    };
    let grouped = |groups| Cloud { groups, ..plain.clone() };
    let clouds = [
        grouped(groups(vec![], &[1.0; 3])),
        grouped(groups(vec![], &[1.0; 5])),
        grouped(groups(vec![(7, 2), (7, 3), (299, 1)], &[1.0; 4])),
        Cloud { groups: groups(vec![(0, 63)], &[1.5; 64]), ..full.clone() },
        Cloud { edges: vec![[299, 0]], ..plain.clone() },
        Cloud { mipmap: leveled(1), color: Some(vectors(2000)), ..plain.clone() },
        Cloud { mipmap: leveled(16), ..full.clone() },
        Cloud { mipmap: leveled(3), groups: groups(vec![(0, 63)], &[1.5; 64]), ..full.clone() },
        plain.clone(),
        full,
    ];
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("cloud.ply");
    for cloud in clouds {
        write(&path, &cloud).unwrap();
        let mut again = read(&path).unwrap();
        again.warnings.clear(); // of colours that nobody means
        // Compare bits too, because -0 and +0 are equal as floats.
        assert_eq!(again, cloud);
        assert!(
            again.position.iter().flat_map(|p| p.to_array()).map(f32::to_bits).eq(cloud
                .position
                .iter()
                .flat_map(|p| p.to_array())
                .map(f32::to_bits))
        );
    }
}

#[test]
fn groups_come_in_any_order_and_are_skipped_without_their_property() {
    let text = |group: &str| {
        let header = [
            "element group 3",
            "property uchar more",
            "property double scale",
            "element vertex 2",
            XYZ[0],
            XYZ[1],
            XYZ[2],
            "property list int int also",
            group,
        ];
        ascii(&header, "9 1\n9 2\n9 0.5\n0 0 0 2 2 1 0\n0 0 0 0 1\n")
    };
    let groups = Groups::new(vec![0, 1], vec![(0, 1), (0, 2)], vec![1.0, 2.0, 0.5]).unwrap();
    assert_eq!(parse(&text("property int group")).unwrap().groups, Some(groups));
    assert_eq!(parse(&text("property int cluster")).unwrap().groups, None);
}

#[test]
fn errors_of_files_name_the_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("cloud.ply");
    assert!(matches!(read(&path), Err(Error::Io { .. })));
    std::fs::write(&path, "hello").unwrap();
    let message = read(&path).unwrap_err().to_string();
    assert!(message.contains("cloud.ply: line 1: not a PLY file"), "{message}");
    let uneven = Cloud { position: vec![Vec3::ZERO], radius: Some(vec![]), ..Cloud::default() };
    let message = write(&path, &uneven).unwrap_err().to_string();
    assert_eq!(message, "1 positions, but 0 radii");
    assert_eq!(std::fs::read(&path).unwrap(), b"hello", "left as it was");
}

/// The 64-bit generator of Steele et al. 2014, as a stream of choices.
struct SplitMix(u64);

impl SplitMix {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % end as u64) as usize
    }
}

#[test]
fn no_mutation_of_a_file_panics_or_is_read_wrongly() {
    let grouped = [
        "property uchar group",
        "property list uchar uchar also",
        "element group 2",
        "property float scale",
    ];
    let grouped = vertices("2", &grouped, "0 0 0 1 1 0\n0 0 0 0 0\n1\n2\n");
    let faces = faces(&[INDICES], "3 0 1 2");
    let lines = edges(&[ENDS[0], ENDS[1]], "0 1\n2 1");
    let leveled = ["red", "green", "blue", "mip1_red", "mip1_green", "mip1_blue"];
    let leveled = leveled.map(|name| format!("property uchar {name}"));
    let leveled = vertices("1", &leveled.each_ref().map(String::as_str), "0 0 0 1 2 3 4 5 6\n");
    let seeds = [binary(false), binary(true), text(), faces, grouped, lines, leveled];
    let words: [&[u8]; 10] = [
        b"-1",
        b"4294967295",
        b"18446744073709551615",
        b"list ",
        b"\n",
        b" ",
        b"nan",
        b"double",
        b"\xFF\xFF\xFF\xFF",
        b"property",
    ];
    let mut random = SplitMix(1);
    let mut read = 0;
    for round in 0..40_000 {
        let mut bytes = seeds[round % seeds.len()].clone();
        for _ in 0..=random.below(4) {
            let at = random.below(bytes.len());
            match random.below(5) {
                0 => bytes[at] = random.below(256) as u8,
                1 => bytes[at] ^= 1 << random.below(8),
                2 => bytes.truncate(at + 1),
                3 => {
                    let end = at + random.below(8).min(bytes.len() - at);
                    bytes.drain(at..end);
                }
                _ => {
                    let word = words[random.below(words.len())];
                    bytes.splice(at..at, word.iter().copied());
                }
            }
            if bytes.is_empty() {
                break;
            }
        }
        if let Ok(cloud) = parse(&bytes) {
            read += 1;
            cloud.check().unwrap();
            assert!(!cloud.position.is_empty());
            // No more positions than the bytes could hold: each takes at least three.
            assert!(cloud.position.len() * 3 <= bytes.len());
            assert!(cloud.triangles.len().max(cloud.edges.len()) <= bytes.len());
            if let Some(groups) = cloud.groups {
                assert!(groups.added().len() <= bytes.len());
            }
        }
    }
    assert!(read > 1000, "only {read} mutants are files: the mutations are too coarse");
}
