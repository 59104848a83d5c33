//! The first pass: from surfels to records of splats.

use super::bug::Bug;
use super::habit::Habit;
use super::number::{Number, Vector, dot};
use super::view::Shared;
use splatref::scene::Surfels;
use splatref::splat::Outline;
use splatref::splat::record::SplatRecord;

/// What fits the footprint: 2^96, beyond which it is not drawn.
const LARGEST: f32 = f32::from_bits((127 + 96) << 23);

/// A splat: what a vertex shader hands to the fragments.
#[derive(Clone, Copy)]
pub(crate) struct Splat {
    pub(crate) surfel: u32,
    /// Whether its back is seen.
    pub(crate) back: bool,
    /// Column and row, in pixels.
    pub(crate) center: [Number; 2],
    /// The Cholesky factor of the conic.
    pub(crate) ux: Number,
    pub(crate) uy: Number,
    pub(crate) vy: Number,
    /// The plane of nearness, relative to the centre.
    pub(crate) w0: Number,
    pub(crate) wx: Number,
    pub(crate) wy: Number,
    pub(crate) w_far: Number,
    pub(crate) w_near: Number,
    pub(crate) amplitude: Number,
    pub(crate) quad: Quad,
}

impl Splat {
    /// The splat as the buffer between the passes holds it.
    fn stored(self) -> Self {
        let [x, y] = self.center;
        Self {
            center: [x.stored(), y.stored()],
            ux: self.ux.stored(),
            uy: self.uy.stored(),
            vy: self.vy.stored(),
            w0: self.w0.stored(),
            wx: self.wx.stored(),
            wy: self.wy.stored(),
            w_far: self.w_far.stored(),
            w_near: self.w_near.stored(),
            amplitude: self.amplitude.stored(),
            ..self
        }
    }

    /// The splat with the attributes of its surfel, in the layout of the crate.
    pub(crate) fn record(&self, surfels: &Surfels) -> SplatRecord {
        let i = self.surfel as usize;
        let normal = surfels.normal()[i].to_array();
        let ([left, right], [top, bottom]) = (self.quad.x, self.quad.y);
        SplatRecord {
            center: self.center.map(|number| number.value),
            conic: [self.ux, self.uy, self.vy].map(|number| number.value),
            plane: [self.w0, self.wx, self.wy].map(|number| number.value),
            range: [self.w_far, self.w_near].map(|number| number.value),
            amplitude: self.amplitude.value,
            surfel: self.surfel,
            bounds: [left, top, right, bottom],
            normal: if self.back { normal.map(|component| -component) } else { normal },
            opacity: 1.0,
            color: surfels.color().map_or([0.0; 3], |color| color[i].to_array()),
            back: self.back.into(),
        }
    }
}

/// A rectangle of pixels, each side a first and a past-the-last one.
#[derive(Clone, Copy)]
pub(crate) struct Quad {
    pub(crate) x: [u32; 2],
    pub(crate) y: [u32; 2],
}

/// A surfel before the camera.
struct Placed {
    p: Vector,
    n: Vector,
    radius: Number,
    /// Depth of the centre.
    t: Number,
    /// 1/t, or 1 under an orthographic camera.
    m: Number,
    /// The ray through the centre is (d, -1).
    d: [Number; 2],
    /// Pixels per world unit at the centre.
    scale: [Number; 2],
    /// < 0: the front is seen.
    g: Number,
    center: [Number; 2],
}

/// What depends on the outline.
struct Outlined {
    center: [Number; 2],
    w0: Number,
    /// ux, uy and vy.
    factor: [Number; 3],
    amplitude: Number,
    quad: Quad,
}

/// A Gaussian on the screen.
#[derive(Clone, Copy)]
struct Shape {
    center: [Number; 2],
    w0: Number,
    xx: Number,
    xy: Number,
    yy: Number,
    /// The root of the determinant.
    area: Number,
}

/// The splats that are drawn, in the order of their surfels.
pub(crate) fn project(shared: &Shared<'_>) -> Vec<Splat> {
    let count = u32::try_from(shared.scene.surfels.len()).unwrap();
    let mut splats: Vec<_> =
        (0..count).filter_map(|surfel| Some(splat(shared, surfel)?.stored())).collect();
    if shared.how.has(Bug::SplatMissing) && !splats.is_empty() {
        splats.remove(splats.len() / 2);
    }
    splats
}

