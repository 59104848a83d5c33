//! An environment and what a thin sheet of glass makes of it, by angles and std's functions.

use crate::oracle::kit::condition::Conditioned;
use crate::oracle::kit::eye::{Eye, V3, cross, dot, scaled, sub, unit};
use crate::oracle::transparent::model::{Near, Truth};
use splatref::scene::Environment;
use splatref::scene::environment::Map;
use splatref::shade::optics::{BendingLayers, Refraction};
use std::f64::consts::PI;

/// Light from a direction, and its change with the rounding of the direction and of what the lookup
/// computes on the way; with a step of 0 the light alone.
pub(crate) fn radiance(environment: &Environment, direction: V3, step: f64) -> [Conditioned; 3] {
    let d = unit(direction);
    let (look, own): (Box<dyn Fn(V3) -> V3 + '_>, V3) = match environment {
        Environment::Sky => (Box::new(sky), pattern_rounding(d, step)),
        Environment::Map(map) => (Box::new(|d| lookup(map, d, 0.0)), {
            // A column and a row are numbers up to the width.
            let shift = step * f64::from(map.pixels().width());
            sub(lookup(map, d, shift), lookup(map, d, 0.0)).map(f64::abs)
        }),
    };
    let value = look(d);
    if step == 0.0 {
        return value.map(Conditioned::exact);
    }
    let mut condition = own;
    for axis in 0..3 {
        let mut moved = d;
        moved[axis] += step;
        for (sum, change) in condition.iter_mut().zip(sub(look(moved), value)) {
            *sum += change.abs();
        }
    }
    [0, 1, 2].map(|c| Conditioned { value: value[c], condition: condition[c] + step * value[c] })
}

/// Bilinear lookup by longitude and polar angle; columns and rows moved by `shift`.
fn lookup(map: &Map, d: V3, shift: f64) -> V3 {
    let (width, height) = (i64::from(map.pixels().width()), i64::from(map.pixels().height()));
    let longitude = d[0].atan2(-d[2]);
    let polar = d[0].hypot(d[2]).atan2(d[1]);
    let s = longitude / (2.0 * PI) * width as f64 - 0.5 + shift;
    let t = polar / PI * height as f64 - 0.5 + shift;
    let (i, j) = (s.floor() as i64, t.floor() as i64);
    let pixel = |i: i64, j: i64| {
        let (x, y) = (i.rem_euclid(width), j.clamp(0, height - 1));
        map.pixels().at(x as u32, y as u32).map(f64::from)
    };
    let (f, g) = (s - s.floor(), t - t.floor());
    let mut light = [0.0; 3];
    for (di, dj, part) in
        [(0, 0, (1.0 - f) * (1.0 - g)), (1, 0, f * (1.0 - g)), (0, 1, (1.0 - f) * g), (1, 1, f * g)]
    {
        let color = pixel(i + di, j + dj);
        (0..3).for_each(|c| light[c] += part * color[c]);
    }
    light
}

/// A ramp with level ends.
fn ramp(a: f64) -> f64 {
    let a = a.clamp(0.0, 1.0);
    3.0 * a * a - 2.0 * a * a * a
}

/// The sky of the documentation, its rings as cosines.
fn sky(d: V3) -> V3 {
    let ring = |a: f64| (32.0 * a.clamp(-1.0, 1.0).acos()).cos();
    let pattern = 1.0 + 0.5 * ring(d[0]) * ring(d[1]) * ring(d[2]);
    let base = ground_and_sky(d[1]);
    let k = dot(d, [-2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0]).max(0.0);
    let sun = ramp((k - (1.0 - 1.0 / 1024.0)) * 2048.0);
    let (disc, glow) = ([24.0, 20.0, 16.0], [0.75, 0.625, 0.375]);
    [0, 1, 2].map(|c| base[c] * pattern + disc[c] * sun + glow[c] * k.powi(32))
}

fn ground_and_sky(y: f64) -> V3 {
    let (zenith, horizon) = ([0.125, 0.25, 0.625], [0.75, 0.8125, 0.875]);
    let ground = [0.1875, 0.15625, 0.125];
    let fade = (1.0 - y).min(1.0).powi(4);
    let above = ramp(8.0 * y + 0.5);
    [0, 1, 2].map(|c| {
        let sky = zenith[c] * (1.0 - fade) + horizon[c] * fade;
        ground[c] * (1.0 - above) + sky * above
    })
}

/// What rounding does to the rings, each five doublings of an angle: an error quadruples where the
/// cosine is 1.
fn pattern_rounding(d: V3, step: f64) -> V3 {
    let rings = d.map(|a| {
        let (mut a, mut error) = (a, 0.0);
        for _ in 0..5 {
            error = 4.0 * f64::abs(a) * error + step * (2.0 * a * a + 1.0);
            a = 2.0 * a * a - 1.0;
        }
        Conditioned { value: a, condition: error }
    });
    let product = rings[0] * rings[1] * rings[2];
    scaled(ground_and_sky(d[1]), 0.5 * product.condition)
}

