//! What the pull-push pyramid must keep, whatever the scene.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::planes::{pixels, value};
use crate::oracle::kit::scene::{ahead, discs, surfels};
use crate::oracle::pyramid::cases;
use crate::oracle::pyramid::model::{Cell, Level, occluded};
use glam::Vec3;
use splatref::frame::Frame;
use splatref::method::pyramid::{Settings, Weights};
use splatref::number::Exact;
use splatref::scene::{Camera, Cloud, Lens, Scene};

/// A surfel: position, normal, radius, colour.
pub(crate) type Colored = (Vec3, Vec3, f32, Vec3);

/// An unlit scene of discs.
pub(crate) fn scene(all: &[Colored]) -> Scene {
    let cloud = discs(all.iter().map(|(p, n, r, _)| (*p, *n, *r)));
    let color = Some(all.iter().map(|d| d.3).collect());
    crate::oracle::kit::scene::scene(surfels(Cloud { color, ..cloud }))
}

/// Orthographic, one pixel a unit: the point (x, y, -t) is at (width/2 + x, height/2 - y).
pub(crate) fn plan([width, height]: [u32; 2]) -> Camera {
    ahead(Lens::Orthographic(height.into()), [width, height])
}

pub(crate) fn render<R: Exact>(scene: &Scene, camera: &Camera, settings: &Settings) -> Frame<R> {
    Drawing::new(scene, camera, *settings).frame()
}

pub(crate) fn filled<R: Exact>(frame: &Frame<R>) -> Vec<usize> {
    pixels(frame).filter(|i| value(frame, "kind", *i)[0] != 0.0).collect()
}

/// The sizes of all levels.
fn sizes([width, height]: [u32; 2]) -> Vec<[u32; 2]> {
    let half = |size: &[u32; 2]| (*size != [1, 1]).then(|| size.map(|s| s.div_ceil(2)));
    std::iter::successors(Some([width, height]), half).collect()
}

/// What the pull and the push phase left, the finest level first; the coarsest is not pushed.
fn levels<R: Exact>(frame: &Frame<R>) -> (Vec<Level>, Vec<Level>) {
    let sizes = sizes([frame.width, frame.height]);
    let mut pulls = vec![Level::projected(frame)];
    for (l, size) in sizes.iter().enumerate().skip(1) {
        pulls.push(Level::read(frame, &format!("pull{l:02}"), *size));
    }
    let finer = sizes.iter().enumerate().take(sizes.len() - 1);
    let pushes = finer.map(|(l, size)| Level::read(frame, &format!("push{l:02}"), *size));
    (pulls, pushes.collect())
}

/// All surfels with one normal, colour and radius: that is what every pixel has, exactly.
#[test]
fn pyramid_reproduces_a_constant() {
    fn check<R: Exact>(number: usize) {
        let mut dice = Dice(number as u64 * 77 + 5);
        let size = cases::SIZES[number % 6];
        let mut camera = cases::camera(&mut dice, true, size);
        camera.cx += dice.within(-0.25, 0.25);
        let normal = (dice.direction() + Vec3::Z * 1.5).normalize();
        let (radius, color) = (dice.within(0.25, 3.0), dice.vector(Vec3::ZERO, Vec3::ONE));
        let count = 1 + dice.below(60);
        let place =
            |dice: &mut Dice| dice.vector(Vec3::new(-4.0, -3.0, -5.0), Vec3::new(4.0, 3.0, -2.0));
        let discs: Vec<_> = (0..count).map(|_| (place(&mut dice), normal, radius, color)).collect();
        let mut scene = scene(&discs);
        // With light too, normals come out; ambient light alone leaves the colour in proportion.
        scene.lights = vec![splatref::scene::Light::DEFAULT];
        let frame: Frame<R> = render(&scene, &camera, &cases::settings(number % 4));
        let (pulls, pushes) = levels(&frame);
        let cells = || pulls.iter().chain(&pushes).flat_map(|level| &level.cells);
        let valid: Vec<&Cell> = cells().filter(|c| c.kind != 0).collect();
        let Some(first) = valid.first() else { return };
        for cell in &valid {
            assert_eq!(cell.color, color.to_array().map(f64::from), "colour in {number}");
            assert_eq!((cell.normal, cell.radius), (first.normal, first.radius), "in {number}");
        }
        let pixels = filled(&frame);
        let bits = |i: &usize| value(&frame, "normal", *i).map(f64::to_bits);
        assert!(pixels.iter().all(|i| bits(i) == bits(&pixels[0])), "normal in {number}");
        scene.lights.clear();
        let frame: Frame<R> = render(&scene, &camera, &cases::settings(number % 4));
        for i in filled(&frame) {
            assert_eq!(value(&frame, "", i), color.to_array().map(f64::from), "in {number}");
        }
    }
    for number in 0..120 {
        check::<f32>(number);
        check::<f64>(number);
    }
}

