//! No verdict accuses the crate: every method with every setting at other values, in several scenes,
//! computed in f32 and in f64, under every promise. The settings come from their rows, so that a new
//! setting is tried too.

use splatref::frame::Exec;
use splatref::io::scene_file::SceneFile;
use splatref::method::{Method, Session};
use splatref::scene::Camera;
use splatref::setting::{Fields, Refused, Slot, Value};
use splatref::verdict::client::{Client, Rounding};
use splatref::verdict::{Outcome, Verdict};
use std::collections::BTreeSet;
use std::path::Path;

/// Scenes without a method: light and environment, opacities, another camera, what a method alone
/// reads of a model.
const SCENES: [(&str, &str); 4] = [
    ("plain", "[[model]]\nshape = \"cluster\"\ncount = 150\n"),
    (
        "sky",
        "[[model]]\nshape = \"sphere\"\ncount = 120\nopacity = 0.999\n\
         [[light]]\nkind = \"point\"\nposition = [3, 3, 3]\n[environment]\nsky = true\n",
    ),
    ("opacities", "[[model]]\nshape = \"staircase\"\ncount = 120\nopacity = 0.6\n"),
    ("mipmaps", "[[model]]\nshape = \"checkerboard\"\ncount = 300\nmipmaps = 2\n"),
];

/// Other values of a row that may be allowed, the likeliest first.
fn candidates(slot: &Slot<'_>) -> Vec<Value> {
    let text = |text: &str| Value::Text(text.into());
    if let Slot::Parts(_, names) = slot {
        let of = |numbers: [f32; 3]| {
            Value::Parts(names.iter().map(|name| (*name).to_owned()).zip(numbers).collect())
        };
        return [[0.5, 1.2, 0.3], [0.5, 1.4, 1.0], [0.1, 0.2, 0.3]].map(of).into();
    }
    match slot.get() {
        Some(Value::Switch(on)) => vec![Value::Switch(!on)],
        Some(Value::Number(own)) => {
            let others = [1.5 * own, 0.5 * own, 0.25, 0.5, 1.0, 0.0, 2.0];
            others.into_iter().filter(|other| *other != own).map(Value::Number).collect()
        }
        Some(Value::Whole(own)) => {
            let others = [own + 1, own - 1, own + 2, own - 2, 1, 2, 3, 5, 7, 8, 16];
            let others = others.into_iter().filter(|other| *other != own && *other >= 0);
            others.map(Value::Whole).collect()
        }
        _ if !slot.words().is_empty() && !matches!(slot, Slot::Ratios(_)) => {
            let own = slot.get();
            let words = slot.words().into_iter().map(text);
            let numbers = [1, 2, 5].map(Value::Whole);
            words.chain(numbers).filter(|word| Some(word) != own.as_ref()).collect()
        }
        _ => vec![
            text("0.5r"),
            text("0.3"),
            Value::Numbers(vec![1.1, 1.2, 1.3]),
            Value::Numbers(vec![0.5, 0.6, 0.7]),
            Value::Whole(2),
            Value::Whole(3),
            Value::Number(0.5),
            text("none"),
        ],
    }
}

/// A method with one setting changed, and the change in words; nothing if it is not allowed.
fn with(method: &Method, name: &str, value: &Value) -> Option<Method> {
    let mut changed = *method;
    changed.set(name, value).ok()?;
    (changed != *method && changed.check().is_ok()).then_some(changed)
}

/// The names of a method's settings, each with other values.
fn rows(method: &Method) -> Vec<(&'static str, Vec<Value>)> {
    let (mut own, mut rows) = (*method, Vec::new());
    own.fields(&mut |field| rows.push((field.name, candidates(&field.slot))));
    rows
}

/// Whether a setting has no effect beside the others.
fn is_idle(method: &Method, (name, values): &(&str, Vec<Value>)) -> bool {
    let set = |value| {
        let mut changed = *method;
        changed.set(name, value)
    };
    values.iter().any(|value| matches!(set(value), Err(Refused::Idle(_))))
}

