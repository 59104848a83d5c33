//! The verifier on the client: no lawful habit is called wrong, and every bug is found.

use crate::verify::cases::{Case, cases};
use crate::verify::client::{Bug, Habit, How, records, render};
use crate::verify::matrix::Picture;
use splatref::frame::{Exec, Samples};
use splatref::method::{Method, Session};
use splatref::number::Real;
use splatref::splat::Epsilon;
use splatref::verdict::causes::likely_cause;
use splatref::verdict::client::{Client, Rounding, Ties};
use splatref::verdict::{Outcome, Verdict};

/// What is said of a client's picture of a case, however much of it is undecided.
fn judge(case: &Case, how: How, rounding: Rounding) -> Verdict {
    judge_with(case, how, rounding, false)
}

/// The same of a client that hands in its records too, or does not.
fn judge_with(
    (scene, camera, settings): &Case,
    how: How,
    rounding: Rounding,
    own_records: bool,
) -> Verdict {
    let exec = Exec::sequential();
    let session = Session::new(scene, Method::Ewa(*settings), &exec).unwrap();
    let mut client = Client::from(&render(scene, camera, settings, how));
    client.rounding = rounding;
    client.records = own_records.then(|| records(scene, camera, settings, how));
    if how.habit == Habit::TiesToTheLast {
        client.ties = Ties::Last;
    }
    session.verify(camera, &client, 1.0).unwrap()
}

