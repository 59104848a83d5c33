//! Files of 3D Gaussians.

use super::*;
use tempfile::TempDir;

/// An ascii PLY of Gaussians of degree 0 without normals, in rows of position, coefficients, opacity, scales and rotation.
fn write(path: &Path, rows: &[&str]) {
    let names =
        "x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3";
    let properties: String =
        names.split(' ').map(|name| format!("property float {name}\n")).collect();
    let (count, rows) = (rows.len(), rows.join("\n"));
    let text =
        format!("ply\nformat ascii 1.0\nelement vertex {count}\n{properties}end_header\n{rows}\n");
    fs::write(path, text).unwrap();
}

const ROWS: [&str; 3] = [
    "0 0 0 0.5 0 -0.5 2 -2 -1 -3 1 0 0 0",
    "1 0 0 1 1 1 -0.5 -2 -2 -2 0.5 0.5 0.25 0",
    "0 1 0 0 0 0 0 -1 -1 -2.5 0 2 0 0",
];

#[test]
fn a_file_is_described_with_its_convention() {
    let at = TempDir::new().unwrap();
    let bad = "nan 0 0 0 0 0 0 0 0 0 1 0 0 0";
    let unturned = "0 0 0 0 0 0 0 0 0 0 0 0 0 0";
    write(&at.path().join("g.ply"), &[&ROWS[..], &[bad, unturned]].concat());
    let said = succeeds(at.path(), &["info", "g.ply"]);
    for line in [
        "scene      g: 3 Gaussians, spherical harmonics of degree 0",
        "  read as  PLY of 3D Gaussians: log scales, logit opacities, quaternion w first",
        "  colours  srgb_rec709_display",
        "  dropped  2 Gaussians with a number that is not finite, a scale < 0, a rotation of length 0",
        "  bounds   (0, 0, 0) to (1, 1, 0)",
    ] {
        assert!(said.contains(line), "{line}\n{said}");
    }
    write(&at.path().join("none.ply"), &[bad]);
    let line = fails(at.path(), &["info", "none.ply"], 1);
    assert!(line.contains("none.ply: the scene is empty: none of its 1 Gaussians"), "{line}");
}

