use super::*;
use crate::number::Real;
use crate::number::elementary::{cos, sin};
use crate::scene::objects::{Geometry, Motion, Object, Objects};
use crate::scene::{Similarity, Triangles, Vertices};
use glam::DMat3;
use proptest::prelude::*;
use std::f64::consts::PI;

fn quiet(_: &str, _: u64, _: u64) {}

/// Triangles with the normals of their planes; each has its own corners.
fn soup(corners: &[[Vec3; 3]]) -> Scene {
    let normal = |[a, b, c]: &[Vec3; 3]| [(*b - *a).cross(*c - *a).normalize(); 3];
    let position: Vec<Vec3> = corners.iter().flatten().copied().collect();
    let vertices = Vertices {
        direction: corners.iter().flat_map(normal).collect(),
        radius: vec![0.0; position.len()],
        color: None,
        position,
        ..Vertices::default()
    };
    let indices = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let (triangles, dropped) = Triangles::new(vertices, indices).unwrap();
    assert_eq!(dropped, 0);
    let primitives = Primitives { triangles, ..Primitives::default() };
    Scene { primitives, ..Scene::unlit("soup", Surfels::none()) }
}

/// A box around the origin, with two triangles for each face.
fn boxed(half: Vec3) -> Scene {
    let mut all = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let corner = |u: f32, v: f32| {
                let mut at = Vec3::ZERO;
                (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (side, side * u, v);
                at * half
            };
            let [a, b, c, d] =
                [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
            all.extend([[a, b, c], [a, c, d]]);
        }
    }
    soup(&all)
}

fn found(scene: &Scene, directions: &Directions, side: u32) -> Result<Candidates> {
    candidates(scene, directions, side, &Exec::sequential(), &quiet)
}

/// The eight directions of the page, written out.
const CUBE: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
];

/// The first hit of a ray: its distance, the triangle's normal, and the lesser of the distances to
/// an edge and to the second hit.
fn cast(soup: &[[Vec3; 3]], from: DVec3, along: DVec3) -> Option<(f64, DVec3, f64)> {
    let mut hits = Vec::new();
    let mut clear = f64::INFINITY;
    for corners in soup {
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let normal = (b - a).cross(c - a);
        let facing = normal.dot(along);
        let t = normal.dot(a - from) / facing;
        let p = from + along * t;
        let inside = [(a, b), (b, c), (c, a)].map(|(a, b)| {
            // The distance from the edge as seen along the ray.
            let side = (b - a).cross(along).normalize();
            (p - a).dot(side) * -facing.signum()
        });
        let least = inside.into_iter().fold(f64::INFINITY, Real::at_most);
        clear = clear.at_most(least.abs());
        if least > 0.0 {
            hits.push((t, normal.normalize()));
        }
    }
    hits.sort_by(|a, b| a.0.total_cmp(&b.0));
    if let [first, second, ..] = hits[..] {
        clear = clear.at_most(second.0 - first.0);
    }
    let &(t, normal) = hits.first()?;
    Some((t, normal, clear))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Draws the pictures again with a ray through each pixel, from the page: no camera, no
    /// rasterizer.
    #[test]
    fn candidates_are_what_rays_meet(
        corners in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(-1.0_f32..1.0)), 1..9),
        scale in prop::sample::select(vec![1e-3_f32, 1.0, 300.0]),
        side in 9_u32..33,
    ) {
        let corners: Vec<[Vec3; 3]> = corners
            .iter()
            .map(|corners| corners.map(|p| Vec3::from_array(p) * scale))
            .filter(|[a, b, c]| (*b - *a).cross(*c - *a).length() > 0.01 * scale * scale)
            .collect();
        prop_assume!(!corners.is_empty());
        let all = || corners.iter().flatten();
        let low = all().fold(Vec3::splat(9e9), |a, b| a.min(*b)).as_dvec3();
        let high = all().fold(Vec3::splat(-9e9), |a, b| a.max(*b)).as_dvec3();
        let (center, radius) = ((low + high) / 2.0, (high - low).length() / 2.0);
        let pixel = 2.0 * radius / f64::from(side);
        let Ok(found) = found(&soup(&corners), &Directions::Cube, side) else { return Ok(()) };
        prop_assert!((found.pixel - pixel).abs() < 1e-6 * pixel);
        let mut next = 0;
        let mut compared = 0;
        for (count, direction) in found.counts.iter().zip(CUBE) {
            let back = DVec3::from_array(direction).normalize();
            let right = DVec3::Y.cross(back).normalize();
            let up = back.cross(right);
            let last = next + *count as usize;
            for i in 0..side * side {
                let (x, y) = (f64::from(i % side) + 0.5, f64::from(i / side) + 0.5);
                let middle = f64::from(side) / 2.0;
                let from = center + right * ((x - middle) * pixel) + up * ((middle - y) * pixel)
                    + back * (3.0 * radius);
                let hit = cast(&corners, from, -back);
                let own = (next < last).then(|| found.cloud.position[next].as_dvec3());
                let of_pixel = |p: &DVec3| {
                    let d = *p - from;
                    d.dot(right).abs() < 0.1 * pixel && d.dot(up).abs() < 0.1 * pixel
                };
                let own = own.filter(of_pixel);
                // Corners are snapped to 1/256 px.
                let clear = hit.is_none_or(|(_, _, clear)| clear > 0.02 * pixel);
                if clear && hit.is_some() {
                    let (t, normal, _) = hit.unwrap();
                    let Some(own) = own else {
                        return Err(TestCaseError::fail(format!("pixel {i} has no candidate")));
                    };
                    let steep = normal.dot(back).abs();
                    let near = (own - (from - back * t)).length();
                    prop_assert!(near < pixel * (0.02 / steep + 0.02) + 1e-5 * radius, "{near}");
                    let off = (own - (from - back * t)).dot(normal).abs();
                    prop_assert!(off < 1e-5 * radius, "{off} from the triangle");
                    let facing = normal * normal.dot(back).signum();
                    let given = found.cloud.normal.as_ref().unwrap()[next].as_dvec3();
                    prop_assert!((facing - given).length() < 1e-5);
                    compared += 1;
                }
                next += usize::from(own.is_some());
            }
            prop_assert_eq!(next, last, "every candidate belongs to a pixel, in their order");
        }
        let all = found.cloud.position.len();
        prop_assert!(2 * compared > all || all < 200, "{compared} of {all}");
    }
}

