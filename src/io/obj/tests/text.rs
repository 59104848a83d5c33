//! Encodings, ends of lines, comments, and statements that are not read.

use super::{SQUARE, line};
use crate::io::obj::parse;
use crate::scene::Cloud;
use glam::Vec3;

fn read(text: &str) -> Cloud {
    parse(text.as_bytes()).unwrap()
}

#[test]
fn a_byte_order_mark_is_skipped_and_utf16_is_refused() {
    let text = format!("{SQUARE}f 1 2 3 4\n");
    let plain = read(&text);
    assert_eq!(read(&format!("\u{feff}{text}")), plain);
    assert_eq!(plain.position.len(), 4);
    for (mark, bytes) in [
        (Some(0xFEFF), u16::to_le_bytes as fn(u16) -> [u8; 2]),
        (Some(0xFEFF), u16::to_be_bytes),
        (None, u16::to_le_bytes),
        (None, u16::to_be_bytes),
    ] {
        let units = mark.into_iter().chain(text.encode_utf16());
        let found = parse(&units.flat_map(bytes).collect::<Vec<u8>>()).unwrap_err();
        assert_eq!(found, "the text is UTF-16 or not text at all; save it as UTF-8");
    }
}

#[test]
fn lines_end_in_every_way_and_are_joined() {
    let text = format!("# a\n{SQUARE}f 1 2 3 4\nf 1 2 3\n");
    let plain = read(&text);
    for other in [
        text.replace('\n', "\r\n"),
        text.replace('\n', "\r"),
        text.trim_end().to_owned(),
        text.replace("f 1 2", "f 1\\\n2"),
        text.replace("f 1 2", "f \\\r\n  1\\\r2  \\ \n"),
        text.replace("v 1 0 0\n", "v 1\\\n0\\\n0\n"),
        text.replace("# a\n", "# a \\\n"),
        text.replace("v 0 0 0\n", "v 0 0 0 # C:\\models\\\n"),
        format!("{text}\\"),
        format!("{text}# \\"),
    ] {
        assert_eq!(read(&other), plain, "{other:?}");
    }
    // A joined line has the number of its first part, and later lines keep theirs.
    assert!(line("v 0 0 \\\n x").starts_with("line 1: `x`"));
    assert!(line("v 0 0 \\\n0\nv x 0 0").starts_with("line 3: `x`"));
    assert!(line("v 0 0 0\r\r\nv x 0 0").starts_with("line 3: `x`"));
}

#[test]
fn comments_end_numbers() {
    let plain = read(&format!("{SQUARE}f 1 2 3\n"));
    let text =
        format!("#v 9 9 9\n  # v 9 9 9\n{SQUARE}f 1 2 3").replace("v 1 0 0\n", "v 1 0 0#x 4\n");
    assert_eq!(read(&format!("{text}# 4")), plain);
    assert_eq!(read(&format!("{text} #4")), plain);
    assert_eq!(read(&format!("{text}\t# 4 5 6")), plain);
}

/// The run-time library of Microsoft prints NaN and infinity with a `#`.
#[test]
fn numbers_that_are_none_are_read() {
    let found = read("v 1.#QNAN -1.#IND 1.#SNAN\nv 1.#INF00 -1.#INF 0\nv nan inf -inf\nv 1. 2. 3.");
    assert!(found.position[0].is_nan() && found.position[2].x.is_nan());
    assert_eq!(found.position[1], Vec3::new(f32::INFINITY, f32::NEG_INFINITY, 0.0));
}

#[test]
fn references_may_run_ahead() {
    let ahead = read(&format!("f 1/1/1 2/1/1 3/1/1\nvt 0 0\nvn 0 0 1\n{SQUARE}"));
    let usual = read(&format!("vt 0 0\nvn 0 0 1\n{SQUARE}f 1/1/1 2/1/1 3/1/1\n"));
    assert_eq!(ahead, usual);
    let cut = "f 1 2 9\nf 1 2 8\nf 1 2 10\n";
    assert_eq!(
        line(&format!("{cut}{SQUARE}")),
        "line 1: there is no vertex 9, as the file has 4; the file may be cut off"
    );
    assert!(
        line(&format!("{SQUARE}f 1 2 3/9\nf 1 2 3//7\n"))
            .starts_with("line 5: there is no texture")
    );
    assert!(
        line(&format!("f -1 -2 -3\n{SQUARE}")).contains("there is no vertex -1, as 0 came before")
    );
}

