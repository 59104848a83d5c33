//! The client without habits draws the crate's picture, bit for bit; what its habits and its bugs
//! change.

use crate::verify::cases::{Case, cases};
use crate::verify::client::{Bug, Habit, How, render};
use splatref::frame::{Exec, Frame, Samples};
use splatref::method::{Method, Session};

fn draw((scene, camera, settings): &Case, how: How) -> Frame<f32> {
    render(scene, camera, settings, how)
}

/// In how many pixels two planes differ, by bits.
fn differing(a: &Samples<f32>, b: &Samples<f32>) -> usize {
    fn count<T, K: PartialEq>(a: &[T], b: &[T], key: impl Fn(&T) -> K) -> usize {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).filter(|(a, b)| key(a) != key(b)).count()
    }
    let three = |v: &[f32; 3]| v.map(f32::to_bits);
    match (a, b) {
        (Samples::Scalar(a), Samples::Scalar(b)) => count(a.values(), b.values(), |v| v.to_bits()),
        (Samples::Color(a), Samples::Color(b)) | (Samples::Vector(a), Samples::Vector(b)) => {
            count(a.values(), b.values(), three)
        }
        (Samples::Index(a), Samples::Index(b)) => count(a.values(), b.values(), |&v| v),
        (Samples::Count(a), Samples::Count(b)) => count(a.values(), b.values(), |&v| v),
        _ => panic!("planes of two kinds"),
    }
}

/// Every plane of `a` that differs from that of `b`, and in how many pixels.
pub(crate) fn differences(a: &Frame<f32>, b: &Frame<f32>) -> Vec<(String, usize)> {
    let planes = a.planes.iter().map(|plane| {
        let other = b.plane(&plane.name).expect("a plane that both have");
        (plane.name.clone(), differing(&plane.samples, other))
    });
    planes.filter(|(_, count)| *count > 0).collect()
}

#[test]
fn the_plain_client_has_the_bits_of_the_crate() {
    let exec = Exec::sequential();
    let mut found = Vec::new();
    for (name, case) in cases() {
        let (scene, camera, settings) = &case;
        let session = Session::new(scene, Method::Ewa(*settings), &exec).unwrap();
        let crates = session.define::<f32>(camera, true).unwrap().frame;
        let ours = draw(&case, How::default());
        let covered = ours.scalar("A").unwrap().values().iter().filter(|a| **a > 0.0).count();
        assert!(covered > 100, "{name} has something to see");
        let names = |frame: &Frame<f32>| -> Vec<_> {
            frame.planes.iter().map(|plane| plane.name.clone()).collect()
        };
        let without_margin: Vec<_> =
            names(&crates).into_iter().filter(|name| name != "margin").collect();
        assert_eq!(names(&ours), without_margin, "{name}");
        let differences = differences(&ours, &crates);
        if !differences.is_empty() {
            found.push(format!("{name}, {covered} pixels: {differences:?}"));
        }
    }
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn habits_keep_the_ids() {
    // Of many coplanar discs the nearest is anybody's.
    let flat = |name: &str| name.contains("checkerboard") || name.contains("staircase");
    for (name, case) in cases().into_iter().filter(|(name, _)| !flat(name)) {
        let plain = draw(&case, How::default());
        for &habit in Habit::ALL {
            let picture = draw(&case, How { habit, bug: None });
            let changed = differing(plain.plane("id").unwrap(), picture.plane("id").unwrap());
            let pixels = plain.width as usize * plain.height as usize;
            assert!(10 * changed <= pixels, "{name}, {}: {changed} of {pixels}", habit.name());
        }
    }
}

#[test]
fn every_bug_is_to_be_seen() {
    let cases = cases();
    let plain: Vec<_> = cases.iter().map(|(_, case)| draw(case, How::default())).collect();
    for &bug in Bug::ALL {
        let how = How { bug: Some(bug), ..How::default() };
        let mut all = cases.iter().zip(&plain);
        let seen = all.any(|((_, case), plain)| !differences(plain, &draw(case, how)).is_empty());
        assert!(seen, "{}", bug.name());
    }
}
