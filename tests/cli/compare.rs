//! `splatref compare` with planes chosen, tolerances a plane, and files of other kinds.

use super::*;
use splatref::frame::{Frame, Plane, Samples};
use tempfile::TempDir;

/// Exit code and what was printed, without complaint.
fn compared(at: &TempDir, arguments: &[&str]) -> (i32, String) {
    let output = splatref(at.path(), &[&["compare"], arguments].concat());
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
}

/// A picture of 4 x 2 pixels as a client makes it: depths, ids and normals.
fn client(depth: [f32; 8], id: [u32; 8]) -> Frame<f32> {
    Frame::new(4, 2)
        .with("Z", Samples::Scalar(Plane::from_values(4, 2, depth.to_vec())))
        .and_then(|f| f.with("id", Samples::Index(Plane::from_values(4, 2, id.to_vec()))))
        .and_then(|f| f.with("normal", Samples::Vector(Plane::filled(4, 2, [0.0, 0.0, 1.0]))))
        .unwrap()
}

const DEPTH: [f32; 8] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, f32::INFINITY];
const ID: [u32; 8] = [0, 1, 2, 3, 4, 5, 6, u32::MAX];

/// `a.exr`, and `b.exr` with two depths and one id changed.
fn two_pictures() -> TempDir {
    let at = TempDir::new().unwrap();
    exr::write(&at.path().join("a.exr"), &client(DEPTH, ID), "").unwrap();
    let (mut depth, mut id) = (DEPTH, ID);
    (depth[1], depth[6], id[4]) = (2.0_f32.next_up(), 7.5, 9);
    exr::write(&at.path().join("b.exr"), &client(depth, id), "").unwrap();
    at
}

/// A file as numpy.save writes it.
fn npy(at: &TempDir, name: &str, descr: &str, shape: &str, data: &[u8]) {
    let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (text.len() as u16).to_le_bytes();
    let bytes = [b"\x93NUMPY\x01\0", &length[..], text.as_bytes(), data].concat();
    fs::write(at.path().join(name), bytes).unwrap();
}

#[test]
fn a_page_shows_what_was_compared() {
    let at = two_pictures();
    let (code, said) = compared(&at, &["a.exr", "b.exr", "--report", "page.html"]);
    assert_eq!((code, said), compared(&at, &["a.exr", "b.exr"]), "prints the same");
    let page = fs::read_to_string(at.path().join("page.html")).unwrap();
    assert!(page.contains("different: 2 of 5 planes differ") && !page.contains("://"));
    let compare = |rest: &[&str]| fails(at.path(), &[&["compare", "a.exr"], rest].concat(), 2);
    assert!(compare(&["b.exr", "--report", "./b.exr"]).contains("is also an input"));
    // Pictures of two sizes have a page too, which says so.
    let small = Frame::new(2, 2).with("Z", Samples::Scalar(Plane::filled(2, 2, 1.0))).unwrap();
    exr::write(&at.path().join("small.exr"), &small, "").unwrap();
    assert_eq!(compared(&at, &["a.exr", "small.exr", "--report", "page.html"]).0, 1);
    let page = fs::read_to_string(at.path().join("page.html")).unwrap();
    assert!(page.contains("The sizes differ, so no pixel can be compared."));
}

#[test]
fn planes_are_chosen_and_each_has_its_tolerance() {
    let at = two_pictures();
    let (code, said) = compared(&at, &["a.exr", "b.exr"]);
    assert_eq!(code, 1);
    assert!(said.contains("Z: 2 of 8 pixels differ, first (1, 0): 2.0"), "{said}");
    assert!(said.contains("; worst (2, 1): 7.0 (0x40e00000) against 7.5"), "{said}");
    assert!(said.contains("different: 2 of 5 planes differ"), "{said}");

    let (code, said) = compared(&at, &["a.exr", "b.exr", "--planes", "normal"]);
    assert_eq!((code, said.lines().count()), (0, 4), "{said}");
    assert!(said.contains("normal.Y: equal") && said.contains("equal: all 3 planes"), "{said}");
    assert_eq!(compared(&at, &["a.exr", "b.exr", "--planes", "normal,id"]).0, 1);
    assert_eq!(compared(&at, &["a.exr", "b.exr", "--planes", "n*"]).0, 0);

    let both = ["--tolerance", "Z:ulp=1,pixels=1", "--tolerance", "id:pixels=1"];
    let (code, said) = compared(&at, &[&["a.exr", "b.exr"], &both[..]].concat());
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("1 beyond tolerance where 1 may be, first (2, 1)"), "{said}");
    assert!(said.contains("within tolerance: 2 of 5 planes differ"), "{said}");
    for (depth, code) in [("Z:abs=0.5", 0), ("Z:abs=0.25", 1), ("Z:pixels=2", 0), ("Z:ulp=0", 1)] {
        let more = ["--tolerance", depth, "--tolerance", "id:pixels=1", "--max-abs", "9"];
        let found = compared(&at, &[&["a.exr", "b.exr"], &more[..]].concat());
        assert_eq!(found.0, code, "what is said of a plane replaces what is said of all: {depth}");
    }
    for (more, what, code) in [
        (["--planes", "z"], "no plane of the reference is called `z`; there are: Z, id", 1),
        (["--tolerance", "depth:ulp=1"], "called `depth`", 1),
        (["--tolerance", "Z"], "such as Z:ulp=4", 2),
        (["--tolerance", "Z:ulps=4"], "such as Z:ulp=4", 2),
        (["--tolerance", "Z:ulp=-4"], "such as Z:ulp=4", 2),
        (["--tolerance", "Z:abs=-1"], "give a number >= 0", 2),
        (["--max-abs", "nan"], "give a number >= 0", 2),
    ] {
        let line = fails(at.path(), &[&["compare", "a.exr", "b.exr"], &more[..]].concat(), code);
        assert!(line.contains(what), "{line}");
    }
}