#[test]
fn a_flat_mesh_has_candidates_from_the_cube_and_none_from_its_box() {
    let plate = soup(&[
        [Vec3::new(-1.0, -1.0, 0.5), Vec3::new(1.0, -1.0, 0.5), Vec3::new(1.0, 1.0, 0.5)],
        [Vec3::new(-1.0, -1.0, 0.5), Vec3::new(1.0, 1.0, 0.5), Vec3::new(-1.0, 1.0, 0.5)],
    ]);
    let cube = found(&plate, &Directions::Cube, 64).unwrap();
    // The area that a direction sees, 4 / sqrt 3, in pixels of (2 sqrt 2 / 64)^2.
    let expected = 4.0 / 3.0_f64.sqrt() / (8.0 / 4096.0);
    for count in cube.counts {
        assert!((f64::from(count) - expected).abs() < 40.0, "{count} of {expected}");
    }
    let error = found(&plate, &Directions::Box, 64).unwrap_err().to_string();
    assert!(error.starts_with("no triangle covers the centre of a pixel"), "{error}");
}

/// Checks the numbers of candidates that `Decided:` gives for the faces of a bar.
#[test]
fn a_bar_is_seen_evenly_from_the_cube_and_at_its_ends_from_its_box() {
    let bar = boxed(Vec3::new(10.0, 1.0, 1.0));
    let share = |directions: &Directions| {
        let found = found(&bar, directions, 512).unwrap();
        let ends = found.cloud.normal.unwrap().iter().filter(|n| n.x.abs() > 0.5).count();
        let sides = found.cloud.position.len() - ends;
        // Two ends of 4 each, four sides of 40.
        (ends as f64 / 8.0) / (sides as f64 / 160.0)
    };
    // What a face shows of its area is the cosine: 1 / sqrt 3 for all, or 10 to 1.
    let (cube, own) = (share(&Directions::Cube), share(&Directions::Box));
    assert!((cube - 1.0).abs() < 0.03, "{cube}");
    assert!((own - 10.0).abs() < 0.3, "{own}");
}

