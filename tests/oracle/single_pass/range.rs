//! `d_min` and `d_max` of \[ZP06, eq. 6\]: no fragment is outside.

use crate::oracle::ewa::cases::{self, KINDS};
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::eye::{Eye, dot, sub, wide};
use crate::oracle::kit::planes::scalars;
use crate::oracle::kit::scene::{self, OUTLINES, groups, straight};
use crate::oracle::single_pass::identity::lit;
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use splatref::method::ewa;
use splatref::method::single_pass::{BinCount, DepthTest, Settings, depth_range};
use splatref::scene::{Camera, Lens, Pose, Scene, Surfels};
use splatref::source::Shape;
use splatref::splat::Kernel;

/// The depths of all fragments that the groups of a scene keep.
fn depths(scene: &Scene, camera: &Camera, splats: ewa::Settings, own: Vec<u8>) -> Vec<f64> {
    let settings = Settings { splats, depth: DepthTest::Plain };
    let groups = groups(own, 64);
    let frame = Drawing::new(scene, camera, settings).grouped(&groups).frame::<f64>();
    let planes = frame.planes.iter().filter(|p| p.name.starts_with("group"));
    let names = planes.map(|p| p.name.as_str()).filter(|name| name.ends_with(".Z"));
    let depths = names.flat_map(|name| scalars(&frame, name).to_vec());
    depths.filter(|t| t.is_finite()).collect()
}

/// By definition: the middle of the box around all positions, the greatest distance from there with
/// the reach of the surfel; its depth under the camera, plus and minus that distance.
pub(crate) fn by_definition(surfels: &Surfels, camera: &Camera) -> [f64; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in surfels.position() {
        for (i, v) in wide(*p).into_iter().enumerate() {
            (low[i], high[i]) = (low[i].min(v), high[i].max(v));
        }
    }
    let center: [f64; 3] = std::array::from_fn(|i| (low[i] + high[i]) / 2.0);
    let mut most = 0.0_f64;
    for (i, p) in surfels.position().iter().enumerate() {
        let reach = match surfels.tangents() {
            None => f64::from(surfels.radius()[i]),
            Some(tangents) => {
                let squared = tangents[i].map(|axis| dot(wide(axis), wide(axis)));
                (squared[0] + squared[1]).sqrt()
            }
        };
        let offset = sub(wide(*p), center);
        most = most.max(dot(offset, offset).sqrt() + reach);
    }
    let t = -Eye::new(camera).point(center)[2];
    [t - most, t + most]
}

/// The range of a scene is what its definition says, and is a range.
fn check(surfels: &Surfels, camera: &Camera) -> (f32, f32) {
    let (low, high) = depth_range(surfels, camera);
    let [near, far] = by_definition(surfels, camera);
    let close = |found: f32, expected: f64| {
        let error = 2.0_f64.powi(-23) * expected.abs().max(far.abs());
        (f64::from(found) - expected).abs() <= error
    };
    assert!(low < high && low >= camera.near && high.is_finite(), "{low} {high}");
    assert!(close(low, near.max(camera.near.into())), "{low} for {near}");
    if far as f32 > low {
        assert!(close(high, far), "{high} for {far}");
    } else {
        assert_eq!(high, low.next_up(), "{low} {high}, {far}");
    }
    (low, high)
}

/// Whether a depth is in a range whose ends are rounded to `f32`.
fn inside([low, high]: [f32; 2], t: f64) -> bool {
    let half_ulp = 2.0_f64.powi(-24);
    f64::from(low) * (1.0 - half_ulp) <= t && t <= f64::from(high) * (1.0 + half_ulp)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn every_fragment_is_in_the_range(
        kind in 0..KINDS.len(), seed: u32, outline in 0..3_usize, low_pass in 0.0_f32..2.0,
        [orthographic, cull] in any::<[bool; 2]>(),
    ) {
        let kernel = Kernel { outline: OUTLINES[outline], cutoff: 2.0, low_pass };
        let splats = ewa::Settings { kernel, cull, ..ewa::Settings::default() };
        let case = cases::case(KINDS[kind], seed.into(), splats, orthographic);
        let (low, high) = check(&case.scene.surfels, &case.camera);
        let mut dice = Dice(seed.into());
        let own = (0..case.scene.surfels.len()).map(|_| dice.below(64) as u8).collect();
        for t in depths(&case.scene, &case.camera, splats, own) {
            prop_assert!(inside([low, high], t), "{} {} {} of {}", low, t, high, case.name);
        }
    }
}

const SKIRT: Kernel = Kernel { low_pass: 1.0, ..Kernel::DEFAULT };
const SPLATS: ewa::Settings = ewa::Settings {
    kernel: SKIRT,
    epsilon: splatref::splat::Epsilon::MedianRadii(1.0),
    cull: false,
};

