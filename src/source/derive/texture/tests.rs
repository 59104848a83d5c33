use super::super::{Derive, facets as of_facets, polygons, surfels};
use super::*;
use crate::frame::Plane;
use crate::number::random::unit;
use crate::scene::Texture;

fn quiet(_: &str, _: u64, _: u64) {}

/// A texture of 100 x 80 texels whose colour is their place: x, y and 0.
fn ramp() -> Texture {
    Texture::new(Plane::from_pixels([100, 80], |x, y| [x as f32 + 0.5, y as f32 + 0.5, 0.0]))
        .unwrap()
}

fn noise() -> Texture {
    let value = |x: u32, y: u32, c: u64| unit(c, u64::from(x) << 16 | u64::from(y));
    Texture::new(Plane::from_pixels([64, 48], |x, y| [0, 1, 2].map(|c| value(x, y, c)))).unwrap()
}

/// A flat grid of 8 x 8 squares of side 1 around the origin; (u, v) = (a x + b y + 1/2, c x + d y + 1/2).
fn grid([a, b, c, d]: [f32; 4]) -> Cloud {
    let places = (0..81).map(|i| Vec3::new((i % 9) as f32 - 4.0, (i / 9) as f32 - 4.0, 0.0));
    let position: Vec<Vec3> = places.collect();
    let squares = (0..64_u32).map(|i| i / 8 * 9 + i % 8);
    let at = |p: &Vec3| Vec2::new(a * p.x + b * p.y + 0.5, c * p.x + d * p.y + 0.5);
    Cloud {
        coordinates: Some(Coordinates::Points(position.iter().map(at).collect())),
        triangles: squares.flat_map(|i| [[i, i + 1, i + 10], [i, i + 10, i + 9]]).collect(),
        position,
        ..Cloud::default()
    }
}

fn painted(mut cloud: Cloud, texture: Texture, levels: usize) -> Cloud {
    cloud.paint = cloud.coordinates.as_ref().map(|all| Paint::new(texture, all, levels));
    cloud
}

/// The same coordinates, given for each corner.
fn by_corners(cloud: Cloud) -> Cloud {
    let all = cloud.coordinates.clone().unwrap();
    let corners = cloud.triangles.iter().enumerate().map(|(i, c)| all.corners(i, *c)).collect();
    Cloud { coordinates: Some(Coordinates::Corners(corners)), ..cloud }
}

/// An affine map J has one matrix everywhere, r r J J^T. A facet has the colour of its own ellipse.
#[test]
fn colours_are_means_within_the_outlines() {
    let exec = Exec::new(3, 16).unwrap();
    for map in [[0.05, 0.0, 0.0, 0.05], [0.04, 0.03, -0.01, 0.05], [-0.05, 0.02, 0.0, 0.03]] {
        let cloud = painted(grid(map), noise(), 3);
        let paint = cloud.paint.clone().unwrap();
        let [a, b, c, d] = map.map(f64::from);
        let options = Derive { radius: Some(0.75) };
        let (points, _) = surfels(cloud.clone(), &options, &exec, &quiet).unwrap();
        assert_eq!(
            surfels(by_corners(cloud.clone()), &options, &Exec::sequential(), &quiet).unwrap().0,
            points
        );
        let at = |p: Vec3| {
            let p = p.as_dvec3();
            DVec3::new(a * p.x + b * p.y + 0.5, c * p.x + d * p.y + 0.5, 0.0).truncate()
        };
        for i in 0..points.len() {
            let (u, v) = (glam::DVec2::new(a, c) * 0.75, glam::DVec2::new(b, d) * 0.75);
            for k in 0..=3 {
                let found = if k == 0 {
                    points.color().unwrap()[i]
                } else {
                    points.mipmap().unwrap().of_surfel(i)[k - 1]
                };
                let scale = [1.0, 4.0, 16.0, 64.0][k];
                let expected = paint
                    .color(at(points.position()[i]), Ellipse::from_half_axes(u, v).times(scale));
                // Corners with rounded coordinates have no exact affine map.
                assert!((found - expected).abs().max_element() < 1e-4, "{map:?} {i} level {k}");
            }
        }
        let (flat, _) = of_facets(cloud.clone(), &exec, &quiet).unwrap();
        for i in 0..flat.len() {
            let place = at(flat.position()[i]);
            let halves = flat.tangents().unwrap()[i].map(|half| at(half) - 0.5);
            for k in 0..=3 {
                let found = if k == 0 {
                    flat.color().unwrap()[i]
                } else {
                    flat.mipmap().unwrap().of_surfel(i)[k - 1]
                };
                let ellipse =
                    Ellipse::from_half_axes(halves[0], halves[1]).times([1.0, 4.0, 16.0, 64.0][k]);
                let expected = paint.color(place, ellipse);
                assert!((found - expected).abs().max_element() < 1e-3, "{map:?} {i} level {k}");
            }
        }
    }
}

