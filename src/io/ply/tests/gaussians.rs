//! Check the reader of 3D Gaussians.

use super::*;
use crate::io::gaussians::GaussianFile;
use crate::io::ply::gaussians::parse_gaussians;
use crate::number::elementary;
use crate::scene::Gaussians;
use crate::scene::gaussians::Encoding;

/// The properties of a degree, in the order of the original program.
fn names(degree: u32) -> Vec<String> {
    let rest = 3 * ((degree + 1) * (degree + 1) - 1);
    let own = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2"].map(String::from);
    let more = (0..rest).map(|i| format!("f_rest_{i}"));
    let end = ["opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"];
    own.into_iter().chain(more).chain(end.map(String::from)).collect()
}

/// The number of a property of a vertex; normals are not finite, because nobody reads them.
fn number(name: &str, vertex: u32) -> f64 {
    let far = f64::from(vertex);
    match name {
        "x" => 1.5 + far,
        "y" => -2.25,
        "z" => 0.375,
        "opacity" => -1.5 + far / 4.0,
        "scale_0" => -4.0,
        "scale_1" => -3.5 + far / 8.0,
        "scale_2" => -0.25,
        "rot_0" => 2.0,
        "rot_1" => 0.5,
        "rot_2" => -0.25,
        "rot_3" => 0.125,
        "f_dc_0" => 0.5,
        "f_dc_1" => -0.5,
        "f_dc_2" => 0.75,
        other => match other.strip_prefix("f_rest_") {
            Some(rest) => rest.parse::<f64>().unwrap() / 64.0 + far,
            None => f64::NAN,
        },
    }
}

/// A file of two vertices with these properties.
fn file(format: &str, kind: &str, names: &[String]) -> Vec<u8> {
    let properties: String = names.iter().map(|name| format!("property {kind} {name}\n")).collect();
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement other 1\nproperty uchar what\nelement vertex 2\n\
         {properties}end_header\n"
    )
    .into_bytes();
    let numbers = |vertex| names.iter().map(move |name| number(name, vertex));
    if format == "ascii" {
        bytes.extend(b"7\n");
        for vertex in 0..2 {
            let row: Vec<String> = numbers(vertex).map(|value| value.to_string()).collect();
            bytes.extend(format!("{}\n", row.join(" ")).bytes());
        }
        return bytes;
    }
    bytes.push(7);
    for value in numbers(0).chain(numbers(1)) {
        let (narrow, wide) = ((value as f32).to_le_bytes(), value.to_le_bytes());
        let mut number = if kind == "float" { narrow.to_vec() } else { wide.to_vec() };
        if format == "binary_big_endian" {
            number.reverse();
        }
        bytes.extend(number);
    }
    bytes
}

fn read(bytes: &[u8]) -> GaussianFile {
    parse_gaussians(bytes).unwrap()
}

#[test]
fn numbers_are_activated_and_coefficients_put_in_order() {
    let found = read(&file("binary_little_endian", "float", &names(2)));
    let arrays = &found.arrays;
    assert_eq!(arrays.position, [Vec3::new(1.5, -2.25, 0.375), Vec3::new(2.5, -2.25, 0.375)]);
    // Correctly rounded, by another program.
    let scale = [-4.0, -3.5, -0.25].map(elementary::exp_f32);
    assert_eq!(scale, [0.018_315_64, 0.030_197_384, 0.778_800_8]);
    assert_eq!(arrays.scale[0].to_array(), scale);
    assert_eq!(arrays.rotation[1], [0.5, -0.25, 0.125, 2.0], "w first in the file, last here");
    assert_eq!(arrays.opacity, [0.182_425_53, 0.222_700_13], "1 / (1 + e^1.5) and of 1.25");
    assert_eq!((arrays.degree, arrays.encoding), (2, Encoding::Srgb));
    assert_eq!(arrays.harmonics[0], Vec3::new(0.5, -0.5, 0.75));
    // Eight coefficients of red, then of green, then of blue.
    for k in 0..8 {
        let of = |channel: usize| (8 * channel + k) as f32 / 64.0;
        assert_eq!(arrays.harmonics[1 + k], Vec3::new(of(0), of(1), of(2)));
        assert_eq!(arrays.harmonics[10 + k], Vec3::new(of(0), of(1), of(2)) + 1.0);
    }
    assert_eq!(
        found.convention,
        "PLY of 3D Gaussians: log scales, logit opacities, quaternion w first"
    );
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    let (gaussians, dropped) = Gaussians::new(found.arrays).unwrap();
    assert_eq!((gaussians.len(), dropped), (2, 0));
}

