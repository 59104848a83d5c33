//! One disc alone: which of its pixels find it, under either rule of levels.

use crate::ewa::cases::{Dice, straight};
use crate::kit::tolerance::Arithmetic;
use crate::template::cases::scene;
use crate::template::known::id;
use crate::template::model::{Cell, Template};
use crate::template::stages::{GUARD, grid, unit};
use glam::Vec3;
use splatref::frame::{Exec, NO_ID};
use splatref::method::template::{self, LevelRule, Settings};
use splatref::scene::{Camera, Cloud, Projection, Scene, Surfels};

const SIZES: [[u32; 2]; 8] =
    [[16, 16], [31, 33], [64, 48], [1, 7], [97, 61], [128, 128], [200, 3], [255, 129]];

/// One disc somewhere in a picture, of 0.1 to 200 pixels, at any angle.
fn single(dice: &mut Dice) -> (Scene, Camera) {
    let size = SIZES[dice.below(SIZES.len())];
    let mut camera = straight(dice.below(2) == 0, size);
    (camera.cx, camera.cy) = (size[0] as f32 / 2.0, size[1] as f32 / 2.0);
    let [x, y] = size.map(|side| dice.within(0.0, side as f32));
    let radius = 0.1 * 2000.0_f32.powf(dice.within(0.0, 1.0));
    let t = dice.within(1.0, 9.0);
    let far = if camera.projection == Projection::Perspective { t } else { 1.0 };
    let normal = match dice.below(3) {
        0 => Vec3::Z,
        1 => (dice.direction() + 2.0 * Vec3::Z).normalize(),
        _ => dice.direction(),
    };
    let [x, y] = [(x - camera.cx) / camera.fx * far, (camera.cy - y) / camera.fy * far];
    let cloud = Cloud {
        position: vec![Vec3::new(x, y, -t)],
        normal: Some(vec![normal]),
        radius: Some(vec![radius * far / (camera.fx * camera.fy).sqrt()]),
        color: None,
        ..Cloud::default()
    };
    let scene = scene(Surfels::new(cloud).expect("a good surfel").0, Vec::new());
    (scene, camera)
}

/// The least level at which so many cells reach as far as the radius, but not beyond the top.
fn level(template: &Template, cells: f64, radius: f64) -> usize {
    (0..template.top()).find(|l| radius <= cells * (*l as f64).exp2()).unwrap_or(template.top())
}

/// What a disc does to a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Seen {
    Outside,
    Missed,
    Found,
    /// Rounding decides whether it is inside.
    Open,
}

/// What a disc that stays at a level does to every pixel, row by row; `own`: where it was projected
/// to.
fn seen(template: &Template, disc: &Cell, own: [u32; 2], level: usize) -> Vec<Seen> {
    let [width, height] = template.sizes[0];
    let cell = own.map(|v| v >> level);
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let one = |pixel| match template.weight(disc, pixel, level == 0 && own == pixel) {
        Err(()) => Seen::Open,
        Ok(None) => Seen::Outside,
        Ok(Some(_)) if template.finds(level, cell, pixel) => Seen::Found,
        Ok(Some(_)) => Seen::Missed,
    };
    pixels.map(one).collect()
}

/// What the discs of a template lose, as shares of their pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Losses {
    discs: f64,
    cut: f64,
    sum: f64,
    worst: f64,
}

impl Losses {
    fn add(&mut self, all: &[Seen]) {
        let count = |seen| all.iter().filter(|s| **s == seen).count() as f64;
        let [missed, found] = [Seen::Missed, Seen::Found].map(count);
        if missed + found > 0.0 {
            let lost = missed / (missed + found);
            self.discs += 1.0;
            self.cut += f64::from(u8::from(lost > 0.0));
            self.sum += lost;
            self.worst = self.worst.max(lost);
        }
    }

    fn mean(&self) -> f64 {
        self.sum / self.discs
    }
}

