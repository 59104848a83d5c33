//! The page of a verdict: its stages as tabs, and the decisions at the worst pixels.

use super::{VerdictReport, judged};
use crate::error::Result;
use crate::frame::{Exec, Frame, Image, Samples};
use crate::io::scene_file::Number;
use crate::method::{Holds, PlaneRow, Session, Stage};
use crate::report::page::{
    CheckRow, Explained, Kind, LISTED, Mark, Measure, Report, Shown, Tab, worst,
};
use crate::report::short;
use crate::scene::Camera;
use crate::verdict::client::Client;
use crate::verdict::{Check, Doubt, Fault, StageVerdict};

/// How many of the worst pixels of a right stage are listed. Explaining a pixel of a pyramid takes
/// as long as drawing the picture.
const LISTED_RIGHT: usize = 1;
/// The longest explanation of a pixel, in bytes.
const LONGEST: usize = 20_000;

/// What explains a pixel of a page.
struct Explaining<'a> {
    report: &'a VerdictReport<'a>,
    session: &'a Session<'a>,
    camera: &'a Camera,
    number: Number,
}

impl VerdictReport<'_> {
    /// What the page of the verdict shows. `session` and `camera` are the ones of the verdict;
    /// `number` is the arithmetic of the reference picture.
    ///
    /// # Errors
    /// As [`Session::define`] and [`Session::explain`].
    pub fn page(
        &self,
        session: &Session<'_>,
        camera: &Camera,
        number: Number,
        exec: &Exec,
    ) -> Result<Report> {
        let verdict = self.verdict;
        let reference = match number {
            Number::F32 => session.define_whole::<f32>(camera, true)?.frame,
            Number::F64 => session.define_whole::<f64>(camera, true)?.frame.to_f32(),
        };
        let client = self.client.frame().to_f32();
        let stages = session.method().stages();
        let tabs: Vec<Tab> =
            verdict.stages.iter().map(|stage| tab(stage, &client, stages)).collect();
        let mut listed: Vec<usize> = tabs.iter().flat_map(|tab| tab.worst.clone()).collect();
        listed.sort_unstable();
        listed.dedup();
        let explaining = Explaining { report: self, session, camera, number };
        let explained = exec.ordered(listed, |pixel| explaining.explained(pixel));
        let explained = explained.into_iter().collect::<Result<_>>()?;
        let shown = |(label, _): &(String, String)| {
            !verdict.stages.iter().any(|stage| stage.stage == label)
        };
        Ok(Report {
            title: format!("splatref verify: {}", self.ending()),
            facts: self.facts().into_iter().filter(shown).collect(),
            about: about(&client, self.client),
            sides: ["Client", "Reference"],
            pictures: [Image::from(&client), Image::from(&reference)],
            measure: Measure {
                name: "Error in bounds",
                unit: "bounds",
                limit: Some(1.0),
                words: ["right", "WRONG"],
            },
            tabs,
            doubts: Doubt::ALL.map(|doubt| (doubt as u8, doubt.name())).to_vec(),
            cause: self.likely.clone(),
            explained,
        })
    }
}

impl Explaining<'_> {
    /// The decisions at a pixel, and the client's values there.
    fn explained(&self, pixel: usize) -> Result<Explained> {
        let width = self.camera.width as usize;
        let at = ((pixel % width) as u32, (pixel / width) as u32);
        let text = match self.number {
            Number::F32 => self.session.explain::<f32>(self.camera, at)?,
            Number::F64 => self.session.explain::<f64>(self.camera, at)?,
        };
        let checks = self.session.checks(self.camera, self.report.client, at)?;
        Ok(Explained {
            pixel,
            checks: checks.iter().map(row).collect(),
            text: shortened(text.trim_end()),
            replay: (self.report.replay)(at),
        })
    }
}

