//! Judge a part of a picture: only what may touch it needs a projection.

use super::algorithm::Job;
use crate::frame::Rect;
use crate::number::{MapInline, Real, Vector3};
use crate::scene::Camera;
use crate::splat::View;
use glam::Vec3;
use std::ops::Range;

/// A part of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<'a> {
    /// Rectangles, each with the number of the tile that it lies in.
    pub(crate) pieces: &'a [(usize, Rect)],
    /// A splat reaches at most this many times as far as its surfel.
    pub(crate) spread: f64,
    /// The surfels around the pieces, if they were looked for before.
    pub(crate) around: Option<&'a Around>,
}

/// The surfels around a small part of a picture. A search for a mistake judges one part many times, by
/// other rules; each time it looks for what is near among these surfels alone.
#[derive(Debug)]
pub(crate) struct Around {
    camera: Camera,
    /// Their indices, ascending.
    surfels: Vec<usize>,
}

/// Surfels are around a part if they are near it when they reach this many times as far. Naming tries no
/// larger radii.
const MOST_SPREAD: f64 = 2.5;

/// The same for how far the low-pass filter reaches, in pixels.
const MOST_SKIRT: f64 = 3.0;

impl Around {
    /// The surfels around pieces of a job's picture; none if there are too many pieces.
    pub(crate) fn new(job: &Job<'_>, pieces: &[(usize, Rect)]) -> Option<Self> {
        let part = Part { pieces, spread: MOST_SPREAD, around: None };
        let surfels = &job.scene.surfels;
        let surfels = part.near(job, MOST_SKIRT, |i| surfels.reach_of(i))?;
        Some(Self { camera: *job.camera, surfels })
    }
}

/// The most pieces of a part for which what is near them is looked for.
const MOST_PIECES: usize = 32;

impl Part<'_> {
    /// Whether it pays to look for what is near: many pieces are near almost everything.
    pub(crate) fn is_small(&self) -> bool {
        self.pieces.len() <= MOST_PIECES
    }

    /// The surfels of a job that may touch the part, ascending, if the part is small: splats are wider
    /// by `skirt` pixels than what they show, and a surfel reaches as far as `reach` says.
    pub(crate) fn near(
        &self,
        job: &Job<'_>,
        skirt: f64,
        reach: impl Fn(usize) -> f64 + Sync + Send,
    ) -> Option<Vec<usize>> {
        if !self.is_small() {
            return None;
        }
        let nearby = Nearby::new(*self, job.camera, skirt);
        let position = job.scene.surfels.position();
        let holds = |i: &usize| nearby.holds(Vector3::from_glam(position[*i]), reach(*i));
        let knows = |around: &&Around| {
            let reaches = self.spread <= MOST_SPREAD && skirt <= MOST_SKIRT;
            reaches && around.camera == *job.camera
        };
        if let Some(around) = self.around.filter(knows) {
            return Some(around.surfels.iter().copied().filter(holds).collect());
        }
        let count = position.len();
        let ranges = (0..count).step_by(8192).map(|first| first..count.min(first + 8192));
        let some = |range: Range<usize>| range.filter(holds).collect::<Vec<_>>();
        Some(job.exec.ordered(ranges.collect(), some).concat())
    }

    /// Whether a splat with these bounds touches the part.
    pub(crate) fn touches(&self, bounds: &Rect) -> bool {
        self.pieces.iter().any(|(_, rect)| !rect.intersection(bounds).is_empty())
    }
}

/// Finds what may touch a part. This takes a fraction of the time of a projection.
#[derive(Clone, Copy)]
pub(crate) struct Nearby<'a> {
    part: Part<'a>,
    view: View<f64>,
    /// How far the low-pass filter reaches, in pixels, and a few pixels more.
    skirt: f64,
}

/// More pixels than bounds are widened by, and more than a mistake moves a splat by.
const SLACK: f64 = 2.0;

impl<'a> Nearby<'a> {
    /// What is near a part, if splats are wider by `skirt` pixels than what they show.
    pub(crate) fn new(part: Part<'a>, camera: &Camera, skirt: f64) -> Self {
        Self { part, view: View::new(camera), skirt: skirt + SLACK }
    }

    /// Whether a splat may touch the part, whose centre is here, and which reaches this far in the
    /// world. A sphere decides it, where the sphere is far before the eye.
    pub(crate) fn holds(&self, center: Vector3<f64>, reach: f64) -> bool {
        let Self { part, view, skirt } = self;
        let (p, reach) = (view.point(center), reach * part.spread);
        let t = -p.z;
        if view.perspective && !(t > 4.0 * reach) {
            return true;
        }
        // A point of the sphere is at most this far from the projected centre.
        let [m, most] = if view.perspective { [1.0 / t, 1.0 / (t - reach)] } else { [1.0; 2] };
        let side = |focal: f64, along: f64, center: f64| {
            let slope = if view.perspective { 1.0 + (along * m).abs() } else { 1.0 };
            let half = 1.02 * focal.abs() * reach * slope * most + skirt;
            let at = center + focal * along * m;
            [at - half, at + half]
        };
        self.meets(side(view.fx, p.x, view.cx), side(view.fy, -p.y, view.cy))
    }

