//! `splatref study`: measures every method and setting against the true picture and the clock.

use super::tried::Tried;
use super::{Ended, Ending, atlas, claims, output, progress, report, say};
use splatref::frame::{Exec, Frame};
use splatref::io::png;
use splatref::io::replace::write_atomically;
use splatref::io::scene_file::SceneFile;
use splatref::study::report::chart::chart;
use splatref::study::report::{csv, page};
use splatref::study::run::measure::{loss, losses, measure};
use splatref::study::run::truths::Truths;
use splatref::study::run::{Bench, LeftOut, Loss, Record, Setup, Study, Subject, time};
use splatref::study::sweep::Candidate;
use splatref::{Error, Result};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[derive(clap::Args)]
#[command(after_help = "\
Writes study.csv, study.json, chart.svg, chart.png, index.html and the pictures. Results are saved as
they come; rerun the command with --resume to resume a study that was stopped.

Examples:
  splatref study bunny.ply
  splatref study failures
  splatref study claims
  splatref study torus --method ewa --metric flip
  splatref study blue.ply --surfel-size 2 --truth bunny.ply -o out/blue
  splatref study scene.toml --time 60s")]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(super) struct Args {
    #[command(subcommand)]
    what: Option<What>,
    #[command(flatten)]
    tried: Tried,
    /// Write the files into this folder; it is made if it does not exist
    #[arg(short, long, value_name = "DIR", default_value = "out/study")]
    output: PathBuf,
    /// Plot this metric
    #[arg(long, value_name = "NAME", default_value = "rmse", value_parser = loss)]
    metric: Loss,
    /// Stop after this time, such as 60s or 5m: measure as many candidates as fit, then time them
    #[arg(long, value_name = "TIME", value_parser = span)]
    time: Option<Duration>,
    /// Resume the study in the folder
    #[arg(long)]
    resume: bool,
}

#[derive(clap::Subcommand)]
enum What {
    /// Write the atlas of failures: where each method breaks, and what cures it
    Failures(atlas::Args),
    /// Measure what the papers claim, and write a page
    Claims(claims::Args),
}

/// The fraction of the time that errors may take; the rest is for times.
const MEASURING: f64 = 0.7;

pub(super) fn run(args: &Args) -> Ended {
    match &args.what {
        Some(What::Failures(args)) => atlas::run(args),
        Some(What::Claims(args)) => claims::run(args),
        None => scene(args),
    }
}

fn scene(args: &Args) -> Ended {
    let start = Instant::now();
    let tried = &args.tried;
    let scene = tried.scene_file()?;
    let exec = tried.exec()?;
    let folder = Folder::make(args, &scene)?;
    let steps = progress::Steps::new("loading");
    let show = |what: &str, done, of| steps.show(what, done, of);
    let mut setup = tried.load(&scene, &exec, &steps)?;
    let truths = setup.known.pictures(&setup.camera, &exec, &show)?;
    let of = setup.subject(&truths, &exec)?;
    let Setup { mut bench, candidates, left_out, .. } = setup;
    let mut study = folder.begin(of, &candidates, left_out, args.resume, &exec)?;
    folder.keep_truth(&truths.still.frame)?;

    let job = Job { args, exec: &exec, folder: &folder, start, steps: &steps };
    job.measure(&mut bench, &candidates, &truths, &mut study)?;
    job.time(&mut bench, &candidates, &mut study)?;
    steps.show("writing", 0, 1);
    let files = folder.publish(&study, &args.metric)?;
    drop(steps);
    print(&study, &args.metric, start.elapsed());
    for (i, path) in files.iter().enumerate() {
        report::line(if i == 0 { "files" } else { "" }, path.display());
    }
    Ok(Ending::Good)
}

/// What the steps of a study share.
struct Job<'a> {
    args: &'a Args,
    exec: &'a Exec,
    folder: &'a Folder,
    start: Instant,
    steps: &'a progress::Steps,
}

