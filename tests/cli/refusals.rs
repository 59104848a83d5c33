//! What is refused, and that nothing is left behind.

use super::*;
use tempfile::TempDir;

#[test]
fn wrong_usage_is_exit_code_2() {
    let at = TempDir::new().unwrap();
    let line = fails(at.path(), &["render", "--sise", "3x3"], 2);
    assert!(line.contains("--sise"), "{line}");
    fails(at.path(), &[], 2);
    fails(at.path(), &["paint"], 2);
    fails(at.path(), &["render", "nothing-of-the-kind"], 2);
    fails(at.path(), &["render", "picture.exr"], 2);
    fails(at.path(), &["render", "a.ply", "--count", "3"], 2);
    let line = fails(at.path(), &["convert", "a.obj", "b.ply"], 2);
    assert!(line.contains(".spz"), "{line}");
    fails(at.path(), &["explain", "torus"], 2);
    let line = fails(at.path(), &["explain", "torus", "1", "1", "--method", "nothing"], 2);
    assert!(line.contains("single-pass"), "{line}");
    fails(at.path(), &["explain", "sphere", "32", "0", "--count", "9", "--size", "32x24"], 2);
    fails(at.path(), &["compare", "a.exr", "b.exr", "--max-abs", "-1"], 2);
    for more in [
        &["--size", "3"] as &[&str],
        &["--size", "axb"],
        &["--size", "0x0"],
        &["--size", "70000x1"],
        &["--size", "65536x65536"],
        &["--eye", "1,2,3,4"],
        &["--eye", "1,2"],
        &["--eye", "1,2,x"],
        &["--fov", "30", "--ortho", "2"],
        &["--tile", "12"],
        &["--threads", "5000"],
        &["--repeat", "0"],
        &["--outline", "round"],
        &["--kernel", "gauss"],
        &["--number", "f16"],
        &["--epsilon", "1.5x"],
        &["-o", "picture.png"],
        &["--overlap", "0.5"],
        &["--method", "peeling", "--groups", "3"],
        &["--method", "voronoi"],
        &["--depth", "deep"],
        &["--refraction", "0.7,0.8"],
    ] {
        fails(at.path(), &small(more), 2);
    }
    assert!(names(at.path()).is_empty());
}

#[test]
fn pictures_that_cannot_be_are_refused() {
    let at = TempDir::new().unwrap();
    // A setting that cannot be is wrong usage, whatever the scene.
    for (more, what) in [
        (&["--epsilon", "-1"] as &[&str], "epsilon"),
        (&["--epsilon", "nan"], "epsilon"),
        (&["--cutoff", "9"], "cut-off of 9"),
        (&["--low-pass", "-1"], "low-pass"),
        (&["--opacity", "1.5"], "opacity of 1.5"),
        (&["--mipmaps", "99"], "mipmaps of 99 levels"),
        (&["--surfel-size", "0"], "discs of 0 pixels"),
        (&["--bins", "5"], "`bins` does not apply to the method ewa"),
        (&["--flags", "3"], "`flags` does not apply to the method ewa"),
        (&["--method", "deferred", "--flags", "0"], "flags: 0 surfels"),
        (&["--method", "deferred", "--share", "2"], "share: 2"),
        (&["--method", "single-pass", "--overlap", "-0.5"], "c = -0.5"),
        (&["--method", "single-pass", "--overlap", "nan"], "c = NaN"),
        (&["--method", "single-pass", "--groups", "0"], "0 groups"),
        (&["--method", "transparent", "--groups", "65"], "1 to 64"),
        (&["--method", "transparent", "--bins", "0"], "bins: 0;"),
        (&["--method", "transparent", "--bins", "65536"], "bins: 65536"),
        (&["--method", "transparent", "--refraction", "0.7"], "`refraction` does not apply to"),
        (
            &["--method", "transparent-hq", "--environment", "sky", "--refraction", "5"],
            "a ratio of 5",
        ),
        (&["--method", "peeling", "--peel", "0"], "peel: 0"),
    ] {
        let line = fails(at.path(), &small(more), 2);
        assert!(line.contains(what), "{line}");
    }
    for (more, what) in [
        (&["--eye", "1e308,0,0"] as &[&str], "farther away than 1e38"),
        (&["--eye", "0,1e39,0", "--up", "1,0,0"], "farther away than 1e38"),
        (&["--up", "0,0,0"], "up is zero"),
        (&["--up", "0,0,1e300", "--eye", "0,0,5", "--target", "0,0,0"], "parallel"),
        (&["--eye", "1,1,1", "--target", "1,1,1"], "same point"),
        (&["--eye", "0,5,0", "--target", "0,0,0"], "--up"),
        (&["--eye", "nan,0,0"], "finite"),
        (&["--fov", "180"], "180"),
        (&["--focal", "0"], "focal length"),
        (&["--ortho", "-1"], "height"),
        (&["--environment", "none.exr"], "none.exr"),
        (&["--method", "transparent", "--epsilon", "1e-9"], "at most 65535 bins"),
        (&["--method", "single-pass", "--epsilon", "0"], "at most 65535 bins"),
        (&["--method", "transparent-hq", "--refraction", "0.7"], "give an environment"),
    ] {
        let line = fails(at.path(), &small(more), 1);
        assert!(line.contains(what), "{line}");
    }
    let line = fails(at.path(), &["render", "torus", "--count", "0"], 1);
    assert!(line.contains("0 surfels"), "{line}");
    assert!(names(at.path()).is_empty(), "{:?}", names(at.path()));
}

