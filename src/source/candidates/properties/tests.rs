use super::*;
use crate::frame::Exec;
use crate::source::candidates::{Candidates, Directions, of_cloud};
use crate::source::derive::Derived;
use glam::{DVec3, Vec3};

fn quiet(_: &str, _: u64, _: u64) {}

fn property(name: &str, values: Vec<f32>) -> Property {
    Property { name: name.into(), values }
}

/// A plate of n x n points in the plane z = x / 2. Its numbers are affine in x and y, and its
/// colours have the same formula. One point before all others is nowhere.
fn plate(n: u32, number: [fn(f32, f32) -> f32; 2]) -> Cloud {
    let at = |i: u32| {
        let (x, y) = ((i % n) as f32 / (n - 1) as f32, (i / n) as f32 / (n - 1) as f32);
        Vec3::new(x, y, x / 2.0)
    };
    let nowhere = [Vec3::splat(f32::NAN)];
    let position: Vec<Vec3> = nowhere.into_iter().chain((0..n * n).map(at)).collect();
    let values = |of: fn(f32, f32) -> f32| {
        position.iter().map(move |p| if p.is_nan() { 0.5 } else { of(p.x, p.y) })
    };
    let corner = |x: u32, y: u32| 1 + y * n + x;
    let cells = (0..(n - 1) * (n - 1)).map(|i| (i % (n - 1), i / (n - 1)));
    let triangles = cells.flat_map(|(x, y)| {
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    Cloud {
        opacity: Some(values(number[0]).collect()),
        color: Some(values(number[1]).map(Vec3::splat).collect()),
        properties: vec![
            property("gloss", values(number[1]).collect()),
            property(
                "height",
                position.iter().map(|p| if p.is_nan() { 0.0 } else { -p.z }).collect(),
            ),
        ],
        triangles: triangles.collect(),
        position,
        ..Cloud::default()
    }
}

fn found(cloud: Cloud) -> (Candidates, Derived) {
    let directions = Directions::These(vec![DVec3::Z, DVec3::new(1.0, 2.0, -3.0)]);
    of_cloud(cloud, &directions, 40, &Exec::sequential(), &quiet).unwrap()
}

/// A number that is affine over a mesh is affine between its points, whatever the triangles: no
/// weights, no rasterizer.
#[test]
fn affine_numbers_are_those_of_the_place() {
    let number: [fn(f32, f32) -> f32; 2] = [|x, y| 0.25 + 0.5 * x - 0.125 * y, |x, y| 3.0 * y + x];
    let mesh = plate(6, number);
    let (candidates, derived) = found(mesh.clone());
    assert_eq!((candidates.dropped, derived.dropped_primitives), (0, 0));
    let Cloud { position, opacity, color, properties, .. } = &candidates.cloud;
    let (opacity, color) = (opacity.as_ref().unwrap(), color.as_ref().unwrap());
    assert!(position.len() > 500 && opacity.len() == position.len());
    let names: Vec<_> = properties.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(names, ["gloss", "height"]);
    for (i, p) in position.iter().enumerate() {
        assert!((opacity[i] - number[0](p.x, p.y)).abs() < 1e-6, "{} at {p}", opacity[i]);
        // The rasterizer interpolates colours by the same formula, to the bit.
        assert_eq!(properties[0].values[i].to_bits(), color[i].x.to_bits());
        assert!((properties[1].values[i] + p.z).abs() < 1e-6);
    }
    let threads = Exec::new(3, 16).unwrap();
    let directions = Directions::These(vec![DVec3::Z, DVec3::new(1.0, 2.0, -3.0)]);
    assert_eq!(of_cloud(mesh.clone(), &directions, 40, &threads, &quiet).unwrap().0, candidates);
    // The same points as without, because numbers do not affect what is seen.
    let bare = found(Cloud { opacity: None, properties: vec![], ..mesh }).0;
    assert!(bare.cloud.opacity.is_none() && bare.cloud.properties.is_empty());
    assert_eq!((&bare.cloud.position, &bare.cloud.color), (position, &candidates.cloud.color));
}

/// Weights may add up to more than 1.
#[test]
fn no_opacity_is_above_one() {
    let (candidates, _) = found(plate(9, [|_, _| 1.0, |_, _| 1.0]));
    let opacity = candidates.cloud.opacity.unwrap();
    assert!(opacity.iter().all(|&o| o <= 1.0 && o > 0.999_999));
    let color = candidates.cloud.color.unwrap();
    assert!(color.iter().any(|c| c.x > 1.0), "as colours show: the test tests something");
}

#[test]
fn a_corner_that_cannot_be_takes_its_triangles_with_it() {
    let flat: [fn(f32, f32) -> f32; 2] = [|_, _| 0.5, |_, _| 0.0];
    for wrong in [-0.125, 1.25, f32::NAN, f32::INFINITY] {
        // The middle of 3 x 3 points has 6 of the 8 triangles.
        let mut mesh = plate(3, flat);
        mesh.opacity.as_mut().unwrap()[5] = wrong;
        let (candidates, derived) = found(mesh.clone());
        assert_eq!(derived.dropped_primitives, 6, "{wrong}");
        let distance = |p: &Vec3| (p.x - p.y).abs();
        assert!(
            candidates.cloud.position.iter().all(|p| distance(p) > 0.49),
            "two corners are left"
        );
        mesh.opacity = Some(vec![wrong; 10]);
        let error = of_cloud(mesh, &Directions::Cube, 8, &Exec::sequential(), &quiet).unwrap_err();
        let what = "the scene is empty: none of its 8 triangles has corners with an opacity in [0, 1] and finite \
                    properties";
        assert_eq!(error.to_string(), what);
    }
    let mut mesh = plate(3, flat);
    mesh.properties[1].values[5] = f32::NAN;
    assert_eq!(found(mesh).1.dropped_primitives, 6);
    let mut mesh = plate(3, flat);
    mesh.properties[1].values.pop();
    let error = of_cloud(mesh, &Directions::Cube, 8, &Exec::sequential(), &quiet).unwrap_err();
    assert_eq!(error.to_string(), "10 positions, but 9 of height");
}
