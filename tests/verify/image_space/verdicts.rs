//! The client without habits draws the crate's picture, bit for bit; the verifier calls no lawful
//! habit wrong, and finds every bug.

use super::bug::Bug;
use super::cases::{Case, of_pyramid, of_template};
use super::{How, render};
use crate::verify::client::Habit;
use crate::verify::client_is_right::differences;
use crate::verify::matrix::Picture;
use splatref::frame::{Exec, Frame};
use splatref::method::Session;
use splatref::verdict::Verdict;
use splatref::verdict::client::{Client, Rounding, Storage, Ties};

/// What is said of a client's picture of a case.
fn judge(case: &Case, how: How, rounding: Rounding) -> Verdict {
    judge_with(case, how, rounding, |_| true, false)
}

/// The same of a client that hands in the planes of some names, and may declare half floats.
fn judge_with(
    (scene, camera, method): &Case,
    how: How,
    rounding: Rounding,
    handed: fn(&str) -> bool,
    declared: bool,
) -> Verdict {
    let exec = Exec::sequential();
    let session = Session::new(scene, *method, &exec).unwrap();
    let mut frame = render(scene, camera, method, how);
    frame.planes.retain(|plane| handed(&plane.name));
    let mut client = Client::from(&frame);
    client.rounding = rounding;
    if how.habit == Habit::TiesToTheLast {
        client.ties = Ties::Last;
    }
    if how.bug == Some(Bug::HalfLevels) && declared {
        let levels = frame.planes.iter().filter(|plane| is_of_level(&plane.name));
        client = levels.fold(client, |client, plane| client.stored(&plane.name, Storage::Half));
    }
    session.verify(camera, &client, 1.0).unwrap()
}

fn is_of_level(plane: &str) -> bool {
    ["level", "pull", "push"].iter().any(|phase| plane.starts_with(phase))
}

/// What a client with a habit may promise; nothing, if the habit has no meaning here: nothing is
/// blended in another order than the page's, no quads are drawn, and no depth buffer holds 1/t.
fn promises(habit: Habit) -> &'static [Rounding] {
    match habit {
        Habit::LastFirst | Habit::Shuffled | Habit::WideQuads | Habit::DepthByNewton => &[],
        _ => habit.promises(),
    }
}

/// The names of the planes, sorted: their order is the client's own.
fn names(frame: &Frame<f32>) -> Vec<&str> {
    let mut names: Vec<_> = frame.planes.iter().map(|plane| plane.name.as_str()).collect();
    names.sort_unstable();
    names
}