fn splat(shared: &Shared<'_>, surfel: u32) -> Option<Splat> {
    let placed = place(shared, surfel as usize);
    // What lies behind has no projection.
    if !(placed.t > shared.near) {
        return None;
    }
    let (disc, half, tilt) = disc(shared, &placed);
    let Outlined { center, w0, factor, amplitude, quad } =
        outlined(shared, &placed, disc, half, tilt);
    let [nx, ny, _] = placed.n;
    let slope = (placed.m * ny) / (shared.fy * placed.g);
    let nearer = (placed.t - half).larger(shared.near);
    let splat = Splat {
        surfel,
        back: placed.g.value >= 0.0,
        center,
        ux: factor[0],
        uy: if shared.how.has(Bug::SkewSign) { -factor[1] } else { factor[1] },
        vy: factor[2],
        w0,
        wx: (placed.m * nx) / (shared.fx * placed.g),
        wy: if shared.how.has(Bug::SlopeSign) { slope } else { -slope },
        w_far: shared.nearness(placed.t + half),
        w_near: shared.nearness(nearer),
        amplitude: match shared.how.bug {
            Some(Bug::AmplitudeMissing) => shared.number(1.0),
            _ => amplitude,
        },
        quad,
    };
    let culled = match shared.how.bug {
        Some(Bug::CullingInverted) => shared.cull && placed.g.value <= 0.0,
        Some(Bug::CullingIgnored) => false,
        _ => shared.cull && placed.g.value >= 0.0,
    };
    let drawn = !degenerate(&splat) && !culled && touches(shared, &placed);
    drawn.then_some(splat)
}

/// The shape of a splat by the outline of the picture.
fn outlined(
    shared: &Shared<'_>,
    placed: &Placed,
    disc: Shape,
    half: Number,
    tilt: [Number; 2],
) -> Outlined {
    // A disc that reaches the near plane has no ellipse.
    let whole = shared.perspective && placed.t - half > shared.near;
    let ellipse = if whole { exact(shared, placed, disc, half, tilt) } else { disc };
    match shared.outline {
        Outline::Affine => gaussian(shared, disc),
        Outline::Perspective => gaussian(shared, ellipse),
        Outline::RayCast if shared.perspective && !whole => {
            let [width, height] = shared.size;
            ray_cast(shared, disc, Quad { x: [0, width], y: [0, height] })
        }
        Outline::RayCast => {
            let one = shared.number(1.0);
            let ratio = if shared.perspective { placed.t / (placed.t - half) } else { one };
            ray_cast(shared, disc, ray_quad(shared, disc, ellipse, ratio))
        }
    }
}

fn place(shared: &Shared<'_>, index: usize) -> Placed {
    let surfels = &shared.scene.surfels;
    let (p, normal) = (shared.point(surfels.position()[index]), surfels.normal()[index]);
    let n = match shared.how.bug {
        Some(Bug::NormalsTransposed) => {
            let column = |j: usize| shared.rows.map(|row| row[j]);
            let normal = shared.vector(normal.to_array());
            [0, 1, 2].map(|j| dot(column(j), normal))
        }
        _ => shared.direction(normal),
    };
    let (t, one, zero) = (-p[2], shared.number(1.0), shared.number(0.0));
    let m = if shared.perspective { one / t } else { one };
    let d = if shared.perspective { [p[0] * m, p[1] * m] } else { [zero, zero] };
    let [x, y] = if shared.perspective { d } else { [p[0], p[1]] };
    Placed {
        p,
        n,
        radius: shared.number(surfels.radius()[index]),
        t,
        m,
        d,
        scale: [shared.fx * m, shared.fy * m],
        g: (n[0] * d[0] + n[1] * d[1]) - n[2],
        center: [shared.cx + shared.fx * x, shared.cy - shared.fy * y],
    }
}

/// The projection linearized at the centre; half the disc's range of depth; how nearness grows.
fn disc(shared: &Shared<'_>, placed: &Placed) -> (Shape, Number, [Number; 2]) {
    let Placed { n: [nx, ny, nz], d: [dx, dy], scale: [sx, sy], .. } = *placed;
    let s = match shared.how.bug {
        Some(Bug::RadiusNotDivided) => placed.radius,
        _ => placed.radius / shared.cutoff,
    };
    let (rx, ry) = (s * sx, s * sy);
    let c = [-(dx * ny), dx * nx - nz, ny];
    let e = [nz - dy * ny, dy * nx, -nx];
    let flat = nx * nx + ny * ny;
    let z = [-(nz * nx), -(nz * ny), flat].map(|z| z * (s * s));
    let tilt = [(sx * (z[0] + dx * z[2])) * placed.m, -(sy * (z[1] + dy * z[2])) * placed.m];
    let shape = Shape {
        center: placed.center,
        w0: if shared.perspective { placed.m } else { -placed.t },
        xx: (rx * rx) * dot(c, c),
        xy: -((rx * ry) * dot(c, e)),
        yy: (ry * ry) * dot(e, e),
        area: ((rx * ry) * placed.g).abs(),
    };
    (shape, placed.radius * flat.sqrt(), tilt)
}

/// The ellipse that is the projection of the disc.
fn exact(
    shared: &Shared<'_>,
    placed: &Placed,
    disc: Shape,
    half: Number,
    tilt: [Number; 2],
) -> Shape {
    let t = placed.t;
    let rest = ((t - half) / t) * ((t + half) / t);
    let factor = (shared.cutoff * shared.cutoff) / rest;
    let [x, y] = tilt;
    Shape {
        center: [disc.center[0] + factor * x, disc.center[1] + factor * y],
        w0: placed.m / rest,
        xx: (disc.xx + factor * (x * x)) / rest,
        xy: (disc.xy + factor * (x * y)) / rest,
        yy: (disc.yy + factor * (y * y)) / rest,
        area: (disc.area / rest) / rest.sqrt(),
    }
}

