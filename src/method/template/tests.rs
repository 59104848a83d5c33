//! Test the stages, planes and explanations of the templates.

use super::explain::explain;
use super::*;
use crate::frame::{Exec, Frame, Plane, Samples};
use crate::index::Index;
use crate::method::Method;
use crate::method::projection::SampleKind;
use crate::method::projection::tests::{
    every_stage_runs_alone, lit, samples_mut, stage_with, wrong_planes_are_refused,
};
use crate::method::tests::{cameras, scene, surfels};
use crate::scene::{Camera, Scene};

fn settings() -> [Settings; 2] {
    [
        Settings::default(),
        Settings { size: 3, levels: LevelRule::Covering, falloff: Falloff::Linear, cull: false },
    ]
}

#[test]
fn every_stage_runs_on_planes() {
    for (i, camera) in cameras().into_iter().enumerate() {
        let scene = scene(surfels(400, 0.2, i % 3 == 0, i as u64));
        let scene = if i % 2 == 0 { lit(scene) } else { scene };
        for settings in settings() {
            every_stage_runs_alone::<f32>(&scene, &camera, Method::Template(settings));
            every_stage_runs_alone::<f64>(&scene, &camera, Method::Template(settings));
        }
    }
}

#[test]
fn planes_that_do_not_fit_are_refused() {
    let scene = scene(surfels(400, 0.2, true, 1));
    wrong_planes_are_refused(&scene, &cameras()[4], Method::Template(Settings::default()));
}

/// Every level is computed from the given planes, so a wrong level changes only the next.
#[test]
fn a_wrong_level_spoils_the_next_alone() {
    let (scene, camera) = (scene(surfels(400, 0.4, true, 1)), cameras()[6]);
    let method = Method::Template(settings()[1]);
    let right = stage_with(&scene, &camera, method, "propagation", |_| {}).unwrap();
    let wrong = |frame: &mut Frame<f32>| {
        let Samples::Scalar(depths) = samples_mut(frame, "level01.Z") else { panic!("its type") };
        depths.values_mut().iter_mut().for_each(|depth| *depth += 0.125);
    };
    let found = stage_with(&scene, &camera, method, "propagation", wrong).unwrap();
    for (found, right) in found.planes.iter().zip(&right.planes) {
        let same = format!("{found:?}") == format!("{right:?}");
        assert!(same || found.name.starts_with("level02"), "{}", found.name);
    }
    assert!(found != right, "nothing of level02 has changed");
}

/// Asserts that the explanation of every pixel has the values of the picture.
fn assert_explained<R: Exact>(scene: &Scene, camera: &Camera, settings: &Settings) {
    let exec = Exec::sequential();
    let index = Index::default();
    let job = Job::new(scene, &index, camera, &exec);
    let frame = settings.define::<R>(&job, true).unwrap().frame;
    let given = InputPlanes::new(&frame, &job).unwrap();
    let samples = given.projection().unwrap();
    let sizes = crate::frame::pyramid::sizes(frame.width, frame.height);
    let empty = |[width, height]: [u32; 2]| Plane::filled(width, height, Center::empty());
    let level = |l: usize| given.records(&Center::PLANES, l, empty(sizes[l]));
    let levels = (1..=propagation::top(settings, &sizes)).map(level);
    let levels: Vec<_> = levels.map(Result::unwrap).collect();
    let mut most = 0;
    for (x, y) in (0..frame.height).flat_map(|y| (0..frame.width).map(move |x| (x, y))) {
        let found = explain::<R>(&job, settings, (x, y)).unwrap();
        let sample = samples.at(x, y);
        let kept = (sample.kind != SampleKind::Empty).then_some((sample.id, sample.depth));
        assert_eq!(found.projection.kept, kept, "({x}, {y})");
        assert_eq!(found.merged.len(), levels.len());
        for ((level, found), cells) in (1..).zip(&found.merged).zip(&levels) {
            assert_eq!(found.found, *cells.at(x >> level, y >> level), "({x}, {y}), {level}");
        }
        let gathered = &found.gathered;
        assert_eq!(frame.index("id").unwrap().at(x, y), &gathered.id);
        assert_eq!(frame.scalar("weight").unwrap().at(x, y), &gathered.weight);
        assert_eq!(frame.count("gathered.count").unwrap().at(x, y), &gathered.count);
        assert_eq!(frame.scalar("gathered.Z").unwrap().at(x, y), &gathered.depth);
        assert_eq!(frame.scalar("Z").unwrap().at(x, y), &found.depth);
        most = most.max(gathered.count);
        // From the last new start on, the text must list as many centres that add to the sums as
        // were counted.
        let text = found.to_string();
        let lines: Vec<_> = text.lines().filter(|line| line.contains(", weight ")).collect();
        let anew = |line: &&str| line.contains("the first") || line.contains("starts anew");
        let start = lines.iter().rposition(anew).unwrap_or(0);
        assert_eq!(lines.len() - start, usize::from(gathered.count), "{text}");
        assert_eq!(text, explain::<R>(&job, settings, (x, y)).unwrap().to_string());
    }
    assert!(most > 2, "{most}");
}

#[test]
fn explanations_agree_with_the_picture() {
    let camera = cameras()[4];
    for settings in settings() {
        assert_explained::<f32>(&scene(surfels(300, 0.2, true, 7)), &camera, &settings);
        assert_explained::<f64>(&scene(surfels(300, 0.4, false, 9)), &camera, &settings);
    }
}
