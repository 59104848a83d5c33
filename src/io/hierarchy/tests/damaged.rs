//! Read folders with false contents.

use super::super::bytes::checked;
use super::super::index::Index;
use super::*;
use crate::io::checksum;
use crate::scene::Property;
use proptest::prelude::*;

/// A hierarchy, with opacities and properties or without.
fn whole(numbers: bool) -> TempDir {
    let at = TempDir::new().unwrap();
    let mut mesh = sphere(75, true);
    let mut settings = Settings { most: 50, side: 200, ..Settings::default() };
    if numbers {
        let values: Vec<f32> = mesh.position.iter().map(|p| p.x.abs()).collect();
        mesh.opacity = Some(values.clone());
        mesh.properties = vec![Property { name: "heat".into(), values }];
        settings.properties = vec!["heat".into()];
    }
    ply::write(&at.path().join("mesh.ply"), &mesh).unwrap();
    make(&at, "mesh.ply", "out", &settings).unwrap();
    at
}

#[test]
fn an_index_comes_back_as_it_is_and_no_beginning_of_one_does() {
    let mut bytes = Vec::new();
    for numbers in [true, false] {
        let at = whole(numbers);
        let file = fs::read(at.path().join("out/index")).unwrap();
        bytes = checked(&file).unwrap().to_vec();
        let index = Index::parse(&bytes).unwrap();
        assert_eq!(index.bytes(), bytes);
        for end in 0..bytes.len() {
            Index::parse(&bytes[..end]).unwrap_err();
        }
        Index::parse(&[&bytes[..], &[0]].concat()).unwrap_err();
    }
    // 2^32 - 1 nodes, which would take 378 GB.
    let mut many = bytes;
    many[48..52].copy_from_slice(&[0xff; 4]);
    let line = Index::parse(&many).unwrap_err();
    assert!(
        line.contains("4294967295 nodes") && line.contains("bytes, but the file has"),
        "{line}"
    );
}

