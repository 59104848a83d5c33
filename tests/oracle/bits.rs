//! Bits: the fast path is the plain one, and neither threads nor tiles can be seen in a picture.

use crate::ewa::cases::{Case, KINDS, Kind, OUTLINES};
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use sha2::{Digest, Sha256};
use splatref::composite::bins::MAX_BINS;
use splatref::frame::{Exec, Frame, Samples};
use splatref::method::ewa::{self, Epsilon, Settings};
use splatref::method::single_pass::{self, BinCount, DepthTest};
use splatref::number::Exact;
use splatref::number::random::unit;
use splatref::scene::groups::{Groups, MAX_GROUPS};
use splatref::scene::{Camera, Cloud, Lens, Phong, Pose, Scene, Surfels};
use splatref::splat::Kernel;

/// The bits of a plane; through f64, which keeps those of f32 apart.
pub(crate) fn bits<R: Exact>(samples: &Samples<R>) -> Vec<u64> {
    let number = |v: R| v.to_f64().to_bits();
    match samples {
        Samples::Scalar(plane) => plane.values().iter().map(|v| number(*v)).collect(),
        Samples::Color(plane) | Samples::Vector(plane) => {
            plane.values().iter().flatten().map(|v| number(*v)).collect()
        }
        Samples::Index(plane) => plane.values().iter().map(|v| u64::from(*v)).collect(),
        Samples::Count(plane) => plane.values().iter().map(|v| u64::from(*v)).collect(),
    }
}

/// One hash of all planes and their names.
pub(crate) fn digest<R: Exact>(frame: &Frame<R>) -> Vec<u8> {
    let mut hash = Sha256::new();
    for plane in &frame.planes {
        hash.update(plane.name.as_bytes());
        for value in bits(&plane.samples) {
            hash.update(value.to_le_bytes());
        }
    }
    hash.finalize().to_vec()
}

/// A -0 or a NaN, which no plane may hold.
pub(crate) fn unclean<R: Exact>(frame: &Frame<R>) -> Option<&str> {
    let negative_zero = (-0.0_f64).to_bits();
    let bad = |v: &u64| *v == negative_zero || f64::from_bits(*v).is_nan();
    let floats = |s: &Samples<R>| !matches!(s, Samples::Index(_) | Samples::Count(_));
    let plane =
        frame.planes.iter().find(|p| floats(&p.samples) && bits(&p.samples).iter().any(bad));
    plane.map(|p| p.name.as_str())
}

fn settings() -> impl Strategy<Value = Settings> {
    let kernel = (0..3_usize, prop_oneof![Just(2.0_f32), Just(1.0), 0.25_f32..4.0]);
    let low_pass = prop_oneof![Just(0.25_f32), Just(1.0), Just(0.0), 0.0_f32..16.0];
    let epsilon = prop_oneof![
        Just(Epsilon::World(0.0)),
        Just(Epsilon::World(f32::INFINITY)),
        (0.0_f32..3.0).prop_map(Epsilon::MedianRadii),
        (0.0_f32..1e-6).prop_map(Epsilon::World),
    ];
    (kernel, low_pass, epsilon, any::<bool>()).prop_map(|((o, cutoff), low_pass, epsilon, cull)| {
        Settings { kernel: Kernel { outline: OUTLINES[o], cutoff, low_pass }, epsilon, cull }
    })
}

fn depth_test() -> impl Strategy<Value = DepthTest> {
    let bins = prop_oneof![
        Just(BinCount::Epsilon),
        (1..=MAX_BINS).prop_map(BinCount::Count),
        (1..40_u32).prop_map(BinCount::Count),
    ];
    prop_oneof![Just(DepthTest::Plain), bins.prop_map(DepthTest::Voronoi)]
}

/// Groups that know nothing of the surfels.
fn groups(surfels: &Surfels, count: usize, seed: u64) -> Groups {
    let own = (0..surfels.len()).map(|i| (unit(seed, i as u64) * count as f32) as u8).collect();
    Groups::new(own, Vec::new(), vec![1.0; count]).expect("groups in range")
}