#[test]
fn a_file_of_discs_names_its_preset_and_is_explained() {
    let at = TempDir::new().unwrap();
    write(&at.path().join("g.ply"), &ROWS);
    let text = fs::read_to_string(at.path().join("g.ply")).unwrap();
    // The file of a program that trains discs lacks the third scale.
    let text = text.replace("property float scale_2\n", "").replace(" -3 1", " 1");
    let text = text.replace("-2 -2 -2", "-2 -2").replace("-1 -1 -2.5", "-1 -1");
    fs::write(at.path().join("d.ply"), text).unwrap();
    let said = succeeds(at.path(), &["info", "d.ply"]);
    assert!(said.contains("the third scale is 0") && said.contains("--preset 2dgs"), "{said}");
    let view = ["--method", "gaussians", "--eye", "0.5,0.5,4", "--size", "24x16"];
    let all = |first: &[&'static str]| [first, &view[..], &["--preset", "2dgs"]].concat();
    succeeds(at.path(), &all(&["render", "d.ply", "-o", "p.exr"]));
    let said = succeeds(at.path(), &all(&["verify", "d.ply", "p.exr"]));
    assert!(said.contains("\nright"), "{said}");
    let said = succeeds(at.path(), &all(&["explain", "d.ply", "12", "8"]));
    assert!(
        said.contains("  u ") && said.contains(", rho3d ") && said.contains(", rho2d "),
        "{said}"
    );
    let line =
        fails(at.path(), &[&all(&["render", "d.ply"])[..], &["--clamp", "none"]].concat(), 2);
    assert!(line.contains("`clamp` has no effect with discs that meet rays; remove it"), "{line}");
}

#[test]
fn a_scene_file_moves_them() {
    let at = TempDir::new().unwrap();
    write(&at.path().join("g.ply"), &ROWS);
    let text = "[[model]]\nfile = \"g.ply\"\n[model.transform]\ntranslate = [0, 0, 5]\nscale = 2\n";
    fs::write(at.path().join("s.toml"), text).unwrap();
    let said = succeeds(at.path(), &["info", "s.toml"]);
    assert!(said.contains("  bounds   (0, 0, 5) to (2, 2, 5)"), "{said}");
    assert!(said.contains("scene      s: 3 Gaussians"), "{said}");
    assert!(said.contains("\ncamera     perspective"), "{said}");
}

#[test]
fn methods_of_surfels_refuse_them() {
    let at = TempDir::new().unwrap();
    write(&at.path().join("g.ply"), &ROWS);
    for method in ["ewa", "deferred"] {
        let line = fails(at.path(), &["render", "g.ply", "--method", method, "-o", "o.exr"], 1);
        assert!(line.contains("Gaussians") && line.contains("--method gaussians"), "{line}");
    }
    assert_eq!(names(at.path()), ["g.ply"]);
}

#[test]
fn choices_and_commands_of_surfels_are_refused() {
    let at = TempDir::new().unwrap();
    write(&at.path().join("g.ply"), &ROWS);
    for (more, key) in [
        (&["--opacity", "0.5"], "opacity"),
        (&["--prefix", "1"], "prefix"),
        (&["--color-by", "z"], "color_by"),
        (&["--texture", "t.png"], "texture"),
        (&["--mipmaps", "2"], "mipmaps"),
        (&["--surfel-size", "2"], "surfel_size"),
    ] {
        let line = fails(at.path(), &[&["render", "g.ply"], &more[..]].concat(), 1);
        assert!(line.contains("does not apply to 3D Gaussians; remove it"), "{line}");
        assert!(line.contains(key), "{line}");
    }
    for (text, what) in [
        ("[[model]]\nfile = \"g.ply\"\nradius = 1\n", "`radius` does not apply"),
        ("[[model]]\nfile = \"g.ply\"\ncolor = [1, 0, 0]\n", "`color` does not apply"),
        ("[[model]]\nfile = \"g.ply\"\ndraw = \"points\"\n", "`draw` does not apply"),
        (
            "[[model]]\nshape = \"sphere\"\n[[model]]\nfile = \"g.ply\"\n",
            "has one model and no objects",
        ),
        ("[[geometry]]\nname = \"a\"\nfile = \"g.ply\"\n[[object]]\nof = \"a\"\n", "has one model"),
        (
            "[[light]]\nkind = \"point\"\nposition = [1, 2, 3]\n[[model]]\nfile = \"g.ply\"\n",
            "`light` does not",
        ),
    ] {
        fs::write(at.path().join("s.toml"), text).unwrap();
        let line = fails(at.path(), &["info", "s.toml"], 1);
        assert!(line.contains("g.ply: ") && line.contains(what), "{line}");
    }
    fs::write(at.path().join("s.toml"), "[[model]]\nfile = \"g.ply\"\n").unwrap();
    for arguments in [
        &["group", "g.ply", "-o", "o.ply"] as &[&str],
        &["surfels", "g.ply", "-o", "o.ply"],
        &["surfels", "s.toml", "-o", "folder"],
        &["quality", "g.ply"],
        &["project", "g.ply", "-o", "o.bin"],
    ] {
        let line = fails(at.path(), arguments, 1);
        assert!(line.contains("3D Gaussians"), "{arguments:?}: {line}");
    }
    for arguments in [
        &["study", "g.ply", "--method", "gaussians", "--size", "16x12", "-o", "s"] as &[&str],
        &["plan", "g.ply", "--method", "gaussians", "--size", "16x12", "--error", "1"],
    ] {
        let line = fails(at.path(), arguments, 2);
        assert!(line.contains("true surface") && line.contains("splatref compare"), "{line}");
    }
}

#[test]
fn gaussians_are_converted_and_described_in_every_format() {
    let at = TempDir::new().unwrap();
    write(&at.path().join("g.ply"), &ROWS);
    let said = succeeds(at.path(), &["convert", "g.ply", "g.glb"]);
    assert!(said.contains("gaussians  3, spherical harmonics of degree 0"), "{said}");
    assert!(
        said.contains("  changed  nothing: the file gives the same Gaussians, bit for bit"),
        "{said}"
    );
    let line = |name: &str, key: &str| {
        let said = succeeds(at.path(), &["info", name]);
        said.lines().find(|line| line.trim().starts_with(key)).unwrap().to_owned()
    };
    assert_eq!(line("g.glb", "sha256"), line("g.ply", "sha256"), "the same scene");
    assert!(line("g.glb", "read as").contains("glTF with KHR_gaussian_splatting: linear scales"));
    // A file that splatref wrote once keeps every bit on its way to GLB and back.
    succeeds(at.path(), &["convert", "g.glb", "a.ply"]);
    succeeds(at.path(), &["convert", "a.ply", "a.glb"]);
    let said = succeeds(at.path(), &["convert", "a.glb", "b.ply"]);
    assert!(said.contains("  changed  nothing"), "{said}");
    let [a, b] = ["a.ply", "b.ply"].map(|name| fs::read(at.path().join(name)).unwrap());
    assert!(a == b);

    let floats = [1.0_f32, 2.0, 3.0, 500.25, 0.25, 0.125];
    let mut row: Vec<u8> = floats.iter().flat_map(|value| value.to_le_bytes()).collect();
    row.extend([255, 0, 51, 204, 192, 128, 64, 128]);
    fs::write(at.path().join("s.splat"), row).unwrap();
    assert!(line("s.splat", "read as").contains(".splat: linear scales"));
    let said = succeeds(at.path(), &["convert", "s.splat", "s.ply"]);
    assert!(said.contains("1 of 3 scales, by at most"), "{said}");
    assert!(said.contains("because of logarithms in f32"), "{said}");
}

/// An SPZ of one Gaussian at (1, 2, -4), flattened along z.
fn spz(flags: u8) -> Vec<u8> {
    use std::io::Write;
    let head = [b"NGSP", &2_u32.to_le_bytes()[..], &1_u32.to_le_bytes(), &[0, 12, flags, 0]];
    let position = [0, 16, 0, 0, 32, 0, 0, 192, 255];
    let rest = [230, 255, 0, 128, 140, 132, 90, 127, 127, 127];
    let mut file = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    file.write_all(&[&head.concat()[..], &position, &rest].concat()).unwrap();
    file.finish().unwrap()
}

#[test]
fn an_spz_is_drawn_described_and_converted() {
    let at = TempDir::new().unwrap();
    fs::write(at.path().join("a.spz"), spz(1)).unwrap();
    let said = succeeds(at.path(), &["info", "a.spz"]);
    assert!(said.contains("  read as  SPZ version 2: positions of 24 bits, other"), "{said}");
    assert!(said.contains("with antialiasing: draw it with --compensation ratio"), "{said}");
    let said = succeeds(at.path(), &["convert", "a.spz", "a.glb"]);
    assert!(said.contains("  changed  nothing"), "{said}");
    succeeds(at.path(), &["convert", "a.spz", "a.ply"]);
    fs::write(at.path().join("s.toml"), "[[model]]\nfile = \"a.spz\"\n").unwrap();
    // The same Gaussian in three files, by its name and in a scene, makes the same picture.
    let view =
        ["--eye", "1,2,0", "--target", "1,2,-4", "--size", "24x16", "--compensation", "ratio"];
    let picture = |name: &str| {
        let arguments = [&["render", name, "--method", "gaussians", "-o", "p.exr"], &view[..]];
        succeeds(at.path(), &arguments.concat());
        let said = succeeds(at.path(), &["info", "p.exr"]);
        said.lines().find(|line| line.trim().starts_with("sha256")).unwrap().to_owned()
    };
    assert_eq!(picture("a.spz"), picture("a.glb"));
    assert_eq!(picture("a.spz"), picture("s.toml"));
    let line = fails(at.path(), &["render", "a.spz"], 1);
    assert!(line.contains("a has 3D Gaussians, but the method ewa draws surfels"), "{line}");
    fs::write(at.path().join("b.spz"), &spz(0)[..30]).unwrap();
    for arguments in [&["info", "b.spz"][..], &["convert", "b.spz", "b.ply"]] {
        let line = fails(at.path(), arguments, 1);
        assert!(line.contains("b.spz: the gzip stream ends early"), "{line}");
    }
}

#[test]
fn what_cannot_be_converted_is_refused() {
    let at = TempDir::new().unwrap();
    write(&at.path().join("g.ply"), &ROWS);
    let before = fs::read(at.path().join("g.ply")).unwrap();
    for (arguments, code, what) in [
        (["g.ply", "g.ply"], 2, "g.ply is also an input; give another name"),
        (["g.ply", "./g.ply"], 2, "is also an input"),
        (["g.ply", "g.obj"], 2, "g.obj: Gaussians are written as .ply or .glb"),
        (["g.ply", "no/g.glb"], 1, "no/g.glb"),
        (["none.ply", "g.glb"], 1, "none.ply"),
        (["g.ply", "g.spz"], 2, "g.spz: Gaussians are written as .ply or .glb"),
        (["g.ply", "g.splat"], 2, "g.splat: Gaussians are written as .ply or .glb"),
        (["none.spz", "g.glb"], 1, "none.spz"),
    ] {
        let line = fails(at.path(), &[&["convert"], &arguments[..]].concat(), code);
        assert!(line.contains(what), "{line}");
    }
    assert!(fs::read(at.path().join("g.ply")).unwrap() == before);
    fs::write(
        at.path().join("p.ply"),
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n\
        property float y\nproperty float z\nend_header\n0 0 0\n",
    )
    .unwrap();
    let line = fails(at.path(), &["convert", "p.ply", "o.glb"], 1);
    assert!(line.contains("p.ply: this PLY holds no Gaussians"), "{line}");
    succeeds(at.path(), &["convert", "g.ply", "g.glb"]);
    for arguments in [&["surfels", "g.glb", "-o", "o.ply"] as &[&str], &["quality", "g.glb"]] {
        let line = fails(at.path(), arguments, 1);
        assert!(line.contains("g.glb: the file holds 3D Gaussians"), "{line}");
    }
    assert_eq!(names(at.path()), ["g.glb", "g.ply", "p.ply"]);
}

/// Where the splats of [`ROWS`] and a sphere are seen.
const VIEW: &[&str] =
    &["--eye", "0.5,0.5,4", "--target", "0.25,0.25,0", "--fov", "40", "--size", "24x16"];

#[test]
fn splats_are_mixed_with_a_surface_in_whole_in_parts_and_by_a_scene_file() {
    let at = TempDir::new().unwrap();
    write(&at.path().join("g.ply"), &ROWS);
    let sphere = ["render", "sphere", "--count", "400", "-o", "opaque.exr"];
    succeeds(at.path(), &[&sphere, VIEW].concat());
    let mixed = [&["--method", "gaussians", "--surface", "opaque.exr"], VIEW].concat();
    let with = |first: &[&'static str]| [first, &mixed].concat();
    let run = |first: &[&'static str]| succeeds(at.path(), &with(first));
    run(&["render", "g.ply", "-o", "mixed.exr"]);
    run(&["render", "g.ply", "-o", "bands.exr", "--bands", "3"]);
    run(&["render", "g.ply", "-o", "a.exr", "--region", "0,0,24,7"]);
    run(&["render", "g.ply", "-o", "b.exr", "--region", "0,7,24,16"]);
    run(&["render", "g.ply", "-o", "few.exr", "--storage", "f16", "--depth-storage", "unorm16"]);
    succeeds(at.path(), &["assemble", "a.exr", "b.exr", "-o", "parts.exr"]);
    let text = "surface = \"opaque.exr\"\n[[model]]\nfile = \"g.ply\"\n[camera]\nsize = [24, 16]\n\
                eye = [0.5, 0.5, 4]\ntarget = [0.25, 0.25, 0]\nfov = 40\n[method]\nname = \"gaussians\"\n";
    fs::write(at.path().join("s.toml"), text).unwrap();
    succeeds(at.path(), &["render", "s.toml", "-o", "file.exr"]);
    for other in ["bands.exr", "parts.exr", "file.exr"] {
        succeeds(at.path(), &["compare", "mixed.exr", other]);
    }
    let said = run(&["verify", "g.ply", "mixed.exr"]);
    assert!(said.contains("\nright"), "{said}");
    let said = run(&["verify", "g.ply", "a.exr", "--region", "0,0,24,7"]);
    assert!(said.contains("\nright"), "{said}");
    let bare = [&["verify", "g.ply", "mixed.exr", "--method", "gaussians"], VIEW].concat();
    assert_eq!(splatref(at.path(), &bare).status.code(), Some(1));
    let said = run(&["explain", "g.ply", "12", "8"]);
    assert!(said.contains("behind the surface, skipped"), "{said}");
    assert!(said.contains("\nthe surface: depth "), "{said}");
}

#[test]
fn what_is_no_surface_is_refused_with_the_cure() {
    let at = TempDir::new().unwrap();
    write(&at.path().join("g.ply"), &ROWS);
    succeeds(at.path(), &[&["render", "sphere", "--count", "400", "-o", "o.exr"], VIEW].concat());
    let refused = |first: &[&'static str], code| {
        let first = [first, &["--surface", "o.exr"], VIEW].concat();
        let line = fails(at.path(), &first, code);
        assert!(!line.trim().contains('\n'), "{line}");
        line
    };
    let line = refused(&["render", "sphere", "--count", "400"], 1);
    assert!(
        line.contains("the method ewa draws none") && line.contains("--method gaussians"),
        "{line}"
    );
    let splats = ["render", "g.ply", "--method", "gaussians"];
    let other = [&splats[..], &["--surface", "o.exr", "--size", "12x8"]].concat();
    let line = fails(at.path(), &other, 1);
    assert!(line.contains("24 x 16 pixels, but the camera's picture has 12 x 8"), "{line}");
    let line = refused(&[&splats[..], &["--turntable", "3"]].concat(), 2);
    assert!(line.contains("a surface belongs to one view") && line.contains("--frame"), "{line}");
    let line = fails(at.path(), &[&splats[..], &["--surface", "g.ply"]].concat(), 1);
    assert!(line.contains("g.ply: "), "{line}");
    let line = fails(at.path(), &[&splats[..], &["--surface", "o.png"]].concat(), 1);
    assert!(line.contains("no EXR file") && line.contains("convert it to .exr"), "{line}");
}