/// The pictures of every habit and every bug.
pub(crate) fn pictures(each: &mut dyn FnMut(Picture<'_>)) {
    let exec = Exec::sequential();
    for (name, (scene, camera, settings)) in cases() {
        let session = Session::new(&scene, Method::Ewa(settings), &exec).unwrap();
        let habits = Habit::ALL.iter().map(|&habit| How { habit, bug: None });
        let bugs = Bug::ALL.iter().map(|&bug| How { habit: Habit::Plain, bug: Some(bug) });
        for how in habits.chain(bugs) {
            each(Picture {
                session: &session,
                camera: &camera,
                scene: name,
                what: how.bug.map_or(how.habit.name(), Bug::name).to_owned(),
                keeps: how.bug.is_none().then(|| how.habit.promises()),
                ties: if how.habit == Habit::TiesToTheLast { Ties::Last } else { Ties::Lowest },
                frame: render(&scene, &camera, &settings, how),
            });
        }
    }
}

#[test]
fn no_lawful_habit_is_called_wrong() {
    for (name, case) in cases() {
        for &habit in Habit::ALL {
            for &promise in habit.promises() {
                let verdict = judge(&case, How { habit, bug: None }, promise);
                let wrong = verdict.first_wrong().map(|stage| (stage.stage, &stage.worst));
                assert_eq!(wrong, None, "{name}, {}, {promise:?}", habit.name());
                // But for the cases whose decisions are at their limits.
                let share = verdict.undecided as f64 / verdict.covered as f64;
                assert!(share <= 0.005 || ["rims", "ladder"].contains(&name), "{name}: {share}");
            }
        }
    }
}

#[test]
#[ignore = "slow: .ci/run runs it"]
fn with_its_records_a_client_is_judged_more_sharply() {
    let cases = cases();
    for (name, case) in &cases {
        for &habit in Habit::ALL {
            let verdict = judge_with(case, How { habit, bug: None }, Rounding::Gpu, true);
            let wrong = verdict.first_wrong().map(|stage| (stage.stage, &stage.worst));
            assert_eq!(wrong, None, "{name}, {}", habit.name());
        }
    }
    // One-sided mistakes that hide within the rounding of a projection.
    for bug in [Bug::CutoffSmaller, Bug::CutoffLarger, Bug::FastExp] {
        let how = How { habit: Habit::Plain, bug: Some(bug) };
        let found = |own| {
            let wrong = |(_, case): &&(_, Case)| {
                judge_with(case, how, Rounding::Gpu, own).first_wrong().is_some()
            };
            cases.iter().filter(wrong).count()
        };
        println!("{}: {} {}", bug.name(), found(false), found(true));
        assert!(found(true) > found(false) || found(false) == cases.len(), "{}", bug.name());
    }
    // What is wrong of a projection is said of the projection.
    for bug in [Bug::LowPassDoubled, Bug::SkewSign, Bug::SplatMissing] {
        let how = How { habit: Habit::Plain, bug: Some(bug) };
        let verdicts = cases.iter().map(|(_, case)| judge_with(case, how, Rounding::Gpu, true));
        let stages: Vec<_> = verdicts.filter_map(|v| Some(v.first_wrong()?.stage)).collect();
        // The filter of ray casting is no part of a record, and a splat need not be drawn for certain.
        let projection = stages.iter().filter(|stage| **stage == "projection").count();
        assert!(projection > 1 && 2 * projection > stages.len(), "{}: {stages:?}", bug.name());
    }
}

/// The bugs that one with another rounding could take for rounding in every case.
const BELOW_WHAT_A_GPU_MAY_ROUND: [Bug; 4] =
    [Bug::CutoffLarger, Bug::CutoffBarelySmaller, Bug::CutoffBarelyLarger, Bug::RimOutside];

#[test]
fn every_bug_is_found_at_its_stage() {
    let cases = cases();
    for &bug in Bug::ALL {
        let how = How { habit: Habit::Plain, bug: Some(bug) };
        for promise in [Rounding::Ieee, Rounding::Gpu] {
            let verdicts = cases.iter().map(|(_, case)| judge(case, how, promise));
            let mut first = verdicts.filter_map(|verdict| Some(verdict.first_wrong()?.stage));
            let found = first.next();
            let missed = promise == Rounding::Gpu && BELOW_WHAT_A_GPU_MAY_ROUND.contains(&bug);
            assert_eq!(found.is_some(), !missed, "{} {promise:?}", bug.name());
            let stage = stage_of(bug);
            // A fragment that is turned is the nearest of its pixel, or is in the sums.
            let either = bug.name().starts_with("Cutoff") && found == Some("attributes");
            assert!(found.is_none_or(|found| found == stage) || either, "{} {found:?}", bug.name());
        }
    }
}

/// The stage in which a bug is first to be seen.
fn stage_of(bug: Bug) -> &'static str {
    match bug {
        Bug::AmplitudeMissing
        | Bug::RaysAffine
        | Bug::ExpWithoutHalf
        | Bug::FastExp
        | Bug::CutoffSmaller
        | Bug::CutoffLarger
        | Bug::EpsilonSubtracted
        | Bug::EpsilonStrict
        | Bug::EpsilonHalf
        | Bug::EpsilonDouble
        | Bug::EpsilonIgnored
        | Bug::EpsilonOfNearness
        | Bug::EpsilonOfDepthBuffer
        | Bug::EpsilonAlongRay
        | Bug::EpsilonOfNearestRadius
        | Bug::EpsilonOtherUnit
        | Bug::EpsilonReversed
        | Bug::NormalsNotReversed
        | Bug::HalfSums
        | Bug::SumsSaturate
        | Bug::CountOffByOne
        | Bug::NearestTwice
        | Bug::SplatTwice
        | Bug::WeightOff => "attributes",
        Bug::ColorNotDivided | Bug::NormalNotUnit => "normalization",
        Bug::NormalNotTurned | Bug::SpecularSign | Bug::Srgb | Bug::PixelNan => "shading",
        _ => "visibility",
    }
}

/// What is said of a client with a bug, if it is wrong.
fn named((scene, camera, settings): &Case, bug: Bug) -> Option<Option<String>> {
    let exec = Exec::sequential();
    let session = Session::new(scene, Method::Ewa(*settings), &exec).unwrap();
    let how = How { habit: Habit::Plain, bug: Some(bug) };
    let mut client = Client::from(&render(scene, camera, settings, how));
    client.rounding = Rounding::Ieee;
    let verdict = session.verify(camera, &client, 1.0).unwrap();
    verdict.first_wrong()?;
    Some(likely_cause(&session, camera, &client, &verdict).unwrap())
}

