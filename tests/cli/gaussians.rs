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
}