impl Job<'_> {
    /// Measures the error of each candidate that has none, while there is time, and of the first in
    /// any case.
    fn measure(
        &self,
        bench: &mut Bench,
        candidates: &[Candidate],
        truths: &Truths,
        study: &mut Study,
    ) -> Result<()> {
        let late = self.args.time.map(|time| time.mul_f64(MEASURING));
        for (i, candidate) in candidates.iter().enumerate() {
            let record = &study.candidates[i];
            if record.measured.is_some() && self.folder.has_picture(record) {
                continue;
            }
            if i > 0 && late.is_some_and(|late| self.start.elapsed() >= late) {
                break;
            }
            self.steps.show("measuring", i as u64, candidates.len() as u64);
            let (measured, frame) = measure(bench, candidate, truths, self.exec)?;
            self.folder.keep_picture(record, &frame)?;
            study.candidates[i].measured = Some(measured);
            self.folder.keep(study)?;
        }
        Ok(())
    }

    /// Times all measured candidates, round by round.
    fn time(&self, bench: &mut Bench, candidates: &[Candidate], study: &mut Study) -> Result<()> {
        for round in 0..time::ROUNDS {
            let order = time::order(round, candidates.len());
            for (done, &i) in order.iter().enumerate() {
                let over = self.args.time.is_some_and(|time| self.start.elapsed() >= time);
                let Record { measured, times, .. } = &mut study.candidates[i];
                let timed = !candidates[i].imitates && measured.is_some();
                if !timed || over && !times.is_empty() {
                    continue;
                }
                let count = candidates.len() as u64;
                self.steps.show("timing", round * count + done as u64, time::ROUNDS * count);
                time::turn(bench, &candidates[i], round, times, self.exec)?;
            }
            self.folder.keep(study)?;
        }
        Ok(())
    }
}

/// The folder of a study.
struct Folder(PathBuf);

impl Folder {
    /// Makes the folder, and refuses it if the study would overwrite one of its inputs.
    fn make(args: &Args, scene: &SceneFile) -> Result<Self> {
        let folder = Self(args.output.clone());
        for name in FILES {
            output::check_unread(&folder.0.join(name), args.tried.path()?, scene)?;
        }
        if args.resume {
            let state = folder.0.join(STATE);
            fs::metadata(&state).map_err(|source| Error::io(&state, source))?;
        }
        let pictures = folder.0.join(PICTURES);
        fs::create_dir_all(&pictures).map_err(|source| Error::io(&pictures, source))?;
        Ok(folder)
    }

    /// An empty study, or with `resume` the study in the folder.
    fn begin(
        &self,
        of: Subject,
        candidates: &[Candidate],
        left_out: Vec<LeftOut>,
        resume: bool,
        exec: &Exec,
    ) -> Result<Study> {
        let study = Study {
            of,
            candidates: candidates.iter().map(Record::new).collect(),
            left_out: left_out.into_iter().map(|(method, why)| (method.to_owned(), why)).collect(),
            machine: time::machine(exec),
        };
        if !resume {
            return Ok(study);
        }
        let path = self.0.join(STATE);
        let bytes = fs::read(&path).map_err(|source| Error::io(&path, source))?;
        let before = serde_json::from_slice(&bytes)
            .map_err(|error| Error::format(&path, format!("not a study: {error}")))?;
        study.resumed(before).map_err(|error| Error::format(&path, error.to_string()))
    }

    /// Saves the results so far.
    fn keep(&self, study: &Study) -> Result<()> {
        let path = self.0.join(STATE);
        let text = serde_json::to_string_pretty(study)
            .map_err(|error| Error::format(&path, error.to_string()))?;
        write_atomically(&path, |file| writeln!(file, "{text}"))
    }

    fn picture(&self, record: &Record) -> PathBuf {
        self.0.join(PICTURES).join(record.picture_name())
    }

    fn has_picture(&self, record: &Record) -> bool {
        self.picture(record).is_file()
    }

    fn keep_picture(&self, record: &Record, frame: &Frame<f32>) -> Result<()> {
        png::write_frame(&self.picture(record), frame)
    }

    fn truth(&self) -> PathBuf {
        self.0.join(PICTURES).join("truth.png")
    }

    fn keep_truth(&self, frame: &Frame<f32>) -> Result<()> {
        png::write_frame(&self.truth(), frame)
    }