#[test]
fn a_ramp_is_sampled_where_the_surfels_are() {
    // 8 of 100 texels and 12 of 80 in each unit.
    let cloud = painted(grid([0.08, 0.0, 0.0, -0.1]), ramp(), 0);
    let expected = |p: Vec3| Vec3::new(50.0 + 8.0 * p.x, 40.0 + 8.0 * p.y, 0.0);
    let exec = Exec::sequential();
    let (flat, _) = of_facets(cloud.clone(), &exec, &quiet).unwrap();
    let (points, _) = surfels(cloud.clone(), &Derive::default(), &exec, &quiet).unwrap();
    let inside = |p: Vec3| p.abs().max_element() < 2.5;
    for (surfels, most) in [(&flat, 0.1), (&points, 0.02)] {
        assert_eq!(surfels.mipmap(), None);
        for (&p, &color) in
            surfels.position().iter().zip(surfels.color().unwrap()).filter(|(p, _)| inside(**p))
        {
            assert!((color - expected(p)).abs().max_element() < most, "{p}: {color}");
        }
    }
    let (triangles, _) = polygons(cloud, &exec, &quiet).unwrap();
    assert_eq!(triangles.vertices().color.as_deref(), points.color(), "as those of points");
}

/// u = |x|: one side mirrors the other. The maps cancel, their matrices do not.
#[test]
fn what_is_mirrored_does_not_cancel() {
    let at = |x: f32, y: f32| Vec2::new(x.abs() / 8.0, y / 8.0 + 0.5);
    let mut cloud = grid([0.0; 4]);
    let all = cloud.position.iter().map(|p| at(p.x, p.y)).collect();
    cloud.coordinates = Some(Coordinates::Points(all));
    let board = Texture::new(Plane::from_pixels([256, 256], |x, _| [(x % 2) as f32; 3])).unwrap();
    let cloud = painted(cloud, board, 0);
    let (points, _) =
        surfels(cloud, &Derive { radius: Some(1.0) }, &Exec::sequential(), &quiet).unwrap();
    // At x = 0 columns of black and white are averaged over 32 texels to each side.
    assert!((points.color().unwrap()[40].x - 0.5).abs() < 0.02, "{}", points.color().unwrap()[40]);
}

#[test]
fn a_point_at_a_seam_has_something_of_both_sides() {
    let (red, blue) = (Vec3::X, Vec3::Z);
    let halves = Plane::from_pixels([64, 64], |x, _| if x < 32 { red } else { blue }.to_array());
    let position = vec![Vec3::ZERO, Vec3::X, Vec3::Y, -3.0 * Vec3::X];
    let [near, far] = [Vec2::splat(0.125), Vec2::splat(0.875)];
    let cloud = Cloud {
        position,
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        coordinates: Some(Coordinates::Corners(vec![[near; 3], [far; 3]])),
        normal: Some(vec![Vec3::Z; 4]),
        ..Cloud::default()
    };
    let cloud = painted(cloud, Texture::new(halves).unwrap(), 1);
    let exec = Exec::sequential();
    let (points, derived) = surfels(cloud.clone(), &Derive::default(), &exec, &quiet).unwrap();
    assert_eq!(derived.dropped.total(), 0);
    let both = Vec3::new(0.25, 0.0, 0.75); // areas of 1 and 3
    assert_eq!(points.color().unwrap(), [both, red, both, blue]);
    assert_eq!(points.mipmap().unwrap().of_surfel(0), [both]);
    assert_eq!(of_facets(cloud.clone(), &exec, &quiet).unwrap().0.color().unwrap(), [red, blue]);

    // A triangle without a coordinate is dropped and counted, and so is a point without a triangle.
    let mut cloud = cloud;
    cloud.coordinates = Some(Coordinates::Corners(vec![[near; 3], [far, Vec2::NAN, far]]));
    cloud.position.push(Vec3::ONE);
    cloud.normal.as_mut().unwrap().push(Vec3::Z);
    cloud.radius = Some(vec![1.0; 5]);
    let (points, derived) = surfels(cloud.clone(), &Derive::default(), &exec, &quiet).unwrap();
    assert_eq!((points.len(), derived.dropped.attribute), (1, 4));
    let (flat, derived) = of_facets(cloud, &exec, &quiet).unwrap();
    assert_eq!((flat.color().unwrap(), derived.dropped.attribute), ([red].as_slice(), 1));
}

#[test]
fn without_a_texture_coordinates_change_nothing() {
    let cloud = Cloud { color: Some(vec![Vec3::Y; 81]), ..grid([0.1, 0.0, 0.0, 0.1]) };
    let bare = Cloud { coordinates: None, ..cloud.clone() };
    let exec = Exec::sequential();
    let of = |cloud: Cloud| surfels(cloud, &Derive::default(), &exec, &quiet).unwrap().0;
    assert_eq!(of(cloud.clone()), of(bare.clone()));
    assert_eq!(
        of_facets(cloud, &exec, &quiet).unwrap().0,
        of_facets(bare.clone(), &exec, &quiet).unwrap().0
    );
    let lost = Cloud { paint: painted(grid([0.0; 4]), ramp(), 0).paint, ..bare };
    let error = of_facets(lost, &exec, &quiet).unwrap_err().to_string();
    assert_eq!(error, "the texture needs texture coordinates");
    // Points without triangles have the texture's colour at their place.
    let points =
        Cloud { triangles: Vec::new(), ..painted(grid([0.08, 0.0, 0.0, -0.1]), ramp(), 0) };
    let found = of(points);
    assert!((found.color().unwrap()[40] - Vec3::new(50.0, 40.0, 0.0)).abs().max_element() < 1e-5);
}
