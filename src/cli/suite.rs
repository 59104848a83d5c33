//! `splatref suite`: pools the verdicts of several scenes.

use super::verify::report::{JsonShift, leaning};
use super::{Ended, Ending, say};
use serde::Deserialize;
use splatref::verdict::shift::{LIMITS, Shift, Shifts};
use splatref::{Error, Result};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "\
A decision close to a threshold is undecided in a single picture. Pooling the verdicts of several scenes
exposes a slightly wrong threshold, because it biases the undecided decisions one way; rounding turns
about as many to either side. The same verdict, named twice or copied, counts once.

Examples:
  splatref verify a.toml a.exr --promise ieee --json a.json
  splatref verify b.toml b.exr --promise ieee --json b.json
  splatref suite a.json b.json

Exit codes: 0 all right, 1 any wrong, or their decisions biased to one side, 2 wrong usage, 3 any
undecidable.")]
pub(super) struct Args {
    /// Verdicts that `verify --json` wrote
    #[arg(required = true, value_name = "VERDICT.json")]
    verdicts: Vec<PathBuf>,
}

/// The fields that are read from a verdict.
#[derive(Deserialize)]
struct Verdict {
    outcome: String,
    promise: String,
    shifts: Vec<JsonShift>,
}

pub(super) fn run(args: &Args) -> Ended {
    // A verdict added twice would show twice the bias of its picture. Two pictures have the same
    // text only where neither is biased.
    let mut seen: BTreeMap<String, &Path> = BTreeMap::new();
    let mut verdicts = Vec::new();
    for path in &args.verdicts {
        let (text, verdict) = verdict(path)?;
        let Verdict { outcome, promise, .. } = &verdict;
        let first = *seen.entry(text).or_insert(path);
        if std::ptr::eq(first, path.as_path()) {
            say(format!("{outcome:<12} {promise:<5} {}", path.display()));
            verdicts.push(verdict);
        } else {
            let (path, first) = (path.display(), first.display());
            say(format!(
                "{:<12} {promise:<5} {path}: the same verdict as {first}, counted once",
                "again"
            ));
        }
    }
    let any = |word: &str| verdicts.iter().any(|verdict| verdict.outcome == word);
    let mut leans = false;
    // A decision that is undecided under one promise may be certain under the other.
    for promise in ["ieee", "gpu"] {
        let own = verdicts.iter().filter(|verdict| verdict.promise == promise);
        let all = together(own.flat_map(|verdict| &verdict.shifts));
        for (limit, shift) in LIMITS.iter().zip(&all).filter(|(_, shift)| shift.decisions > 0) {
            // An operation that is inexact within its promise may be biased.
            let alarms = promise == "ieee" && shift.alarms();
            leans |= alarms;
            let word = if alarms { "WRONG" } else { "" };
            say(format!("{word:<12} {promise:<5} {}", leaning(*limit, shift)));
        }
    }
    Ok(if leans || any("wrong") {
        Ending::Different
    } else if any("undecidable") {
        Ending::Undecidable
    } else {
        Ending::Good
    })
}

/// Reads a verdict, and returns its text too.
fn verdict(path: &Path) -> Result<(String, Verdict)> {
    let mut text = String::new();
    // A verdict has a few kilobytes; a longer file is cut here, and is then no JSON.
    let file = File::open(path).map(|file| file.take(1 << 24));
    file.and_then(|mut file| file.read_to_string(&mut text))
        .map_err(|source| Error::io(path, source))?;
    let verdict = serde_json::from_str(&text).map_err(|error| {
        Error::format(path, format!("not a verdict of `verify --json`: {error}"))
    })?;
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
