//! Prefixes, their budget, their zones, and finer objects.

use super::*;
use crate::scene::Stereo;
use crate::scene::camera::stereo;
use crate::scene::objects::detail::prefix::Estimate;
use crate::scene::objects::detail::refine::Refinement;
use crate::scene::{Cloud, Triangles, Vertices};

/// A wall of n x n points, a unit apart, around the origin. The rows are in order: that is no good
/// order, but its estimate is known.
fn wall(n: usize) -> Surfels {
    let at = |i: usize| i as f32 - (n - 1) as f32 / 2.0;
    let position: Vec<Vec3> = (0..n * n).map(|i| Vec3::new(at(i % n), at(i / n), 0.0)).collect();
    let cloud = Cloud {
        normal: Some(vec![Vec3::Z; position.len()]),
        radius: Some(vec![1.0; position.len()]),
        position,
        ..Cloud::default()
    };
    Surfels::new(cloud).unwrap().0
}

fn in_order(n: usize, primitives: Primitives) -> Geometry {
    let plain = Geometry { name: "wall".into(), surfels: wall(n), primitives, detail: None };
    let count = (n * n) as u32;
    plain.with_prefix(Estimate { count, distance: 1.0 }).unwrap()
}

/// Walls in places, some of them finer ones of others.
fn walls(of: &[(usize, Similarity)], coarser: Vec<Option<u32>>) -> Objects {
    let geometries = of.iter().map(|&(n, _)| in_order(n, Primitives::default())).collect();
    let objects = (0..).zip(of).map(|(geometry, &(_, place))| Object {
        name: "one".into(),
        geometry,
        motion: Motion::still(place),
        color: None,
    });
    let all = Objects::new(geometries, objects.collect(), Vec3::ONE).unwrap();
    all.with_coarser(coarser).unwrap()
}

fn asks(surfel_size: f32) -> Refinement {
    Refinement { surfel_size, ..Refinement::default() }
}

fn seen(objects: &Objects, asked: Refinement, camera: &Camera) -> Objects {
    let objects = objects.clone().with_refinement(asked).unwrap();
    objects.seen_from(camera, &Exec::sequential()).unwrap()
}

/// From the front, 64 pixels per unit at the distance 1.
fn front(away: f64) -> Camera {
    camera(DVec3::new(0.0, 0.0, away), DVec3::ZERO, Lens::Focal(64.0))
}

fn counts(objects: &Objects) -> Vec<u32> {
    (0..objects.objects().len() as u32).map(|object| objects.ids().count(object)).collect()
}

