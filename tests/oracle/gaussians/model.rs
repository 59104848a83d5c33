//! Gaussians on the screen, each by the images of its axes.
//!
//! V0 is a sum of squares of 2-vectors, and its determinant a sum of squares of their cross
//! products, so nothing cancels. A [`Conditioned`] has the error that a computation by matrices
//! makes in an arithmetic with this rounding, to first order.

use crate::oracle::gaussians::bounds::Bounds;
use crate::oracle::gaussians::discs::Disc;
use crate::oracle::gaussians::harmonics::harmonics;
use crate::oracle::gaussians::shape::Shape;
use crate::oracle::kit::condition::Conditioned;
use crate::oracle::kit::eye::{Eye, V3, scaled, sub, unit, wide};
use splatref::method::gaussians::{BlendSpace, ColorBounds, Order, Settings};
use splatref::scene::gaussians::Encoding;
use splatref::scene::{Camera, Scene};
use splatref::splat::gaussian::{Clamp, Compensation};

/// A splat that may be drawn.
pub(crate) struct Splat {
    pub(crate) item: u32,
    /// Whether near plane, determinant and bounds leave no doubt that it is drawn.
    pub(crate) sure: bool,
    pub(crate) depth: Conditioned,
    pub(crate) key: Conditioned,
    /// The centre in the camera frame, and its rounding.
    pub(crate) center: [Conditioned; 3],
    /// What B' is the sum of squares of.
    pub(crate) thin: [V3; 3],
    pub(crate) screen: [Conditioned; 2],
    /// (xx, xy, yy), and the determinant.
    pub(crate) ellipse: [Conditioned; 3],
    pub(crate) det: Conditioned,
    pub(crate) opacity: Conditioned,
    pub(crate) color: [Conditioned; 3],
    /// Pixels that it may touch, and those that no rounding keeps from it.
    pub(crate) wide: Bounds,
    pub(crate) narrow: Bounds,
    /// If discs meet rays.
    pub(crate) disc: Option<Disc>,
}

pub(crate) struct Model<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) camera: &'a Camera,
    pub(crate) settings: &'a Settings,
    pub(crate) eye: Eye,
    /// The rounding of the arithmetic under test, half a unit of the last place of 1.
    pub(crate) step: f64,
}

/// Whether a difference may have another sign for rounding: within a millionth of the scale, or
/// within 16 times the error.
pub(crate) fn tips(difference: f64, scale: f64, error: f64) -> bool {
    difference.abs() <= (1e-6 * scale.abs()).max(16.0 * error)
}

/// The transfer function of sRGB with constants of `f32`; `up` encodes.
fn transfer(up: bool, v: f64) -> f64 {
    let c = |digits: f64| f64::from(digits as f32);
    let power = |base: f64, exponent: f64| (exponent * base.ln()).exp();
    match (up, v <= c(if up { 0.003_130_8 } else { 0.040_45 })) {
        (false, true) => v / c(12.92),
        (false, false) => power((v + c(0.055)) / c(1.055), c(2.4)),
        (true, true) => v * c(12.92),
        (true, false) => c(1.055) * power(v, c(1.0 / 2.4)) - c(0.055),
    }
}

/// A transfer function of a number that has an error.
pub(crate) fn transferred(up: bool, v: Conditioned, step: f64) -> Conditioned {
    let value = transfer(up, v.value);
    let change = |by: f64| (transfer(up, v.value + by * v.condition) - value).abs();
    let own = 8.0 * step * (value.abs() + if up { 1.0 } else { 0.0 });
    Conditioned { value, condition: change(1.0).max(change(-1.0)) + own }
}

/// The image of an axis on the screen, and the magnitudes that it is the sum of.
struct Images {
    axes: [[f64; 2]; 3],
    magnitude: [[f64; 2]; 3],
    /// The same with the change of the Jacobian.
    moved: [[f64; 2]; 3],
}

