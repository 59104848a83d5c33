//! The renderer hands in its records: no lawful one is called wrong, a mistake of the projection is named
//! by its field, and compositing is accused of its own mistakes alone.

use super::scenes::{Case, large, suite};
use super::tests::{Planes, alarms, bug, client, draw, session};
use super::{Bug, Habit, How, records};
use splatref::frame::Exec;
use splatref::verdict::causes::likely_cause;
use splatref::verdict::client::Rounding;
use splatref::verdict::{Fault, Verdict};

/// The verdict on a client that hands in every plane, and its records.
fn judged(case: &Case, how: How, rounding: Rounding) -> Verdict {
    let exec = Exec::sequential();
    let mut client = client(&draw(case, how), Planes::All, rounding);
    client.gaussian_records = Some(records(case, how));
    session(case, &exec).verify(&case.camera, &client, 1.0).unwrap()
}

/// The lawful records of some scenes that a verdict accuses.
fn accused(cases: &[Case]) -> Vec<String> {
    let mut accused = Vec::new();
    for case in cases {
        for &habit in Habit::ALL {
            for rounding in [*habit.promises().first().unwrap(), Rounding::Gpu] {
                let verdict = judged(case, How { habit, bug: None }, rounding);
                assert_eq!(verdict.stages[0].stage, "projection");
                if alarms(&verdict) {
                    let worst = verdict.first_wrong().map(|stage| (stage.stage, &stage.worst));
                    let (name, habit) = (case.name, habit.name());
                    accused.push(format!("{habit} in {name}, {rounding:?}: {worst:?}"));
                }
            }
        }
    }
    accused
}

#[test]
fn no_lawful_records_are_called_wrong() {
    let few = ["rotation-inverse", "stop", "beside", "orthographic", "near", "needle"];
    let rest = ["order-pixel", "compensation-floor", "least-alpha", "count-17", "disc-tilted"];
    let accused = accused(&suite(|name| few.contains(&name) || rest.contains(&name)));
    assert!(accused.is_empty(), "{accused:#?}");
}

#[test]
#[ignore = "slow: .ci/run runs it"]
fn no_lawful_records_are_called_wrong_in_any_scene() {
    let mut cases = suite(|_| true);
    cases.extend(large());
    let accused = accused(&cases);
    assert!(accused.is_empty(), "{accused:#?}");
}

/// Mistakes of the projection, a scene that shows each, and the field that is wrong first.
const OF_PROJECTION: [(Bug, &str, &str); 19] = [
    (Bug::QuaternionWFirst, "rotation-inverse", "covariance."),
    (Bug::QuaternionWLast, "rotation-inverse", "covariance."),
    (Bug::RotationTransposed, "rotation-inverse", "covariance."),
    (Bug::CovarianceReversed, "rotation-inverse", "covariance."),
    (Bug::ViewTransposed, "from-above", "covariance."),
    (Bug::ScalesExchanged, "rotation-inverse", "covariance."),
    (Bug::ScaleLogarithm, "rotation-inverse", "covariance."),
    (Bug::HalfCovariance, "rotation-inverse", "covariance."),
    (Bug::JacobianUnbounded, "beside", "unfiltered."),
    (Bug::LowPassSmall, "low-pass", "ellipse."),
    (Bug::ConicMirrored, "rotation-inverse", "conic.xy"),
    (Bug::ConicExchanged, "rotation-inverse", "conic."),
    (Bug::CompensationMissing, "compensation-floor", "compensation"),
    (Bug::OpacityLogit, "premultiplied", "alpha"),
    (Bug::DegreeThreeMissing, "look-of-degree-3", "color."),
    (Bug::DirectionReversed, "direction", "color."),
    (Bug::SortedByDistance, "order-by-depth", "key"),
    (Bug::CentersWhole, "between-pixels", "center."),
    (Bug::FocalLengthOfX, "pixel-aspect", "center."),
];

