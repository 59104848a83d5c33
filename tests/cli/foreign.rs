//! Point files as other programs write them.

use super::*;
use splatref::io::ply;
use tempfile::TempDir;

/// An ascii PLY of vertices with these properties, each `TYPE NAME`.
fn write(path: &Path, properties: &[&str], rows: &[&str]) {
    let properties: String = properties.iter().map(|one| format!("property {one}\n")).collect();
    let (count, rows) = (rows.len(), rows.join("\n"));
    let text =
        format!("ply\nformat ascii 1.0\nelement vertex {count}\n{properties}end_header\n{rows}\n");
    fs::write(path, text).unwrap();
}

const XYZ: [&str; 3] = ["float x", "float y", "float z"];
const OCTAHEDRON: [&str; 6] = ["1 0 0", "-1 0 0", "0 1 0", "0 -1 0", "0 0 1", "0 0 -1"];

fn rows(rest: &str) -> Vec<String> {
    OCTAHEDRON.iter().map(|place| format!("{place} {rest}")).collect()
}

#[test]
fn normals_of_zero_are_derived() {
    let at = TempDir::new().unwrap();
    let strs =
        |rows: &[String]| rows.iter().map(String::as_str).map(str::to_owned).collect::<Vec<_>>();
    write(&at.path().join("without.ply"), &XYZ, &OCTAHEDRON);
    let normals = [&XYZ[..], &["float nx", "float ny", "float nz"]].concat();
    let zeros = strs(&rows("0 0 0"));
    write(
        &at.path().join("zero.ply"),
        &normals,
        &zeros.iter().map(String::as_str).collect::<Vec<_>>(),
    );
    let drawn = |name: &str| {
        let picture = format!("{name}.exr");
        succeeds(at.path(), &["render", &format!("{name}.ply"), "-o", &picture, "--size", "32x24"]);
        exr::read(&at.path().join(picture)).unwrap()
    };
    let [without, zero] = ["without", "zero"].map(drawn);
    assert!(without.channels == zero.channels, "the same picture");
}

#[test]
fn colours_in_another_range_are_doubted_and_mended() {
    let at = TempDir::new().unwrap();
    let picture = |input: &str, code: i32| {
        let output = splatref(at.path(), &["render", input, "-o", "o.exr", "--size", "32x24"]);
        assert_eq!(output.status.code(), Some(code));
        (String::from_utf8(output.stderr).unwrap(), exr::read(&at.path().join("o.exr")).unwrap())
    };
    let colored = |kind: &str| {
        let colors = ["red", "green", "blue"].map(|name| format!("{kind} {name}"));
        let properties = [&XYZ[..], &colors.each_ref().map(String::as_str)].concat();
        let rows = rows("200 20 0");
        write(
            &at.path().join("c.ply"),
            &properties,
            &rows.iter().map(String::as_str).collect::<Vec<_>>(),
        );
    };
    colored("uchar");
    let (said, right) = picture("c.ply", 0);
    assert_eq!(said, "");
    let scene = "[[model]]\nfile = \"c.ply\"\ncolor_range = 255\n[[model]]\nfile = \"c.ply\"\n";
    for kind in ["float", "ushort"] {
        colored(kind);
        let (said, _) = picture("c.ply", 0);
        let start = "splatref: warning: c.ply: ";
        assert!(said.starts_with(start) && said.lines().count() == 1, "{said}");
        assert!(said.contains("write `color_range = 255` in a scene file"), "{said}");
        fs::write(at.path().join("two.toml"), scene).unwrap();
        assert_eq!(picture("two.toml", 0).0.lines().count(), 1, "of the model that has no range");
        fs::write(at.path().join("c.toml"), "[[model]]\nfile = \"c.ply\"\ncolor_range = 255\n")
            .unwrap();
        let (said, mended) = picture("c.toml", 0);
        assert_eq!(said, "");
        assert!(mended.channels == right.channels, "as bytes would be drawn");
    }
    fs::write(at.path().join("c.toml"), "[[model]]\nfile = \"c.ply\"\ncolor_range = 0\n").unwrap();
    assert!(
        fails(at.path(), &["info", "c.toml"], 1).contains("give the code of white, such as 255")
    );
}