proptest! {
    /// In the world: two neighbouring pixels, projected onto the plane through the closest point.
    #[test]
    fn discs_are_as_wide_as_asked_where_the_object_is_nearest(
        degrees in 0.0..360.0_f64, scale in 0.25..4.0_f64, size in 0.25..8.0_f32,
        away in 12.0..400.0_f64, ortho in any::<bool>(),
    ) {
        let place = at(degrees, scale, DVec3::new(0.5, -0.25, 1.0));
        let target = place.translation;
        let lens = if ortho { Lens::Orthographic(30.0 * scale) } else { Lens::FieldOfView(40.0) };
        let camera = camera(target + DVec3::new(0.2, 0.3, 1.0).normalize() * (away * scale), target, lens);
        let found = seen(&walls(&[(11, place)], vec![None]), asks(size), &camera);
        // The point of the wall that is the closest to the eye, found by trying many.
        let mut closest = (f64::INFINITY, 0.0);
        for i in 0..=400 {
            for j in 0..=400 {
                let at = |i: i32| f64::from(i) / 40.0 - 5.0;
                let p = place.rotation * (DVec3::new(at(i), at(j), 0.0) * scale) + target;
                let view = camera.view_from_world.as_dmat4().transform_point3(p);
                if view.length() < closest.0 {
                    closest = (view.length(), -view.z);
                }
            }
        }
        let pixel = if ortho { 1.0 } else { closest.1 } / f64::from(camera.fy) / scale;
        let asked = f64::from(size) * pixel / 2.0;
        let wanted = 121.0 / (asked * asked);
        let disc = found.disc(0).unwrap();
        let (radius, side) = (f64::from(disc.radius) / scale, f64::from(disc.side));
        let count = f64::from(found.ids().count(0));
        if wanted > 121.0 * (1.0 + 1e-3) {
            // All of them, as large as their distance.
            prop_assert_eq!(count, 121.0);
            prop_assert!((radius - 1.0).abs() < 1e-6 && (side / f64::from(size) * asked - 1.0).abs() < 1e-3);
        } else if wanted < 121.0 * (1.0 - 1e-3) {
            prop_assert!((radius / asked - 1.0).abs() < 1e-3, "{radius} {asked}");
            prop_assert_eq!(disc.side, size);
            prop_assert!((wanted * 0.998..=wanted * 1.002 + 1.0).contains(&count), "{count} {wanted}");
        }
        // The placed surfels have that radius, and are the first ones.
        let (flat, _) = found.flattened(&Exec::sequential()).unwrap();
        prop_assert_eq!(flat.len(), found.ids().count(0) as usize);
        prop_assert!(flat.radius().iter().all(|r| (f64::from(*r) / (radius * scale) - 1.0).abs() < 1e-6));
        prop_assert_eq!(found.sides().unwrap().unwrap().side(0), Some(disc.side));
        prop_assert_eq!(found.median_radius(), flat.radius()[0]);
    }

    #[test]
    fn a_budget_is_kept_and_used(
        away in 30.0..90.0_f64, second in 30.0..300.0_f64, budget in 1_u32..900, size in 0.5..4.0_f32,
    ) {
        let two = [(20, at(0.0, 1.0, DVec3::ZERO)), (20, at(0.0, 1.0, DVec3::new(0.0, 0.0, -second)))];
        let (objects, camera) = (walls(&two, vec![None, None]), front(away));
        let free = seen(&objects, asks(size), &camera);
        let kept = seen(&objects, Refinement { budget: Some(budget), ..asks(size) }, &camera);
        prop_assert!(kept.drawn_total() <= u64::from(budget));
        if free.drawn_total() <= u64::from(budget) {
            prop_assert_eq!(counts(&free), counts(&kept));
        } else if budget >= 2 {
            // Each object has as many as a common, larger size gives; one step less would give too
            // many.
            prop_assert!(kept.drawn_total() as f64 >= f64::from(budget) * 0.969 - 2.0);
            let [a, b] = [0, 1].map(|object| kept.disc(object).unwrap());
            prop_assert!(a.side >= size && a.radius <= b.radius);
            let larger = seen(&objects, asks(a.side.at_least(b.side)), &camera);
            prop_assert!(larger.drawn_total() <= kept.drawn_total());
        } else {
            prop_assert_eq!(counts(&kept), [1, 0]);
        }
    }

    /// From far away to close by, an object gives way to two finer ones.
    #[test]
    fn finer_objects_fade_in_as_theirs_fades_out(away in 4.0..400.0_f64) {
        let place = at(0.0, 1.0, DVec3::ZERO);
        // Each finer object shows half of the surface, twice as densely.
        let half = at(0.0, 0.5, DVec3::ZERO);
        let three = walls(&[(32, place), (32, half), (32, half)], vec![None, Some(0), Some(0)]);
        let found = seen(&three, asks(2.0), &front(away));
        let wanted = 1024.0 * (64.0 / away) * (64.0 / away);
        let [coarse, a, b]: [u32; 3] = counts(&found).try_into().unwrap();
        prop_assert_eq!(a, b);
        let [coarse, finer] = [coarse, a + b].map(f64::from);
        if wanted <= 1024.0 {
            prop_assert_eq!([coarse, finer], [wanted.ceil(), 0.0]);
        } else if wanted < 1331.1 {
            let fade = (wanted / 1024.0 - 1.0) / 0.3;
            let [own, other] = [1.0 - fade, fade].map(|share| (2.0 * share).at_most(1.0));
            prop_assert!((coarse - own * 1024.0).abs() < 1.001);
            // Half the size of the geometry: a quarter of the surfels for the same discs, in two
            // objects.
            prop_assert!((finer - 2.0 * (other * wanted / 4.0).at_most(1024.0)).abs() < 2.002, "{finer}");
        } else if wanted > 1331.3 {
            prop_assert_eq!(coarse, 0.0);
        }
    }
}