/// Under `Covering` a disc paints exactly the pixels that it holds. Under `Published` exactly those
/// are missing that do not find it; and if D of \[MOC08, eq. 1\] were the diameter, fewer would be.
#[test]
fn a_disc_alone_paints_the_pixels_that_find_it() {
    let mut dice = Dice(2008);
    let exec = Exec::sequential();
    let mut published = [Losses::default(); 3];
    let mut diameter = [Losses::default(); 3];
    let (mut open, mut pixels) = (0, 0);
    for _ in 0..250 {
        let (scene, camera) = single(&mut dice);
        for (i, size) in [3, 5, 7].into_iter().enumerate() {
            for levels in [LevelRule::Covering, LevelRule::Published] {
                let settings = Settings { size, levels, cull: false };
                let picture = template::render::<f32>(&scene, &camera, &settings, &exec, true);
                let frame = picture.expect("renders").frame;
                let shape = [camera.width, camera.height];
                let template = Template::new(settings, shape, unit(Arithmetic::F32) * GUARD);
                let sample = grid(&frame, 0, shape);
                let Some(own) = sample.positions().find(|[x, y]| sample.at(*x, *y).is_some())
                else {
                    continue;
                };
                let disc = sample.at(own[0], own[1]).expect("found");
                let k = f64::from(size);
                let reach = match levels {
                    LevelRule::Covering => (k - 1.0) / 2.0,
                    LevelRule::Published => k,
                };

                let all = seen(&template, disc, own, level(&template, reach, disc.extent));
                for (pixel, seen) in sample.positions().zip(&all) {
                    let painted = id(&frame, "id", pixel) != NO_ID;
                    let expected = *seen == Seen::Found;
                    assert!(
                        *seen == Seen::Open || painted == expected,
                        "{pixel:?} of {disc:?}, {settings:?}: {seen:?}"
                    );
                }
                open += all.iter().filter(|seen| **seen == Seen::Open).count();
                pixels += all.iter().filter(|seen| **seen == Seen::Found).count();
                if levels == LevelRule::Covering {
                    assert!(!all.contains(&Seen::Missed), "{disc:?}, {settings:?}: cut");
                } else {
                    published[i].add(&all);
                    let least = level(&template, k / 2.0, disc.extent);
                    diameter[i].add(&seen(&template, disc, own, least));
                }
            }
        }
    }
    report(&published, &diameter);
    assert!(open * 10_000 < pixels, "{open} of {pixels} pixels are rounding's");
    for (published, diameter) in published.iter().zip(&diameter) {
        // A radius is up to k cells of its level, of which (k - 1)/2 are found for sure.
        assert!((0.05..0.15).contains(&published.mean()), "{published:?}");
        assert!((0.6..0.75).contains(&published.worst), "{published:?}");
        // Half a cell is missing there, and only to discs that nearly fill their level.
        assert!(diameter.mean() > 0.0 && diameter.mean() < 0.005, "{diameter:?}");
        assert!((0.03..0.15).contains(&diameter.worst), "{diameter:?}");
    }
    let falls = |all: [f64; 3]| all[0] > all[1] && all[1] > all[2];
    assert!(falls(published.map(|l| l.mean())) && falls(diameter.map(|l| l.mean())));
}

/// Prints the summary.
fn report(published: &[Losses; 3], diameter: &[Losses; 3]) {
    for (name, losses) in [("D = rho", published), ("D = 2 rho", diameter)] {
        for (k, losses) in [3, 5, 7].into_iter().zip(losses) {
            let Losses { discs, cut, worst, .. } = losses;
            let [mean, cut, worst] = [losses.mean(), cut / discs, *worst].map(|v| 100.0 * v);
            println!(
                "{name}, k = {k}: {mean:.1} % of a disc's pixels lost on average, {worst:.1} % at \
                 worst; {cut:.1} % of {discs} discs are cut"
            );
        }
    }
}
