//! `splatref project`.

use super::*;
use splatref::frame::Exec;
use splatref::io::scene_file::SceneFile;
use splatref::splat::record::{SplatRecord, project_records};
use tempfile::TempDir;

#[test]
fn records_are_those_of_the_library() {
    let at = TempDir::new().unwrap();
    let scene = "[[model]]\nshape = \"sphere\"\ncount = 300\n[camera]\nsize = [32, 24]\n";
    fs::write(at.path().join("s.toml"), scene).unwrap();
    let said = succeeds(at.path(), &["project", "s.toml", "-o", "a.bin", "--outline", "raycast"]);
    let more = ["--outline", "raycast", "--threads", "1"];
    succeeds(at.path(), &[&["project", "s.toml", "-o", "b.bin"], &more[..]].concat());
    let [a, b] = ["a.bin", "b.bin"].map(|name| fs::read(at.path().join(name)).unwrap());
    assert_eq!(a, b);

    let text = format!("{scene}[method]\noutline = \"raycast\"\n");
    let file = SceneFile::parse(&text, &at.path().join("s.toml")).unwrap();
    let ready = file.ready(&Exec::sequential(), &|_, _, _| ()).unwrap();
    let splats = ready.method.splats().unwrap();
    let surfels = &ready.loaded.scene.surfels;
    let (records, _) = project_records(surfels, &ready.camera, &splats.kernel, splats.cull);
    assert!(records.len() > 50);
    let bytes: Vec<u8> = records.iter().flat_map(SplatRecord::to_bytes).collect();
    assert_eq!(a, bytes);
    let count = format!("records    {} of 96 bytes", records.len());
    for word in
        [&count, "44 surfel       u32", "80 color        f32 x 3", "limit = 4.0, low_pass = 0.25"]
    {
        assert!(said.contains(word), "{word} in {said}");
    }
}

/// Each record is a splat of `explain`, and keys ascend.
#[test]
fn gaussians_have_records_in_the_order_of_blending() {
    let at = TempDir::new().unwrap();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden/splats.glb");
    let view = [scene.to_str().unwrap(), "--method", "gaussians", "--size", "96x72"];
    let said = succeeds(at.path(), &[&["project", "-o", "a.bin"], &view[..]].concat());
    let bytes = fs::read(at.path().join("a.bin")).unwrap();
    assert!(said.contains(&format!("records    {} of 128 bytes", bytes.len() / 128)), "{said}");
    let word =
        |record: &[u8], at: usize| u32::from_le_bytes(record[at..at + 4].try_into().unwrap());
    let number = |record: &[u8], at: usize| f32::from_bits(word(record, at));
    let keys: Vec<f32> = bytes.chunks(128).map(|record| number(record, 12)).collect();
    assert!(keys.len() > 50 && keys.is_sorted());
    let pixel = [view[0], "48", "36", "--method", "gaussians", "--size", "96x72"];
    let explained = succeeds(at.path(), &[&["explain"], &pixel[..]].concat());
    let splats: Vec<_> = explained.split("\nsplat ").skip(1).collect();
    assert!(splats.len() > 2, "{explained}");
    for text in splats {
        let index: u32 = text.lines().next().unwrap().parse().unwrap();
        let record = bytes.chunks(128).find(|record| word(record, 76) == index).unwrap();
        let n = |at| f64::from(number(record, at));
        let [depth, distance, x, y] = [8, 60, 104, 108].map(n);
        let line = format!("depth {depth}, distance {distance}, centre ({x}, {y})");
        assert!(text.contains(&line), "{line} in {text}");
        let conic = [32, 36, 40].map(n);
        let color = [16, 20, 24].map(n);
        for part in [format!("conic {conic:?}"), format!("colour {color:?}")] {
            assert!(text.contains(&part), "{part} in {text}");
        }
    }
}

#[test]
fn what_has_no_records_is_refused() {
    let at = TempDir::new().unwrap();
    for (more, what, code) in [
        (&["-o", "a.bin", "--method", "pyramid"] as &[&str], "draws no splats", 2),
        (&["-o", "a.bin", "--method", "template"], "draws no splats", 2),
        (&["-o", "a.bin", "--number", "f64"], "records are f32", 2),
        (&["-o", "a.ply"], "give a name that ends in .bin", 2),
        (&[], "--output", 2),
        (&["-o", "missing/a.bin"], "missing", 1),
        (&["-o", "a.bin", "--cutoff", "9"], "cut-off of 9", 2),
    ] {
        let arguments = [&["project", "sphere", "--count", "50", "--size", "8x8"], more].concat();
        let line = fails(at.path(), &arguments, code);
        assert!(line.contains(what), "{line}");
    }
    assert!(names(at.path()).is_empty());
}
