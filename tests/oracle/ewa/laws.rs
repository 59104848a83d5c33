//! Laws of the 2+1-pass method, on whole pictures.

use crate::oracle::ewa::cases::{self, Kind};
use crate::oracle::kit::case::Case;
use crate::oracle::kit::draw::explained;
use crate::oracle::kit::planes::numbers;
use crate::oracle::kit::scene::{OUTLINES, change};
use glam::{Mat4, Vec3, Vec4};
use proptest::prelude::*;
use splatref::frame::NO_ID;
use splatref::method::ewa::Settings;
use splatref::splat::Epsilon;
use splatref::splat::Kernel;

/// Whether two lists are equal within a part of their largest number.
fn close(a: &[f64], b: &[f64], part: f64) -> bool {
    let largest = a.iter().filter(|v| v.is_finite()).fold(1.0, |m: f64, v| m.max(v.abs()));
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b || (a - b).abs() <= part * largest)
}

fn case() -> impl Strategy<Value = Case<Settings>> {
    let kinds = prop::sample::select(vec![
        Kind::Discs,
        Kind::Axes,
        Kind::Tilted,
        Kind::Shape(0),
        Kind::Shape(5),
    ]);
    (kinds, any::<u32>(), any::<bool>(), 0..3_usize, any::<bool>()).prop_map(
        |(kind, seed, orthographic, outline, cull)| {
            let kernel = Kernel { outline: OUTLINES[outline], ..Kernel::DEFAULT };
            let settings = Settings { kernel, epsilon: Epsilon::MedianRadii(1.0), cull };
            let mut case = cases::case(kind, seed.into(), settings, orthographic);
            case.scene.lights.clear();
            case
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn order_changes_roundings_only(mut case in case()) {
        let before = case.drawing().frame::<f32>();
        let last = case.scene.surfels.len() as u32 - 1;
        change(&mut case.scene, |cloud| {
            cloud.position.reverse();
            cloud.normal.as_mut().into_iter().for_each(|v| v.reverse());
            cloud.radius.as_mut().into_iter().for_each(|v| v.reverse());
            cloud.color.as_mut().into_iter().for_each(|v| v.reverse());
            cloud.tangents.as_mut().into_iter().for_each(|v| v.reverse());
        });
        let after = case.drawing().frame::<f32>();
        for plane in ["attributes.count", "visibility.Z", "Z", "A"] {
            prop_assert_eq!(numbers(&before, plane), numbers(&after, plane), "{}", plane);
        }
        for plane in ["attributes.weight", "attributes", "attributes.normal"] {
            prop_assert!(close(&numbers(&before, plane), &numbers(&after, plane), 1e-5), "{}", plane);
        }
        // An id that does not follow is that of a tie, which goes to the lower index.
        let (ids, others) = (numbers(&before, "id"), numbers(&after, "id"));
        for (i, (id, other)) in (0_u32..).zip(ids.iter().zip(&others)) {
            let follows = f64::from(last) - id;
            if *id == f64::from(NO_ID) || follows == *other {
                continue;
            }
            let pixel = (i % case.camera.width, i / case.camera.width);
            let why = explained(&case, pixel);
            let nearness = |id: f64| why.touches.iter().find(|t| f64::from(t.surfel) == id).map(|t| t.w);
            prop_assert!(nearness(follows).is_some(), "{follows} is not at {pixel:?}");
            prop_assert_eq!(nearness(follows), nearness(*other), "no tie at {:?}", pixel);
            prop_assert!(*other < follows, "the tie went to the higher index at {pixel:?}");
        }
    }

    #[test]
    fn a_mirrored_scene_gives_the_mirrored_picture(mut case in case()) {
        let before = case.drawing().frame::<f64>();
        let mirror = Vec3::new(-1.0, 1.0, 1.0);
        // Mirrored in the world, seen by the mirrored camera: x changes sign in view space.
        let flip = Mat4::from_scale(mirror);
        case.camera.view_from_world = flip * case.camera.view_from_world * flip;
        case.camera.cx = case.camera.width as f32 - case.camera.cx;
        change(&mut case.scene, |cloud| {
            cloud.position.iter_mut().for_each(|v| *v *= mirror);
            cloud.normal.iter_mut().flatten().for_each(|v| *v *= mirror);
            cloud.tangents.iter_mut().flatten().flatten().for_each(|v| *v *= mirror);
        });
        let after = case.drawing().frame::<f64>();
        let width = case.camera.width as usize;
        for plane in ["id", "attributes.count", "visibility.Z", "weight", "resolved", ""] {
            let (there, here) = (numbers(&before, plane), numbers(&after, plane));
            let components = there.len() / (width * case.camera.height as usize);
            let mirrored: Vec<f64> = here
                .chunks(width * components.max(1))
                .flat_map(|row| row.chunks(components.max(1)).rev().flatten().copied().collect::<Vec<_>>())
                .collect();
            // Of two depths that are equal but for rounding the other may be nearer: that of the
            // plane beside it is the same.
            let others = there.iter().zip(&mirrored).filter(|(a, b)| a != b).count();
            let ties = plane == "id" && others <= 2;
            prop_assert!(ties || close(&there, &mirrored, 1e-9), "plane '{}' of {:?}", plane, case);
        }
    }

    #[test]
    fn moving_scene_and_camera_together_changes_no_bit(
        mut case in case().prop_filter("an identity view", |c| c.camera.view_from_world == Mat4::IDENTITY),
        by in (-8_i32..8, -8_i32..8, -8_i32..8),
    ) {
        let by = Vec3::new(by.0 as f32, by.1 as f32, by.2 as f32);
        // Multiples of 2^-12: sums with integers are exact, and so are the differences.
        let grid = |v: Vec3| (v * 4096.0).round() / 4096.0;
        change(&mut case.scene, |cloud| cloud.position.iter_mut().for_each(|v| *v = grid(*v)));
        let before = case.drawing().frame::<f32>();
        change(&mut case.scene, |cloud| cloud.position.iter_mut().for_each(|v| *v += by));
        case.camera.view_from_world.w_axis = Vec4::new(-by.x, -by.y, -by.z, 1.0);
        let after = case.drawing().frame::<f32>();
        for plane in &before.planes {
            let name = plane.name.as_str();
            prop_assert_eq!(numbers(&before, name), numbers(&after, name), "plane '{}'", name);
        }
    }
}
