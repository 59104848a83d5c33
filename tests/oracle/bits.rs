//! Bits: the fast path is the plain one, and neither threads nor tiles can be seen in a picture.

use crate::oracle::ewa::cases::{self, KINDS, Kind};
use crate::oracle::kit::case::Case;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::planes::{bits, digest, number, unclean};
use crate::oracle::kit::scene::{self, OUTLINES, change, scene, surfels};
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use splatref::composite::bins::MAX_BINS;
use splatref::frame::Exec;
use splatref::method::ewa::Settings;
use splatref::method::single_pass::{self, BinCount, DepthTest};
use splatref::number::random::unit;
use splatref::scene::groups::{Groups, MAX_GROUPS};
use splatref::scene::{Camera, Lens, Pose, Surfels};
use splatref::splat::Epsilon;
use splatref::splat::Kernel;

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
    scene::groups(own, count)
}

pub(crate) fn case() -> impl Strategy<Value = Case<Settings>> {
    let which = (0..KINDS.len(), any::<u32>(), any::<bool>());
    let size = (1_u32..70, 1_u32..50);
    (which, settings(), size).prop_map(|((kind, seed, orthographic), settings, (width, height))| {
        let mut case = cases::case(KINDS[kind], seed.into(), settings, orthographic);
        case.camera.width = width;
        case.camera.height = height;
        case
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(160))]

    #[test]
    fn the_fast_path_has_the_bits_of_the_plain_one(case in case(), tile in 0..4_usize) {
        let (drawing, exec) = (case.drawing(), Exec::new(1, 8 << tile).expect("a tile size"));
        let (plain, fast) = (drawing.on(&exec).define::<f32>(), drawing.fast());
        prop_assert_eq!(plain.tally, fast.tally);
        prop_assert_eq!(fast.frame.planes.len(), if case.scene.lights.is_empty() { 5 } else { 6 });
        for plane in &fast.frame.planes {
            let same = plain.frame.plane(&plane.name).expect("a shared plane");
            prop_assert!(bits(same) == bits(&plane.samples), "plane '{}' of {}", plane.name, case.name);
        }
        prop_assert_eq!(unclean(&plain.frame), None, "{}", case.name);
        let wide = drawing.on(&exec).frame::<f64>();
        prop_assert_eq!(unclean(&wide), None, "{}", case.name);
    }

    #[test]
    fn the_fast_path_of_the_single_pass_has_the_bits_of_the_plain_one(
        (case, depth) in (case(), depth_test()),
        tile in 0..4_usize,
        (count, seed) in (prop_oneof![1..9_usize, 1..=MAX_GROUPS], any::<u64>()),
    ) {
        let exec = Exec::new(1, 8 << tile).expect("a tile size");
        let settings = single_pass::Settings { splats: case.settings, depth };
        let groups = groups(&case.scene.surfels, count, seed);
        let drawing = Drawing::new(&case.scene, &case.camera, settings).grouped(&groups);
        let fast = drawing.on(&exec).try_fast();
        match drawing.try_define::<f32>(false) {
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
        let mut case = cases::case(kind, number as u64, settings, number % 2 == 1);
        (case.camera.width, case.camera.height) = (131, 70);
        let groups = groups(&case.scene.surfels, 7, number as u64);
        let depth = [DepthTest::Plain, DepthTest::Voronoi(BinCount::Count(64))][number / 2 % 2];
        let single = single_pass::Settings { splats: settings, depth };
        let single = Drawing::new(&case.scene, &case.camera, single).grouped(&groups);
        let mut seen = None;
        for exec in &execs {
            // Counts and margins are among the planes of the stages.
            let drawing = case.drawing().on(exec);
            let (fast, plain) = (drawing.fast().frame, drawing.frame::<f32>());
            let wide = drawing.frame::<f64>();
            for name in ["attributes.count", "margin"] {
                assert!(plain.plane(name).is_some(), "no plane {name}");
            }
            let single = single.on(exec).fast().frame;
            let all = ([&fast, &plain, &single].map(digest), digest(&wide));
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
        let disc = (Vec3::new(0.5, 0.5, 0.0), Vec3::Z, half_width);
        let axes = [Vec3::new(half_width, 0.0, 0.0), Vec3::new(0.0, 16.0, 0.0)];
        let mut scene = scene(surfels(scene::discs([disc])));
        change(&mut scene, |cloud| cloud.tangents = Some(vec![axes]));
        let kernel = Kernel { low_pass: 0.0, ..Kernel::DEFAULT };
        let drawing = Drawing::new(&scene, &camera, Settings { kernel, ..Settings::default() });
        let (plain, fast) = (drawing.plain::<f32>(), drawing.fast().frame);
        assert!(digest(&plain) == digest(&fast), "half width {half_width}");
        let alpha = [47, 48].map(|y| number(&plain, "A", y * 64 + 32));
        assert_eq!(alpha, [1.0, 0.0], "the tip is in row 47");
    }
}
