//! Tests of the reader: what files of every kind give. `text` tests lines and names, `materials` the
//! materials.

mod materials;
mod text;

use super::*;
use crate::scene::Coordinates;
use glam::{Vec2, Vec3};

fn line(text: &str) -> String {
    let line = parse(text.as_bytes()).unwrap_err();
    assert_eq!(line.lines().count(), 1, "{line}");
    line
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn polygons_become_fans_and_corners_count_from_both_ends() {
    let expected = vec![[0, 1, 2], [0, 2, 3]];
    for face in ["f 1 2 3 4", "f -4 -3 -2 -1", "f 1/1 2/1 3/1 4/1 # comment", "f 1// 2// 3 4\r"] {
        let cloud =
            parse(format!("o a\r\n{SQUARE}vt 0 0\nusemtl b\n{face}\nf 1 2").as_bytes()).unwrap();
        assert_eq!(cloud.triangles, expected, "{face}");
        assert_eq!((cloud.position[2], cloud.normal), (Vec3::new(1.0, 1.0, 0.0), None));
    }
}

#[test]
fn vertices_are_split_where_normals_differ() {
    let text =
        format!("{SQUARE}v 9 9 9\nvn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 3//2 -2//-1 1//2\n");
    // -2 is the vertex before the last.
    let cloud = parse(text.as_bytes()).unwrap();
    let x = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let corner = [x(0.0, 0.0), x(0.0, 0.0), x(1.0, 0.0), x(1.0, 1.0), x(1.0, 1.0), x(0.0, 1.0)];
    assert_eq!(cloud.position[..6], corner);
    let normals = [Vec3::Z, Vec3::Y, Vec3::Z, Vec3::Z, Vec3::Y, Vec3::Y, Vec3::ZERO];
    assert_eq!(cloud.normal.unwrap(), normals, "the last is of no polygon");
    assert_eq!(cloud.triangles, [[0, 2, 3], [4, 5, 1]]);
    let some = format!("{SQUARE}vn 0 0 1\nf 1//1 2//1 3\n");
    assert_eq!(parse(some.as_bytes()).unwrap().normal, None);
}

#[test]
fn colours_are_decoded_and_points_keep_their_normals() {
    let cloud = parse(b"v 1 2 3 0 0.5 1\nvn 0 0 2\n").unwrap();
    let color = cloud.color.as_ref().unwrap()[0];
    // ((0.5 + 0.055)/1.055)^2.4 by an independent calculator.
    assert!((color.y - 0.214_041_14).abs() < 1e-7 && (color.x, color.z) == (0.0, 1.0));
    assert_eq!(cloud.normal.unwrap(), [Vec3::new(0.0, 0.0, 2.0)]);
}

#[test]
fn what_is_wrong_is_one_line() {
    assert!(line("").contains("the file holds no points"));
    assert_eq!(line("v 0 0 x"), "line 1: `x` is not a number");
    assert!(line("v 0 0").contains("a vertex of 2 numbers; give x y z"));
    assert!(line("v 0 0 0 1 256 1").contains("line 1: a colour of 256; give numbers in [0, 1]"));
    assert!(line("v 0 0 0 1 -1 1").contains("line 1: a colour of -1; give numbers in [0, 1]"));
    assert!(line("v 0 0 0 1 1 1\nv 0 0 0 .5 2 1").starts_with("vertex 2 has a colour of 0.5, and"));
    assert!(line("v 0 0 0 1 1").contains("a vertex of 5 numbers"));
    assert!(line("vn 0 0\nv 0 0 0").contains("a normal of 2 numbers"));
    for (face, why) in [
        ("5 1 1", "there is no vertex 5, as the file has 4"),
        ("0 1 1", "there is no vertex 0"),
        ("-5 1 1", "there is no vertex -5"),
        ("-9223372036854775808 1 1", "there is no vertex -9"),
        ("99999999999999999999 1 1", "not the number of a vertex"),
        ("1//1 2 3", "there is no normal 1, as the file has 0"),
        ("1/1/1/1 2 3", "is not a corner"),
        ("\u{1} 2 3", "`\\u{1}`: not the number of a vertex"),
    ] {
        let found = line(&format!("{SQUARE}f {face}\n"));
        assert!(found.starts_with("line 5: ") && found.contains(why), "{found}");
    }
}

/// No bytes make it panic, and the parts of its result fit together.
#[test]
fn bytes_turned_at_random_are_read_or_refused() {
    let seed = format!("{SQUARE}vn 0 0 1\nvn 1 0 0\nf 1//1 2//2 3//1 4//2\nf -1 -2 -3\n");
    for round in 0..4000_u64 {
        let mut bytes = seed.clone().into_bytes();
        for k in 0..3 {
            let unit = |c: u64| crate::number::random::unit(round, 4 * k + c);
            let at = (unit(0) * bytes.len() as f32) as usize % bytes.len();
            bytes[at] = b"v fn/-0129.e#\n\xFF"[(unit(1) * 15.0) as usize % 15];
        }
        if let Ok(cloud) = parse(&bytes) {
            cloud.check().unwrap();
        }
    }
}

/// The result for a file `a.obj` with this text, or the line of its refusal, beside a file `a.mtl`.
fn beside(obj: &str, mtl: &str) -> std::result::Result<Cloud, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.mtl"), mtl).unwrap();
    std::fs::write(folder.path().join("a.obj"), obj).unwrap();
    read(&folder.path().join("a.obj")).map_err(|error| {
        let line = error.to_string();
        assert_eq!(line.lines().count(), 1, "{line}");
        line.split_once("a.obj: ").unwrap().1.to_owned()
    })
}

