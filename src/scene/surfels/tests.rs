use super::*;
use crate::scene::Sphere;

fn cloud(position: Vec<Vec3>, normal: Vec<Vec3>, radius: Vec<f32>) -> Cloud {
    Cloud { position, normal: Some(normal), radius: Some(radius), ..Cloud::default() }
}

#[test]
fn degenerate_surfels_are_dropped_and_counted_once() {
    let p = [Vec3::NAN, Vec3::ZERO, Vec3::ZERO, Vec3::X, Vec3::Y];
    let n = [Vec3::ZERO, Vec3::ZERO, Vec3::Z, 3.0 * Vec3::Z, Vec3::Z];
    let r = [-1.0, -1.0, -1.0, 0.5, f32::INFINITY];
    let (surfels, dropped) = Surfels::new(cloud(p.into(), n.into(), r.into())).unwrap();
    assert_eq!(dropped, Dropped { position: 1, normal: 1, radius: 2, attribute: 0 });
    assert_eq!(surfels.position(), [Vec3::X]);
    assert_eq!(surfels.normal(), [Vec3::Z], "made a unit vector");
}

#[test]
fn threads_change_nothing() {
    let number = |i: usize, salt: u32| (i as u32 ^ salt).wrapping_mul(0x9E37_79B9);
    // Any bits, so that every chunk has every kind of degenerate surfel.
    let any = |i, salt| f32::from_bits(number(i, salt));
    let vector = |i, salt| Vec3::new(any(i, salt), any(i, salt + 1), any(i, salt + 2));
    let unit = |i, salt| number(i, salt) as f32 / u32::MAX as f32;
    let indices = 0..5 * CHUNK + 7;
    let mut p: Vec<_> = indices.clone().map(|i| Vec3::splat(unit(i, 1))).collect();
    indices.clone().step_by(9).for_each(|i| p[i] = vector(i, 11));
    let n = indices.clone().map(|i| vector(i, 21)).collect();
    let r = indices.clone().map(|i| any(i, 31)).collect();
    let color = indices.map(|i| Vec3::splat(unit(i, 41) - 0.125)).collect();
    let all = Cloud { color: Some(color), ..cloud(p, n, r) };
    let alone = Surfels::new(all.clone()).unwrap();
    let Dropped { position, normal, radius, attribute } = alone.1;
    assert!([position, normal, radius, attribute].iter().all(|&count| count > 50));
    assert!(alone.0.len() > 1000);
    assert!(Surfels::new_with(all, &Exec::new(3, 32).unwrap()).unwrap() == alone);
}

#[test]
fn groups_lose_the_surfels_that_are_dropped() {
    let p = vec![Vec3::ZERO, Vec3::NAN, Vec3::X, Vec3::Y];
    let added = vec![(0, 2), (1, 0), (3, 1), (3, 4)];
    let groups = Groups::new(vec![0, 1, 2, 3], added, vec![1.0, 2.0, 3.0, 4.0, 5.0]).unwrap();
    let all = Cloud { groups: Some(groups), ..cloud(p, vec![Vec3::Z; 4], vec![1.0; 4]) };
    let (surfels, _) = Surfels::new(all.clone()).unwrap();
    let kept = vec![(0, 2), (2, 1), (2, 4)];
    let kept = Groups::new(vec![0, 2, 3], kept, vec![1.0, 2.0, 3.0, 4.0, 5.0]).unwrap();
    assert_eq!(surfels.groups(), Some(&kept));
    assert_eq!(surfels.into_cloud().groups, Some(kept));
    let few = Groups::new(vec![0; 3], vec![], vec![1.0]).unwrap();
    let error = Surfels::new(Cloud { groups: Some(few), ..all }).unwrap_err();
    assert_eq!(error.to_string(), "4 positions, but 3 groups");
}

#[test]
fn an_empty_scene_is_an_error() {
    let error = Surfels::new(cloud(vec![], vec![], vec![])).unwrap_err();
    assert!(error.to_string().contains("empty"), "{error}");
}

#[test]
fn the_median_radius_is_the_lower_one() {
    let r = vec![4.0, 1.0, 3.0, 2.0];
    let (surfels, _) = Surfels::new(cloud(vec![Vec3::ZERO; 4], vec![Vec3::Z; 4], r)).unwrap();
    assert_eq!(surfels.median_radius(), 2.0);
}

#[test]
fn the_bounding_sphere_holds_every_disc() {
    let p = vec![Vec3::new(-1.0, 0.0, 0.0), Vec3::new(3.0, 0.0, 0.0), Vec3::X];
    let r = vec![0.5, 0.25, 4.0];
    let (surfels, _) = Surfels::new(cloud(p, vec![Vec3::Z; 3], r)).unwrap();
    assert_eq!(surfels.bounding_sphere(), Sphere { center: DVec3::X, radius: 4.0 });
}

#[test]
fn a_nearly_unit_normal_keeps_its_bits() {
    let n = Vec3::new(0.6, 0.0, 0.800_000_1);
    let (surfels, _) = Surfels::new(cloud(vec![Vec3::ZERO], vec![n], vec![1.0])).unwrap();
    assert_eq!(surfels.normal(), [n]);
}
