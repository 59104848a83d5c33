//! `splatref suite`: pools the verdicts of several scenes.

use super::{Ended, Ending, say};
use serde::Deserialize;
use serde_json::{Map, Value};
use splatref::method::Method;
use splatref::report::verdict::{self as report, JsonShift, leaning};
use splatref::setting::{Word, Words};
use splatref::verdict::client::Rounding;
use splatref::verdict::shift::{LIMITS, Shift, Shifts};
use splatref::verdict::{Doubt, Outcome};
use splatref::{Error, Result};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "\
A decision close to a threshold is undecided in a single picture. Pooling the verdicts of several scenes
exposes a slightly wrong threshold, because it biases the undecided decisions one way; rounding turns
about as many to either side. The same verdict, named twice or copied, counts once.

The verdicts of each promise are pooled by themselves. Under every promise the bias is WRONG if its z is
4.5 or more, and larger than a rounded threshold or one-sided rounding can cause. At most one right suite
of 10,000 is called wrong.

Examples:
  splatref verify a.toml a.exr --promise ieee --json a.json
  splatref verify b.toml b.exr --promise ieee --json b.json
  splatref suite a.json b.json

Exit codes: 0 all right, 1 any wrong, or their decisions biased to one side, 2 wrong usage or
no verdict, 3 any undecidable, 4 any unlike those of right renderers.")]
pub(super) struct Args {
    /// Verdicts that `verify --json` wrote
    #[arg(required = true, value_name = "VERDICT.json")]
    verdicts: Vec<PathBuf>,
}

/// The fields that are read from a verdict.
#[derive(Deserialize)]
struct Verdict {
    method: String,
    outcome: String,
    promise: String,
    stages: Vec<Map<String, Value>>,
    shifts: Vec<JsonShift>,
}

/// The words of the promises.
fn promises() -> Vec<&'static str> {
    Rounding::WORDS.iter().map(|(word, _)| *word).collect()
}

impl Verdict {
    /// Checks the words, because one that is not known would count as nothing.
    fn check(&self) -> std::result::Result<(), String> {
        let (limits, promises) = (LIMITS.map(Doubt::name), promises());
        let shifts = self.shifts.iter().map(|shift| ("shifts.limit", &shift.limit, &limits[..]));
        let outcomes = Outcome::Right.words();
        let own =
            [("outcome", &self.outcome, &outcomes[..]), ("promise", &self.promise, &promises[..])];
        for (key, word, known) in own.into_iter().chain(shifts) {
            if !known.contains(&word.as_str()) {
                let known = known.join(", ");
                return Err(format!("{key} is \"{word}\", but can be {known}"));
            }
        }
        self.check_stages()?;
        match self.shifts.iter().find(|shift| !shift.is_possible()) {
            Some(shift) => Err(format!("the numbers of the limit {} are impossible", shift.limit)),
            None => Ok(()),
        }
    }

    /// Checks the names of the stages, because a verdict on other stages judges something else.
    fn check_stages(&self) -> std::result::Result<(), String> {
        let methods = Method::all();
        let Some(method) = methods.iter().find(|method| method.name() == self.method) else {
            return Err(format!("method is \"{}\", which is unknown", self.method));
        };
        let known: Vec<&str> = method.stages().iter().map(|stage| stage.name).collect();
        let [_, fields] = report::fields();
        for stage in &self.stages {
            check_fields(stage, &fields)?;
            let name = stage.get("stage").and_then(Value::as_str).unwrap_or_default();
            if !known.contains(&name) {
                let known = known.join(", ");
                return Err(format!("stages.stage is \"{name}\", but can be {known}"));
            }
        }
        Ok(())
    }
}

/// Refuses a field that `verify` does not write, because it may change what the others mean.
fn check_fields(found: &Map<String, Value>, known: &[String]) -> std::result::Result<(), String> {
    match found.keys().find(|key| !known.contains(key)) {
        Some(key) => Err(format!("the field \"{key}\" is unknown")),
        None => Ok(()),
    }
}

pub(super) fn run(args: &Args) -> Ended {
    // A verdict added twice would show twice the bias of its picture. Two pictures have the same
    // text only where neither is biased.
    let mut seen: BTreeMap<String, &Path> = BTreeMap::new();
    let mut verdicts = Vec::new();
    for path in &args.verdicts {
        // A file that is no verdict exits with 2, because 1 says that a picture is wrong.
        let (text, verdict) = verdict(path).map_err(|error| Error::Usage(error.to_string()))?;
        let Verdict { outcome, promise, .. } = &verdict;
        let first = *seen.entry(text).or_insert(path);
        if std::ptr::eq(first, path.as_path()) {
            say(format!("{outcome:<12} {promise:<7} {}", path.display()));
            verdicts.push(verdict);
        } else {
            let (path, first) = (path.display(), first.display());
            say(format!(
                "{:<12} {promise:<7} {path}: the same verdict as {first}, counted once",
                "again"
            ));
        }
    }
    let any = |word: &str| verdicts.iter().any(|verdict| verdict.outcome == word);
    let mut leans = false;
    // A decision that is undecided under one promise may be certain under another.
    for promise in promises() {
        let own = verdicts.iter().filter(|verdict| verdict.promise == promise);
        let all = together(own.flat_map(|verdict| &verdict.shifts));
        for (limit, shift) in LIMITS.iter().zip(&all).filter(|(_, shift)| shift.decisions > 0) {
            let alarms = shift.alarms();
            leans |= alarms;
            let word = if alarms { "WRONG" } else { "" };
            say(format!("{word:<12} {promise:<7} {}", leaning(*limit, shift)));
        }
    }
    Ok(if leans || any("wrong") {
        Ending::Different
    } else if any("undecidable") {
        Ending::Undecidable
    } else if any("unlike") {
        Ending::Unlike
    } else {
        Ending::Good
    })
}

/// Reads a verdict, and returns its text too.
fn verdict(path: &Path) -> Result<(String, Verdict)> {
    let io = |source| Error::io(path, source);
    // Ask before opening, because opening a pipe without a writer would wait.
    if !fs::metadata(path).map_err(io)?.is_file() {
        let what = "this is no file; write the verdict to a file with verify --json FILE";
        return Err(Error::format(path, what));
    }
    let mut text = String::new();
    // A verdict has a few kilobytes; a longer file is cut here, and is then no JSON.
    let mut file = File::open(path).map_err(io)?.take(1 << 24);
    file.read_to_string(&mut text).map_err(io)?;
    let no_verdict =
        |what: String| Error::format(path, format!("not a verdict of `verify --json`: {what}"));
    let json = |error: serde_json::Error| no_verdict(error.to_string());
    let all: Map<String, Value> = serde_json::from_str(&text).map_err(json)?;
    let [fields, _] = report::fields();
    let unknown = check_fields(&all, &fields);
    let verdict: Verdict = serde_json::from_value(Value::Object(all)).map_err(json)?;
    unknown.map_err(no_verdict)?;
    verdict.check().map_err(no_verdict)?;
    Ok((text, verdict))
}

/// Adds up the shifts of several pictures.
fn together<'a>(leans: impl Iterator<Item = &'a JsonShift>) -> Shifts {
    let mut all = [Shift::default(); LIMITS.len()];
    for lean in leans {
        if let Some(at) = LIMITS.iter().position(|limit| limit.name() == lean.limit) {
            all[at].add(&lean.shift());
        }
    }
    all
}
