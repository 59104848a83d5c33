//! Every stage of every path against the oracle.

use crate::oracle::ewa::cases;
use crate::oracle::ewa::model::{Entry, Oracle, Pixel};
use crate::oracle::ewa::tolerance::EWA;
use crate::oracle::kit::case::Case;
use crate::oracle::kit::goldens;
use crate::oracle::kit::planes::{at, index};
use crate::oracle::kit::tolerance::{Arithmetic, Measured};
use splatref::frame::{Frame, NO_ID, Samples};
use splatref::method::Picture;
use splatref::method::ewa::Settings;
use splatref::number::Exact;

/// How many conditions of rounding leave a decision open.
pub(crate) const GUARD: f64 = 4.0;

pub(crate) fn oracle<'a, S>(
    case: &'a Case<S>,
    splats: &Settings,
    arithmetic: Arithmetic,
) -> Oracle<'a> {
    let (step, part) = arithmetic.step();
    Oracle::new(&case.scene, &case.camera, splats, [step, GUARD * part])
}

/// What an empty pixel holds.
fn check_empty<R: Exact>(frame: &Frame<R>, i: usize, place: &str) {
    for plane in &frame.planes {
        let value = at(&plane.samples, i);
        let expected = match plane.name.as_str() {
            "visibility.Z" | "Z" | "margin" => f64::INFINITY,
            "visibility.id" | "id" => f64::from(NO_ID),
            _ => 0.0,
        };
        // The margin of an empty pixel says how nearly something was inside.
        if plane.name != "margin" {
            assert_eq!(value, [expected; 3], "{place}: empty, plane '{}'", plane.name);
        }
    }
}

/// One pixel of one picture against the oracle.
fn check<R: Exact>(frame: &Frame<R>, truth: &Pixel, i: usize, place: &str) {
    if truth.nearest.is_empty() {
        check_empty(frame, i, place);
        return;
    }
    for name in ["visibility.id", "id"] {
        if frame.plane(name).is_some() {
            let (id, nearest) = (index(frame, name, i), &truth.nearest);
            assert!(nearest.contains(&id), "{place}: {name} {id}, not of {nearest:?}");
        }
    }
    if let Some(count) = frame.plane("attributes.count") {
        let expected = [truth.count.min(255) as f64; 3];
        assert_eq!(at(count, i), expected, "{place}: fragments");
    }
    if let Some(seen) = frame.plane("A") {
        assert_eq!(at(seen, i), [1.0; 3], "{place}: A");
    }
}

/// Measures the deviation of a plane at one pixel, in conditions, for the row `key` of the table.
pub(crate) fn measure<R: Exact>(
    (samples, key): (&Samples<R>, &'static str),
    entry: &Entry,
    i: usize,
    (arithmetic, place): (Arithmetic, &str),
    measured: &mut Measured,
) {
    let value = at(samples, i);
    for (c, found) in value.into_iter().enumerate() {
        let error = (found - entry.value[c]).abs();
        let unit = entry.condition[c] * arithmetic.step().1;
        let deviation = if error == 0.0 { 0.0 } else { error / unit };
        measured.add(key, arithmetic, deviation, || {
            format!("{place}: {found} for {} (unit {unit:e})", entry.value[c])
        });
    }
}

/// Compares pictures of one arithmetic with the oracle; returns how many pixels were left out.
fn compare<R: Exact>(
    case: &Case<Settings>,
    arithmetic: Arithmetic,
    pictures: &[Picture<R>],
    measured: &mut Measured,
) -> usize {
    let oracle = oracle(case, &case.settings, arithmetic);
    for Picture { tally, .. } in pictures {
        let drawn = tally.visible + tally.outside;
        let expected = oracle.drawn().unwrap_or(drawn);
        assert_eq!(drawn, expected, "{arithmetic:?}: {tally:?} in {}", case.name);
    }
    let mut ambiguous = 0;
    for (i, x, y) in case.pixels() {
        let truth = oracle.pixel(x, y);
        if truth.ambiguous {
            ambiguous += 1;
            continue;
        }
        let place = || format!("{arithmetic:?} pixel ({x}, {y}) of {}", case.name);
        for Picture { frame, .. } in pictures {
            check(frame, &truth, i, &place());
            let mut planes = 0;
            for entry in &truth.entries {
                let Some(samples) = frame.plane(entry.plane) else { continue };
                let (plane, place) = ((samples, entry.plane), (arithmetic, &*place()));
                measure(plane, entry, i, place, measured);
                planes += 1;
            }
            assert!(planes > 0 || truth.entries.is_empty(), "{}: no planes", place());
        }
    }
    ambiguous
}

#[test]
fn every_stage_equals_the_oracle() {
    let mut measured = Measured::default();
    let mut cases = cases::all();
    cases.extend(goldens::of());
    let mut worst = [0.0_f64; 3];
    for case in &cases {
        let drawing = case.drawing();
        let pixels = f64::from(case.camera.width * case.camera.height);
        let narrow = [drawing.define::<f32>(), drawing.fast()];
        let truth = drawing.define::<f64>();
        let wide = if case.exact { Arithmetic::F64 } else { Arithmetic::F64Rounded };
        let left = compare(case, Arithmetic::F32, &narrow, &mut measured) as f64 / pixels;
        worst[0] = worst[0].max(left);
        // The ladder is made of decisions at their limits.
        let most = if case.name.contains("ladder") { 0.02 } else { 0.005 };
        assert!(
            left <= most,
            "f32: {} % of the pixels are ambiguous in {}",
            left * 100.0,
            case.name
        );
        let left = compare(case, wide, &[truth], &mut measured) as f64;
        let slot = if case.exact { 1 } else { 2 };
        worst[slot] = worst[slot].max(left);
        let most = if case.exact { 4.0 } else { most * pixels };
        assert!(left <= most, "f64: {left} pixels are ambiguous in {}", case.name);
    }
    println!(
        "{} scenes; most ambiguous: f32 {:.4}, f64 {} px, rounded {} px",
        cases.len(),
        worst[0],
        worst[1],
        worst[2]
    );
    measured.check(EWA);
}
