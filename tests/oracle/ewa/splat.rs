//! One surfel under one camera, by the textbook: the geometry of the oracle.
//!
//! A surfel is spanned by two explicit half axes. Its covariance is J S J^T with the 2 x 3 Jacobian
//! of the projection, its conic the adjugate over the determinant; the perspective outline comes
//! from the dual conic of the projected disc, depth from the intersection of the pixel's ray with
//! the plane. Every number comes with the sum of its changes when each input moves by one step: its
//! condition, in which the rounding errors of the crate are measured.

use crate::oracle::kit::eye::{Eye, V3, cross, dot, scaled, sub, unit, wide};
use splatref::method::ewa::Settings;
use splatref::scene::{Camera, Surfels};
use splatref::splat::Outline;

/// A surfel in view space.
#[derive(Clone, Copy)]
pub(crate) struct Body {
    pub(crate) p: V3,
    pub(crate) n: V3,
    span: Span,
}

#[derive(Clone, Copy)]
enum Span {
    Disc(f64),
    Ellipse([V3; 2]),
}

impl Body {
    /// A surfel, enlarged.
    pub(crate) fn new(eye: &Eye, surfels: &Surfels, (i, scale): (usize, f64)) -> Self {
        let span = match surfels.tangents() {
            Some(pairs) => Span::Ellipse(pairs[i].map(|v| scaled(eye.direction(wide(v)), scale))),
            None => Span::Disc(f64::from(surfels.radius()[i]) * scale),
        };
        let (p, n) = (wide(surfels.position()[i]), wide(surfels.normal()[i]));
        Self { p: eye.point(p), n: eye.direction(n), span }
    }

    /// Half axes at the rim; for a disc some basis of its plane.
    fn axes(&self) -> [V3; 2] {
        match self.span {
            Span::Ellipse(axes) => axes,
            Span::Disc(r) => {
                let n = unit(self.n);
                let helper = if n[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
                let first = unit(cross(n, helper));
                [scaled(first, r), scaled(cross(n, first), r)]
            }
        }
    }

    /// This surfel with each of its numbers moved by `step` times its magnitude, one at a time.
    fn neighbours(&self, magnitude: V3, step: f64) -> Vec<Self> {
        let mut all = Vec::new();
        for i in 0..3 {
            let mut body = *self;
            body.p[i] += step * magnitude[i];
            all.push(body);
            let mut body = *self;
            body.n[i] += step;
            all.push(body);
            if let Span::Ellipse(axes) = self.span {
                for k in 0..2 {
                    let mut moved = axes;
                    moved[k][i] += step * dot(axes[k], axes[k]).sqrt();
                    all.push(Self { span: Span::Ellipse(moved), ..*self });
                }
            }
        }
        if let Span::Disc(r) = self.span {
            all.push(Self { span: Span::Disc(r + step * r), ..*self });
        }
        all
    }
}

/// What the shape of a surfel depends on besides the surfel.
pub(crate) struct Optics {
    pub(crate) eye: Eye,
    outline: Outline,
    pub(crate) k: f64,
    h: f64,
}

impl Optics {
    pub(crate) fn new(camera: &Camera, settings: &Settings) -> Self {
        Self {
            eye: Eye::new(camera),
            outline: settings.kernel.outline,
            k: settings.kernel.cutoff.into(),
            h: settings.kernel.low_pass.into(),
        }
    }
}

/// One value of a fragment.
#[derive(Clone, Copy)]
pub(crate) struct Value {
    /// The squared distance, before the near plane cuts it off.
    pub(crate) whole: f64,
    pub(crate) q: f64,
    pub(crate) t: f64,
    pub(crate) weight: f64,
}

/// The shape of a body on the screen.
pub(crate) struct Figure {
    body: Body,
    axes: [V3; 2],
    /// Depth of the centre, and half the range of depth.
    pub(crate) t: f64,
    pub(crate) half: f64,
    pub(crate) center: [f64; 2],
    /// Covariance xx, xy, yy with the low-pass filter.
    pub(crate) covariance: V3,
    pub(crate) amplitude: f64,
    /// n . ray through the centre: negative where the front is seen.
    pub(crate) facing: f64,
}

impl Figure {
    pub(crate) fn new(optics: &Optics, body: Body) -> Self {
        let eye = &optics.eye;
        let axes = body.axes();
        let t = -body.p[2];
        let half = (axes[0][2] * axes[0][2] + axes[1][2] * axes[1][2]).sqrt();
        let ray = if eye.perspective { scaled(body.p, 1.0 / t) } else { [0.0, 0.0, -1.0] };
        let mut figure = Self {
            body,
            axes,
            t,
            half,
            center: eye.pixel(body.p),
            covariance: [0.0; 3],
            amplitude: 1.0,
            facing: dot(body.n, ray),
        };
        let exact = optics.outline == Outline::Perspective && eye.perspective;
        let area =
            if exact && t - half > eye.near { figure.dual(optics) } else { figure.affine(optics) };
        figure.covariance[0] += optics.h;
        figure.covariance[2] += optics.h;
        let [xx, xy, yy] = figure.covariance;
        if optics.outline != Outline::RayCast {
            figure.amplitude = area / (xx * yy - xy * xy).sqrt();
        }
        figure
    }

