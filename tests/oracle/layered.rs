//! Bits of transparent layers: the fast paths of Algorithms 2 and 3 and of peeling are the
//! definitions.

use crate::oracle::bits;
use crate::oracle::kit::case::Case;
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::planes::{self, unclean};
use crate::oracle::kit::scene::{AHEAD, change, discs, scene, surfels};
use crate::oracle::transparent::cases;
use glam::Vec3;
use proptest::prelude::*;
use splatref::frame::Exec;
use splatref::method::ewa::Settings as Splats;
use splatref::method::single_pass::{BinCount, DepthTest};
use splatref::method::transparent::{self, BinEdges, Holes};
use splatref::method::{Method, peeling, transparent_hq};
use splatref::scene::{Camera, Cloud, Groups, Lens, Light};
use splatref::splat::Epsilon;

/// Whether the picture of a session is that of the definition, and says the same of the surfels;
/// or neither can be drawn.
fn agrees(drawing: &Drawing<'_>, tile: u32, name: &str) {
    let exec = Exec::new(1, tile).expect("a tile size");
    let drawing = drawing.on(&exec);
    let fast = drawing.try_fast();
    let plain = match drawing.try_define::<f32>(false) {
        Ok(plain) => plain,
        Err(error) => {
            assert_eq!(error.to_string(), fast.expect_err("as plain").to_string(), "{name}");
            return;
        }
    };
    let fast = fast.expect("renders");
    assert_eq!(plain.tally, fast.tally, "{name}");
    assert_eq!(plain.frame.planes.len(), fast.frame.planes.len(), "{name}");
    for (plain, fast) in plain.frame.planes.iter().zip(&fast.frame.planes) {
        assert_eq!(plain.name, fast.name, "{name}");
        let same = planes::bits(&plain.samples) == planes::bits(&fast.samples);
        assert!(same, "plane '{}' with tiles of {tile}: {name}", plain.name);
    }
    assert_eq!(unclean(&fast.frame), None, "{name}");
}

#[test]
fn environments_glass_and_groups_of_any_size_have_the_bits_of_the_definition() {
    for number in 0..400 {
        let case = cases::case(number);
        agrees(&case.drawing(), [8, 16, 32, 64][number / 5 % 4], &case.name);
    }
}

/// Opacities by lot, or none.
fn opacities(cloud: &mut Cloud, dice: &mut Dice) {
    let few = [0.0, 0.125, 0.5, 0.9, 1.0];
    let count = cloud.position.len();
    cloud.opacity = match dice.below(4) {
        0 => None,
        1 => Some((0..count).map(|_| few[dice.below(few.len())]).collect()),
        _ => Some((0..count).map(|_| dice.within(0.0, 1.0)).collect()),
    };
}

/// Groups that know nothing of the surfels: some of them enlarged, with additions.
fn groups(count: usize, dice: &mut Dice) -> Groups {
    let most = if dice.below(4) == 0 { 64 } else { 5 };
    let groups = 1 + dice.below(most);
    let own = (0..count).map(|_| dice.below(groups) as u8).collect();
    let further = dice.below(3) * count / 4;
    let added =
        (0..further).map(|_| (dice.below(count) as u32, dice.below(groups) as u8)).collect();
    let enlarged = dice.below(2) == 0;
    let scale = |dice: &mut Dice| if enlarged { dice.within(0.75, 2.0) } else { 1.0 };
    let scale = (0..groups).map(|_| scale(dice)).collect();
    Groups::new(own, added, scale).expect("groups in range")
}