#[test]
fn the_margin_of_the_reference_is_not_missed() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &small(&["-o", "a.exr", "--stages"]));
    succeeds(at.path(), &small(&["-o", "b.exr"]));
    let planes = ["--planes", "R,G,B,Z,weight,normal,margin"];
    let (code, said) = compared(&at, &[&["a.exr", "b.exr"], &planes[..]].concat());
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("margin: not compared, an observation of the first file"), "{said}");
    assert!(said.contains("equal: all 8 planes"), "{said}");
    let (code, said) = compared(&at, &["b.exr", "a.exr"]);
    assert!(code == 1 && said.contains("margin: only in the second file"), "{said}");
    let (code, said) = compared(&at, &["a.exr", "b.exr"]);
    assert!(code == 1 && said.contains("visibility.Z: only in the first file"), "{said}");
}

#[test]
fn arrays_of_numpy_are_compared_by_their_name() {
    let at = two_pictures();
    let depth: Vec<u8> = DEPTH.iter().flat_map(|v| v.to_le_bytes()).collect();
    npy(&at, "Z.npy", "<f4", "(2, 4)", &depth);
    let (code, said) = compared(&at, &["a.exr", "Z.npy"]);
    assert_eq!((code, said.as_str()), (0, "Z: equal\nequal: all 1 planes, bit for bit\n"));
    assert_eq!(compared(&at, &["Z.npy", "a.exr"]).0, 0);
    let (code, said) = compared(&at, &["b.exr", "Z.npy"]);
    assert!(code == 1 && said.contains("Z: 2 of 8 pixels differ"), "{said}");
    assert_eq!(compared(&at, &["b.exr", "Z.npy", "--max-abs", "0.5"]).0, 0);

    let doubles: Vec<u8> = DEPTH.iter().flat_map(|v| f64::from(*v).to_le_bytes()).collect();
    npy(&at, "depth.npy", "<f8", "(2, 4, 1)", &doubles);
    let line = fails(at.path(), &["compare", "a.exr", "depth.npy"], 1);
    assert!(
        line.contains("depth.npy: holds depth, which the other picture does not have;"),
        "{line}"
    );
    assert!(line.contains("--as one of: Z, id, normal.X"), "{line}");
    assert_eq!(compared(&at, &["a.exr", "depth.npy", "--as", "Z"]).0, 0);
    assert_eq!(compared(&at, &["Z.npy", "depth.npy", "--as", "Z"]).0, 0);

    let ids: Vec<u8> = ID.iter().flat_map(|v| (*v as i32).to_le_bytes()).collect();
    npy(&at, "id.npy", "<i4", "(2, 4)", &ids);
    assert_eq!(compared(&at, &["a.exr", "id.npy"]).0, 0);
    let (code, said) = compared(&at, &["b.exr", "id.npy", "--tolerance", "id:pixels=1"]);
    assert!(code == 0 && said.contains("first (0, 1): 9 (0x00000009) against 4"), "{said}");
    let normals: Vec<u8> =
        [0.0_f32, 0.0, 1.0].repeat(8).iter().flat_map(|v| v.to_le_bytes()).collect();
    npy(&at, "normal.npy", "<f4", "(2, 4, 3)", &normals);
    let (code, said) = compared(&at, &["a.exr", "normal.npy"]);
    assert!(code == 0 && said.contains("equal: all 3 planes"), "{said}");

    npy(&at, "huge.npy", "<f8", "(4000000000, 4000000000)", b"");
    let line = fails(at.path(), &["compare", "a.exr", "huge.npy"], 1);
    assert!(line.contains("huge.npy: header: declares"), "{line}");
    fs::write(at.path().join("noise.npy"), "no array").unwrap();
    fails(at.path(), &["compare", "a.exr", "noise.npy"], 1);
    fails(at.path(), &["compare", "a.exr", "missing.npy"], 1);
}

