//! What a page holds can be read again, and a page keeps its limit.

use super::*;
use crate::frame::image::Values;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use miniz_oxide::inflate::decompress_to_vec_zlib;
use serde_json::Value;

/// A report of two pictures with these channels, each a plane of one tab.
fn report(size: [u32; 2], pictures: [Vec<(String, Values)>; 2]) -> Report {
    let pixels = size[0] as usize * size[1] as usize;
    let planes = pictures[0].iter().map(|(name, values)| Shown {
        name: name.clone(),
        kind: Kind::from_names(std::slice::from_ref(name), matches!(values, Values::Index(_))),
        unit: "",
        meaning: "",
        channels: vec![name.clone()],
    });
    let mut errors = vec![0.5; pixels];
    errors[3] = 2.0;
    let tab = Tab {
        name: "tab".into(),
        says: String::new(),
        mark: Mark::Wrong,
        planes: planes.collect(),
        wrong: errors.iter().map(|error| *error > 1.0).collect(),
        doubts: vec![0; pixels],
        worst: worst(&errors, 1),
        errors,
    };
    let [width, height] = size;
    Report {
        title: String::new(),
        facts: Vec::new(),
        about: String::new(),
        sides: ["Client", "Reference"],
        pictures: pictures.map(|channels| Image { width, height, channels, text: None }),
        measure: Measure { name: "", unit: "", limit: Some(1.0), words: ["right", "WRONG"] },
        tabs: vec![tab],
        doubts: Vec::new(),
        cause: None,
        explained: Vec::new(),
    }
}

/// The text of an element.
fn element<'p>(page: &'p str, id: &str) -> &'p str {
    let (_, rest) = page.split_once(&format!("id=\"{id}\"")).unwrap();
    rest.split_once('>').unwrap().1.split_once("</script>").unwrap().0
}

fn data(page: &str) -> Value {
    serde_json::from_str(element(page, "data")).unwrap()
}

/// A plane of bytes, as the script reads it.
fn bytes(page: &str, id: &Value) -> Vec<u8> {
    let packed = STANDARD.decode(element(page, &format!("b{id}"))).unwrap();
    let mut bytes = decompress_to_vec_zlib(&packed).unwrap();
    for i in 1..bytes.len() {
        bytes[i] = bytes[i].wrapping_add(bytes[i - 1]);
    }
    bytes
}

/// The bits of a channel in both pictures, as the script reads them.
fn bits(page: &str, channel: &Value) -> [Vec<u32>; 2] {
    let side = |i: usize| {
        let mut all: Vec<u32> = Vec::new();
        for (k, id) in channel["bytes"][i].as_array().unwrap().iter().enumerate() {
            let bytes = bytes(page, id);
            all.resize(bytes.len(), 0);
            let add = |(all, byte): (&mut u32, u8)| *all |= u32::from(byte) << (24 - 8 * k);
            all.iter_mut().zip(bytes).for_each(add);
        }
        all
    };
    let (first, second) = (side(0), side(1));
    let second = second.iter().zip(&first).map(|(bits, other)| bits ^ other).collect();
    [first, second]
}

#[test]
fn every_bit_comes_back() {
    let floats = [1.5, -0.0, f32::NAN, f32::INFINITY, 1e-42, 0.1];
    let channel = |name: &str, values| (name.to_owned(), values);
    let pictures = [
        vec![
            channel("Z", Values::Float(floats.to_vec())),
            channel("id", Values::Index(vec![0, 7, u32::MAX, 1 << 31, 5, 6])),
        ],
        vec![
            channel("Z", Values::Float(floats.map(f32::next_up).to_vec())),
            channel("id", Values::Index(vec![9, 7, u32::MAX, 0, 5, 6])),
        ],
    ];
    let report = report([3, 2], pictures);
    let page = html(&report, &Exec::sequential()).unwrap();
    let data = data(&page);
    for name in ["Z", "id"] {
        assert_eq!(data["channels"][name]["digits"], 4);
        for (found, picture) in bits(&page, &data["channels"][name]).iter().zip(&report.pictures) {
            let wanted: Vec<u32> = match picture.channel(name).unwrap() {
                Values::Float(values) => values.iter().map(|v| v.to_bits()).collect(),
                Values::Index(values) => values.clone(),
            };
            assert_eq!(*found, wanted, "{name}");
        }
    }
    assert_eq!(data["tabs"][0]["worst"][0][0], 3);
    assert_eq!(bytes(&page, &data["tabs"][0]["wrong"]), [0, 0, 0, 1, 0, 0]);
}