pub(crate) fn case() -> impl Strategy<Value = Case> {
    let which = (0..KINDS.len(), any::<u32>(), any::<bool>());
    let size = (1_u32..70, 1_u32..50);
    (which, settings(), size).prop_map(|((kind, seed, orthographic), settings, (width, height))| {
        let mut case = Case::new(KINDS[kind], seed.into(), settings, orthographic);
        case.camera.width = width;
        case.camera.height = height;
        case
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(160))]

    #[test]
    fn the_fast_path_has_the_bits_of_the_plain_one(case in case(), tile in 0..4_usize) {
        let Case { scene, camera, settings, .. } = &case;
        let exec = Exec::new(1, 8 << tile).expect("a tile size");
        let plain = ewa::render::<f32>(scene, camera, settings, &exec, true).expect("renders");
        let fast = ewa::render_f32(scene, camera, settings, &Exec::sequential()).expect("renders");
        prop_assert_eq!(plain.tally, fast.tally);
        prop_assert_eq!(fast.frame.planes.len(), if scene.lights.is_empty() { 5 } else { 6 });
        for plane in &fast.frame.planes {
            let same = plain.frame.plane(&plane.name).expect("a shared plane");
            prop_assert!(bits(same) == bits(&plane.samples), "plane '{}' of {}", plane.name, case.name);
        }
        prop_assert_eq!(unclean(&plain.frame), None, "{}", case.name);
        let wide = ewa::render::<f64>(scene, camera, settings, &exec, true).expect("renders");
        prop_assert_eq!(unclean(&wide.frame), None, "{}", case.name);
    }

    #[test]
    fn the_fast_path_of_the_single_pass_has_the_bits_of_the_plain_one(
        (case, depth) in (case(), depth_test()),
        tile in 0..4_usize,
        (count, seed) in (prop_oneof![1..9_usize, 1..=MAX_GROUPS], any::<u64>()),
    ) {
        let Case { scene, camera, settings, .. } = &case;
        let exec = Exec::new(1, 8 << tile).expect("a tile size");
        let settings = single_pass::Settings { splats: *settings, depth };
        let groups = groups(&scene.surfels, count, seed);
        let other = Exec::sequential();
        let fast = single_pass::render_f32(scene, &groups, camera, &settings, &exec);
        match single_pass::render::<f32>(scene, &groups, camera, &settings, &other, false) {
            Err(error) => prop_assert_eq!(error.to_string(), fast.expect_err("as plain").to_string()),
            Ok(plain) => {
                let fast = fast.expect("renders");
                prop_assert_eq!(plain.tally, fast.tally);
                prop_assert_eq!(plain.frame.planes.len(), fast.frame.planes.len());
                for (plain, fast) in plain.frame.planes.iter().zip(&fast.frame.planes) {
                    prop_assert_eq!(&plain.name, &fast.name);
                    let same = bits(&plain.samples) == bits(&fast.samples);
                    prop_assert!(same, "plane '{}' of {}", plain.name, case.name);
                }
                prop_assert_eq!(unclean(&fast.frame), None, "{}", case.name);
            }
        }
    }
}

#[test]
fn threads_and_tiles_leave_no_trace() {
    let execs: Vec<Exec> = [1, 2, 3, 7, 16]
        .into_iter()
        .flat_map(|threads| [8, 16, 32, 64].map(|tile| Exec::new(threads, tile).expect("in range")))
        .collect();
    for (number, kind) in
        [Kind::Discs, Kind::Sizes, Kind::Degenerate, Kind::Shape(1), Kind::Tilted, Kind::Layers]
            .into_iter()
            .enumerate()
    {
        let kernel = Kernel { outline: OUTLINES[number % 3], ..Kernel::DEFAULT };
        let settings = Settings { kernel, ..Settings::default() };
        let mut case = Case::new(kind, number as u64, settings, number % 2 == 1);
        (case.camera.width, case.camera.height) = (131, 70);
        let Case { scene, camera, settings, .. } = &case;
        let mut seen = None;
        for exec in &execs {
            // Counts and margins are among the planes of the stages.
            let fast = ewa::render_f32(scene, camera, settings, exec).expect("renders");
            let plain = ewa::render::<f32>(scene, camera, settings, exec, true).expect("renders");
            let wide = ewa::render::<f64>(scene, camera, settings, exec, true).expect("renders");
            for name in ["attributes.count", "margin"] {
                assert!(plain.frame.plane(name).is_some(), "no plane {name}");
            }
            let groups = groups(&scene.surfels, 7, number as u64);
            let depth = [DepthTest::Plain, DepthTest::Voronoi(BinCount::Count(64))][number / 2 % 2];
            let single = single_pass::Settings { splats: *settings, depth };
            let single = single_pass::render_f32(scene, &groups, camera, &single, exec);
            let single = single.expect("renders");
            let frames = [&fast.frame, &plain.frame, &single.frame];
            let all = (frames.map(digest), digest(&wide.frame));
            let first = seen.get_or_insert_with(|| all.clone());
            assert!(*first == all, "{} threads, {exec:?}: {}", exec.threads(), case.name);
        }
    }
}

/// A flat ellipse that ends exactly in a row of pixel centres: there q = u u + k k rounds to k k
/// for a stretch of the row, all of which is inside, however narrow the ellipse is at its tip.
#[test]
fn the_tip_of_a_wide_ellipse_has_the_bits_of_the_plain_path() {
    let pose = Pose { eye: DVec3::new(0.0, 0.0, 4.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(64, 64, pose, Lens::Orthographic(64.0)).expect("one px a unit");
    for half_width in [64.0, 4096.0, 32_768.0, 1e6] {
        let cloud = Cloud {
            position: vec![Vec3::new(0.5, 0.5, 0.0)],
            normal: Some(vec![Vec3::Z]),
            radius: Some(vec![half_width]),
            tangents: Some(vec![[Vec3::new(half_width, 0.0, 0.0), Vec3::new(0.0, 16.0, 0.0)]]),
            ..Cloud::default()
        };
        let surfels = Surfels::new(cloud).expect("a surfel").0;
        let (lights, material) = (Vec::new(), Phong::default());
        let scene = Scene {
            name: String::new(),
            surfels,
            lights,
            material,
            primitives: Default::default(),
            environment: None,
        };
        let kernel = Kernel { low_pass: 0.0, ..Kernel::DEFAULT };
        let settings = Settings { kernel, ..Settings::default() };
        let exec = Exec::sequential();
        let plain = ewa::render::<f32>(&scene, &camera, &settings, &exec, false).expect("renders");
        let fast = ewa::render_f32(&scene, &camera, &settings, &exec).expect("renders");
        assert!(digest(&plain.frame) == digest(&fast.frame), "half width {half_width}");
        let Some(Samples::Scalar(alpha)) = plain.frame.plane("A") else { unreachable!() };
        assert_eq!((*alpha.at(32, 47), *alpha.at(32, 48)), (1.0, 0.0), "the tip is in row 47");
    }
}
