//! Known answers of the reconstruction with templates: every threshold, tie and degenerate input
//! that its documentation names, on numbers that no arithmetic rounds, for `f32` and `f64` alike.

use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::planes;
use crate::oracle::template::cases::{Dot, exact_camera, exact_scene};
use glam::Vec3;
use splatref::frame::{Frame, NO_ID, Samples};
use splatref::method::template::{Falloff, LevelRule, Settings};
use splatref::number::Exact;

/// 2^-24.
const LEAST: f32 = 1.0 / 16_777_216.0;

fn settings(size: u32) -> Settings {
    Settings { size, levels: LevelRule::Covering, falloff: Falloff::Linear, cull: false }
}

fn drawn<R: Exact>(size: [u32; 2], discs: &[Dot], settings: &Settings) -> Frame<R> {
    Drawing::new(&exact_scene(discs), &exact_camera(size), *settings).frame()
}

/// Both arithmetics, where they agree bit for bit.
fn agreed(size: [u32; 2], discs: &[Dot], settings: &Settings) -> Frame<f32> {
    let narrow = drawn::<f32>(size, discs, settings);
    let wide = drawn::<f64>(size, discs, settings).to_f32();
    assert_eq!(narrow, wide);
    narrow
}

fn pixel(frame: &Frame<f32>, [x, y]: [u32; 2]) -> usize {
    (y * frame.width + x) as usize
}

pub(crate) fn number(frame: &Frame<f32>, name: &str, at: [u32; 2]) -> f32 {
    planes::number(frame, name, pixel(frame, at)) as f32
}

pub(crate) fn id(frame: &Frame<f32>, name: &str, at: [u32; 2]) -> u32 {
    planes::index(frame, name, pixel(frame, at))
}

fn color(frame: &Frame<f32>, at: [u32; 2]) -> [f32; 3] {
    planes::value(frame, "", pixel(frame, at)).map(|v| v as f32)
}

/// The level up to which a picture's only centre has come.
fn highest(frame: &Frame<f32>) -> usize {
    let is_there = |level: &usize| {
        let Some(Samples::Index(ids)) = frame.plane(&format!("level{level:02}.id")) else {
            return false;
        };
        ids.values().iter().any(|id| *id != NO_ID)
    };
    (1..32).take_while(is_there).count()
}

#[test]
fn a_radius_that_just_fits_stays() {
    for (k, h) in [(3, 1.0), (5, 2.0), (7, 3.0)] {
        for level in 0..4 {
            let rules = [
                (LevelRule::Radius, 2.0 * h + 1.0),
                (LevelRule::Diameter, h + 0.5),
                (LevelRule::Covering, h),
                (LevelRule::BySize, if k == 3 { 3.0 } else { h + 0.5 }),
            ];
            for (levels, reach) in rules {
                let settings = Settings { levels, ..settings(k) };
                let fits = reach * (level as f32).exp2();
                assert_eq!(settings.reach(level), fits);
                for (radius, expected) in [(fits, level), (fits.next_up(), level + 1)] {
                    let disc = Dot::new(20.5, 30.5, radius);
                    let frame = drawn::<f32>([64, 64], &[disc], &settings);
                    assert_eq!(highest(&frame), expected, "radius {radius}, {settings:?}");
                }
            }
        }
    }
}

#[test]
fn the_top_is_the_first_level_from_which_all_cells_are_found() {
    // From the documentation, h = 1, 2, 3: both sides at most 2, 3, 4.
    for (size, tops) in [
        ([1, 1], [0, 0, 0]),
        ([2, 2], [0, 0, 0]),
        ([3, 1], [1, 0, 0]),
        ([4, 3], [1, 1, 0]),
        ([5, 1], [2, 1, 1]),
        ([9, 2], [3, 2, 2]),
        ([64, 48], [5, 5, 4]),
        ([96, 1], [6, 5, 5]),
        ([97, 1], [6, 6, 5]),
    ] {
        for (k, top) in [3, 5, 7].into_iter().zip(tops) {
            let disc = Dot::new(0.5, 0.5, 1e30);
            let frame = agreed(size, &[disc], &settings(k));
            assert_eq!(highest(&frame), top, "{size:?}, k = {k}");
            let last = frame.plane(&format!("level{:02}.id", top + 1));
            assert!(last.is_none(), "{size:?}, k = {k}: beyond the top");
            // A radius beyond all pictures counts as 2^48, and is seen in every pixel.
            assert_eq!(number(&frame, "projection.extent", [0, 0]), 48.0_f32.exp2());
            assert_eq!(number(&frame, "projection.radius", [0, 0]), 1e30);
            let all = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
            assert!(all.into_iter().all(|pixel| id(&frame, "id", pixel) == 0), "{size:?}, k = {k}");
        }
    }
}

