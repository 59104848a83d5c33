use super::*;
use crate::setting::Value;
use std::collections::BTreeSet;

fn shape(name: &str) -> SceneFile {
    SceneFile::open(name).unwrap()
}

/// The names of all settings.
fn settings() -> BTreeSet<&'static str> {
    let rows = [MethodChoice::rows(), GroupChoice::rows(), OutputSettings::rows()];
    rows.iter().flatten().map(|row| row.name).collect()
}

#[test]
fn every_setting_is_traded_or_said_why_not() {
    let said = TRADES.iter().map(|trade| trade.setting).chain(NOT_TRADED.iter().map(|row| row.0));
    let said: Vec<_> = said.collect();
    assert_eq!(said.iter().copied().collect::<BTreeSet<_>>(), settings());
    assert_eq!(said.len(), settings().len(), "each once");
}

#[test]
fn every_value_is_one_that_a_method_takes() {
    for trade in TRADES {
        let all = Method::all().into_iter().map(|method| method.name());
        let starts: Vec<_> = all.map(|name| start(&shape("torus"), name).unwrap()).collect();
        for value in trade.values {
            let tried = starts.iter().map(|start| traded(start, trade, value).unwrap());
            let others = tried.flatten().count();
            let is_default = starts.iter().any(|start| {
                let method = start.file.method.method().unwrap();
                let mut values = method.values();
                values.extend(start.file.output.values());
                values.extend(method.grouping().into_iter().flat_map(Fields::values));
                let set =
                    |(name, set): &(&str, Value)| *name == trade.setting && set.text() == *value;
                values.iter().any(set)
            });
            assert!(others > 0 || is_default, "{} {value}", trade.setting);
        }
    }
}

#[test]
fn no_two_are_alike_and_methods_come_first() {
    let all = candidates(&shape("torus"), None).unwrap();
    let methods = Method::all();
    for (candidate, method) in all.iter().zip(&methods) {
        assert_eq!(candidate.options, format!("--method {}", method.name()));
        assert_eq!(candidate.file.method.method().unwrap(), *method);
    }
    let names: BTreeSet<_> = all.iter().map(|candidate| &candidate.options).collect();
    assert_eq!(names.len(), all.len());
    for (i, one) in all.iter().enumerate() {
        let method = one.file.method.method().unwrap();
        let drawn = |candidate: &Candidate| {
            let method = candidate.file.method.method().unwrap();
            let grouping =
                method.grouping().map(|default| candidate.file.groups.grouping(default).unwrap());
            (method, grouping, candidate.file.output, candidate.file.models.clone())
        };
        assert_eq!(method.name(), one.method);
        let twin = all[..i].iter().find(|other| drawn(other) == drawn(one));
        assert_eq!(twin.map(|twin| &twin.options), None, "{}", one.options);
    }
}

#[test]
fn what_blends_is_tried_once_where_nothing_is_blended() {
    let count = |only, needs| {
        let all = candidates(&shape("torus"), only).unwrap();
        all.iter().filter(|one| one.method == "peeling" && one.needs_opacity == needs).count()
    };
    assert_eq!(count(None, false), 1);
    assert!(count(None, true) > 5);
    assert_eq!(count(Some("peeling"), true), 0);
}

#[test]
fn the_scene_s_method_is_tried_as_the_scene_has_set_it() {
    let mut scene = shape("torus");
    scene.method.name = Some("ewa");
    let value = Method::default().read("outline", "raycast").unwrap().unwrap();
    scene.method.settings.push("outline", value);
    let all = candidates(&scene, Some("ewa")).unwrap();
    assert!(all.iter().all(|candidate| candidate.method == "ewa"));
    assert!(all[0].file.method.settings.has("outline"));
    let outlines: Vec<_> = all.iter().filter(|one| one.options.contains("--outline")).collect();
    let words: Vec<_> = outlines.iter().map(|one| one.options.as_str()).collect();
    assert_eq!(words, ["--method ewa --outline affine", "--method ewa --outline perspective"]);
}

#[test]
fn what_the_scene_sets_is_set_in_every_method_that_has_it() {
    let mut scene = shape("torus");
    scene.method.settings.push("cutoff", Value::Number(1.0));
    scene.groups.settings.push("overlap", Value::Number(0.25));
    let all = candidates(&scene, None).unwrap();
    let first = |name: &str| all.iter().find(|one| one.method == name).unwrap();
    for name in ["ewa", "single-pass", "deferred"] {
        let method = first(name).file.method.method().unwrap();
        assert!(method.values().contains(&("cutoff", Value::Number(1.0))), "{name}");
    }
    assert!(first("pyramid").file.method.settings.is_empty());
    assert!(first("pyramid").file.groups.settings.is_empty());
    assert!(first("single-pass").file.groups.settings.has("overlap"));
}

#[test]
fn shapes_are_tried_of_fewer_surfels_and_orders_of_larger() {
    let counts = candidates(&shape("torus"), Some("pyramid")).unwrap();
    let counts = counts.iter().filter(|one| one.options.contains("--count")).count();
    assert_eq!(counts, 2);
    let mut scene = shape("torus");
    scene.models[0].progressive = true;
    let sizes = candidates(&scene, Some("pyramid")).unwrap();
    let sizes: Vec<_> = sizes.iter().filter(|one| one.options.contains("--surfel-size")).collect();
    assert_eq!(sizes.len(), 3, "2 is the default");
    assert_eq!(sizes[0].file.refinement.surfel_size, 1.0);
}
