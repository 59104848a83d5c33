//! Laws of the reconstruction with templates, on pictures of scenes drawn by lot.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::number::Num;
use crate::oracle::kit::planes::{at, plane};
use crate::oracle::kit::scene::change;
use crate::oracle::template::cases::{self, Dot, exact_camera, exact_scene};
use crate::oracle::template::model::{Grid, Template};
use crate::oracle::template::stages::{all_settings, grid};
use glam::Vec3;
use splatref::Error;
use splatref::frame::{Frame, NO_ID};
use splatref::method::Method;
use splatref::method::template::{Falloff, LevelRule, Settings};
use splatref::scene::{Camera, Scene};
use std::collections::BTreeMap;

fn drawn(scene: &Scene, camera: &Camera, settings: &Settings) -> Frame<f32> {
    Drawing::new(scene, camera, *settings).frame()
}

/// All levels of a picture.
fn levels(template: &Template<24>, frame: &Frame<f32>) -> Vec<Grid> {
    let sizes = template.sizes.iter().enumerate();
    sizes.map(|(level, size)| grid(frame, level, *size)).collect()
}

fn oracle(settings: Settings, camera: &Camera) -> Template<24> {
    let size = [camera.width, camera.height];
    Template::new(settings, size)
}

#[test]
fn an_empty_scene_stays_empty() {
    let behind = Dot::new(4.5, 4.5, 3.0).at_depth(-4.0);
    let beside = Dot::new(-0.5, 4.5, 3.0);
    for (size, discs) in [([9, 7], vec![]), ([9, 7], vec![behind, beside]), ([1, 1], vec![])] {
        for settings in all_settings(true) {
            let frame = drawn(&exact_scene(&discs), &exact_camera(size), &settings);
            for plane in &frame.planes {
                let name = plane.name.rsplit('.').next().unwrap_or_default();
                let expected = match name {
                    "Z" => f64::INFINITY,
                    "id" => f64::from(NO_ID),
                    _ => 0.0,
                };
                for i in 0..(size[0] * size[1]) as usize {
                    assert_eq!(at(&plane.samples, i), [expected; 3], "plane '{}'", plane.name);
                }
            }
        }
    }
}

#[test]
fn a_surface_of_one_colour_has_that_colour() {
    let color = Vec3::new(0.1, 0.7, 1.0);
    let mut pixels = 0;
    for number in 0..84 {
        let mut case = cases::case(number);
        change(&mut case.scene, |cloud| cloud.color = Some(vec![color; cloud.position.len()]));
        case.scene.lights.clear();
        for settings in all_settings(false) {
            let frame = drawn(&case.scene, &case.camera, &settings);
            for i in 0..(frame.width * frame.height) as usize {
                let terms = at(plane(&frame, "gathered.count"), i)[0];
                let found = at(plane(&frame, ""), i);
                // Of n products of a weight two roundings each, in the sums of both; a quotient.
                let bound = (2.0 * terms + 2.0) * Num::<24>::unit();
                let expected = if terms > 0.0 { color.to_array().map(f64::from) } else { [0.0; 3] };
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!((found - expected).abs() <= bound * expected, "{found} in {case:?}");
                }
                pixels += usize::from(terms > 1.0);
            }
        }
    }
    assert!(pixels > 10_000, "{pixels} pixels of several centres");
}

/// Where the samples of a projection are in the end.
#[derive(Default)]
struct Account {
    /// Samples that are in a centre which stays, and how many such centres there are.
    kept: usize,
    centers: usize,
    /// Samples that were behind another surface where centres met.
    lost: usize,
}

/// Follows every sample up the levels of a picture; `None` if rounding decides.
fn account(template: &Template<24>, grids: &[Grid], case: &str) -> Option<Account> {
    let mut account = Account::default();
    // Which samples each centre consists of, by its id; nothing else may have two.
    let mut holds: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for cell in grids[0].cells.iter().flatten() {
        assert!(holds.insert(cell.id, vec![cell.id]).is_none(), "{case}: {} twice", cell.id);
    }
    let samples = holds.len();
    for (level, here) in grids.iter().enumerate() {
        for staying in template.staying(level, here) {
            let content = holds.remove(&staying.center.id);
            let content = content.unwrap_or_else(|| panic!("{case}: a centre stays twice"));
            account.kept += content.len();
            account.centers += 1;
        }
        let Some(above) = grids.get(level + 1) else { break };
        let mut arrived = BTreeMap::new();
        for [x, y] in above.positions() {
            let Some(merged) = template.merged(level, here, [x, y]).ok()? else {
                assert!(above.at(x, y).is_none(), "{case}: a centre from nowhere");
                continue;
            };
            let id = above.at(x, y).map(|cell| cell.id);
            assert_eq!(id, Some(merged.id), "{case}: what meets in ({x}, {y})");
            let mut take = |id: &u32| holds.remove(id).expect("what moves has not stayed");
            account.lost += merged.lost.iter().map(&mut take).map(|lost| lost.len()).sum::<usize>();
            arrived.insert(merged.id, merged.members.iter().flat_map(take).collect());
        }
        assert!(holds.is_empty(), "{case}: neither stayed nor moved at level {level}: {holds:?}");
        holds = arrived;
    }
    assert_eq!(account.kept + account.lost, samples, "{case}");
    Some(account)
}