proptest! {
    #[test]
    fn no_index_makes_it_panic(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        thread_local! {
            static WHOLE: (TempDir, Vec<u8>) = {
                let at = whole(true);
                let file = fs::read(at.path().join("out/index")).unwrap();
                (at, checked(&file).unwrap().to_vec())
            };
        }
        WHOLE.with(|(at, whole)| {
            let mut bytes = whole.clone();
            for (at, value) in flips {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            if let Ok(index) = Index::parse(&bytes) {
                let hierarchy = Hierarchy { folder: at.path().join("out"), index };
                for node in 0..hierarchy.nodes().len() as u32 {
                    // Either the result is valid, or one line gives the reason.
                    let _ = (hierarchy.surfels(node, u32::MAX), hierarchy.triangles(node));
                }
            }
        });
    }

    #[test]
    fn no_other_file_makes_it_panic(
        name in prop::sample::select(vec!["mesh-0", "surfels-1"]),
        cut in any::<prop::sample::Index>(),
        flips in prop::collection::vec((0_usize..300, any::<u8>()), 0..4),
    ) {
        thread_local! {
            static WHOLE: TempDir = whole(true);
        }
        WHOLE.with(|at| {
            let path = at.path().join("out").join(name);
            let whole = fs::read(&path).unwrap();
            let mut bytes = whole.clone();
            flips.iter().for_each(|(at, value)| bytes[at % whole.len()] = *value);
            bytes.truncate(cut.index(whole.len()) + 1);
            fs::write(&path, &bytes).unwrap();
            let hierarchy = Hierarchy::open(&at.path().join("out")).unwrap();
            let _ = (hierarchy.surfels(1, u32::MAX), hierarchy.triangles(1), hierarchy.triangles(2));
            fs::write(&path, whole).unwrap();
        });
    }
}

#[test]
fn what_is_missing_or_of_another_is_told_in_a_line() {
    let at = whole(false);
    let out = at.path().join("out");
    let hierarchy = Hierarchy::open(&out).unwrap();
    let told = |node: u32| hierarchy.surfels(node, 9).unwrap_err().to_string();
    let one = fs::read(out.join("surfels-1")).unwrap();
    let line = hierarchy.surfels(99, 9).unwrap_err().to_string();
    assert!(line.contains("node 99 does not exist"), "{line}");
    fs::remove_file(out.join("surfels-1")).unwrap();
    assert!(told(1).contains("surfels-1: "), "{}", told(1));
    let other = fs::read(out.join("surfels-2")).unwrap();
    fs::write(out.join("surfels-1"), &other).unwrap();
    assert!(told(1).contains("belong to another index"), "{}", told(1));
    fs::write(out.join("surfels-1"), &one[..one.len() - 1]).unwrap();
    assert!(told(1).contains("50 surfels need 1072 bytes, but the file has 1071"), "{}", told(1));
    let mut foreign = one.clone();
    foreign[20] ^= 1;
    fs::write(out.join("surfels-1"), &foreign).unwrap();
    assert!(told(1).contains("damaged: its checksum is wrong"), "{}", told(1));
    let header = checksum::of(&foreign[..64]);
    foreign[64..68].copy_from_slice(&header);
    fs::write(out.join("surfels-1"), &foreign).unwrap();
    assert!(told(1).contains("belong to another hierarchy"), "{}", told(1));
    fs::write(out.join("surfels-1"), &one).unwrap();
    assert!(hierarchy.surfels(1, 9).is_ok());
    let mesh = fs::read(out.join("mesh-0")).unwrap();
    fs::write(out.join("mesh-0"), &mesh[..200]).unwrap();
    let leaf = hierarchy.nodes().len() as u32 - 1;
    let line = hierarchy.triangles(leaf).unwrap_err().to_string();
    assert!(line.contains("mesh-0: ") && line.contains("beyond the end of the file"), "{line}");
    assert!(Hierarchy::open(at.path()).unwrap_err().to_string().contains("index"));
}

/// All that can be read of a folder, or the first error.
fn everything(folder: &Path) -> Result<(Hierarchy, Vec<(Cloud, crate::scene::Triangles)>)> {
    let hierarchy = Hierarchy::open(folder)?;
    hierarchy.outlined(&Exec::sequential(), &quiet)?;
    let nodes = 0..hierarchy.nodes().len() as u32;
    let each = nodes.map(|node| Ok((hierarchy.surfels(node, 9)?, hierarchy.triangles(node)?)));
    let all = each.collect::<Result<Vec<_>>>()?;
    Ok((hierarchy, all))
}

#[test]
fn a_flipped_bit_is_noticed_in_every_file_and_mended_by_another_run() {
    let at = whole(true);
    let out = at.path().join("out");
    let all = bytes(&out);
    let properties = vec!["heat".into()];
    let settings = Settings { most: 50, side: 200, properties, ..Settings::default() };
    let expected = everything(&out).unwrap();
    for name in ["index", "bounds", "mesh-0", "surfels-1"] {
        let whole = &all[name];
        // Some bits of the beginning, then one here and there; all of them in all bits of a byte.
        let bits = 8 * whole.len();
        let start = (0..640).step_by(13);
        for bit in start.chain((640..bits).step_by(bits / 60 + 1)).filter(|&bit| bit < bits) {
            let mut flipped = whole.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            fs::write(out.join(name), flipped).unwrap();
            match everything(&out).map_err(|error| error.to_string()) {
                // The tree in a geometry's file is for resuming; views use the index.
                Ok(found) => assert!(found == expected, "{name}: bit {bit} is not noticed"),
                Err(line) => assert!(line.contains(&format!("out/{name}: ")), "{line}"),
            }
            if name == "mesh-0" {
                mesh::read(&out, 0).err().unwrap();
            }
        }
        let mut older = whole.clone();
        older[14] = b'1';
        fs::write(out.join(name), older).unwrap();
        let line = everything(&out).unwrap_err().to_string();
        assert!(line.contains("an older version wrote this file"), "{line}");
        // Resuming must not take the file for done.
        let mut flipped = whole.clone();
        flipped[whole.len() / 2] ^= 4;
        fs::write(out.join(name), flipped).unwrap();
        make(&at, "mesh.ply", "out", &settings).unwrap();
        assert!(bytes(&out) == all, "{name}");
    }
}
