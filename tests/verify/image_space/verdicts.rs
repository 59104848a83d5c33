//! The client without habits draws the crate's picture, bit for bit; the verifier calls no lawful
//! habit wrong, and finds every bug.

use super::bug::Bug;
use super::cases::{Case, of_pyramid, of_template};
use super::{How, render};
use crate::client::Habit;
use crate::client_is_right::differences;
use splatref::frame::{Exec, Frame};
use splatref::method::Session;
use splatref::verify::client::{Client, Rounding, Ties};
use splatref::verify::verdict::Verdict;

/// What is said of a client's picture of a case.
fn judge((scene, camera, method): &Case, how: How, rounding: Rounding) -> Verdict {
    let exec = Exec::sequential();
    let session = Session::new(scene, *method, &exec).unwrap();
    let mut client = Client::from(&render(scene, camera, method, how));
    client.rounding = rounding;
    if how.habit == Habit::TiesToTheLast {
        client.ties = Ties::Last;
    }
    session.verify(camera, &client, 1.0).unwrap()
}

/// What a client with a habit may promise; nothing, if the habit has no meaning here: nothing is
/// blended in another order than the page's, no quads are drawn, and no depth buffer holds 1/t.
fn promises(habit: Habit) -> &'static [Rounding] {
    match habit {
        Habit::LastFirst | Habit::Shuffled | Habit::WideQuads | Habit::DepthByNewton => &[],
        Habit::Plain | Habit::Fused => &[Rounding::Ieee, Rounding::Gpu],
        _ => &[Rounding::Gpu],
    }
}

/// The names of the planes, sorted: their order is the client's own.
fn names(frame: &Frame<f32>) -> Vec<&str> {
    let mut names: Vec<_> = frame.planes.iter().map(|plane| plane.name.as_str()).collect();
    names.sort_unstable();
    names
}

/// Whether a bug changes a picture.
fn is_seen((scene, camera, method): &Case, bug: Bug) -> bool {
    let draw = |bug| render(scene, camera, method, How { habit: Habit::Plain, bug });
    let (plain, other) = (draw(None), draw(Some(bug)));
    names(&plain) != names(&other) || !differences(&plain, &other).is_empty()
}

fn has_the_bits_of_the_crate(cases: &[(&str, Case)]) {
    let exec = Exec::sequential();
    let mut found = Vec::new();
    for (name, (scene, camera, method)) in cases {
        let session = Session::new(scene, *method, &exec).unwrap();
        let crates = session.define::<f32>(camera, true).unwrap().frame;
        let ours = render(scene, camera, method, How::default());
        assert_eq!(names(&ours), names(&crates), "{name}");
        let covered = ours.scalar("A").unwrap().values().iter().filter(|a| **a > 0.0).count();
        assert!(covered > 100, "{name} has something to see");
        let differences = differences(&ours, &crates);
        if !differences.is_empty() {
            found.push(format!("{name}, {covered} pixels: {differences:?}"));
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

fn no_lawful_habit_is_called_wrong(cases: &[(&str, Case)]) {
    let mut found = Vec::new();
    for (name, case) in cases {
        for &habit in Habit::ALL {
            for &promise in promises(habit) {
                let verdict = judge(case, How { habit, bug: None }, promise);
                if let Some(stage) = verdict.first_wrong() {
                    let (stage, wrong, worst) = (stage.stage, stage.wrong, &stage.worst);
                    let who = habit.name();
                    found.push(format!("{name}, {who} {promise:?}: {stage} {wrong}: {worst:?}"));
                }
            }
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

fn every_bug_is_found(cases: &[(&str, Case)], bugs: impl Iterator<Item = Bug>) {
    let mut missed = Vec::new();
    for bug in bugs {
        let how = How { habit: Habit::Plain, bug: Some(bug) };
        let found = cases.iter().find_map(|(name, case)| {
            Some((name, judge(case, how, Rounding::Ieee).first_wrong()?.stage))
        });
        println!("{}: {found:?}", bug.name());
        if found.is_none() {
            let seen = cases.iter().filter(|(_, case)| is_seen(case, bug));
            let seen: Vec<_> = seen.map(|(name, _)| *name).collect();
            missed.push(format!("{}, to be seen in {seen:?}", bug.name()));
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

fn bugs(of: fn(Bug) -> bool) -> impl Iterator<Item = Bug> {
    Bug::ALL.iter().copied().filter(move |bug| of(*bug))
}

#[test]
fn the_plain_template_has_the_bits_of_the_crate() {
    has_the_bits_of_the_crate(&of_template());
}

#[test]
fn the_plain_pyramid_has_the_bits_of_the_crate() {
    has_the_bits_of_the_crate(&of_pyramid());
}

#[test]
fn no_lawful_template_is_called_wrong() {
    no_lawful_habit_is_called_wrong(&of_template());
}

#[test]
fn no_lawful_pyramid_is_called_wrong() {
    no_lawful_habit_is_called_wrong(&of_pyramid());
}

#[test]
fn every_bug_of_a_template_is_found() {
    every_bug_is_found(&of_template(), bugs(Bug::of_template));
}

#[test]
fn every_bug_of_a_pyramid_is_found() {
    every_bug_is_found(&of_pyramid(), bugs(Bug::of_pyramid));
}