/// Algorithms 2 and 3 and peeling with these footprints.
fn methods(splats: Splats, dice: &mut Dice) -> [Method; 3] {
    let bins = |dice: &mut Dice| match dice.below(3) {
        0 => BinCount::Epsilon,
        1 => BinCount::Count(1 + dice.below(9) as u32),
        _ => BinCount::Count(1 + dice.below(65_535) as u32),
    };
    let holes = [Holes::Skipped, Holes::Background][dice.below(2)];
    let bin_edges = [BinEdges::Staggered, BinEdges::Common][dice.below(2)];
    let layers = transparent::Settings { splats, bins: bins(dice), bin_edges, holes };
    let nearest = [DepthTest::Plain, DepthTest::Voronoi(bins(dice))][dice.below(2)];
    let hq = transparent_hq::Settings { layers, nearest, refraction: None };
    let most = [1, 2, 5, 64, 256][dice.below(5)];
    [layers.into(), hq.into(), peeling::Settings { splats, layers: most }.into()]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn hard_scenes_have_the_bits_of_the_definition(
        mut case in bits::case(),
        tile in 0..4_usize,
        seed in any::<u32>(),
    ) {
        let mut dice = Dice(u64::from(seed));
        change(&mut case.scene, |cloud| opacities(cloud, &mut dice));
        let groups = groups(case.scene.surfels.len(), &mut dice);
        let Case { scene, camera, settings, name, .. } = &case;
        for method in methods(*settings, &mut dice) {
            let drawing = Drawing::new(scene, camera, method).grouped(&groups);
            agrees(&drawing, 8 << tile, &format!("{name} {method:?}"));
        }
    }
}

/// 300 sheets one behind the other, in one group and in three: counts of layers end at 255.
#[test]
fn counts_that_end_have_the_bits_of_the_definition() {
    let disc = |i: usize| {
        let (sheet, place) = (i / 4, i % 4);
        let [x, y] = [place % 2, place / 2].map(|v| v as f32 - 0.5);
        (Vec3::new(x, y, -2.0 - sheet as f32 / 128.0), Vec3::Z, 1.25)
    };
    let mut cloud = discs((0..1200).map(disc));
    cloud.opacity = Some((0..1200).map(|i| [0.0, 0.003, 0.5, 0.01][i % 4]).collect());
    let mut scene = scene(surfels(cloud));
    scene.lights = vec![Light::DEFAULT];
    let camera = Camera::new(37, 21, AHEAD, Lens::Focal(24.0)).expect("a camera");
    let splats = Splats { epsilon: Epsilon::World(1.0 / 512.0), cull: false, ..Splats::default() };
    for count in [1, 3] {
        let own = (0..1200).map(|i| (i / 4 % count) as u8).collect();
        let groups = Groups::new(own, Vec::new(), vec![1.0; count]).expect("groups");
        let layers = transparent::Settings {
            splats,
            bins: BinCount::Count(65_535),
            bin_edges: BinEdges::Staggered,
            holes: Holes::Background,
        };
        let hq = transparent_hq::Settings { layers, ..Default::default() };
        let deep = peeling::Settings { splats, layers: peeling::MAX_LAYERS };
        for method in [Method::from(layers), hq.into(), deep.into()] {
            let drawing = Drawing::new(&scene, &camera, method).grouped(&groups);
            agrees(&drawing, 16, method.name());
            if count == 1 {
                let layers = planes::numbers(&drawing.fast().frame, "layers");
                let most = layers.iter().copied().fold(0.0, f64::max);
                // The nearest layer of Algorithm 3 counts beside the others.
                let end = if method.name() == "transparent-hq" { 256.0 } else { 255.0 };
                assert_eq!(most, end, "{}", method.name());
            }
        }
    }
}

/// Threads and tiles cannot be seen, and neither can an earlier picture in the same memory.
#[test]
fn threads_tiles_and_earlier_pictures_leave_no_trace() {
    for number in [3, 10, 17] {
        let case = cases::case(number);
        let mut camera = case.camera;
        (camera.width, camera.height) = (131, 70);
        let mut dice = Dice(number as u64);
        for method in methods(case.settings.splats, &mut dice) {
            let drawing = Drawing::new(&case.scene, &camera, method).grouped(case.groups());
            let Ok(first) = drawing.try_fast() else { continue };
            for exec in [(2, 8), (3, 16), (7, 32), (1, 64)] {
                let exec = Exec::new(exec.0, exec.1).expect("in range");
                let found = drawing.on(&exec).fast_after(&case.camera);
                assert!(planes::digest(&found.frame) == planes::digest(&first.frame), "{exec:?}");
            }
        }
    }
}
