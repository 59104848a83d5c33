//! Test the stages, planes and explanations of the pyramid.

use super::explain::explain;
use super::planes::CellFields;
use super::*;
use crate::frame::{Exec, Frame, Plane, Samples};
use crate::index::Index;
use crate::method::Method;
use crate::method::projection::SampleKind;
use crate::method::projection::tests::{
    every_stage_runs_alone, lit, samples_mut, stage_with, wrong_planes_are_refused,
};
use crate::method::tests::{cameras, scene, surfels};
use crate::scene::indexed::{Indexed, Vertices};
use crate::scene::{Camera, Primitives, Scene};
use glam::Vec3;

/// Primitives between random points. Their vertices are surfels made from another seed.
pub(crate) fn indexed<const N: usize>(count: u32, seed: u64) -> Indexed<N> {
    let points = surfels(u64::from(count), 0.05, true, seed);
    let vertices = Vertices {
        position: points.position().iter().map(|p| *p * 0.75).collect(),
        direction: points.normal().to_vec(),
        radius: points.radius().to_vec(),
        color: points.color().map(<[Vec3]>::to_vec),
        ..Vertices::default()
    };
    let corners = (0..count).map(|i| std::array::from_fn(|k| (i + k as u32) % count)).collect();
    Indexed::new(vertices, corners).unwrap().0
}

/// Surfels, with triangles, ribbons and tubes among them.
fn hybrid(color: bool) -> Scene {
    let primitives = Primitives {
        triangles: indexed(9, 100),
        ribbons: indexed(40, 200),
        tubes: indexed(40, 300),
    };
    lit(Scene { primitives, ..scene(surfels(500, 0.05, color, 7)) })
}

fn settings() -> [Settings; 2] {
    let rare = Settings {
        weights: Weights::Box,
        occlusion: Occlusion::Outside,
        cull: false,
        ..Settings::default()
    };
    [Settings::default(), rare]
}

#[test]
fn every_stage_runs_on_planes() {
    for (i, camera) in cameras().into_iter().enumerate() {
        let scene = if i % 2 == 0 { hybrid(i % 4 == 0) } else { scene(surfels(400, 0.1, true, 3)) };
        for settings in settings() {
            every_stage_runs_alone::<f32>(&scene, &camera, Method::Pyramid(settings));
            every_stage_runs_alone::<f64>(&scene, &camera, Method::Pyramid(settings));
        }
    }
}

#[test]
fn planes_that_do_not_fit_are_refused() {
    wrong_planes_are_refused(&hybrid(true), &cameras()[4], Method::Pyramid(Settings::default()));
}

/// Every level is computed from the given planes, so a wrong level changes only the next.
#[test]
fn a_wrong_level_spoils_the_next_alone() {
    // The surfels are large, so that coarse levels are not empty.
    let (scene, camera) = (scene(surfels(400, 0.4, true, 3)), cameras()[6]);
    let method = Method::Pyramid(Settings::default());
    let wrong = |frame: &mut Frame<f32>, level: &str| {
        let Samples::Scalar(fronts) = samples_mut(frame, level) else { panic!("{level}") };
        fronts.values_mut().iter_mut().for_each(|front| *front += 0.125);
    };
    let run = |stage: &str, level: &str| {
        let change = |frame: &mut Frame<f32>| wrong(frame, level);
        stage_with(&scene, &camera, method, stage, change).unwrap()
    };
    for (stage, level, next) in
        [("pull", "pull02.front", "pull03"), ("push", "push03.front", "push02")]
    {
        let right = stage_with(&scene, &camera, method, stage, |_| {}).unwrap();
        let found = run(stage, level);
        for (found, right) in found.planes.iter().zip(&right.planes) {
            let same = format!("{found:?}") == format!("{right:?}");
            assert!(same || found.name.starts_with(next), "{}", found.name);
        }
        assert!(found != right, "nothing of {next} has changed");
    }
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
    let of = |fields: &CellFields<R>, range: std::ops::Range<usize>| {
        let empty = |[width, height]: [u32; 2]| Plane::filled(width, height, Cell::empty());
        let level = |l| given.records(fields, l, empty(sizes[l])).unwrap();
        range.map(level).collect::<Vec<_>>()
    };
    let (pulled, pushed) = (of(&Cell::PULL, 1..sizes.len()), of(&Cell::PUSH, 0..sizes.len() - 1));
    let (mut kinds, mut occluded) = ([0; 5], 0);
    for (x, y) in (0..frame.height).flat_map(|y| (0..frame.width).map(move |x| (x, y))) {
        let found = explain::<R>(&job, settings, (x, y)).unwrap();
        let sample = samples.at(x, y);
        let kept = (sample.kind != SampleKind::Empty).then_some((sample.id, sample.depth));
        assert_eq!(found.projection.kept, kept, "({x}, {y})");
        assert_eq!(found.pulled.len(), pulled.len());
        for ((level, found), cells) in (1..).zip(&found.pulled).zip(&pulled) {
            assert_eq!(found.found, *cells.at(x >> level, y >> level), "({x}, {y}), pull {level}");
        }
        assert_eq!(found.pushed.len(), pushed.len());
        for ((level, cells), found) in pushed.iter().enumerate().rev().zip(&found.pushed) {
            assert_eq!(found.left, *cells.at(x >> level, y >> level), "({x}, {y}), push {level}");
        }
        assert_eq!(frame.scalar("Z").unwrap().at(x, y), &found.shown.front);
        assert_eq!(*frame.count("kind").unwrap().at(x, y), found.shown.kind as u8);
        kinds[found.shown.kind as usize] += 1;
        let text = found.to_string();
        assert!(text.contains(found.shown.kind.name()), "{text}");
        occluded += usize::from(text.contains("occluded"));
        assert_eq!(text, explain::<R>(&job, settings, (x, y)).unwrap().to_string());
    }
    assert!(kinds[0] > 0 && kinds[1] > 50 && occluded > 10, "{kinds:?}, {occluded}");
}

#[test]
fn explanations_agree_with_the_picture() {
    let camera = cameras()[4];
    let tiny = Scene { surfels: surfels(80, 0.4, true, 7), ..hybrid(true) };
    for settings in settings() {
        assert_explained::<f32>(&tiny, &camera, &settings);
        assert_explained::<f64>(&scene(surfels(300, 0.2, false, 9)), &camera, &settings);
    }
}

#[test]
fn a_pixel_of_one_surfel_in_words() {
    let (scene, camera) = (scene(surfels(300, 0.1, false, 9)), cameras()[4]);
    let (exec, settings) = (Exec::sequential(), Settings::default());
    let index = Index::default();
    let job = Job::new(&scene, &index, &camera, &exec);
    let text = explain::<f32>(&job, &settings, (16, 8)).unwrap().to_string();
    for part in ["pixel (16, 8)", "projection:", "pull:", "push:", "level 1, cell (8, 4)", "ulp"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}
