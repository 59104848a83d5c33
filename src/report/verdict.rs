//! Prints a verdict in about ten lines, or as JSON.

mod page;

use super::short;
use crate::error::{Error, Result};
use crate::frame::Plane;
use crate::method::Session;
use crate::scene::Camera;
use crate::setting::Word;
use crate::verdict::client::Client;
use crate::verdict::shift::{LIMITS, Shift};
use crate::verdict::{Doubt, Fault, Finding, Outcome, StageVerdict, Unlike, Verdict};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A verdict, with what its report shows beside it.
pub struct VerdictReport<'a> {
    verdict: &'a Verdict,
    client: &'a Client,
    method: &'static str,
    likely: Option<String>,
    /// The surfels with the largest weights at the worst pixel.
    heaviest: Vec<(u32, f64)>,
    /// The command that explains a pixel.
    replay: &'a (dyn Fn((u32, u32)) -> String + Sync),
}

impl fmt::Debug for VerdictReport<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "VerdictReport({})", self.ending())
    }
}

/// How many surfels of a pixel are named.
const NAMED: usize = 5;

impl<'a> VerdictReport<'a> {
    /// A report on the verdict about a client. `likely` is the mistake that
    /// [`likely_cause`](crate::verdict::causes::likely_cause) found, and `replay` gives the command
    /// that explains a pixel.
    ///
    /// # Errors
    /// As [`Session::weights`].
    pub fn new(
        session: &Session<'_>,
        camera: &Camera,
        (client, verdict, likely): (&'a Client, &'a Verdict, Option<String>),
        replay: &'a (dyn Fn((u32, u32)) -> String + Sync),
    ) -> Result<Self> {
        let heaviest = match worst(verdict) {
            Some(worst) => session.weights(camera, worst.pixel)?,
            None => Vec::new(),
        };
        Ok(Self { verdict, client, method: session.method().name(), likely, heaviest, replay })
    }

    /// The lines of the report.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let facts = self.facts().into_iter();
        let lines = facts.map(|(label, text)| format!("{label:<14} {text}"));
        lines.chain([self.ending()]).collect()
    }

    /// Labels and texts: the report without its last line.
    fn facts(&self) -> Vec<(String, String)> {
        let Self { verdict, client, method, likely, heaviest, replay } = self;
        let mut lines = vec![labelled("client", planes(client, method))];
        let promise = format!("{}, {}", client.rounding.word(), client.rounding.promise());
        lines.push(labelled("promise", promise));
        lines.extend(verdict.stages.iter().map(|stage| labelled(stage.stage, judged(stage))));
        if let Some((stage, worst)) =
            verdict.first_wrong().and_then(|stage| Some((stage, stage.worst.as_ref()?)))
        {
            let (x, y) = worst.pixel;
            let Finding { fault, error, .. } = worst;
            let by = if error.is_finite() {
                format!(": {} bounds", short(*error))
            } else {
                String::new()
            };
            lines.push(labelled("worst", format!("{} at ({x}, {y}): {fault}{by}", stage.stage)));
            let of = |(surfel, weight): &(u32, f64)| format!("{surfel} ({})", short(*weight));
            let named: Vec<String> = heaviest.iter().take(NAMED).map(of).collect();
            if !named.is_empty() {
                lines.push(labelled("surfels", format!("heaviest there: {}", named.join(", "))));
            }
            if let Some(likely) = likely {
                lines.push(labelled("looks like", likely));
            }
            lines.push(labelled("replay", replay((x, y))));
        } else if let Some(next) = next(verdict) {
            lines.push(labelled("sharper", next));
        }
        lines.extend(verdict.unlike.iter().map(|unlike| labelled("unlike", unlike)));
        let shifts = LIMITS.into_iter().zip(&verdict.shifts);
        let visible = shifts.filter(|(_, shift)| shift.z().abs() >= Shift::REMARK);
        lines.extend(visible.map(|(limit, shift)| labelled("shift", leaning(limit, shift))));
        lines
    }

    /// The verdict in a sentence.
    #[must_use]
    pub fn ending(&self) -> String {
        let Verdict { undecided, covered, unbounded, budget, .. } = self.verdict;
        let share = |pixels: u64| 100.0 * pixels as f64 / (*covered).max(1) as f64;
        match self.verdict.outcome() {
            Outcome::Right => {
                format!("right: of {covered} covered pixels {undecided} have undecided sums")
            }
            Outcome::Unlike => {
                "unlike: right in each pixel, but no right renderer that was tried has such errors"
                    .into()
            }
            Outcome::Wrong => {
                "wrong: no implementation that keeps the promise can produce this".into()
            }
            Outcome::Undecidable if !self.verdict.judges() => {
                "undecidable: no plane was judged; `render --stages` shows what to hand in".into()
            }
            Outcome::Undecidable => format!(
                "undecidable: {} % of the covered pixels have undecided sums, {} % have numbers \
                 without bounds; the budget is {} %",
                short(share(*undecided)),
                short(share(*unbounded)),
                short(100.0 * budget)
            ),
        }
    }

    /// The report as JSON, for other programs.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the numbers cannot be written as JSON.
    pub fn json(&self) -> Result<String> {
        let Self { verdict, client, method, likely, heaviest, replay } = self;
        let json = Json {
            outcome: verdict.outcome().word(),
            method,
            promise: client.rounding.word(),
            covered: verdict.covered,
            undecided: verdict.undecided,
            budget: verdict.budget,
            first_wrong: verdict.first_wrong().map(|stage| stage.stage),
            looks_like: likely.as_deref(),
            heaviest: heaviest.clone(),
            replay: worst(verdict).map(|worst| replay(worst.pixel)),
            stages: verdict.stages.iter().map(JsonStage::new).collect(),
            unlike: verdict.unlike.iter().map(JsonUnlike::new).collect(),
            shifts: LIMITS.iter().zip(&verdict.shifts).map(JsonShift::new).collect(),
        };
        let text = serde_json::to_string_pretty(&json);
        text.map(|text| text + "\n").map_err(|error| Error::Invalid(error.to_string()))
    }
}

