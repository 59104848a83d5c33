mod prefixes;

use super::*;
use crate::scene::transform::rotation;
use crate::scene::{Lens, Motion, Object, Pose, Primitives, Sphere, Surfels};
use crate::source::Shape;
use glam::Vec3;
use proptest::prelude::*;

/// Balls with `count` surfels each, with a threshold or without levels of detail, in places.
fn scene(count: usize, thresholds: &[Option<f64>], places: &[(usize, Similarity)]) -> Objects {
    let exec = Exec::sequential();
    let geometries = thresholds.iter().map(|threshold| {
        let surfels = Shape::Sphere.surfels(count, 3).unwrap();
        let primitives = Primitives::default();
        let plain = Geometry { name: "ball".into(), surfels, primitives, detail: None };
        match threshold {
            Some(threshold) => plain.with_detail(*threshold, &exec).unwrap(),
            None => plain,
        }
    });
    let objects = places.iter().map(|&(geometry, place)| Object {
        name: "one".into(),
        geometry,
        motion: Motion::still(place),
        color: None,
    });
    Objects::new(geometries.collect(), objects.collect(), Vec3::ONE).unwrap()
}

fn at(degrees: f64, scale: f64, translation: DVec3) -> Similarity {
    Similarity { rotation: rotation(DVec3::new(1.0, 2.0, 0.5), degrees), scale, translation }
}

fn camera(eye: DVec3, target: DVec3, lens: Lens) -> Camera {
    Camera::new(64, 48, Pose { eye, target, up: DVec3::Y }, lens).unwrap()
}

/// The radii that are drawn, in the world, object by object.
fn radii(objects: &Objects) -> Vec<Vec<f32>> {
    let all = |object: u32| {
        let (surfels, scale) =
            (&objects.geometry(object).surfels, objects.places()[object as usize].scale);
        let of = |i: usize| (f64::from(surfels.radius()[i]) * scale) as f32;
        match objects.drawn(object) {
            Some(mask) => mask.surfels().map(of).collect(),
            None => vec![(f64::from(surfels.median_radius()) * scale) as f32; surfels.len()],
        }
    };
    (0..objects.objects().len() as u32).map(all).collect()
}

proptest! {
    /// In the world, without the tests of the list: a drawn node has an error of at most tau
    /// pixels, and its parent has more, except for the gap. Every surfel has a node that is drawn.
    #[test]
    fn what_is_drawn_is_good_enough_and_no_better(
        degrees in 0.0..360.0_f64, scale in 0.25..4.0_f64, tau in prop_oneof![Just(0.0), 0.25..8.0_f64],
        from in prop::array::uniform3(-1.0..1.0_f64), away in 0.5..40.0_f64, ortho in any::<bool>(),
    ) {
        let place = at(degrees, scale, DVec3::new(0.5, -0.25, 1.0));
        let objects = scene(400, &[Some(tau)], &[(0, place)]);
        let target = place.translation;
        let direction = DVec3::from_array(from) + DVec3::new(0.0, 0.0, 2.0);
        let lens = if ortho { Lens::Orthographic(2.0 * scale) } else { Lens::FieldOfView(40.0) };
        let camera = camera(target + direction.normalize() * (away * scale), target, lens);
        let seen = objects.seen_from(&camera, &Exec::sequential()).unwrap();
        let (list, surfels) = (seen.geometry(0).tree().unwrap().list(), &seen.geometry(0).surfels);
        let mask = seen.drawn(0).unwrap();
        let pixels = |node: usize, error: f32| {
            let p = place.rotation * (surfels.position()[node].as_dvec3() * scale) + target;
            let depth = if ortho { 1.0 } else { (p - camera.eye()).length() };
            f64::from(error) * scale * f64::from(camera.fy) / depth
        };
        let count = seen.ids().count(0) as usize;
        for node in 0..surfels.len() {
            let own = pixels(node, list.near()[node]);
            let gap = if ortho { 0.0 } else { f64::from(list.gap()[node]) };
            let larger = f64::from(list.far()[node])
                + gap * if tau == 0.0 { 0.0 } else { tau / f64::from(camera.fy) };
            let parent = pixels(node, 1.0) * larger;
            let (slack, drawn) = (1e-5 * (tau + own), mask.has(node));
            if drawn {
                prop_assert!(own <= tau + slack && parent + 1e-5 * parent >= tau, "{node}");
                prop_assert!(node < count);
            } else {
                prop_assert!(own >= tau - slack || parent <= tau * (1.0 + 1e-5), "{node}");
            }
        }
        for leaf in (0..surfels.len()).filter(|&node| list.surfel(node).is_some()) {
            let mut path = std::iter::successors(Some(leaf), |&node| list.parent(node));
            prop_assert!(path.any(|node| mask.has(node)));
        }
        if tau == 0.0 {
            prop_assert_eq!(mask, &*objects.geometry(0).tree().unwrap().leaves());
        }
    }

    /// The frustum test drops nothing that has a fragment in the picture.
    #[test]
    fn what_is_left_out_is_outside(
        x in -60.0..60.0_f64, y in -60.0..60.0_f64, z in -60.0..60.0_f64, ortho in any::<bool>(),
    ) {
        let objects = scene(50, &[Some(1.0)], &[(0, at(20.0, 1.5, DVec3::new(x, y, z)))]);
        let lens = if ortho { Lens::Orthographic(20.0) } else { Lens::FieldOfView(50.0) };
        let camera = camera(DVec3::new(1.0, 2.0, 20.0), DVec3::ZERO, lens);
        let seen = objects.seen_from(&camera, &Exec::sequential()).unwrap();
        let Sphere { center, radius } = objects.sphere(0);
        // Points of the sphere, projected.
        let mut inside = false;
        for i in 0..2000_u32 {
            let direction = rotation(DVec3::Y, f64::from(i) * 137.508)
                * rotation(DVec3::X, f64::from(i) * 0.09)
                * DVec3::Z;
            let p = camera.view_from_world.as_dmat4().transform_point3(center + direction * radius);
            let w = if ortho { 1.0 } else { -p.z };
            let column = f64::from(camera.cx) + f64::from(camera.fx) * p.x / w;
            let row = f64::from(camera.cy) - f64::from(camera.fy) * p.y / w;
            inside |= -p.z > f64::from(camera.near)
                && (0.0..64.0).contains(&column)
                && (0.0..48.0).contains(&row);
        }
        prop_assert!(!inside || seen.drawn_total() > 0);
        // Far outside, nothing is drawn.
        let p = camera.view_from_world.as_dmat4().transform_point3(center);
        if -p.z < -radius {
            prop_assert_eq!((seen.drawn_total(), seen.ids().count(0)), (0, 0));
        }
    }
}