    /// Whether any splat of `ewa`, `peeling` or `blue` may touch the part, in `f32` or `f64`, if the
    /// centres lie in a box of the world and the surfels reach at most `reach` in the world. `false`
    /// is a proof that none does:
    ///
    /// 1. In view space the box is spanned by its eight corners. A number that is linear in the
    ///    position, such as the depth t, has its extremes at corners. So has x/t where all t > 0: for
    ///    every c the set x - c t >= 0 is a half space, and meets the box in a corner or not at all.
    /// 2. `f32` places a centre at most e beside its exact place, where e is 2^-20 times the greatest
    ///    sum |m0 x| + |m1 y| + |m2 z| + |m3| of a row: its roundings are at most 2^-22 of that.
    /// 3. No centre is drawn unless t > near. If all t + e <= near, there is no splat.
    /// 4. Let r = reach + e. Unless t > 4 r and t > 1000 e at all corners, the box may touch.
    ///    Otherwise let u be the exact x/t of a centre. Its place in `f32` is within
    ///    fx (1 + |u|) e / (t - e) of fx u, and the outline, exact or linearized at the centre, reaches
    ///    at most fx (1 + |u|) reach t / ((t - e) (t - r)) farther, then `skirt`. Both together are
    ///    below 1.01 h, with h = fx (1 + |u|) r / (t - r). Corners bound h, as it grows with |u| and
    ///    falls with t. A square of `blue` reaches less than h.
    /// 5. The test whether a pixel is inside is rounded too. In the terms of
    ///    [`Footprint`](crate::splat::Footprint), |v dy| <= k and |ux dx + uy dy| <= k hold up to a few
    ///    ulp of each term, with xx yy - xy xy = area area. So |dx| <= k (area + |xy|) / sqrt(yy), at
    ///    most sqrt(2) k sqrt(xx) = 1.42 times the exact reach, however thin the ellipse is. A ray that
    ///    is cast compares with k w, and w is rounded by 2^-22 (|wx dx| + |wy dy|). While |g| is at
    ///    least 2^-18 r/t, this and the growth of w with r/t < 1/4 leave it below 2.9 times. The factor
    ///    here is 3.
    /// 6. Other roundings move an end by less than 2^-20 of its distance from the principal point, and
    ///    [`SLACK`] is more than that in a picture of at most 2^16 pixels.
    ///
    /// Under an orthographic camera, x takes the place of x/t, and 1 that of 1/t.
    ///
    /// `Decided:` a disc with |g| below 2^-18 r/t is within a millionth of a radian of edge-on, and
    /// covers no pixel in exact numbers, except on the line itself. With cast rays the nearness of its
    /// plane is rounding noise in `f32`; what it then draws beyond three times its own length is not
    /// looked for.
    pub(crate) fn holds_any(&self, bounds: [Vec3; 2], reach: f64) -> bool {
        self.holds_hull(corners(bounds), reach)
    }

    /// Whether the camera sees all of a box of the world in one piece of the part. Then to ask for each
    /// splat there only takes time.
    pub(crate) fn covers(&self, bounds: [Vec3; 2]) -> bool {
        let Self { part, view, .. } = self;
        let corners = corners(bounds).map_inline(|p| view.point(Vector3::from_glam(p)));
        // The corners span a convex set, before the eye if they are.
        let scale = |p: &Vector3<f64>| if view.perspective { -1.0 / p.z } else { 1.0 };
        let is_before = !view.perspective || corners.iter().all(|p| -p.z > 0.0);
        let is_in = |rect: &Rect| {
            corners.iter().all(|p| {
                let (x, y) =
                    (view.cx + view.fx * p.x * scale(p), view.cy - view.fy * p.y * scale(p));
                let inside = |at: f64, from: u32, to: u32| at >= from.into() && at <= to.into();
                inside(x, rect.x0, rect.x1) && inside(y, rect.y0, rect.y1)
            })
        };
        is_before && part.pieces.iter().any(|(_, rect)| is_in(rect))
    }

    /// [`Nearby::holds_any`] for one splat.
    pub(crate) fn holds_one(&self, position: Vec3, reach: f64) -> bool {
        self.holds_hull([position], reach)
    }