/// Whether a habit or a bug changes a plane.
fn is_seen((scene, camera, method): &Case, how: How) -> bool {
    let draw = |how| render(scene, camera, method, how);
    let (plain, other) = (draw(How::default()), draw(how));
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
                found.extend(said(&verdict, &format!("{name}, {} {promise:?}", habit.name())));
                // But for the case whose decisions are all at their limits.
                let share = verdict.undecided as f64 / verdict.covered as f64;
                assert!(share <= 0.005 || *name == "limits", "{name}: {share}");
            }
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// The pictures of every habit and of these bugs.
fn pictures(
    cases: &[(&'static str, Case)],
    bugs: fn(Bug) -> bool,
    each: &mut dyn FnMut(Picture<'_>),
) {
    let exec = Exec::sequential();
    for (name, (scene, camera, method)) in cases {
        let session = Session::new(scene, *method, &exec).unwrap();
        let habits = Habit::ALL.iter().filter(|habit| !promises(**habit).is_empty());
        let habits = habits.map(|&habit| How { habit, bug: None });
        let bugs = Bug::ALL.iter().filter(|bug| bugs(**bug));
        let bugs = bugs.map(|&bug| How { habit: Habit::Plain, bug: Some(bug) });
        for how in habits.chain(bugs) {
            each(Picture {
                session: &session,
                camera,
                scene: name,
                what: how.bug.map_or(how.habit.name(), Bug::name).to_owned(),
                keeps: how.bug.is_none().then(|| promises(how.habit)),
                ties: if how.habit == Habit::TiesToTheLast { Ties::Last } else { Ties::Lowest },
                frame: render(scene, camera, method, how),
            });
        }
    }
}

pub(crate) fn pictures_of_pyramid(each: &mut dyn FnMut(Picture<'_>)) {
    pictures(&of_pyramid(), Bug::of_pyramid, each);
}

pub(crate) fn pictures_of_template(each: &mut dyn FnMut(Picture<'_>)) {
    pictures(&of_template(), Bug::of_template, each);
}

/// What is wrong, in words.
fn said(verdict: &Verdict, of: &str) -> Option<String> {
    let stage = verdict.first_wrong()?;
    Some(format!("{of}: {}, {} pixels, {:?}", stage.stage, stage.wrong, stage.worst))
}

/// A part of the planes, and whether a plane is one of it.
type Part = (&'static str, fn(&str) -> bool);

/// What a client may hand in.
const PARTS: [Part; 4] = [
    ("the picture", |plane| !plane.contains('.') && !is_of_level(plane)),
    ("without levels", |plane| !is_of_level(plane)),
    ("without the projection", |plane| !plane.starts_with("projection")),
    ("without depths and normals", |plane| !["Z", "normal"].contains(&plane)),
];

fn parts_and_halves_are_right(cases: &[(&str, Case)]) {
    let mut found = Vec::new();
    for (name, case) in cases {
        let how = How { habit: Habit::EitherNeighbor, bug: None };
        for (part, handed) in PARTS {
            let verdict = judge_with(case, how, Rounding::Gpu, handed, false);
            found.extend(said(&verdict, &format!("{name}, {part}")));
        }
        let how = How { bug: Some(Bug::HalfLevels), ..how };
        let verdict = judge_with(case, how, Rounding::Gpu, |_| true, true);
        found.extend(said(&verdict, &format!("{name}, halves")));
    }
    assert!(found.is_empty(), "{found:#?}");
}

/// The bugs at limits, of which one with another rounding could be on the other side.
const BELOW_WHAT_A_GPU_MAY_ROUND: [Bug; 3] =
    [Bug::RimOutside, Bug::MergeStrict, Bug::OverlapStrict];

fn every_bug_is_found(cases: &[(&str, Case)], bugs: impl Iterator<Item = Bug>) {
    let mut other = Vec::new();
    for bug in bugs {
        let how = How { habit: Habit::Plain, bug: Some(bug) };
        for promise in [Rounding::Ieee, Rounding::Gpu] {
            let found = cases.iter().find_map(|(name, case)| {
                Some((name, judge(case, how, promise).first_wrong()?.stage))
            });
            println!("{} {promise:?}: {found:?}", bug.name());
            let missed = promise == Rounding::Gpu && BELOW_WHAT_A_GPU_MAY_ROUND.contains(&bug);
            if found.is_none() != missed {
                let seen = cases.iter().filter(|(_, case)| is_seen(case, how));
                let seen: Vec<_> = seen.map(|(name, _)| *name).collect();
                other.push(format!("{} {promise:?}, {found:?}, seen in {seen:?}", bug.name()));
            }
        }
    }
    assert!(other.is_empty(), "{other:#?}");
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
fn habits_are_to_be_seen() {
    for cases in [of_template(), of_pyramid()] {
        for &habit in Habit::ALL.iter().filter(|habit| !promises(**habit).is_empty()) {
            let seen = cases.iter().any(|(_, case)| is_seen(case, How { habit, bug: None }));
            // No bounds cross, and nothing is so small.
            let idle = [Habit::Plain, Habit::ClampHighFirst, Habit::FlushDenormals];
            assert!(seen || idle.contains(&habit), "{}", habit.name());
        }
    }
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
fn parts_and_halves_of_a_template_are_right() {
    parts_and_halves_are_right(&of_template());
}

#[test]
fn parts_and_halves_of_a_pyramid_are_right() {
    parts_and_halves_are_right(&of_pyramid());
}

#[test]
fn every_bug_of_a_template_is_found() {
    every_bug_is_found(&of_template(), bugs(Bug::of_template));
}

#[test]
fn every_bug_of_a_pyramid_is_found() {
    every_bug_is_found(&of_pyramid(), bugs(Bug::of_pyramid));
}
