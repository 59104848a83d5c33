mod damaged;
mod laws;
mod loaded;
mod near;
mod resumed;
mod view;

use super::build::Work;
use super::*;
use crate::error::Result;
use crate::frame::Exec;
use crate::io::ply;
use crate::io::scene_file::SceneFile;
use crate::scene::Cloud;
use crate::source::hierarchy::{Settings, Traversal};
use glam::Vec3;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A sphere of radius 1 with 2 n n triangles, as a grid on a cube's outline, so that rows stay away
/// from the poles.
fn sphere(n: u32, colored: bool) -> Cloud {
    let mut mesh = Cloud::default();
    for row in 0..=n {
        for column in 0..n {
            // A point of a cube's outline, on the sphere.
            let t = 4.0 * column as f32 / n as f32;
            let (side, along) = (t.floor() as u32, 2.0 * (t - t.floor()) - 1.0);
            let (x, y) =
                [(1.0, along), (-along, 1.0), (-1.0, -along), (along, -1.0)][side as usize % 4];
            let z = 1.8 * (row as f32 / n as f32 - 0.5);
            mesh.position.push(Vec3::new(x, y, z).normalize());
        }
    }
    for row in 0..n {
        for column in 0..n {
            let at = |r: u32, c: u32| r * n + c % n;
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
            mesh.triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    mesh.color = colored.then(|| mesh.position.iter().map(|p| p.abs()).collect());
    mesh
}

/// A folder with a mesh, a small one, and a scene of both.
fn given() -> TempDir {
    let at = TempDir::new().unwrap();
    ply::write(&at.path().join("mesh.ply"), &sphere(80, true)).unwrap();
    ply::write(&at.path().join("small.ply"), &sphere(15, false)).unwrap();
    let scene = "\
[[geometry]]
name = \"ball\"
file = \"mesh.ply\"
[[geometry]]
name = \"pea\"
file = \"small.ply\"
[[object]]
of = \"ball\"
[[object]]
of = \"ball\"
transform = { translate = [10, 0, 0], scale = 2 }
color = [0, 1, 0]
[[object]]
of = \"pea\"
transform = { translate = [0, 10, 0] }
[[object]]
of = \"pea\"
transform = { translate = [0, 13, 0], rotate = { axis = [0, 1, 0], degrees = 30 } }
[[object]]
of = \"pea\"
transform = { translate = [3, 10, 0] }
";
    fs::write(at.path().join("scene.toml"), scene).unwrap();
    at
}

/// Settings that are quick to compute.
fn quick(traversal: Traversal) -> Settings {
    Settings { most: 700, side: 512, traversal, ..Settings::default() }
}

fn quiet(_: &str, _: u64, _: u64) {}

/// Makes the hierarchy of a file in a folder into another folder.
fn make(at: &TempDir, scene: &str, to: &str, settings: &Settings) -> Result<Built> {
    let file = SceneFile::open(at.path().join(scene)).unwrap();
    file.approximate(&at.path().join(to), settings, &Exec::sequential(), &quiet)
}

/// The bytes of all files of a folder.
fn bytes(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries.map(|e| (e.file_name().into_string().unwrap(), fs::read(e.path()).unwrap())).collect()
}
