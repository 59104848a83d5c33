//! What a picture costs in one piece, and in 64 regions, each drawn by a process of its own.
//!
//! `cargo bench --bench regions` prints Markdown, and with `--write` puts the table into `docs/regions.md`; an
//! argument is a pattern that the rows must contain. The scene is a torus of surfels with colours, as a PLY
//! of 40 bytes a surfel, and as the folder that `splatref tile` makes of it. Every round draws once the file, the
//! folder and all regions by `ewa`. Columns are processor seconds of the processes, medians over the rounds. A
//! ratio is the median over the rounds. Linux alone tells these times.

mod common;

use common::report::{Arguments, Table};
use glam::Vec3;
use splatref::io::ply;
use splatref::source::Shape;
use splatref::{Error, Result};
use std::path::Path;
use std::process::Command;

const ROUNDS: usize = 3;
/// Regions in a row, and rows.
const SIDE: usize = 8;

fn main() -> Result<()> {
    let arguments = Arguments::parse()?;
    let folder = tempfile::tempdir().map_err(|error| Error::Invalid(error.to_string()))?;
    let at = folder.path();
    let mut table = Table::new(&[
        "surfels",
        "pixels",
        "file, s",
        "folder, s",
        "64 regions, s",
        "of the folder",
        "of the file",
    ]);
    for count in [1_000_000, 4_000_000, 16_000_000] {
        let sizes = [2048, 4096, 8192].map(|size| (size, format!("{count} | {size} x {size}")));
        if sizes.iter().all(|(_, row)| !row.contains(&arguments.pattern)) {
            continue;
        }
        torus(at, count)?;
        for (size, row) in sizes {
            if row.contains(&arguments.pattern) {
                table.row(&format!("{row} | {}", cells(at, size)?));
            }
        }
    }
    table.publish_times(&arguments, "regions.md", "regions")
}

/// Writes `torus.ply`, and tiles it into `torus`.
fn torus(at: &Path, count: usize) -> Result<()> {
    let mut cloud = Shape::Torus.surfels(count, 0)?.into_cloud();
    let color = |normal: &Vec3| 0.5 * (*normal + Vec3::ONE);
    cloud.color = cloud.normal.as_ref().map(|normals| normals.iter().map(color).collect());
    ply::write(&at.join("torus.ply"), &cloud)?;
    seconds(at, &["tile", "torus.ply", "-o", "torus"]).map(|_| ())
}

/// The cells of a picture with `size` pixels a side.
fn cells(at: &Path, size: usize) -> Result<String> {
    let pixels = format!("{size}x{size}");
    let draw = |scene: &str, more: &[&str]| {
        let render = ["render", scene, "--size", &pixels, "-o", "picture.exr"];
        let time = seconds(at, &[&render, more].concat());
        // Replacing a file that is not on the disk yet takes time, which is not the picture's.
        for name in std::fs::read_dir(at).into_iter().flatten().flatten() {
            if name.file_name().to_string_lossy().starts_with("picture.") {
                std::fs::remove_file(name.path())
                    .map_err(|error| Error::io(&name.path(), error))?;
            }
        }
        time
    };
    let regions = || -> Result<f64> {
        let side = size / SIDE;
        let corners = (0..SIDE * SIDE).map(|i| (i % SIDE * side, i / SIDE * side));
        corners
            .map(|(x, y)| {
                draw("./torus", &["--region", &format!("{x},{y},{},{}", x + side, y + side)])
            })
            .sum()
    };
    let mut columns = [const { Vec::new() }; 5];
    for _ in 0..ROUNDS {
        let (file, folder, parts) = (draw("torus.ply", &[])?, draw("./torus", &[])?, regions()?);
        for (column, value) in
            columns.iter_mut().zip([file, folder, parts, parts / folder, parts / file])
        {
            column.push(value);
        }
    }
    let cells = columns.map(|mut column| {
        column.sort_by(f64::total_cmp);
        format!("{:.2}", column[ROUNDS / 2])
    });
    Ok(cells.join(" | "))
}

/// The processor seconds that a run of the program takes.
fn seconds(at: &Path, arguments: &[&str]) -> Result<f64> {
    let before = children()?;
    let mut program = Command::new(env!("CARGO_BIN_EXE_splatref"));
    let run = program.args(arguments).current_dir(at).output();
    let run = run.map_err(|error| Error::Invalid(error.to_string()))?;
    if !run.status.success() {
        return Err(Error::Invalid(String::from_utf8_lossy(&run.stderr).into_owned()));
    }
    Ok(children()? - before)
}

/// The processor seconds of all processes that this one has waited for, from proc(5).
fn children() -> Result<f64> {
    let path = Path::new("/proc/self/stat");
    let text = std::fs::read_to_string(path).map_err(|error| Error::io(path, error))?;
    // Behind the name of the program, which may hold blanks, `cutime` and `cstime` are the 14th and the 15th.
    let fields = text.rsplit(')').next().unwrap_or_default().split_whitespace().skip(13);
    // Linux has 100 ticks a second in this file, whatever its kernel's clock.
    Ok(fields.take(2).filter_map(|field| field.parse::<f64>().ok()).sum::<f64>() / 100.0)
}