#[test]
fn the_unit_of_epsilon_is_the_median_of_what_is_drawn() {
    let near = at(0.0, 1.0, DVec3::ZERO);
    let far = at(70.0, 2.0, DVec3::new(1.0, 0.0, -90.0));
    for (thresholds, second) in [(vec![Some(1.5)], 0), (vec![Some(1.5), None], 1)] {
        let objects = scene(3000, &thresholds, &[(0, near), (second, far)]);
        let eye = DVec3::new(0.0, 0.5, 9.0);
        let camera = camera(eye, DVec3::ZERO, Lens::FieldOfView(40.0));
        let seen = objects.seen_from(&camera, &Exec::new(3, 32).unwrap()).unwrap();
        let by_object = radii(&seen);
        assert!(by_object[0].len() > 4 * by_object[1].len() || second == 1, "a level for each");
        let mut all = by_object.concat();
        all.sort_by(f32::total_cmp);
        assert_eq!(seen.median_radius(), all[(all.len() - 1) / 2]);
        assert_eq!(seen.drawn_total(), all.len() as u64);
        assert_eq!(seen.drawn_ids().len(), all.len());
        assert!(seen.drawn_ids().is_sorted());
        let (flat, _) = seen.flattened(&Exec::sequential()).unwrap();
        assert_eq!((flat.radius().len(), flat.median_radius()), (all.len(), seen.median_radius()));
        assert_eq!(flat.radius()[..by_object[0].len()], by_object[0]);
    }
}

#[test]
fn without_a_camera_the_surfels_are_drawn() {
    let place = at(33.0, 0.5, DVec3::X);
    let [with, without] = [Some(2.0), None].map(|detail| scene(500, &[detail], &[(0, place)]));
    let exec = Exec::sequential();
    let [a, b] = [&with, &without].map(|objects| objects.flattened(&exec).unwrap().0);
    assert_eq!(with.drawn_total(), 500);
    assert_eq!(a.median_radius(), b.median_radius());
    assert_eq!(with.bounding_sphere(), without.bounding_sphere());
    let sorted = |surfels: &Surfels| -> Vec<[u32; 3]> {
        let mut all: Vec<_> =
            surfels.position().iter().map(|p| p.to_array().map(f32::to_bits)).collect();
        all.sort_unstable();
        all
    };
    assert_eq!(sorted(&a), sorted(&b));
}

#[test]
fn what_cannot_have_levels_says_why() {
    let plain = |surfels| Geometry {
        name: "ball".into(),
        surfels,
        primitives: Primitives::default(),
        detail: None,
    };
    let exec = Exec::sequential();
    let words = |geometry: Geometry, threshold| {
        geometry.with_detail(threshold, &exec).unwrap_err().to_string()
    };
    let ball = || plain(Shape::Sphere.surfels(10, 0).unwrap());
    for threshold in [-1.0, f64::NAN, 5000.0] {
        assert!(words(ball(), threshold).ends_with("pixels; give 0 to 4096"));
    }
    assert_eq!(words(plain(Surfels::none()), 1.0), "ball has no surfels for levels of detail");
    let twice = ball().with_detail(1.0, &exec).unwrap();
    assert_eq!(words(twice, 1.0), "ball has already levels of detail");
}
