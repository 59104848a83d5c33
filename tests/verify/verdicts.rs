//! The verifier on the client: no lawful habit is called wrong, and every bug is found.

use crate::cases::{Case, cases};
use crate::client::{Bug, Habit, How, render};
use splatref::frame::Exec;
use splatref::method::{Method, Session};
use splatref::verify::client::{Client, Rounding, Ties};
use splatref::verify::verdict::Verdict;

/// What is said of a client's picture of a case, however much of it is undecided.
fn judge((scene, camera, settings): &Case, how: How, rounding: Rounding) -> Verdict {
    let exec = Exec::sequential();
    let session = Session::new(scene, Method::Ewa(*settings), &exec).unwrap();
    let mut client = Client::from(&render(scene, camera, settings, how));
    client.rounding = rounding;
    if how.habit == Habit::TiesToTheLast {
        client.ties = Ties::Last;
    }
    session.verify(camera, &client, 1.0).unwrap()
}

/// What a client with a habit may promise.
fn promises(habit: Habit) -> &'static [Rounding] {
    match habit {
        Habit::Plain | Habit::Fused | Habit::WideQuads | Habit::ClampHighFirst => {
            &[Rounding::Ieee, Rounding::Gpu]
        }
        _ => &[Rounding::Gpu],
    }
}

#[test]
fn no_lawful_habit_is_called_wrong() {
    for (name, case) in cases() {
        for &habit in Habit::ALL {
            for &promise in promises(habit) {
                let verdict = judge(&case, How { habit, bug: None }, promise);
                let wrong = verdict.first_wrong().map(|stage| (stage.stage, &stage.worst));
                assert_eq!(wrong, None, "{name}, {}, {promise:?}", habit.name());
                // But for the case whose decisions are all at their limits.
                let share = verdict.undecided as f64 / verdict.covered as f64;
                assert!(share <= 0.005 || name == "rims", "{name}: {share}");
            }
        }
    }
}

/// The bugs that one with another rounding could take for rounding in every case.
const BELOW_WHAT_A_GPU_MAY_ROUND: [Bug; 2] = [Bug::CutoffLarger, Bug::RimOutside];

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
            assert!(found.is_none_or(|found| found == stage), "{} {found:?}", bug.name());
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
