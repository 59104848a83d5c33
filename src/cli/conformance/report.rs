//! The report as JSON and as JUnit XML.

use crate::cli::Ending;
use serde_json::{Value, json};
use splatref::report::verdict::{JsonShift, JsonStage};
use splatref::setting::Word;
use splatref::study::chart::escaped;
use splatref::verdict::Outcome;
use splatref::verdict::conformance::{Judged, Report, Row};
use splatref::verdict::shift::LIMITS;
use splatref::{Error, Result};
use std::fmt::Write;
use std::path::PathBuf;

/// The report, with what the program knows beside it.
pub(super) struct Tried {
    pub(super) report: Report,
    /// What the program knows of each row.
    pub(super) runs: Vec<Run>,
}

/// A run of the command.
pub(super) struct Run {
    pub(super) seconds: f64,
    /// The folder of the scene.
    pub(super) folder: PathBuf,
    pub(super) shown: Exhibit,
}

/// What the page shows of a rule beside its row.
#[derive(Default)]
pub(super) struct Exhibit {
    /// The pictures of the renderer and of splatref as PNG, if they have colours.
    pub(super) pictures: [Option<Vec<u8>>; 2],
    /// Whether the folder of the scene has the page of the verdict.
    pub(super) linked: bool,
}

/// A verdict in the words of `verify --json`.
fn verdict(judged: &Judged) -> Value {
    let Judged { verdict, rounding, .. } = judged;
    json!({
        "promise": rounding.word(),
        "covered": verdict.covered,
        "undecided": verdict.undecided,
        "budget": verdict.budget,
        "first_wrong": verdict.first_wrong().map(|stage| stage.stage),
        "stages": verdict.stages.iter().map(JsonStage::new).collect::<Vec<_>>(),
        "shifts": LIMITS.iter().zip(&verdict.shifts).map(|(limit, shift)| JsonShift::new(limit, shift)).collect::<Vec<_>>(),
    })
}

/// How the command ends because of a row; a renderer that failed is as a wrong one.
fn ending(row: &Row) -> Ending {
    row.outcome().unwrap_or(Outcome::Wrong).into()
}

impl Tried {
    pub(super) fn new(method: &str) -> Self {
        Self { report: Report::new(method), runs: Vec::new() }
    }

    pub(super) fn push(&mut self, row: Row, run: Run) {
        self.report.rows.push(row);
        self.runs.push(run);
    }

    /// How the command ends: as its worst row.
    pub(super) fn ending(&self) -> Ending {
        let has = |which| self.report.rows.iter().any(|row| ending(row) == which);
        if self.report.leans() {
            return Ending::Different;
        }
        let endings = [Ending::Different, Ending::Undecidable, Ending::Unlike];
        endings.into_iter().find(|which| has(*which)).unwrap_or(Ending::Good)
    }

    /// The report as `docs/conformance.schema.json` describes it.
    pub(super) fn json(&self, command: &str) -> Result<String> {
        let rules = self.report.rows.iter().zip(&self.runs);
        let rules = rules.map(|(row, Run { seconds, folder, .. })| {
            let judged = row.judged.as_ref().ok();
            let cause = row.cause();
            json!({
                "rule": row.rule.name,
                "tests": row.rule.tests,
                "outcome": row.word(),
                "why": (!cause.is_empty()).then_some(cause),
                "looks_like": judged.and_then(|judged| Some(&judged.likely.as_ref()?.words)),
                "sharper": judged.and_then(|judged| judged.sharper.as_ref()),
                "seconds": seconds,
                "folder": folder.display().to_string(),
                "verdict": judged.map(verdict),
            })
        });
        let rules: Vec<Value> = rules.collect();
        let shifts = self.report.shifts();
        let shifts = shifts.iter().flat_map(|(rounding, shifts)| {
            LIMITS.iter().zip(shifts).map(|(limit, shift)| {
                json!({
                    "promise": rounding.word(),
                    "alarms": shift.alarms(),
                    "shift": JsonShift::new(limit, shift),
                })
            })
        });
        let shifts: Vec<Value> = shifts.collect();
        let counts = Report::words().into_iter();
        let counts = counts.map(|word| (word.to_owned(), json!(self.report.count(word))));
        let json = json!({
            "splatref": env!("CARGO_PKG_VERSION"),
            "method": self.report.method,
            "command": command,
            "right": self.report.is_right(),
            "looks_like": self.report.common().map(|common| json!({
                "mistake": common.mistake,
                "explains": common.explains,
                "wrong": common.wrong,
            })),
            "counts": counts.collect::<serde_json::Map<_, _>>(),
            "rules": rules,
            "shifts": shifts,
        });
        let text = serde_json::to_string_pretty(&json);
        text.map(|text| text + "\n").map_err(|error| Error::Invalid(error.to_string()))
    }

    /// The report as JUnit XML: a test case for each rule, and one for the bias of all.
    pub(super) fn junit(&self) -> String {
        let Report { method, rows } = &self.report;
        let leans = self.report.leans();
        let tests = rows.len() + 1;
        let failures = self.report.count("wrong") + usize::from(leans);
        let errors = rows.len() - self.report.count("wrong") - self.report.count("right");
        let seconds: f64 = self.runs.iter().map(|run| run.seconds).sum();
        let counts = format!(
            "tests=\"{tests}\" failures=\"{failures}\" errors=\"{errors}\" time=\"{seconds:.3}\""
        );
        let mut xml = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {counts}>\n\
             <testsuite name=\"splatref conformance {method}\" {counts}>\n"
        );
        if let Some(common) = self.report.common() {
            let common = escaped(&common.to_string());
            let _ = writeln!(
                xml,
                "<properties><property name=\"looks like\" value=\"{common}\"/></properties>"
            );
        }
        for (row, Run { seconds, .. }) in rows.iter().zip(&self.runs) {
            let (name, why) = (&row.rule.name, escaped(&row.cause()));
            let tag = match row.word() {
                "right" => String::new(),
                "wrong" => format!("<failure type=\"wrong\" message=\"{why}\"/>"),
                word => format!("<error type=\"{word}\" message=\"{why}\"/>"),
            };
            let _ = writeln!(
                xml,
                "<testcase classname=\"splatref.{method}\" name=\"{name}\" time=\"{seconds:.3}\">{tag}\
                 </testcase>"
            );
        }
        let bias = match leans {
            true => {
                "<failure type=\"wrong\" message=\"the undecided decisions of all rules lean to \
                     one side\"/>"
            }
            false => "",
        };
        let _ = writeln!(
            xml,
            "<testcase classname=\"splatref.{method}\" name=\"all rules together\" time=\"0\">{bias}\
             </testcase>\n</testsuite>\n</testsuites>"
        );
        xml
    }
}
