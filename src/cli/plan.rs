//! `splatref plan`: chooses the best method and settings within a budget.

use super::tried::Tried;
use super::words::quoted;
use super::{Ended, Ending, output, progress, report, say};
use splatref::compare::metrics::METRICS;
use splatref::io::replace::write_atomically;
use splatref::io::scene_file::{GroupChoice, MethodChoice};
use splatref::method::Method;
use splatref::setting::Setting;
use splatref::study::plan::{Budget, Known as Row, choose};
use splatref::study::run::measure::loss;
use splatref::study::run::{Loss, Setup};
use splatref::study::sweep::Candidate;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

#[derive(clap::Args)]
#[command(after_help = "\
How the choice is made:
  1. Draw and time every candidate of `splatref study` in a picture a quarter as wide and high.
  2. From the fastest on, draw candidates at full size and compare them with the true picture, as
     long as they can still be the best. Only this error counts, because holes depend on the size.
  3. Time the candidates within the budget, by turns.

Examples:
  splatref plan bunny.ply --error 0.02
  splatref plan bunny.ply --error 0.03 --metric ssim
  splatref plan torus --time 20ms --metric flip
  splatref plan bunny.ply --error 0.02 -o best.toml && splatref render best.toml")]
#[command(group(clap::ArgGroup::new("budget").required(true)))]
pub(super) struct Args {
    #[command(flatten)]
    tried: Tried,
    /// Choose the fastest candidate within this error (SSIM: 1 - SSIM, PSNR: RMSE)
    #[arg(long, value_name = "E", value_parser = error, group = "budget")]
    error: Option<f64>,
    /// Choose the most accurate candidate within this time a picture, such as 20ms or 0.5s
    #[arg(long, value_name = "TIME", value_parser = milliseconds, group = "budget")]
    time: Option<f64>,
    /// Measure the error with this metric
    #[arg(long, value_name = "NAME", default_value = "rmse", value_parser = still)]
    metric: Loss,
    /// Write a minimal scene file that renders the chosen candidate
    #[arg(short, long, value_name = "FILE.toml", value_parser = toml)]
    output: Option<PathBuf>,
}

/// How many of the other candidates are printed.
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
    let Setup { mut bench, mut candidates, known, camera, .. } =
        args.tried.load(&scene, &exec, &steps)?;
    candidates.retain(|candidate| !candidate.imitates);
    let truth = known.still(&camera, &exec, &show)?;

    let rows = choose(&mut bench, &candidates, &truth, budget, &args.metric, &exec, &show)?;
    drop(steps);
    report::line("scene", format!("{}, {} x {}", scene.name, camera.width, camera.height));
    report::line("truth", known.in_words(&truth));
    let small = rows.iter().filter(|row| !row.is_whole).count();
    report::line(
        "tried",
        format!("{} candidates, {small} of them only in the small picture", rows.len()),
    );
    let ended = print(args, budget, &candidates, &rows);
    report::time("total", vec![start.elapsed()]);
    ended
}

/// Prints the choice, the command that renders it, and the next best.
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
        let nearest = nearest.map_or_else(|| "no candidate has such an error".into(), in_words);
        say(format!("no candidate is within {what}; the nearest is {nearest}"));
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
        let mut file = candidates[best].file.clone();
        // What the method does not draw would only be warned of.
        if !matches!(file.method.method()?, Method::Deferred(_)) {
            let levels = file.all_models_mut().map(|model| &mut model.mipmaps);
            levels.for_each(|levels| *levels = levels.filter(|levels| *levels == 0));
        }
        let text = file.text(path)?;
        write_atomically(path, |file| file.write_all(text.as_bytes()))?;
        report::line("wrote", path.display());
    }
    Ok(Ending::Good)
}

/// The options that `render` does not have; each takes a value.
const LEFT: [&str; 6] = ["--error", "--time", "--metric", "--truth", "--output", "-o"];

/// The scene and those options of this command that `render` takes too. Options that the candidate
/// sets, or that its method does not have, are left out.
fn own_options(chosen: &Candidate) -> String {
    let rows: Vec<_> = MethodChoice::rows().into_iter().chain(GroupChoice::rows()).collect();
    let replaced: Vec<&str> = chosen.options.split([' ', '=']).collect();
    let mut all = std::env::args_os().skip(1);
    let (mut kept, mut begun, mut places) = (String::new(), false, false);
    while let Some(word) = all.next() {
        // A name that is no text cannot be an option.
        let text = word.to_string_lossy();
        let (name, with_value) = match text.split_once('=') {
            Some((name, _)) => (name, true),
            None => (&*text, false),
        };
        let attached = text.starts_with("-o") && text.len() > 2;
        let row = rows.iter().find(|row| name.strip_prefix("--") == Some(&row.option));
        let means_nothing =
            row.is_some_and(|row| row.owners.iter().all(|(owner, _)| *owner != chosen.method));
        let is_said = name.starts_with("--") && replaced.contains(&name);
        if places {
            // Options follow, so a name that looks like one is made to look like a path.
            let path = if text.starts_with('-') { "./" } else { "" };
            kept.push_str(&format!("{path}{} ", quoted(&word)));
        } else if !begun && text == "plan" {
            begun = true;
        } else if begun && text == "--" {
            places = true;
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

/// Parses the name of a scene file.
fn toml(text: &str) -> Result<PathBuf, String> {
    match Path::new(text).extension() {
        Some(end) if end == "toml" => Ok(text.into()),
        _ => Err("give a name that ends in .toml, such as best.toml".into()),
    }
}

/// Parses a number >= 0.
fn error(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|v: &f64| *v >= 0.0 && v.is_finite());
    number.ok_or_else(|| "give a number >= 0, such as 0.02".into())
}

/// Parses `20ms` or `0.5s`.
fn milliseconds(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix("ms").map(|digits| (digits, 1.0));
    let number = number.or_else(|| text.strip_suffix('s').map(|digits| (digits, 1000.0)));
    let time = number.and_then(|(digits, scale)| Some(digits.parse::<f64>().ok()? * scale));
    time.filter(|time| *time > 0.0 && time.is_finite())
        .ok_or_else(|| "give a time for one picture, such as 20ms or 0.5s".into())
}

/// Parses the name of a metric for one picture.
fn still(name: &str) -> Result<Loss, String> {
    match loss(name) {
        Ok(loss) if !METRICS.iter().any(|metric| metric.name == name) => {
            Err(format!("{} is measured on sequences; give a metric of one picture", loss.figure))
        }
        other => other.map_err(|error| error.to_string()),
    }
}