#[test]
fn the_rim_is_inside_with_the_least_weight() {
    // Radius 5: (3, 4) and (5, 0) from the centre are on the rim.
    let frame = drawn::<f32>([16, 16], &[Dot::new(8.5, 8.5, 5.0)], &settings(5));
    for pixel in [[11, 12], [5, 4], [13, 8], [8, 3]] {
        assert_eq!(number(&frame, "weight", pixel), LEAST, "{pixel:?}");
        assert_eq!((number(&frame, "Z", pixel), color(&frame, pixel)), (4.0, [1.0; 3]));
    }
    assert_eq!(number(&frame, "weight", [8, 8]), 1.0);
    for pixel in [[12, 12], [14, 8], [8, 2]] {
        assert_eq!(id(&frame, "id", pixel), NO_ID, "{pixel:?}");
    }
    // A radius an ulp larger: the same pixel is just inside; an ulp smaller: it is outside.
    let frame = drawn::<f32>([16, 16], &[Dot::new(8.5, 8.5, 5.0_f32.next_up())], &settings(5));
    assert!((LEAST..=3.0 * LEAST).contains(&number(&frame, "weight", [13, 8])));
    let frame = drawn::<f32>([16, 16], &[Dot::new(8.5, 8.5, 5.0_f32.next_down())], &settings(5));
    assert_eq!(id(&frame, "id", [13, 8]), NO_ID);
}

#[test]
fn a_tilted_disc_is_narrow_across_its_normal() {
    // Slope 4/3 in x: at an offset of 3 the disc's plane is 4 away and the distance 5; y as it is.
    let disc = Dot { normal: Vec3::new(0.8, 0.0, 0.6), ..Dot::new(8.5, 8.5, 5.0) };
    let mirrored = Dot { normal: Vec3::new(-0.8, 0.0, 0.6), ..disc };
    let turned = Dot { normal: Vec3::new(0.0, 0.8, 0.6), ..disc };
    for (disc, inside, outside) in
        [(disc, [10, 8], [12, 8]), (mirrored, [6, 8], [4, 8]), (turned, [8, 10], [8, 12])]
    {
        let frame = drawn::<f32>([16, 16], &[disc], &settings(5));
        assert_eq!(id(&frame, "id", inside), 0);
        // 1 - 2 (5/3) / 5, and the normal is of length 1 but for the input's rounding.
        assert!((number(&frame, "weight", inside) - 1.0 / 3.0).abs() < 1e-6);
        assert_eq!(id(&frame, "id", outside), NO_ID);
    }
    // The long axis lies across (nx, ny), whose y is up while that of the picture is down.
    let disc = Dot { normal: Vec3::new(0.64, 0.64, 0.4), ..Dot::new(8.5, 8.5, 7.0) };
    let frame = drawn::<f32>([16, 16], &[disc], &settings(5));
    assert_eq!(id(&frame, "id", [12, 12]), 0, "down right, across (1, 1) with y up");
    assert_eq!(id(&frame, "id", [12, 4]), NO_ID, "up right, along it");
}

