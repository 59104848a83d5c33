//! The splats of a pixel are blended, as a shader for each pixel would do it.

use super::color::{decoded, encoded};
use super::project::Splat;
use super::{Bug, Habit, Shared};
use splatref::frame::{Frame, NO_ID, Plane, Samples};
use splatref::method::gaussians::{Order, Support};
use splatref::number::Vector3;
use splatref::scene::gaussians::Encoding;

/// A pixel.
#[derive(Clone, Copy, Debug)]
struct Pixel {
    color: [f32; 3],
    alpha: f32,
    through: f32,
    moment: f32,
    depth: f32,
    median: f32,
    id: u32,
    heaviest: u32,
    weight: f32,
    count: u8,
}

const EMPTY: Pixel = Pixel {
    color: [0.0; 3],
    alpha: 0.0,
    through: 1.0,
    moment: 0.0,
    depth: f32::INFINITY,
    median: f32::INFINITY,
    id: NO_ID,
    heaviest: NO_ID,
    weight: 0.0,
    count: 0,
};

/// A fragment that may be drawn.
struct Fragment<'s> {
    splat: &'s Splat,
    alpha: f32,
    depth: f32,
}

impl Shared<'_> {
    /// The picture, with the planes of all stages.
    pub(super) fn picture(&self) -> Frame<f32> {
        let splats = self.sorted();
        let [width, height] = self.size;
        let all = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let pixels: Vec<Pixel> = all().map(|at| self.pixel(&splats, at)).collect();
        let colors = all().zip(&pixels).map(|(at, pixel)| self.display(pixel, at)).collect();
        let covered = self.scene.environment.is_some();
        let opacities = all().zip(&pixels).map(|(at, pixel)| {
            if covered || self.opaque(at).is_some() { 1.0 } else { 1.0 - pixel.through }
        });
        let opacities = Samples::Scalar(self.plane(opacities.collect()));
        let expected = |pixel: &Pixel| match pixel.alpha > 0.0 {
            true => pixel.moment / pixel.alpha,
            false => f32::INFINITY,
        };
        let numbers = |of: &dyn Fn(&Pixel) -> f32| {
            Samples::Scalar(self.plane(pixels.iter().map(of).collect()))
        };
        let ids = |of: &dyn Fn(&Pixel) -> u32| {
            Samples::Index(self.plane(pixels.iter().map(of).collect()))
        };
        let planes = [
            ("blended", Samples::Color(self.plane(pixels.iter().map(|p| p.color).collect()))),
            ("T", numbers(&|pixel| pixel.through)),
            ("Z", numbers(&|pixel| pixel.depth)),
            ("Z.expected", numbers(&expected)),
            ("Z.median", numbers(&|pixel| pixel.median)),
            ("id", ids(&|pixel| pixel.id)),
            ("heaviest", ids(&|pixel| pixel.heaviest)),
            ("count", Samples::Count(self.plane(pixels.iter().map(|p| p.count).collect()))),
            ("", Samples::Color(self.plane(colors))),
            ("A", opacities),
        ];
        let mut frame = Frame::new(width, height);
        for (name, samples) in planes {
            frame.push(name, samples).unwrap();
        }
        frame
    }

    fn plane<T: Clone>(&self, values: Vec<T>) -> Plane<T> {
        let [width, height] = self.size;
        if !self.how.has(Bug::RowsFlipped) {
            return Plane::from_values(width, height, values);
        }
        let rows = values.chunks(width as usize).rev();
        Plane::from_values(width, height, rows.flatten().cloned().collect())
    }

    /// The splats from front to back.
    pub(super) fn sorted(&self) -> Vec<Splat> {
        let count = self.gaussians.len();
        let dispatched = match self.how.bug {
            Some(Bug::PaddingDrawn) => count.next_multiple_of(16),
            Some(Bug::LastMissing) => count - 1,
            _ => count,
        };
        let row = |i: usize| if i < count { i } else { 0 };
        let mut all: Vec<Splat> = (0..dispatched).filter_map(|i| self.project(row(i))).collect();
        if self.how.has(Bug::TiesReversed) {
            all.reverse();
        }
        if self.settings.order == Order::Steps {
            let keys = || all.iter().map(|splat| splat.key);
            let least = keys().fold(f32::INFINITY, |a, b| if b < a { b } else { a });
            let most = keys().fold(f32::NEG_INFINITY, |a, b| if b > a { b } else { a });
            let step = |key: f32| ((key - least) / (most - least) * 65_535.0).floor();
            all.iter_mut()
                .for_each(|splat| splat.key = if most > least { step(splat.key) } else { 0.0 });
        }
        if self.how.habit == Habit::SortedByBits {
            all.sort_by_key(|splat| ordered_bits(splat.key));
        } else {
            all.sort_by(|a, b| a.key.partial_cmp(&b.key).unwrap());
        }
        if self.how.has(Bug::BackToFront) {
            all.reverse();
        }
        all
    }

    /// Blends a pixel from front to back.
    fn pixel(&self, splats: &[Splat], at: (u32, u32)) -> Pixel {
        let mut fragments: Vec<_> =
            splats.iter().filter_map(|splat| self.fragment(splat, at)).collect();
        if self.settings.order == Order::Pixel {
            fragments.sort_by(|a, b| a.depth.partial_cmp(&b.depth).unwrap());
            if self.how.has(Bug::BackToFront) {
                fragments.reverse();
            }
        }
        let (mut pixel, stop) = (EMPTY, self.settings.stop);
        let ends = |through: f32| through < stop || (self.settings.stop_at && through <= stop);
        let mut drawn = 0;
        for one in &fragments {
            let left = match self.how.habit {
                Habit::ThroughLess => pixel.through - pixel.through * one.alpha,
                _ => pixel.through * (1.0 - one.alpha),
            };
            let stops = stop > 0.0 && ends(left);
            if stops && !self.how.has(Bug::StopAfter) {
                break;
            }
            self.add(&mut pixel, one, left);
            drawn += 1;
            if stops {
                break;
            }
        }
        if self.how.habit == Habit::Over {
            pixel.color = fragments[..drawn].iter().rev().fold([0.0; 3], |behind, one| {
                [0, 1, 2].map(|c| one.alpha * one.splat.color[c] + (1.0 - one.alpha) * behind[c])
            });
        }
        pixel
    }

    fn add(&self, pixel: &mut Pixel, one: &Fragment<'_>, left: f32) {
        let weight = match self.how.bug {
            Some(Bug::TransmittanceMissing) => one.alpha,
            _ => pixel.through * one.alpha,
        };
        let color = match self.how.bug {
            Some(Bug::PremultipliedTwice) => one.splat.color.map(|part| part * one.alpha),
            _ => one.splat.color,
        };
        pixel.color = [0, 1, 2].map(|c| self.add_product(pixel.color[c], weight, color[c]));
        pixel.alpha += weight;
        pixel.moment = self.add_product(pixel.moment, weight, one.depth);
        if pixel.through > 0.5 {
            pixel.median = one.depth;
        }
        if pixel.id == NO_ID {
            (pixel.id, pixel.depth) = (one.splat.index, one.depth);
        }
        if pixel.heaviest == NO_ID || weight > pixel.weight {
            (pixel.heaviest, pixel.weight) = (one.splat.index, weight);
        }
        pixel.count = pixel.count.saturating_add(1);
        pixel.through = left;
    }

    /// The fragment of a splat at a pixel, if it takes part.
    fn fragment<'s>(&self, splat: &'s Splat, at: (u32, u32)) -> Option<Fragment<'s>> {
        let [x, y] = [i64::from(at.0), i64::from(at.1)];
        let [x0, y0, x1, y1] = splat.bounds;
        if x < x0 || x >= x1 || y < y0 || y >= y1 {
            return None;
        }
        let half = if self.how.has(Bug::NoHalfPixel) { 0.0 } else { 0.5 };
        let dx = splat.center[0] - (at.0 as f32 + half);
        let dy = splat.center[1] - (at.1 as f32 + half);
        let met = match &splat.disc {
            Some(disc) => {
                let place = [at.0 as f32 + half, at.1 as f32 + half];
                Some(self.meet(disc, (splat.center, splat.depth), place)?)
            }
            None => None,
        };
        let power = met.map_or_else(|| self.power(splat.conic, dx, dy), |(rho, _)| 0.5 * rho);
        let k = self.settings.cutoff;
        if !(power >= 0.0) || self.settings.support == Support::Ellipse && power > (k * k) / 2.0 {
            return None;
        }
        let density = match met {
            Some(_) => self.exp_minus(power),
            None => self.density(splat.conic, dx, dy),
        };
        let (alpha, most) = (splat.alpha * density, self.settings.most_alpha);
        let alpha = if alpha > most { most } else { alpha };
        if alpha < self.settings.least_alpha {
            return None;
        }
        let depth = match (met, self.settings.order) {
            (Some((_, depth)), _) => depth,
            (None, Order::Pixel) => self.deepest(splat, at),
            _ => splat.depth,
        };
        let tested = !self.how.has(Bug::SurfaceNotTested);
        if tested && self.opaque(at).is_some_and(|(opaque, _)| depth > opaque) {
            return None;
        }
        Some(Fragment { splat, alpha, depth })
    }

    /// Depth and colour of the surface at a pixel.
    fn opaque(&self, (x, y): (u32, u32)) -> Option<(f32, [f32; 3])> {
        let surface = self.scene.surface.as_ref().filter(|_| !self.how.has(Bug::SurfaceIgnored))?;
        let [width, _] = self.size;
        let i = (y * width + x) as usize;
        let depth = surface.depths().values()[i];
        (depth != f32::INFINITY).then(|| (depth, surface.colors().values()[i]))
    }

    /// q/2.
    fn power(&self, [a, b, c]: [f32; 3], dx: f32, dy: f32) -> f32 {
        if self.how.habit == Habit::Cholesky {
            let l = [a.sqrt(), b / a.sqrt()];
            let rest = c - l[1] * l[1];
            let along = l[0] * dx + l[1] * dy;
            return 0.5 * (along * along + rest * (dy * dy));
        }
        let squares = self.add_product(a * (dx * dx), c, dy * dy);
        self.add_product(0.5 * squares, b, dx * dy)
    }

    /// exp(-q/2).
    fn density(&self, conic: [f32; 3], dx: f32, dy: f32) -> f32 {
        const LOG2_E: f32 = std::f32::consts::LOG2_E;
        if self.how.habit == Habit::ConicOfExp2 {
            let [a, b, c] = conic;
            let [a, b, c] = [-0.5 * LOG2_E * a, -LOG2_E * b, -0.5 * LOG2_E * c];
            return core_math::exp2f(a * (dx * dx) + c * (dy * dy) + b * (dx * dy));
        }
        self.exp_minus(self.power(conic, dx, dy))
    }

    /// exp(-q/2) of a q/2.
    fn exp_minus(&self, power: f32) -> f32 {
        if matches!(self.how.habit, Habit::Exp2 | Habit::ConicOfExp2) {
            return core_math::exp2f(-power * std::f32::consts::LOG2_E);
        }
        core_math::expf(if self.how.has(Bug::ExpWithoutHalf) { -2.0 * power } else { -power })
    }

    /// The depth of the greatest density along the ray of a pixel.
    fn deepest(&self, splat: &Splat, (x, y): (u32, u32)) -> f32 {
        let [fx, fy, cx, cy] = self.lens;
        let [u, v] = [(x as f32 + 0.5 - cx) / fx, (y as f32 + 0.5 - cy) / fy];
        let [px, py, t] = splat.place;
        let (d, m) = match self.perspective() {
            true => ([u, v, 1.0], splat.place),
            false => ([0.0, 0.0, 1.0], [px - u, py - v, t]),
        };
        let g = splat.inverse.map(|row| self.dot(row, d));
        let across = self.dot(g, d);
        let depth = self.dot(g, m) / across;
        if across > 0.0 && depth.is_finite() { depth } else { t }
    }

    /// What is seen: the layers before the environment, as linear light.
    fn display(&self, pixel: &Pixel, (x, y): (u32, u32)) -> [f32; 3] {
        let mut color = pixel.color;
        let seen = !self.how.has(Bug::SurfaceNotSeen);
        let opaque = self.opaque((x, y)).filter(|_| seen).map(|(_, color)| color);
        let environment = self.scene.environment.as_ref();
        let around = || environment.map(|environment| environment.radiance(self.ray(x, y)));
        if let Some(light) = opaque.or_else(around) {
            let light = if self.space == Encoding::Srgb { light.map(encoded) } else { light };
            let times = if self.how.has(Bug::BackgroundTwice) { 2.0 } else { 1.0 };
            let through = match self.how.bug {
                Some(Bug::SurfaceWhole) if opaque.is_some() => 1.0,
                _ => pixel.through,
            };
            color = [0, 1, 2].map(|c| color[c] + times * through * light[c]);
        }
        let coded = self.space == Encoding::Srgb && !self.how.has(Bug::PictureNotDecoded);
        if coded { color.map(decoded) } else { color }
    }

    /// The ray of a pixel in the world.
    fn ray(&self, x: u32, y: u32) -> Vector3<f32> {
        let [fx, fy, cx, cy] = self.lens;
        let [u, v] = match self.perspective() {
            true => [((x as f32 + 0.5) - cx) / fx, ((y as f32 + 0.5) - cy) / fy],
            false => [0.0, 0.0],
        };
        let [a, b, c] = self.frame;
        let column = |i: usize| (a[i] * u + b[i] * v) + c[i];
        Vector3::new(column(0), column(1), column(2))
    }
}

/// Bits that ascend as the numbers do.
fn ordered_bits(value: f32) -> u32 {
    let bits = (value + 0.0).to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}