#[test]
fn surfaces_themselves_are_drawn_close_by() {
    let corners = [Vec3::new(-5.0, -5.0, 0.0), Vec3::new(5.0, -5.0, 0.0), Vec3::new(0.0, 5.0, 0.0)];
    let vertices = Vertices {
        position: corners.to_vec(),
        direction: vec![Vec3::Z; 3],
        radius: vec![0.0; 3],
        color: None,
        ..Vertices::default()
    };
    let (triangles, _) = Triangles::new(vertices, vec![[0, 1, 2]]).unwrap();
    let primitives = Primitives { triangles, ..Primitives::default() };
    let object = Object {
        name: "one".into(),
        geometry: 0,
        motion: Motion::still(at(0.0, 1.0, DVec3::ZERO)),
        color: None,
    };
    let objects = Objects::new(vec![in_order(10, primitives)], vec![object], Vec3::ONE).unwrap();
    // 100 (64 / away)^2 surfels of the size 2 are asked for: 100 at 64, 130 at 56.1.
    let shown_from = |camera: &Camera| {
        let found = seen(&objects, asks(2.0), camera);
        let triangles = found.primitives().unwrap().iter().map(Primitives::len).sum::<usize>();
        (found.ids().count(0), triangles)
    };
    let shown = |away: f64| shown_from(&front(away));
    assert_eq!(shown(128.0), (25, 0));
    assert_eq!(shown(64.5), (99, 0));
    assert_eq!(shown(62.0), (100, 1), "all that there are, of 106.6 that are asked for");
    assert_eq!(shown(58.0), (55, 1), "where the fade is 0.7253");
    assert_eq!(shown(56.0), (0, 1));
    let behind = camera(DVec3::Z * 20.0, DVec3::Z * 40.0, Lens::Focal(64.0));
    assert_eq!(shown_from(&behind), (0, 0));
}

#[test]
fn sizes_are_interpolated_between_zones() {
    let zones = vec![[100.0, 1.0], [200.0, 3.0], [200.0, 4.0], [300.0, 4.5]];
    let asked = Refinement { zones, ..asks(2.0) };
    let found = [0.0, 100.0, 150.0, 199.0, 200.0, 250.0, 300.0, 9e9].map(|d| asked.factor(d));
    assert_eq!(found, [1.0, 1.0, 2.0, 2.98, 4.0, 4.25, 4.5, 4.5]);
    assert_eq!(asks(2.0).factor(7.0), 1.0);
    // A wall in the middle, one beside it, 128 pixels off with a sphere of 9.5 sqrt 2 + 1 units = 1.8 pixels.
    let side = at(0.0, 1.0, DVec3::new(1000.0, 0.0, 0.0));
    let two = walls(&[(20, at(0.0, 1.0, DVec3::ZERO)), (20, side)], vec![None, None]);
    let zones = vec![[26.0, 1.0], [226.0, 3.0]];
    let wide = Camera { width: 640, cx: 320.0, ..front(500.0) };
    let found = seen(&two, Refinement { zones, ..asks(1.0) }, &wide);
    let [middle, beside] = [0, 1].map(|object| f64::from(found.disc(object).unwrap().side));
    let expected =
        1.0 + 2.0 * ((128.0 - 64.0 * (9.5 * 2.0_f64.sqrt() + 1.0) / 500.0) - 26.0) / 200.0;
    assert_eq!(middle, 1.0);
    assert!((beside - expected).abs() < 1e-4, "{beside} {expected}");
}