#[test]
fn every_sample_is_in_one_place_or_lost_by_the_rule() {
    let (mut merged, mut lost, mut open) = (0, 0, 0);
    for number in 0..84 {
        let Case { scene, camera, name, .. } = cases::case(number);
        for settings in all_settings(false) {
            let template = oracle(settings, &camera);
            let grids = levels(&template, &drawn(&scene, &camera, &settings));
            match account(&template, &grids, &format!("{name}, {settings:?}")) {
                Some(account) => {
                    merged += account.kept - account.centers;
                    lost += account.lost;
                }
                None => open += 1,
            }
        }
    }
    println!("{merged} merged, {lost} lost; rounding decided in {open} pictures");
    assert!(merged > 10_000 && lost > 1000 && open < 10, "{merged} {lost} {open}");
}

/// Discs by lot, of many sizes and depths.
fn crowd(dice: &mut Dice, size: u32, count: usize) -> Vec<Dot> {
    let by_lot = |dice: &mut Dice| {
        let [x, y] = [(); 2].map(|()| dice.below(2 * size as usize) as f32 / 2.0 + 0.25);
        let radius = [0.5, 1.5, 2.5, 3.5, 5.0, 7.0, 10.0, 20.0, 40.0][dice.below(9)];
        Dot::new(x, y, radius).at_depth([4.0, 8.0, 16.0, 64.0, 256.0][dice.below(5)])
    };
    (0..count).map(|_| by_lot(dice)).collect()
}

/// How many centres are left of discs; `None` if rounding decides.
fn centers(discs: &[Dot], size: u32, settings: Settings) -> Option<usize> {
    let (scene, camera) = (exact_scene(discs), exact_camera([size, size]));
    let template = oracle(settings, &camera);
    let grids = levels(&template, &drawn(&scene, &camera, &settings));
    account(&template, &grids, "a crowd").map(|account| account.centers)
}

/// \[MOC08, section 3.2\]: "larger templates tend to merge less splats". They do, and it is no law.
#[test]
fn larger_templates_tend_to_merge_less() {
    let mut dice = Dice(17);
    for levels in [LevelRule::Radius, LevelRule::Diameter, LevelRule::Covering] {
        let (mut total, mut rises) = ([0; 3], [0; 2]);
        for _ in 0..60 {
            let discs = crowd(&mut dice, 32, 150);
            let found = [3, 5, 7].map(|size| {
                centers(
                    &discs,
                    32,
                    Settings { size, levels, falloff: Falloff::Linear, cull: false },
                )
            });
            let [Some(a), Some(b), Some(c)] = found else { continue };
            let found = [a, b, c];
            (0..3).for_each(|i| total[i] += found[i]);
            (0..2).for_each(|i| rises[i] += usize::from(found[i + 1] < found[i]));
        }
        println!("{levels:?}: centres left {total:?}, fewer for the larger template {rises:?}");
        assert!(total[0] < total[1] && total[1] < total[2], "{levels:?}: {total:?}");
    }
}

/// Each 4 x 4 pixels have a small disc, a huge one far behind it in the same 2 x 2, and a third one
/// farther behind. With k = 5 the small disc moves once, hides the huge one, and stays; the third
/// stays as well. With k = 7 the small one never moves, so that the huge ones do, hide the third,
/// and merge.
#[test]
fn a_larger_template_can_merge_more() {
    let group = |x: f32, y: f32| {
        let small = Dot::new(x + 0.5, y + 0.5, 2.5);
        let huge = Dot::new(x + 1.5, y + 0.5, 100.0).at_depth(200.0);
        [small, huge, Dot::new(x + 2.5, y + 2.5, 7.0).at_depth(400.0)]
    };
    let discs = [[8.0, 8.0], [12.0, 8.0], [8.0, 12.0], [12.0, 12.0]].map(|[x, y]| group(x, y));
    let discs: Vec<Dot> = discs.into_iter().flatten().collect();
    let left = [5, 7].map(|size| {
        centers(
            &discs,
            64,
            Settings { size, levels: LevelRule::Covering, falloff: Falloff::Linear, cull: false },
        )
    });
    assert_eq!(left, [Some(8), Some(5)], "of 12");
}

#[test]
fn templates_that_are_not_3_5_or_7_wide_are_refused() {
    let (scene, camera) = (exact_scene(&[Dot::new(0.5, 0.5, 1.0)]), exact_camera([2, 1]));
    for size in [0, 1, 2, 4, 6, 8, 9, u32::MAX] {
        let settings = Settings { size, ..Settings::default() };
        let refused = Drawing::new(&scene, &camera, settings).try_define::<f32>(true);
        let error = refused.expect_err("refused");
        assert!(matches!(error, Error::Invalid(..)), "{error:?}");
        assert!(!error.to_string().is_empty() && !error.to_string().contains('\n'), "{error}");
        assert!(Method::Template(settings).check().is_err());
    }
    for size in [3, 5, 7] {
        let settings = Settings { size, ..Settings::default() };
        let frame = drawn(&scene, &camera, &settings);
        assert_eq!(at(plane(&frame, "weight"), 0), [1.0; 3], "wider than the picture");
        assert_eq!(at(plane(&frame, "weight"), 1), [(-24.0_f64).exp2(); 3], "on the rim");
    }
}
