//! Laws of compositing, on functions and on whole pictures.

use crate::ewa::cases::{Case, Kind, OUTLINES};
use glam::{Mat4, Vec3, Vec4};
use proptest::prelude::*;
use splatref::composite::{decide, sum};
use splatref::frame::{Exec, Frame, NO_ID, Samples};
use splatref::method::ewa::explain::explain;
use splatref::method::ewa::{self, Epsilon, Settings};
use splatref::number::Exact;
use splatref::scene::{Cloud, Surfels};
use splatref::splat::Kernel;

/// A depth: ordinary, a few ulp from another, huge, tiny.
fn depth() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => 0.01_f32..100.0,
        4 => (-3_i32..=3).prop_map(|ulps| f32::from_bits((3.0_f32.to_bits() as i32 + ulps) as u32)),
        1 => 1e-38_f32..1e-30,
        1 => 1e30_f32..3e38,
    ]
}

fn band() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0_f32), Just(f32::INFINITY), 0.0_f32..1e-6, 0.0_f32..10.0, 1e-44_f32..1e-38]
}

/// A weight that the pipeline can make: at least 2^-96 times the kernel at its rim.
fn weight() -> impl Strategy<Value = f32> {
    prop_oneof![4 => 1e-4_f32..1.0, 1 => 1e-30_f32..1e-20]
}

/// The epsilon-z test of a depth against the nearest of its pixel.
fn visible(t: f32, nearest: f32, epsilon: f32) -> bool {
    decide::visible(t, decide::limit(nearest, epsilon))
}

proptest! {
    #[test]
    fn the_epsilon_test_is_an_interval_that_grows(t in depth(), nearest in depth(), a in band(), b in band()) {
        let (small, large) = if a < b { (a, b) } else { (b, a) };
        prop_assert!(visible(nearest, nearest, a), "the nearest passes");
        prop_assert!(visible(t, nearest, f32::INFINITY), "inf keeps everything");
        prop_assert!(!visible(t, nearest, small) || visible(t, nearest, large));
        let (near, far) = if t < nearest { (t, nearest) } else { (nearest, t) };
        prop_assert_eq!(visible(far, near, 0.0), far == near, "0 keeps ties alone");
        // Nearer never fails where farther passes; in f64 f32 operands add without rounding here.
        prop_assert!(!visible(far, nearest, a) || visible(near, nearest, a));
    }

    #[test]
    fn the_average_of_a_constant_is_the_constant(
        weights in prop::collection::vec(weight(), 1..300),
        value in (0.0_f32..1.0, 1e-3_f32..1e3).prop_map(|(a, b)| [a, b, 1.0]),
    ) {
        let (mut total, mut colors) = (0.0_f32, [0.0_f32; 3]);
        for w in &weights {
            total += w;
            colors = sum::add(colors, *w, value);
        }
        let average = sum::average(colors, total);
        for (a, v) in average.into_iter().zip(value) {
            // Each sum of n terms >= 0 is off by n roundings, each product by one, the quotient by one.
            let bound = (2 * weights.len() + 2) as f32 * 2.0_f32.powi(-24) * v;
            prop_assert!((a - v).abs() <= bound + 1e-37, "{} for {}", a, v);
        }
        prop_assert_eq!(average[2], 1.0, "weights themselves average to 1 exactly");
        let direction = sum::direction(colors.map(|c| c + total), total);
        let length = direction.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
        prop_assert!((length - 1.0).abs() < 4e-7, "length {}", length);
    }

    #[test]
    fn without_weight_there_is_nothing(a: f32, b: f32, c: f32) {
        prop_assert_eq!(sum::average([a, b, c], 0.0).map(f32::to_bits), [0; 3]);
        prop_assert_eq!(sum::direction([a, b, c], 0.0).map(f32::to_bits), [0; 3]);
        // Opposite normals cancel to nothing, not to NaN.
        prop_assert_eq!(sum::direction([0.0, -0.0, 0.0], 1.0).map(f32::to_bits), [0; 3]);
    }
}

fn numbers<R: Exact>(frame: &Frame<R>, name: &str) -> Vec<f64> {
    match frame.plane(name) {
        Some(Samples::Scalar(p)) => p.values().iter().map(|v| v.to_f64()).collect(),
        Some(Samples::Color(p) | Samples::Vector(p)) => {
            p.values().iter().flatten().map(|v| v.to_f64()).collect()
        }
        Some(Samples::Index(p)) => p.values().iter().map(|v| f64::from(*v)).collect(),
        Some(Samples::Count(p)) => p.values().iter().map(|v| f64::from(*v)).collect(),
        None => Vec::new(),
    }
}

fn render<R: Exact>(case: &Case) -> Frame<R> {
    let exec = Exec::sequential();
    let picture = ewa::render::<R>(&case.scene, &case.camera, &case.settings, &exec, true);
    picture.expect("renders").frame
}

