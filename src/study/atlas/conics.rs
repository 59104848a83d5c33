//! Boxes of a projected disc as the textbooks have them, from its outline as a conic.
//!
//! **The mapping** \[ZRB+04, section 3\]. U and V are the half axes of a disc and p its centre, each
//! (x, y, t) in view space with the depth t instead of z. Its plane maps to the picture plane t = 1 by
//!
//! ```text
//!   (x, y, 1) ~ (u, v, 1) M      M: the rows U, V and p      the rim: (u, v, 1) D (u, v, 1)^T = 0
//!                                                            D = diag(1, 1, -1)
//! ```
//!
//! **Centred** \[ZRB+04, section 3\]. The rim in the picture is the conic Q = M^-1 D M^-T, and its box is that
//! of the conic moved to its centre:
//!
//! ```text
//!   Q = [a b d; b c e; d e -f]              a x x + 2 b x y + c y y + 2 d x + 2 e y = f
//!   det = a c - b b                         x_t = (b e - c d) / det      y_t = (b d - a e) / det
//!   level = f - d x_t - e y_t
//!   x_t +- sqrt(c level / det)              y_t +- sqrt(a level / det)
//! ```
//!
//! M^-1 is taken by its adjugate, of columns V x p, p x U and U x V; the factor 1 / det M is left out, for
//! a multiple of Q is the same conic.
//!
//! **Homogeneous** \[WHA+07\], after the boxes of quadrics of Sigg, Weyrich, Botsch and Gross (2006). A line
//! x = s is tangent to the rim where s is a root of a square equation in H = M^T D M, which is the dual of Q, so
//! that nothing is inverted:
//!
//! ```text
//!   h_ij = U_i U_j + V_i V_j - p_i p_j
//!   x = (h_13 +- sqrt(h_13 h_13 - h_11 h_33)) / h_33       and so for y, with h_23 and h_22
//! ```
//!
//! `h_33` < 0 where the disc is before the plane of the eye, t = 0, all of it. Where the disc crosses that plane
//! the rim is a hyperbola, and its two tangents have the gap between its branches between them.
//!
//! `Decided:` both formulas are taken from work that quotes them; a test holds both boxes to a sampled rim.

use super::case::both;
use super::numbers::{Facing, ahead, outside, shown, tilted, visible};
use super::{Failure, Found};
use crate::error::{Error, Result};
use crate::frame::{Exec, Plane};
use crate::number::elementary::{cos, sin};
use crate::number::{Exact, Real, Vector3};
use crate::splat::{Disc, Fate, Kernel, Outline, Projector, View, project};
use glam::DVec3;

pub(super) const FAILURES: [Failure; 2] = [
    Failure {
        id: "bounds-conic",
        title: "The centred conic of a small splat loses its digits",
        why: "Sixteen discs are spread over a picture of 90 degrees, and their planes are tilted \
              by 30 degrees to the ray. [ZRB+04, 3] writes the outline as the conic a x^2 + 2 b x \
              y + c y^2 + 2 d x + 2 e y = f, from the inverse of (U, V, p), and moves the conic to \
              its centre. The move leaves only f - d x_t - e y_t of f. This fraction is as small \
              as the squared ratio of the splat's size to its distance from the axis, so f32 loses \
              digits. At 1024 radii a disc has a radius of 1 px in a picture 2048 px wide. The \
              error is the largest error of a side of the box in f32, as a fraction of half the \
              box; it is 1 where no ellipse is left. Pictures: each disc magnified at its place in \
              the picture; light is right, red is missing, blue is too much.",
        swept: "distance, radii",
        values: &[4.0, 16.0, 64.0, 128.0, 256.0, 512.0, 1024.0, 2048.0],
        error: "error of the box, part of half its side",
        limit: 0.1,
        cure: "`--outline perspective`: centre and covariance from a rank-one update, without a \
               conic; see `splat::project`",
        at: conic,
    },
    Failure {
        id: "bounds-hyperbola",
        title: "The box of a hyperbola is the gap between its branches",
        why: "A disc is tilted by 45 degrees, 20 degrees off the axis. [WHA+07] takes the box from \
              tangents, x = (h_13 +- sqrt(h_13^2 - h_11 h_33)) / h_33 with h_ij = U_i U_j + V_i \
              V_j - p_i p_j. The box is exact as long as the whole disc is in front of the eye. \
              Below 0.71 radii the near half is not in front. Then the outline is a hyperbola, and \
              the two tangents enclose the gap between its branches; or the root is of a negative \
              number, so that there is no box. Pictures: the disc is light inside the box and red \
              outside; blue is the rest of the box.",
        swept: "distance, radii",
        values: &[4.0, 2.0, 1.0, 0.8, 0.72, 0.7, 0.6, 0.35],
        error: "pixels of the disc outside, per mille",
        limit: 10.0,
        cure: "bounds of the part in front of the near plane, with room for rounding; see \
               `splat::crossing`",
        at: hyperbola,
    },
];

