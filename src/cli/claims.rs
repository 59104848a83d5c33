//! `splatref study claims`: measures what the papers claim.

use super::options::ExecOptions;
use super::{Ended, Ending, progress, report, say};
use splatref::Error;
use splatref::io::png;
use splatref::io::replace::write_atomically;
use splatref::io::scene_file::SceneFile;
use splatref::study::claims::{FORMATS, Files, PICTURES, claims, outcome, page, verdicts};
use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

#[derive(clap::Args)]
#[command(after_help = "\
Writes claims.md, and pictures beside it in claims/.

Examples:
  splatref study claims
  splatref study claims bunny.ply dragon.ply -o docs")]
pub(super) struct Args {
    /// Measure these scans too: scenes of surfels
    scans: Vec<PathBuf>,
    /// Write the files into this folder; it is made if it does not exist
    #[arg(short, long, value_name = "DIR", default_value = "out/study")]
    output: PathBuf,
    #[command(flatten)]
    exec: ExecOptions,
}

pub(super) fn run(args: &Args) -> Ended {
    let start = Instant::now();
    let exec = args.exec.exec()?;
    let scans = args.scans.iter().map(|path| SceneFile::open(path.as_path()));
    let scans = scans.collect::<splatref::Result<Vec<_>>>()?;
    let folder = args.output.join(PICTURES);
    fs::create_dir_all(&folder).map_err(|source| Error::io(&folder, source))?;
    let steps = progress::Steps::new("measuring");
    let verdicts = verdicts(&claims(), &scans, &FORMATS, &exec, &|what, done, of| {
        steps.show(what, done, of);
    })?;
    steps.show("writing", 0, 1);
    let names: Vec<&str> = scans.iter().map(|scan| scan.name.as_str()).collect();
    let Files { text, pictures } = page(&verdicts, &names);
    for (id, picture) in &pictures {
        png::write(&folder.join(id).with_extension("png"), picture, None)?;
    }
    let path = args.output.join("claims.md");
    write_atomically(&path, |file| file.write_all(text.as_bytes()))?;
    drop(steps);
    for verdict in &verdicts {
        say(format!("{:<16} {:<7} {}", verdict.of.id, outcome(verdict), verdict.of.says));
    }
    report::line("page", path.display());
    report::time("total", vec![start.elapsed()]);
    Ok(Ending::Good)
}
