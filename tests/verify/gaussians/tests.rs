//! What verdicts say of the renderer.

use super::scenes::{Case, suite};
use super::{Bug, Habit, How, render};
use splatref::frame::{Exec, Frame};
use splatref::method::{Method, Session};
use splatref::verdict::causes::likely_cause;
use splatref::verdict::client::{Client, Rounding};
use splatref::verdict::conformance::{self, Renderer, run};
use splatref::verdict::{Outcome, Verdict};

/// What a client hands in: every plane, or the picture alone.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Planes {
    All,
    Picture,
}

/// The client of a picture.
pub(super) fn client(frame: &Frame<f32>, planes: Planes, rounding: Rounding) -> Client {
    let mut frame = frame.clone();
    frame.planes.retain(|plane| planes == Planes::All || plane.name.is_empty());
    let mut client = Client::from(&frame);
    client.rounding = rounding;
    client
}

pub(super) fn session<'a>(case: &'a Case, exec: &'a Exec) -> Session<'a> {
    Session::new(&case.scene, Method::Gaussians(case.settings), exec).unwrap()
}

pub(super) fn draw(case: &Case, how: How) -> Frame<f32> {
    render(&case.scene, &case.camera, &case.settings, how)
}

pub(super) fn bug(bug: Bug) -> How {
    How { habit: Habit::Plain, bug: Some(bug) }
}

pub(super) fn alarms(verdict: &Verdict) -> bool {
    matches!(verdict.outcome(), Outcome::Wrong | Outcome::Unlike)
}

/// The lawful pictures of some scenes that a verdict accuses.
pub(super) fn accused(cases: &[Case]) -> Vec<String> {
    let exec = Exec::sequential();
    let mut accused = Vec::new();
    for case in cases {
        let session = session(case, &exec);
        for &habit in Habit::ALL {
            let frame = draw(case, How { habit, bug: None });
            for (planes, rounding) in [
                (Planes::All, *habit.promises().first().unwrap()),
                (Planes::All, Rounding::Gpu),
                (Planes::Picture, Rounding::Gpu),
            ] {
                let client = client(&frame, planes, rounding);
                let verdict = session.verify(&case.camera, &client, 1.0).unwrap();
                if alarms(&verdict) {
                    let worst = verdict.first_wrong().map(|stage| &stage.worst);
                    let (name, habit) = (case.name, habit.name());
                    accused.push(format!("{habit} in {name}, {rounding:?}, {planes:?}: {worst:?}"));
                }
            }
        }
    }
    accused
}

#[test]
fn no_lawful_renderer_of_gaussians_is_called_wrong() {
    let few = ["rotation-inverse", "stop", "count-17", "beside", "orthographic", "order-pixel"];
    let few = |name: &str| {
        few.contains(&name) || name.starts_with("surface-") || name.starts_with("disc-")
    };
    let accused = accused(&suite(few));
    assert!(accused.is_empty(), "{accused:#?}");
}

