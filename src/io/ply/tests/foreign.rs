//! Check files as other programs write them: Gaussians, strips, colours under other names.

use super::*;

const POINT: &str = "0 0 0";

fn floats(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| format!("property float {name}")).collect()
}

fn with(names: &[&str], body: &str) -> Reason<Cloud> {
    let properties = floats(names);
    let properties: Vec<&str> = properties.iter().map(String::as_str).collect();
    parse(&vertices("1", &properties, body))
}

#[test]
fn gaussians_are_refused_by_name() {
    let rest = ["opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"];
    let harmonics = ["f_dc_0", "f_dc_1", "f_dc_2"];
    let bare = [&harmonics[..], &rest].concat();
    let with_normals = [&["nx", "ny", "nz"][..], &bare].concat();
    let rgb = [&["red", "green", "blue"][..], &rest].concat();
    let flat = ["opacity", "scale_0", "scale_1", "rot_0", "rot_1", "rot_2", "rot_3"];
    for names in [&harmonics[..], &bare, &with_normals, &rgb, &flat] {
        let error = with(names, &[POINT; 9].join(" ")).unwrap_err();
        assert!(error.contains("this PLY holds 3D Gaussians: opacities are logits"), "{error}");
        assert!(error.contains("only `--method gaussians` draws them"), "{error}");
    }
    let packed = "ply\nformat binary_little_endian 1.0\nelement chunk 1\nproperty float min_x\n\
                  element vertex 1\nproperty uint packed_position\nproperty uint packed_rotation\n\
                  property uint packed_scale\nproperty uint packed_color\nend_header\n";
    let error = parse(&[packed.as_bytes(), &[0; 20]].concat()).unwrap_err();
    assert!(error.contains("compressed 3D Gaussians, as SuperSplat"), "{error}");
    // A scale or an opacity alone is an ordinary number of a point.
    assert!(with(&["scale_0", "opacity"], "0 0 0 1 1").is_ok());
}

/// A large file is refused without being read.
#[test]
fn gaussians_are_refused_before_the_vertices_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("g.ply");
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\n\
                  property float y\nproperty float z\nproperty float f_dc_0\nend_header\n";
    std::fs::write(&path, [header.as_bytes(), &[0; 16]].concat()).unwrap();
    let error = read(&path).unwrap_err().to_string();
    assert!(error.starts_with(&path.display().to_string()), "{error}");
    assert!(error.contains("3D Gaussians"), "{error}");
}

/// Five points and strips of them.
fn strips(element: &str, list: &str, body: &str) -> Reason<Cloud> {
    let header = ["element vertex 5", XYZ[0], XYZ[1], XYZ[2], element, list];
    parse(&ascii(&header, &format!("{}\n{body}", [POINT; 5].join("\n"))))
}

#[test]
fn strips_become_triangles_of_one_orientation() {
    let one = "element tristrips 1";
    for (kind, end) in [
        ("char", "-1"),
        ("short", "-1"),
        ("int", "-1"),
        ("uchar", "255"),
        ("ushort", "65535"),
        ("uint", "4294967295"),
    ] {
        for name in ["vertex_indices", "vertex_index"] {
            let list = format!("property list int {kind} {name}");
            // The second strip is joined to a third one by corners that coincide.
            let body = format!("13 0 1 2 3 {end} 0 2 4 4 3 3 1 {end}");
            let found = strips(one, &list, &body).unwrap().triangles;
            assert_eq!(found, [[0, 1, 2], [2, 1, 3], [0, 2, 4]], "{kind}");
        }
    }
    let list = "property list int int vertex_indices";
    let two = strips("element tristrips 2", list, "3 0 1 2\n5 4 3 2 -1 1\n").unwrap();
    assert_eq!(two.triangles, [[0, 1, 2], [4, 3, 2]], "the end of a list ends its strip");
    // Corners that coincide still turn the strip.
    let joined = strips("element tristrip 1", list, "6 0 1 2 2 3 4\n").unwrap();
    assert_eq!(joined.triangles, [[0, 1, 2], [3, 2, 4]]);
    for (body, what) in [
        ("3 0 1 5", "vertex 5 does not exist"),
        ("3 0 1 -2", "vertex -2 does not exist"),
        ("4 0 1", "the file is truncated"),
    ] {
        let error = strips(one, list, &format!("{body}\n")).unwrap_err();
        assert!(error.starts_with("tristrips 0 (line ") && error.contains(what), "{error}");
    }
    let error = strips(one, "property list int float vertex_indices", "0\n").unwrap_err();
    assert_eq!(error, "element tristrips: property `vertex_indices` must be a list of integers");
    let error = strips(one, "property int a", "0\n").unwrap_err();
    assert!(error.contains("element tristrips has no property list vertex_indices"), "{error}");
}