/// The method with each setting at up to two values other than its default.
fn variants(method: &Method) -> Vec<(String, Method)> {
    let rows = rows(method);
    let mut all = vec![("defaults".to_owned(), *method)];
    for row @ (name, values) in &rows {
        // Beside the defaults the setting may have no effect; then another setting changes too.
        let others = rows.iter().filter(|(other, _)| other != name);
        let others = others.flat_map(|(other, values)| values.iter().map(move |v| (*other, v)));
        let beside = others.filter_map(|(other, value)| with(method, other, value));
        let base = [*method].into_iter().chain(beside).find(|base| !is_idle(base, row));
        let base = base.unwrap_or_else(|| panic!("{}: {name} has no effect", method.name()));
        let changed = values
            .iter()
            .filter_map(|value| Some((format!("{name} = {value}"), with(&base, name, value)?)));
        let two: Vec<_> = changed.take(2).collect();
        assert!(!two.is_empty(), "{}: no other value of {name} is allowed", method.name());
        all.extend(two);
    }
    all
}

/// What is wrong with the verdict on the crate's own picture. None if the scene cannot be drawn with
/// these settings.
fn accusations(session: &Session<'_>, camera: &Camera) -> Option<Vec<String>> {
    let mut found = Vec::new();
    let single = session.define::<f32>(camera, true).ok()?.frame;
    let double = session.define::<f64>(camera, true).unwrap().frame.to_f32();
    let clients = [("f32", Client::from(&single)), ("f64", Client::from(&double).rounded())];
    for (number, mut client) in clients {
        for rounding in [Rounding::Gpu, Rounding::Precise, Rounding::Ieee] {
            client.rounding = rounding;
            let verdict = session.verify(camera, &client, Verdict::BUDGET).unwrap();
            let wrong = verdict.first_wrong().map(|stage| {
                let fault = stage.worst.as_ref().map(|worst| worst.fault.to_string());
                format!("{} pixels of {}: {}", stage.wrong, stage.stage, fault.unwrap_or_default())
            });
            let unlike = verdict.unlike.iter().map(ToString::to_string);
            let unjudged =
                verdict.stages.iter().flat_map(|own| own.missing.iter().chain(&own.unjudged));
            let unjudged = unjudged.map(|name| format!("not judged: {name}"));
            let said = wrong.into_iter().chain(unlike).chain(unjudged);
            found.extend(said.map(|said| format!("{number} {rounding:?}: {said}")));
            if verdict.outcome() == Outcome::Undecidable && rounding == Rounding::Ieee {
                println!("{number} {rounding:?} is undecidable: {}", verdict.undecided);
            }
        }
    }
    Some(found)
}

/// The accusations in the scenes that `take` chooses, over all methods and settings.
fn all_accusations(take: impl Fn(&str, &Method) -> bool) -> Vec<String> {
    let (exec, mut found) = (Exec::new(2, 16).unwrap(), Vec::new());
    let [mut drawn, mut not_drawn] = [BTreeSet::new(), BTreeSet::new()];
    for (scene, text) in SCENES {
        for method in Method::all().into_iter().filter(|method| take(scene, method)) {
            let camera = if scene == "sky" { "ortho = 3\n" } else { "" };
            let text = format!("{text}[camera]\nsize = [32, 24]\n{camera}");
            let text = format!("{text}[method]\nname = \"{}\"\n", method.name());
            let file = SceneFile::parse(&text, Path::new("scene.toml")).unwrap();
            let mut ready = file.ready(&exec, &|_, _, _| ()).unwrap();
            for (what, variant) in variants(&method) {
                ready.method = variant;
                let (session, _) = ready.session(&exec, &|_, _, _| ()).unwrap();
                let variant = format!("{}, {what}", method.name());
                let Some(wrong) = accusations(&session, &ready.camera) else {
                    not_drawn.insert(variant);
                    continue;
                };
                let name = format!("{scene}, {variant}");
                drawn.insert(variant);
                found.extend(wrong.into_iter().map(|wrong| format!("{name}, {wrong}")));
            }
        }
    }
    let never: Vec<_> = not_drawn.difference(&drawn).collect();
    assert!(never.is_empty(), "no scene shows {never:?}");
    found
}

#[test]
#[ignore = "slow: .ci/run runs it"]
fn no_verdict_accuses_the_crate() {
    let found = all_accusations(|_, _| true);
    assert!(found.is_empty(), "{} verdicts:\n{}", found.len(), found.join("\n"));
}