    /// Writes the table, the charts and the page, and returns their paths.
    fn publish(&self, study: &Study, loss: &Loss) -> Result<Vec<PathBuf>> {
        self.keep(study)?;
        let figures: Vec<&str> = losses().iter().map(|loss| loss.figure).collect();
        let paths = FILES.map(|name| self.0.join(name));
        let [page_path, svg, png, csv_path, _] = &paths;
        let text = |path: &Path, text: &str| {
            write_atomically(path, |file| file.write_all(text.as_bytes()))
        };
        text(csv_path, &csv::csv(study, &figures))?;
        let drawing = chart(study, loss);
        text(svg, &drawing.svg())?;
        let picture =
            drawing.picture().ok_or_else(|| Error::Invalid("the chart has no area".into()))?;
        png::write_codes(png, [picture.width, picture.height], &picture.pixels)?;
        let read = |path: PathBuf| fs::read(&path).map_err(|source| Error::io(&path, source));
        let pictures = study.candidates.iter().map(|record| match record.measured {
            Some(_) => read(self.picture(record)),
            None => Ok(Vec::new()),
        });
        let pictures = pictures.collect::<Result<Vec<_>>>()?;
        let page = page::page(study, &drawing, loss, &figures, &read(self.truth())?, &pictures);
        text(page_path, &page)?;
        Ok(paths.into())
    }
}

/// The results so far; the last of the files.
const STATE: &str = "study.json";
const FILES: [&str; 5] = ["index.html", "chart.svg", "chart.png", "study.csv", STATE];
const PICTURES: &str = "pictures";

/// Parses `60s`, `5m` or `1h`.
fn span(text: &str) -> std::result::Result<Duration, String> {
    let unit = text.char_indices().next_back().and_then(|(at, unit)| {
        let seconds =
            [('s', 1.0), ('m', 60.0), ('h', 3600.0)].into_iter().find(|known| known.0 == unit)?.1;
        let number: f64 = text[..at].parse().ok()?;
        Duration::try_from_secs_f64(number * seconds).ok()
    });
    unit.filter(|span| !span.is_zero()).ok_or_else(|| "give a time such as 60s, 5m or 1h".into())
}

/// Prints the table on stdout, the fastest first.
fn print(study: &Study, loss: &Loss, total: Duration) {
    let [width, height] = study.of.size;
    report::line("scene", format!("{}, {width} x {height}", study.of.scene));
    report::line("truth", &study.of.truth);
    for (method, why) in &study.left_out {
        report::line("left out", format!("{method}: {why}"));
    }
    let front = study.front(|record| loss.value(record));
    let timed =
        |i: usize| Some((i, study.candidates[i].quartiles()?, loss.value(&study.candidates[i])));
    let mut rows: Vec<_> = (0..study.candidates.len()).filter_map(timed).collect();
    rows.sort_by(|a, b| a.1[1].total_cmp(&b.1[1]).then(a.0.cmp(&b.0)));
    say(format!("{:>10} {:>17} {:>12}", "ms", "quartiles", loss.figure));
    for (i, [first, median, last], error) in rows {
        let mark = if front.contains(&i) { '*' } else { ' ' };
        let error = error.map_or_else(|| "-".into(), report::short);
        let spread = format!("{} to {}", report::short(first), report::short(last));
        let options = &study.candidates[i].options;
        say(format!("{:>10} {spread:>17} {error:>12} {mark} {options}", report::short(median)));
    }
    let untimed = |record: &&Record| record.measured.is_some() && record.times.is_empty();
    for record in study.candidates.iter().filter(untimed) {
        let error = loss.value(record).map_or_else(|| "-".into(), report::short);
        say(format!("{:>10} {:>17} {error:>12}   {}", "-", "", record.options));
    }
    let left = study.candidates.iter().filter(|record| record.measured.is_none()).count();
    if left > 0 {
        report::line(
            "not tried",
            format!("{left} candidates, because the time was up; resume with --resume"),
        );
    }
    report::line("front", "* no other candidate is both faster and more accurate");
    report::time("total", vec![total]);
}