#[test]
fn discs_that_hold_no_pixel_center_paint_their_own_pixel() {
    let black = Vec3::new(0.25, 0.5, 0.75);
    let tiny = Dot { color: black, ..Dot::new(3.125, 2.25, 1e-30) };
    let small = Dot { radius: 0.25, ..tiny };
    let edge_on = Dot { normal: Vec3::X, radius: 1.0, ..tiny };
    for k in [3, 5, 7] {
        for disc in [tiny, small, edge_on, Dot { normal: Vec3::Y, ..edge_on }] {
            let frame = agreed([9, 9], &[disc], &settings(k));
            for (x, y) in (0..9).flat_map(|y| (0..9).map(move |x| (x, y))) {
                let expected = if (x, y) == (3, 2) { LEAST } else { 0.0 };
                assert_eq!(number(&frame, "weight", [x, y]), expected, "({x}, {y}) of {disc:?}");
            }
            assert_eq!(color(&frame, [3, 2]), black.to_array());
            assert_eq!(number(&frame, "gathered.count", [3, 2]), 1.0);
        }
        // Exactly at the centre form = square = 0 once the square has underflowed, and 0/0 is no
        // weight: `f32` holds it by the rule for its own pixel, `f64` by the ellipse.
        let centerd = Dot { place: [3.5, 2.5], ..tiny };
        let weights = [
            number(&drawn::<f32>([9, 9], &[centerd], &settings(k)), "weight", [3, 2]),
            number(&drawn::<f64>([9, 9], &[centerd], &settings(k)).to_f32(), "weight", [3, 2]),
        ];
        assert_eq!(weights, [LEAST, 1.0]);
        // Of those that moved on nothing is left.
        let frame = agreed([9, 9], &[Dot { radius: 4.0, ..edge_on }], &settings(k));
        let painted = (0..9).flat_map(|y| (0..9).map(move |x| [x, y]));
        assert!(painted.into_iter().all(|pixel| id(&frame, "id", pixel) == NO_ID), "{k}");
    }
}

#[test]
fn centers_as_far_apart_as_their_radii_are_one_surface() {
    // Both move into one cell; r + r_front = 6.
    for (behind, merged) in [(10.0_f32, true), (10.0_f32.next_up(), false)] {
        let discs = [Dot::new(2.5, 2.5, 3.0), Dot::new(3.5, 2.5, 3.0).at_depth(behind)];
        for order in [[0, 1], [1, 0]] {
            let discs = order.map(|i: usize| discs[i]);
            let front = order.iter().position(|i| *i == 0).expect("one of two") as u32;
            let frame = drawn::<f32>([16, 16], &discs, &settings(3));
            let cell = [1, 1];
            assert_eq!(id(&frame, "level01.id", cell), front);
            let expected = if merged { [7.0, 3.0] } else { [4.0, 2.5] };
            assert_eq!(number(&frame, "level01.Z", cell), expected[0]);
            assert_eq!(number(&frame, "level01.center.X", cell), expected[1]);
        }
    }
    // Equally near: the id is that of the lower j, left before right, above before below.
    for (places, front) in [
        ([[2.5, 2.5], [3.5, 2.5]], 0),
        ([[3.5, 2.5], [2.5, 2.5]], 1),
        ([[2.5, 3.5], [3.5, 2.5]], 1),
    ] {
        let discs = places.map(|[x, y]: [f32; 2]| Dot::new(x, y, 3.0));
        let frame = drawn::<f32>([16, 16], &discs, &settings(3));
        assert_eq!(id(&frame, "level01.id", [1, 1]), front);
    }
    // Of three equal numbers the mean is the number, whatever thirds round to.
    for radius in [3.0, 3.001, 3.006, 3.008] {
        let discs = [[2.5, 2.5], [3.5, 2.5], [3.5, 3.5]];
        let discs = discs.map(|[x, y]: [f32; 2]| Dot::new(x, y, radius));
        let frame = drawn::<f32>([16, 16], &discs, &settings(3));
        assert_eq!(number(&frame, "level01.extent", [1, 1]), radius);
    }
}

#[test]
fn a_pixel_blends_as_far_as_the_sum_of_radii() {
    // Both stay at level 0; the pixel between them finds the left one first. r + r = 2.
    for (depth, count, front) in [
        (6.0_f32, 2.0, 0),
        (6.0_f32.next_up(), 1.0, 0),
        (2.0, 2.0, 1),
        (2.0 - 4.0 * f32::EPSILON, 1.0, 1),
        (4.0, 2.0, 0),
    ] {
        let discs = [Dot::new(7.5, 8.5, 1.0), Dot::new(8.5, 8.5, 1.0).at_depth(depth)];
        let frame = drawn::<f32>([16, 16], &discs, &settings(3));
        for pixel in [[7, 8], [8, 8]] {
            assert_eq!(number(&frame, "gathered.count", pixel), count, "depth {depth}");
            assert_eq!(id(&frame, "id", pixel), front, "depth {depth}");
        }
        let front = [4.0, depth][front as usize];
        assert_eq!(number(&frame, "gathered.Z", [7, 8]), front, "depth {depth}");
    }
}

