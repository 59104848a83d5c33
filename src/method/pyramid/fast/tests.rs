//! The fast path equals the definition, bit for bit.

use super::super::tests::indexed;
use super::super::{Occlusion, Weights};
use super::*;
use crate::frame::Pool;
use crate::index::Index;
use crate::method::Algorithm;
use crate::method::tests::{cameras, scene, surfels};
use crate::scene::{Light, Primitives, Scene};

fn assert_same(scene: Scene, camera: &Camera, settings: &Settings, levels: &mut CellLevels) {
    // With a light, so that normals are there too.
    let scene = Scene { lights: vec![Light::DEFAULT], ..scene };
    let exec = Exec::new(3, 16).unwrap();
    let index = Index::default();
    let job = Job::new(&scene, &index, camera, &exec);
    let expected = settings.define::<f32>(&job, false).unwrap();
    let found = Algorithm::draw(settings, &job, levels, &mut Pool::default()).unwrap();
    assert_eq!(found.tally, expected.tally);
    assert_eq!(found.frame.planes.len(), expected.frame.planes.len());
    for (found, expected) in found.frame.planes.iter().zip(&expected.frame.planes) {
        // The shortest decimals of floats tell them apart to the last bit, and the signs of zeros.
        let same = format!("{found:?}") == format!("{expected:?}");
        assert!(same, "{}, {settings:?}, {} surfels", expected.name, scene.surfels.len());
    }
}

#[test]
fn every_cell_has_the_bits_of_the_definition() {
    // Used again and again, also for other sizes.
    let mut levels = CellLevels::default();
    for (i, camera) in cameras().into_iter().enumerate() {
        for (count, radius) in [(1, 1e30), (37, 0.4), (3000, 0.05), (50_000, 0.01)] {
            let surfels = surfels(count, radius, count % 2 == 1, i as u64);
            for occlusion in [Occlusion::Behind, Occlusion::Outside] {
                let weights = if count == 37 { Weights::Box } else { Weights::Gaussian };
                let cull = count != 3000;
                let settings = Settings { weights, occlusion, cull, ..Settings::default() };
                assert_same(scene(surfels.clone()), &camera, &settings, &mut levels);
            }
        }
    }
}

#[test]
fn triangles_and_lines_too() {
    let mut levels = CellLevels::default();
    for (i, camera) in cameras().into_iter().enumerate() {
        let primitives = Primitives {
            triangles: indexed(9, 100),
            ribbons: indexed(40, 200),
            tubes: indexed(40, 300),
        };
        let scene = Scene { primitives, ..scene(surfels(500, 0.05, i % 2 == 0, 7)) };
        for cull in [true, false] {
            let settings = Settings { cull, ..Settings::default() };
            assert_same(scene.clone(), &camera, &settings, &mut levels);
        }
    }
}