/// What the two pictures are.
fn about(client: &Frame<f32>, from: &Client) -> String {
    let mut about = "Reference: what splatref draws, each stage from its own planes. The verdict \
                     judges each stage from the client's planes of the stage before. So a stage \
                     after a wrong one may be right although it differs from the reference."
        .to_owned();
    let rounded = from.frame().planes.iter().filter(|plane| !is_single(&plane.samples));
    let rounded: Vec<&str> =
        rounded.map(|plane| if plane.name.is_empty() { "RGB" } else { &plane.name }).collect();
    if !rounded.is_empty() {
        let rounded = rounded.join(", ");
        about += &format!(
            " These planes of the client were converted, and are shown as the nearest f32: \
             {rounded}."
        );
    }
    let [width, height] = [client.width, client.height];
    about + &format!(" The picture has {width} x {height} pixels.")
}

/// Whether every number of a plane is an `f32`.
fn is_single(samples: &Samples<f64>) -> bool {
    let single = |v: &f64| v.is_nan() || f64::from(*v as f32) == *v;
    match samples {
        Samples::Scalar(plane) => plane.values().iter().all(single),
        Samples::Color(plane) | Samples::Vector(plane) => {
            plane.values().iter().flatten().all(single)
        }
        Samples::Index(_) | Samples::Count(_) => true,
    }
}

/// The tab of a stage.
fn tab(verdict: &StageVerdict, client: &Frame<f32>, stages: &[Stage]) -> Tab {
    let errors = verdict.errors.values().to_vec();
    let own = stages.iter().find(|stage| stage.name == verdict.stage);
    let rows = client.planes.iter().filter_map(|plane| {
        // No client has a diagnostic.
        let row = own?.row(&plane.name).filter(|row| row.holds != Holds::Diagnostic)?;
        Some(shown(&plane.name, row))
    });
    let most = if verdict.wrong > 0 { LISTED } else { LISTED_RIGHT };
    Tab {
        name: verdict.stage.into(),
        says: format!("{}: {}", verdict.stage, judged(verdict)),
        mark: match verdict.wrong {
            _ if verdict.planes.is_empty() => Mark::NotJudged,
            0 => Mark::Right,
            _ => Mark::Wrong,
        },
        planes: rows.collect(),
        wrong: errors.iter().map(|error| *error > 1.0).collect(),
        doubts: verdict.doubts.values().to_vec(),
        worst: worst(&errors, most),
        errors,
    }
}

fn shown(name: &str, row: &PlaneRow) -> Shown {
    Shown {
        name: if name.is_empty() { "RGB".into() } else { name.into() },
        kind: match row.holds {
            Holds::Scalar | Holds::Diagnostic => Kind::Scalar,
            Holds::Depth => Kind::Depth,
            Holds::Color => Kind::Color,
            Holds::Vector => Kind::Vector,
            Holds::Normal => Kind::Normal,
            Holds::Index => Kind::Index,
            Holds::HighIndex | Holds::Count => Kind::Count,
        },
        unit: row.unit,
        meaning: row.meaning,
        channels: row.holds.channels(name),
    }
}

/// A checked value as texts.
fn row(check: &Check) -> CheckRow {
    let interval = match &check.fault {
        Fault::Value { channel, found, truth, radius } => {
            let [low, high] = [truth - radius, truth + radius];
            Some([channel.clone(), plain(*found), plain(low), plain(high)])
        }
        Fault::Whole { channel, found, truth } => {
            let whole = |v: u32| if v == u32::MAX { "none".to_owned() } else { v.to_string() };
            Some([channel.clone(), whole(*found), whole(*truth), whole(*truth)])
        }
        _ => None,
    };
    CheckRow {
        stage: check.stage,
        word: match check.error {
            error if error.is_nan() => "open",
            error if error > 1.0 => "WRONG",
            _ => "right",
        },
        interval,
        says: check.fault.to_string(),
        error: match check.error {
            error if error > 0.0 && error.is_finite() => format!("{} bounds", short(error)),
            _ => String::new(),
        },
        size: check.error,
    }
}

/// A number with all its digits; very small and very large ones have a power of ten.
fn plain(value: f64) -> String {
    let size = value.abs();
    if value.is_finite() && size > 0.0 && !(1e-4..1e16).contains(&size) {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}

/// The first lines of an explanation that is too long for a page.
fn shortened(text: &str) -> String {
    if text.len() <= LONGEST {
        return text.to_owned();
    }
    let end = text[..text.floor_char_boundary(LONGEST)].rfind('\n').unwrap_or(0);
    format!("{}\n... shortened; the command above prints everything", &text[..end])
}