/// Whether two lists are equal within a part of their largest number.
fn close(a: &[f64], b: &[f64], part: f64) -> bool {
    let largest = a.iter().filter(|v| v.is_finite()).fold(1.0, |m: f64, v| m.max(v.abs()));
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b || (a - b).abs() <= part * largest)
}

/// The surfels of a case, changed.
fn changed(case: &mut Case, change: impl FnOnce(&mut Cloud)) {
    let mut cloud = case.scene.surfels.clone().into_cloud();
    change(&mut cloud);
    case.scene.surfels = Surfels::new(cloud).expect("still good").0;
}

fn case() -> impl Strategy<Value = Case> {
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
            let mut case = Case::new(kind, seed.into(), settings, orthographic);
            case.scene.lights.clear();
            case
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn order_changes_roundings_only(mut case in case()) {
        let before = render::<f32>(&case);
        let last = case.scene.surfels.len() as u32 - 1;
        changed(&mut case, |cloud| {
            cloud.position.reverse();
            cloud.normal.as_mut().into_iter().for_each(|v| v.reverse());
            cloud.radius.as_mut().into_iter().for_each(|v| v.reverse());
            cloud.color.as_mut().into_iter().for_each(|v| v.reverse());
            cloud.tangents.as_mut().into_iter().for_each(|v| v.reverse());
        });
        let after = render::<f32>(&case);
        for plane in ["attributes.count", "visibility.Z", "Z", "A"] {
            prop_assert_eq!(numbers(&before, plane), numbers(&after, plane), "{}", plane);
        }
        for plane in ["attributes.weight", "attributes", "attributes.normal"] {
            prop_assert!(close(&numbers(&before, plane), &numbers(&after, plane), 1e-5), "{}", plane);
        }
        // An id that does not follow is that of a tie, which goes to the lower index.
        let (ids, others) = (numbers(&before, "id"), numbers(&after, "id"));
        let Case { scene, camera, settings, .. } = &case;
        for (i, (id, other)) in (0_u32..).zip(ids.iter().zip(&others)) {
            let follows = f64::from(last) - id;
            if *id == f64::from(NO_ID) || follows == *other {
                continue;
            }
            let pixel = (i % camera.width, i / camera.width);
            let exec = Exec::sequential();
            let why = explain::<f32>(&scene.surfels, camera, settings, &exec, pixel).expect("inside");
            let nearness = |id: f64| why.touches.iter().find(|t| f64::from(t.surfel) == id).map(|t| t.w);
            prop_assert!(nearness(follows).is_some(), "{follows} is not at {pixel:?}");
            prop_assert_eq!(nearness(follows), nearness(*other), "no tie at {:?}", pixel);
            prop_assert!(*other < follows, "the tie went to the higher index at {pixel:?}");
        }
    }

    #[test]
    fn a_mirrored_scene_gives_the_mirrored_picture(mut case in case()) {
        let before = render::<f64>(&case);
        let mirror = Vec3::new(-1.0, 1.0, 1.0);
        // Mirrored in the world, seen by the mirrored camera: x changes sign in view space.
        let flip = Mat4::from_scale(mirror);
        case.camera.view_from_world = flip * case.camera.view_from_world * flip;
        case.camera.cx = case.camera.width as f32 - case.camera.cx;
        changed(&mut case, |cloud| {
            cloud.position.iter_mut().for_each(|v| *v *= mirror);
            cloud.normal.iter_mut().flatten().for_each(|v| *v *= mirror);
            cloud.tangents.iter_mut().flatten().flatten().for_each(|v| *v *= mirror);
        });
        let after = render::<f64>(&case);
        let width = case.camera.width as usize;
        for plane in ["id", "attributes.count", "visibility.Z", "weight", "resolved", ""] {
            let (there, here) = (numbers(&before, plane), numbers(&after, plane));
            let components = there.len() / (width * case.camera.height as usize);
            let mirrored: Vec<f64> = here
                .chunks(width * components.max(1))
                .flat_map(|row| row.chunks(components.max(1)).rev().flatten().copied().collect::<Vec<_>>())
                .collect();
            prop_assert!(close(&there, &mirrored, 1e-9), "plane '{}' of {:?}", plane, case);
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
        changed(&mut case, |cloud| cloud.position.iter_mut().for_each(|v| *v = grid(*v)));
        let before = render::<f32>(&case);
        changed(&mut case, |cloud| cloud.position.iter_mut().for_each(|v| *v += by));
        case.camera.view_from_world.w_axis = Vec4::new(-by.x, -by.y, -by.z, 1.0);
        let after = render::<f32>(&case);
        for plane in &before.planes {
            let name = plane.name.as_str();
            prop_assert_eq!(numbers(&before, name), numbers(&after, name), "plane '{}'", name);
        }
    }
}