/// The rows of M; see the module.
#[derive(Clone, Copy, Debug)]
struct Mapping<R> {
    u: Vector3<R>,
    v: Vector3<R>,
    p: Vector3<R>,
}

/// The middle and half the side of a box, in x and y.
type Sides = [[f64; 2]; 2];

/// A conic about its centre: a x^2 + 2 b x y + c y^2 = level.
#[derive(Clone, Copy, Debug)]
struct Centred<R> {
    form: [R; 3],
    level: R,
    center: [R; 2],
}

impl<R: Real> Mapping<R> {
    /// The conic of the outline, moved to its centre.
    fn centred(&self) -> Centred<R> {
        let columns = [self.v.cross(self.p), self.p.cross(self.u), self.u.cross(self.v)];
        let [x, y, one] = [columns.map(|c| c.x), columns.map(|c| c.y), columns.map(|c| c.z)];
        let q = |m: [R; 3], n: [R; 3]| (m[0] * n[0] + m[1] * n[1]) - m[2] * n[2];
        let (a, b, c) = (q(x, x), q(x, y), q(y, y));
        let (d, e, f) = (q(x, one), q(y, one), -q(one, one));
        let det = a * c - b * b;
        let center = [(b * e - c * d) / det, (b * d - a * e) / det];
        let level = (f - d * center[0]) - e * center[1];
        Centred { form: [a, b, c], level, center }
    }

    /// The two tangents of each axis, in any order; NaN where there are none.
    fn tangents(&self) -> [[R; 2]; 2] {
        let Self { u, v, p } = *self;
        let h = |[a, b, c]: [R; 3], [d, e, f]: [R; 3]| (a * d + b * e) - c * f;
        let t = [u.z, v.z, p.z];
        [[u.x, v.x, p.x], [u.y, v.y, p.y]].map(|k| {
            let root = (h(k, t) * h(k, t) - h(k, k) * h(t, t)).sqrt();
            [(h(k, t) - root) / h(t, t), (h(k, t) + root) / h(t, t)]
        })
    }
}

impl Mapping<f32> {
    /// The same disc in f64, exactly.
    fn wide(&self) -> Mapping<f64> {
        let [u, v, p] = [self.u, self.v, self.p].map(|v| v.map(f64::from));
        Mapping { u, v, p }
    }
}

impl Mapping<f64> {
    /// The box between the tangents.
    fn sides(&self) -> Sides {
        self.tangents().map(|[one, other]| [f64::midpoint(one, other), (one - other).abs() / 2.0])
    }
}

impl<R: Exact> Centred<R> {
    /// The box; `None` if the conic is not an ellipse.
    fn sides(&self) -> Option<Sides> {
        let ([a, b, c], level) = (self.form, self.level);
        let det = a * c - b * b;
        let half = [(c * level / det).sqrt(), (a * level / det).sqrt()];
        let sides = [0, 1].map(|k| [self.center[k].to_f64(), half[k].to_f64()]);
        // Written so that NaN fails the comparison.
        (a > R::ZERO && det > R::ZERO && level > R::ZERO).then_some(sides)
    }

    /// Whether a point is inside.
    fn holds(&self, x: f64, y: f64) -> bool {
        let ([a, b, c], [xt, yt]) = (self.form.map(R::to_f64), self.center.map(R::to_f64));
        let (dx, dy) = (x - xt, y - yt);
        a * dx * dx + 2.0 * b * dx * dy + c * dy * dy <= self.level.to_f64()
    }
}

/// The same conic, from the crate's own footprint of a disc in f32.
fn by_footprint(disc: &Mapping<f32>) -> Result<Centred<f64>> {
    let world = |v: Vector3<f32>| Vector3::new(v.x, v.y, -v.z);
    let normal = disc.u.cross(disc.v).normalized();
    let disc = Disc {
        position: world(disc.p),
        normal: world(normal),
        radius: 1.0,
        tangents: Some([world(disc.u), world(disc.v)]),
    };
    // Large enough that the farthest disc has a few pixels.
    let camera = ahead(4096, 2048.0)?;
    let kernel = Kernel { outline: Outline::Perspective, low_pass: 0.0, cutoff: 1.0 };
    let projector = Projector::new(View::new(&camera), &kernel, false);
    let (splat, reasons) = project::<f32>(&projector, &disc, 0);
    if reasons.fate() != Fate::Visible {
        return Err(Error::Invalid(format!("the disc is not drawn: {:?}", reasons.fate())));
    }
    let footprint = splat.footprint.map(f64::from);
    let [fx, fy, cx, cy] = [camera.fx, camera.fy, camera.cx, camera.cy].map(f64::from);
    let (ux, uy, vy) = (footprint.ux * fx, -footprint.uy * fy, footprint.vy * fy);
    let center = [(footprint.center.x - cx) / fx, (cy - footprint.center.y) / fy];
    Ok(Centred { form: [ux * ux, ux * uy, uy * uy + vy * vy], level: 1.0, center })
}

