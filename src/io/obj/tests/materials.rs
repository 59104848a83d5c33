//! Names of materials and of their files, what is missing, and the options of textures.

use super::{SQUARE, beside};
use crate::io::obj::read;
use crate::scene::{Cloud, Coordinates};
use glam::{Vec2, Vec3};
use std::fs;

const RED_GREEN: [Vec3; 2] = [Vec3::X, Vec3::Y];

/// The colours of two triangles of their own points, and the warnings.
fn colors(before: &str, names: [&str; 2], mtl: &str) -> (Option<[Vec3; 2]>, Vec<String>) {
    let points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".repeat(2);
    let [a, b] = names;
    let obj = format!("{before}\n{points}{a}\nf 1 2 3\n{b}\nf 4 5 6\n");
    let found = beside(&obj, mtl).unwrap();
    (found.color.map(|color| [color[0], color[3]]), found.warnings)
}

#[test]
fn names_keep_their_number_signs() {
    for [a, b] in [["a#1", "a#2"], ["Material #1", "Material #2"], ["m # 1", "m # 2"], ["#1", "#2"]]
    {
        let mtl = format!("newmtl {a}\nKd 1 0 0\nnewmtl {b}\nKd 0 1 0\n");
        let names = [format!("usemtl {a}"), format!("usemtl {b}")];
        let found = colors("mtllib a.mtl", [&names[0], &names[1]], &mtl);
        assert_eq!(found, (Some(RED_GREEN), vec![]), "{a}");
    }
    // Comments on one side or on both.
    for (mtl, names) in [
        ("newmtl r # x\nKd 1 0 0\nnewmtl g\nKd 0 1 0 # y\n", ["usemtl r", "usemtl g # z"]),
        ("newmtl r #x\nKd 1 0 0#x\nnewmtl g # y\nKd 0 1 0\n", ["usemtl r", "usemtl g # z"]),
    ] {
        assert_eq!(colors("mtllib a.mtl # m", names, mtl), (Some(RED_GREEN), vec![]), "{mtl}");
    }
}

#[test]
fn names_that_differ_in_bytes_stay_different() {
    let folder = tempfile::tempdir().unwrap();
    let mtl = b"newmtl M\xE9\nKd 1 0 0\nnewmtl M\xE8\nKd 0 1 0\n";
    let points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".repeat(2);
    let faces = b"usemtl M\xE9\nf 1 2 3\nusemtl M\xE8\nf 4 5 6\n";
    fs::write(folder.path().join("a.mtl"), mtl).unwrap();
    let path = folder.path().join("a.obj");
    fs::write(&path, [b"mtllib a.mtl\n", points.as_bytes(), faces].concat()).unwrap();
    let color = read(&path).unwrap().color.unwrap();
    assert_eq!([color[0], color[3]], RED_GREEN);
}

#[test]
fn an_empty_name_is_the_default_material() {
    let mtl = "\u{feff}newmtl a\r\nKd 1 0 0\r\n";
    for empty in ["usemtl", "usemtl ", "usemtl\t\r"] {
        let found = colors("mtllib a.mtl", ["usemtl a", empty], mtl);
        assert_eq!(found, (Some([Vec3::X, Vec3::ONE]), vec![]));
    }
    assert_eq!(colors("mtllib a.mtl", ["usemtl", ""], mtl), (None, vec![]));
    // The names may come before the file that defines them.
    let late = format!("{SQUARE}usemtl a\nf 1 2 3\nmtllib a.mtl\n");
    assert_eq!(beside(&late, mtl).unwrap().color.unwrap()[0], Vec3::X);
}

#[test]
fn what_is_missing_is_grey_and_said() {
    let names = ["usemtl a", "usemtl b"];
    let (color, warnings) = colors("mtllib no.mtl", names, "");
    assert_eq!((color, warnings.len()), (None, 1));
    assert!(warnings[0].starts_with("no.mtl: ") && warnings[0].ends_with("have the default grey"));
    assert_eq!(colors("mtllib no.mtl", ["", ""], "").1.len(), 1);
    let (color, warnings) = colors("mtllib a.mtl", names, "newmtl a\nKd 1 0 0\n");
    let unknown = "line 10: no material is called `b`; its polygons have the default grey";
    assert_eq!((color, warnings), (Some([Vec3::X, Vec3::splat(0.75)]), vec![unknown.to_owned()]));
    let (color, warnings) = colors("mtllib a.mtl", names, "newmtl c\nKd 1 0 0\n");
    let unknown =
        "line 8: no material is called `a`, nor as 1 others; its polygons have the default grey";
    assert_eq!((color, warnings), (None, vec![unknown.to_owned()]));
    let (color, warnings) = colors("", names, "");
    assert_eq!((color, warnings.len()), (None, 1));
    assert!(warnings[0].starts_with("line 8: usemtl `a`, but no mtllib"), "{warnings:?}");
    // A folder is no file, and a name that no polygon has is not said.
    let found = colors("mtllib .\nmtllib", ["usemtl x", "usemtl a"], "");
    assert!(found.1[0].starts_with(".: this is a directory"), "{found:?}");
    let many: String = (0..100).map(|i| format!("mtllib {i}.mtl\n")).collect();
    assert_eq!(colors(&many, ["", ""], "").1.len(), 13);
}