/// A scene of the suite in which each bug shows, and words of its name; "" if it has none.
const SHOWN: &[(Bug, &str, &str)] = &[
    (Bug::LowPassSmall, "low-pass", "variance: 0.1"),
    (Bug::LowPassLarge, "low-pass-0.1", "variance: 0.3"),
    (Bug::CompensationMissing, "compensation-floor", "are not compensated"),
    (Bug::CompensationAdded, "compensation-off", "are compensated"),
    (Bug::ConicMirrored, "rotation-inverse", "a quad is mirrored"),
    (Bug::ConicExchanged, "rotation-inverse", "columns and rows are exchanged"),
    (Bug::RotationTransposed, "rotation-inverse", "rotations are reversed"),
    (Bug::CovarianceReversed, "rotation-inverse", "rotations have no effect"),
    (Bug::ViewTransposed, "from-above", "transpose of the camera's rotation"),
    (Bug::QuaternionWFirst, "rotation-inverse", "x is read where w is"),
    (Bug::QuaternionWLast, "rotation-inverse", "w is read where x is"),
    (Bug::ScalesExchanged, "rotation-inverse", "x and y are exchanged"),
    (Bug::ScaleLogarithm, "rotation-inverse", ""),
    (Bug::HalfCovariance, "rotation-inverse", "covariances in half"),
    (Bug::JacobianUnbounded, "beside", "not bounded in the Jacobian"),
    (Bug::DegreeThreeMissing, "look-of-degree-3", "end at degree 2"),
    (Bug::DirectionReversed, "direction", "direction of the harmonics is reversed"),
    (Bug::DirectionOfCamera, "direction-of-world", "camera space, y down"),
    (Bug::DirectionOfView, "direction-of-world", "camera space, y up"),
    (Bug::RestByCoefficient, "direction", "coefficients of colours are mixed"),
    (Bug::HalfMissing, "opacity", "lack their 1/2"),
    (Bug::ColorsUnbounded, "colors-below-0", "below 0 are not bounded"),
    (Bug::BlendedAsLinear, "opacity", "blended as linear light"),
    (Bug::PictureNotDecoded, "opacity", "sRGB where"),
    (Bug::OpacityIgnored, "premultiplied", "opacities are ignored"),
    (Bug::OpacityLogit, "premultiplied", ""),
    (Bug::AlphaUnbounded, "most-alpha-0.5", "alpha goes up to 1"),
    (Bug::AlphaBounded, "most-alpha-0.999", "alpha goes up to 0.99"),
    (Bug::LeastAlpha256, "many", "below an alpha of 0.00390625"),
    (Bug::LeastAlphaMissing, "least-alpha", "below an alpha of 0,"),
    (Bug::ExpWithoutHalf, "middle", "exp(-q)"),
    (Bug::CutoffThree, "cutoff-2", "3 standard"),
    (Bug::CutoffRootEight, "support", "sqrt(8) standard"),
    (Bug::TilesOf8, "least-alpha-0", ""),
    (Bug::NearMissing, "behind", "nearer than the near plane are drawn"),
    (Bug::SortedByDistance, "order-by-depth", "sorted by their distance"),
    (Bug::SortedByDepth, "order-distance", "sorted by depth"),
    (Bug::BackToFront, "opacity", "from back to front"),
    (Bug::TiesReversed, "tie", "ties: "),
    (Bug::StopAfter, "stop", "ends after the fragment"),
    (Bug::StopMissing, "stop", "at the transmittance 0,"),
    (Bug::PremultipliedTwice, "premultiplied", "premultiplied twice"),
    (Bug::BackgroundTwice, "background", "background is added once too often"),
    (Bug::SurfaceIgnored, "surface-hides", "the surface has no effect"),
    (Bug::SurfaceNotTested, "surface-cuts", "there is no depth test"),
    (Bug::SurfaceWhole, "surface-seen", "not multiplied by the transmittance"),
    (Bug::SurfaceNotSeen, "surface-seen", "the background is added"),
    (Bug::TransmittanceMissing, "opacity", ""),
    (Bug::PaddingDrawn, "count-17", "splat 0 is drawn"),
    (Bug::LastMissing, "count-17", "last splat is missing"),
    (Bug::CentersWhole, "between-pixels", "rounded to the centres"),
    (Bug::NoHalfPixel, "middle", "half a pixel to the right and down"),
    (Bug::RowsFlipped, "rows-run-down", "rows are flipped"),
    (Bug::PrincipalPointIgnored, "principal-point", "middle of the picture"),
    (Bug::FocalLengthOfX, "pixel-aspect", "fx is taken for fy"),
];

/// Words of the name of a bug.
fn words(own: Bug) -> &'static str {
    SHOWN.iter().find(|(bug, ..)| *bug == own).unwrap().2
}

/// Whether a name, or none, is right for a bug.
fn is_right(own: Bug, name: Option<&str>) -> bool {
    match (words(own), name) {
        ("", name) => name.is_none(),
        (words, name) => name.is_some_and(|name| name.contains(words)),
    }
}

