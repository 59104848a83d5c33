//! `splatref plan`: the cheapest method and settings within a budget.

use super::study::loss;
use super::tried::{Loaded, Tried, truth_in_words};
use super::{Ended, Ending, output, progress, report, say};
use splatref::compare::metrics::METRICS;
use splatref::io::replace::write_atomically;
use splatref::io::scene_file::{GroupChoice, MethodChoice};
use splatref::setting::Setting;
use splatref::study::plan::{Budget, Known as Row, choose};
use splatref::study::run::Loss;
use splatref::study::sweep::Candidate;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(clap::Args)]
#[command(after_help = "\
Every candidate of `splatref study` is drawn and timed with a quarter of the columns and rows. From the
fastest on, candidates are drawn at the full size and compared with the true picture, as long as they may be
the best. What is within the budget is timed by turns. Errors are of the full size alone: holes come and go
with the size of a picture.

Examples:
  splatref plan bunny.ply --error 0.02
  splatref plan bunny.ply --error 0.03 --metric ssim
  splatref plan torus --time 20ms --metric flip
  splatref plan bunny.ply --error 0.02 -o best.toml && splatref render best.toml")]
#[command(group(clap::ArgGroup::new("budget").required(true)))]
pub(super) struct Args {
    #[command(flatten)]
    tried: Tried,
    /// The most error; of SSIM what is missing to 1, of PSNR the RMSE: the fastest is chosen
    #[arg(long, value_name = "E", value_parser = error, group = "budget")]
    error: Option<f64>,
    /// The most time of a picture, such as 20ms or 0.5s: the one with the least error is chosen
    #[arg(long, value_name = "TIME", value_parser = milliseconds, group = "budget")]
    time: Option<f64>,
    /// What the error is
    #[arg(long, value_name = "NAME", default_value = "rmse", value_parser = still)]
    metric: Loss,
    /// Writes the scene file that draws what is chosen, and nothing that it does not need
    #[arg(short, long, value_name = "FILE.toml", value_parser = toml)]
    output: Option<PathBuf>,
}

/// How many that were not chosen are named.
const RUNNERS_UP: usize = 3;

pub(super) fn run(args: &Args) -> Ended {
    let start = Instant::now();
    let budget = match (args.error, args.time) {
        (Some(error), _) => Budget::Error(error),
        (None, time) => Budget::Time(time.unwrap_or(f64::INFINITY)),
    };
    let scene = args.tried.scene_file()?;
    if let Some(path) = &args.output {
        output::check(path, args.tried.path()?, &scene)?;
        args.tried.truth().map_or(Ok(()), |truth| output::check_other(path, truth))?;
    }
    let exec = args.tried.exec()?;
    let steps = progress::Steps::new("loading");
    let show = |what: &str, done, of| steps.show(what, done, of);
    let Loaded { mut bench, mut candidates, known, camera, .. } =
        args.tried.load(&scene, &exec, &steps)?;
    candidates.retain(|candidate| !candidate.imitates);
    let truth = known.still(&camera, &exec, &show)?;

    let rows = choose(&mut bench, &candidates, &truth, budget, &args.metric, &exec, &show)?;
    drop(steps);
    report::line("scene", format!("{}, {} x {}", scene.name, camera.width, camera.height));
    report::line("truth", truth_in_words(&known, &truth));
    let small = rows.iter().filter(|row| !row.is_whole).count();
    report::line("tried", format!("{} candidates, {small} of them in small alone", rows.len()));
    let ended = print(args, budget, &candidates, &rows);
    report::time("total", vec![start.elapsed()]);
    ended
}