#[test]
fn a_page_keeps_its_limit_and_wrong_pixels_keep_their_bits() {
    // Noise, of which nothing can be saved.
    let size = [256, 128];
    let mut state = 1_u32;
    let mut noise = || {
        let of = |_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            1.0 + (state >> 9) as f32 / 8_388_608.0
        };
        Values::Float((0..256 * 128).map(of).collect())
    };
    let mut channels = || (0..6).map(|i| (format!("c{i}"), noise())).collect::<Vec<_>>();
    let report = report(size, [channels(), channels()]);
    let exec = Exec::sequential();
    let whole = html(&report, &exec).unwrap().len();
    let mut digits = Vec::new();
    for largest in [whole, whole * 3 / 4, whole / 2, whole / 8] {
        let page = html_within(&report, largest, &exec).unwrap();
        assert!(page.len() <= largest, "{} in {largest}", page.len());
        let data = data(&page);
        let exact = bytes(&page, &data["exact"]);
        let channels = data["channels"].as_object().unwrap();
        for (name, channel) in channels {
            digits.push(channel["digits"].as_u64().unwrap());
            if channel["bytes"][0].as_array().unwrap().len() < 4 {
                continue;
            }
            let found = bits(&page, channel);
            for (side, picture) in report.pictures.iter().enumerate() {
                let Some(Values::Float(values)) = picture.channel(name) else { panic!() };
                assert_eq!((exact[3], found[side][3]), (1, values[3].to_bits()));
            }
        }
    }
    for count in [0, 2, 3, 4] {
        assert!(digits.contains(&count), "{digits:?}");
    }
}

#[test]
fn texts_of_files_are_no_markup() {
    let hostile = "</script><b>\"'&";
    let values = || vec![(hostile.to_owned(), Values::Float(vec![1.0; 6]))];
    let mut report = report([3, 2], [values(), values()]);
    report.title = hostile.into();
    report.facts = vec![(hostile.into(), hostile.into())];
    report.cause = Some(hostile.into());
    report.explained = vec![Explained {
        pixel: 3,
        checks: Vec::new(),
        text: hostile.into(),
        replay: hostile.into(),
    }];
    let page = html(&report, &Exec::sequential()).unwrap();
    assert!(!page.contains("<b>"));
    assert_eq!(data(&page)["explained"]["3"]["text"], hostile);
}

#[test]
fn equal_errors_are_listed_all_over_the_picture() {
    let mut errors = vec![0.0; 100];
    for i in (0..100).step_by(2) {
        errors[i] = f32::INFINITY;
    }
    errors[51] = 3.0;
    assert_eq!(worst(&errors, 5), [0, 20, 40, 60, 80]);
    assert_eq!(worst(&[0.0, 1.0, 3.0, 2.0, 2.0], 3), [2, 3, 4]);
    assert_eq!(worst(&[0.0, 1.0, 3.0, 2.0, 2.0], 9), [2, 3, 4, 1]);
    assert_eq!(worst(&[0.0; 4], 9), [0; 0]);
}

#[test]
fn the_kind_of_a_plane_follows_from_its_names() {
    let kind = |names: &[&str], is_index| {
        Kind::from_names(&names.iter().map(ToString::to_string).collect::<Vec<_>>(), is_index)
    };
    assert_eq!(kind(&["R", "G", "B"], false), Kind::Color);
    assert_eq!(kind(&["normal.X", "normal.Y", "normal.Z"], false), Kind::Normal);
    let sums = ["attributes.normal.X", "attributes.normal.Y", "attributes.normal.Z"];
    assert_eq!(kind(&sums, false), Kind::Vector, "a sum of normals has any length");
    assert_eq!(kind(&["visibility.Z"], false), Kind::Depth);
    assert_eq!(kind(&["weight"], false), Kind::Scalar);
    assert_eq!(kind(&["visibility.id"], true), Kind::Index);
    assert_eq!(kind(&["attributes.count"], true), Kind::Count);
}
