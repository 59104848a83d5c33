//! Check files of every kind against numbers computed by hand.

mod arrays;
mod depths;
mod normals;
mod pictures;
mod planes;
mod refused;

use super::*;
use crate::frame::Samples;
use crate::method::Method;
use crate::verdict::client::{Rounding, Storage, Ties};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// A folder of files.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn with(self, name: &str, bytes: &[u8]) -> Self {
        fs::write(self.path(name), bytes).unwrap();
        self
    }

    /// The client of a TOML file in the folder, with a camera of 2 x 2 pixels.
    fn read(&self, toml: &str) -> Result<Client> {
        fs::write(self.path("mine.toml"), toml).unwrap();
        self.open("mine.toml")
    }

    fn open(&self, name: &str) -> Result<Client> {
        let ewa = Method::by_name("ewa").unwrap();
        read(&self.path(name), ewa.stages(), [2, 2], &Exec::sequential())
    }

    /// The one line of the refusal.
    fn refusal(&self, toml: &str) -> String {
        let line = self.read(toml).unwrap_err().to_string();
        assert_eq!(line.lines().count(), 1, "{line}");
        line
    }
}

/// The bytes of numbers.
fn le<T: Copy, const N: usize>(values: &[T], bytes: fn(T) -> [u8; N]) -> Vec<u8> {
    values.iter().flat_map(|&v| bytes(v)).collect()
}

fn floats(values: &[f32]) -> Vec<u8> {
    le(values, f32::to_le_bytes)
}

fn scalars(client: &Client, name: &str) -> Vec<f64> {
    client.frame().scalar(name).unwrap().values().to_vec()
}

fn triples(client: &Client, name: &str) -> Vec<[f64; 3]> {
    match client.frame().plane(name) {
        Some(Samples::Color(plane) | Samples::Vector(plane)) => plane.values().to_vec(),
        other => panic!("{name}: {other:?}"),
    }
}

fn ids(client: &Client, name: &str) -> Vec<u32> {
    client.frame().index(name).unwrap().values().to_vec()
}

/// Asserts that numbers are equal up to rounding in f64.
#[track_caller]
fn near(found: &[f64], known: &[f64]) {
    assert_eq!(found.len(), known.len(), "{found:?}");
    for (found, known) in found.iter().zip(known) {
        let same = found == known || (found - known).abs() <= 1e-12 * known.abs();
        assert!(same, "{found:?} {known:?}");
    }
}

#[test]
fn the_example_of_the_documentation_is_read() {
    let read = Sidecar::parse(include_str!("../example.toml"), Path::new("at/mine.toml")).unwrap();
    assert_eq!(read.file, Some(PathBuf::from("at/frame.exr")));
    assert_eq!((read.rounding, read.ties), (Rounding::Gpu, Ties::Last));
    assert_eq!((read.accumulator, read.upwards), (Storage::Half, true));
    assert_eq!((read.size, read.depth.far), (Some([4, 3]), Some(f64::INFINITY)));
    let step = 1.0 / 16_777_215.0 + 1.0 / 2_097_152.0;
    assert_eq!(read.depth_test, Storage::DepthBuffer { step, near: 0.1, far: 100.0 });
    let names: Vec<&str> = read.planes.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["A", "RGB", "Z", "attributes.normal", "id"]);
    let id = &read.planes[4].1;
    assert_eq!(id.file, Some(PathBuf::from("at/id.npy")));
    let z = &read.planes[2].1;
    assert_eq!((z.offset, z.row_stride, z.pixel_stride), (Some(128), Some(256), None));
}

#[test]
fn the_defaults_and_the_words() {
    let at = Folder::new().with("z.raw", &floats(&[1.0, 2.0, 3.0, 4.0]));
    let client = at.read("[planes]\nZ = \"z.raw\"").unwrap();
    assert_eq!((client.rounding, client.ties), (Rounding::Gpu, Ties::Lowest));
    assert_eq!((client.accumulator, client.storage("Z")), (Storage::Single, Storage::Single));
    assert_eq!(scalars(&client, "Z"), [1.0, 2.0, 3.0, 4.0]);
    let said = "profile = \"ieee\"\naccumulator = \"f16\"\nties = \"any\"\norigin = \"bottom-left\"\n\
                [planes]\nZ = \"z.raw\"";
    let client = at.read(said).unwrap();
    assert_eq!((client.rounding, client.ties), (Rounding::Ieee, Ties::Any));
    assert_eq!(client.accumulator, Storage::Half);
    assert_eq!(scalars(&client, "Z"), [3.0, 4.0, 1.0, 2.0], "the upper row is the second");
    // The size in the file wins over the camera's size.
    let client = at.read("size = [1, 4]\n[planes]\nZ = \"z.raw\"").unwrap();
    assert_eq!((client.frame().width, client.frame().height), (1, 4));
}