/// What `read` gives for a triangle of material `m`, in a folder that has these files.
fn with_files(mtllib: &str, files: &[&str]) -> Cloud {
    let folder = tempfile::tempdir().unwrap();
    for (i, name) in files.iter().enumerate() {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, format!("newmtl m{i}\nKd 0.{} 0 0\n", i + 1)).unwrap();
    }
    let last = files.len() - 1;
    let path = folder.path().join("x.obj");
    fs::write(&path, format!("{mtllib}\n{SQUARE}usemtl m{last}\nf 1 2 3\n")).unwrap();
    read(&path).unwrap()
}

#[test]
fn a_line_names_files_in_many_ways() {
    for (mtllib, files) in [
        ("mtllib a.mtl b.mtl", &["a.mtl", "b.mtl"][..]),
        ("mtllib my a.mtl", &["my a.mtl"]),
        ("mtllib my a.mtl my b.mtl c.mtl", &["my a.mtl", "my b.mtl", "c.mtl"]),
        ("mtllib my  a.mtl", &["my  a.mtl"]),
        ("mtllib a #1.mtl", &["a #1.mtl"]),
        ("mtllib a#1.mtl", &["a#1.mtl"]),
        ("mtllib a.mtl # the materials", &["a.mtl"]),
        ("mtllib sub\\a.mtl", &["sub/a.mtl"]),
        ("mtllib ./a.mtl\r", &["a.mtl"]),
        ("mtllib a.mtl\nmtllib b.mtl", &["a.mtl", "b.mtl"]),
        ("mtllib a b", &["a", "b"]),
    ] {
        let found = with_files(mtllib, files);
        assert_eq!((found.color.is_some(), found.warnings), (true, vec![]), "{mtllib}");
    }
    let some = with_files("mtllib my no.mtl a.mtl no b.mtl", &["a.mtl"]);
    assert!(some.color.is_some() && some.warnings.len() == 2, "{:?}", some.warnings);
    assert!(
        some.warnings[0].starts_with("my no.mtl: ") && some.warnings[1].starts_with("no b.mtl: ")
    );
}

#[test]
fn utf16_and_damage_in_materials_are_refused() {
    let obj = format!("{SQUARE}mtllib a.mtl\n");
    assert_eq!(
        beside(&obj, "n\0e\0w\0").unwrap_err(),
        "line 5: a.mtl: the text is UTF-16 or not text at all; save it as UTF-8"
    );
}

/// The texture's name, the coordinates of three corners, and the warnings for a line `map_Kd`.
fn mapped(line: &str) -> (String, [Vec2; 3], Vec<String>) {
    let obj = format!("mtllib a.mtl\n{SQUARE}vt 0 0\nvt 1 0\nvt 1 .5\nusemtl a\nf 1/1 2/2 3/3\n");
    let found = beside(&obj, &format!("newmtl a\nKd 1 1 1\nmap_Kd {line}\n")).unwrap();
    let Some(Coordinates::Corners(at)) = found.coordinates else { panic!() };
    (found.textures[0].clone(), at[0], found.warnings)
}

