//! What must hold whatever the scene.

use super::cases::case;
use crate::oracle::kit::case::Case;
use crate::oracle::kit::planes::{bits, digest, index, number};
use crate::oracle::kit::scene::{change, surfels};
use proptest::prelude::*;
use splatref::frame::{Exec, NO_ID};
use splatref::method::blue::Settings;
use splatref::scene::{Cloud, Primitives, Sides, Surfels};

/// A scene of one of the surfels.
fn alone(case: &Case<Settings>, i: usize) -> Case<Settings> {
    let of = &case.scene.surfels;
    let mut scene = case.scene.clone();
    scene.surfels = surfels(Cloud {
        position: vec![of.position()[i]],
        normal: Some(vec![of.normal()[i]]),
        radius: Some(vec![of.radius()[i]]),
        ..Cloud::default()
    });
    let side = scene.sides.as_ref().and_then(|sides| sides.side(i as u32));
    scene.sides = side.and_then(|side| Sides::new(vec![(0, Some(side))]).ok());
    scene.primitives = Primitives::default();
    let Case { name, camera, settings, .. } = case;
    Case {
        name: name.clone(),
        scene,
        camera: *camera,
        settings: *settings,
        groups: None,
        exact: false,
    }
}

/// Depth and id at each pixel.
fn shown(case: &Case<Settings>) -> Vec<(f64, u32)> {
    let frame = case.drawing().plain::<f32>();
    case.pixels().map(|(i, ..)| (number(&frame, "Z", i), index(&frame, "id", i))).collect()
}

fn random(cases: u32) -> ProptestConfig {
    ProptestConfig::with_cases(cases)
}

proptest! {
    #![proptest_config(random(60))]

    /// So a surfel changes only the pixels in which it is seen alone, and only where it is nearer.
    #[test]
    fn a_picture_is_the_nearest_of_its_surfels_alone_and_its_triangles(seed in any::<u64>()) {
        let case = case(seed);
        let count = case.scene.surfels.len();
        let mut nearest = vec![(f64::INFINITY, NO_ID); case.pixels().count()];
        let mut draw = |of: &Case<Settings>, first: u32| {
            for (held, (z, id)) in nearest.iter_mut().zip(shown(of)) {
                if z < held.0 {
                    *held = (z, first + id);
                }
            }
        };
        (0..count).for_each(|i| draw(&alone(&case, i), i as u32));
        let mut beside = alone(&case, 0);
        beside.scene.surfels = Surfels::none();
        beside.scene.primitives = case.scene.primitives.clone();
        draw(&beside, count as u32);
        prop_assert_eq!(shown(&case), nearest);
    }

    #[test]
    fn the_order_of_surfels_changes_ties_alone(seed in any::<u64>()) {
        let mut case = case(seed);
        case.scene.sides = None;
        let count = case.scene.surfels.len() as u32;
        let before = shown(&case);
        let all: Vec<_> = (0..count).map(|i| shown(&alone(&case, i as usize))).collect();
        change(&mut case.scene, |cloud| {
            cloud.position.reverse();
            for of in [&mut cloud.normal, &mut cloud.color] {
                of.iter_mut().for_each(|of| of.reverse());
            }
            cloud.radius.iter_mut().for_each(|of| of.reverse());
        });
        for (i, (now, before)) in shown(&case).into_iter().zip(before).enumerate() {
            prop_assert_eq!(now.0, before.0);
            let own = if now.1 < count { count - 1 - now.1 } else { now.1 };
            let tie = || all[own as usize][i].0 == before.0;
            prop_assert!(own == before.1 || tie(), "{} {}", own, before.1);
        }
    }

    #[test]
    fn a_larger_side_never_loses_a_pixel(seed in any::<u64>(), side in 0.25_f32..20.0, more in 1.0_f32..3.0) {
        let mut case = case(seed);
        let mut with = |side: f32| {
            case.scene.sides = Sides::new(vec![(0, Some(side))]).ok();
            shown(&case)
        };
        let (small, large) = (with(side), with(side * more));
        for (small, large) in small.into_iter().zip(large) {
            prop_assert!(large.0 <= small.0);
        }
    }

    #[test]
    fn neither_threads_nor_tiles_nor_the_path_leave_a_trace(seed in any::<u64>(), tile in 0..4_usize) {
        let case = case(seed);
        let one = case.drawing().plain::<f32>();
        for threads in [1, 3] {
            let exec = Exec::new(threads, 8 << tile).expect("a tile size");
            prop_assert_eq!(digest(&case.drawing().on(&exec).plain::<f32>()), digest(&one));
            let fast = case.drawing().on(&exec).fast();
            prop_assert_eq!(fast.frame.planes.len(), one.planes.len());
            for (fast, plain) in fast.frame.planes.iter().zip(&one.planes) {
                prop_assert_eq!(&fast.name, &plain.name);
                prop_assert!(bits(&fast.samples) == bits(&plain.samples), "{} of {:?}", plain.name, case);
            }
        }
    }
}
