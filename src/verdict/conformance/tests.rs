//! Every case is right by its own reference, and wrong by a renderer that does not keep its rule.

use super::*;
use crate::method::gaussians;
use crate::scene::Gaussians;
use crate::setting::{Fields, Words};
use crate::verdict::Outcome;
use crate::verdict::client::Rounding;
use std::collections::BTreeSet;

fn methods() -> impl Iterator<Item = &'static str> {
    Method::all().into_iter().map(|method| method.name())
}

/// splatref, with what it draws in place of a case.
fn drawn(case: &Case, exec: &Exec) -> Client {
    let session = case.session(exec).unwrap();
    Client::from(&session.define::<f32>(&case.camera, true).unwrap().frame)
}

#[test]
fn every_method_has_25_small_rules_with_names_of_their_own() {
    for method in methods() {
        let rules = Rule::all(method).unwrap();
        let names: BTreeSet<&str> = rules.iter().map(|rule| rule.name.as_str()).collect();
        assert_eq!(names.len(), rules.len(), "{method}: a name stands twice");
        let named = |name: &&str| {
            name.bytes().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || b".-".contains(&c))
        };
        assert!(names.iter().all(named), "{names:?}");
        let small = rules.iter().filter(|rule| !rule.large).count();
        assert!(small >= 25 && rules.len() >= small + 2, "{method}: {small} of {}", rules.len());
        assert!(rules.iter().all(|rule| rule.tests.ends_with('.')), "{method}");
    }
    assert!(Rule::all("wea").is_err());
}

#[test]
fn every_setting_has_a_rule() {
    // Culling has rules of its own, a preset sets other settings, whether blending ends at its
    // limit shows at one number that no promise of rounding settles, and the last two change only the
    // frames after the first.
    let others = ["cull", "kernel", "preset", "stop_at", "flags", "share"];
    for mut method in Method::all() {
        let rules = Rule::all(method.name()).unwrap();
        let name = method.name();
        method.fields(&mut |field| {
            let of = |rule: &Rule| {
                matches!(rule.varies, Varies::Setting(setting, _) if setting == field.name)
            };
            let found = others.contains(&field.name) || rules.iter().any(of);
            assert!(found, "{name}: no rule for `{}`; add one to rules/settings.rs", field.name);
        });
    }
}

/// What is wrong with the rules of a method, under these promises.
fn flaws(method: &str, large: bool, promises: &[Rounding], exec: &Exec) -> Vec<String> {
    let rules = Rule::all(method).unwrap().into_iter().filter(|rule| rule.large == large);
    let mut flaws = Vec::new();
    for rule in rules {
        let (case, broken) = (rule.case(exec).unwrap(), rule.broken(exec).unwrap());
        let most = if large { (5100, 320) } else { (100, 64) };
        let size = case.camera.size();
        let gaussians = case.scene.gaussians.as_ref().map_or(0, Gaussians::len);
        if case.scene.surfels.len() + gaussians > most.0 || size.iter().any(|&side| side > most.1) {
            flaws.push(format!("{method} {}: too large", rule.name));
        }
        let (own, other) = (drawn(&case, exec), drawn(&broken, exec));
        for &rounding in promises {
            for (client, wanted) in [(&own, Outcome::Right), (&other, Outcome::Wrong)] {
                let client = Client { rounding, ..client.clone() };
                let session = case.session(exec).unwrap();
                let verdict = session.verify(&case.camera, &client, Verdict::BUDGET).unwrap();
                if verdict.outcome() != wanted {
                    let fault = verdict.first_wrong().and_then(|stage| stage.worst.as_ref());
                    flaws.push(format!(
                        "{method} {} {rounding:?}: {:?}, not {wanted:?}: {} of {}, {fault:?}",
                        rule.name,
                        verdict.outcome(),
                        verdict.undecided,
                        verdict.covered
                    ));
                }
            }
        }
    }
    flaws
}

#[test]
fn a_case_is_right_and_is_wrong_if_its_rule_is_broken() {
    let exec = Exec::new(0, 32).unwrap();
    let promises = [Rounding::default()];
    let flaws = methods().flat_map(|method| flaws(method, false, &promises, &exec));
    let flaws: Vec<String> = flaws.collect();
    assert!(flaws.is_empty(), "{}", flaws.join("\n"));
}

/// With another program's rules a case is still right; what is broken may not show.
#[test]
fn a_case_of_gaussians_is_right_with_every_preset() {
    let exec = Exec::new(0, 32).unwrap();
    for (word, preset) in gaussians::Settings::WORDS {
        for rule in Rule::of(&Method::from(*preset)).iter().filter(|rule| !rule.large) {
            let case = rule.case(&exec).unwrap();
            let judged = case.judge(&drawn(&case, &exec), Verdict::BUDGET, &exec).unwrap();
            assert_eq!(judged.verdict.outcome(), Outcome::Right, "{word}: {}", rule.name);
        }
    }
}

#[test]
#[ignore = "slow: .ci/run runs it"]
fn so_it_is_under_every_promise_and_if_it_is_large() {
    let exec = Exec::new(0, 32).unwrap();
    let promises: Vec<Rounding> = Rounding::WORDS.iter().map(|(_, rounding)| *rounding).collect();
    let flaws = methods().flat_map(|method| {
        [false, true]
            .into_iter()
            .flat_map(|large| flaws(method, large, &promises, &exec))
            .collect::<Vec<_>>()
    });
    let flaws: Vec<String> = flaws.collect();
    assert!(flaws.is_empty(), "{}", flaws.join("\n"));
}

/// The name of the mistake of a renderer that breaks a rule.
fn cause(method: &str, rule: &str) -> Option<String> {
    let exec = Exec::sequential();
    let rules = Rule::all(method).unwrap();
    let rule = rules.iter().find(|own| own.name == rule).unwrap();
    let (case, broken) = (rule.case(&exec).unwrap(), rule.broken(&exec).unwrap());
    case.judge(&drawn(&broken, &exec), 1.0, &exec).unwrap().likely.map(|likely| likely.words)
}

#[test]
fn numbers_of_broken_rules_are_estimated() {
    for (method, rule, name) in [
        ("ewa", "low-pass", "the low-pass filter has another variance: 0.6 px^2, not 0.25"),
        ("single-pass", "low-pass", "the low-pass filter has another variance: 0.6 px^2, not 0.25"),
        ("ewa", "rim", "radii are 1.02 times as large"),
        ("ewa", "rolled", "the camera is tilted by -26.57 degrees"),
        ("ewa", "sizes", "large splats are clamped: no radius is above 2"),
        ("ewa", "between-pixels", "centres are rounded to the centres of pixels"),
        ("gaussians", "disc-tilted", "the scales of x and y are exchanged"),
        ("gaussians", "disc-edge-on", "the low-pass filter has another variance: 0 px^2, not 0.5"),
        ("gaussians", "disc-small", "the low-pass filter has another variance: 1 px^2, not 0.5"),
    ] {
        assert_eq!(cause(method, rule).as_deref(), Some(name), "{method}: {rule}");
    }
}
