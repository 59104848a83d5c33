//! Tests the program as a person meets it: exit codes, errors of one line, and files that are
//! either whole or not there.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod cameras;
mod compare;
mod conformance;
mod damage;
mod foreign;
mod gaussians;
mod golden;
mod groups;
mod guide;
mod hierarchy;
#[cfg(unix)]
mod interrupts;
mod memory;
mod moving;
mod one_file;
mod pictures;
mod plan;
mod primitives;
#[cfg(target_os = "linux")]
mod progress;
mod project;
mod projections;
mod quality;
mod refusals;
mod regions;
mod reports;
mod sequence;
mod stereo;
mod study;
mod surfels;
mod tiles;
mod verify;

use splatref::frame::image::{Image, Values};
use splatref::io::exr;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// What the program did in a directory.
fn splatref(directory: &Path, arguments: &[&str]) -> Output {
    let program = Path::new(env!("CARGO_BIN_EXE_splatref"));
    let mut command = Command::new(program);
    // A command that `splatref conformance` runs may be splatref itself.
    let own = program.parent().map(Path::to_owned);
    let others = std::env::var_os("PATH").unwrap_or_default();
    let path = own.into_iter().chain(std::env::split_paths(&others));
    command.env("PATH", std::env::join_paths(path).unwrap());
    command.current_dir(directory).args(arguments).output().expect("the program starts")
}

/// Asserts success without complaint; what it printed.
fn succeeds(directory: &Path, arguments: &[&str]) -> String {
    let output = splatref(directory, arguments);
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), complaint.as_ref()), (Some(0), ""), "{arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Asserts an exit code and exactly one line of complaint; the line.
fn fails(directory: &Path, arguments: &[&str], code: i32) -> String {
    let output = splatref(directory, arguments);
    let complaint = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {complaint}");
    assert!(complaint.starts_with("splatref: ") && complaint.ends_with('\n'), "{complaint}");
    assert_eq!(complaint.lines().count(), 1, "{arguments:?}: {complaint}");
    complaint
}

/// The names in a directory, hidden ones too.
fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let mut names: Vec<String> =
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn floats(image: &Image, name: &str) -> Vec<f32> {
    match image.channel(name) {
        Some(Values::Float(values)) => values.clone(),
        _ => panic!("no floats {name}"),
    }
}

fn indices(image: &Image, name: &str) -> Vec<u32> {
    match image.channel(name) {
        Some(Values::Index(values)) => values.clone(),
        _ => panic!("no indices {name}"),
    }
}

/// The arguments for a small picture of a shape, and more.
fn small<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let size: &[&str] = if more.contains(&"--size") { &[] } else { &["--size", "32x24"] };
    [&["render", "sphere", "--count", "300"], size, more].concat()
}

/// Swaps one bit of the depth of the pixel in the middle, in a file of the same planes.
fn flip_a_bit(path: &Path) {
    use splatref::frame::{Frame, NamedPlane, Plane, Samples};
    let image = exr::read(path).unwrap();
    let (width, height) = (image.width, image.height);
    let planes = image.channels.into_iter().map(|(name, values)| {
        let samples = match values {
            Values::Index(values) => Samples::Index(Plane::from_values(width, height, values)),
            Values::Float(mut values) => {
                if name == "Z" {
                    let middle = values.len() / 2 + width as usize / 2;
                    values[middle] = f32::from_bits(values[middle].to_bits() ^ 1);
                }
                Samples::Scalar(Plane::from_values(width, height, values))
            }
        };
        NamedPlane { name, samples }
    });
    let frame = Frame { width, height, planes: planes.collect() };
    exr::write(path, &frame, &image.text.unwrap_or_default()).unwrap();
}
