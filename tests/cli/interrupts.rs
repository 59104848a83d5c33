//! Signals in the middle of writing.

use super::*;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Stdio};
use tempfile::TempDir;

/// A picture that takes a while to be written, when the first byte of it is.
fn writing(at: &TempDir, command: &mut Command) -> Child {
    let options = ["--count", "1000", "--size", "2048x2048", "--stages", "-o", "a.exr"];
    let mut child = command
        .current_dir(at.path())
        .args(["render", "sphere"])
        .args(options)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    while !names(at.path()).iter().any(|name| name.ends_with(".partial")) {
        assert_eq!(child.try_wait().unwrap(), None, "it has ended");
    }
    child
}

fn send(signal: i32, child: &Child) {
    let sent = Command::new("kill").arg(format!("-{signal}")).arg(child.id().to_string()).status();
    assert!(sent.unwrap().success());
}

/// Whether this process, and so what it starts, ignores a signal: tests may run under `nohup`, or in
/// the background of a shell.
fn is_ignored(signal: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() >> (signal - 1) & 1 == 1)
}

#[test]
fn a_signal_leaves_no_partial_file() {
    let (ignored, signals): (Vec<_>, Vec<_>) = [1, 2, 15].into_iter().partition(|s| is_ignored(*s));
    println!("skipped, as this process ignores them: {ignored:?}");
    assert!(signals.contains(&15), "SIGTERM is ignored by nobody");
    for signal in signals {
        let at = TempDir::new().unwrap();
        fs::write(at.path().join("a.exr"), "old").unwrap();
        let mut child = writing(&at, &mut Command::new(env!("CARGO_BIN_EXE_splatref")));
        send(signal, &child);
        assert_eq!(child.wait().unwrap().signal(), Some(signal));
        assert_eq!(names(at.path()), ["a.exr"], "signal {signal}");
        assert_eq!(fs::read(at.path().join("a.exr")).unwrap(), b"old");
    }
}

/// A folder is made before the surfels are sorted into it.
#[test]
fn a_signal_leaves_no_empty_folder() {
    let at = TempDir::new().unwrap();
    let cloud = splatref::source::Shape::Torus.surfels(1_000_000, 0).unwrap().into_cloud();
    splatref::io::ply::write(&at.path().join("torus.ply"), &cloud).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_splatref"));
    let tile = program.current_dir(at.path()).args(["tile", "torus.ply", "-o", "torus"]);
    let mut child = tile.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while !at.path().join("torus").exists() {
        assert_eq!(child.try_wait().unwrap(), None, "it has ended");
    }
    send(15, &child);
    assert_eq!(child.wait().unwrap().signal(), Some(15));
    assert_eq!(names(at.path()), ["torus.ply"]);
}

/// `ulimit -f` stands for a full disk, which a test cannot have without rights of its own.
#[test]
fn a_file_that_cannot_grow_is_an_error_and_leaves_nothing() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let torus = ["render", "torus", "--count", "300", "--size", "300x200"];
    let halves =
        [["--region", "0,0,300,90", "-o", "a.exr"], ["--region", "0,90,300,200", "-o", "b.exr"]];
    halves.iter().for_each(|half| drop(succeeds(at, &[&torus[..], half].concat())));
    let cloud = splatref::source::Shape::Torus.surfels(3000, 0).unwrap().into_cloud();
    splatref::io::ply::write(&at.join("torus.ply"), &cloud).unwrap();
    let before = names(at);
    for arguments in [
        &[&torus[..], &["-o", "c.exr"]].concat()[..],
        &[&torus[..], &["--region", "0,0,300,90", "-o", "c.exr"]].concat(),
        &[&torus[..], &["--bands", "4", "-o", "c.exr"]].concat(),
        &["assemble", "a.exr", "b.exr", "-o", "c.exr"],
        &["tile", "torus.ply", "-o", "c"],
    ] {
        let mut shell = Command::new("sh");
        shell.args(["-c", "ulimit -f 16; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_splatref")]);
        let output = shell.current_dir(at).args(arguments).output().unwrap();
        let line = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {line} {:?}", output.status);
        assert!(line.starts_with("splatref: c") && line.lines().count() == 1, "{line}");
        assert_eq!(names(at), before, "{arguments:?}");
    }
}

/// As under `nohup`.
#[cfg(target_os = "linux")]
#[test]
fn a_signal_that_is_ignored_stays_ignored() {
    let at = TempDir::new().unwrap();
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' HUP; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_splatref")]);
    let mut child = writing(&at, &mut shell);
    send(1, &child);
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert_eq!(names(at.path()), ["a.exr", "a.png"]);
}
