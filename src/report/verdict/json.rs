//! A verdict as JSON.

use crate::frame::Plane;
use crate::verdict::shift::Shift;
use crate::verdict::{Doubt, Fault, Finding, StageVerdict, Unlike};
use serde::{Deserialize, Serialize};

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
pub(super) struct Json<'a> {
    pub(super) outcome: &'static str,
    pub(super) method: &'static str,
    pub(super) promise: &'static str,
    /// x0, y0, x1, y1 of the pixels that were judged, the ends excluded, if not all of them were.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) region: Option<[u32; 4]>,
    pub(super) covered: u64,
    pub(super) undecided: u64,
    pub(super) budget: f64,
    pub(super) first_wrong: Option<&'static str>,
    pub(super) looks_like: Option<&'a str>,
    pub(super) heaviest: Vec<(u32, f64)>,
    /// The command that explains the worst pixel of the first wrong stage.
    pub(super) replay: Option<String>,
    pub(super) stages: Vec<JsonStage<'a>>,
    pub(super) unlike: Vec<JsonUnlike>,
    pub(super) shifts: Vec<JsonShift>,
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
    pub fn new(limit: &Doubt, shift: &Shift) -> Self {
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
pub(super) struct JsonUnlike {
    stage: &'static str,
    quantile: f64,
    error: f64,
    usual: f64,
}

impl JsonUnlike {
    pub(super) fn new(unlike: &Unlike) -> Self {
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
    unjudged: &'a [String],
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
            unjudged: &stage.unjudged,
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