    /// [`Nearby::holds_any`] for the hull of these points.
    fn holds_hull<const N: usize>(&self, corners: [Vec3; N], reach: f64) -> bool {
        let Self { part, view, skirt } = self;
        let farthest = corners.iter().fold(Vec3::ZERO, |most, p| most.max(p.abs()));
        let farthest = farthest.to_array().map_inline(f64::from);
        let corners = corners.map_inline(|p| view.point(Vector3::from_glam(p)));
        let [least, most] = ends(corners.map_inline(|p| -p.z));
        let sum =
            |row: &[f64; 4]| (0..3).map(|i| row[i].abs() * farthest[i]).sum::<f64>() + row[3].abs();
        let off = ends(view.rows.each_ref().map_inline(sum))[1] / f64::from(1 << 20);
        if most + off <= view.near {
            return false;
        }
        let reach = reach * part.spread + off;
        if view.perspective && !(least > 4.0 * reach && least > 1000.0 * off) {
            return true;
        }
        let side = |focal: f64, along: [f64; N], center: f64| {
            let steep = along.iter().fold(0.0, |most: f64, u| most.at_least(u.abs()));
            let wide = if view.perspective { (1.0 + steep) / (least - reach) } else { 1.0 };
            // Squares have the side of the greater focal length.
            let half = 3.0 * view.fx.abs().at_least(view.fy.abs()) * reach * wide + skirt;
            let [a, b] = ends(along.map_inline(|u| center + focal * u));
            [a - half, b + half]
        };
        let slope = |of: fn(&Vector3<f64>) -> f64| {
            corners.map_inline(|p| if view.perspective { of(&p) / -p.z } else { of(&p) })
        };
        self.meets(side(view.fx, slope(|p| p.x), view.cx), side(view.fy, slope(|p| -p.y), view.cy))
    }

    /// Whether a rectangle meets the part.
    fn meets(&self, [x0, x1]: [f64; 2], [y0, y1]: [f64; 2]) -> bool {
        self.part.pieces.iter().any(|(_, rect)| {
            let [left, top, right, bottom] =
                [rect.x0, rect.y0, rect.x1, rect.y1].map_inline(f64::from);
            // Written so that a NaN touches.
            !(x1 < left || x0 > right || y1 < top || y0 > bottom)
        })
    }
}

/// The corners of a box.
#[inline]
fn corners([low, high]: [Vec3; 2]) -> [Vec3; 8] {
    let corner = |i: usize| {
        let pick = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
        Vec3::new(pick(0), pick(1), pick(2))
    };
    std::array::from_fn(corner)
}