fn labelled(label: &str, text: impl fmt::Display) -> (String, String) {
    (label.to_owned(), text.to_string())
}

/// The planes that the client handed in.
fn planes(client: &Client, method: &str) -> String {
    let count = client.frame().planes.len();
    let plural = if count == 1 { "plane" } else { "planes" };
    let known = format!("{count} {plural} of {method}");
    match client.unknown.as_slice() {
        [] => known,
        unknown => format!("{known}; not judged: {}", unknown.join(", ")),
    }
}

/// A stage in words.
fn judged(stage: &StageVerdict) -> String {
    if stage.planes.is_empty() {
        return "not judged: none of its planes was handed in".into();
    }
    let names: Vec<&str> =
        stage.planes.iter().map(|name| if name.is_empty() { "RGB" } else { name }).collect();
    let what = match stage.wrong {
        0 => {
            let worst =
                stage.errors.values().iter().fold(0.0_f32, |a, &b| if b > a { b } else { a });
            format!("right, to {} bounds", short(f64::from(worst)))
        }
        1 => "WRONG in 1 pixel".into(),
        wrong => format!("WRONG in {wrong} pixels"),
    };
    let doubts = Doubt::ALL.map(|doubt| (doubt.name(), stage.doubtful(doubt as u8)));
    let doubts: Vec<String> = doubts
        .into_iter()
        .filter(|(_, pixels)| *pixels > 0)
        .map(|(name, pixels)| format!("{name} {pixels}"))
        .collect();
    let doubts = match doubts.as_slice() {
        [] => String::new(),
        doubts => format!("; undecided: {}", doubts.join(", ")),
    };
    let missing = match stage.missing.as_slice() {
        [] => String::new(),
        missing => format!("; not handed in: {}", missing.join(", ")),
    };
    format!("{what} ({}){doubts}{missing}", names.join(", "))
}

