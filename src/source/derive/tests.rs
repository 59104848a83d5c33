//! Check derived normals and radii against shapes whose truth is known.

use super::*;
use crate::scene::Groups;
use proptest::prelude::*;

fn derive(cloud: Cloud) -> Result<(Surfels, Derived)> {
    surfels(cloud, &Derive::default(), &Exec::sequential(), &|_, _, _| ())
}

fn points(position: Vec<Vec3>) -> Cloud {
    Cloud { position, ..Cloud::default() }
}

/// A number in [0, 1) for each index: the fractional part of a multiple of an irrational number.
fn uniform(i: usize, irrational: f64) -> f64 {
    ((i + 1) as f64 * irrational).fract()
}

/// `n` points on the unit sphere, spread as evenly as a spiral does.
fn sphere(n: usize) -> Vec<Vec3> {
    let point = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / n as f64;
        let angle = std::f64::consts::TAU * uniform(i, 0.618_033_988_749_895);
        let radius = (1.0 - z * z).sqrt();
        Vec3::new((radius * libm::cos(angle)) as f32, (radius * libm::sin(angle)) as f32, z as f32)
    };
    (0..n).map(point).collect()
}

/// Points and outward normals of a torus around z, of radii 1 and 0.25.
fn torus(n: usize) -> (Vec<Vec3>, Vec<Vec3>) {
    let point = |i: usize| {
        let tau = std::f64::consts::TAU;
        // Two numbers that are independent over the rationals.
        let (u, v) = (tau * uniform(i, 2_f64.sqrt()), tau * uniform(i, 3_f64.sqrt()));
        let (cu, su, cv, sv) = (libm::cos(u), libm::sin(u), libm::cos(v), libm::sin(v));
        let normal = glam::DVec3::new(cv * cu, cv * su, sv);
        let center = glam::DVec3::new(cu, su, 0.0);
        ((center + 0.25 * normal).as_vec3(), normal.as_vec3())
    };
    (0..n).map(point).unzip()
}

#[test]
fn a_sphere_of_points_gets_its_normals_outwards_and_no_holes() {
    let position = sphere(5000);
    let (surfels, derived) = derive(points(position.clone())).unwrap();
    assert_eq!((derived.normals, derived.radii), (Origin::Neighbours, Origin::Neighbours));
    assert_eq!(derived.dropped.total(), 0);
    for (normal, truth) in surfels.normal().iter().zip(&position) {
        assert!(normal.dot(*truth) > 0.99, "{normal} instead of {truth}");
    }
    // Every direction meets a disc: its plane inside its radius.
    let discs: Vec<_> = (0..surfels.len())
        .map(|i| (surfels.position()[i], surfels.normal()[i], surfels.radius()[i]))
        .collect();
    for probe in sphere(3001) {
        let covers = |(p, n, r): &(Vec3, Vec3, f32)| {
            let hit = probe * (p.dot(*n) / probe.dot(*n));
            hit.dot(probe) > 0.0 && hit.distance(*p) <= *r
        };
        assert!(discs.iter().any(covers), "a hole at {probe}");
    }
}

#[test]
fn the_inside_of_a_torus_is_oriented_along_its_surface() {
    let (position, truth) = torus(6000);
    let (surfels, _) = derive(points(position)).unwrap();
    // Half of the inner side points towards the centroid, so only propagation gets it right.
    for (normal, truth) in surfels.normal().iter().zip(&truth) {
        assert!(normal.dot(*truth) > 0.9, "{normal} instead of {truth}");
    }
}

#[test]
fn each_part_is_oriented_by_itself() {
    let far = Vec3::new(0.0, 100.0, 0.0);
    let position: Vec<Vec3> =
        sphere(500).into_iter().chain(sphere(500).iter().map(|p| *p + far)).collect();
    let (surfels, _) = derive(points(position)).unwrap();
    for (normal, truth) in surfels.normal().iter().zip(sphere(500).iter().chain(&sphere(500))) {
        assert!(normal.dot(*truth) > 0.9, "{normal} instead of {truth}");
    }
}

