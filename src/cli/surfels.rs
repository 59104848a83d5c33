//! `splatref surfels`: points in a progressive order, into a PLY.

use super::{Ended, Ending, output, progress, report};
use splatref::frame::Exec;
use splatref::io::ply;
use splatref::io::scene_file::FileKind;
use splatref::scene::Cloud;
use splatref::source::sampler::{Greedy, Start};
use splatref::{Error, Result};
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(clap::Args)]
#[command(after_help = "\
Every prefix of the points that are written is spread over all of them. The samplers:
  greedy  each point is the one farthest from all before it, ties to the lower index; exact

Examples:
  splatref surfels scan.ply -o blue.ply
  splatref surfels scan.ply -o blue.ply --sampler greedy --start 3 --count 10000")]
pub(super) struct Args {
    /// A .ply of points
    points: PathBuf,
    /// Where the points go in their order, with all that the file has of them
    #[arg(short, long, value_name = "FILE.ply")]
    output: PathBuf,
    /// What puts the points in order
    #[arg(long, value_enum, default_value = "greedy")]
    sampler: Sampler,
    /// The index of the first point; else --seed chooses it
    #[arg(long, value_name = "N", conflicts_with = "seed")]
    start: Option<u32>,
    /// What the first point is chosen by [default: 0]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// How many points at most [default: all]
    #[arg(long, value_name = "N")]
    count: Option<usize>,
    /// Threads; 0 takes every core
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Sampler {
    Greedy,
}

pub(super) fn run(args: &Args) -> Ended {
    args.check()?;
    let exec = Exec::new(args.threads, 32)?;
    let steps = progress::Steps::new("loading");
    let cloud = ply::read_with(&args.points, &exec)?;
    points_alone(&cloud, &args.points)?;
    let all = cloud.position.len();
    let show = |what: &str, done, of| steps.show(what, done, of);
    let start = Instant::now();
    let first = args.start.map_or(Start::Seed(args.seed.unwrap_or(0)), Start::Index);
    let order = match args.sampler {
        Sampler::Greedy => {
            Greedy { start: first }.order(&cloud.position, args.count.unwrap_or(all), &exec, &show)
        }
    };
    let order = order.map_err(|error| Error::format(&args.points, error.to_string()))?;
    let time = start.elapsed();
    let cloud = cloud.some(&order.index);
    drop(steps);

    report::line("points", all);
    report::line(
        "order",
        format!("greedy, {} of them, from point {}", order.index.len(), order.index[0]),
    );
    if let [_, .., last] = order.distance[..] {
        let apart = report::short(f64::from(last).sqrt());
        report::line("apart", format!("{apart} at least, in world units"));
    }
    report::line("time", format!("{:.2} s", time.as_secs_f64()));
    progress::during("writing", || ply::write(&args.output, &cloud))?;
    report::line("file", args.output.display());
    Ok(Ending::Good)
}

impl Args {
    /// What is refused before anything is read.
    fn check(&self) -> Result<()> {
        if self.count == Some(0) {
            return Err(Error::Usage("--count 0 leaves no point; give at least 1".into()));
        }
        for path in [&self.points, &self.output] {
            if !matches!(FileKind::of(path), Ok(FileKind::Ply)) {
                let path = path.display();
                let what = format!(
                    "{path}: points are read from a PLY and go into one; give a name in .ply"
                );
                return Err(Error::Usage(what));
            }
        }
        output::check_folder(&self.output)?;
        output::check_other(&self.output, &self.points)
    }
}

/// Whether a file has no more than points.
fn points_alone(cloud: &Cloud, path: &Path) -> Result<()> {
    let has = match (cloud.triangles.len(), cloud.edges.len()) {
        (0, 0) => return Ok(()),
        (0, edges) => format!("{edges} edges"),
        (triangles, _) => format!("{triangles} triangles"),
    };
    let what = format!("the file has {has}, but only points are put in order yet");
    Err(Error::format(path, what))
}