/// One point with a colour.
fn colored(kind: &str, names: [&str; 3], values: &str, range: Option<f64>) -> Cloud {
    let properties = names.map(|name| format!("property {kind} {name}"));
    let bytes =
        vertices("1", &properties.each_ref().map(String::as_str), &format!("0 0 0 {values}"));
    parse_with(
        &bytes,
        &ReadOptions { color_range: range, ..ReadOptions::default() },
        &Exec::sequential(),
    )
    .unwrap()
}

const RGB: [&str; 3] = ["red", "green", "blue"];

#[test]
fn colours_have_other_names_and_types() {
    let expected = colored("uchar", RGB, "255 188 0", None);
    assert!(expected.warnings.is_empty());
    for names in [
        ["diffuse_red", "diffuse_green", "diffuse_blue"],
        ["r", "g", "b"],
        ["R", "G", "B"],
        ["Red", "Green", "Blue"],
    ] {
        assert_eq!(colored("uchar", names, "255 188 0", None), expected, "{names:?}");
    }
    for kind in ["short", "int", "uint"] {
        assert_eq!(colored(kind, RGB, "255 188 0", None), expected, "{kind}");
    }
    // A number called r that is no colour, and names of both kinds.
    assert_eq!(with(&["r"], "0 0 0 1").unwrap().color, None);
    let both = with(&["r", "g", "b", "red", "green", "blue"], "0 0 0 9 9 9 1 0.5 0").unwrap();
    assert_eq!(both.color, Some(vec![Vec3::new(1.0, 0.5, 0.0)]));
}

#[test]
fn colours_out_of_the_range_of_their_type_are_doubted() {
    let warned = |kind, values, range| colored(kind, RGB, values, range).warnings.join("\n");
    let floats = warned("float", "200 20 20", None);
    assert!(
        floats.contains("colours reach 200") && floats.contains("color_range = 255"),
        "{floats}"
    );
    assert!(warned("double", "0 40000.5 0", None).contains("color_range = 65535"));
    assert!(warned("ushort", "255 7 0", None).contains("color_range = 255"));
    assert!(warned("int", "0 256 0", None).contains("color_range = 65535"));
    assert!(warned("float", "2 0 0", Some(1.0)).contains("greater than their color_range of 1"));
    for (kind, values) in [
        ("float", "8 0.5 0"),
        ("float", "nan -inf 1"),
        ("uchar", "255 1 0"),
        ("ushort", "256 0 0"),
        ("ushort", "0 0 0"),
        ("int", "255 0 0"),
    ] {
        assert_eq!(warned(kind, values, None), "", "{kind} {values}");
    }
    // What the warning advises gives the colours that bytes would have.
    let expected = colored("uchar", RGB, "200 188 0", None);
    for kind in ["float", "double", "ushort", "int", "uchar"] {
        assert_eq!(colored(kind, RGB, "200 188 0", Some(255.0)), expected, "{kind}");
    }
}

#[test]
fn faces_have_colours() {
    let color = [
        "property uchar diffuse_red",
        "property uchar Diffuse_Green",
        "property uchar diffuse_blue",
    ];
    let more: Vec<&str> = [INDICES].into_iter().chain(color).collect();
    let found = parse(&faces(&more, "4 0 1 2 0 255 0 255")).unwrap();
    assert_eq!(found.triangle_color, Some(vec![Vec3::new(1.0, 0.0, 1.0); 2]), "of both triangles");
    assert_eq!((found.triangles.len(), &found.color), (2, &None));
    let more: Vec<&str> =
        [INDICES, "property float red", "property float green", "property float blue"].to_vec();
    let found = parse(&faces(&more, "3 0 1 2 255 3 0")).unwrap();
    assert!(found.warnings[0].contains("color_range = 255"), "{:?}", found.warnings);
    // They come back, and are lost with their triangles.
    let mut bytes = Vec::new();
    write::encode(&found, &mut bytes).unwrap();
    assert_eq!(parse(&bytes).unwrap(), found);
    let mut none = found;
    none.retain(&[true, false, true]);
    assert_eq!(none.triangle_color, Some(vec![]));
}
