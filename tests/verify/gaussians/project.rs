//! A Gaussian becomes an ellipse, a colour and a key, as a shader for each splat would do it.

use super::color::bounded;
use super::ray::Disc;
use super::{Bug, Habit, Shared};
use splatref::method::gaussians::record::GaussianRecord;
use splatref::method::gaussians::{Order, Support};
use splatref::scene::Projection;
use splatref::splat::gaussian::{Clamp, Compensation};

/// What the fragments of a splat need.
#[derive(Clone, Debug)]
pub(super) struct Splat {
    pub(super) index: u32,
    pub(super) center: [f32; 2],
    pub(super) conic: [f32; 3],
    pub(super) alpha: f32,
    pub(super) color: [f32; 3],
    pub(super) depth: f32,
    pub(super) key: f32,
    /// The pixels that it may touch: first column and row, end of columns and rows.
    pub(super) bounds: [i64; 4],
    /// The inverse covariance in the camera frame up to a factor, and the place, for the order of a
    /// pixel.
    pub(super) inverse: [[f32; 3]; 3],
    pub(super) place: [f32; 3],
    /// The disc, if discs meet rays.
    pub(super) disc: Option<Disc>,
    /// What it hands in; its key may be replaced by a step.
    pub(super) record: GaussianRecord,
}

impl Splat {
    /// The splat of a record, with what the record lacks.
    fn new(
        record: GaussianRecord,
        (bounds, inverse, disc): ([i64; 4], Matrix, Option<Disc>),
    ) -> Self {
        let GaussianRecord { index, center, conic, alpha, color, key, place, .. } = record;
        let [_, _, depth] = place;
        Self {
            index,
            center,
            conic,
            alpha,
            color,
            depth,
            key,
            bounds,
            inverse,
            place,
            disc,
            record,
        }
    }
}

pub(super) type Matrix = [[f32; 3]; 3];

fn transposed(m: Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| m[j][i]))
}