/// The least and the greatest number; NaN if there is one.
fn ends<const N: usize>(numbers: [f64; N]) -> [f64; 2] {
    numbers.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &n| {
        // Comparisons with NaN are false, so a NaN replaces a number, and stays.
        [
            if low.is_nan() || n >= low { low } else { n },
            if high.is_nan() || n <= high { high } else { n },
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composite::decide;
    use crate::number::elementary;
    use crate::scene::{Lens, Pose, Projection};
    use crate::splat::project::project;
    use crate::splat::{Disc, Fate, Kernel, Outline, Projector, Shared, fragment};
    use glam::DVec3;
    use proptest::prelude::*;

    /// A camera of 40 x 30 pixels near the origin, which lies at `far`.
    fn camera(lens: Lens, far: DVec3, eye: DVec3) -> Camera {
        let pose = Pose { eye: far + eye, target: far, up: DVec3::new(0.3, 1.0, 0.2) };
        Camera::new(40, 30, pose, lens).unwrap()
    }

    /// The direction from a position to the eye.
    fn to_eye(camera: &Camera, position: Vec3) -> Vec3 {
        let view = camera.view_from_world;
        let p = view.transform_point3(position);
        let d = if camera.projection == Projection::Perspective { -p } else { Vec3::Z };
        view.inverse().transform_vector3(d).normalize()
    }

    /// A power of ten.
    fn ten(power: f32) -> f32 {
        elementary::exp(f64::from(power) * std::f64::consts::LN_10) as f32
    }

    fn vector(scale: f32) -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-scale..scale).prop_map(Vec3::from_array)
    }

    proptest! {
        // Each case tests 1,200 pixels.
        #![proptest_config(ProptestConfig::with_cases(3000))]

        /// Draws a surfel by the definition in `f32`, and looks for each of its pixels.
        #[test]
        fn no_box_with_a_surfel_that_draws_a_pixel_is_left_out(
            (outline, low_pass) in (
                prop::sample::select(vec![Outline::Affine, Outline::Perspective, Outline::RayCast]),
                prop::sample::select(vec![0.0_f32, 0.25, 16.0]),
            ),
            cutoff in prop::sample::select(vec![0.25_f32, 2.0, 4.0]),
            lens in prop::sample::select(vec![
                Lens::FieldOfView(40.0), Lens::FieldOfView(150.0), Lens::Orthographic(2.0),
            ]),
            far in prop::sample::select(vec![0.0, 1e3, 1e6]),
            (eye, position) in (vector(3.0), vector(2.0)),
            (normal, edge_on) in (vector(1.0), prop::option::of(-7.0_f32..-1.0)),
            (radius, long) in (-3.0_f32..0.5, prop::option::of(0.1_f32..3.0)),
            (before, after) in (vector(0.4), vector(0.4)),
        ) {
            prop_assume!(eye.length() > 0.3 && normal.length() > 0.1);
            let far = DVec3::splat(far);
            let camera = camera(lens, far, eye.as_dvec3());
            let position = (position.as_dvec3() + far).as_vec3();
            let mut normal = normal.normalize();
            if let Some(power) = edge_on {
                // As far from edge-on as a power of ten says.
                let ray = to_eye(&camera, position);
                let side = normal.cross(ray);
                prop_assume!(side.length() > 0.1);
                normal = (side.normalize() + ray * ten(power)).normalize();
            }
            let radius = ten(radius);
            let u = normal.any_orthonormal_vector() * radius;
            let tangents = long.map(|long| [u, normal.cross(u) * long]);
            let reach = tangents.map_or(f64::from(radius), |[u, v]| {
                (u.as_dvec3().length_squared() + v.as_dvec3().length_squared()).sqrt()
            });
            let disc = Disc::<f32> {
                position: Vector3::from_glam(position),
                normal: Vector3::from_glam(normal),
                radius,
                tangents: tangents.map(|pair| pair.map(Vector3::from_glam)),
            };
            let kernel = Kernel { outline, cutoff, low_pass };
            let view = View::<f32>::new(&camera);
            let (splat, reasons) = project(&Projector::new(view, &kernel, false), &disc, 0);
            if reasons.fate() != Fate::Visible {
                return Ok(());
            }
            // Nearer to edge-on, cast rays are noise.
            let p = view.point(disc.position);
            let (g, t) = (to_eye(&camera, position).dot(normal).abs(), -p.z);
            let noise = outline == Outline::RayCast && f64::from(g) * f64::from(1 << 18) < reach / f64::from(t);
            if noise {
                return Ok(());
            }
            let around = [position - before.abs(), position + after.abs()];
            let shared = Shared::new(&view, &kernel);
            let skirt = f64::from(cutoff) * f64::from(low_pass).sqrt();
            for (x, y) in (0..30).flat_map(|y| (0..40).map(move |x| (x, y))) {
                let (q, _) = fragment(&shared, &splat.footprint, (x, y));
                if splat.bounds.contains(x, y) && decide::inside(q, shared.limit) {
                    let pieces = [(0, Rect { x0: x, y0: y, x1: x + 1, y1: y + 1 })];
                    let part = Part { pieces: &pieces, spread: 1.0, around: None };
                    let nearby = Nearby::new(part, &camera, skirt);
                    prop_assert!(nearby.holds_any(around, reach), "pixel {x} {y}");
                    prop_assert!(nearby.holds_one(position, reach), "pixel {x} {y} alone");
                }
            }
        }
    }

    #[test]
    fn what_is_far_beside_or_behind_is_left_out() {
        let camera = camera(Lens::FieldOfView(40.0), DVec3::ZERO, DVec3::new(0.0, 0.0, 4.0));
        let holds = |region: Rect, middle: Vec3| {
            let pieces = [(0, region)];
            let part = Part { pieces: &pieces, spread: 1.0, around: None };
            let nearby = Nearby::new(part, &camera, 1.0);
            nearby.holds_any([middle - 0.1, middle + 0.1], 0.01)
        };
        let whole = Rect::of_size([40, 30]);
        assert!(holds(whole, Vec3::ZERO));
        assert!(!holds(whole, Vec3::new(0.0, 0.0, 4.5)), "behind the eye");
        assert!(holds(whole, Vec3::new(0.0, 0.0, 4.0)), "around the eye");
        for beside in [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y] {
            assert!(!holds(whole, 3.0 * beside));
        }
        let corner = Rect { x0: 0, y0: 0, x1: 8, y1: 8 };
        assert!(!holds(corner, Vec3::ZERO) && holds(corner, Vec3::new(-1.4, 0.9, 0.0)));
        assert!(holds(corner, Vec3::NAN), "nobody knows where it is");
        let covers = |middle: Vec3| {
            let pieces = [(0, whole)];
            let part = Part { pieces: &pieces, spread: 1.0, around: None };
            Nearby::new(part, &camera, 1.0).covers([middle - 0.1, middle + 0.1])
        };
        assert!(covers(Vec3::ZERO) && !covers(1.9 * Vec3::X), "partly beside");
        assert!(!covers(Vec3::new(0.0, 0.0, 4.5)) && !covers(Vec3::NAN));
    }
}