/// How many discs a row has, and how many pixels the cell of a disc has.
const CELLS: u32 = 4;
const CELL: u32 = 60;

/// The k-th disc, with radius 1 and its centre at a distance from the plane of the eye.
fn small(k: u32, distance: f64) -> Mapping<f32> {
    let [x, y] = [k % CELLS, k / CELLS].map(|i| (f64::from(i) - 1.5) / 2.0);
    // The first row is at the top.
    let ray = DVec3::new(x, -y, 1.0);
    let along = ray.normalize();
    let side = along.cross(DVec3::Y).normalize();
    let up = along.cross(side);
    // Each disc is turned by another angle.
    let turn = 1.0 + f64::from(k);
    let u = side * cos(turn) + up * sin(turn);
    let across = up * cos(turn) - side * sin(turn);
    let slant = 30_f64.to_radians();
    let v = across * sin(slant) + along * cos(slant);
    let [u, v, p] = [u, v, ray * distance].map(|v| Vector3::from_glam(v.as_vec3()));
    Mapping { u, v, p }
}

fn conic(distance: f64, _: &Exec) -> Result<[Found; 2]> {
    both(|cured| small_ones(distance, cured))
}

/// Draws all small discs with the boxes of the crate's footprints, or of the textbook.
fn small_ones(distance: f64, cured: bool) -> Result<Found> {
    let mut picture = Plane::filled(CELLS * CELL, CELLS * CELL, [0.0; 3]);
    let mut most = 0.0;
    for k in 0..CELLS * CELLS {
        let disc = small(k, distance);
        let truth = disc.wide();
        let (sides, drawn) = if cured {
            let conic = by_footprint(&disc)?;
            (conic.sides(), conic)
        } else {
            let Centred { form, level, center } = disc.centred();
            let wide = Centred {
                form: form.map(f64::from),
                level: level.into(),
                center: center.map(f64::from),
            };
            (disc.centred().sides(), wide)
        };
        let error = sides.map_or(1.0, |sides| off(&sides, &truth.sides()));
        most = if error <= most { most } else { error };
        let drawn = sides.map(|_| drawn);
        paint(&mut picture, k, &truth, |x, y| drawn.is_some_and(|conic| conic.holds(x, y)));
    }
    Ok(Found { error: most, picture, time: None })
}

/// The largest error of a side of the box, as a fraction of half the true side.
fn off(found: &Sides, truth: &Sides) -> f64 {
    let errors = found.iter().zip(truth).map(|([middle, half], [true_middle, true_half])| {
        ((middle - true_middle).abs() + (half - true_half).abs()) / true_half
    });
    errors.fold(0.0, |most, error| if error <= most { most } else { error })
}

/// Draws a disc in its cell, which is one and a half times the size of its box.
fn paint(
    picture: &mut Plane<[f32; 3]>,
    k: u32,
    disc: &Mapping<f64>,
    found: impl Fn(f64, f64) -> bool,
) {
    let (conic, [[x, half_x], [y, half_y]]) = (disc.centred(), disc.sides());
    let half = 1.5 * if half_x > half_y { half_x } else { half_y };
    for (i, pixel) in (0..).zip(picture.values_mut()) {
        let (column, row) = (i % (CELLS * CELL), i / (CELLS * CELL));
        if (column / CELL, row / CELL) == (k % CELLS, k / CELLS) {
            let [dx, dy] = [column, row]
                .map(|v| half * ((f64::from(v % CELL) + 0.5) / (0.5 * f64::from(CELL)) - 1.0));
            *pixel = shown(conic.holds(x + dx, y - dy), found(x + dx, y - dy));
        }
    }
}

/// The direction in which the disc that crosses the plane of the eye is tilted: not along an axis
/// of the picture.
fn askew() -> DVec3 {
    let turn = 30_f64.to_radians();
    DVec3::new(cos(turn), sin(turn), 0.0)
}