/// A Gaussian with the low-pass filter.
fn gaussian(shared: &Shared<'_>, shape: Shape) -> Outlined {
    let Shape { center, w0, xy, area, .. } = shape;
    let h = match shared.how.bug {
        Some(Bug::LowPassOnRadius) => shared.low_pass * (area.sqrt() * 2.0 + shared.low_pass),
        _ => shared.low_pass,
    };
    let (xx, yy) = (shape.xx + h, shape.yy + h);
    let det = (area * area + h * (shape.xx + shape.yy)) + h * h;
    let ux = (yy / det).sqrt();
    let factor = [ux, -((xy / yy) * ux), yy.sqrt().reciprocal()];
    let extent = [xx, yy].map(|variance| shared.cutoff * variance.sqrt());
    let sides = sides(shared, center, extent, ux * xx.sqrt());
    Outlined { center, w0, factor, amplitude: area / det.sqrt(), quad: quad(shared, sides) }
}

/// The form in the disc's plane.
fn ray_cast(shared: &Shared<'_>, disc: Shape, quad: Quad) -> Outlined {
    let Shape { center, w0, xy, yy, area, .. } = disc;
    let scale = if shared.perspective { w0 } else { shared.number(1.0) };
    let root = yy.sqrt();
    let ux = (scale * root) / area;
    let factor = [ux, -((xy / yy) * ux), scale / root];
    let amplitude = shared.number(if area.value == 0.0 { 0.0 } else { 1.0 });
    Outlined { center, w0, factor, amplitude, quad }
}

/// The quad around the outline and around the circle of the filter.
fn ray_quad(shared: &Shared<'_>, disc: Shape, ellipse: Shape, ratio: Number) -> Quad {
    let circle = shared.cutoff * shared.low_pass.sqrt();
    let filter = sides(shared, disc.center, [circle, circle], shared.number(1.0));
    let stretch = (ellipse.xx.sqrt() * ellipse.yy.sqrt()) / ellipse.area * ratio;
    let extent = [ellipse.xx, ellipse.yy].map(|variance| shared.cutoff * variance.sqrt());
    let outline = sides(shared, ellipse.center, extent, stretch);
    let both = [0, 1].map(|axis| {
        let ([a, b], [c, d]): ([f32; 2], [f32; 2]) = (filter[axis], outline[axis]);
        [if c < a { c } else { a }, if d > b { d } else { b }]
    });
    quad(shared, both)
}

/// How far a splat reaches from its centre along each axis, widened for rounding.
fn sides(
    shared: &Shared<'_>,
    center: [Number; 2],
    extent: [Number; 2],
    stretch: Number,
) -> [[f32; 2]; 2] {
    [0, 1].map(|axis| {
        let extent = extent[axis].value;
        let reach = match shared.how.bug {
            Some(Bug::QuadsTooSmall) => 0.9 * extent,
            Some(Bug::QuadsFloored) => extent.floor(),
            _ => extent * (1.0 + stretch.value / 65_536.0) + 0.0625,
        };
        let wide = if shared.how.habit == Habit::WideQuads { 3.0 } else { 0.0 };
        [center[axis].value - reach - wide, center[axis].value + reach + wide]
    })
}

/// The pixels whose centres lie in a rectangle.
fn quad(shared: &Shared<'_>, sides: [[f32; 2]; 2]) -> Quad {
    let pixels = |axis: usize| {
        let [low, high] = sides[axis];
        // The conversion saturates: at 0, and a rectangle of NaN is empty.
        let past = ((high - 0.5).floor() + 1.0) as u32;
        [(low - 0.5).ceil() as u32, past.min(shared.size[axis])]
    };
    Quad { x: pixels(0), y: pixels(1) }
}

fn degenerate(splat: &Splat) -> bool {
    let Splat { center: [x, y], ux, uy, vy, w0, wx, wy, w_far, w_near, amplitude, .. } = *splat;
    let numbers = [x, y, ux, uy, vy, w0, wx, wy, w_far, w_near, amplitude];
    amplitude.value < 1.0 / LARGEST
        || wx.abs().value > LARGEST
        || wy.abs().value > LARGEST
        || numbers.iter().any(|number| !number.value.is_finite())
}

/// Whether the sphere around a disc reaches into the view.
fn touches(shared: &Shared<'_>, placed: &Placed) -> bool {
    let [x, y, _] = placed.p;
    let [width, height] = shared.size.map(|size| shared.number(size as f32));
    let reach = shared.cutoff * shared.low_pass.sqrt();
    let outside = |f: Number, c: Number, p: Number| {
        if shared.perspective {
            let slant = (f * f + c * c).sqrt();
            f * p + c * placed.t < -(placed.radius * slant + reach * placed.t)
        } else {
            f * p + c < -(f * placed.radius + reach)
        }
    };
    !(outside(shared.fx, shared.cx, x)
        || outside(shared.fx, width - shared.cx, -x)
        || outside(shared.fy, shared.cy, -y)
        || outside(shared.fy, height - shared.cy, y))
}
