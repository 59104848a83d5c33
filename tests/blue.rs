//! Where prefixes of orders fail [BJFM19, 6], pinned on the scenes of the bench `blue`.

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

/// Sides of a plate share surfels where they are nearer to each other than surfels are; along the surface not.
#[test]
fn walls_thinner_than_half_the_distance_of_surfels_have_holes() {
    let holes = |gap, along| failures::thin_wall(gap, along, &exec()).unwrap();
    assert!([4.0, 1.0].iter().all(|&gap| holes(gap, false) < 0.5));
    let thin = [0.5, 0.25, 0.0625].map(|gap| holes(gap, false));
    assert!(thin[0] > 1.5 && thin.is_sorted() && thin[2] > 8.0, "{thin:?}");
    let cured = [0.5, 0.0625].map(|gap| holes(gap, true));
    assert!(
        cured.iter().zip([thin[0], thin[2]]).all(|(cured, thin)| 2.0 * cured < thin),
        "{cured:?}"
    );
}

/// The far end of a bar has more surfels a pixel than the near one, for which their number is chosen.
#[test]
fn long_objects_have_too_many_surfels_far_away() {
    let ratio = |length| {
        let [_, near, far] = failures::long_object(length, &exec()).unwrap();
        far / near
    };
    let [short, long] = [1.0, 16.0].map(ratio);
    assert!(short < 1.5 && long > 5.0, "{short} {long}");
}

/// The estimate of `p_m` = 1000 holds for shorter prefixes down to about 100.
#[test]
fn prefixes_too_short_for_the_estimate_have_holes() {
    let holes = |count| failures::short_prefix(count, &exec()).unwrap();
    let [few, some, enough, many] = [3.0, 10.0, 100.0, 1000.0].map(holes);
    assert!(few.1 > some.1 && some.1 > 2.0, "{few:?} {some:?}");
    assert!(enough.1 < 0.05 && many.1 < 0.05, "{enough:?} {many:?}");
    assert_eq!([few.0, some.0, enough.0, many.0], [4, 11, 100, 1001]);
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