#[test]
fn a_grid_gets_twice_its_spacing() {
    let position = (0..400).map(|i| Vec3::new((i % 20) as f32, (i / 20) as f32, 0.0)).collect();
    let (surfels, _) = derive(points(position)).unwrap();
    // Neighbours at 1, 1, 1, 1, sqrt 2 four times, 2, 2: the tenth is at 2.
    assert_eq!(surfels.radius()[10 * 20 + 10], 2.0);
    assert!(surfels.normal().iter().all(|&n| n == Vec3::Z), "a flat part faces the positive axis");
}

#[test]
fn points_at_one_place_share_what_is_derived() {
    let once = sphere(300);
    let many: Vec<Vec3> =
        once.iter().chain(&once).chain(&vec![once[0]; 100_000]).copied().collect();
    let (alone, _) = derive(points(once)).unwrap();
    let (together, derived) = derive(points(many)).unwrap();
    assert_eq!(derived.dropped.total(), 0, "a coincident neighbour is no radius of 0");
    assert_eq!(&together.radius()[..300], alone.radius());
    assert_eq!(&together.radius()[300..600], alone.radius());
    assert_eq!(&together.normal()[300..600], alone.normal());
    assert_eq!(together.normal()[100_599], alone.normal()[0]);
}

#[test]
fn a_mesh_uses_its_triangles() {
    let mut position = [0.0, 1.0, 3.0].map(|x| Vec3::new(x, x * x, 2.0)).to_vec();
    position.insert(1, Vec3::new(f32::NAN, 0.0, 0.0));
    position.push(Vec3::ZERO);
    let triangles = vec![[0, 2, 3], [0, 1, 2], [3, 2, 1]];
    let groups = Groups::new(vec![0, 1, 2, 3, 4], vec![(1, 0), (2, 1)], vec![1.0; 5]).ok();
    let (surfels, derived) = derive(Cloud { triangles, groups, ..points(position) }).unwrap();
    assert_eq!((derived.normals, derived.radii), (Origin::Triangles, Origin::Triangles));
    assert_eq!(derived.dropped, Dropped { position: 1, normal: 1, ..Dropped::default() });
    assert_eq!(surfels.normal(), [Vec3::Z; 3], "the triangles at the lost point went with it");
    assert_eq!(surfels.radius(), [90.0_f32.sqrt(); 3]);
    let groups = Groups::new(vec![0, 2, 3], vec![(1, 1)], vec![1.0; 5]).unwrap();
    assert_eq!(surfels.groups(), Some(&groups), "the lost point and the last without a triangle");
}

#[test]
fn tangents_say_normal_and_radius() {
    let tangents = Some(vec![[Vec3::new(0.0, 3.0, 0.0), Vec3::new(0.0, 0.0, 2.0)]]);
    let cloud = Cloud { tangents, ..points(vec![Vec3::ONE]) };
    let (surfels, derived) = derive(cloud).unwrap();
    assert_eq!((derived.normals, derived.radii), (Origin::Tangents, Origin::Tangents));
    assert_eq!((surfels.normal(), surfels.radius()), (&[Vec3::X][..], &[3.0][..]));
}

#[test]
fn a_radius_may_be_asked_for() {
    let single = Cloud { normal: Some(vec![Vec3::Z]), ..points(vec![Vec3::ONE]) };
    let ask = |radius| {
        surfels(
            single.clone(),
            &Derive { radius: Some(radius) },
            &Exec::sequential(),
            &|_, _, _| (),
        )
    };
    let (surfels, derived) = ask(0.5).unwrap();
    assert_eq!((surfels.radius(), derived.radii), (&[0.5][..], Origin::Given));
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(ask(bad).unwrap_err().to_string().contains("give a finite number > 0"));
    }
}

#[test]
fn what_cannot_be_derived_says_what_to_give() {
    let refused = |cloud| derive(cloud).unwrap_err().to_string();
    let flat = |n| Cloud { normal: Some(vec![Vec3::Z; n]), ..points(vec![Vec3::ONE; n]) };
    assert!(refused(flat(1)).contains("all points stand at one place; give a radius"));
    assert!(refused(flat(9)).contains("all points stand at one place; give a radius"));
    let two = [Vec3::ZERO, Vec3::ZERO, Vec3::ONE].to_vec();
    assert!(refused(points(two)).contains("they stand at 2 only; give nx, ny and nz"));
    assert!(refused(points(vec![])).contains("none of its 0 points has a finite position"));
    assert!(refused(points(vec![Vec3::NAN; 2])).contains("none of its 2 points"));
    let uneven = Cloud { color: Some(vec![]), ..points(vec![Vec3::ONE]) };
    assert_eq!(refused(uneven), "1 positions, but 0 colours");
    let outside = Cloud { triangles: vec![[0, 0, 0], [0, 1, 0]], ..points(vec![Vec3::ONE]) };
    assert!(refused(outside).contains("triangle 1 has a corner that is not one of the 1 points"));
}

