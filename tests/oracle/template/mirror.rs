//! What becomes of a picture when its scene is mirrored.
//!
//! One disc mirrors bit for bit. Of several neither is true: their sums are added in another order,
//! so that rounding differs, and the ternary test depends on which is found first, so that a pixel
//! can even show other discs. That is the documented order, and the paper's method.

use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::number::Num;
use crate::oracle::kit::planes::value;
use crate::oracle::template::cases::{Dot, exact_camera, exact_scene};
use crate::oracle::template::known::{id, number};
use crate::oracle::template::stages::all_settings;
use glam::Vec3;
use splatref::frame::{Frame, NO_ID};
use splatref::method::template::{Falloff, LevelRule, Settings};

/// Left and right exchanged (0), or top and bottom (1).
const AXES: [usize; 2] = [0, 1];

fn drawn(size: [u32; 2], discs: &[Dot], settings: &Settings) -> Frame<f32> {
    Drawing::new(&exact_scene(discs), &exact_camera(size), *settings).frame()
}

fn mirrored(size: [u32; 2], discs: &[Dot], axis: usize) -> Vec<Dot> {
    let mirror = |disc: &Dot| {
        let mut other = *disc;
        other.place[axis] = size[axis] as f32 - disc.place[axis];
        other.normal[axis] = -disc.normal[axis];
        other
    };
    discs.iter().map(mirror).collect()
}

/// Pairs of pixels that show the same.
fn pairs(size: [u32; 2], axis: usize) -> impl Iterator<Item = [[u32; 2]; 2]> {
    (0..size[1]).flat_map(move |y| (0..size[0]).map(move |x| [x, y])).map(move |pixel| {
        let mut other = pixel;
        other[axis] = size[axis] - 1 - pixel[axis];
        [pixel, other]
    })
}

fn disc(dice: &mut Dice, size: [u32; 2], radius: f32) -> Dot {
    // Not on an edge between pixels: that belongs to one of them.
    let [x, y] = size.map(|side| dice.below(32 * side as usize) as f32 / 32.0 + 1.0 / 64.0);
    let normal = if dice.below(2) == 0 { Vec3::Z } else { dice.direction() };
    let color = dice.vector(Vec3::ZERO, Vec3::ONE);
    Dot { normal, color, ..Dot::new(x, y, radius) }
}

#[test]
fn one_disc_mirrors_bit_for_bit() {
    let mut dice = Dice(5);
    for number in 0..200 {
        let size = [[16, 16], [64, 32], [13, 9]][number % 3];
        let radius = 0.25 * 64.0_f32.powf(dice.within(0.0, 1.0));
        let disc = disc(&mut dice, size, radius);
        for settings in all_settings(false) {
            // Where the level cuts a disc it is by cells, and only those of a power of two mirror.
            if size == [13, 9] && settings.levels != LevelRule::Covering {
                continue;
            }
            for axis in AXES {
                let frames =
                    [vec![disc], mirrored(size, &[disc], axis)].map(|d| drawn(size, &d, &settings));
                for pair in pairs(size, axis) {
                    let [a, b] = [0, 1].map(|i| {
                        let [x, y] = pair[i];
                        let at = |name| value(&frames[i], name, (y * size[0] + x) as usize);
                        let mut normal = at("normal");
                        normal[axis] *= [1.0, -1.0][i];
                        (at(""), at("Z"), at("weight"), at("id"), normal)
                    });
                    assert_eq!(a, b, "{pair:?} of {disc:?} in {size:?}, {settings:?}");
                }
            }
        }
    }
}

/// Discs of one surface: all depths within the sums of radii. Not all rims agree, because the mean
/// of three places rounds; all sums agree as far as sums of so many numbers round.
#[test]
fn a_surface_mirrors_up_to_rounding_and_not_bit_for_bit() {
    let (mut dice, size) = (Dice(6), [32, 32]);
    let (mut same, mut rounded, mut rims, mut worst) = (0, 0, 0, 0.0_f64);
    for _ in 0..20 {
        let discs: Vec<Dot> = (0..150)
            .map(|_| {
                let radius = [1.5, 2.5, 5.0][dice.below(3)];
                let depth = dice.within(4.0, 6.0);
                let disc = disc(&mut dice, size, radius);
                Dot { normal: Vec3::Z, ..disc }.at_depth(depth)
            })
            .collect();
        for settings in all_settings(false) {
            for axis in AXES {
                let frames = [drawn(size, &discs, &settings), {
                    drawn(size, &mirrored(size, &discs, axis), &settings)
                }];
                for [pixel, other] in pairs(size, axis) {
                    let all =
                        |name| [number(&frames[0], name, pixel), number(&frames[1], name, other)];
                    let [count, other_count] = all("gathered.count");
                    if count != other_count {
                        rims += 1;
                        continue;
                    }
                    for name in ["gathered.weight", "gathered.depths"] {
                        let [a, b] = all(name).map(f64::from);
                        same += usize::from(a == b);
                        rounded += usize::from(a != b);
                        // Falloff near the rim are differences of numbers near 1.
                        let terms =
                            f64::from(count) * if name == "gathered.depths" { 6.0 } else { 1.0 };
                        let units = (a - b).abs() / (Num::<24>::unit() * terms.max(1.0));
                        worst = worst.max(units);
                    }
                }
            }
        }
    }
    println!(
        "{same} sums mirror exactly, {rounded} up to {worst:.1} roundings a term; {rims} rims"
    );
    assert!(rounded > 1000 && same > 10_000, "{same} {rounded}");
    assert!(worst < 32.0 && rims * 1000 < same, "{worst} {rims}");
}

/// Three discs, each within the sum of radii of its neighbour in depth, the first and the last not:
/// from the left the last is behind the first; from the right the front comes nearer by and by.
#[test]
fn the_ternary_test_does_not_mirror() {
    let row = [(7.5, 4.0), (8.5, 5.75), (9.5, 7.5)];
    let discs = row.map(|(x, depth)| Dot::new(x, 8.5, 1.0).at_depth(depth));
    let upright = discs.map(|d| Dot { place: [d.place[1], d.place[0]], ..d });
    for settings in all_settings(false) {
        for (axis, discs) in [discs, upright].into_iter().enumerate() {
            let frame = drawn([16, 16], &discs, &settings);
            let other = drawn([16, 16], &mirrored([16, 16], &discs, axis), &settings);
            let (middle, mut opposite) = ([8, 8], [8, 8]);
            opposite[axis] = 7;
            let count = |frame, pixel| number(frame, "gathered.count", pixel);
            assert_eq!((count(&frame, middle), count(&other, opposite)), (2.0, 3.0));
            assert_eq!((id(&frame, "id", middle), id(&other, "id", opposite)), (0, 0));
        }
    }
}

#[test]
fn cells_mirror_for_powers_of_two_only() {
    let discs = [Dot::new(1.5, 4.5, 3.0), Dot::new(2.5, 4.5, 3.0)];
    let settings =
        Settings { size: 3, levels: LevelRule::Covering, falloff: Falloff::Linear, cull: false };
    for (width, merged) in [(16, 0), (13, 1)] {
        let size = [width, 16];
        let frame = drawn(size, &mirrored(size, &discs, 0), &settings);
        let centers = (0..width).filter(|x| id(&frame, "level01.id", [*x, 2]) != NO_ID).count();
        assert_eq!(centers, 2 - merged, "{width}");
        let frame = drawn(size, &discs, &settings);
        let centers = (0..width).filter(|x| id(&frame, "level01.id", [*x, 2]) != NO_ID).count();
        assert_eq!(centers, 2, "{width}");
    }
}
