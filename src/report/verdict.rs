//! Prints a verdict in about ten lines, or as JSON.

mod json;
mod page;

use json::{Json, JsonUnlike};
pub use json::{JsonShift, JsonStage, fields};

use super::short;
use crate::error::{Error, Result};
use crate::frame::Rect;
use crate::method::Session;
use crate::scene::Camera;
use crate::setting::Word;
use crate::verdict::client::Client;
use crate::verdict::shift::{LIMITS, Shift};
use crate::verdict::{Doubt, Finding, Outcome, StageVerdict, Verdict};
use std::fmt;

/// A verdict, with what its report shows beside it.
pub struct VerdictReport<'a> {
    verdict: &'a Verdict,
    client: &'a Client,
    method: &'static str,
    likely: Option<String>,
    /// The pixels that were judged, if not all of them were.
    region: Option<Rect>,
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
        client: &'a Client,
        verdict: &'a Verdict,
        likely: Option<String>,
        replay: &'a (dyn Fn((u32, u32)) -> String + Sync),
    ) -> Result<Self> {
        let heaviest = match worst(verdict) {
            Some(worst) => session.weights(camera, worst.pixel)?,
            None => Vec::new(),
        };
        let (window, method) = (session.window(camera)?, session.method().name());
        let region = (window != Rect::of_size(camera.size())).then_some(window);
        Ok(Self { verdict, client, method, likely, region, heaviest, replay })
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
        let Self { verdict, client, method, likely, region, heaviest, replay } = self;
        let mut lines = vec![labelled("client", planes(client, method))];
        let promise = format!("{}, {}", client.rounding.word(), client.rounding.promise());
        lines.push(labelled("promise", promise));
        if let Some(Rect { x0, y0, x1, y1 }) = region {
            lines.push(labelled(
                "region",
                format!("{x0},{y0},{x1},{y1}; the other pixels are not judged"),
            ));
        }
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
            Outcome::Undecidable if !self.verdict.unjudged().is_empty() => format!(
                "undecidable: nothing is wrong, but not judged are {}, because planes that they \
                 follow from were not handed in",
                abridged(&self.verdict.unjudged())
            ),
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
        let Self { verdict, client, method, likely, region, heaviest, replay } = self;
        let json = Json {
            outcome: verdict.outcome().word(),
            method,
            promise: client.rounding.word(),
            region: region.map(|Rect { x0, y0, x1, y1 }| [x0, y0, x1, y1]),
            covered: verdict.covered,
            undecided: verdict.undecided,
            budget: verdict.budget,
            first_wrong: verdict.first_wrong().map(|stage| stage.stage),
            looks_like: likely.as_deref(),
            heaviest: heaviest.clone(),
            replay: worst(verdict).map(|worst| replay(worst.pixel)),
            stages: verdict.stages.iter().map(JsonStage::new).collect(),
            unlike: verdict.unlike.iter().map(JsonUnlike::new).collect(),
            shifts: LIMITS
                .iter()
                .zip(&verdict.shifts)
                .map(|(limit, shift)| JsonShift::new(limit, shift))
                .collect(),
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
    let unjudged = stage.unjudged.join(", ");
    match (stage.planes.is_empty(), unjudged.as_str()) {
        (true, "") => return "not judged: none of its planes was handed in".into(),
        (true, unjudged) => return format!("not judged ({unjudged}){}", missing(stage)),
        _ => {}
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
    let unjudged = if unjudged.is_empty() { unjudged } else { format!("; not judged: {unjudged}") };
    format!("{what} ({}){doubts}{unjudged}{}", names.join(", "), missing(stage))
}

/// The planes that were not handed in, in words.
fn missing(stage: &StageVerdict) -> String {
    match stage.missing.as_slice() {
        [] => String::new(),
        missing => format!("; not handed in: {}", missing.join(", ")),
    }
}

/// The first names of a list, and how many there are more.
fn abridged(names: &[&str]) -> String {
    match names.len().saturating_sub(NAMED) {
        0 => names.join(", "),
        more => format!("{} and {more} more", names[..NAMED].join(", ")),
    }
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
        [first, ..] => format!("hand in {first} of the stage {stage}"),
    })
}

/// The worst pixel of the first wrong stage.
fn worst(verdict: &Verdict) -> Option<&Finding> {
    verdict.first_wrong()?.worst.as_ref()
}