const QUAD: &str =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nvt 0 0\nvt 1 0 7\nvt .5\n";

#[test]
fn coordinates_stay_with_their_corners() {
    let text =
        format!("{SQUARE}vt 0 0\nvt 1 0\nvt 1 1 0\nvt 0.5\nf 1/1 2/2 3/3 4/-1\nf 3/1 2 1/2\n");
    let cloud = parse(text.as_bytes()).unwrap();
    assert_eq!(cloud.position.len(), 4, "no vertex is divided");
    let Some(Coordinates::Corners(found)) = cloud.coordinates else { panic!() };
    let at = Vec2::new;
    assert_eq!(
        found[..2],
        [[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0)], [at(0.0, 0.0), at(1.0, 1.0), at(0.5, 0.0)]]
    );
    assert!(found[2][0] == at(0.0, 0.0) && found[2][1].is_nan() && found[2][2] == at(1.0, 0.0));
    assert_eq!(parse(format!("{SQUARE}f 1 2 3").as_bytes()).unwrap().coordinates, None);
    for (lines, why) in [
        ("vt 0 0\nf 1/1 2/2 3/1", "line 6: there is no texture coordinate 2, as the file has 1"),
        ("f 1/1 2/1 3/1", "line 5: there is no texture coordinate 1, as the file has 0"),
        ("f 1/a 2 3", "not the number of a texture coordinate"),
        ("vt", "line 5: texture coordinates of 0 numbers; give u v"),
        ("vt 1 2 3 4", "texture coordinates of 4 numbers"),
        ("vt 1 x", "`x` is not a number"),
    ] {
        let found = line(&format!("{SQUARE}{lines}\n"));
        assert!(found.contains(why), "{found}");
    }
}

