//! `splatref study failures`: writes the atlas of failures.

use super::options::ExecOptions;
use super::{Ended, Ending, progress, report, say};
use splatref::io::png;
use splatref::io::replace::write_atomically;
use splatref::study::atlas::{Curve, Failure, Files, PICTURES, failures, page};
use splatref::{Error, Result};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(clap::Args)]
#[command(after_help = "\
Writes atlas.md, and charts and pictures beside it in atlas/.

Examples:
  splatref study failures
  splatref study failures --only eps-sheets -o out/eps")]
pub(super) struct Args {
    /// Write the files into this folder; it is made if it does not exist
    #[arg(short, long, value_name = "DIR", default_value = "out/study")]
    output: PathBuf,
    /// Measure only the failure with this name
    #[arg(long, value_name = "NAME", value_parser = named)]
    only: Option<&'static Failure>,
    #[command(flatten)]
    exec: ExecOptions,
}

pub(super) fn run(args: &Args) -> Ended {
    let start = Instant::now();
    let exec = args.exec.exec()?;
    let folder = args.output.join(PICTURES);
    fs::create_dir_all(&folder).map_err(|source| Error::io(&folder, source))?;
    let steps = progress::Steps::new("measuring");
    let all = args.only.map_or_else(failures, |only| vec![only]);
    let mut curves = Vec::new();
    for failure in all {
        let curve = failure.curve(&exec, &|done, of| steps.show(failure.id, done, of))?;
        let cost = curve.breaks.map(|at| failure.cost(at, &exec)).transpose()?.flatten();
        curves.push((curve, cost));
    }
    steps.show("writing", 0, 1);
    let path = publish(&args.output, &page(&curves))?;
    drop(steps);
    curves.iter().for_each(|(curve, _)| print(curve));
    report::line("page", path.display());
    report::time("total", vec![start.elapsed()]);
    Ok(Ending::Good)
}

/// Writes the charts, the pictures and the page, and returns the path of the page.
fn publish(folder: &Path, files: &Files) -> Result<PathBuf> {
    let beside = |id: &str, end: &str| folder.join(PICTURES).join(id).with_extension(end);
    let text =
        |path: &Path, text: &str| write_atomically(path, |file| file.write_all(text.as_bytes()));
    for (id, chart) in &files.charts {
        text(&beside(id, "svg"), &chart.svg())?;
    }
    for (id, picture) in &files.pictures {
        png::write(&beside(id, "png"), picture, None)?;
    }
    let page = folder.join("atlas.md");
    text(&page, &files.text)?;
    Ok(page)
}

fn print(curve: &Curve) {
    let Failure { id, swept, values, .. } = curve.of;
    match curve.breaks {
        Some(at) => {
            let [error, cured] =
                [&curve.plain, &curve.cured].map(|errors| report::short(errors[at]));
            say(format!("{id:<20} breaks at {} ({swept}): {error}, cured {cured}", values[at]));
        }
        None => say(format!("{id:<20} does not break")),
    }
}

/// Finds a failure by its name.
fn named(name: &str) -> std::result::Result<&'static Failure, String> {
    let all = failures();
    all.iter().find(|failure| failure.id == name).copied().ok_or_else(|| {
        let names: Vec<&str> = all.iter().map(|failure| failure.id).collect();
        format!("give one of {}", names.join(", "))
    })
}
