//! One disc alone: which of its pixels find it, under each rule of levels.

use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::scene::{discs, scene, straight, surfels};
use crate::oracle::template::known::id;
use crate::oracle::template::model::{Center, Template};
use crate::oracle::template::stages::grid;
use glam::Vec3;
use splatref::frame::NO_ID;
use splatref::method::template::{Falloff, LevelRule, Settings};
use splatref::scene::{Camera, Projection, Scene};

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
    let radius = radius * far / (camera.fx * camera.fy).sqrt();
    (scene(surfels(discs([(Vec3::new(x, y, -t), normal, radius)]))), camera)
}

/// The least level at which so many cells reach as far as the radius, but not beyond the top.
fn level(template: &Template<24>, cells: f64, radius: f64) -> usize {
    (0..template.top()).find(|l| radius <= cells * (*l as f64).exp2()).unwrap_or(template.top())
}

/// What a disc does to a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Reach {
    Outside,
    Missed,
    Found,
    /// Rounding decides whether it is inside.
    Open,
}

/// What a disc that stays at a level does to every pixel, row by row; `own`: where it was projected
/// to.
fn seen(template: &Template<24>, disc: &Center, own: [u32; 2], level: usize) -> Vec<Reach> {
    let [width, height] = template.sizes[0];
    let cell = own.map(|v| v >> level);
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
    let one = |pixel| match template.weight(disc, pixel, level == 0 && own == pixel) {
        Err(()) => Reach::Open,
        Ok(None) => Reach::Outside,
        Ok(Some(_)) if template.finds(level, cell, pixel) => Reach::Found,
        Ok(Some(_)) => Reach::Missed,
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
    fn add(&mut self, all: &[Reach]) {
        let count = |seen| all.iter().filter(|s| **s == seen).count() as f64;
        let [missed, found] = [Reach::Missed, Reach::Found].map(count);
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

/// Under each rule a disc paints exactly those of its pixels that find it: all of them under
/// `Covering`.
#[test]
#[ignore = "slow: .ci/run runs it"]
fn a_disc_alone_paints_the_pixels_that_find_it() {
    let mut dice = Dice(2008);
    let mut losses = [[Losses::default(); 3]; 3];
    let (mut open, mut pixels) = (0, 0);
    for _ in 0..250 {
        let (scene, camera) = single(&mut dice);
        let shape = [camera.width, camera.height];
        for (i, k) in [3_u32, 5, 7].into_iter().enumerate() {
            let k_cells = f64::from(k);
            let rules = [
                (LevelRule::Radius, k_cells),
                (LevelRule::Diameter, k_cells / 2.0),
                (LevelRule::Covering, (k_cells - 1.0) / 2.0),
            ];
            for (rule, (levels, reach)) in rules.into_iter().enumerate() {
                let settings = Settings { size: k, levels, falloff: Falloff::Linear, cull: false };
                let frame = Drawing::new(&scene, &camera, settings).frame::<f32>();
                let template = Template::new(settings, shape);
                let sample = grid(&frame, 0, shape);
                let Some(own) = sample.positions().find(|[x, y]| sample.at(*x, *y).is_some())
                else {
                    continue;
                };
                let disc = sample.at(own[0], own[1]).expect("found");
                let all = seen(&template, disc, own, level(&template, reach, disc.extent));
                for (pixel, seen) in sample.positions().zip(&all) {
                    let painted = id(&frame, "id", pixel) != NO_ID;
                    let expected = *seen == Reach::Found;
                    assert!(
                        *seen == Reach::Open || painted == expected,
                        "{pixel:?} of {disc:?}, {settings:?}: {seen:?}"
                    );
                }
                open += all.iter().filter(|seen| **seen == Reach::Open).count();
                pixels += all.iter().filter(|seen| **seen == Reach::Found).count();
                losses[rule][i].add(&all);
            }
        }
    }
    report(&losses);
    assert!(open * 10_000 < pixels, "{open} of {pixels} pixels are rounding's");
    let [radius, diameter, covering] = &losses;
    for (i, radius) in radius.iter().enumerate() {
        // A radius is up to k cells of its level, of which (k - 1)/2 are found for sure.
        assert!((0.05..0.15).contains(&radius.mean()), "{radius:?}");
        assert!((0.6..0.75).contains(&radius.worst), "{radius:?}");
        // Half a cell is missing there, and only to discs that nearly fill their level.
        let diameter = &diameter[i];
        assert!(diameter.mean() > 0.0 && diameter.mean() < 0.005, "{diameter:?}");
        assert!((0.03..0.15).contains(&diameter.worst), "{diameter:?}");
        assert!(covering[i].discs > 100.0 && covering[i].worst == 0.0, "{covering:?}");
    }
    let falls = |all: [f64; 3]| all[0] > all[1] && all[1] > all[2];
    assert!(falls(radius.map(|l| l.mean())) && falls(diameter.map(|l| l.mean())));
}

/// Prints the summary.
fn report(losses: &[[Losses; 3]; 3]) {
    for (name, losses) in ["radius", "diameter", "covering"].into_iter().zip(losses) {
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
