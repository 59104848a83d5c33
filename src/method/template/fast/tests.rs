//! The fast path equals the definition, bit for bit.

use super::super::LevelRule;
use super::*;
use crate::frame::{Samples, Wanted};
use crate::index::Index;
use crate::method::algorithm::{Algorithm, Job};
use crate::method::tests::{cameras, scene, surfels};

/// The planes of a framebuffer as bits.
fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn every_pixel_has_the_bits_of_the_definition() {
    let exec = Exec::new(3, 16).unwrap();
    // Used again and again, also for other sizes.
    let mut levels = CenterLevels::default();
    for (i, camera) in cameras().into_iter().enumerate() {
        for (count, radius) in [(1, 1e30), (37, 0.4), (3000, 0.05), (50_000, 0.01)] {
            let scene = scene(surfels(count, radius, count % 2 == 1, i as u64));
            for (size, rule, falloff) in [
                (3, LevelRule::Covering, Falloff::Linear),
                (5, LevelRule::Diameter, Falloff::Gaussian),
                (5, LevelRule::Radius, Falloff::Linear),
                (7, LevelRule::Covering, Falloff::Gaussian),
            ] {
                let settings = Settings { size, levels: rule, falloff, cull: count != 3000 };
                let color = scene.surfels.color().is_some();
                let wanted = Wanted { normal: true, color, observed: false };
                let mut found = Framebuffer::new(camera.width, camera.height, 9.0, wanted);
                let (tally, _) = levels.draw(&scene, &camera, &settings, &exec, &mut found);
                let (index, camera) = (&Index::default(), &camera);
                let job = Job::new(&scene, index, camera, &exec);
                let picture = settings.define::<f32>(&job, true).unwrap();
                let place = format!("{i}: {count} surfels, {settings:?}");
                assert_eq!(tally, picture.tally, "{place}");
                let expected = |name: &str| match picture.frame.plane(name) {
                    Some(Samples::Scalar(plane)) => bits(plane.values()),
                    Some(Samples::Vector(plane) | Samples::Color(plane)) => {
                        bits(plane.values().as_flattened())
                    }
                    Some(Samples::Index(plane)) => plane.values().to_vec(),
                    _ => panic!("no plane {name}"),
                };
                assert_eq!(found.id.values(), expected("id"), "{place}");
                assert_eq!(bits(found.depth.values()), expected("Z"), "{place}");
                assert_eq!(bits(found.weight.values()), expected("weight"), "{place}");
                let normal = found.normal.unwrap();
                assert_eq!(bits(normal.values().as_flattened()), expected("normal"), "{place}");
                if let Some(color) = found.color {
                    // The scene is unlit, so that the picture is the colour, black where it is
                    // empty.
                    assert_eq!(bits(color.values().as_flattened()), expected(""), "{place}");
                }
                assert!(found.weight.values().iter().all(|weight| weight.is_finite()));
            }
        }
    }
}