#[test]
fn materials_colour_points_and_name_textures() {
    let faces = "usemtl red\nf 1 2 3\nusemtl as red\nf 1 3 4\nusemtl blue\nf 2 5 3\n";
    let mtl =
        "newmtl red\nKd 1 0 0\nKs 1 1 1\nnewmtl blue # light\n\tKd .25\nnewmtl as red\nKd 1 0 0\n";
    let cloud = beside(&format!("{QUAD}{faces}"), mtl).unwrap();
    let (red, blue) = (Vec3::X, Vec3::splat(0.25));
    // Vertices 2 and 3 have both colours.
    assert_eq!(cloud.color.as_deref(), Some([red, red, blue, red, blue, red, blue].as_slice()));
    assert_eq!(cloud.triangles, [[0, 1, 3], [0, 3, 5], [2, 6, 4]]);
    assert_eq!((cloud.textures.len(), cloud.coordinates), (0, None));

    // Vertices with colours keep them. Without any Kd there are no colours; a material without Kd
    // is white.
    let lines = QUAD.lines();
    let white = |line: &str| {
        if line.starts_with("v ") { format!("{line} 1 1 1\n") } else { format!("{line}\n") }
    };
    let colored: String = lines.map(white).collect();
    let cloud = beside(&format!("{colored}{faces}"), mtl).unwrap();
    assert_eq!(cloud.color, Some(vec![Vec3::ONE; 5]));
    let cloud = beside(&format!("{QUAD}{faces}"), &mtl.replace("Kd", "Ka")).unwrap();
    assert_eq!((cloud.color, cloud.position.len()), (None, 5));
    let cloud = beside(&format!("{QUAD}f 1 2 3\nusemtl red\nf 1 3 4\n"), mtl).unwrap();
    assert_eq!(cloud.color.unwrap(), [red, Vec3::ONE, Vec3::ONE, red, Vec3::ONE, red, Vec3::ONE]);

    let textured = format!("{QUAD}usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 3/3 4/2\n");
    let of = |mtl: &str| beside(&textured, mtl).unwrap();
    let one =
        of("newmtl a\nKd 0.5 0 0\nmap_Kd my wood.png\r\nnewmtl b\nKd 0 1 0\nmap_Kd my wood.png\n");
    assert_eq!(
        (one.textures, one.color, one.position.len()),
        (vec!["my wood.png".to_owned()], None, 5)
    );
    let some = of("newmtl b\nmap_Kd b.png\nnewmtl a\nKd 0.5 0 0\n");
    assert_eq!((some.textures, some.color), (vec![String::new(), "b.png".to_owned()], None));
    let bare = beside(
        &textured.replace("/1", "").replace("/2", "").replace("/3", ""),
        "newmtl a\nKd 1 0 0\nnewmtl b\nmap_Kd c.png\n",
    )
    .unwrap();
    assert!(bare.color.is_some(), "a texture without coordinates is not seen");
}

#[test]
fn materials_that_are_none_are_refused() {
    let face = "usemtl a\nf 1 2 3\n";
    let refused = |mtl: &str| beside(&format!("{QUAD}{face}"), mtl).unwrap_err();
    for (mtl, why) in [
        ("Kd 1 1 1\n", "line 1: a.mtl: line 1: Kd before the first newmtl"),
        ("newmtl a\nKd 1 1\n", "line 1: a.mtl: line 2: a Kd of 2 numbers; give r g b"),
        ("newmtl a\nKd 1 -1 0\n", "a.mtl: line 2: a Kd of [1, -1, 0]; give numbers in [0, 65536]"),
        ("newmtl a\nKd light x\n", "`light` is not a number"),
        ("newmtl a\nmap_Kd\n", "map_Kd without a file"),
    ] {
        let found = refused(mtl);
        assert!(found.contains(why), "{found}");
    }
    assert_eq!(beside(&format!("{SQUARE}{face}"), "").unwrap().color, None, "no mtllib");
}

#[test]
fn lines_are_edges_and_points_are_nothing_more() {
    let cloud = parse(format!("{SQUARE}vt 0 0\nl 1 2/1 -2\np 4\nl 4\n").as_bytes()).unwrap();
    assert_eq!((cloud.edges, cloud.position.len()), (vec![[0, 1], [1, 2]], 4));
    assert_eq!(cloud.warnings, [""; 0]);
    // Beside polygons, a vertex may be several points: the line goes to the first.
    let faces = "vn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 3//2 4//2 1//2\nl 3 1\n";
    let cloud = parse(format!("{SQUARE}{faces}").as_bytes()).unwrap();
    let ends = cloud.edges[0].map(|end| cloud.position[end as usize]);
    assert_eq!(ends, [Vec3::new(1.0, 1.0, 0.0), Vec3::ZERO]);
    assert_eq!(cloud.position.len(), 6);
    assert!(line(&format!("{SQUARE}l 1 9\n")).contains("there is no vertex 9"));
}
