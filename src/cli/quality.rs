//! `splatref quality`: measures how evenly the prefixes of ordered points cover the surface.

use super::{Ended, Ending, output, progress, report, say, warn_of};
use splatref::frame::Exec;
use splatref::io::ply::ReadOptions;
use splatref::io::png;
use splatref::io::replace::write_atomically;
use splatref::io::scene_file::{FileKind, read_model};
use splatref::study::spread::{self, AtPrefix, MOST_ORDERS, MOST_PREFIXES, Ordered};
use splatref::{Error, Result};
use std::io::Write;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "\
Two figures are printed for each prefix:
  - the distance of each point to its nearest neighbour
  - the covering radius: the largest distance of any point to the prefix
Relative figures are divided by the largest least distance among the files at that prefix, so an exact
greedy order has 1.

Examples:
  splatref surfels bunny.ply -o greedy.ply
  splatref surfels bunny.ply -o random.ply --sampler random
  splatref quality greedy.ply random.ply --prefix 1000,5000,10000 -o violins.svg --spectrum")]
pub(super) struct Args {
    /// Points in their order: a .ply, .obj, .las, .laz or .e57 for each order
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Measure the first N points; several numbers measure several prefixes [default: all that
    /// every file has]
    #[arg(long, value_name = "N,N", value_delimiter = ',')]
    prefix: Vec<usize>,
    /// Measure how well a prefix covers the points of this file [default: its own file]
    #[arg(long, value_name = "FILE")]
    of: Option<PathBuf>,
    /// Write a chart: violins, and spectra with --spectrum
    #[arg(short, long, value_name = "FILE.svg|png")]
    output: Option<PathBuf>,
    /// Measure radial power spectra too; needs at least 256 points
    #[arg(long)]
    spectrum: bool,
    /// Use N threads; 0 uses every core
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
}

pub(super) fn run(args: &Args) -> Ended {
    args.check()?;
    let exec = Exec::new(args.threads, 32)?;
    let steps = progress::Steps::new("loading");
    let names = names(&args.files);
    let orders = args.files.iter().zip(names).map(|(path, name)| {
        let points = points(path, &exec)?;
        Ok(Ordered { name, points })
    });
    let orders = orders.collect::<Result<Vec<_>>>()?;
    let of = args.of.as_ref().map(|path| points(path, &exec)).transpose()?;
    let shortest = orders.iter().map(|order| order.points.len()).min().unwrap_or(0);
    let prefixes = if args.prefix.is_empty() { vec![shortest] } else { args.prefix.clone() };
    let show = |what: &str, done, of| steps.show(what, done, of);
    let found = spread::measure(&orders, of.as_deref(), &prefixes, args.spectrum, &exec, &show)?;
    let chart = args.output.as_ref().map(|_| spread::chart(&found)).transpose()?;
    drop(steps);

    for order in &orders {
        report::line("points", format!("{} {}", order.points.len(), order.name));
    }
    if let (Some(path), Some(all)) = (&args.of, &of) {
        report::line("of", format!("{} {}", all.len(), path.display()));
    }
    table(&found);
    if let (Some(path), Some(chart)) = (&args.output, chart) {
        progress::during("writing", || write(path, &chart))?;
        report::line("file", path.display());
    }
    Ok(Ending::Good)
}

impl Args {
    /// Refuses wrong options before anything is read.
    fn check(&self) -> Result<()> {
        let refused = |path: &Path, what| Err(Error::Usage(format!("{}: {what}", path.display())));
        for path in self.files.iter().chain(&self.of) {
            if !FileKind::from_extension(path).is_ok_and(FileKind::is_model) {
                let what = "points are read from a .ply, .obj, .las, .laz or .e57; give one";
                return refused(path, what);
            }
        }
        if let Some(few) = self.prefix.iter().find(|prefix| **prefix < 2) {
            let what = format!("--prefix {few}: one point has no distance; give at least 2");
            return Err(Error::Usage(what));
        }
        let Some(output) = &self.output else { return Ok(()) };
        if kind(output).is_none() {
            return refused(output, "charts are written as .svg or .png; give such a name");
        }
        if self.files.len() > MOST_ORDERS || self.prefix.len() > MOST_PREFIXES {
            return Err(Error::Usage(format!(
                "a chart has room for {MOST_ORDERS} files and {MOST_PREFIXES} prefixes; give fewer"
            )));
        }
        output::check_folder(output)?;
        self.files.iter().chain(&self.of).try_for_each(|path| output::check_other(output, path))
    }
}

#[derive(Clone, Copy)]
enum Chart {
    Svg,
    Png,
}

fn kind(path: &Path) -> Option<Chart> {
    let end = path.extension()?.to_str()?;
    let is = |kind: &str| end.eq_ignore_ascii_case(kind);
    if is("svg") { Some(Chart::Svg) } else { is("png").then_some(Chart::Png) }
}

fn write(path: &Path, chart: &splatref::study::chart::Drawing) -> Result<()> {
    if let Some(Chart::Svg) = kind(path) {
        return write_atomically(path, |file| file.write_all(chart.svg().as_bytes()));
    }
    let picture = chart.picture().ok_or_else(|| Error::Invalid("the chart has no area".into()))?;
    png::write_codes(path, [picture.width, picture.height], &picture.pixels)
}

/// The stems of the files; a file whose stem is not unique keeps its whole name.
fn names(files: &[PathBuf]) -> Vec<String> {
    let stem = |path: &PathBuf| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let stems: Vec<_> = files.iter().map(stem).collect();
    let one = |(path, stem): (&PathBuf, &Option<String>)| match stem {
        Some(name) if stems.iter().filter(|other| *other == stem).count() == 1 => name.clone(),
        _ => path.display().to_string(),
    };
    files.iter().zip(&stems).map(one).collect()
}

/// The points of a file that holds only points.
fn points(path: &Path, exec: &Exec) -> Result<Vec<glam::Vec3>> {
    let mut cloud = read_model(path, &ReadOptions::default(), exec)?;
    warn_of(path, &mut cloud);
    if !cloud.triangles.is_empty() || !cloud.edges.is_empty() {
        let what = "the file has triangles or lines, but ordered points are needed; `splatref \
                    surfels` samples a mesh";
        return Err(Error::format(path, what));
    }
    if let Some(at) = cloud.position.iter().position(|point| !point.is_finite()) {
        let what = format!("point {at} is not finite, so it has no distance to others; remove it");
        return Err(Error::format(path, what));
    }
    Ok(cloud.position)
}

/// Prints distances in world units, then relative to each prefix.
fn table(found: &[AtPrefix]) {
    let width = found.iter().flat_map(|at| &at.spreads).map(|s| s.name.chars().count()).max();
    let width = width.unwrap_or(0).max(5);
    let head = ["least", "25 %", "median", "75 %", "covering"];
    let cells = |cells: &[String]| {
        cells.iter().map(|cell| format!(" {cell:>10}")).collect::<Vec<_>>().concat()
    };
    let row =
        |prefix: &str, name: &str, rest: String| say(format!("{prefix:>9}  {name:<width$}{rest}"));
    row("prefix", "order", cells(&head.map(str::to_owned)));
    for AtPrefix { prefix, spreads, .. } in found {
        for spread in spreads {
            let five = spread.five().map(report::short);
            row(&prefix.to_string(), &spread.name, cells(&five));
        }
    }
    say("relative to the largest least distance of each prefix:");
    for AtPrefix { prefix, unit, spreads } in found {
        for spread in spreads {
            let relative =
                |d: f64| if *unit > 0.0 { format!("{:.3}", d / unit) } else { "-".into() };
            row(&prefix.to_string(), &spread.name, cells(&spread.five().map(relative)));
        }
    }
    if found.iter().flat_map(|at| &at.spreads).any(|s| s.spectrum.is_some()) {
        spectra(found, &row, &cells);
    }
}

/// Prints the figures of the spectra, if there are any.
fn spectra(
    found: &[AtPrefix],
    row: &dyn Fn(&str, &str, String),
    cells: &dyn Fn(&[String]) -> String,
) {
    say(
        "spectra: least distance relative to the densest packing, power below the peak, the peak, \
         and its frequency:",
    );
    row("", "", cells(&["packing", "below", "peak", "at"].map(str::to_owned)));
    for AtPrefix { prefix, spreads, .. } in found {
        for spread in spreads {
            let Some(spectrum) = &spread.spectrum else { continue };
            let [at, peak] = spectrum.peak();
            let packing = spread.least() / spectrum.unit;
            let four = [packing, spectrum.below(), peak, at].map(|v| format!("{v:.3}"));
            row(&prefix.to_string(), &spread.name, cells(&four));
        }
    }
}