#[test]
fn a_sphere_is_covered_to_a_few_pixels() {
    // 80 by 40 quads of latitude and longitude.
    let at = |i: u32, j: u32| {
        let (longitude, latitude) = (f64::from(i) * 0.078_539_816, f64::from(j) * 0.078_539_816);
        let ring = sin(latitude);
        DVec3::new(ring * cos(longitude), cos(latitude), ring * sin(longitude)).as_vec3()
    };
    let mut all = Vec::new();
    for i in 0..80 {
        for j in 0..40 {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            all.extend(
                [[a, c, b], [a, d, c]]
                    .into_iter()
                    .filter(|[a, b, c]| (*b - *a).cross(*c - *a).length() > 1e-6),
            );
        }
    }
    let found = found(&soup(&all), &Directions::Cube, 96).unwrap();
    let of_pixels = |count: &u32| f64::from(*count) * found.pixel * found.pixel;
    for area in found.counts.iter().map(of_pixels) {
        // The circle pi, minus the sagitta of the facets, plus or minus half a pixel of its
        // outline.
        assert!((area - PI).abs() < 0.06, "{area}");
    }
    // No direction is farther than 54.7 degrees from one of the cube's directions, so a pixel is at
    // most 1 / cos = sqrt 3 long there.
    for vertex in all.iter().flatten() {
        let nearest = found.cloud.position.iter().map(|p| (*p - *vertex).length_squared());
        let nearest = f64::from(nearest.fold(f32::INFINITY, Real::at_most)).sqrt();
        assert!(nearest < 1.5 * found.pixel, "{nearest} of {}", found.pixel);
    }
}

#[test]
fn objects_are_seen_in_their_places() {
    // Turned by a right angle and twice as large, all of it exact.
    let corners = [Vec3::ZERO, Vec3::new(1.0, 0.0, 0.5), Vec3::new(0.0, 1.0, 0.25)];
    let moved = |p: Vec3| 2.0 * Vec3::new(-p.y, p.x, p.z) + Vec3::new(0.0, 3.0, 0.0);
    let place = Similarity {
        rotation: DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z),
        scale: 2.0,
        translation: DVec3::new(0.0, 3.0, 0.0),
    };
    let Scene { surfels, primitives, .. } = soup(&[corners]);
    let geometry = Geometry { name: "one".into(), surfels, primitives, detail: None };
    let object = |name: &str, place| Object {
        name: name.into(),
        geometry: 0,
        motion: Motion::still(place),
        color: None,
    };
    let objects = vec![object("here", Similarity::IDENTITY), object("there", place)];
    let objects = Objects::new(vec![geometry], objects, Vec3::ONE).unwrap();
    let scene = Scene { objects: Some(objects), ..Scene::unlit("two", Surfels::none()) };
    let both = found(&soup(&[corners, corners.map(moved)]), &Directions::Cube, 40).unwrap();
    assert!(both.cloud.position.len() > 100);
    assert_eq!(found(&scene, &Directions::Cube, 40).unwrap(), both);
}

#[test]
fn threads_and_tiles_change_nothing() {
    let scene = boxed(Vec3::new(1.0, 0.5, 2.0));
    let alone = found(&scene, &Directions::Cube, 50).unwrap();
    for (threads, tile) in [(2, 8), (3, 64)] {
        let exec = Exec::new(threads, tile).unwrap();
        assert_eq!(candidates(&scene, &Directions::Cube, 50, &exec, &quiet).unwrap(), alone);
    }
}

#[test]
fn what_cannot_be_sampled_is_refused() {
    let none = Scene::unlit("none", Surfels::none());
    let error = found(&none, &Directions::Cube, 8).unwrap_err().to_string();
    assert_eq!(error, "there are no triangles to sample");
    let scene = boxed(Vec3::ONE);
    let bad = Directions::These(vec![DVec3::X, DVec3::ZERO]);
    let error = found(&scene, &bad, 8).unwrap_err().to_string();
    assert_eq!(error, "the direction 0, 0, 0 must be finite and not 0");
    assert!(found(&scene, &Directions::These(vec![]), 8).is_err());
    assert!(found(&scene, &Directions::Cube, 0).is_err());
}