/// The disc of [`tilted`]; its first half axis comes nearest to the eye.
fn crossing(distance: f64) -> Mapping<f64> {
    let Facing { center, normal } = tilted(distance, askew());
    let three = |v: DVec3| Vector3::new(v.x, v.y, -v.z);
    let level = DVec3::Z.cross(askew());
    Mapping { u: three(level.cross(normal)), v: three(level), p: three(center) }
}

fn hyperbola(distance: f64, _: &Exec) -> Result<[Found; 2]> {
    const SIDE: u32 = 240;
    // A wide lens, so that the picture shows the surroundings of the disc.
    let camera = ahead(SIDE, 0.25 * f64::from(SIDE))?;
    let disc = tilted(distance, askew());
    let rect = visible(&camera, disc);
    let [[x, half_x], [y, half_y]] = crossing(distance).sides();
    let boxed = |column, row| {
        let [px, py] = [column, row].map(|v| f64::from(v) + 0.5 - 0.5 * f64::from(SIDE));
        let [px, py] = [px, -py].map(|v| v / f64::from(camera.fx));
        // Written so that NaN fails the comparisons.
        (px - x).abs() <= half_x && (py - y).abs() <= half_y
    };
    Ok([
        outside(&camera, disc, boxed),
        outside(&camera, disc, |x, y| rect.is_some_and(|rect| rect.contains(x, y))),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of the rim, each with its depth.
    fn rim(disc: &Mapping<f64>) -> impl Iterator<Item = ([f64; 2], f64)> {
        const COUNT: u32 = 1 << 14;
        let Mapping { u, v, p } = *disc;
        (0..COUNT).map(move |i| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(COUNT);
            let at = p + u * cos(angle) + v * sin(angle);
            ([at.x / at.z, at.y / at.z], at.z)
        })
    }

    fn sampled(disc: &Mapping<f64>) -> Sides {
        let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for (point, depth) in rim(disc) {
            assert!(depth > 0.0);
            for (end, v) in ends.iter_mut().zip(point) {
                *end = [end[0].at_most(v), end[1].at_least(v)];
            }
        }
        ends.map(|[low, high]| [f64::midpoint(low, high), (high - low) / 2.0])
    }

    /// While the whole disc is in front of the eye, both textbooks are right up to rounding, so the
    /// errors in the atlas are not caused by a slip in its formulas.
    #[test]
    fn boxes_of_ellipses_are_those_of_the_sampled_rim() {
        let far = [2.0, 8.0, 64.0, 2048.0];
        let small = far.iter().flat_map(|t| (0..CELLS * CELLS).map(|k| small(k, *t).wide()));
        for disc in small.chain([4.0, 1.0, 0.75].map(crossing)) {
            let rim = sampled(&disc);
            let centred = disc.centred().sides().unwrap();
            // The samples miss the ends by the square of half a step.
            assert!(off(&centred, &rim) < 1e-6, "{centred:?} {rim:?}");
            assert!(off(&disc.sides(), &rim) < 1e-6, "{:?} {rim:?}", disc.sides());
        }
    }

    /// The conic matches the rim, not only its box.
    #[test]
    fn the_centred_conic_goes_through_the_rim() {
        for disc in [small(3, 8.0).wide(), small(6, 2.0).wide(), crossing(1.0)] {
            let Centred { form: [a, b, c], level, center } = disc.centred();
            for ([x, y], _) in rim(&disc) {
                let (dx, dy) = (x - center[0], y - center[1]);
                let value = a * dx * dx + 2.0 * b * dx * dy + c * dy * dy;
                assert!((value - level).abs() <= 1e-9 * level, "{value} {level}");
            }
        }
    }

    /// No point of a disc that crosses the plane of the eye lies between its tangents, in x or in
    /// y.
    #[test]
    fn the_box_of_a_hyperbola_is_its_gap() {
        for (distance, axis) in [(0.7, 0), (0.7, 1), (0.69, 0), (0.69, 1), (0.6, 0)] {
            let disc = crossing(distance);
            let [middle, half] = disc.sides()[axis];
            let mut points = [0_u32; 2];
            for (at, depth) in rim(&disc) {
                assert!((at[axis] - middle).abs() >= half * (1.0 - 1e-6), "{at:?}");
                assert_eq!(at[axis] < middle, depth > 0.0, "what is seen is on one side");
                points[usize::from(depth > 0.0)] += 1;
            }
            assert!(half > 0.0 && points.iter().all(|count| *count > 0), "both branches");
        }
        for (distance, axis) in [(0.6, 1), (0.35, 0), (0.35, 1)] {
            assert!(crossing(distance).sides()[axis][1].is_nan(), "no tangent: {distance}");
        }
    }
}