/// What is chosen, how to draw it, and what comes next.
fn print(args: &Args, budget: Budget, candidates: &[Candidate], rows: &[Row]) -> Ended {
    let in_words = |i: usize| {
        let Row { time, loss, .. } = rows[i];
        let (time, loss) = (report::short(time), report::short(loss));
        format!("{}: {time} ms, {} {loss}", candidates[i].options, args.metric.title)
    };
    let ranked = budget.ranked(rows);
    let Some((&best, others)) = ranked.split_first() else {
        let by = |of: fn(&Row) -> f64| {
            let finite = (0..rows.len()).filter(|&i| !rows[i].loss.is_nan());
            finite.min_by(|&a, &b| of(&rows[a]).total_cmp(&of(&rows[b])))
        };
        let (what, nearest) = match budget {
            Budget::Error(most) => (format!("an error of {most}"), by(|row| row.loss)),
            Budget::Time(most) => (format!("{most} ms"), by(|row| row.time)),
        };
        let nearest = nearest.map_or_else(|| "none has such an error".into(), in_words);
        say(format!("nothing is within {what}; the nearest is {nearest}"));
        return Ok(Ending::Different);
    };
    report::line("plan", in_words(best));
    for &i in others.iter().take(RUNNERS_UP) {
        let why = match budget {
            Budget::Error(_) => {
                format!("{} times as long", report::short(rows[i].time / rows[best].time))
            }
            Budget::Time(_) => {
                format!("{} times the error", report::short(rows[i].loss / rows[best].loss))
            }
        };
        report::line("  next", format!("{}; {why}", in_words(i)));
    }
    report::line(
        "command",
        format!("splatref render {}{}", own_options(&candidates[best]), candidates[best].options),
    );
    if let Some(path) = &args.output {
        let text = candidates[best].file.text(path)?;
        write_atomically(path, |file| file.write_all(text.as_bytes()))?;
        report::line("wrote", path.display());
    }
    Ok(Ending::Good)
}

/// The options that `render` does not take; each has a value.
const LEFT: [&str; 6] = ["--error", "--time", "--metric", "--truth", "--output", "-o"];

/// The scene and the options of this command that `render` takes with those of a candidate: not what the
/// candidate says too, nor what means nothing to its method.
fn own_options(chosen: &Candidate) -> String {
    let rows: Vec<_> = MethodChoice::rows().into_iter().chain(GroupChoice::rows()).collect();
    let replaced: Vec<&str> = chosen.options.split([' ', '=']).collect();
    let mut all = std::env::args().skip(1);
    let (mut kept, mut begun) = (String::new(), false);
    while let Some(word) = all.next() {
        let (name, with_value) = match word.split_once('=') {
            Some((name, _)) => (name, true),
            None => (word.as_str(), false),
        };
        let attached = word.starts_with("-o") && word.len() > 2;
        let row = rows.iter().find(|row| name.strip_prefix("--") == Some(&row.option));
        let means_nothing =
            row.is_some_and(|row| row.owners.iter().all(|(owner, _)| *owner != chosen.method));
        let is_said = name.starts_with("--") && replaced.contains(&name);
        if !begun && word == "plan" {
            begun = true;
        } else if means_nothing || is_said || attached || LEFT.contains(&name) {
            if !with_value && !attached && !row.is_some_and(Setting::is_switch) {
                all.next();
            }
        } else {
            kept.push_str(&quoted(&word));
            kept.push(' ');
        }
    }
    kept
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_=./,:+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// The name of a scene file.
fn toml(text: &str) -> Result<PathBuf, String> {
    match Path::new(text).extension() {
        Some(end) if end == "toml" => Ok(text.into()),
        _ => Err("a scene file is called .toml, such as best.toml".into()),
    }
}

/// A number of at least 0.
fn error(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|v: &f64| *v >= 0.0 && v.is_finite());
    number.ok_or_else(|| "give a number of at least 0, such as 0.02".into())
}

/// `20ms` or `0.5s`.
fn milliseconds(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix("ms").map(|digits| (digits, 1.0));
    let number = number.or_else(|| text.strip_suffix('s').map(|digits| (digits, 1000.0)));
    let time = number.and_then(|(digits, scale)| Some(digits.parse::<f64>().ok()? * scale));
    time.filter(|time| *time > 0.0 && time.is_finite())
        .ok_or_else(|| "give a time of a picture, such as 20ms or 0.5s".into())
}

/// A loss of one picture.
fn still(name: &str) -> Result<Loss, String> {
    match loss(name) {
        Ok(loss) if !METRICS.iter().any(|metric| metric.name == name) => {
            Err(format!("{} is of a sequence; give an error of one picture", loss.figure))
        }
        other => other,
    }
}
