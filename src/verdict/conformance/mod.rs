//! Run the whole suite: small scenes, each of which tests one rule of a method.
//!
//! [`Rule::all`] lists the rules of a method. A [`Rule`] makes its [`Case`]: a scene of at most 100
//! surfels, a camera of at most 64 x 64 pixels, and the method with its settings. Two large scenes
//! end the list. Your renderer draws each case, and gets a verdict on each.
//!
//! In Rust, implement [`Renderer`] and let [`conformance!`](crate::conformance) make the tests:
//!
//! ```
//! use splatref::frame::Exec;
//! use splatref::verdict::client::Client;
//! use splatref::verdict::conformance::{Case, Renderer, run};
//!
//! /// Here splatref itself stands in for your renderer.
//! struct Mine;
//!
//! impl Renderer for Mine {
//!     fn draw(&mut self, case: &Case) -> splatref::Result<Client> {
//!         let exec = Exec::sequential();
//!         let picture = case.session(&exec)?.define::<f32>(&case.camera, true)?;
//!         Ok(Client::from(&picture.frame))
//!     }
//! }
//!
//! splatref::conformance! { my_renderer_is_right: "ewa", Mine; }
//!
//! # let exec = Exec::sequential();
//! // Or run some of the rules yourself.
//! let report = run("ewa", &mut Mine, |rule| !rule.large && rule.name.starts_with("epsilon"), &exec)?;
//! assert!(report.is_right(), "{report}");
//! # Ok::<(), splatref::Error>(())
//! ```
//!
//! For a renderer in another language, `splatref conformance` writes the cases as files and runs a
//! command for each.
//!
//! A case of `deferred` is the first frame of a sequence. So no rule tests what a frame carries to
//! the next, and none tests the settings `flags` and `share`.

mod common;
mod report;
mod rules;
mod sketch;
#[cfg(test)]
mod tests;

pub use common::Common;
pub use report::{Judged, Report, Row};

use super::causes::likely;
use super::client::Client;
use super::{StageVerdict, Verdict};
use crate::error::Result;
use crate::frame::{Exec, Frame};
use crate::method::{Holds, Method, PlaneRow, Session, Stage};
use crate::scene::{Camera, Cloud, Scene};
use sketch::Sketch;

/// A renderer that is tried on the cases.
pub trait Renderer {
    /// Draws a case, and returns the planes, by the names of [`crate::method::planes`].
    ///
    /// # Errors
    /// Whatever went wrong; the report lists the rule as failed.
    fn draw(&mut self, case: &Case) -> Result<Client>;
}

/// A rule of a method.
#[derive(Clone, Debug)]
pub struct Rule {
    /// The name, such as `rim`: small letters, digits, points and hyphens.
    pub name: String,
    /// What the case tests, in a sentence.
    pub tests: String,
    /// Whether the case is one of the large ones.
    pub large: bool,
    method: Method,
    draw: fn(&mut Sketch),
    varies: Varies,
}

/// What a renderer draws that does not keep a rule.
#[derive(Clone, Copy, Debug)]
enum Varies {
    /// The scene, changed.
    Otherwise(fn(&mut Sketch)),
    /// The scene without this setting.
    Setting(&'static str, &'static str),
}

/// A scene that tests one rule.
#[derive(Clone, Debug)]
pub struct Case {
    /// The name of the rule.
    pub rule: String,
    /// The scene. Surfels have groups if the method draws groups.
    pub scene: Scene,
    /// The primitives of the scene, as a file holds them.
    pub meshes: Vec<(Cloud, Draws)>,
    /// The camera.
    pub camera: Camera,
    /// The method and its settings.
    pub method: Method,
}

/// The primitives that a mesh is drawn as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draws {
    /// Its triangles.
    Polygons,
    /// Its edges, as ribbons.
    Ribbons,
    /// Its edges, as tubes.
    Tubes,
}

impl Draws {
    /// The word of a scene file.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Polygons => "polygons",
            Self::Ribbons => "ribbons",
            Self::Tubes => "tubes",
        }
    }
}

impl Rule {
    /// The rules of the method with this name, the large cases last.
    ///
    /// # Errors
    /// [`Usage`](crate::Error::Usage) as [`Method::by_name`].
    pub fn all(method: &str) -> Result<Vec<Self>> {
        Ok(rules::of_method(&Method::by_name(method)?))
    }

    /// The rules of a method with these settings, in place of its default ones. A rule may set some of
    /// them.
    #[must_use]
    pub fn of(method: &Method) -> Vec<Self> {
        rules::of_method(method)
    }

    /// Makes the case.
    ///
    /// # Errors
    /// [`Invalid`](crate::Error::Invalid) if there is not enough memory.
    pub fn case(&self, exec: &Exec) -> Result<Case> {
        let mut sketch = Sketch::default();
        (self.draw)(&mut sketch);
        if let Varies::Setting(name, value) = self.varies {
            sketch.set(name, value);
        }
        sketch.case(&self.name, self.method, exec)
    }

    /// Makes the case that a renderer draws which does not keep this rule, for tests of a verifier:
    /// the verdict on its picture must be "wrong".
    ///
    /// # Errors
    /// As [`Rule::case`].
    pub fn broken(&self, exec: &Exec) -> Result<Case> {
        let mut sketch = Sketch::default();
        (self.draw)(&mut sketch);
        if let Varies::Otherwise(change) = self.varies {
            change(&mut sketch);
        }
        sketch.case(&self.name, self.method, exec)
    }
}

