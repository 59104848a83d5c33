//! A limit that is a little off leans the undecided decisions of a suite of scenes to one side; those of
//! lawful clients go to both.

use crate::verify::client::{Habit, How, render};
use splatref::frame::Exec;
use splatref::method::{Method, Session, blue};
use splatref::scene::{Camera, Scene, Surfels};
use splatref::source::Shape;
use splatref::splat::{Epsilon, Kernel, SplatSettings};
use splatref::verdict::client::{Client, Rounding};
use splatref::verdict::shift::{Shift, Shifts};

/// The scenes: a shape, how many surfels, the outline.
const SUITE: [(&str, usize, Kernel); 7] = [
    ("sphere", 40_000, Kernel::DEFAULT),
    ("torus", 30_000, Kernel::DEFAULT),
    ("cluster", 60_000, Kernel::ZPVBG01),
    ("staircase", 20_000, Kernel::ZP06),
    ("checkerboard", 20_000, Kernel::DEFAULT),
    ("cluster", 120_000, Kernel::DEFAULT),
    ("cluster", 90_000, Kernel::ZPVBG01),
];

/// What all scenes say together of the crate in `f32`, as a client whose limit of q is off by twice this
/// share: surfels are larger, and so is the cut-off, by which their radii are divided.
fn leaning(off: f32, method: fn(SplatSettings) -> Method, rounding: Rounding) -> Shifts {
    let exec = Exec::new(2, 32).unwrap();
    let mut all = Shifts::default();
    for (seed, (name, count, kernel)) in SUITE.into_iter().enumerate() {
        let shape = Shape::by_name(name).unwrap();
        let scene = Scene::lit(name, shape.surfels(count, seed as u64).unwrap());
        let camera = Camera::new(720, 540, shape.default_pose(), shape.default_lens()).unwrap();
        let epsilon = Epsilon::World(Epsilon::MedianRadii(2.0).resolve(&scene.surfels));
        let settings = SplatSettings { kernel, epsilon, ..SplatSettings::default() };
        let mut cloud = scene.surfels.clone().into_cloud();
        cloud.radius.iter_mut().flatten().for_each(|radius| *radius *= 1.0 + off);
        let larger = Scene { surfels: Surfels::new(cloud).unwrap().0, ..scene.clone() };
        let mut changed = settings;
        changed.kernel.cutoff *= 1.0 + off;
        let client = Session::new(&larger, method(changed), &exec).unwrap();
        let frame = client.define::<f32>(&camera, false).unwrap().frame;
        let mut client = Client::from(&frame);
        client.rounding = rounding;
        let session = Session::new(&scene, method(settings), &exec).unwrap();
        let verdict = session.verify(&camera, &client, 1.0).unwrap();
        println!("{name}: {:?}", verdict.shifts.map(|shift| (shift.decisions, shift.z())));
        all.iter_mut().zip(&verdict.shifts).for_each(|(all, shift)| all.add(shift));
    }
    let radii = all.map(|s| s.estimate() / s.radius());
    println!("z {:?}, off {:?}, {radii:?} radii", all.map(|s| s.z()), all.map(|s| s.estimate()));
    all
}

/// A device may be one-sided, but not by as much as this limit is off.
#[test]
fn under_gpu_a_limit_that_is_off_alarms() {
    let lawful = leaning(0.0, Method::Ewa, Rounding::Gpu);
    assert!(lawful[0].decisions > 300 && !lawful.iter().any(Shift::alarms), "{lawful:?}");
    for off in [2e-5, -2e-5] {
        let [cutoff, _] = leaning(off, Method::Ewa, Rounding::Gpu);
        assert!(cutoff.alarms() && (cutoff.z() > 0.0) == (off > 0.0), "{cutoff:?}");
    }
}

/// Rounding that is one-sided, as far as shading languages allow, leans less than the alarm.
#[test]
#[ignore = "slow: .ci/run runs it"]
fn under_gpu_no_habit_alarms() {
    let exec = Exec::new(2, 32).unwrap();
    for habit in [Habit::TowardsZero, Habit::Coarse, Habit::Exp2, Habit::EitherNeighbor] {
        let mut all = Shifts::default();
        for (name, count, kernel) in [SUITE[0], SUITE[2]] {
            let shape = Shape::by_name(name).unwrap();
            let scene = Scene::lit(name, shape.surfels(count, 0).unwrap());
            let camera = Camera::new(720, 540, shape.default_pose(), shape.default_lens()).unwrap();
            let settings = SplatSettings { kernel, ..SplatSettings::default() };
            let mut client =
                Client::from(&render(&scene, &camera, &settings, How { habit, bug: None }));
            client.rounding = Rounding::Gpu;
            let session = Session::new(&scene, Method::Ewa(settings), &exec).unwrap();
            let verdict = session.verify(&camera, &client, 1.0).unwrap();
            all.iter_mut().zip(&verdict.shifts).for_each(|(all, shift)| all.add(shift));
        }
        let of = all.map(|s| (s.decisions, s.z(), s.estimate() / s.radius()));
        println!("{}: {of:?}", habit.name());
        assert!(!all.iter().any(Shift::alarms), "{}: {of:?}", habit.name());
    }
}

#[test]
fn a_limit_that_is_a_little_off_leans() {
    let lawful = leaning(0.0, Method::Ewa, Rounding::Ieee);
    // Few are undecided at epsilon, which is the same of all surfels.
    assert!(lawful[0].decisions > 50, "{lawful:?}");
    assert!(lawful.iter().all(|shift| shift.z().abs() < Shift::REMARK), "{lawful:?}");
    for off in [5e-6, -5e-6] {
        let [cutoff, _] = leaning(off, Method::Ewa, Rounding::Ieee);
        assert!(cutoff.alarms() && (cutoff.z() > 0.0) == (off > 0.0), "{cutoff:?}");
    }
}

/// Of `blue` an id tells whether the nearest disc was cut off; epsilon is none of its limits.
#[test]
fn so_does_the_rim_of_discs() {
    let blue = |_| blue::Settings { cull: true }.into();
    let [rim, epsilon] = leaning(0.0, blue, Rounding::Ieee);
    assert!(rim.decisions > 20 && epsilon.decisions == 0, "{rim:?}");
    assert!(rim.z().abs() < Shift::REMARK, "{rim:?}");
    // Fewer are open than of splats, which lie one over the other.
    for off in [2e-5, -2e-5] {
        let [rim, _] = leaning(off, blue, Rounding::Ieee);
        assert!(rim.alarms() && (rim.z() > 0.0) == (off > 0.0), "{rim:?}");
    }
}