#[test]
fn mistakes_of_the_projection_are_named_by_field_and_accuse_nothing_else() {
    let cases = suite(|name| OF_PROJECTION.iter().any(|(_, own, _)| *own == name));
    let mut wrong = Vec::new();
    for (own, scene, field) in OF_PROJECTION {
        let case = cases.iter().find(|case| case.name == scene).unwrap();
        let verdict = judged(case, bug(own), Rounding::Gpu);
        let first = verdict.first_wrong();
        let named = first.and_then(|stage| stage.worst.as_ref()).is_some_and(|worst| {
            matches!(&worst.fault, Fault::Value { channel, .. }
                if channel.starts_with(field) && channel.contains(" of surfel "))
        });
        let stages: Vec<_> =
            verdict.stages.iter().map(|stage| (stage.stage, stage.wrong)).collect();
        let alone = verdict.stages[1..].iter().all(|stage| stage.wrong == 0);
        if !(named && alone) {
            let worst = first.map(|stage| &stage.worst);
            wrong.push(format!("{} in {scene}: {stages:?}, {worst:?}", own.name()));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn mistakes_of_compositing_are_found_there_where_records_are_right() {
    let all = [
        (Bug::BackToFront, "opacity"),
        (Bug::PremultipliedTwice, "premultiplied"),
        (Bug::TransmittanceMissing, "opacity"),
        (Bug::StopAfter, "stop"),
        (Bug::ExpWithoutHalf, "middle"),
        (Bug::AlphaUnbounded, "most-alpha-0.5"),
        (Bug::TiesReversed, "tie"),
        (Bug::NoHalfPixel, "middle"),
    ];
    let cases = suite(|name| all.iter().any(|(_, own)| *own == name));
    for (own, scene) in all {
        let case = cases.iter().find(|case| case.name == scene).unwrap();
        let verdict = judged(case, bug(own), Rounding::Gpu);
        let first = verdict.first_wrong().map(|stage| stage.stage);
        assert_eq!(first, Some("blending"), "{} in {scene}", own.name());
        assert_eq!(verdict.stages[0].wrong, 0);
    }
}

/// A client that leaves a splat out leaves out its record, or that of another splat.
#[test]
fn missing_records_and_records_too_many_are_found() {
    let exec = Exec::sequential();
    let cases = suite(|name| name == "count-17" || name == "behind");
    let [count, behind] =
        ["count-17", "behind"].map(|name| cases.iter().find(|case| case.name == name).unwrap());
    let verdict = judged(count, bug(Bug::LastMissing), Rounding::Gpu);
    let worst = verdict.first_wrong().unwrap().worst.as_ref().unwrap();
    assert!(matches!(worst.fault, Fault::NotProjected { surfel: 16 }), "{worst:?}");
    let verdict = judged(behind, bug(Bug::NearMissing), Rounding::Gpu);
    let worst = verdict.first_wrong().unwrap().worst.as_ref().unwrap();
    assert!(matches!(worst.fault, Fault::Projected { .. }), "{worst:?}");
    // A record beside the scene.
    let mut client = client(&draw(count, How::default()), Planes::All, Rounding::Gpu);
    let mut all = records(count, How::default());
    all.push(splatref::method::gaussians::record::GaussianRecord { index: 17, ..all[0] });
    client.gaussian_records = Some(all);
    let verdict = session(count, &exec).verify(&count.camera, &client, 1.0).unwrap();
    let worst = verdict.first_wrong().unwrap().worst.as_ref().unwrap();
    assert!(matches!(worst.fault, Fault::Projected { surfel: 17 }), "{worst:?}");
}

/// The cause says which setting explains the records, and which of their fields are wrong.
#[test]
fn a_mistake_of_the_projection_has_a_name_with_its_fields() {
    let exec = Exec::sequential();
    let case = &suite(|name| name == "many")[0];
    let how = bug(Bug::LowPassSmall);
    let mut client = client(&draw(case, how), Planes::All, Rounding::Gpu);
    client.gaussian_records = Some(records(case, how));
    let session = session(case, &exec);
    let verdict = session.verify(&case.camera, &client, 1.0).unwrap();
    let said = likely_cause(&session, &case.camera, &client, &verdict).unwrap().unwrap();
    for words in ["variance: 0.1", "; wrong in the records: ellipse.xx of "] {
        assert!(said.contains(words), "{said}");
    }
}