impl Case {
    /// Prepares the case to be drawn by splatref.
    ///
    /// # Errors
    /// As [`Session::new`].
    pub fn session<'a>(&'a self, exec: &'a Exec) -> Result<Session<'a>> {
        Session::new(&self.scene, self.method, exec)
    }

    /// The planes that a renderer can hand in, stage by stage: those that splatref's own picture of
    /// the case has. A row whose name has `#` stands for a plane each of several groups, layers or
    /// levels.
    ///
    /// # Errors
    /// As [`Session::define`].
    pub fn planes(&self, exec: &Exec) -> Result<Vec<(&'static Stage, Vec<&'static PlaneRow>)>> {
        Ok(self.planes_of(&self.session(exec)?.define::<f32>(&self.camera, true)?.frame))
    }

    /// [`Case::planes`], if splatref's picture of the case with all its stages is there already.
    #[must_use]
    pub fn planes_of(&self, frame: &Frame<f32>) -> Vec<(&'static Stage, Vec<&'static PlaneRow>)> {
        let there = |row: &&'static PlaneRow| {
            row.holds != Holds::Diagnostic
                && frame.planes.iter().any(|plane| row.is_called(&plane.name))
        };
        let stages = self.method.stages().iter();
        let rows = stages.map(|stage| (stage, stage.leaves.iter().filter(there).collect()));
        rows.filter(|(_, rows): &(_, Vec<_>)| !rows.is_empty()).collect()
    }

    /// Judges the planes of a client, and looks for the mistake behind a wrong one.
    ///
    /// # Errors
    /// As [`Session::verify`].
    pub fn judge(&self, client: &Client, budget: f64, exec: &Exec) -> Result<Judged> {
        let session = self.session(exec)?;
        let verdict = session.verify(&self.camera, client, budget)?;
        let likely = likely(&session, &self.camera, client, &verdict)?;
        let sharper = self.sharper(&verdict, exec)?;
        Ok(Judged { verdict, likely, sharper, rounding: client.rounding })
    }

    /// What to hand in next: of the first stage that is not judged as a whole, the planes or the
    /// levels that the client lacks.
    fn sharper(&self, verdict: &Verdict, exec: &Exec) -> Result<Option<String>> {
        let lacks = |stage: &StageVerdict| stage.planes.is_empty() || !stage.missing.is_empty();
        // Which planes there are is only known once the case is drawn.
        let planes = if verdict.stages.iter().any(lacks) { self.planes(exec)? } else { Vec::new() };
        for (stage, rows) in planes {
            let judged = verdict.stages.iter().find(|judged| judged.stage == stage.name);
            let Some(StageVerdict { planes, missing, .. }) = judged else { continue };
            if let Some(missing) = missing.first() {
                return Ok(Some(format!("{missing} of the stage {}", stage.name)));
            }
            if planes.is_empty() {
                let names: Vec<&str> = rows.iter().map(|row| row.name).collect();
                return Ok(Some(format!("{} of the stage {}", names.join(", "), stage.name)));
            }
        }
        Ok(None)
    }
}

/// Lets a renderer draw the cases of a method that `choose` takes, and judges each.
///
/// # Errors
/// [`Usage`](crate::Error::Usage) as [`Rule::all`]; [`Invalid`](crate::Error::Invalid) if there is not enough memory. What goes
/// wrong in the renderer is part of the report.
pub fn run(
    method: &str,
    renderer: &mut dyn Renderer,
    choose: impl Fn(&Rule) -> bool,
    exec: &Exec,
) -> Result<Report> {
    let mut report = Report::new(method);
    for rule in Rule::all(method)?.into_iter().filter(choose) {
        let case = rule.case(exec)?;
        let judged = renderer.draw(&case);
        let judged = judged.and_then(|client| case.judge(&client, Verdict::BUDGET, exec));
        report.rows.push(Row::new(rule, judged));
    }
    Ok(report)
}

/// Panics unless a renderer is right in every case of a method: the body of the tests that
/// [`conformance!`](crate::conformance) makes.
///
/// # Panics
/// With the report, if a rule is not right.
pub fn assert_right(method: &str, renderer: &mut dyn Renderer) {
    let report = Exec::new(0, 32).and_then(|exec| run(method, renderer, |_| true, &exec));
    match report {
        Ok(report) => assert!(report.is_right(), "{report}"),
        Err(error) => panic!("{error}"),
    }
}

/// Makes tests of `cargo test` that run the suite of a method, one test for each line. The message
/// of a test that fails lists every rule and its verdict. Attributes such as `#[ignore]` may stand before
/// a line.
///
/// ```
/// # use splatref::verdict::{client::Client, conformance::{Case, Renderer}};
/// # struct Mine;
/// # impl Renderer for Mine {
/// #     fn draw(&mut self, case: &Case) -> splatref::Result<Client> { unimplemented!() }
/// # }
/// splatref::conformance! {
///     my_ewa_is_right: "ewa", Mine;
///     my_pyramid_is_right: "pyramid", Mine;
/// }
/// ```
#[macro_export]
macro_rules! conformance {
    ($($(#[$attribute:meta])* $test:ident: $method:expr, $renderer:expr;)+) => {$(
        #[test]
        $(#[$attribute])*
        fn $test() {
            $crate::verdict::conformance::assert_right($method, &mut $renderer);
        }
    )+};
}