/// The bias of the undecided decisions at a threshold, in words.
#[must_use]
pub fn leaning(limit: Doubt, shift: &Shift) -> String {
    let estimate = shift.estimate();
    format!(
        "{}: {} undecided decisions, as if the threshold were {:.1e} of itself too {}; z = {:.1}",
        limit.name(),
        shift.decisions,
        estimate.abs(),
        if estimate < 0.0 { "small" } else { "large" },
        shift.z()
    )
}

/// The plane to hand in next, so that more can be judged.
fn next(verdict: &Verdict) -> Option<String> {
    let lacks = |stage: &&StageVerdict| stage.planes.is_empty() || !stage.missing.is_empty();
    let StageVerdict { stage, missing, .. } = verdict.stages.iter().find(lacks)?;
    Some(match missing.as_slice() {
        [] => format!("hand in the planes of the stage {stage}; render --stages shows them"),
        [first, ..] => {
            format!(
                "hand in {first} of the stage {stage}; planes that follow from it are not judged"
            )
        }
    })
}

/// The fields that a verdict as JSON has, and the fields of each of its stages.
#[must_use]
pub fn fields() -> [Vec<String>; 2] {
    let keys = |value: serde_json::Result<serde_json::Value>| match value {
        Ok(serde_json::Value::Object(fields)) => fields.into_iter().map(|(key, _)| key).collect(),
        _ => Vec::new(),
    };
    let [verdict, stage] =
        [serde_json::to_value(Json::default()), serde_json::to_value(JsonStage::default())];
    [keys(verdict), keys(stage)]
}

/// A verdict as JSON; infinite numbers are null.
#[derive(Serialize, Default)]
struct Json<'a> {
    outcome: &'static str,
    method: &'static str,
    promise: &'static str,
    covered: u64,
    undecided: u64,
    budget: f64,
    first_wrong: Option<&'static str>,
    looks_like: Option<&'a str>,
    heaviest: Vec<(u32, f64)>,
    /// The command that explains the worst pixel of the first wrong stage.
    replay: Option<String>,
    stages: Vec<JsonStage<'a>>,
    unlike: Vec<JsonUnlike>,
    shifts: Vec<JsonShift>,
}

/// The bias of the undecided decisions at a threshold; z and the estimate are for readers.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JsonShift {
    /// The name of the threshold.
    pub limit: String,
    decisions: u64,
    score: f64,
    information: f64,
    variance: f64,
    z: f64,
    estimate: f64,
}

impl JsonShift {
    /// The sums at a threshold.
    #[must_use]
    pub fn new((limit, shift): (&Doubt, &Shift)) -> Self {
        let Shift { decisions, score, information, variance } = *shift;
        let (z, estimate) = (shift.z(), shift.estimate());
        Self { limit: limit.name().into(), decisions, score, information, variance, z, estimate }
    }

    /// Whether a picture can have these sums.
    #[must_use]
    pub fn is_possible(&self) -> bool {
        let Self { score, information, variance, .. } = *self;
        score.is_finite()
            && (0.0..f64::INFINITY).contains(&information)
            && (0.0..f64::INFINITY).contains(&variance)
    }

    /// The sums, to be added over pictures.
    #[must_use]
    pub fn shift(&self) -> Shift {
        let Self { decisions, score, information, variance, .. } = *self;
        Shift { decisions, score, information, variance }
    }
}

/// A stage whose errors are unlike those of right renderers.
#[derive(Serialize)]
struct JsonUnlike {
    stage: &'static str,
    quantile: f64,
    error: f64,
    usual: f64,
}

impl JsonUnlike {
    fn new(unlike: &Unlike) -> Self {
        let Unlike { stage, quantile, error, usual } = *unlike;
        Self { stage, quantile, error, usual }
    }
}

/// The findings about a stage, as JSON.
#[derive(Debug, Serialize, Default)]
pub struct JsonStage<'a> {
    stage: &'static str,
    planes: &'a [&'static str],
    missing: &'a [String],
    wrong: u64,
    undecided: Vec<(&'static str, u64)>,
    worst: Option<JsonFinding>,
    wrong_pixels: Vec<JsonPixel>,
    histogram: JsonHistogram,
}

