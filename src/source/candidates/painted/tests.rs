use super::*;
use crate::frame::Plane;
use crate::number::random::unit;
use crate::scene::{Coordinates, Texture};
use glam::DVec3;

fn quiet(_: &str, _: u64, _: u64) {}

/// A square of side 2 in the plane z = 0, cut into four triangles, seen from the front and at an
/// angle.
fn square(texture: Texture, at: impl Fn(Vec3) -> Vec2) -> Cloud {
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let position = vec![
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
        Vec3::ZERO,
    ];
    let coordinates = Coordinates::Points(position.iter().map(|&p| at(p)).collect());
    Cloud {
        paint: Some(Paint::new(texture, &coordinates, 2)),
        coordinates: Some(coordinates),
        triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        color: Some(vec![Vec3::ONE; 5]),
        position,
        ..Cloud::default()
    }
}

fn directions() -> Directions {
    Directions::These(vec![DVec3::Z, DVec3::new(2.0, 1.0, 1.0), DVec3::new(0.0, 1.0, -1.0)])
}

fn found(cloud: Cloud, side: u32, exec: &Exec) -> (Candidates, Derived) {
    of_cloud(cloud, &directions(), side, exec, &quiet).unwrap()
}

fn noise() -> Texture {
    let value = |x: u32, y: u32, c: u64| unit(c, u64::from(x) << 16 | u64::from(y));
    Texture::new(Plane::from_pixels([90, 70], |x, y| [0, 1, 2].map(|c| value(x, y, c)))).unwrap()
}

/// An affine map J takes a disc of the radius of a pixel's side s to s s J J^T, from wherever it is
/// seen.
#[test]
fn a_candidate_has_the_mean_of_the_texture_around_it() {
    let at = |p: Vec3| Vec2::new(0.25 * p.x + 0.125 * p.y + 0.5, 0.375 * p.y + 0.5);
    let cloud = square(noise(), at);
    let paint = cloud.paint.clone().unwrap();
    let (candidates, derived) = found(cloud.clone(), 60, &Exec::new(3, 16).unwrap());
    assert_eq!(candidates, found(cloud.clone(), 60, &Exec::sequential()).0);
    assert_eq!((derived.dropped_primitives, candidates.dropped), (0, 0));
    assert!(candidates.counts.iter().all(|&count| count > 300), "{:?}", candidates.counts);
    let s = candidates.pixel;
    let outline = Ellipse::of(DVec2::new(0.25, 0.0) * s, DVec2::new(0.125, 0.375) * s);
    for (&p, &color) in
        candidates.cloud.position.iter().zip(candidates.cloud.color.as_ref().unwrap())
    {
        let expected = paint.color(at(p).as_dvec2(), outline);
        assert!((color - expected).abs().max_element() < 1e-4, "{p}: {color} and {expected}");
    }
    // The same points as without a texture, in different colours.
    let bare = found(Cloud { paint: None, ..cloud }, 60, &Exec::sequential()).0;
    assert_eq!(
        (bare.cloud.position, bare.cloud.normal),
        (candidates.cloud.position, candidates.cloud.normal)
    );
    assert!(bare.cloud.color.unwrap().iter().all(|color| color.distance(Vec3::ONE) < 1e-6));
}

/// Squares of 1/64 of a pixel would alias if a pixel had the colour of one texel: half of the
/// candidates would be black and half white.
#[test]
fn what_is_finer_than_a_pixel_is_grey() {
    let board = Plane::from_pixels([1024, 1024], |x, y| [((x + y) % 2) as f32; 3]);
    let cloud = square(Texture::new(board).unwrap(), |p| Vec2::new(p.x, p.y) * 0.5 + 0.5);
    let (candidates, _) = found(cloud, 24, &Exec::sequential());
    let colors = candidates.cloud.color.unwrap();
    assert!(colors.len() > 300 && colors.iter().all(|color| (color.x - 0.5).abs() < 0.01));
}

/// Dropped triangles take their coordinates with them; the other triangles keep theirs.
#[test]
fn what_is_dropped_does_not_move_the_texture() {
    let halves =
        Plane::from_pixels([64, 64], |x, _| if x < 32 { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] });
    let side = |x: f32| [Vec2::new(x, 0.5); 3];
    let texture = Texture::new(halves).unwrap();
    let mut cloud = square(texture, |_| Vec2::splat(0.5));
    cloud.position.extend([Vec3::NAN, Vec3::new(0.0, 0.0, 0.5)]);
    cloud.normal = Some(vec![Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Z, Vec3::ZERO]);
    cloud.color = None;
    // One triangle at an infinite place, one without coordinates, one with a null normal; and four
    // that stay, one of them twice.
    let [a, b, c, d] = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    cloud.triangles = vec![[0, 5, 1], a, b, c, [0, 1, 6], [0, 1, 6], a, c, d];
    let nan = [Vec2::splat(0.5), Vec2::new(0.5, f32::NAN), Vec2::splat(0.5)];
    let all = vec![
        side(0.9),
        side(0.1),
        nan,
        side(0.9),
        side(0.9),
        side(0.1),
        side(0.9),
        side(0.9),
        side(0.1),
    ];
    cloud.coordinates = Some(Coordinates::Corners(all));
    let (candidates, derived) = found(cloud.clone(), 40, &Exec::sequential());
    assert_eq!(derived.dropped_primitives, 4);
    for (p, color) in candidates.cloud.position.iter().zip(candidates.cloud.color.unwrap()) {
        // a is below the middle, c above, d to the left; b, to the right, is gone.
        let is_c = p.y > p.x.abs() - 1e-4;
        let edge = (p.y.abs() - p.x.abs()).abs() < 1e-4;
        assert!(edge || color == if is_c { Vec3::Z } else { Vec3::X }, "{p}: {color}");
        assert!(edge || p.x < p.y.abs(), "{p}");
    }
    cloud.coordinates = Some(Coordinates::Points(vec![Vec2::NAN; 7]));
    let error =
        of_cloud(cloud, &directions(), 8, &Exec::sequential(), &quiet).unwrap_err().to_string();
    assert_eq!(
        error,
        "the scene is empty: none of its 9 triangles has finite places and texture coordinates"
    );
}
