//! Pins how one order gives way to another, and how the controller answers [BJFM19, 4], on the
//! scenes of the bench `blue`.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(dead_code, reason = "the bench uses more of what they share")]

#[path = "../benches/blue/failures.rs"]
mod failures;
#[path = "../benches/blue/scene.rs"]
mod scene;

use splatref::frame::Exec;

fn exec() -> Exec {
    Exec::new(2, 32).unwrap()
}

/// An object gives way to a finer one without holes.
#[test]
fn objects_fade_into_finer_ones_without_holes() {
    let found = failures::FADES.map(|fade| failures::fade(fade, &exec()).unwrap());
    assert!(found.iter().all(|(_, holes)| *holes < 0.05), "{found:?}");
    assert!(found[3].0 > 7000, "both are drawn whole halfway: {found:?}");
}

/// Times that are known three frames late make the size swing for ever, after any load step.
#[test]
fn the_controller_swings_if_times_come_three_frames_late() {
    for step in failures::STEPS {
        let settled = [0, 1, 2, 3, 4].map(|late| failures::load_step(step, late).settled);
        assert!(settled[..3].iter().all(Option::is_some), "{step}: {settled:?}");
        assert!(settled[3..].iter().all(Option::is_none), "{step}: {settled:?}");
    }
    let overshoot = [0, 1, 2].map(|late| failures::load_step(2.0, late).overshoot);
    assert!(overshoot[0] < 0.0 && overshoot.is_sorted() && overshoot[2] > 40.0, "{overshoot:?}");
}
