//! What verdicts say of the renderer.

use super::scenes::{Case, large, some, suite};
use super::{Bug, Habit, How, render};
use crate::verify::client_is_right::differences;
use splatref::frame::{Exec, Frame};
use splatref::method::{Method, Session};
use splatref::verdict::causes::likely_cause;
use splatref::verdict::client::{Client, Rounding};
use splatref::verdict::{Outcome, Verdict};

/// What a client hands in: every plane, or the picture alone.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Planes {
    All,
    Picture,
}

/// The client of a picture.
fn client(frame: &Frame<f32>, planes: Planes, rounding: Rounding) -> Client {
    let mut frame = frame.clone();
    frame.planes.retain(|plane| planes == Planes::All || plane.name.is_empty());
    let mut client = Client::from(&frame);
    client.rounding = rounding;
    client
}

fn session<'a>(case: &'a Case, exec: &'a Exec) -> Session<'a> {
    Session::new(&case.scene, Method::Gaussians(case.settings), exec).unwrap()
}

fn draw(case: &Case, how: How) -> Frame<f32> {
    render(&case.scene, &case.camera, &case.settings, how)
}

fn bug(bug: Bug) -> How {
    How { habit: Habit::Plain, bug: Some(bug) }
}

fn alarms(verdict: &Verdict) -> bool {
    matches!(verdict.outcome(), Outcome::Wrong | Outcome::Unlike)
}

/// The lawful pictures of some scenes that a verdict accuses.
fn accused(cases: &[Case]) -> Vec<String> {
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
    let accused = accused(&suite(|name| few.contains(&name)));
    assert!(accused.is_empty(), "{accused:#?}");
}

#[test]
#[ignore = "slow: .ci/run runs it"]
fn no_lawful_renderer_of_gaussians_is_called_wrong_in_any_scene() {
    let mut cases = suite(|_| true);
    cases.extend(large());
    let accused = accused(&cases);
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

/// The wrong names of some bugs in their scenes.
fn misnamed(some: impl Fn(Bug) -> bool) -> Vec<String> {
    let exec = Exec::sequential();
    let cases = suite(|name| SHOWN.iter().any(|(_, own, _)| *own == name));
    let mut wrong = Vec::new();
    for &(own, scene, _) in SHOWN.iter().filter(|(own, ..)| some(*own)) {
        let case = cases.iter().find(|case| case.name == scene).unwrap();
        let session = session(case, &exec);
        let client = client(&draw(case, bug(own)), Planes::All, Rounding::Gpu);
        let verdict = session.verify(&case.camera, &client, 1.0).unwrap();
        let said = likely_cause(&session, &case.camera, &client, &verdict).unwrap();
        if !is_right(own, said.as_deref()) {
            wrong.push(format!("{} in {scene}: {said:?}", own.name()));
        }
    }
    wrong
}

/// Those whose names have rules of their own. A name takes a hundred verdicts.
#[test]
fn some_bugs_of_gaussians_are_named() {
    let wrong = misnamed(|own| {
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
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
#[ignore = "slow: .ci/run runs it"]
fn every_bug_of_gaussians_is_named() {
    let wrong = misnamed(|_| true);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// How often a bug shows, is found from every plane, and from the picture alone.
#[test]
#[ignore = "slow: .ci/run runs it"]
fn every_bug_of_gaussians_is_found_where_it_shows() {
    let exec = Exec::sequential();
    let cases = some();
    let plain: Vec<_> = cases.iter().map(|case| draw(case, How::default())).collect();
    let mut missed = Vec::new();
    println!(
        "bug: scenes that show it, found, found from the picture; larger scenes, found, picture"
    );
    for &own in Bug::ALL {
        let mut counts = [[0; 3]; 2];
        for (case, plain) in cases.iter().zip(&plain) {
            let frame = draw(case, bug(own));
            if differences(plain, &frame).is_empty() {
                continue;
            }
            let is_large = case.camera.width > 64;
            let counts = &mut counts[usize::from(is_large)];
            counts[0] += 1;
            let session = session(case, &exec);
            for (i, planes) in [Planes::All, Planes::Picture].into_iter().enumerate() {
                let client = client(&frame, planes, Rounding::Gpu);
                let found = alarms(&session.verify(&case.camera, &client, 1.0).unwrap());
                counts[1 + i] += usize::from(found);
                if is_large && planes == Planes::All && !found {
                    missed.push(format!("{} in {}", own.name(), case.name));
                }
            }
        }
        let [[a, b, c], [d, e, f]] = counts;
        println!("{}: {a} {b} {c}; {d} {e} {f}", own.name());
    }
    assert!(missed.is_empty(), "{missed:#?}");
}
