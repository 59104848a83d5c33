//! The fast path equals the definition, bit for bit.

use super::points::{CHUNK, depth, order};
use super::*;
use crate::frame::raster::Snap;
use crate::frame::{Exec, NO_ID};
use crate::index::Index;
use crate::method::Job;
use crate::method::projection::project;
use crate::method::projection::surfels::PointProjector;
use crate::method::tests::{cameras, scene, surfels};
use crate::number::lanes::{LANES, Lanes};
use crate::scene::{Camera, Cloud, Projection, Surfels};
use crate::splat::View;

/// The samples of the fast path, as text. The shortest decimals tell floats apart, and the signs of
/// zeros.
fn samples(of: &Surfels, camera: &Camera, cull: bool, points: &mut Points) -> Vec<String> {
    let exec = Exec::new(3, 16).unwrap();
    let lens = PointProjector::new(View::new(camera), cull);
    points.find(of, &lens, &exec);
    let width = camera.width as usize;
    let mut rows = vec![vec![String::new(); width]; camera.height as usize];
    let draw = |nearest: NearestPoints<'_>, row: &mut Vec<String>| {
        for x in (0..width).step_by(LANES) {
            let Some(s) = nearest.take(x) else { continue };
            let ids = nearest.ids(&s);
            let (center, color) = (nearest.centers(&ids), nearest.colors(&ids));
            for i in 0..LANES.min(width - x) {
                if ids[i] == NO_ID {
                    assert_eq!(s.depth[i], f32::INFINITY);
                    continue;
                }
                let lane = |of: &[Lanes; 3]| of.map(|lanes| lanes[i]);
                let center = center.map(|lanes| lanes[i]);
                let form = (s.depth[i], s.radius[i], s.extent[i], center, lane(&s.normal));
                let color = color.as_ref().map_or([0.0; 3], lane);
                row[x + i] = format!("{} {form:?} {color:?}", ids[i]);
            }
        }
    };
    points.each_band(of, &lens, pairs(rows.iter_mut()), &exec, |band, pairs, _| {
        for (y, (upper, lower)) in (0..).step_by(2).zip(pairs) {
            draw(band.row(y), upper);
            if let Some(lower) = lower {
                draw(band.row(y + 1), lower);
            }
        }
    });
    rows.concat()
}

/// The samples of the definition.
fn expected(of: &Surfels, camera: &Camera, cull: bool) -> Vec<String> {
    let exec = Exec::sequential();
    let snap = Snap::new(8).unwrap();
    let (scene, index) = (scene(of.clone()), Index::default());
    let projected = project::<f32>(&Job::new(&scene, &index, camera, &exec), cull, snap).unwrap();
    let text = |s: &crate::method::projection::PixelSample<f32>| {
        let normal = [s.normal.x, s.normal.y, s.normal.z];
        let form = (s.depth, s.radius, s.extent, [s.center.x, s.center.y], normal);
        format!("{} {form:?} {:?}", s.id, s.color)
    };
    let samples = projected.samples.values().iter();
    samples.map(|s| if s.id == NO_ID { String::new() } else { text(s) }).collect()
}

#[test]
fn samples_have_the_bits_of_the_definition() {
    let mut points = Points::default();
    for (i, camera) in cameras().into_iter().enumerate() {
        // Counts around a chunk and around full lanes.
        for count in [1, 16, 17, CHUNK as u64 - 1, CHUNK as u64 + 1, 2 * CHUNK as u64] {
            for cull in [true, false] {
                let of = surfels(count, 0.1, count % 2 == 1, i as u64);
                let found = samples(&of, &camera, cull, &mut points);
                assert!(
                    found == expected(&of, &camera, cull),
                    "{count} surfels, camera {i}, {cull}"
                );
            }
        }
    }
}

#[test]
fn of_equal_depths_the_lower_index_stays() {
    let few = surfels(100, 0.1, true, 5);
    let again = |of: &[glam::Vec3]| of.repeat(2 * CHUNK / 100);
    let copies = Surfels::new(Cloud {
        position: again(few.position()),
        normal: Some(again(few.normal())),
        radius: Some(few.radius().repeat(2 * CHUNK / 100)),
        color: few.color().map(again),
        ..Cloud::default()
    });
    let copies = copies.unwrap().0;
    for camera in cameras() {
        let found = samples(&copies, &camera, true, &mut Points::default());
        assert!(found == samples(&few, &camera, true, &mut Points::default()));
    }
}

#[test]
fn depths_may_be_negative() {
    let of = surfels(20_000, 0.1, false, 3);
    for camera in cameras() {
        if camera.projection == Projection::Orthographic {
            // Cameras whose near plane runs through the middle of the scene, and with all of the
            // scene behind them.
            for shift in [4.0, 8.0] {
                let mut camera = Camera { near: -100.0, ..camera };
                camera.view_from_world.w_axis.z += shift;
                let found = samples(&of, &camera, true, &mut Points::default());
                assert!(found == expected(&of, &camera, true), "{shift}");
                assert!(found.iter().any(|sample| sample.contains(" (-")), "{shift}");
            }
        }
    }
}

#[test]
fn order_is_that_of_the_numbers() {
    let tiny = f32::from_bits(1);
    let ascending = [f32::MIN, -1.5, -1.0, -f32::MIN_POSITIVE, -tiny, 0.0, tiny, 1.0, f32::MAX];
    assert!(ascending.map(order).is_sorted_by(|a, b| a < b));
    assert_eq!(ascending.map(|t| depth(order(t)).to_bits()), ascending.map(f32::to_bits));
    assert!(order(f32::MAX) < u32::MAX, "the order of no point");
}