#[test]
fn given_values_are_kept_and_degenerate_ones_counted() {
    let cloud = Cloud {
        normal: Some(vec![Vec3::Z, Vec3::ZERO, Vec3::X, Vec3::Y]),
        radius: Some(vec![1.0, 1.0, -1.0, 1.0]),
        ..points(vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::INFINITY])
    };
    let (surfels, derived) = derive(cloud).unwrap();
    assert_eq!((surfels.len(), derived.normals, derived.radii), (1, Origin::File, Origin::File));
    assert_eq!(derived.dropped, Dropped { position: 1, normal: 1, radius: 1, attribute: 0 });
}

proptest! {
    /// Any points give usable normals and radii, and the same ones with three threads.
    #[test]
    fn nothing_finite_is_lost(seed in prop::collection::vec((0_u8..6, -2.0_f32..2.0), 9..300)) {
        let value = |(kind, x): (u8, f32)| match kind {
            0 => 0.0,
            1 => x.trunc(),
            2 => x * 1e-38,
            3 => x * 1e37,
            _ => x,
        };
        let position: Vec<Vec3> = seed
            .chunks_exact(3)
            .map(|c| Vec3::new(value(c[0]), value(c[1]), value(c[2])))
            .collect();
        let n = position.len();
        let Ok((surfels, derived)) = derive(points(position.clone())) else {
            let all = position.iter().filter(|p| **p != position[0]).count();
            prop_assert!(all < n, "refused though the points differ");
            return Ok(());
        };
        prop_assert_eq!(derived.dropped.total(), 0);
        prop_assert_eq!(surfels.len(), n);
        let three = Exec::new(3, 8).unwrap();
        let (together, _) =
            super::surfels(points(position), &Derive::default(), &three, &|_, _, _| ()).unwrap();
        prop_assert_eq!(together, surfels);
    }
}

/// Programs without normals write zeros.
#[test]
fn normals_without_a_direction_are_derived_as_if_there_were_none() {
    let expected = derive(points(sphere(200))).unwrap();
    for none in [Vec3::ZERO, Vec3::NAN, Vec3::splat(f32::INFINITY)] {
        let mut cloud = points(sphere(200));
        cloud.normal = Some(vec![none; 200]);
        assert_eq!(derive(cloud.clone()).unwrap(), expected, "{none}");
        // With one normal in the file, the others are dropped and counted.
        cloud.normal.as_mut().unwrap()[7] = Vec3::Z;
        let (one, derived) = derive(cloud).unwrap();
        assert_eq!((one.normal(), derived.normals), (&[Vec3::Z][..], Origin::File));
        assert_eq!(derived.dropped.normal, 199);
    }
    let mesh = Cloud { triangles: vec![[0, 1, 2]], ..points(vec![Vec3::ZERO, Vec3::X, Vec3::Y]) };
    let zeros = Cloud { normal: Some(vec![Vec3::ZERO; 3]), ..mesh.clone() };
    let drawn = |cloud| polygons(cloud, &Exec::sequential(), &|_, _, _| ()).unwrap();
    assert_eq!(drawn(zeros), drawn(mesh));
}

#[test]
fn an_empty_scene_says_why() {
    let mut cloud = points(sphere(9));
    cloud.normal = Some(vec![Vec3::Z; 9]);
    cloud.radius = Some(vec![0.0; 9]);
    cloud.normal.as_mut().unwrap()[3] = Vec3::ZERO;
    let error = derive(cloud).unwrap_err().to_string();
    let what = "none of its 9 points can be a surfel: 1 without normal, 8 without radius; give \
                finite radii above 0";
    assert!(error.contains(what), "{error}");
}