/// A wrong pixel and its error in bounds.
#[derive(Debug, Serialize)]
struct JsonPixel {
    pixel: (u32, u32),
    error: f32,
}

/// How many pixels have errors in which range.
#[derive(Debug, Serialize, Default)]
struct JsonHistogram {
    /// The edges, ascending.
    edges: [f32; EDGES.len()],
    /// The number of pixels with an error up to the first edge, then of each range above an edge up
    /// to the next, and last above all edges.
    counts: Vec<u64>,
}

#[derive(Debug, Serialize)]
struct JsonFinding {
    pixel: (u32, u32),
    error: f64,
    fault: String,
    found: Option<f64>,
    interval: Option<[f64; 2]>,
    surfel: Option<u32>,
}

impl<'a> JsonStage<'a> {
    /// The findings about a stage.
    #[must_use]
    pub fn new(stage: &'a StageVerdict) -> Self {
        let undecided = Doubt::ALL.map(|doubt| (doubt.name(), stage.doubtful(doubt as u8)));
        Self {
            stage: stage.stage,
            planes: &stage.planes,
            missing: &stage.missing,
            wrong: stage.wrong,
            undecided: undecided.to_vec(),
            worst: stage.worst.as_ref().map(JsonFinding::new),
            wrong_pixels: wrong_pixels(&stage.errors),
            histogram: histogram(stage.errors.values()),
        }
    }
}

/// The most wrong pixels of a stage that the JSON lists.
const MOST_WRONG: usize = 1000;

/// The edges of the histogram of errors in bounds. Up to 1 a pixel is right.
const EDGES: [f32; 18] = [
    0.0, 0.001, 0.01, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 10.0, 100.0,
    1000.0,
];

/// The worst wrong pixels, the worst first.
fn wrong_pixels(errors: &Plane<f32>) -> Vec<JsonPixel> {
    let width = errors.width().max(1) as usize;
    let errors = errors.values();
    let mut wrong: Vec<usize> = (0..errors.len()).filter(|&i| errors[i] > 1.0).collect();
    wrong.sort_by(|&a, &b| errors[b].total_cmp(&errors[a]).then(a.cmp(&b)));
    let pixel = |i: usize| ((i % width) as u32, (i / width) as u32);
    let wrong = wrong.into_iter().take(MOST_WRONG);
    wrong.map(|i| JsonPixel { pixel: pixel(i), error: errors[i] }).collect()
}

fn histogram(errors: &[f32]) -> JsonHistogram {
    let mut counts = vec![0; EDGES.len() + 1];
    for error in errors {
        counts[EDGES.partition_point(|edge| edge < error)] += 1;
    }
    JsonHistogram { edges: EDGES, counts }
}

/// The worst pixel of the first wrong stage.
fn worst(verdict: &Verdict) -> Option<&Finding> {
    verdict.first_wrong()?.worst.as_ref()
}

impl JsonFinding {
    fn new(finding: &Finding) -> Self {
        let (found, interval, surfel) = match finding.fault {
            Fault::Value { found, truth, radius, .. } => {
                (Some(found), Some([truth - radius, truth + radius]), None)
            }
            Fault::Whole { found, truth, .. } => {
                (Some(found.into()), Some([truth.into(), truth.into()]), None)
            }
            Fault::NoSuchDepth { found, .. } | Fault::Hidden { found, .. } => {
                (Some(found), None, None)
            }
            Fault::LeftOut { surfel, found, .. } => (Some(found), None, Some(surfel)),
            Fault::NotProjected { surfel }
            | Fault::Projected { surfel }
            | Fault::Copied { surfel }
            | Fault::Absent { surfel }
            | Fault::Outside { surfel, .. }
            | Fault::Tie { surfel, .. } => (None, None, Some(surfel)),
        };
        let fault = finding.fault.to_string();
        Self { pixel: finding.pixel, error: finding.error, fault, found, interval, surfel }
    }
}