#[test]
fn a_unit_in_which_not_everything_is_within_epsilon_is_named() {
    let named_at = |near: f32, bug| {
        let (_, (scene, mut camera, mut settings)) = cases().swap_remove(2);
        camera.near = near;
        settings.epsilon = Epsilon::World(0.02);
        named(&(scene, camera, settings), bug).unwrap().unwrap()
    };
    for (near, bug, words) in [
        (0.5, Bug::EpsilonOfNearness, "a difference of 1/t"),
        (0.5, Bug::EpsilonOfDepthBuffer, "depth-buffer values"),
        (0.75, Bug::EpsilonOfDepthBuffer, "depth-buffer values"),
    ] {
        let said = named_at(near, bug);
        assert!(said.contains(words), "{}: {said}", bug.name());
    }
}

#[test]
fn what_is_not_of_epsilon_is_not_called_so() {
    for bug in [
        Bug::AmplitudeMissing,
        Bug::RaysAffine,
        Bug::ExpWithoutHalf,
        Bug::FastExp,
        Bug::NormalsNotReversed,
        Bug::SumsSaturate,
        Bug::CountOffByOne,
        Bug::NearestTwice,
        Bug::SplatTwice,
        Bug::WeightOff,
        Bug::DepthOfCenter,
        Bug::SlopeSign,
    ] {
        for (name, case) in cases().into_iter().take(3) {
            let said = named(&case, bug).flatten().unwrap_or_default();
            assert!(!said.contains("epsilon"), "{}, {name}: {said}", bug.name());
        }
    }
}

#[test]
fn with_records_the_wrong_fields_are_named() {
    let (_, (scene, camera, settings)) = cases().swap_remove(0);
    let exec = Exec::sequential();
    let session = Session::new(&scene, Method::Ewa(settings), &exec).unwrap();
    let named = |habit, bug| {
        let how = How { habit, bug };
        let mut client = Client::from(&render(&scene, &camera, &settings, how));
        client.records = Some(records(&scene, &camera, &settings, how));
        let verdict = session.verify(&camera, &client, 1.0).unwrap();
        likely_cause(&session, &camera, &client, &verdict).unwrap()
    };
    let said = named(Habit::Plain, Some(Bug::SkewSign)).unwrap();
    assert!(said.contains("sign of their tilt; wrong in the records: uy of "), "{said}");
    assert!(said.ends_with("surfels, -1 times what is right"), "{said}");
    let said = named(Habit::Plain, Some(Bug::LowPassDoubled)).unwrap();
    assert!(said.contains("added twice; wrong in the records: ux of "), "{said}");
    assert_eq!(named(Habit::Coarse, None), None, "a lawful client has no mistake");
}

/// Colours that are all off by most of their bounds leave no interval, but no rounding leaves them.
#[test]
fn errors_to_one_side_are_unlike_those_of_a_right_renderer() {
    let (_, (scene, camera, settings)) = cases().swap_remove(0);
    let exec = Exec::sequential();
    let session = Session::new(&scene, Method::Ewa(settings), &exec).unwrap();
    let right = render(&scene, &camera, &settings, How::default());
    // The verdict on colours that are too large by a fraction, given for each pixel.
    let judge = |part: &dyn Fn(usize) -> f32| {
        let mut frame = right.clone();
        frame.planes.retain(|plane| plane.name.is_empty());
        if let Samples::Color(plane) = &mut frame.planes[0].samples {
            for (i, color) in plane.values_mut().iter_mut().enumerate() {
                *color = color.map(|c| c * (1.0 + part(i)));
            }
        }
        session.verify(&camera, &Client::from(&frame), 1.0).unwrap()
    };
    // An error grows as its part does, so one verdict tells which part is an error of one bound.
    let coarse = judge(&|_| 1e-3);
    let errors = coarse.stages.last().unwrap().errors.values();
    let outcome = |error: f32| judge(&|i| 1e-3 * error / errors[i].at_least(1.0)).outcome();
    let outcomes = [0.25, 0.75, 1.5].map(outcome);
    assert_eq!(outcomes, [Outcome::Right, Outcome::Unlike, Outcome::Wrong]);
}