/// Labels, large integers and doubles pass through the order.
#[test]
fn ordered_points_keep_every_property_in_its_type() {
    let at = TempDir::new().unwrap();
    let properties = [
        "double x",
        "double y",
        "double z",
        "int label",
        "float scalar_Intensity",
        "uchar red",
        "uchar green",
        "uchar blue",
    ];
    let rows = [
        "635000.25 4853000.125 1 16777217 0.5 255 128 0",
        "635000.75 4853000.375 2 2 1.5 10 20 30",
        "635001.25 4853000.625 3 3 2.5 1 2 3",
    ];
    write(&at.path().join("in.ply"), &properties, &rows);
    let order = ["surfels", "in.ply", "-o", "out.ply", "--start", "2"];
    for more in [&[][..], &["--properties", "label"]] {
        succeeds(at.path(), &[&order[..], more].concat());
        let bytes = fs::read(at.path().join("out.ply")).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        for property in properties {
            assert!(text.contains(&format!("property {property}\n")), "{property}");
        }
        for number in [&635_000.25_f64.to_le_bytes()[..], &16_777_217_i32.to_le_bytes()] {
            assert!(bytes.windows(number.len()).any(|part| part == number), "{number:?}");
        }
    }
    let cloud = ply::read(&at.path().join("out.ply")).unwrap();
    assert_eq!(cloud.position.len(), 3);
}

/// A PLY of doubles: a grid of points, a quarter of a metre apart.
fn write_map(path: &Path, x: f64) {
    let place = |i: u32| {
        let (column, row) = (f64::from(i % 8) / 4.0, f64::from(i / 8) / 4.0);
        format!("{} {} 410 0 0 1 0.25", x + column, 4_853_000.0 + row)
    };
    let rows: Vec<String> = (0..64).map(place).collect();
    let properties =
        ["double x", "double y", "double z", "float nx", "float ny", "float nz", "float radius"];
    write(path, &properties, &rows.iter().map(String::as_str).collect::<Vec<_>>());
}

#[test]
fn map_coordinates_have_one_offset_that_is_given_back() {
    let at = TempDir::new().unwrap();
    write_map(&at.path().join("a.ply"), 635_000.25);
    write_map(&at.path().join("b.ply"), 635_002.25);
    let info = succeeds(at.path(), &["info", "a.ply"]);
    assert!(info.contains("offset   (635001, 4853000.5, 410), subtracted from"), "{info}");
    succeeds(at.path(), &["group", "a.ply", "-o", "grouped.ply"]);
    let grouped = ply::read(&at.path().join("grouped.ply")).unwrap();
    let mut places: Vec<_> =
        grouped.position.iter().map(|p| p.to_array().map(f32::to_bits)).collect();
    places.sort_unstable();
    places.dedup();
    assert_eq!((places.len(), grouped.offset.y), (64, 4_853_000.5));

    // Two files share the offset of the first; the camera looks from a place on the map.
    let camera = "[camera]\nsize = [64, 32]\neye = [635002.125, 4853000.875, 420]\n\
                  target = [635002.125, 4853000.875, 410]\nup = [0, 1, 0]\n";
    let both = format!("[[model]]\nfile = \"a.ply\"\n[[model]]\nfile = \"b.ply\"\n{camera}");
    fs::write(at.path().join("both.toml"), both).unwrap();
    let said = succeeds(at.path(), &["render", "both.toml", "-o", "both.exr"]);
    assert!(said.contains("offset   (635001, 4853000.5, 410)"), "{said}");
    let picture = exr::read(&at.path().join("both.exr")).unwrap();
    let text = picture.text.unwrap();
    assert!(text.contains("offset = [635001.0, 4853000.5, 410.0]\n"), "{text}");

    // The same scene near 0 is the same picture.
    let near = |file: &str| {
        let text = fs::read_to_string(at.path().join(file)).unwrap();
        let move_by = |line: &str| {
            let mut numbers: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
            for (number, less) in numbers.iter_mut().zip([635_001.0, 4_853_000.5, 410.0]) {
                *number -= less;
            }
            numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
        };
        let (head, body) = text.split_once("end_header\n").unwrap();
        let body: Vec<String> = body.lines().map(move_by).collect();
        fs::write(
            at.path().join(format!("near-{file}")),
            format!("{head}end_header\n{}\n", body.join("\n")),
        )
        .unwrap();
    };
    near("a.ply");
    near("b.ply");
    let camera = "[camera]\nsize = [64, 32]\neye = [1.125, 0.375, 10]\ntarget = [1.125, 0.375, 0]\n\
                  up = [0, 1, 0]\n";
    let both =
        format!("[[model]]\nfile = \"near-a.ply\"\n[[model]]\nfile = \"near-b.ply\"\n{camera}");
    fs::write(at.path().join("near.toml"), both).unwrap();
    succeeds(at.path(), &["render", "near.toml", "-o", "near.exr"]);
    let near = exr::read(&at.path().join("near.exr")).unwrap();
    assert!(near.channels == picture.channels);

    // A transform that moves the map to 0 needs no offset, and loses nothing.
    let moved = "[[model]]\nfile = \"a.ply\"\n[model.transform]\n\
                 translate = [-635001, -4853000.5, -410]\n";
    fs::write(at.path().join("moved.toml"), moved).unwrap();
    let said = succeeds(at.path(), &["group", "moved.toml", "-o", "moved.ply"]);
    assert!(!said.contains("offset"), "{said}");
    let moved = ply::read(&at.path().join("moved.ply")).unwrap();
    assert!(moved.position == grouped.position && moved.offset.y == 0.0);
}