#[test]
fn what_is_not_read_is_said_once() {
    let extra = "o a\ng b c\ng\ns off\ns 1\nl 1 2 3\np 1\nl 1 2\nvp 0 1\n\u{1}x\n";
    let found = read(&format!("{extra}{SQUARE}f 1 2 3\n"));
    assert_eq!(
        found.warnings,
        [
            "these statements are not read: s (2 lines, first line 4), vp (line 9), \\u{1}x (line 10)"
        ]
    );
    let found = read(&format!("s 1\nvn 0 0 1\n{SQUARE}f 1//1 2//1 3//1\nfo 1//1 2//1 4//1\n"));
    assert_eq!((found.warnings, found.triangles.len()), (vec![], 2));
    let many: String = (0..100).map(|i| format!("x{i}\n")).collect();
    assert_eq!(read(&format!("{SQUARE}{many}")).warnings[0].matches("line").count(), 8);
}

#[test]
fn colours_have_many_forms() {
    let (red, half) = (Vec3::X, crate::number::srgb::to_linear(51.0 / 255.0) as f32);
    let is = |text: &str, color: &[Vec3], opacity: Option<&[f32]>, warnings: &[&str]| {
        let found = read(text);
        assert_eq!(found.color.as_deref(), Some(color), "{text}");
        assert_eq!(found.opacity.as_deref(), opacity, "{text}");
        assert_eq!(found.warnings, warnings, "{text}");
    };
    let codes = "colours are read as codes from 0 to 255";
    is("v 0 0 0 255 0 0\nv 0 0 0 51 51 51", &[red, Vec3::splat(half)], None, &[codes]);
    let weight = "2 vertices of 7 numbers are read as x y z weight r g b";
    is("v 0 0 0 1 1 0 0\nv 0 0 0 1.0 0.2 0.2 0.2", &[red, Vec3::splat(half)], None, &[weight]);
    let opaque = "2 vertices of 7 numbers are read as x y z r g b opacity";
    is("v 0 0 0 1 0 0 1\nv 0 0 0 0 0 0 1", &[red, Vec3::ZERO], None, &[opaque]);
    is("v 0 0 0 1 0 0 1\nv 0 0 0 0 0 0 .5", &[red, Vec3::ZERO], Some(&[1.0, 0.5]), &[opaque]);
    let white = "2 of 3 vertices have no colour; they are white";
    is("v 0 0 0\nv 0 0 0 1 0 0\nv 0 0 0 7", &[Vec3::ONE, red, Vec3::ONE], None, &[white]);
    // Opacities follow their vertices.
    let mesh = read("v 0 0 0 0 0 0 .5\nv 1 0 0 0 0 0 1\nv 0 1 0 0 0 0 .25\nf 3 2 1\n");
    assert_eq!(mesh.opacity, Some(vec![0.5, 1.0, 0.25]));
}

/// Ears where the fan leaves the polygon, with the corners' own normals and coordinates.
#[test]
fn concave_polygons_are_cut_into_ears() {
    let l = "v 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\n";
    let ears = [[5, 0, 1], [2, 3, 4], [5, 1, 2], [2, 4, 5]];
    let found = read(&format!("{l}f 1 2 3\nf 1 2 3 4 5 6\nf 4 5 6\n"));
    assert_eq!(found.triangles[1..5], ears);
    assert_eq!((found.triangles[0], found.triangles[5]), ([0, 1, 2], [3, 4, 5]));
    let places: String = (0..6).map(|i| format!("vt {i} 0\n")).collect();
    let found = read(&format!("{l}{places}f 1/1 2/2 3/3 4/4 5/5 6/6\n"));
    let Some(crate::scene::Coordinates::Corners(at)) = found.coordinates else { panic!() };
    let at: Vec<[u32; 3]> = at.iter().map(|one| one.map(|at| at.x as u32)).collect();
    assert_eq!((at.as_slice(), found.triangles.as_slice()), (&ears[..], &ears[..]));
}
