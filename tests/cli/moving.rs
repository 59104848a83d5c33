//! Geometries with a file for each frame: clouds whose points move.

use super::*;
use std::fmt::Write as _;
use tempfile::TempDir;

const FRAMES: u32 = 4;
const CAMERA: &str = "\
[[model]]
file = \"behind.ply\"
[sequence]
frames = 4
[camera]
size = [48, 40]
keys = [
  { frame = 0, eye = [0, 0.5, 4], target = [0, 0, 0] },
  { frame = 3, eye = [1, 0.5, 4], target = [0, 0, 0] },
]
[method]
name = \"deferred\"
";
const FILES: &str =
    "[[geometry]]\nname = \"cloud\"\nfile = \"cloud.%03d.ply\"\n[[object]]\nof = \"cloud\"\n";
/// The same motion by keys: 1/4 a frame.
const KEYS: &str = "[[geometry]]\nname = \"cloud\"\nfile = \"cloud.000.ply\"\n[[object]]\nof = \"cloud\"\n\
                    keys = [{ frame = 0 }, { frame = 4, translate = [1, 0, 0] }]\n";

/// A square sheet of points; all numbers are exact in f32.
fn sheet(side: u16, x: f64, z: f64) -> String {
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", side * side);
    for name in ["x", "y", "z", "nx", "ny", "nz", "radius"] {
        let _ = writeln!(text, "property float {name}");
    }
    text += "end_header\n";
    let half = f64::from(side) / 2.0;
    for i in 0..side * side {
        let [column, row] = [i % side, i / side].map(|at| (f64::from(at) - half) / 16.0);
        let _ = writeln!(text, "{} {row} {z} 0 0 1 0.0625", column + x);
    }
    text
}

/// Clouds, and two scenes of the same motion.
fn clouds() -> TempDir {
    let at = TempDir::new().unwrap();
    for frame in 0..FRAMES {
        let x = f64::from(frame) / 4.0;
        fs::write(at.path().join(format!("cloud.{frame:03}.ply")), sheet(16, x, 1.0)).unwrap();
    }
    fs::write(at.path().join("behind.ply"), sheet(40, 0.0, 0.0)).unwrap();
    fs::write(at.path().join("files.toml"), format!("{FILES}{CAMERA}")).unwrap();
    fs::write(at.path().join("keys.toml"), format!("{KEYS}{CAMERA}")).unwrap();
    at
}

/// The method `deferred` follows points through files as it follows them through places.
#[test]
fn files_move_points_as_keys_do() {
    let at = clouds();
    let png = |name: &str| fs::read(at.path().join(format!("{name}.png"))).unwrap();
    for scene in ["files", "keys"] {
        let (file, out) = (format!("{scene}.toml"), format!("{scene}.exr"));
        succeeds(at.path(), &["render", &file, "--frames", "all", "-o", &out]);
    }
    for frame in 0..FRAMES {
        let [files, keys] = ["files", "keys"].map(|scene| format!("{scene}.{frame:04}"));
        let [one, other] = [&files, &keys].map(|name| format!("{name}.exr"));
        let said = succeeds(at.path(), &["compare", &one, &other]);
        assert!(said.contains("equal: all"), "{said}");
        assert!(frame == 0 || png(&files) != png("files.0000"), "frame {frame} moves");
    }
    // A frame without the frames before it differs: it has another state.
    succeeds(at.path(), &["render", "files.toml", "--frame", "3", "-o", "alone.exr"]);
    let other = splatref(at.path(), &["compare", "alone.exr", "files.0003.exr"]);
    assert_eq!(other.status.code(), Some(1));
    let keep = ["--frames", "0..3", "-o", "w.exr", "--keep-state", "s.bin"];
    succeeds(at.path(), &[&["render", "files.toml"], &keep[..]].concat());
    let late = ["render", "files.toml", "--frame", "3", "--state", "s.bin", "-o", "late.exr"];
    succeeds(at.path(), &late);
    assert_eq!(png("late"), png("files.0003"));
    // Every method sees the points of the frame.
    let ewa = |scene: &str| {
        let out = format!("{scene}.ewa.exr");
        let scene = format!("{scene}.toml");
        let more = ["--method", "ewa", "--frame", "2", "-o", &out, "--tile", "8"];
        succeeds(at.path(), &[&["render", scene.as_str()], &more[..]].concat());
        png(out.trim_end_matches(".exr"))
    };
    assert_eq!(ewa("files"), ewa("keys"));
    let said = succeeds(
        at.path(),
        &["verify", "keys.toml", "files.ewa.exr", "--method", "ewa", "--frame", "2"],
    );
    assert!(said.contains("right: "), "{said}");
}

/// Warnings name the files of all frames, not only those of the first.
#[test]
fn files_of_later_frames_are_doubted() {
    let at = clouds();
    // In f32, the sheet is one row at this x.
    let far = sheet(16, 1e9, 1.0).replace("float x", "double x");
    fs::write(at.path().join("cloud.002.ply"), far).unwrap();
    let frames = ["render", "files.toml", "--frames", "all", "-o", "w.exr"];
    let output = splatref(at.path(), &frames);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.starts_with("splatref: warning: cloud.002.ply: of 256 places, only 16"), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
}

#[test]
fn clouds_that_lose_points_are_refused() {
    let at = clouds();
    let write = |name: &str, text: &str| fs::write(at.path().join(name), text).unwrap();
    let frames = ["render", "files.toml", "--frames", "all", "-o", "w.exr"];
    let frame = ["render", "files.toml", "--frame", "2", "-o", "w.exr"];
    write("cloud.002.ply", &sheet(15, 0.5, 1.0));
    let what = "cloud.002.ply: 225 surfels, but cloud.000.ply has 256; give every frame the same points in \
                the same order";
    assert!(fails(at.path(), &frame, 1).contains(what));
    let hole = sheet(16, 0.5, 1.0).replacen(" 0 0 1 ", " 0 0 0 ", 1);
    write("cloud.002.ply", &hole);
    let line = fails(at.path(), &frame, 1);
    assert!(line.contains("cloud.002.ply: 1 points cannot be surfels"), "{line}");
    write("cloud.000.ply", &hole);
    let line = fails(at.path(), &frame, 1);
    assert!(line.contains("cloud.000.ply: 1 points cannot be surfels"), "{line}");
    // A file that is missing is found before the first frame is drawn.
    write("cloud.000.ply", &sheet(16, 0.0, 1.0));
    fs::remove_file(at.path().join("cloud.003.ply")).unwrap();
    assert!(fails(at.path(), &frames, 1).contains("cloud.003.ply"));
    assert!(!at.path().join("w.0000.exr").exists());
    // No file of a frame is overwritten, whether its frame is drawn or not.
    let keep =
        ["render", "files.toml", "--frame", "0", "-o", "w.exr", "--keep-state", "cloud.001.ply"];
    assert!(fails(at.path(), &keep, 2).contains("cloud.001.ply is part of the scene"));
    let line = fails(at.path(), &["surfels", "files.toml", "-o", "h"], 1);
    assert!(line.contains("cloud: a hierarchy samples triangles that do not move"), "{line}");

    let detail = FILES.replace("file =", "detail = 1.0\nfile =");
    write("files.toml", &format!("{detail}{CAMERA}"));
    assert!(fails(at.path(), &frame, 1).contains("`detail` is made of one file"));
    write("files.toml", &format!("{}{CAMERA}", FILES.replace("%03d", "%d.%03d")));
    assert!(fails(at.path(), &frame, 1).contains("has two numbers of a frame; keep one"));
}