/// The direction of `up` counts, whatever its length.
#[test]
fn up_may_be_of_any_length() {
    let at = TempDir::new().unwrap();
    let picture = |up: &str, name: &str| {
        succeeds(at.path(), &small(&["--up", up, "-o", name]));
        exr::read(&at.path().join(name)).unwrap().channels
    };
    let expected = picture("1,1,0", "a.exr");
    for (up, name) in [("1e300,1e300,0", "b.exr"), ("1e-300,1e-300,0", "c.exr")] {
        assert!(picture(up, name) == expected, "{up}");
    }
}

/// An output that is an input: by another way to its name, and as the preview.
#[cfg(unix)]
#[test]
fn inputs_are_spared() {
    let at = TempDir::new().unwrap();
    let name = |name: &str| at.path().join(name);
    succeeds(at.path(), &["group", "sphere", "--count", "300", "-o", "a.ply"]);
    std::os::unix::fs::symlink("a.ply", name("link.ply")).unwrap();
    fs::create_dir(name("deep")).unwrap();
    succeeds(at.path(), &["render", "sphere", "--count", "9", "--size", "32x16", "-o", "map.exr"]);
    fs::write(name("scene.toml"), "[[model]]\nfile = \"a.ply\"\n").unwrap();
    let before = [fs::read(name("a.ply")).unwrap(), fs::read(name("map.exr")).unwrap()];
    for arguments in [
        &["group", "a.ply", "-o", "a.ply"] as &[&str],
        &["group", "a.ply", "-o", "deep/../a.ply"],
        &["group", "a.ply", "-o", "link.ply"],
        &["group", "scene.toml", "-o", "a.ply"],
        &["render", "sphere", "--environment", "map.exr", "-o", "map.exr"],
    ] {
        let line = fails(at.path(), arguments, 2);
        assert!(line.contains("is part of the scene"), "{line}");
    }
    assert_eq!(before, [fs::read(name("a.ply")).unwrap(), fs::read(name("map.exr")).unwrap()]);
    succeeds(at.path(), &["group", "a.ply", "-o", "b.ply"]);
}

/// A preview that cannot be written keeps the picture from being replaced.
#[test]
fn a_picture_and_its_preview_go_together() {
    let at = TempDir::new().unwrap();
    fs::write(at.path().join("a.exr"), "old").unwrap();
    fs::create_dir(at.path().join("a.png")).unwrap();
    let line = fails(at.path(), &small(&["-o", "a.exr"]), 1);
    assert!(line.contains("a.png") && line.contains("not a regular file"), "{line}");
    assert_eq!(fs::read(at.path().join("a.exr")).unwrap(), b"old");
    assert_eq!(names(at.path()), ["a.exr", "a.png"]);
}

/// What is no file, and what a name may do to a terminal.
#[cfg(unix)]
#[test]
fn pipes_and_names_are_told_in_one_line() {
    let at = TempDir::new().unwrap();
    let pipe = at.path().join("pipe.exr");
    let made = Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    succeeds(at.path(), &small(&["-o", "a.exr"]));
    for (arguments, code) in [
        (&["info", "pipe.exr"] as &[&str], 1),
        (&["compare", "a.exr", "pipe.exr"], 1),
        (&["render", "sphere", "--environment", "pipe.exr"], 1),
        (&["info", "/dev/null"], 2),
    ] {
        let line = fails(at.path(), arguments, code);
        assert!(line.contains("a pipe or a device"), "{line}");
    }
    let line = fails(at.path(), &["info", "."], 2);
    assert!(line.contains("a directory"), "{line}");
    let line = fails(at.path(), &["render", "a\u{1b}[2J\n\u{202e}.ply"], 1);
    assert!(line.contains("a\\u{1b}[2J \\u{202e}.ply"), "{line}");
    let line = fails(at.path(), &["render", &format!("{}.ply", "long".repeat(20_000))], 1);
    assert!(line.chars().count() < 1100 && line.contains("characters left out"), "{line}");
}