/// 40 centres around a pixel in each of 7 levels, each as large as its level can be.
#[test]
fn the_count_ends_at_255_and_the_sums_do_not() {
    let pixel = [256_u32; 2];
    let mut discs = Vec::new();
    let mut sum = 0.0;
    for level in 0..7 {
        let cell = pixel[0] >> level;
        let ring = (cell - 3..=cell + 3).flat_map(|y| (cell - 3..=cell + 3).map(move |x| [x, y]));
        for at in ring.filter(|at| at.iter().any(|v| v.abs_diff(cell) > 1)) {
            // The far end of the cell, which no smaller template reaches: nothing meets another.
            let far = |v: u32| if v < cell { v << level } else { ((v + 1) << level) - 1 };
            let [x, y] = at.map(|v| far(v) as f32 + 0.5);
            let radius = 7.0 * (level as f32).exp2();
            discs.push(Dot::new(x, y, radius));
            let [dx, dy] = [x, y].map(|v| f64::from(v) - 256.5);
            sum += 1.0 - dx.hypot(dy) / f64::from(radius);
        }
    }
    assert_eq!(discs.len(), 280);
    let settings = Settings { levels: LevelRule::Radius, ..settings(7) };
    let frame = drawn::<f32>([512, 512], &discs, &settings);
    assert_eq!(number(&frame, "gathered.count", pixel), 255.0);
    let weight = f64::from(number(&frame, "weight", pixel));
    assert!((weight - sum).abs() < 280.0 * f64::from(LEAST) * sum, "{weight} for {sum}");
    assert_eq!(color(&frame, pixel), [1.0; 3]);
}

#[test]
fn the_projection_keeps_its_thresholds() {
    let flat = |x, y| Dot::new(x, y, 0.25);
    let tally = |discs: &[Dot], cull| {
        let settings = Settings { cull, ..settings(3) };
        Drawing::new(&exact_scene(discs), &exact_camera([8, 4]), settings).define::<f32>()
    };
    // On an edge between pixels: the right one, the lower one. On the picture's: outside.
    let picture = tally(&[flat(3.0, 2.0), flat(0.0, 0.0)], false);
    assert_eq!(id(&picture.frame, "projection.id", [3, 2]), 0);
    assert_eq!(id(&picture.frame, "projection.id", [0, 0]), 1);
    let edges = [flat(8.0, 1.5), flat(1.5, 4.0), flat(-1e-30, 1.5), flat(1.5, -1e-30)];
    assert_eq!(tally(&edges, false).tally.outside, 4);
    // At the near plane: behind. Beyond it by the least step: seen.
    let near = exact_camera([8, 4]).near;
    let discs = [flat(1.5, 1.5).at_depth(near), flat(2.5, 1.5).at_depth(near.next_up())];
    let found = tally(&discs, false).tally;
    assert_eq!((found.behind, found.visible), (1, 1));
    // Edge-on: culled as a back face, else not reversed.
    let edge_on = Dot { normal: Vec3::X, ..flat(1.5, 1.5) };
    assert_eq!(tally(&[edge_on], true).tally.back_facing, 1);
    let picture = tally(&[edge_on, Dot { normal: Vec3::NEG_Z, ..flat(2.5, 1.5) }], false);
    let normals = [1, 2].map(|x| {
        let at = pixel(&picture.frame, [x, 1]);
        planes::value(&picture.frame, "projection.normal", at)
    });
    assert_eq!(normals, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    // The nearest; of equals the lower id.
    let at = |depth| flat(1.5, 1.5).at_depth(depth);
    for (depths, nearest) in [([5.0, 4.0, 4.0], 1), ([4.0, 4.0, 4.0], 0), ([5.0, 4.5, 4.0], 2)] {
        let picture = tally(&depths.map(at), false);
        assert_eq!(id(&picture.frame, "projection.id", [1, 1]), nearest);
        assert_eq!(picture.tally.visible, 3, "those behind it are drawn too");
    }
}