/// The world-space direction of the ray through a point of the picture.
pub(crate) fn world_ray(eye: &Eye, [x, y]: [f64; 2]) -> V3 {
    let (_, ray) = eye.ray(x, y);
    // The inverse of a rotation is its transpose.
    [0, 1, 2].map(|i| dot(eye.direction([0, 1, 2].map(|j| f64::from(u8::from(i == j)))), ray))
}

/// What the formula takes, one number after the other: `C_F`, alpha, n, `C_O`, the sum of
/// opacities, hidden, v.
type Inputs = [f64; 15];

/// One channel of a refracting pixel; `None` for T is total reflection.
struct Refracting<'a> {
    environment: &'a Environment,
    ratio: f64,
    layers: BendingLayers,
    channel: usize,
    step: f64,
}

impl Refracting<'_> {
    /// The light, and whether T exists. The condition is that of the lookups alone.
    fn light(&self, x: &Inputs) -> (Conditioned, bool) {
        let (front, alpha) = (x[self.channel], x[3]);
        let view = unit([x[12], x[13], x[14]]);
        let mut normal = unit([x[4], x[5], x[6]]);
        if dot(normal, view) < 0.0 {
            normal = scaled(normal, -1.0);
        }
        let (mut behind, mut l, mut hidden) = (x[7 + self.channel], 1.0, x[11]);
        if self.layers == BendingLayers::Single {
            (behind, hidden) = (0.0, 0.0);
        } else if alpha > 0.0 {
            l += x[10] / alpha;
        }
        let through = cross(normal, view);
        let sine = dot(through, through).sqrt();
        let angle = sine.atan2(dot(normal, view));
        let tangent = sub(scaled(normal, dot(normal, view)), view);
        let mirror = sub(scaled(normal, 2.0 * dot(normal, view)), view);
        let look = |d: V3| radiance(self.environment, d, self.step)[self.channel];
        let bent = self.ratio.powf(l) * sine;
        let front = Conditioned::exact(alpha * front);
        let open = Conditioned::exact(1.0 - alpha);
        if bent > 1.0 {
            return (front + open * look(mirror), false);
        }
        let along = if sine > 0.0 { scaled(tangent, bent / sine) } else { [0.0; 3] };
        let seen = sub(along, scaled(normal, bent.asin().cos()));
        let share = fresnel(angle, self.ratio);
        let absorbed = Conditioned::exact((1.0 - hidden) * (1.0 - alpha).powf(l));
        let rest = open * Conditioned::exact(behind) + absorbed * look(seen);
        let light = open * Conditioned::exact(share) * look(mirror)
            + Conditioned::exact(1.0 - share) * rest;
        (front + light, true)
    }
}

/// The reflected part by the angles of incidence and refraction.
fn fresnel(angle: f64, ratio: f64) -> f64 {
    let sine = ratio * angle.sin();
    if sine > 1.0 {
        return 1.0;
    }
    if angle == 0.0 {
        return ((1.0 - ratio) / (1.0 + ratio)).powi(2);
    }
    let inside = sine.asin();
    let across = (angle - inside).sin() / (angle + inside).sin();
    let along = (angle - inside).tan() / (angle + inside).tan();
    (across * across + along * along) / 2.0
}

/// The colour of a pixel whose nearest layer bends light, and whether rounding decides about total
/// reflection.
pub(crate) fn refracted(
    (truth, near): (&Truth, &Near),
    environment: &Environment,
    refraction: &Refraction,
    ray: V3,
    [step, guard]: [f64; 2],
) -> ([Conditioned; 3], bool) {
    let view = unit(scaled(ray, -1.0)).map(|value| Conditioned { value, condition: step });
    let behind = &truth.average;
    let mut all = near.color.to_vec();
    all.push(near.alpha);
    all.extend(near.normal);
    all.extend(behind.color);
    all.extend([behind.opacity, behind.hidden]);
    all.extend(view);
    let inputs: Inputs = std::array::from_fn(|i| all[i].value);
    let mut doubt = false;
    let light = [0, 1, 2].map(|channel| {
        let (ratio, layers) = (f64::from(refraction.ratio[channel]), refraction.layers);
        let sheet = Refracting { environment, ratio, layers, channel, step };
        let (mut light, bends) = sheet.light(&inputs);
        for (i, input) in all.iter().enumerate() {
            let moved = |by: f64| {
                let mut x = inputs;
                x[i] += by * (input.condition + step * input.value.abs());
                // Opacities and parts stay within [0, 1].
                if i == 3 || i == 11 {
                    x[i] = x[i].clamp(0.0, 1.0);
                }
                Refracting { step: 0.0, ..sheet }.light(&x)
            };
            let [up, down] = [moved(1.0), moved(-1.0)].map(|(other, _)| other.value);
            light.condition += (up - light.value).abs().max((down - light.value).abs());
            doubt |= [guard, -guard].iter().any(|&by| moved(by).1 != bends);
        }
        light.condition += step * light.value;
        light
    });
    (light, doubt)
}