/// A LAS of point format 0: a grid of map coordinates, whose intensity grows along x.
fn las() -> Vec<u8> {
    let mut header = vec![0; 227];
    let mut put = |at: usize, value: &[u8]| header[at..][..value.len()].copy_from_slice(value);
    put(0, b"LASF");
    put(24, &[1, 2]);
    put(94, &227_u16.to_le_bytes());
    put(96, &227_u32.to_le_bytes());
    put(105, &20_u16.to_le_bytes());
    put(107, &64_u32.to_le_bytes());
    for axis in 0..3 {
        put(131 + 8 * axis, &0.25_f64.to_le_bytes());
    }
    put(155, &635_000.1_f64.to_le_bytes());
    let row = |i: i32| {
        let mut row = [0; 20];
        row[..4].copy_from_slice(&(i % 8).to_le_bytes());
        row[4..8].copy_from_slice(&(i / 8).to_le_bytes());
        row[12..14].copy_from_slice(&(100 + i as u16 % 8).to_le_bytes());
        row
    };
    header.extend((0..64).flat_map(row));
    header
}

#[test]
fn scans_are_drawn_and_coloured_by_a_number_of_each_point() {
    let at = TempDir::new().unwrap();
    fs::write(at.path().join("scan.las"), las()).unwrap();
    let told = succeeds(at.path(), &["info", "scan.las"]);
    for what in ["points     64", "property   intensity", "  offset   (635", "neighbours"] {
        assert!(told.contains(what), "{told}");
    }
    let (size, light) = (["--size", "32x24"], "light = []\n[[model]]\nfile = \"scan.las\"\n");
    let render = |scene: &str, more: &[&str]| {
        let told =
            succeeds(at.path(), &[&["render", scene, "-o", "o.exr"], &size[..], more].concat());
        (told, exr::read(&at.path().join("o.exr")).unwrap())
    };
    fs::write(at.path().join("by.toml"), format!("{light}color_by = \"intensity\"\n")).unwrap();
    fs::write(at.path().join("plain.toml"), light).unwrap();
    let (told, by) = render("by.toml", &[]);
    assert!(told.contains("coloured scan by intensity, viridis from 100 to 107"), "{told}");
    let (_, option) = render("plain.toml", &["--color-by", "intensity"]);
    assert_eq!(option.channels, by.channels, "the option is the key");
    // Intensity and x grow together.
    let (told, place) = render("plain.toml", &["--color-by", "x"]);
    assert!(told.contains("viridis from 635000."), "{told}");
    assert_eq!(floats(&place, "R"), floats(&by, "R"));
    let (_, grey) = render("plain.toml", &[]);
    assert_ne!(grey.channels, by.channels);

    let by = |file: &str, name: &str| {
        fails(at.path(), &["render", file, "--color-by", name], if file == "torus" { 2 } else { 1 })
    };
    let found = by("scan.las", "gps");
    assert!(found.contains("no property `gps`; the file has intensity, classification"), "{found}");
    assert!(by("torus", "x").contains("--color-by applies to a file, but torus is not one"));
    write(&at.path().join("c.ply"), &[&XYZ[..], &["uchar heat"]].concat(), &["0 0 0 5", "0 1 1 2"]);
    let found = by("c.ply", "cold");
    assert!(found.contains("has no number `cold`; it has x, y, z"), "{found}");
    succeeds(at.path(), &["surfels", "scan.las", "-o", "o.ply", "--start", "3"]);
    let text = fs::read(at.path().join("o.ply")).unwrap();
    assert!(String::from_utf8_lossy(&text).contains("property float intensity\n"));
}