/// Output that does not arrive is a failure, though the picture is written.
#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_a_failure() {
    let at = TempDir::new().unwrap();
    for arguments in [&small(&["-o", "a.exr"])[..], &["--help"], &["--version"], &["info", "a.exr"]]
    {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_splatref"))
            .current_dir(at.path())
            .args(arguments)
            .stdout(full)
            .output()
            .unwrap();
        let line = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {line}");
        assert!(line.starts_with("splatref: standard output: "), "{arguments:?}: {line}");
        assert_eq!(names(at.path()), ["a.exr", "a.png"]);
    }
}

/// As [`a_full_standard_output_is_a_failure`]; /dev/null in its place is none.
#[cfg(unix)]
#[test]
fn a_closed_standard_output_is_a_failure() {
    let at = TempDir::new().unwrap();
    let ended = |arguments: &[&str], output: &str| {
        let program = env!("CARGO_BIN_EXE_splatref");
        let script = format!("exec \"$0\" \"$@\" {output}");
        let mut shell = Command::new("sh");
        shell.current_dir(at.path()).args(["-c", &script, program]).args(arguments);
        let output = shell.output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    for arguments in [&small(&["-o", "a.exr"])[..], &["--help"], &["--version"], &["info", "a.exr"]]
    {
        let (code, line) = ended(arguments, ">&-");
        assert_eq!(code, Some(1), "{arguments:?}: {line}");
        assert!(line.starts_with("splatref: standard output: "), "{arguments:?}: {line}");
        assert_eq!(names(at.path()), ["a.exr", "a.png"]);
        for output in [">/dev/null", "1<>/dev/null"] {
            let (code, line) = ended(arguments, output);
            assert_eq!(code, Some(0), "{arguments:?} {output}: {line}");
        }
    }
}

#[test]
fn broken_files_leave_nothing_behind() {
    let at = TempDir::new().unwrap();
    let line = fails(at.path(), &["render", "missing.ply"], 1);
    assert!(line.contains("missing.ply"), "{line}");
    fails(at.path(), &["render", "missing.toml"], 1);
    let vertices = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n\
                    property float y\nproperty float z\nend_header\n";
    for (name, text) in [
        ("noise.ply", "pretty noise"),
        ("short.ply", &format!("{vertices}0 0 0\n1 0 0\n")),
        ("cut.ply", &format!("{vertices}0 0 0\n1 0 0\n0 1 0.12")),
        ("nan.ply", &format!("{vertices}nan 0 0\nnan 0 0\nnan 0 0\n")),
        ("heap.ply", &format!("{vertices}0 0 0\n0 0 0\n0 0 0\n")),
        ("bad.toml", "[[model]\n"),
        ("typo.toml", "[[model]]\nshape = \"sphere\"\n\n[camera]\nfow = 30\n"),
        ("points.toml", "[[model]]\nfile = \"missing.ply\"\n"),
    ] {
        fs::write(at.path().join(name), text).unwrap();
        for command in ["render", "info"] {
            let line = fails(at.path(), &[command, name], 1);
            let names_the_file = line.contains(name) || line.contains("missing.ply");
            assert!(names_the_file, "{line}");
        }
    }
    let line = fails(at.path(), &["render", "typo.toml"], 1);
    assert!(line.contains("line 5") && line.contains("fow"), "{line}");
    assert!(!at.path().join("out").exists());
}

#[test]
fn what_cannot_be_written_is_not_half_written() {
    let at = TempDir::new().unwrap();
    let line = fails(at.path(), &small(&["-o", "missing/a.exr"]), 1);
    assert!(line.contains("missing"), "{line}");
    fs::write(at.path().join("file"), "kept").unwrap();
    fails(at.path(), &small(&["-o", "file/a.exr"]), 1);
    fs::create_dir(at.path().join("b.exr")).unwrap();
    fails(at.path(), &small(&["-o", "b.exr"]), 1);
    assert_eq!(names(at.path()), ["b.exr", "file"]);
    assert!(names(&at.path().join("b.exr")).is_empty());
    // `out` is in the way of the default place.
    fs::write(at.path().join("out"), "kept").unwrap();
    fails(at.path(), &small(&[]), 1);
    assert_eq!(fs::read_to_string(at.path().join("out")).unwrap(), "kept");
}