impl Shared<'_> {
    /// a b^T.
    fn by_transposed(&self, a: Matrix, b: Matrix) -> Matrix {
        a.map(|row| b.map(|column| self.dot(row, column)))
    }

    /// The rows of the rotation of a quaternion.
    fn rotation([x, y, z, w]: [f32; 4]) -> Matrix {
        let two = |a: f32, b: f32| 2.0 * (a + b);
        [
            [1.0 - two(y * y, z * z), two(x * y, -(w * z)), two(x * z, w * y)],
            [two(x * y, w * z), 1.0 - two(x * x, z * z), two(y * z, -(w * x))],
            [two(x * z, -(w * y)), two(y * z, w * x), 1.0 - two(x * x, y * y)],
        ]
    }

    /// The columns are the own axes in the world, of unit length.
    fn axes(&self, i: usize) -> Matrix {
        let [x, y, z, w] = self.gaussians.rotation()[i];
        let axes = match self.how.bug {
            Some(Bug::QuaternionWFirst) => Self::rotation([y, z, w, x]),
            Some(Bug::QuaternionWLast) => Self::rotation([w, x, y, z]),
            _ => Self::rotation([x, y, z, w]),
        };
        if self.how.has(Bug::RotationTransposed) { transposed(axes) } else { axes }
    }

    fn scale(&self, i: usize) -> [f32; 3] {
        let [x, y, z] = self.gaussians.scale()[i].to_array();
        match self.how.bug {
            Some(Bug::ScalesExchanged) => [y, x, z],
            Some(Bug::ScaleLogarithm) => [x, y, z].map(core_math::logf),
            _ => [x, y, z],
        }
    }

    /// Projects a splat; none if it is not drawn.
    pub(super) fn project(&self, i: usize) -> Option<Splat> {
        let [px, py, pz] = self.gaussians.position()[i].to_array();
        let place = self.frame.map(|[a, b, c, d]| self.dot([a, b, c], [px, py, pz]) + d);
        let [_, _, t] = place;
        let kernel = &self.settings.kernel;
        let near = if kernel.near == 0.0 { self.camera.near } else { kernel.near };
        if !(t > near || self.how.has(Bug::NearMissing)) {
            return None;
        }
        let scale = self.scale(i);
        let axes = self.axes(i);
        let m = axes.map(|row| [0, 1, 2].map(|j| row[j] * scale[j]));
        let [j, center] = self.jacobian(place);
        let covariance = self.covariance(m);
        let v = self.unfiltered(m, covariance, j);
        let low_pass = kernel.low_pass;
        let [a, b, c] = [v[0] + low_pass, v[1], v[2] + low_pass];
        let det = self.difference(a, c, b, b);
        let rays = self.meets_rays();
        let conic = self.conic([a, b, c], det);
        let compensation = self.compensation(v, det);
        let alpha = if rays { self.opacity(i) } else { self.opacity(i) * compensation };
        let finite = conic.iter().chain(&center[..2]).all(|part| part.is_finite());
        if !(rays || det > 0.0 && finite) {
            return None;
        }
        let from_eye = [px - self.eye[0], py - self.eye[1], pz - self.eye[2]];
        let distance = if self.perspective() { self.dot(from_eye, from_eye).sqrt() } else { t };
        let key = match self.settings.order {
            Order::Depth | Order::Pixel => t,
            Order::Distance | Order::Steps => distance,
        };
        let mut center = [center[0], center[1]];
        if self.how.has(Bug::CentersWhole) {
            center = center.map(|at| at.floor() + 0.5);
        }
        let disc = if rays { Some(self.disc(m, place, center)?) } else { None };
        let bounds = match &disc {
            Some(disc) => self.bounds_of_disc(disc, center, alpha)?,
            None => self.bounds(center, [a, b, c], alpha)?,
        };
        let color = self.color(i, from_eye);
        let inverse = self.inverse(axes, scale);
        let [[xx, xy, xz], [_, yy, yz], [.., zz]] = covariance;
        let record = GaussianRecord {
            place,
            key,
            color,
            alpha,
            conic,
            compensation,
            ellipse: [a, b, c],
            distance,
            unfiltered: v,
            index: i as u32,
            covariance: [xx, xy, xz, yy, yz, zz],
            center,
            bounds: bounds.map(|end| end as u32),
        };
        Some(Splat::new(record, (bounds, inverse, disc)))
    }

    pub(super) fn perspective(&self) -> bool {
        self.camera.projection == Projection::Perspective
    }

    /// a b - c d.
    pub(super) fn difference(&self, a: f32, b: f32, c: f32, d: f32) -> f32 {
        self.add_product(a * b, -c, d)
    }

    /// The Jacobian (jx, jxz, jy, jyz), and the centre on the screen.
    fn jacobian(&self, [x, y, t]: [f32; 3]) -> [[f32; 4]; 2] {
        let [fx, fy, cx, cy] = self.lens;
        if !self.perspective() {
            return [
                [fx, 0.0, fy, 0.0],
                [self.add_product(cx, fx, x), self.add_product(cy, fy, y), 0.0, 0.0],
            ];
        }
        let quotient = |a: f32| match self.how.habit {
            Habit::Reciprocal => a * (1.0 / t),
            _ => a / t,
        };
        let [u, v] = [quotient(x), quotient(y)];
        let [bu, bv] = self.limits().map_or([u, v], |[[left, right], [top, bottom]]| {
            [bounded(u, left, right), bounded(v, top, bottom)]
        });
        let jacobian = [quotient(fx), -quotient(fx * bu), quotient(fy), -quotient(fy * bv)];
        [jacobian, [self.add_product(cx, fx, u), self.add_product(cy, fy, v), 0.0, 0.0]]
    }

    /// The least and greatest x/t and y/t in the Jacobian.
    fn limits(&self) -> Option<[[f32; 2]; 2]> {
        let [fx, fy, cx, cy] = self.lens;
        let [width, height] = self.size.map(|side| side as f32);
        let fov = |size: f32, f: f32| 1.3 * ((0.5 * size) / f);
        let edges = |size: f32, f: f32, c: f32| {
            let beyond = 0.3 * ((0.5 * size) / f);
            [-(c / f + beyond), (size - c) / f + beyond]
        };
        match self.settings.kernel.clamp {
            Clamp::None => None,
            Clamp::Fov => Some([(width, fx), (height, fy)].map(|(s, f)| [-fov(s, f), fov(s, f)])),
            Clamp::Edges => Some([edges(width, fx, cx), edges(height, fy, cy)]),
        }
    }

    /// The rotation into the camera frame.
    pub(super) fn turn(&self) -> Matrix {
        let w = self.frame.map(|[a, b, c, _]| [a, b, c]);
        if self.how.has(Bug::ViewTransposed) { transposed(w) } else { w }
    }

    /// S' from the axes, which are the columns of a matrix.
    fn covariance(&self, m: Matrix) -> Matrix {
        let w = self.turn();
        if matches!(self.how.habit, Habit::AxesInCamera | Habit::AxesInPixels) {
            let turned = self.by_transposed(w, transposed(m));
            return self.by_transposed(turned, turned);
        }
        let m = if self.how.has(Bug::CovarianceReversed) { transposed(m) } else { m };
        let world = self.by_transposed(m, m);
        let world = match self.how.bug {
            Some(Bug::HalfCovariance) => world.map(|row| row.map(half)),
            _ => world,
        };
        self.by_transposed(w, self.by_transposed(w, world))
    }

    /// V0 from the axes, or from S', and the Jacobian.
    fn unfiltered(&self, m: Matrix, s: Matrix, [jx, jxz, jy, jyz]: [f32; 4]) -> [f32; 3] {
        // The two rows of J.
        let j = [[jx, 0.0, jxz], [0.0, jy, jyz]];
        let squares = |[x, y]: [[f32; 3]; 2]| [self.dot(x, x), self.dot(x, y), self.dot(y, y)];
        if self.how.habit == Habit::AxesInPixels {
            let columns = transposed(self.by_transposed(self.turn(), transposed(m)));
            return squares(j.map(|row| columns.map(|column| self.dot(row, column))));
        }
        let [x, y] = j.map(|row| s.map(|column| self.dot(row, column)));
        [self.dot(x, j[0]), self.dot(x, j[1]), self.dot(y, j[1])]
    }

    fn conic(&self, [a, b, c]: [f32; 3], det: f32) -> [f32; 3] {
        let [a, b, c] = match self.how.habit {
            Habit::ConicDivided => [c / det, -b / det, a / det],
            _ => [c * (1.0 / det), -(b * (1.0 / det)), a * (1.0 / det)],
        };
        match self.how.bug {
            Some(Bug::ConicMirrored) => [a, -b, c],
            Some(Bug::ConicExchanged) => [c, b, a],
            _ => [a, b, c],
        }
    }

    fn opacity(&self, i: usize) -> f32 {
        let opacity = self.gaussians.opacity()[i];
        match self.how.bug {
            Some(Bug::OpacityIgnored) => 1.0,
            // As a PLY stores it; that of 1 is as large as trained ones get.
            Some(Bug::OpacityLogit) if opacity < 1.0 => core_math::logf(opacity / (1.0 - opacity)),
            Some(Bug::OpacityLogit) => 16.0,
            _ => opacity,
        }
    }

    fn compensation(&self, [a, b, c]: [f32; 3], det: f32) -> f32 {
        let det0 = self.difference(a, c, b, b);
        let ratio = match self.settings.kernel.compensation {
            Compensation::None => return 1.0,
            Compensation::Ratio if det0 / det > 0.0 => det0 / det,
            Compensation::Floor if det0 / det > 0.000_025 => det0 / det,
            Compensation::Floor => 0.000_025,
            Compensation::Mip if det0 > 1e-6 && det > 1e-6 => det0 / (det + 1e-6) + 1e-6,
            Compensation::Ratio | Compensation::Mip => 0.0,
        };
        if self.how.habit == Habit::InverseSqrt && ratio > 0.0 {
            return ratio * (1.0 / ratio.sqrt());
        }
        ratio.sqrt()
    }

    /// The pixels that a splat may touch; none if there are none.
    fn bounds(&self, [x, y]: [f32; 2], [a, b, c]: [f32; 3], alpha: f32) -> Option<[i64; 4]> {
        let [x, y, a, b, c, alpha] = [x, y, a, b, c, alpha].map(f64::from);
        let k = f64::from(self.settings.cutoff);
        let wide = |square: f64| {
            let side = |v: f64| (square * v).sqrt() * (1.0 + 1.0 / 1024.0) + 1.0;
            self.pixels([x, y], [side(a), side(c)], 1)
        };
        let natural = |share: f64| 2.0 * core_math::log(share);
        let tile = if self.how.has(Bug::TilesOf8) { 8 } else { 16 };
        match self.settings.support {
            Support::None => {
                let least = f64::from(self.settings.least_alpha);
                if alpha < least { None } else { wide(natural(alpha / least)) }
            }
            Support::Ellipse => wide(k * k),
            Support::Tiles => {
                let middle = 0.5 * (a + c);
                let square = middle * middle - (a * c - b * b);
                let root = if square > 0.1 { square.sqrt() } else { 0.1_f64.sqrt() };
                let side = (k * (middle + root).sqrt()).ceil();
                self.pixels([x, y], [side, side], tile)
            }
            Support::Boxes => {
                if 255.0 * alpha < 1.0 {
                    return None;
                }
                let own = natural(255.0 * alpha).sqrt();
                let k = if own < k { own } else { k };
                self.pixels([x, y], [(k * a.sqrt()).ceil(), (k * c.sqrt()).ceil()], tile)
            }
        }
    }

    /// The pixels, or the tiles, of the picture within an extent of a centre.
    pub(super) fn pixels(&self, center: [f64; 2], extent: [f64; 2], tile: i64) -> Option<[i64; 4]> {
        let wide = tile as f64;
        let side = |axis: usize| {
            let [low, high] = [center[axis] - extent[axis], center[axis] + extent[axis]];
            let [first, end] = match tile {
                1 => [(low - 0.5).ceil(), (high - 0.5).floor() + 1.0],
                // The original counts from the centre of a pixel, gsplat from its corner.
                _ if self.settings.support == Support::Tiles => {
                    let [low, high] = [low - 0.5, high - 1.5];
                    [(low / wide).floor() * wide, ((high / wide).floor() + 1.0) * wide]
                }
                _ => [(low / wide).floor() * wide, (high / wide).ceil() * wide],
            };
            [
                (first as i64).clamp(0, self.size[axis].into()),
                (end as i64).min(self.size[axis].into()),
            ]
        };
        let ([x0, x1], [y0, y1]) = (side(0), side(1));
        (x0 < x1 && y0 < y1).then_some([x0, y0, x1, y1])
    }

    /// The adjugate of the covariance in the camera frame, up to a factor.
    fn inverse(&self, axes: Matrix, [x, y, z]: [f32; 3]) -> Matrix {
        if self.settings.order != Order::Pixel {
            return Matrix::default();
        }
        let most = [x, y, z].into_iter().fold(0.0, |a: f32, b| if b > a { b } else { a });
        let [x, y, z] = [x, y, z].map(|part| if most > 0.0 { part / most } else { 0.0 });
        let factors = [y * z, x * z, x * y];
        let n = axes.map(|row| [0, 1, 2].map(|j| row[j] * factors[j]));
        let w = self.frame.map(|[a, b, c, _]| [a, b, c]);
        let world = self.by_transposed(n, n);
        self.by_transposed(w, self.by_transposed(w, world))
    }
}

/// Rounds to the 11 digits of a half float; its exponents suffice here.
fn half(value: f32) -> f32 {
    f32::from_bits((value.to_bits() + 0xFFF + (value.to_bits() >> 13 & 1)) & !0x1FFF)
}