/// Discs of these places, normals and radii.
fn discs(all: &[(Vec3, Vec3, f32)]) -> Scene {
    lit(scene::discs(all.iter().copied()))
}

/// Renders with the range in use, and says it: fragments are inside, and with one group to each
/// surfel either depth test gives the same picture.
fn range_in_use(scene: &Scene, camera: &Camera) -> (f32, f32) {
    let (low, high) = check(&scene.surfels, camera);
    let own: Vec<u8> = (0..scene.surfels.len()).map(|i| (i % 64) as u8).collect();
    let all = depths(scene, camera, SPLATS, own.clone());
    assert!(all.iter().all(|t| inside([low, high], *t)), "{low} {high}");
    let pictures = [DepthTest::Plain, DepthTest::Voronoi(BinCount::Epsilon)].map(|depth| {
        let (settings, groups) = (Settings { splats: SPLATS, depth }, groups(own.clone(), 64));
        Drawing::new(scene, camera, settings).grouped(&groups).fast().frame
    });
    if own.len() <= 64 {
        assert!(pictures[0] == pictures[1], "{low} {high}");
    }
    (low, high)
}

#[test]
fn one_surfel_has_a_range() {
    for normal in [Vec3::Z, Vec3::X, Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.8, -0.6)] {
        let scene = discs(&[(Vec3::new(0.25, -0.5, -4.0), normal, 0.5)]);
        for orthographic in [false, true] {
            let range = range_in_use(&scene, &straight(orthographic, [24, 24]));
            assert_eq!(range, (3.5, 4.5));
        }
    }
}

#[test]
fn surfels_at_one_point_have_a_range() {
    let at = Vec3::new(0.25, -0.5, -4.0);
    let scene =
        discs(&[(at, Vec3::Z, 0.5), (at, Vec3::X, 0.25), (at, Vec3::Y, 1.0), (at, Vec3::Z, 0.5)]);
    assert_eq!(range_in_use(&scene, &straight(false, [24, 24])), (3.0, 5.0));
    assert_eq!(range_in_use(&scene, &straight(true, [24, 24])), (3.0, 5.0));
}

#[test]
fn inside_the_scene_the_range_starts_at_the_near_plane() {
    let surfels = Shape::Sphere.surfels(300, 1).expect("few surfels");
    let scene = lit(surfels.into_cloud());
    for eye in [DVec3::ZERO, DVec3::new(0.5, 0.25, 0.0), DVec3::new(0.0, 0.0, 0.99)] {
        let pose = Pose { eye, target: eye + DVec3::NEG_Z, up: DVec3::Y };
        let camera = Camera::new(24, 24, pose, Lens::Focal(28.0)).expect("a camera");
        let (low, high) = range_in_use(&scene, &camera);
        assert_eq!(low, camera.near);
        assert!(f64::from(high) > 1.0 + eye.z && f64::from(high) < 1.3 + eye.z, "{high}");
    }
}

#[test]
fn behind_the_camera_there_is_still_a_range() {
    let scene = discs(&[(Vec3::new(0.0, 0.0, 4.0), Vec3::Z, 0.5)]);
    let mut camera = straight(false, [8, 8]);
    assert_eq!(range_in_use(&scene, &camera), (0.0625, 0.0625_f32.next_up()));
    camera = straight(true, [8, 8]);
    camera.near = 0.0;
    assert_eq!(depth_range(&scene.surfels, &camera), (0.0, 0.0_f32.next_up()));
}

/// The ends are rounded to the nearest `f32`, and so a fragment may be outside by half an ulp; its
/// bin is that of the end.
#[test]
fn a_rim_may_leave_the_range_by_half_an_ulp() {
    let scene = discs(&[(Vec3::new(0.0, -0.5, -4.0), Vec3::Y, 0.1)]);
    let camera = straight(false, [48, 48]);
    let (low, _) = range_in_use(&scene, &camera);
    let all = depths(&scene, &camera, SPLATS, vec![0]);
    let nearest = all.into_iter().fold(f64::INFINITY, f64::min);
    assert!(nearest < f64::from(low) && low == 3.9, "{nearest} {low}");
}

#[test]
fn a_scene_smaller_than_the_spacing_of_f32_has_one_step() {
    for (depth, radius) in [(4.0_f32, 1e-7), (1000.0, 1e-5), (1e6, 0.01)] {
        let scene = discs(&[(Vec3::new(0.0, 0.0, -depth), Vec3::Z, radius)]);
        let camera = straight(false, [4, 4]);
        let (low, high) = depth_range(&scene.surfels, &camera);
        assert!(low < high && high <= low.next_up().next_up(), "{low} {high}");
        let bins = BinCount::Epsilon.resolve(&scene.surfels, &camera, radius).expect("few bins");
        assert!(bins.count < 16, "{bins:?}");
    }
}
