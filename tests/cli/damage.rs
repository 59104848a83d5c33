//! Damaged files, too little memory, and readers that have gone.

use super::*;
use tempfile::TempDir;

/// `info | head` ends as it would with a reader that stays, and says nothing.
#[cfg(unix)]
#[test]
fn a_reader_that_has_gone_is_no_failure() {
    let at = TempDir::new().unwrap();
    succeeds(at.path(), &[&small(&["-o", "b.exr"])[..], &["--eye", "3,2,1"]].concat());
    let ended = |arguments: &[&str]| {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut program = Command::new(env!("CARGO_BIN_EXE_splatref"));
        let output = program.current_dir(at.path()).args(arguments).stdout(writer).output();
        let output = output.unwrap();
        assert_eq!(String::from_utf8(output.stderr).unwrap(), "", "{arguments:?}");
        output.status.code()
    };
    for arguments in [
        &small(&["-o", "a.exr"])[..],
        &["--help"],
        &["--version"],
        &["info", "a.exr"],
        &["compare", "a.exr", "a.exr"],
    ] {
        assert_eq!(ended(arguments), Some(0), "{arguments:?}");
    }
    assert_eq!(ended(&["compare", "a.exr", "b.exr"]), Some(1));
}

#[test]
fn a_dash_is_refused_wherever_a_file_is_named() {
    let at = TempDir::new().unwrap();
    for arguments in [
        &["render", "-"][..],
        &["render", "-o", "-"],
        &["render", "-o-"],
        &["render", "--output=-"],
        &["render", "--method", "deferred", "--keep-state", "-"],
        &["render", "--method", "deferred", "--state", "-"],
        &["info", "-"],
        &["compare", "-", "a.exr"],
        &["verify", "sphere", "-"],
        &["project", "sphere", "-o", "-"],
        &["group", "sphere", "-o", "-"],
        &["surfels", "sphere", "-o", "-"],
        &["study", "sphere", "-o", "-"],
        &["golden", "-"],
    ] {
        let line = fails(at.path(), arguments, 2);
        assert!(line.contains("`-` stands for neither"), "{arguments:?}: {line}");
    }
    assert!(names(at.path()).is_empty());
    succeeds(at.path(), &small(&["-o", "./-.exr"]));
}

/// Colours that a PNG's decoder does not survive are one line, wherever a PNG is read.
#[test]
fn a_broken_palette_is_an_error_of_the_file() {
    let at = TempDir::new().unwrap();
    // 2 x 2 pixels with the indices 0 and 1, and a palette of four bytes.
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\x02\0\0\0\x02\x08\x03\0\0\0\x45\x68\xfd\x16\
                \0\0\0\x04PLTE\x01\x02\x03\x04\x23\xdb\x8a\xab\
                \0\0\0\x0cIDAT\x78\x9c\x63\x60\x60\x04\x42\0\0\x0c\0\x03\x2b\x63\xcb\x50\
                \0\0\0\0IEND\xaeB`\x82";
    fs::write(at.path().join("a.png"), png).unwrap();
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    fs::write(at.path().join("a.obj"), vertices).unwrap();
    for arguments in [
        &["compare", "a.png", "a.png"][..],
        &["render", "a.obj", "--texture", "a.png", "-o", "a.exr"],
    ] {
        let line = fails(at.path(), arguments, 1);
        assert!(line.contains("a.png: ") && line.lines().count() == 1, "{line}");
    }
}

/// What a table or a text takes is asked before it is parsed.
#[test]
fn memory_is_asked_before_text_is_parsed() {
    let at = TempDir::new().unwrap();
    let light = "[[light]]\nkind = \"point\"\nposition = [1, 1, 1]\n".repeat(30_000);
    let text = format!("[[model]]\nshape = \"sphere\"\ncount = 200\n{light}");
    fs::write(at.path().join("s.toml"), text).unwrap();
    let line = fails(at.path(), &["info", "s.toml", "--memory", "100M"], 1);
    assert!(line.contains("s.toml: ") && line.contains("bytes of TOML needs"), "{line}");
    let table = format!("x,y,z\n{}", "0,0,0\n".repeat(1_000_000));
    fs::write(at.path().join("t.csv"), table).unwrap();
    let geometry =
        "[[geometry]]\nname = \"t\"\nshape = \"torus\"\ncount = 3\n[[object]]\nof = \"t\"\n";
    fs::write(at.path().join("t.toml"), format!("{geometry}table = \"t.csv\"\n")).unwrap();
    let line = fails(at.path(), &["info", "t.toml", "--memory", "100M"], 1);
    assert!(line.contains("t.csv: ") && line.contains("rows needs"), "{line}");
}

#[test]
fn wrong_usage_of_a_state_has_its_own_exit_code() {
    let at = TempDir::new().unwrap();
    let deferred = ["--method", "deferred"];
    succeeds(at.path(), &[&small(&["-o", "a.exr", "--keep-state", "s"])[..], &deferred].concat());
    let with =
        |more: &[&'static str]| [&small(&["-o", "b.exr", "--state", "s"])[..], more].concat();
    let line = fails(at.path(), &with(&[]), 2);
    assert!(line.contains("has no state between frames"), "{line}");
    let line = fails(at.path(), &with(&deferred), 2);
    assert!(line.contains("is for frame 1, but this is frame 0"), "{line}");
    // A flipped bit is never another picture.
    let whole = fs::read(at.path().join("s")).unwrap();
    for byte in (0..whole.len()).step_by(whole.len() / 6) {
        let mut flipped = whole.clone();
        flipped[byte] ^= 16;
        fs::write(at.path().join("s"), flipped).unwrap();
        let line = fails(at.path(), &with(&deferred), 1);
        assert!(line.contains("s: ") && line.lines().count() == 1, "{line}");
    }
}

#[test]
fn a_picture_of_backs_points_at_culling() {
    let at = TempDir::new().unwrap();
    let from_behind = ["render", "sheets", "--count", "200", "--size", "16x12", "--eye", "0,0,-9"];
    let towards = ["--target", "0,0,0", "--cull=on", "-o", "a.exr"];
    let shown = succeeds(at.path(), &[&from_behind[..], &towards].concat());
    assert!(shown.contains("face away from the camera") && shown.contains("--cull=off"), "{shown}");
}