#[test]
fn order_type_and_format_change_nothing() {
    for degree in 0..=3 {
        let mut names = names(degree);
        let first = read(&file("binary_little_endian", "float", &names));
        assert_eq!(first.arrays.degree, degree);
        for (format, kind) in [
            ("ascii", "float"),
            ("ascii", "double"),
            ("binary_big_endian", "float"),
            ("binary_little_endian", "double"),
            ("binary_big_endian", "double"),
        ] {
            names.reverse();
            let other = read(&file(format, kind, &names));
            assert!(other == first, "{degree} {format} {kind}");
        }
    }
}

#[test]
fn two_scales_are_a_disc() {
    let names: Vec<String> = names(0).into_iter().filter(|name| name != "scale_2").collect();
    let found = read(&file("ascii", "float", &names));
    assert_eq!(found.arrays.scale[0].z, 0.0);
    assert!(found.convention.starts_with("PLY of 2D Gaussians: two log scales"));
    assert!(found.convention.ends_with("; draw it with --preset 2dgs"));
    assert_eq!(Gaussians::new(found.arrays).unwrap().1, 0);
}

#[test]
fn doubles_far_from_0_are_shifted() {
    let text = String::from_utf8(file("ascii", "double", &names(0))).unwrap();
    let text = text.replace("\n1.5 ", "\n635000.1 ").replace("\n2.5 ", "\n635001.1 ");
    let found = read(text.as_bytes());
    assert_eq!(found.offset.x, 635_000.5);
    assert_eq!(found.arrays.position[1].x, 0.6, "rounded once");
}

#[test]
fn what_is_not_a_number_is_left_to_the_check() {
    let text = String::from_utf8(file("ascii", "float", &names(0))).unwrap();
    let found = read(text.replacen("-1.5", "nan", 1).as_bytes());
    assert_eq!(Gaussians::new(found.arrays).unwrap().1, 1, "one is dropped");
    let found = read(text.replacen("-1.5", "-inf", 1).as_bytes());
    assert_eq!(found.arrays.opacity[0], 0.0, "a logit may be infinite");
}

#[test]
fn numbers_that_look_activated_are_doubted() {
    let row = "0 0 0 0.5 0.5 0.5 0.25 0.1 0.2 0.1 1 0 0 0\n";
    let text = |row: &str| {
        let names: Vec<String> =
            names(0).into_iter().filter(|name| !name.starts_with('n')).collect();
        let properties: String =
            names.iter().map(|one| format!("property float {one}\n")).collect();
        format!(
            "ply\nformat ascii 1.0\nelement vertex 8\n{properties}end_header\n{}",
            row.repeat(8)
        )
    };
    assert!(read(text(row).as_bytes()).warnings[0].contains("write logarithms and logits"));
    assert!(read(text(&row.replace("0.2", "-2")).as_bytes()).warnings.is_empty());
}

#[test]
fn files_that_lack_something_are_refused_in_one_line() {
    let refused = |names: &[String], kind: &str| {
        let error = parse_gaussians(&file("ascii", kind, names)).unwrap_err();
        assert!(!error.contains('\n'), "{error}");
        error
    };
    let without = |name: &str, degree| -> Vec<String> {
        names(degree).into_iter().filter(|other| other != name).collect()
    };
    for name in ["x", "scale_1", "rot_3", "opacity", "f_dc_1"] {
        let error = refused(&without(name, 0), "float");
        assert!(error.contains(&format!("no property `{name}`")), "{error}");
    }
    let error = refused(&without("f_rest_3", 1), "float");
    assert!(error.contains("8 properties f_rest_*; give 0, 9, 24 or 45"), "{error}");
    let swapped: Vec<String> =
        names(1).into_iter().map(|name| name.replace("f_rest_3", "f_rest_12")).collect();
    let error = refused(&swapped, "float");
    assert!(error.contains("but no `f_rest_3`; number them from 0 on"), "{error}");
    let error = refused(&names(0), "int");
    assert!(error.contains("numbers of Gaussians are float or double"), "{error}");

    let whole = file("binary_little_endian", "float", &names(3));
    for end in [whole.len() - 1, whole.len() - 300] {
        let error = parse_gaussians(&whole[..end]).unwrap_err();
        assert!(error.contains("the file is truncated or the count is wrong"), "{error}");
    }
    let error = parse_gaussians(&[&whole[..], b"0"].concat()).unwrap_err();
    assert!(error.contains("left over"), "{error}");
}
