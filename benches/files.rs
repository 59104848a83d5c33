//! How long files take: pictures written and read, clouds read.
//!
//! `cargo bench --bench files` prints Markdown, and with `--write` puts the tables into
//! `docs/speed.md`; an argument is a pattern that the names of rows must contain. Pictures are of
//! 1 M surfels on a sphere, 1024 x 1024, by the method `ewa`. "All" is what `render` calls writing:
//! the EXR, the PNG and the hash of the scene. Files are in a temporary folder and, where there is
//! memory for it, never leave it. A row is the median and the minimum of at least 9 runs.

mod common;

use common::report::{Arguments, Table};
use common::sphere::{STANDARD, camera, cell, sphere};
use splatref::frame::{Exec, Frame};
use splatref::io::exr::{self, Compression};
use splatref::io::replace::Pending;
use splatref::io::{ply, png, provenance};
use splatref::method::{Method, Session};
use splatref::scene::{Scene, Surfels};
use splatref::setting::Words;
use splatref::{Error, Result};
use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

fn main() -> Result<()> {
    let arguments = Arguments::parse()?;
    let exec = Exec::new(0, 32)?;
    let folder = tempfile::tempdir().map_err(|error| Error::Invalid(error.to_string()))?;
    pictures(&arguments, folder.path(), &exec)?;
    clouds(&arguments, folder.path(), &exec)
}

/// Pictures with the planes of a picture, and of every stage, compressed in every way.
fn pictures(arguments: &Arguments, folder: &Path, exec: &Exec) -> Result<()> {
    let mut table = Table::new(&["planes", "compression", "EXR, ms", "all, ms", "MB", "read, ms"]);
    let scene = Scene::lit("sphere", sphere(&STANDARD[2]));
    let method = Method::by_name("ewa")?;
    for stages in [false, true] {
        let mut session = Session::new(&scene, method, exec)?;
        let frame = match stages {
            false => session.render(&camera())?.frame.clone(),
            true => session.define::<f32>(&camera(), true)?.frame,
        };
        let planes = format!("{}{}", frame.channels().len(), if stages { ", stages" } else { "" });
        for (name, compression) in Compression::WORDS {
            let row = format!("{planes} | {name}");
            if row.contains(&arguments.pattern) {
                let cells = picture(folder, &frame, &scene, &method, *compression, exec)?;
                table.row(&format!("{row} | {cells}"));
            }
        }
    }
    table.publish_times(arguments, "speed.md", "files")
}

/// The cells of a picture.
fn picture(
    folder: &Path,
    frame: &Frame<f32>,
    scene: &Scene,
    method: &Method,
    compression: Compression,
    exec: &Exec,
) -> Result<String> {
    let (large, small) = (folder.join("picture.exr"), folder.join("picture.png"));
    let exr = measured(|| exr::pending(&large, frame, "", compression, exec)?.put())?;
    let all = measured(|| {
        let text = || provenance::text(scene, None, &camera(), method, Default::default());
        let (small, large) = exec.join(
            || png::pending_frame(&small, frame),
            || exr::pending(&large, frame, &text(), compression, exec),
        );
        large?.put()?;
        small?.map_or(Ok(()), Pending::put)
    })?;
    let read = measured(|| exr::read_with(&large, exec))?;
    let bytes = std::fs::metadata(&large).map_err(|error| Error::io(&large, error))?.len();
    Ok(format!("{exr} | {all} | {:.1} | {read}", bytes as f64 / 1e6))
}

/// Binary clouds of floats and colours of 8 bits, and the surfels of them.
fn clouds(arguments: &Arguments, folder: &Path, exec: &Exec) -> Result<()> {
    let mut table = Table::new(&["PLY of surfels", "MB", "read, ms", "checked, ms"]);
    for (count, name) in [(1_000_000, "1 M"), (10_000_000, "10 M")] {
        if !name.contains(&arguments.pattern) {
            continue;
        }
        let path = folder.join("cloud.ply");
        cloud(&path, count).map_err(|error| Error::io(&path, error))?;
        let read = measured(|| ply::read_with(&path, &ply::ReadOptions::default(), exec))?;
        let whole = ply::read_with(&path, &ply::ReadOptions::default(), exec)?;
        let mut checks = Vec::new();
        while checks.len() < 9 {
            let cloud = whole.clone();
            let start = Instant::now();
            let surfels = Surfels::new(cloud)?;
            checks.push(start.elapsed());
            drop(surfels);
        }
        let bytes = std::fs::metadata(&path).map_err(|error| Error::io(&path, error))?.len();
        let megabytes = bytes as f64 / 1e6;
        table.row(&format!("{name} | {megabytes:.0} | {read} | {}", cell(&mut checks)));
    }
    table.publish_times(arguments, "speed.md", "clouds")
}

/// A file of 31 bytes a surfel: position, normal, radius, and a colour of 8 bits.
fn cloud(path: &Path, count: usize) -> std::io::Result<()> {
    let mut out = std::io::BufWriter::new(std::fs::File::create(path)?);
    write!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {count}\n")?;
    for name in ["x", "y", "z", "nx", "ny", "nz", "radius"] {
        writeln!(out, "property float {name}")?;
    }
    for name in ["red", "green", "blue"] {
        writeln!(out, "property uchar {name}")?;
    }
    writeln!(out, "end_header")?;
    for i in 0..count {
        let step = i as f32 / count as f32;
        for value in [step, 1.0 - step, step * step, 0.6, 0.0, -0.8, 0.001 + step] {
            out.write_all(&value.to_le_bytes())?;
        }
        out.write_all(&(i as u32).to_le_bytes()[..3])?;
    }
    out.flush()
}

/// Median and minimum of at least 9 runs; what they make is given back when the clock has stopped.
fn measured<T>(mut run: impl FnMut() -> Result<T>) -> Result<String> {
    let (mut times, begin): (Vec<Duration>, _) = (Vec::new(), Instant::now());
    while times.len() < 9 || (times.len() < 101 && begin.elapsed().as_secs() < 2) {
        let start = Instant::now();
        let made = run()?;
        times.push(start.elapsed());
        drop(made);
    }
    Ok(cell(&mut times))
}
