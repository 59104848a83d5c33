//! What would take more memory than there may be is refused in one line, before it is taken.

use super::*;
use splatref::frame::{Frame, Plane, Samples};
use tempfile::TempDir;

/// Small files and short arguments that ask for much.
fn greedy(at: &TempDir) -> Vec<(Vec<&'static str>, &'static str)> {
    let zeros = Samples::Scalar(Plane::filled(4000, 2000, 0.0));
    let frame = Frame::new(4000, 2000).with("R", zeros.clone()).unwrap();
    let frame = frame.with("G", zeros.clone()).unwrap().with("B", zeros).unwrap();
    exr::write(&at.path().join("zeros.exr"), &frame, "").unwrap();
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 1000000\n\
                  property uchar x\nproperty uchar y\nproperty uchar z\nend_header\n";
    let body: Vec<u8> = (0..3_000_000_u32).map(|i| (i.wrapping_mul(i) >> 7) as u8).collect();
    fs::write(at.path().join("bytes.ply"), [header.as_bytes(), &body].concat()).unwrap();
    vec![
        (vec!["compare", "zeros.exr", "zeros.exr"], "a picture of 4000 x 2000 pixels, 3 channels"),
        (vec!["render", "sphere", "--environment", "zeros.exr"], "zeros.exr: a picture of 4000"),
        (vec!["render", "bytes.ply"], "bytes.ply: a cloud of 1000000 points"),
        (vec!["render", "sphere", "--count", "3000000"], "sphere: 3000000 surfels"),
        (
            vec!["render", "sphere", "--count", "9", "--size", "4000x4000"],
            "4000 x 4000 pixels by ewa",
        ),
        (
            vec!["render", "sphere", "--count", "9", "--size", "2000x2000", "--stages"],
            "2000 x 2000 pixels by ewa",
        ),
        (vec!["explain", "sphere", "9", "9", "--count", "3000000"], "sphere: 3000000 surfels"),
        (vec!["group", "sphere", "--count", "400000", "-o", "g.ply"], "groups of 400000 surfels"),
    ]
}

#[cfg(target_os = "linux")] // elsewhere what is in use is not known
#[test]
fn what_takes_too_much_is_refused() {
    let at = TempDir::new().unwrap();
    for (arguments, what) in greedy(&at) {
        let line = fails(at.path(), &[&arguments[..], &["--memory", "96M"]].concat(), 1);
        assert!(line.contains(what) && line.contains("the limit is 96 MiB"), "{line}");
    }
    assert_eq!(names(at.path()), ["bytes.ply", "zeros.exr"]);
    let succeeds = |arguments: &[&str]| {
        let output = splatref(at.path(), arguments);
        let complaint = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {complaint}");
    };
    succeeds(&["compare", "zeros.exr", "zeros.exr", "--memory", "2G"]);
    succeeds(&small(&["-o", "a.exr", "--memory", "96M"]));
    // The second picture is drawn in the memory of the first, and takes no more.
    let twice = ["--size", "1000x800", "--repeat", "2", "-o", "a.exr", "--memory", "96M"];
    succeeds(&small(&twice));
}

/// Found in the header, so that no memory of the machine is too small for the reason to be told.
#[test]
fn an_environment_that_is_no_map_is_not_read() {
    let at = TempDir::new().unwrap();
    let zeros = Samples::Scalar(Plane::filled(3000, 2000, 0.0));
    let frame = Frame::new(3000, 2000).with("R", zeros).unwrap();
    exr::write(&at.path().join("square.exr"), &frame, "").unwrap();
    let options = ["--environment", "square.exr", "--memory", "32M"];
    let line = fails(at.path(), &small(&options), 1);
    assert!(line.contains("a map of 3000 x 2000 pixels"), "{line}");
}