/// FLIP is of light: what is stored as sRGB has the same, but for its rounding to codes.
#[test]
fn flip_is_of_light() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &small(&["-o", "a.exr"]));
    succeeds(at.path(), &small(&["-o", "b.exr", "--method", "pyramid"]));
    let flip = |arguments: &[&str]| -> f64 {
        let (_, said) = compared(&at, arguments);
        let (_, rest) = said.split_once(", FLIP ").unwrap();
        rest.lines().next().unwrap().parse().unwrap()
    };
    let (of_numbers, of_codes) = (flip(&["a.exr", "b.exr"]), flip(&["a.png", "b.png"]));
    assert!(of_numbers > 0.01, "{of_numbers}");
    assert!((of_codes / of_numbers - 1.0).abs() < 0.1, "{of_codes} against {of_numbers}");
    assert!(flip(&["a.exr", "a.png"]) < 0.1 * of_numbers);
}

#[test]
fn a_png_is_compared_as_it_is_stored() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &small(&["-o", "a.exr"]));
    let (code, said) = compared(&at, &["a.exr", "a.png"]);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("R, G, B as sRGB: RMSE 0,") && said.contains("all 4 planes"), "{said}");
    assert_eq!(compared(&at, &["a.png", "a.exr"]).0, 0);
    assert_eq!(compared(&at, &["a.png", "a.png"]).0, 0);

    // One code more or less in one channel of the pixel in the middle.
    let path = at.path().join("a.png");
    let mut picture = image::open(&path).unwrap().into_rgba8();
    let red = &mut picture.get_pixel_mut(16, 12).0[0];
    *red = if *red > 0 { *red - 1 } else { 1 };
    picture.save(&path).unwrap();
    let (code, said) = compared(&at, &["a.exr", "a.png"]);
    assert!(code == 1 && said.contains("R: 1 of 768 pixels differ, first (16, 12)"), "{said}");
    assert_eq!(compared(&at, &["a.exr", "a.png", "--max-abs", "0.004"]).0, 0);
    assert_eq!(compared(&at, &["a.exr", "a.png", "--planes", "G,B,A"]).0, 0);

    let bytes = fs::read(&path).unwrap();
    fs::write(at.path().join("cut.png"), &bytes[..bytes.len() / 2]).unwrap();
    fails(at.path(), &["compare", "a.exr", "cut.png"], 1);
    fails(at.path(), &["compare", "a.exr", "missing.png"], 1);
}

/// Blender calls a plane `ViewLayer.Normal`.
#[test]
fn channels_of_other_names_are_compared() {
    let at = two_pictures();
    let blender = Frame::new(4, 2)
        .with("ViewLayer.Depth", Samples::Scalar(Plane::from_values(4, 2, DEPTH.to_vec())))
        .and_then(|f| {
            f.with("ViewLayer.Normal", Samples::Vector(Plane::filled(4, 2, [0.0, 0.0, 1.0])))
        })
        .unwrap();
    exr::write(&at.path().join("c.exr"), &blender, "").unwrap();
    let both = ["--channels", "Z=ViewLayer.Depth", "--channels", "normal=ViewLayer.Normal"];
    let planes = ["a.exr", "c.exr", "--planes", "Z,normal"];
    let (code, said) = compared(&at, &[&planes[..], &both].concat());
    assert!(code == 0 && said.contains("equal: all 4 planes"), "{said}");
    let compare = ["compare", "a.exr", "c.exr", "--channels"];
    let line = fails(at.path(), &[&compare[..], &["Z=depth"]].concat(), 2);
    assert!(line.contains("neither picture has a channel depth"), "{line}");
    let line = fails(at.path(), &[&compare[..], &["Z"]].concat(), 2);
    assert!(line.contains("give a plane and its channel"), "{line}");
}

/// Files that are not what their names say, and pictures of kinds that are not read.
#[test]
fn pointers_and_other_kinds_are_called_by_their_names() {
    let at = two_pictures();
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2146\nsize 12345\n";
    for name in ["p.exr", "p.png", "p.npy", "p.npz", "p.ply", "p.obj", "p.toml"] {
        fs::write(at.path().join(name), pointer).unwrap();
        let is_picture = ["p.exr", "p.png", "p.npy", "p.npz"].contains(&name);
        let command: &[&str] =
            if is_picture { &["compare", "a.exr", name] } else { &["info", name] };
        let line = fails(at.path(), command, 1);
        assert!(line.contains(name) && line.contains("is a Git LFS pointer"), "{line}");
        assert!(line.contains("run `git lfs pull`"), "{line}");
    }
    for name in ["photo.jpg", "a.tif"] {
        fs::write(at.path().join(name), b"\xff\xd8\xff\xe0").unwrap();
        let line = fails(at.path(), &["compare", "a.exr", name], 1);
        let kind = name.rsplit('.').next().unwrap();
        assert!(line.contains(&format!("pictures of the kind .{kind} are not read")), "{line}");
    }
}