impl<'a> Model<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        camera: &'a Camera,
        settings: &'a Settings,
        step: f64,
    ) -> Self {
        Self { scene, camera, settings, eye: Eye::new(camera), step }
    }

    /// All splats that may be drawn, in the order of the picture.
    pub(crate) fn splats(&self) -> Vec<Splat> {
        let count = self.scene.gaussians.as_ref().map_or(self.scene.surfels.len(), |g| g.len());
        let mut all: Vec<_> = (0..count).filter_map(|i| self.splat(i)).collect();
        if self.settings.order == Order::Steps {
            quantize(&mut all);
        }
        all.sort_by(|a, b| {
            (a.key.value, a.item).partial_cmp(&(b.key.value, b.item)).expect("keys")
        });
        all
    }

    pub(crate) fn shape(&self, i: usize) -> Shape {
        match &self.scene.gaussians {
            Some(gaussians) => Shape::gaussian(gaussians, i),
            None => Shape::surfel(&self.scene.surfels, i, self.settings.cutoff.into()),
        }
    }

    /// A direction in the camera frame: x right, y down, z into the picture.
    pub(crate) fn turned(&self, v: V3) -> V3 {
        let [x, y, z] = self.eye.direction(v);
        [x, -y, -z]
    }

    fn splat(&self, i: usize) -> Option<Splat> {
        let (shape, step) = (self.shape(i), self.step);
        let ([x, y, z], rounding) =
            (self.eye.point(shape.center), self.eye.magnitude(shape.center));
        let p = [x, -y, -z];
        let center = [0, 1, 2].map(|a| Conditioned { value: p[a], condition: step * rounding[a] });
        let near = f64::from(self.settings.kernel.near);
        let near = if near == 0.0 { self.eye.near } else { near };
        let doubtful = tips(p[2] - near, near, center[2].condition);
        if !(p[2] > near) && !doubtful {
            return None;
        }
        let images = self.images(&shape, p);
        let [v0, v] = self.ellipses(&images, &center);
        let (det0, det) = self.determinants(&images, &v0, &v);
        let disc = self.meets_rays().then(|| self.disc(i, &center));
        let finite = det.value.is_finite() && v.iter().all(|v| (v.value / det.value).is_finite());
        if !(det.value > 0.0 && finite) && disc.is_none() {
            return None;
        }
        let opacity = self.opacity(i);
        let screen = self.screen(&center);
        let (opacity, [wide, narrow]) = match &disc {
            Some(disc) => (opacity, self.bounds_of_disc(disc, opacity.value)),
            None => {
                let opacity = opacity * self.compensation(det0, det);
                (opacity, self.bounds(&screen, &v, det, opacity))
            }
        };
        let sound = disc.is_some() || det.value > 16.0 * det.condition;
        let sure = !doubtful && sound && narrow.any();
        let splat = Splat {
            item: i as u32,
            sure,
            depth: center[2],
            key: self.key(&center),
            center,
            thin: shape.thin.map(|n| self.turned(n)),
            screen,
            ellipse: v,
            det,
            opacity,
            color: self.color(i, shape.center),
            wide,
            narrow,
            disc,
        };
        wide.any().then_some(splat)
    }

    fn key(&self, center: &[Conditioned; 3]) -> Conditioned {
        if self.settings.order == Order::Depth || !self.eye.perspective {
            return center[2];
        }
        let value = center.iter().map(|c| c.value * c.value).sum::<f64>().sqrt();
        let error: f64 = center.iter().map(|c| c.condition).sum();
        Conditioned { value, condition: error + 4.0 * self.step * value }
    }

    pub(crate) fn screen(&self, center: &[Conditioned; 3]) -> [Conditioned; 2] {
        let Eye { fx, fy, cx, cy, perspective, .. } = self.eye;
        let [x, y, t] = *center;
        [(x, fx, cx), (y, fy, cy)].map(|(along, f, c)| {
            let one = Conditioned::exact(1.0);
            let part = Conditioned::exact(f) * along / if perspective { t } else { one };
            let value = c + part.value;
            let own = self.step * (c.abs() + 2.0 * part.value.abs());
            Conditioned { value, condition: part.condition + own }
        })
    }

    /// J W v of each axis v, with J as rows (jx, 0, jxz) and (0, jy, jyz).
    fn images(&self, shape: &Shape, p: V3) -> Images {
        let Eye { fx, fy, .. } = self.eye;
        let [u, v] = self.slopes(p);
        let t = if self.eye.perspective { p[2] } else { 1.0 };
        let rows = [[fx / t, 0.0, -fx * u / t], [0.0, fy / t, -fy * v / t]];
        let axes = shape.spread.map(|axis| {
            let w = self.turned(axis);
            rows.map(|row| row[0] * w[0] + row[1] * w[1] + row[2] * w[2])
        });
        let length = shape.spread.map(|axis| 2.0 * axis.iter().map(|a| a.abs()).sum::<f64>());
        let moved = length.map(|l| [fx, fy].map(|f| l * f / t));
        let sums = rows.map(|row| row.iter().map(|j| j.abs()).sum::<f64>());
        let magnitude = length.map(|l| sums.map(|sum| l * sum));
        let moved = [0, 1, 2].map(|k| [0, 1].map(|a| moved[k][a] + magnitude[k][a]));
        Images { axes, magnitude, moved }
    }

    /// x/t and y/t as the Jacobian has them.
    fn slopes(&self, p: V3) -> [f64; 2] {
        let Eye { fx, fy, cx, cy, .. } = self.eye;
        if !self.eye.perspective {
            return [0.0; 2];
        }
        let size = [self.camera.width, self.camera.height].map(f64::from);
        let c = |digits: f64| f64::from(digits as f32);
        [0, 1].map(|a| {
            let (f, middle, slope) = ([fx, fy][a], [cx, cy][a], p[a] / p[2]);
            let half = size[a] / (2.0 * f);
            let [low, high] = match self.settings.kernel.clamp {
                Clamp::None => [f64::NEG_INFINITY, f64::INFINITY],
                Clamp::Fov => [-c(1.3) * half, c(1.3) * half],
                Clamp::Edges => {
                    [-middle / f - c(0.3) * half, (size[a] - middle) / f + c(0.3) * half]
                }
            };
            slope.clamp(low, high)
        })
    }

    /// V0 and V.
    fn ellipses(&self, images: &Images, center: &[Conditioned; 3]) -> [[Conditioned; 3]; 2] {
        let h = f64::from(self.settings.kernel.low_pass);
        let moving = if self.eye.perspective {
            center.iter().map(|c| c.condition).sum::<f64>() / center[2].value
        } else {
            0.0
        };
        let sum = |of: &[[f64; 2]; 3], a: usize, b: usize| -> f64 {
            of.iter().map(|image| image[a] * image[b]).sum()
        };
        let v0 = [(0, 0), (0, 1), (1, 1)].map(|(a, b)| Conditioned {
            value: sum(&images.axes, a, b),
            condition: self.step * sum(&images.magnitude, a, b) + moving * sum(&images.moved, a, b),
        });
        let wider = |v: Conditioned| Conditioned {
            value: v.value + h,
            condition: v.condition + self.step * (v.value + h),
        };
        [v0, [wider(v0[0]), v0[1], wider(v0[2])]]
    }

    /// det V0 by squares of cross products, and det V = det V0 + h trace V0 + h h.
    fn determinants(
        &self,
        images: &Images,
        v0: &[Conditioned; 3],
        v: &[Conditioned; 3],
    ) -> (Conditioned, Conditioned) {
        let h = f64::from(self.settings.kernel.low_pass);
        let [a, b, c] = images.axes;
        let cross = |a: [f64; 2], b: [f64; 2]| (a[0] * b[1] - a[1] * b[0]).powi(2);
        let value = cross(a, b) + cross(a, c) + cross(b, c);
        let error = |v: &[Conditioned; 3]| {
            let own = self.step * (v[0].value * v[2].value + v[1].value * v[1].value);
            (v[0] * v[2] - v[1] * v[1]).condition + own
        };
        let det = value + h * (v0[0].value + v0[2].value) + h * h;
        (
            Conditioned { value, condition: error(v0) },
            Conditioned { value: det, condition: error(v) },
        )
    }

    fn compensation(&self, det0: Conditioned, det: Conditioned) -> Conditioned {
        let tiny = f64::from(0.000_001_f32);
        let root = |det0: f64| match self.settings.kernel.compensation {
            Compensation::None => 1.0,
            Compensation::Ratio => (det0 / det.value).max(0.0).sqrt(),
            Compensation::Floor => (det0 / det.value).max(f64::from(0.000_025_f32)).sqrt(),
            Compensation::Mip if det0 <= tiny || det.value <= tiny => 0.0,
            Compensation::Mip => (det0 / (det.value + tiny) + tiny).sqrt(),
        };
        if self.settings.kernel.compensation == Compensation::None {
            return Conditioned::exact(1.0);
        }
        let value = root(det0.value);
        let change = |by: f64| (root(det0.value + by * det0.condition) - value).abs();
        let rest = value * (det.condition / det.value + 2.0 * self.step);
        Conditioned { value, condition: change(1.0).max(change(-1.0)) + rest }
    }

    fn opacity(&self, i: usize) -> Conditioned {
        let opacity = match &self.scene.gaussians {
            Some(gaussians) => gaussians.opacity()[i],
            None => self.scene.surfels.opacity().map_or(1.0, |opacity| opacity[i]),
        };
        Conditioned { value: opacity.into(), condition: 0.0 }
    }

    /// The direction in which a centre is seen, in the world, and its rounding.
    fn view(&self, center: V3) -> (V3, f64) {
        if !self.eye.perspective {
            let row = self.camera.view_from_world.row(2).truncate();
            return (scaled(wide(row), -1.0), 0.0);
        }
        let eye = wide(self.camera.eye().as_vec3());
        let seen = sub(center, eye);
        let size = |v: V3| v.iter().map(|v| v.abs()).sum::<f64>();
        (unit(seen), self.step * (4.0 + (size(center) + size(eye)) / size(seen)))
    }

    /// Whether colours are blended as sRGB.
    pub(crate) fn blends_srgb(&self) -> bool {
        match self.settings.blend {
            BlendSpace::Stored => self.stores_srgb(),
            BlendSpace::Linear => false,
            BlendSpace::Srgb => true,
        }
    }

    fn stores_srgb(&self) -> bool {
        self.scene.gaussians.as_ref().is_some_and(|g| g.encoding() == Encoding::Srgb)
    }

    fn color(&self, i: usize, center: V3) -> [Conditioned; 3] {
        let stored = match &self.scene.gaussians {
            None => {
                let color = self
                    .scene
                    .surfels
                    .color()
                    .map_or(self.scene.material.color, |colors| colors[i]);
                wide(color).map(Conditioned::exact)
            }
            Some(gaussians) => {
                let (direction, error) = self.view(center);
                let degree = self.settings.degree.min(gaussians.degree());
                let (basis, all) = (harmonics(degree, direction), gaussians.harmonics(i));
                [0, 1, 2].map(|c| {
                    let terms = basis.iter().zip(all).map(|(b, a)| (*b, f64::from(a[c])));
                    let (mut value, mut condition) = (0.5, 4.0 * self.step);
                    for (b, a) in terms {
                        value += b * a;
                        condition += a.abs() * (3.0 * error + 4.0 * self.step);
                    }
                    Conditioned { value, condition }
                })
            }
        };
        stored.map(|color| self.in_space(self.bounded(color)))
    }

    fn bounded(&self, color: Conditioned) -> Conditioned {
        let value = match self.settings.bounds {
            ColorBounds::None => color.value,
            ColorBounds::Zero => color.value.max(0.0),
            ColorBounds::Unit => color.value.clamp(0.0, 1.0),
        };
        Conditioned { value, ..color }
    }

    fn in_space(&self, color: Conditioned) -> Conditioned {
        match (self.stores_srgb(), self.blends_srgb()) {
            (true, false) => transferred(false, color, self.step),
            (false, true) => transferred(true, color, self.step),
            _ => color,
        }
    }
}

/// Replaces distances by 65,536 steps from the least to the greatest.
fn quantize(all: &mut [Splat]) {
    let keys = || all.iter().map(|splat| splat.key.value);
    let (least, most) = (keys().fold(f64::INFINITY, f64::min), keys().fold(0.0, f64::max));
    let range = most - least;
    for splat in all {
        let at = if range > 0.0 { (splat.key.value - least) / range * 65_535.0 } else { 0.0 };
        let error = if range > 0.0 { 3.0 * splat.key.condition / range * 65_535.0 } else { 0.0 };
        // A place that may fall to the next step or the last one could be in front of either.
        let tipping = at > 0.0 && at < 65_535.0 && tips(at - at.round(), 1.0, error);
        let condition = if tipping { 1.0 } else { 0.0 };
        splat.key = Conditioned { value: at.floor(), condition };
    }
}