/// The bugs that are not found in their scenes, from every plane or from the picture alone.
#[test]
fn every_bug_of_gaussians_is_found() {
    assert_eq!(SHOWN.len(), Bug::ALL.len());
    let exec = Exec::sequential();
    let cases = suite(|name| SHOWN.iter().any(|(_, own, _)| *own == name));
    let mut missed = Vec::new();
    for &(own, scene, _) in SHOWN {
        let case = cases.iter().find(|case| case.name == scene).unwrap();
        let (session, frame) = (session(case, &exec), draw(case, bug(own)));
        for planes in [Planes::All, Planes::Picture] {
            let client = client(&frame, planes, Rounding::Gpu);
            let verdict = session.verify(&case.camera, &client, 1.0).unwrap();
            if verdict.outcome() != Outcome::Wrong {
                missed.push(format!("{} in {scene}: {planes:?}", own.name()));
            }
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

/// A bug, its scene, and the name that it gets there.
pub(super) type Named = (Bug, &'static str, Option<String>);

/// The names of some bugs in their scenes.
pub(super) fn named(some: impl Fn(Bug) -> bool) -> Vec<Named> {
    let exec = Exec::sequential();
    let cases = suite(|name| SHOWN.iter().any(|(_, own, _)| *own == name));
    let name = |&(own, scene, _): &(Bug, &'static str, &str)| {
        let case = cases.iter().find(|case| case.name == scene).unwrap();
        let session = session(case, &exec);
        let client = client(&draw(case, bug(own)), Planes::All, Rounding::Gpu);
        let verdict = session.verify(&case.camera, &client, 1.0).unwrap();
        (own, scene, likely_cause(&session, &case.camera, &client, &verdict).unwrap())
    };
    SHOWN.iter().filter(|(own, ..)| some(*own)).map(name).collect()
}

/// The names that are wrong.
pub(super) fn misnamed(named: &[Named]) -> Vec<String> {
    let wrong = named.iter().filter(|(own, _, name)| !is_right(*own, name.as_deref()));
    wrong.map(|(own, scene, name)| format!("{} in {scene}: {name:?}", own.name())).collect()
}

/// Those whose names have rules of their own. A name takes a hundred verdicts.
#[test]
fn some_bugs_of_gaussians_are_named() {
    let named = named(|own| {
        matches!(
            own,
            Bug::StopAfter
                | Bug::NearMissing
                | Bug::TiesReversed
                | Bug::PaddingDrawn
                | Bug::DirectionOfCamera
                | Bug::ViewTransposed
                | Bug::HalfMissing
        )
    });
    let wrong = misnamed(&named);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A renderer with a bug.
struct Seeded(Bug);

impl Renderer for Seeded {
    fn draw(&mut self, case: &conformance::Case) -> splatref::Result<Client> {
        let Method::Gaussians(settings) = case.method else { panic!("a rule of Gaussians") };
        Ok(Client::from(&render(&case.scene, &case.camera, &settings, bug(self.0))))
    }
}

/// A scene may have several explanations; the report names the one of most scenes.
#[test]
fn a_suite_names_the_mistake_that_explains_its_scenes() {
    let exec = Exec::new(0, 32).unwrap();
    let few = ["flat", "needle", "low-pass", "stop", "scale-axes", "linear"];
    let some = |rule: &conformance::Rule| few.contains(&rule.name.as_str());
    let report = run("gaussians", &mut Seeded(Bug::LowPassSmall), some, &exec).unwrap();
    let common = report.common().unwrap_or_else(|| panic!("{report}"));
    assert!(common.mistake.contains("low-pass"), "{common}");
    assert!(common.mistake.contains("0.1"), "{common}");
    assert!(3 * common.explains > 2 * common.wrong, "{report}");
    assert!(report.summary().contains(&common.to_string()), "{report}");
}