    /// Jacobian at the centre; returns the square root of the determinant of the covariance.
    fn affine(&mut self, optics: &Optics) -> f64 {
        let eye = &optics.eye;
        let (p, t) = (self.body.p, self.t);
        let jacobian = if eye.perspective {
            let (sx, sy) = (eye.fx / t, eye.fy / t);
            [[sx, 0.0, sx * p[0] / t], [0.0, -sy, -sy * p[1] / t]]
        } else {
            [[eye.fx, 0.0, 0.0], [0.0, -eye.fy, 0.0]]
        };
        let [u, v] = self.axes.map(|axis| jacobian.map(|row| dot(row, axis) / optics.k));
        self.covariance =
            [u[0] * u[0] + v[0] * v[0], u[0] * u[1] + v[0] * v[1], u[1] * u[1] + v[1] * v[1]];
        (u[0] * v[1] - u[1] * v[0]).abs()
    }

    /// The dual conic H diag(1, 1, -1) H^T of the projected rim, the principal point moved to the
    /// centre; the columns of H are the projections of the half axes and of the centre.
    fn dual(&mut self, optics: &Optics) -> f64 {
        let eye = &optics.eye;
        let (ox, oy) = (eye.fx * self.body.p[0] / self.t, -eye.fy * self.body.p[1] / self.t);
        let image = |v: V3| [eye.fx * v[0] + ox * v[2], -eye.fy * v[1] + oy * v[2], -v[2]];
        let [a, b, c] = [image(self.axes[0]), image(self.axes[1]), [0.0, 0.0, self.t]];
        let conic = |i: usize, j: usize| a[i] * a[j] + b[i] * b[j] - c[i] * c[j];
        let last = -conic(2, 2);
        let (mx, my) = (-conic(0, 2) / last, -conic(1, 2) / last);
        self.center = [self.center[0] + mx, self.center[1] + my];
        let kk = optics.k * optics.k;
        self.covariance = [
            (conic(0, 0) / last + mx * mx) / kk,
            (conic(0, 1) / last + mx * my) / kk,
            (conic(1, 1) / last + my * my) / kk,
        ];
        dot(a, cross(b, c)).abs() / (last * last.sqrt()) / kk
    }

    /// q, depth and weight at a point of the picture.
    pub(crate) fn at(&self, optics: &Optics, x: f64, y: f64) -> Value {
        let eye = &optics.eye;
        let (origin, ray) = eye.ray(x, y);
        let offset = dot(self.body.n, sub(self.body.p, origin));
        let nearness = dot(self.body.n, ray) / offset;
        let hit = if nearness > 0.0 || !eye.perspective { 1.0 / nearness } else { f64::INFINITY };
        let t = hit.min(self.t + self.half).max((self.t - self.half).max(eye.near));
        let (whole, q) = if optics.outline == Outline::RayCast {
            self.cast(optics, [x, y], hit, [origin, ray])
        } else {
            let q = self.screen_distance(x, y);
            (q, q)
        };
        Value { whole, q, t, weight: self.amplitude * (-0.5 * q).exp() }
    }

    /// Whether a point is certainly outside of twice the outline. This costs little, and is so of most
    /// surfels at a pixel.
    fn is_far(&self, optics: &Optics, x: f64, y: f64) -> bool {
        optics.outline != Outline::RayCast && self.screen_distance(x, y) > 4.0 * optics.k * optics.k
    }