#[test]
fn options_of_textures_are_read() {
    let at = |s: [f32; 2], o: [f32; 2]| {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5]]
            .map(|[u, v]: [f32; 2]| Vec2::new(u * s[0] + o[0], v * s[1] + o[1]))
    };
    let plain = at([1.0; 2], [0.0; 2]);
    for (line, name, places) in [
        ("a.png", "a.png", plain),
        ("-s 2 4 1 a b.png", "a b.png", at([2.0, 4.0], [0.0; 2])),
        ("-s 2 a.png", "a.png", at([2.0, 1.0], [0.0; 2])),
        ("-o .5 -.25 -s 3 2 1.png", "1.png", at([3.0, 2.0], [0.5, -0.25])),
        ("-s 1 1 1 -o 0 0 0 a.png", "a.png", plain),
        ("-blendu on -blendv on -clamp off -cc off -mm 0 1 -t 0 0 0 a.png", "a.png", plain),
        ("-o\t1 2 3\t4", "4", at([1.0; 2], [1.0, 2.0])),
        ("a #1.png", "a", plain),
        ("a#1.png", "a#1.png", plain),
        ("-.png", "-.png", plain),
    ] {
        let (found, corners, warnings) = mapped(line);
        assert_eq!((found.as_str(), corners), (name, places), "{line}");
        assert_eq!(warnings.len(), usize::from(line == "-.png"), "{line}: {warnings:?}");
    }
    let (name, _, warnings) =
        mapped("-bm 1 -clamp on -imfchan r -mm 0 2 -texres 64 -t 1 -what x -boost 2 wood.png");
    assert_eq!(name, "wood.png");
    assert_eq!(
        warnings,
        [
            "material `a`: -bm 1, -clamp on, -imfchan r, -mm 0 2, -texres 64, -t 1, -what x, -boost 2 is \
          not read"
        ]
    );
}

#[test]
fn lines_that_are_not_read_are_said() {
    let of = |lines: &str| {
        let obj = format!("mtllib a.mtl\n{SQUARE}usemtl a\nf 1 2 3\n");
        beside(&obj, &format!("d 1\nnewmtl a\nKd 1 0 0\n{lines}newmtl b\nd 0.5\n"))
            .unwrap()
            .warnings
    };
    for read in ["d 1\n", "d 0.5\nTr 0\n", "Tr 0.0 # x\n", ""] {
        assert!(of(read).is_empty(), "{read}");
    }
    for (lines, what) in [
        ("d 1.5\nTr 1 1 1\n", "d, Tr"),
        ("d -halo 0.5\n", "d"),
        ("map_d x.png\nd\n", "map_d, d"),
        ("Kd xyz 1 1 1\n", "Kd xyz"),
        ("Kd spectral a.rfl 1\n", "Kd spectral"),
    ] {
        assert_eq!(of(lines), [format!("material `a`: {what} is not read")]);
    }
}

/// The opacity of a material is that of its points, beside colours of any origin.
#[test]
fn opacities_of_materials_reach_the_points() {
    let two = |mtl: &str, color: &str| {
        let points = format!("v 0 0 0{color}\nv 1 0 0{color}\nv 1 1 0{color}\nv 0 1 0{color}\n");
        let obj = format!("mtllib a.mtl\n{points}usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\n");
        beside(&obj, mtl).unwrap()
    };
    let opacities = |cloud: &Cloud| {
        let of = |triangle: &[u32; 3]| cloud.opacity.as_ref().map(|all| all[triangle[1] as usize]);
        cloud.triangles.iter().map(of).collect::<Vec<_>>()
    };
    for (a, b, expected) in [
        ("d 0.5", "", [0.5, 1.0]),
        ("Tr 0.75", "d 1", [0.25, 1.0]),
        ("Tr 0.75\nd 0.5", "d 0\nTr 0", [0.5, 0.0]),
        ("Tr 1", "d 0.125", [1.0, 0.125]),
    ] {
        let mtl = format!("newmtl a\nKd 1 0 0\n{a}\nnewmtl b\nKd 1 0 0\n{b}\n");
        for color in ["", " 1 0 0"] {
            let cloud = two(&mtl, color);
            assert_eq!(opacities(&cloud), expected.map(Some), "{a}");
            assert_eq!(cloud.position.len(), 6, "the corners of both are two points");
            assert_eq!(cloud.color, Some(vec![Vec3::X; 6]));
            assert_eq!(cloud.warnings, [""; 0]);
        }
        let plain = two(&mtl.replace("Kd 1 0 0\n", ""), "");
        assert_eq!((opacities(&plain), plain.color), (expected.map(Some).to_vec(), None));
    }
    let opaque = two("newmtl a\nd 1\nTr 0\nnewmtl b\n", "");
    assert_eq!((opaque.opacity, opaque.position.len()), (None, 4));
    let doubted = two("newmtl a\nd -halo 0.5\nmap_d x.png\nTr 2\nnewmtl b\n", "");
    assert_eq!(doubted.opacity, None);
    assert_eq!(doubted.warnings, ["material `a`: d, map_d, Tr is not read"]);
}
