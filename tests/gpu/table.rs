//! The tables of `docs/gpu-clients.md`.

use crate::clients::{self, RightClient};
use crate::device::Gpu;
use crate::exposes;
use crate::judge::{Judged, judge};
use crate::operations;
use splatref::setting::Words;
use splatref::verdict::Outcome;
use splatref::verdict::client::Rounding;
use splatref::verdict::shift::Shifts;
use std::fmt::Write;
use std::fs;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/gpu-clients.md");
const END: &str = "<!-- end -->";

/// Writes what the clients of this device leave into its part of the page: there is one for a
/// driver in software, and one for a graphics card.
pub(crate) fn write(gpu: &Gpu) {
    let page = fs::read_to_string(PAGE).expect("the page");
    let start =
        format!("<!-- cargo test: gpu, {} -->", if gpu.software { "software" } else { "card" });
    let (before, rest) = page.split_once(&start).expect("the comment before the tables");
    let after = &rest[rest.find(END).expect("the comment after the tables")..];
    let [errors, pictures] = clients(gpu);
    let tables = [
        ("The device", format!("{}.\n", gpu.name)),
        ("The largest error of each stage, in bounds", errors),
        ("Undecided decisions, and outcomes", pictures),
        ("The seeded bugs", bugs(gpu)),
        ("The operations of the device", operations::table(gpu)),
    ];
    let tables = tables.map(|(heading, table)| format!("### {heading}\n\n{table}")).join("\n");
    fs::write(PAGE, format!("{before}{start}\n\n{tables}\n{after}")).expect("the page");
}

/// What the verdicts of a client's pictures have in common, under one promise.
#[derive(Default)]
struct Summary {
    /// The stages, each with its largest error.
    errors: Vec<(&'static str, f32)>,
    undecided: f64,
    shifts: Shifts,
    /// The outcomes that are not right.
    others: Vec<String>,
}

impl Summary {
    fn add(&mut self, scene: &str, judged: &Judged) {
        self.errors.resize(judged.errors.len(), ("", 0.0));
        for (most, &(stage, error)) in self.errors.iter_mut().zip(&judged.errors) {
            *most = (stage, if error > most.1 { error } else { most.1 });
        }
        if judged.undecided > self.undecided {
            self.undecided = judged.undecided;
        }
        self.shifts.iter_mut().zip(&judged.shifts).for_each(|(sum, shift)| sum.add(shift));
        if judged.outcome != Outcome::Right {
            let word = format!("{:?}", judged.outcome).to_lowercase();
            let fault = judged.fault.as_deref().unwrap_or_default();
            println!("{scene}: {word} {fault} {}", judged.unlike);
            self.others.push(word);
        }
    }
}

/// A table of errors, and one of everything else.
fn clients(gpu: &Gpu) -> [String; 2] {
    let promises = Rounding::WORDS;
    let heads: Vec<_> = promises.iter().map(|(word, _)| format!("`{word}`")).collect();
    let rule = "---|".repeat(promises.len());
    let mut errors = format!("| client | stage | {} |\n|---|---|{rule}\n", heads.join(" | "));
    let mut pictures =
        "| client | promise | undecided, at most | lean of the cut-off, of epsilon | \
                        scenes not right |\n|---|---|---|---|---|\n"
            .to_owned();
    for client in clients::ALL {
        let summaries = summaries(gpu, &client);
        for (i, (stage, _)) in summaries[0].errors.iter().enumerate() {
            let most: Vec<_> =
                summaries.iter().map(|summary| format!("{:.3}", summary.errors[i].1)).collect();
            let name = if i == 0 { client.name } else { "" };
            line(&mut errors, format_args!("| {name} | {stage} | {} |", most.join(" | ")));
        }
        for (head, summary) in heads.iter().zip(&summaries) {
            let lean = summary.shifts.map(|shift| format!("{:.1}", shift.z() + 0.0)).join(", ");
            let others = match summary.others.len() {
                0 => "none".to_owned(),
                _ => counted(&summary.others),
            };
            let undecided = 100.0 * summary.undecided;
            let name = client.name;
            line(
                &mut pictures,
                format_args!("| {name} | {head} | {undecided:.3} % | {lean} | {others} |"),
            );
        }
    }
    [errors, pictures]
}

/// How often each word occurs.
fn counted(words: &[String]) -> String {
    let mut different = words.to_vec();
    different.sort();
    different.dedup();
    let count = |word: &String| words.iter().filter(|other| *other == word).count();
    let counts: Vec<_> = different.iter().map(|word| format!("{} {word}", count(word))).collect();
    counts.join(", ")
}

/// The verdicts of a client under each promise.
fn summaries(gpu: &Gpu, client: &RightClient) -> Vec<Summary> {
    let mut summaries: Vec<Summary> = Rounding::WORDS.iter().map(|_| Summary::default()).collect();
    for job in (client.jobs)() {
        let planes = (client.draw)(gpu, &job);
        for ((_, promise), summary) in Rounding::WORDS.iter().zip(&mut summaries) {
            summary.add(&job.name, &judge(&job, &planes, *promise));
        }
    }
    summaries
}

/// One row a seeded bug.
fn bugs(gpu: &Gpu) -> String {
    let mut rows = "| client | seeded bug | scenes that expose it |\n|---|---|---|\n".to_owned();
    for seeded in &clients::SEEDED {
        let jobs = (seeded.jobs)();
        for &bug in seeded.bugs {
            let exposing = jobs.iter().filter(|job| exposes(gpu, seeded, job, bug)).count();
            let (client, words, of) = (seeded.client, bug.words(), jobs.len());
            line(&mut rows, format_args!("| {client} | {words} | {exposing} of {of} |"));
        }
    }
    rows
}

fn line(text: &mut String, line: std::fmt::Arguments<'_>) {
    writeln!(text, "{line}").expect("a string");
}
