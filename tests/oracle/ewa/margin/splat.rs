//! One surfel in balls, by the affine outline: the page of `splatref::splat::project` in its order.

use crate::oracle::ewa::margin::ball::Ball;
use glam::Vec3;
use splatref::method::ewa::Settings;
use splatref::scene::{Camera, Projection, Surfels};
use std::cmp::Ordering;

type B3 = [Ball; 3];

const ONE: Ball = Ball::exact(1.0);
const ZERO: Ball = Ball::exact(0.0);
const HALF: Ball = Ball::exact(0.5);
/// 2^96, and its inverse.
const HUGE: Ball = Ball::exact(f64::from_bits((1023 + 96) << 52));
const SMALL: Ball = Ball::exact(f64::from_bits((1023 - 96) << 52));

fn dot(a: B3, b: B3) -> Ball {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

/// The camera and the kernel.
pub(crate) struct Lens {
    rows: [[Ball; 4]; 3],
    perspective: bool,
    f: [Ball; 2],
    c: [Ball; 2],
    near: Ball,
    size: [u32; 2],
    k: Ball,
    h: Ball,
    cull: bool,
}

/// What discs and ellipses have by formulas of their own.
struct Form {
    xx: Ball,
    xy: Ball,
    yy: Ball,
    area: Ball,
    half: Ball,
    /// Of the sphere that holds it.
    radius: Ball,
}

/// The place of a surfel.
struct Place {
    p: B3,
    n: B3,
    t: Ball,
    d: [Ball; 2],
    /// sx and sy.
    scale: [Ball; 2],
    g: Ball,
}

/// A surfel on the screen.
pub(crate) struct Splat {
    center: [Ball; 2],
    /// ux, uy, vy.
    factor: [Ball; 3],
    /// w0, wx, wy.
    plane: [Ball; 3],
    /// The least and the greatest nearness.
    pub(crate) range: [Ball; 2],
    /// The columns and rows that may be in the bounds: first, and after the last.
    pub(crate) bounds: [[u32; 2]; 2],
    /// Whether there is no reason not to draw it; none if that is undecided.
    pub(crate) drawn: Option<bool>,
}

/// One splat at one pixel.
#[derive(Clone, Copy)]
pub(crate) struct Fragment {
    pub(crate) q: Ball,
    pub(crate) w: Ball,
    pub(crate) t: Ball,
}

/// Whether any of three-valued reasons holds, as Kleene's or.
fn any(reasons: &[Option<bool>]) -> Option<bool> {
    match reasons {
        all if all.contains(&Some(true)) => Some(true),
        all if all.contains(&None) => None,
        _ => Some(false),
    }
}

impl Lens {
    pub(crate) fn new(camera: &Camera, settings: &Settings) -> Self {
        let exact = |v: f32| Ball::exact(v.into());
        let row = |i| camera.view_from_world.row(i).to_array().map(exact);
        Self {
            rows: [row(0), row(1), row(2)],
            perspective: camera.projection == Projection::Perspective,
            f: [camera.fx, camera.fy].map(exact),
            c: [camera.cx, camera.cy].map(exact),
            near: exact(camera.near),
            size: [camera.width, camera.height],
            k: exact(settings.kernel.cutoff),
            h: exact(settings.kernel.low_pass),
            cull: settings.cull,
        }
    }

    /// k k.
    pub(crate) fn limit(&self) -> Ball {
        self.k * self.k
    }

    fn direction(&self, v: Vec3) -> B3 {
        let v = v.to_array().map(|x| Ball::exact(x.into()));
        self.rows.map(|m| (m[0] * v[0] + m[1] * v[1]) + m[2] * v[2])
    }

    fn point(&self, v: Vec3) -> B3 {
        let turned = self.direction(v);
        [0, 1, 2].map(|i| turned[i] + self.rows[i][3])
    }

    fn nearness(&self, t: Ball) -> Ball {
        if self.perspective { ONE / t } else { -t }
    }

    fn place(&self, position: Vec3, normal: Vec3) -> Place {
        let (p, n) = (self.point(position), self.direction(normal));
        let t = -p[2];
        let m = if self.perspective { ONE / t } else { ONE };
        let d = if self.perspective { [p[0] * m, p[1] * m] } else { [ZERO; 2] };
        let g = (n[0] * d[0] + n[1] * d[1]) - n[2];
        Place { p, n, t, d, scale: self.f.map(|f| f * m), g }
    }

    fn disc(&self, place: &Place, r: Ball) -> Form {
        let Place { n, d: [dx, dy], .. } = *place;
        let s = r / self.k;
        let [rx, ry] = place.scale.map(|scale| s * scale);
        let c = [-(dx * n[1]), (dx * n[0]) - n[2], n[1]];
        let e = [n[2] - (dy * n[1]), dy * n[0], -n[0]];
        Form {
            xx: (rx * rx) * dot(c, c),
            xy: -((rx * ry) * dot(c, e)),
            yy: (ry * ry) * dot(e, e),
            area: ((rx * ry) * place.g).abs(),
            half: r * (n[0] * n[0] + n[1] * n[1]).sqrt(),
            radius: r,
        }
    }

    fn ellipse(&self, place: &Place, tangents: [Vec3; 2]) -> Form {
        let turned = tangents.map(|v| self.direction(v));
        let [u, v] = turned.map(|t| t.map(|x| x / self.k));
        let ([sx, sy], [dx, dy]) = (place.scale, place.d);
        let a = |u: B3| sx * (u[0] + dx * u[2]);
        let b = |u: B3| -(sy * (u[1] + dy * u[2]));
        let cross = |i: usize, j: usize| u[i] * v[j] - u[j] * v[i];
        let facing = (cross(1, 2) * dx + cross(2, 0) * dy) - cross(0, 1);
        Form {
            xx: a(u) * a(u) + a(v) * a(v),
            xy: a(u) * b(u) + a(v) * b(v),
            yy: b(u) * b(u) + b(v) * b(v),
            area: ((sx * sy) * facing).abs(),
            half: self.k * (u[2] * u[2] + v[2] * v[2]).sqrt(),
            radius: (dot(turned[0], turned[0]) + dot(turned[1], turned[1])).sqrt(),
        }
    }

    /// Whether a sphere about the centre is beyond a side of the view.
    fn beyond(&self, place: &Place, radius: Ball) -> Option<bool> {
        let reach = self.k * self.h.sqrt();
        let t = if self.perspective { place.t } else { ONE };
        let side = |i: usize, along: Ball, room: Ball| {
            let f = self.f[i];
            let slope = if self.perspective { (f * f + room * room).sqrt() } else { f };
            let past = -(radius * slope + reach * t);
            (f * along + room * t).compare(past).map(Ordering::is_lt)
        };
        let room = |i: usize| Ball::exact(self.size[i].into()) - self.c[i];
        let [x, y, _] = place.p;
        any(&[
            side(0, x, self.c[0]),
            side(0, -x, room(0)),
            side(1, -y, self.c[1]),
            side(1, y, room(1)),
        ])
    }

    /// The pixels of an axis whose centres may lie in `center` +- `extent`, widened.
    fn span(&self, axis: usize, center: Ball, extent: Ball, stretch: Ball) -> [u32; 2] {
        let part = Ball::exact(1.0 / f64::from(1 << 18));
        let extent = extent * (ONE + part * stretch) + Ball::exact(1.0 / 128.0);
        // The first whose centre lies after a position; beyond the picture the cast saturates.
        let after = |at: f64| ((at + 0.5).floor() as u32).min(self.size[axis]);
        let (low, high) = (center - extent, center + extent);
        if low.bounded() && high.bounded() {
            [after(low.low()), after(high.high())]
        } else {
            [0, self.size[axis]]
        }
    }

    pub(crate) fn splat(&self, surfels: &Surfels, i: usize) -> Splat {
        let place = self.place(surfels.position()[i], surfels.normal()[i]);
        let radius = Ball::exact(surfels.radius()[i].into());
        let form = surfels
            .tangents()
            .map_or_else(|| self.disc(&place, radius), |all| self.ellipse(&place, all[i]));
        let Place { p, n, t, d, g, .. } = place;
        let Form { xx, xy, yy, area, half, radius } = form;
        let h = self.h;
        let det = (area * area + h * (xx + yy)) + h * h;
        let (wide, tall) = (xx + h, yy + h);
        let ux = (tall / det).sqrt();
        let factor = [ux, -((xy / tall) * ux), ONE / tall.sqrt()];
        let amplitude = area / det.sqrt();
        let seen = if self.perspective { d } else { [p[0], p[1]] };
        let center = [self.c[0] + self.f[0] * seen[0], self.c[1] - self.f[1] * seen[1]];
        let m = if self.perspective { ONE / t } else { ONE };
        let slope = |i: usize| (m * n[i]) / (self.f[i] * g);
        let plane = [self.nearness(t), slope(0), -slope(1)];
        let range = [t + half, (t - half).at_least(self.near)].map(|t| self.nearness(t));
        let stretch = ux * wide.sqrt();
        let span = |axis: usize, v: Ball| self.span(axis, center[axis], self.k * v.sqrt(), stretch);
        let bounds = [span(0, wide), span(1, tall)];
        let numbers = [center[0], center[1], factor[0], factor[1], factor[2], amplitude];
        let finite = numbers.iter().chain(&plane).chain(&range).all(|ball| ball.bounded());
        let reasons = [
            t.compare(self.near).map(Ordering::is_le),
            amplitude.compare(SMALL).map(Ordering::is_lt),
            plane[1].abs().compare(HUGE).map(Ordering::is_gt),
            plane[2].abs().compare(HUGE).map(Ordering::is_gt),
            // Exact infinities come of g = 0, which makes the gradient one too.
            finite.then_some(false),
            if self.cull { g.compare(ZERO).map(Ordering::is_ge) } else { Some(false) },
            self.beyond(&place, radius),
        ];
        Splat { center, factor, plane, range, bounds, drawn: any(&reasons).map(|any| !any) }
    }

    pub(crate) fn fragment(&self, splat: &Splat, pixel: [u32; 2]) -> Fragment {
        let at = |i: usize| (Ball::exact(pixel[i].into()) + HALF) - splat.center[i];
        let (dx, dy) = (at(0), at(1));
        let ([ux, uy, vy], [w0, wx, wy], [far, near]) = (splat.factor, splat.plane, splat.range);
        let (u, v) = (ux * dx + uy * dy, vy * dy);
        let w = ((w0 + wx * dx) + wy * dy).clamped(far, near);
        let t = if self.perspective { ONE / w } else { -w };
        Fragment { q: u * u + v * v, w, t }
    }
}