    /// Squared distance on the screen, in units of the kernel.
    fn screen_distance(&self, x: f64, y: f64) -> f64 {
        let [dx, dy] = [x - self.center[0], y - self.center[1]];
        let [xx, xy, yy] = self.covariance;
        (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / (xx * yy - xy * xy)
    }

    /// Squared distance in the surfel's own plane, or in the filter where that is smaller.
    fn cast(&self, optics: &Optics, at: [f64; 2], hit: f64, [origin, ray]: [V3; 2]) -> (f64, f64) {
        let [dx, dy] = [at[0] - self.center[0], at[1] - self.center[1]];
        let filter = if optics.h > 0.0 { (dx * dx + dy * dy) / optics.h } else { f64::INFINITY };
        if !hit.is_finite() {
            return (filter, filter);
        }
        let x: V3 = std::array::from_fn(|i| origin[i] + hit * ray[i] - self.body.p[i]);
        let [a, b] = self.axes;
        let (aa, ab, bb) = (dot(a, a), dot(a, b), dot(b, b));
        let (xa, xb) = (dot(x, a), dot(x, b));
        let det = aa * bb - ab * ab;
        let (s, c) = ((xa * bb - xb * ab) / det, (xb * aa - xa * ab) / det);
        let disc = optics.k * optics.k * (s * s + c * c);
        let whole = disc.min(filter);
        (whole, if hit >= optics.eye.near { whole } else { filter })
    }
}

/// A fragment with the condition of each number.
#[derive(Clone, Copy)]
pub(crate) struct Fragment {
    pub(crate) value: Value,
    pub(crate) spread: Value,
}

/// A surfel on the screen, and its neighbours.
pub(crate) struct Splat {
    pub(crate) index: usize,
    pub(crate) figure: Figure,
    pub(crate) back: bool,
    /// Whether it lies beyond a side of the view.
    pub(crate) outside: bool,
    /// Whether a decision on the whole surfel is within its condition.
    pub(crate) doubtful: bool,
    neighbours: Vec<Figure>,
    shift: [f64; 2],
}

impl Splat {
    /// The splat of a surfel whose radius or tangents are multiplied by `scale`; none if it is
    /// behind, degenerate or culled. `guard`: how many conditions count as rounding.
    pub(crate) fn new(
        optics: &Optics,
        surfels: &Surfels,
        (index, scale): (usize, f64),
        cull: bool,
        [step, guard]: [f64; 2],
    ) -> Option<Self> {
        let eye = &optics.eye;
        let body = Body::new(eye, surfels, (index, scale));
        let magnitude = eye.magnitude(wide(surfels.position()[index]));
        let reach = guard * magnitude[2] * step;
        if -body.p[2] <= eye.near - reach {
            return None;
        }
        let figure = Figure::new(optics, body);
        let neighbours: Vec<_> =
            body.neighbours(magnitude, step).into_iter().map(|b| Figure::new(optics, b)).collect();
        let spread = |f: fn(&Figure) -> f64| -> f64 {
            neighbours.iter().map(|other| (f(other) - f(&figure)).abs()).sum()
        };
        let turning = figure.facing.abs() <= guard * spread(|f| f.facing);
        let exact = optics.outline == Outline::Perspective && eye.perspective;
        let nearest = figure.t - figure.half - eye.near;
        let grazing = exact && nearest.abs() <= guard * spread(|f| f.t - f.half);
        let leaving = (figure.t - eye.near).abs() <= reach && figure.t != eye.near;
        if figure.facing == 0.0 || figure.t == eye.near || (cull && !turning && figure.facing > 0.0)
        {
            return None;
        }
        // 2^-96 on purpose: below, the definition calls it degenerate.
        if figure.amplitude < (-96.0_f64).exp2() {
            return None;
        }
        let shift = [eye.cx, eye.cy];
        let shift = std::array::from_fn(|i| step * (figure.center[i].abs() + shift[i].abs()));
        let radius = match surfels.tangents() {
            None => f64::from(surfels.radius()[index]),
            Some(axes) => {
                let squared = axes[index].map(|axis| axis.as_dvec3().length_squared());
                (squared[0] + squared[1]).sqrt()
            }
        };
        let [excess, terms] = eye.beyond(body.p, radius * scale, optics.k * optics.h.sqrt());
        let parting = excess.abs() <= guard * step * terms;
        let back = figure.facing > 0.0;
        let doubtful = turning || grazing || leaving || parting;
        Some(Self { index, figure, back, outside: excess > 0.0, doubtful, neighbours, shift })
    }

    /// The fragment at a point; without its condition where it is far outside.
    pub(crate) fn fragment(&self, optics: &Optics, x: f64, y: f64) -> Option<Fragment> {
        if self.figure.is_far(optics, x, y) {
            return None;
        }
        let value = self.figure.at(optics, x, y);
        if !(value.whole <= 4.0 * optics.k * optics.k) {
            return None;
        }
        let mut spread = Value { whole: 0.0, q: 0.0, t: 0.0, weight: 0.0 };
        let mut add = |other: Value| {
            let change = |a: f64, b: f64| if a == b { 0.0 } else { (a - b).abs() };
            spread.q += change(other.q, value.q);
            spread.t += change(other.t, value.t);
            spread.weight += change(other.weight, value.weight);
        };
        self.neighbours.iter().for_each(|figure| add(figure.at(optics, x, y)));
        add(self.figure.at(optics, x + self.shift[0], y));
        add(self.figure.at(optics, x, y + self.shift[1]));
        Some(Fragment { value, spread })
    }
}