/// A cell that has something and is not occluded leaves the push phase as it came, bit for bit.
#[test]
fn pyramid_push_leaves_what_is_seen() {
    let (mut kept, mut changed) = (0, 0);
    for case in cases::all().iter().step_by(3) {
        let Case { settings, name, .. } = case;
        let frame = case.drawing().frame::<f32>();
        let (pulls, mut pushes) = levels(&frame);
        // The coarsest level is its own result.
        pushes.push(Level { size: [1, 1], cells: pulls[pulls.len() - 1].cells.clone() });
        for l in 0..pulls.len() - 1 {
            let [width, height] = pulls[l].size.map(i64::from);
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                let (before, after) = (pulls[l].at(x, y), pushes[l].at(x, y));
                let hidden = occluded(&before, &pushes[l + 1].at(x / 2, y / 2), settings.occlusion);
                if before.kind != 0 && !hidden {
                    assert_eq!(before, after, "level {l} ({x}, {y}) of {name}");
                    kept += 1;
                } else {
                    assert!(before.kind == 0 || after.kind != 0, "nothing vanishes: {name}");
                    changed += usize::from(before != after);
                }
            }
        }
    }
    println!("{kept} cells kept, {changed} computed again");
    assert!(kept > 5_000 && changed > 10_000, "{kept} kept, {changed} computed again");
}

/// A full picture of one surface: every level is the plain mean of four, and nothing is computed
/// again.
#[test]
fn pyramid_of_a_full_picture_is_its_mean() {
    for (number, size) in [[16, 16], [32, 8], [1, 16], [64, 64]].into_iter().enumerate() {
        let mut dice = Dice(number as u64 + 9);
        let mut discs = Vec::new();
        for i in 0..size[0] * size[1] {
            let (x, y) = ((i % size[0]) as f32 + 0.5, (i / size[0]) as f32 + 0.5);
            let (x, y) = (x - size[0] as f32 / 2.0, size[1] as f32 / 2.0 - y);
            let depth = dice.within(10.0, 12.0);
            let normal = (dice.direction() + Vec3::Z * 2.0).normalize();
            let radius = dice.within(1000.0, 2000.0);
            let color = dice.vector(Vec3::ZERO, Vec3::ONE);
            discs.push((Vec3::new(x, y, -depth), normal, radius, color));
        }
        for weights in [Weights::Box, Weights::Gaussian] {
            let settings = Settings { weights, ..Settings::default() };
            let frame: Frame<f32> = render(&scene(&discs), &plan(size), &settings);
            let (pulls, pushes) = levels(&frame);
            for (l, push) in pushes.iter().enumerate() {
                assert_eq!(push.cells, pulls[l].cells, "level {l} of {size:?} is as it was");
            }
            for l in 1..pulls.len() {
                let [width, height] = pulls[l].size.map(i64::from);
                for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                    mean_of_four(&pulls[l - 1], &pulls[l].at(x, y), (x, y), size);
                }
            }
        }
    }
}

/// A cell against the mean of those four, or two in a picture of one column, in `f32`.
fn mean_of_four(fine: &Level, cell: &Cell, (x, y): (i64, i64), size: [u32; 2]) {
    let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| fine.at(2 * x + i, 2 * y + j));
    let there = four.map(|c| f32::from(u8::from(c.kind != 0)));
    let count: f32 = there.iter().sum();
    assert!(count == 4.0 || (count == 2.0 && size.iter().zip(fine.size).any(|(_, f)| f == 1)));
    let mean = |of: &dyn Fn(&Cell) -> f64| {
        let a = four.map(|c| of(&c) as f32);
        f64::from(((a[0] + a[1]) + (a[2] + a[3])) / count)
    };
    for i in 0..3 {
        assert_eq!(cell.normal[i], mean(&|c| c.normal[i]));
        assert_eq!(cell.color[i], mean(&|c| c.color[i]));
    }
    assert_eq!(cell.radius, mean(&|c| c.radius));
    let those = || four.iter().filter(|c| c.kind != 0);
    assert_eq!(cell.front, those().map(|c| c.front).fold(f64::INFINITY, f64::min));
    assert_eq!(cell.back, those().map(|c| c.back).fold(0.0, f64::max));
    // Where all four are, the offsets to the middle cancel.
    if size[0] == size[1] {
        assert_eq!(cell.displacement, [0.0; 2]);
    }
}

/// What cannot be seen leaves no trace in any level.
#[test]
fn pyramid_of_nothing_is_empty() {
    let size = [13, 9];
    let away = [
        (Vec3::new(0.0, 0.0, 3.0), Vec3::Z),
        (Vec3::new(-500.0, 0.0, -3.0), Vec3::Z),
        (Vec3::new(0.0, 4.75, -3.0), Vec3::Z),
        (Vec3::new(6.5, 0.0, -3.0), Vec3::Z),
        (Vec3::new(0.0, 0.0, -3.0), -Vec3::Z),
    ];
    let discs = away.map(|(p, n)| (p, n, 1e6, Vec3::ONE));
    for number in 0..4 {
        let settings = Settings { cull: true, ..cases::settings(number) };
        let frame: Frame<f32> = render(&scene(&discs), &plan(size), &settings);
        let (pulls, pushes) = levels(&frame);
        for level in pulls.iter().chain(&pushes) {
            assert!(level.cells.iter().all(|c| *c == Cell::EMPTY), "{:?}", level.size);
        }
        assert!(filled(&frame).is_empty());
        // Without culling the last one is seen, and fills the picture.
        let settings = Settings { cull: false, ..settings };
        let frame: Frame<f32> = render(&scene(&discs), &plan(size), &settings);
        assert_eq!(filled(&frame).len(), 13 * 9, "{settings:?}");
    }
}
