//! Every stage of every path against the oracle.

use crate::ewa::cases::{self, Case};
use crate::ewa::model::{Entry, Oracle, Pixel};
use crate::kit::goldens;
use crate::kit::tolerance::{self, Arithmetic, Measured};
use splatref::frame::{Exec, Frame, NO_ID, Samples};
use splatref::method::Method;
use splatref::method::{Picture, ewa};
use splatref::number::Exact;

/// How many conditions of rounding leave a decision open.
pub(crate) const GUARD: f64 = 4.0;

pub(crate) fn oracle<'a>(case: &'a Case, arithmetic: Arithmetic) -> Oracle<'a> {
    let (step, part) = arithmetic.step();
    Oracle::new(&case.scene, &case.camera, &case.settings, [step, GUARD * part])
}

pub(crate) fn at<R: Exact>(samples: &Samples<R>, i: usize) -> [f64; 3] {
    match samples {
        Samples::Scalar(plane) => [plane.values()[i].to_f64(); 3],
        Samples::Color(plane) | Samples::Vector(plane) => plane.values()[i].map(R::to_f64),
        Samples::Index(plane) => [f64::from(plane.values()[i]); 3],
        Samples::Count(plane) => [f64::from(plane.values()[i]); 3],
    }
}

pub(crate) fn index<R: Exact>(frame: &Frame<R>, name: &str, i: usize) -> Option<u32> {
    match frame.plane(name) {
        Some(Samples::Index(plane)) => Some(plane.values()[i]),
        _ => None,
    }
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
        if let Some(id) = index(frame, name, i) {
            assert!(
                truth.nearest.contains(&id),
                "{place}: {name} {id}, not of {:?}",
                truth.nearest
            );
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
    case: &Case,
    arithmetic: Arithmetic,
    pictures: &[Picture<R>],
    measured: &mut Measured,
) -> usize {
    let oracle = oracle(case, arithmetic);
    for Picture { tally, .. } in pictures {
        let drawn = tally.visible + tally.outside;
        let expected = oracle.drawn().unwrap_or(drawn);
        assert_eq!(drawn, expected, "{arithmetic:?}: {tally:?} in {}", case.name);
    }
    let mut ambiguous = 0;
    for y in 0..case.camera.height {
        for x in 0..case.camera.width {
            let truth = oracle.pixel(x, y);
            if truth.ambiguous {
                ambiguous += 1;
                continue;
            }
            let i = (y * case.camera.width + x) as usize;
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
    }
    ambiguous
}

#[test]
fn every_stage_equals_the_oracle() {
    let exec = Exec::sequential();
    let mut measured = Measured::default();
    let mut cases = cases::all();
    let goldens = goldens::all().into_iter();
    let goldens = goldens.filter(|golden| matches!(golden.method, Method::Ewa(_)));
    cases.extend(goldens::at_least(10, goldens.map(|golden| golden.case).collect()));
    let mut worst = [0.0_f64; 3];
    for case in &cases {
        let Case { scene, camera, settings, .. } = case;
        let pixels = f64::from(camera.width * camera.height);
        let plain = ewa::render::<f32>(scene, camera, settings, &exec, true).expect("renders");
        let fast = ewa::render_f32(scene, camera, settings, &exec).expect("renders");
        let truth = ewa::render::<f64>(scene, camera, settings, &exec, true).expect("renders");
        let wide = if case.exact { Arithmetic::F64 } else { Arithmetic::F64Rounded };
        let narrow = [plain, fast];
        let left = compare(case, Arithmetic::F32, &narrow, &mut measured) as f64 / pixels;
        worst[0] = worst[0].max(left);
        assert!(
            left <= 0.005,
            "f32: {} % of the pixels are ambiguous in {}",
            left * 100.0,
            case.name
        );
        let left = compare(case, wide, &[truth], &mut measured) as f64;
        let slot = if case.exact { 1 } else { 2 };
        worst[slot] = worst[slot].max(left);
        let most = if case.exact { 4.0 } else { 0.005 * pixels };
        assert!(left <= most, "f64: {left} pixels are ambiguous in {}", case.name);
    }
    println!(
        "{} scenes; most ambiguous: f32 {:.4}, f64 {} px, rounded {} px",
        cases.len(),
        worst[0],
        worst[1],
        worst[2]
    );
    for (key, (worst, place)) in &measured.0 {
        println!("{key:?}: {worst:.3} {place}");
    }
    let complaints = measured.complaints(tolerance::EWA);
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
