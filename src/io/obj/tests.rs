use super::*;

fn line(text: &str) -> String {
    let line = parse(text.as_bytes()).unwrap_err();
    assert_eq!(line.lines().count(), 1, "{line}");
    line
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn polygons_become_fans_and_corners_count_from_both_ends() {
    let expected = vec![[0, 1, 2], [0, 2, 3]];
    for face in ["f 1 2 3 4", "f -4 -3 -2 -1", "f 1/7 2/7 3/7 4/7 # comment", "f 1// 2// 3 4\r"] {
        let cloud = parse(format!("o a\r\n{SQUARE}usemtl b\n{face}\nf 1 2").as_bytes()).unwrap();
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
    assert_eq!(line("v 0 0 x"), "line 1: `x` is no number");
    assert!(line("v 0 0").contains("a vertex of 2 numbers; give x y z"));
    assert!(line("v 0 0 0\nv 0 0 0 1 1 1").starts_with("line 2: only some vertices have colours"));
    assert!(line("v 0 0 0 1 1 1\nv 0 0 0").starts_with("line 2: only some vertices have colours"));
    assert!(line("v 0 0 0 1 255 1").contains("a colour of 255; give numbers in [0, 1]"));
    assert!(line("vn 0 0\nv 0 0 0").contains("a normal of 2 numbers"));
    for (face, why) in [
        ("5 1 1", "there is no vertex 5, as 4 came before"),
        ("0 1 1", "there is no vertex 0"),
        ("-5 1 1", "there is no vertex -5"),
        ("-9223372036854775808 1 1", "there is no vertex -9"),
        ("99999999999999999999 1 1", "no number of a vertex"),
        ("1//1 2 3", "there is no normal 1, as 0 came before"),
        ("1/1/1/1 2 3", "is no corner"),
        ("\u{1} 2 3", "`\\u{1}`: no number of a vertex"),
    ] {
        let found = line(&format!("{SQUARE}f {face}\n"));
        assert!(found.starts_with("line 5: ") && found.contains(why), "{found}");
    }
}

/// No bytes make it panic, and what it gives fits together.
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