#[test]
fn what_is_no_order_or_no_forest_says_why() {
    let ball = |detail| Geometry {
        name: "ball".into(),
        surfels: wall(2),
        primitives: Primitives::default(),
        detail,
    };
    let plain = || ball(None);
    for (count, distance) in [(0, 1.0), (5, 1.0), (2, f32::NAN), (2, -1.0), (2, f32::INFINITY)] {
        let words = plain().with_prefix(Estimate { count, distance }).unwrap_err().to_string();
        assert_eq!(
            words,
            format!("ball: {count} of 4 surfels, {distance} apart, define no density")
        );
    }
    let twice = in_order(2, Primitives::default()).with_detail(1.0, &Exec::sequential());
    assert_eq!(twice.unwrap_err().to_string(), "wall has already levels of detail");
    let place = at(0.0, 1.0, DVec3::ZERO);
    let all = walls(&[(2, place), (2, place)], vec![None, None]);
    let words =
        |coarser: Vec<Option<u32>>| all.clone().with_coarser(coarser).unwrap_err().to_string();
    assert_eq!(words(vec![None]), "1 finer objects, but there are 2");
    assert_eq!(words(vec![None, Some(2)]), "an object refines object 2, which does not exist");
    assert_eq!(words(vec![Some(1), Some(0)]), "objects refine themselves in a circle");
    let refused = [
        asks(0.0),
        asks(f32::NAN),
        asks(5000.0),
        Refinement { budget: Some(0), ..asks(1.0) },
        Refinement { zones: vec![[2.0, 1.0], [1.0, 1.0]], ..asks(1.0) },
        Refinement { zones: vec![[0.0, 0.0]], ..asks(1.0) },
        Refinement { zones: vec![[f32::NAN, 1.0]], ..asks(1.0) },
    ];
    for asked in refused {
        assert!(all.clone().with_refinement(asked.clone()).is_err(), "{asked:?}");
    }
    let [first, second] = [ball(None), in_order(2, Primitives::default())];
    let object = |geometry| Object {
        name: "one".into(),
        geometry,
        motion: Motion::still(place),
        color: None,
    };
    let plain = Objects::new(vec![first, second], vec![object(0), object(1)], Vec3::ONE).unwrap();
    let words = plain.with_coarser(vec![None, Some(0)]).unwrap_err().to_string();
    assert_eq!(words, "one has finer objects, but its surfels are not ordered");
}

#[test]
fn far_ends_of_numbers_stay_surfels() {
    for (scale, away) in [(1e-15, 1e3), (1e15, 1e30), (1e-10, 1e30), (1e10, 1.0)] {
        let objects = walls(&[(4, at(0.0, scale, DVec3::ZERO))], vec![None]);
        for asked in [asks(4096.0), asks(1e-30)] {
            let found = seen(&objects, asked, &front(away));
            let (flat, _) = found.flattened(&Exec::sequential()).unwrap();
            assert!(flat.radius().iter().all(|r| *r > 0.0 && r.is_finite()), "{scale} {away}");
            assert!(found.sides().unwrap().is_none_or(|sides| sides.side(0).is_some()));
        }
    }
}

/// Both eyes draw what the camera in the middle asks for, and what only one of them sees.
#[test]
fn the_eyes_of_a_pair_share_the_choice() {
    let middle = front(16.0);
    let eye = |eye| Stereo { distance: 4.0, eye: Some(eye) }.camera(middle).unwrap();
    let eyes = stereo::Eye::BOTH.map(eye);
    let place = |x: f64, z: f64| at(0.0, 1.0, DVec3::new(x, 0.0, z));
    // The last two are in the picture of one eye alone.
    let places = [place(0.5, 0.0), place(-3.0, 4.0), place(-16.0, 0.0), place(16.0, 0.0)];
    let objects = walls(&places.map(|place| (3, place)), vec![None; 4]);
    let asked = Refinement { zones: vec![[0.0, 1.0], [64.0, 2.0]], ..asks(3.0) };
    let [left, right] = eyes.map(|camera| seen(&objects, asked.clone(), &camera));
    assert_eq!(counts(&left), counts(&right));
    assert_eq!(left.median_radius().to_bits(), right.median_radius().to_bits());
    assert!((0..4).all(|object| left.disc(object) == right.disc(object)));
    assert!(counts(&left).iter().all(|count| *count > 0), "{:?}", counts(&left));

    let alone = eyes.map(|camera| Camera { other_eye: None, ..camera });
    let [left, right] = alone.map(|camera| counts(&seen(&objects, asked.clone(), &camera)));
    assert!(left[2] > 0 && left[3] == 0 && right[2] == 0 && right[3] > 0, "{left:?} {right:?}");
    // Without zones, what all see has the size that the middle asks for.
    let [left, alone] = [eyes[0], middle].map(|camera| seen(&objects, asks(3.0), &camera));
    assert_eq!(counts(&left)[..2], counts(&alone)[..2]);
    assert!((0..2).all(|object| left.disc(object) == alone.disc(object)));
}
