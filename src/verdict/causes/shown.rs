//! Fit a number of the camera to the pixels in which the client says both surfel and depth.
//!
//! The ray of a pixel meets the plane of its surfel at the depth of the fragment (\[ZPvBG01, section 4\]),
//! whatever hides what. So each pixel tells by how much a number is off. Their median does not care
//! for pixels that are wrong for another reason:
//!
//! ```text
//!   t_i     the depth that the client shows at pixel i
//!   t_i(v)  the depth at which the ray of pixel i meets its surfel's plane, seen by the camera with v
//!   r_i(v) = t_i/t_i(v) - 1        orthographic: 1 - t_i(v)/t_i
//!   s_i    = (r_i(v + h) - r_i(v)) / h
//!   v is moved by the median of -r_i/s_i with the weights |s_i|, none above their median
//! ```
//!
//! r is linear in the principal point and in 1/f, so a few moves are enough.
//!
//! A search in the verdict's errors would need a start within 10^-4 px: errors fall only where nearly
//! all pixels come into their intervals.

use super::change::Change;
use super::depths::median;
use super::epsilon::DEPTHS;
use super::numbers::Number;
use crate::frame::Frame;
use crate::method::{Method, Session};
use crate::number::{MapInline, Real, Vector3};
use crate::scene::{Camera, Surfels};
use crate::splat::View;
use crate::verdict::client::Client;
use glam::DVec3;

/// The most pixels that a number is fitted to, and the fewest.
const MOST: usize = 4096;
const FEWEST: usize = 64;
/// How often a number is moved.
const TURNS: usize = 6;
/// What may be left of the median error for a number to explain it.
pub(super) const LEAST_LEFT: f64 = 0.05;
/// Fits that leave at most so many times the least error are as good.
pub(super) const AS_WELL: f64 = 2.0;
/// The median error of the right camera, in parts of a depth: roundings are smaller.
pub(super) const RIGHT: f64 = 1e-6;

/// Pixels in which the client shows a surfel at a depth.
pub(super) struct Shown<'a> {
    surfels: &'a Surfels,
    camera: &'a Camera,
    pixels: Vec<Pixel>,
}

/// A pixel: its surfel, its column and row, and the depth there.
pub(super) struct Pixel {
    pub(super) surfel: usize,
    pub(super) at: [u32; 2],
    pub(super) depth: f64,
}

impl Pixel {
    /// The ray through the middle of the pixel, for each unit of depth or at every depth.
    fn ray(&self, view: &View<f64>) -> [f64; 2] {
        let [x, y] = self.at.map_inline(|at| f64::from(at) + 0.5);
        [(x - view.cx) / view.fx, -((y - view.cy) / view.fy)]
    }

    /// How far the ray of the pixel meets the plane of the surfel from the surfel's centre.
    pub(super) fn distance(&self, surfels: &Surfels, view: &View<f64>) -> f64 {
        let p = view.point(Vector3::from_glam(surfels.position()[self.surfel]));
        let ([x, y], error) = (self.ray(view), self.error(surfels, view));
        let met = if view.perspective {
            let t = self.depth / (1.0 + error);
            DVec3::new(x * t, y * t, -t)
        } else {
            DVec3::new(x, y, -self.depth * (1.0 - error))
        };
        met.distance(DVec3::new(p.x, p.y, p.z))
    }

    /// The error r of the pixel.
    pub(super) fn error(&self, surfels: &Surfels, view: &View<f64>) -> f64 {
        let p = view.point(Vector3::from_glam(surfels.position()[self.surfel]));
        let n = view.direction(Vector3::from_glam(surfels.normal()[self.surfel]));
        let [x, y] = self.ray(view);
        if view.perspective {
            let nearness = (n.x * x + n.y * y - n.z) / (n.x * p.x + n.y * p.y + n.z * p.z);
            nearness * self.depth - 1.0
        } else {
            let depth = (n.x * (x - p.x) + n.y * (y - p.y)) / n.z - p.z;
            1.0 - depth / self.depth
        }
    }
}

impl<'a> Shown<'a> {
    /// The pixels of a client; none if it does not say both, or if the method's depths are not those of planes.
    pub(super) fn new(
        session: &'a Session<'_>,
        camera: &'a Camera,
        client: &Client,
    ) -> Option<Self> {
        let (method, surfels) = (session.method(), &session.scene().surfels);
        if method.splats().is_none() && !matches!(method, Method::Deferred(_)) {
            return None;
        }
        let found = DEPTHS.iter().find_map(|name| pixels(client.frame(), name, surfels.len()));
        Some(Self { surfels, camera, pixels: found? })
    }

    /// The number that the pixels show to be wrong, and its value; several, the best one first, if they
    /// fit about as well, as where most pixels show one plane. None if the camera is right, or if no
    /// single number is wrong.
    pub(super) fn fit<'n, 'c>(&self, numbers: &'n [Number<'c>]) -> Vec<(&'n Number<'c>, f64)> {
        let right = median_size(&self.errors(&View::new(self.camera)));
        if right <= RIGHT {
            return Vec::new();
        }
        let fit = |number| self.value(number).map(|(value, left)| (number, value, left));
        let mut found: Vec<_> = numbers.iter().filter_map(fit).collect();
        found.retain(|(_, _, left)| *left <= LEAST_LEFT * right);
        found.sort_by(|(_, _, a), (_, _, b)| a.total_cmp(b));
        let least = found.first().map_or(0.0, |(_, _, left)| *left);
        found.retain(|(_, _, left)| *left <= AS_WELL * least);
        found.into_iter().map(|(number, value, _)| (number, value)).collect()
    }

    /// The value of a number with which depths fit best, and the median error that it leaves.
    fn value(&self, number: &Number<'_>) -> Option<(f64, f64)> {
        let errors = |value: f64| match (number.change)(value)? {
            Change::Camera(camera) => Some(self.errors(&View::new(&camera))),
            _ => None,
        };
        let (mut value, mut best) = (number.estimate.unwrap_or(number.right), None);
        for _ in 0..TURNS {
            let (now, beside) = (errors(value)?, errors(value + 0.1 * number.step)?);
            let left = median_size(&now);
            if best.is_none_or(|(_, least)| left < least) {
                best = Some((value, left));
            }
            let slope = |(a, b): (&f64, &f64)| (*a, (b - a) / (0.1 * number.step));
            value += median_move(&now.iter().zip(&beside).map(slope).collect::<Vec<_>>())?;
        }
        best
    }

    /// The median depth.
    pub(super) fn depth(&self) -> f64 {
        median(self.pixels.iter().map(|pixel| pixel.depth).collect())
    }

    /// The error of each pixel with a camera.
    pub(super) fn errors(&self, view: &View<f64>) -> Vec<f64> {
        self.pixels.iter().map(|pixel| pixel.error(self.surfels, view)).collect()
    }
}

/// Pixels of a plane of depths, spread evenly. None if too few show a surfel.
fn pixels(frame: &Frame<f64>, name: &str, surfels: usize) -> Option<Vec<Pixel>> {
    let (depths, ids) = (frame.scalar(name).ok()?, frame.index(&name.replace('Z', "id")).ok()?);
    let is_shown =
        |(_, (id, depth)): &(usize, (&u32, &f64))| (**id as usize) < surfels && depth.is_finite();
    let shown = || ids.values().iter().zip(depths.values()).enumerate().filter(is_shown);
    // Counted first, because a list of all pixels of a large picture takes gigabytes.
    let count = shown().count();
    let width = ids.width() as usize;
    let pixel = |(i, (id, depth)): (usize, (&u32, &f64))| Pixel {
        surfel: *id as usize,
        at: [i % width, i / width].map_inline(|at| at as u32),
        depth: *depth,
    };
    (count >= FEWEST).then(|| shown().step_by(count.div_ceil(MOST)).map(pixel).collect())
}

/// The median of the errors' sizes. An error that is no number is the largest.
pub(super) fn median_size(errors: &[f64]) -> f64 {
    median(errors.iter().map(|error| error.abs()).collect())
}

/// The median of -r / s with the weights |s|. No weight is above the median one: beside the rim of a
/// shape s is large, and a depth there may be that of the splat's end.
fn median_move(pixels: &[(f64, f64)]) -> Option<f64> {
    let most = median(pixels.iter().map(|(_, slope)| slope.abs()).collect());
    let moves = pixels.iter().map(|(error, slope)| (-error / slope, slope.abs().at_most(most)));
    let mut moves: Vec<_> = moves.filter(|(by, weight)| (by * weight).is_finite()).collect();
    moves.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let half = 0.5 * moves.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut sum = 0.0;
    moves.into_iter().find_map(|(by, weight)| {
        sum += weight;
        (sum >= half).then_some(by)
    })
}

#[cfg(test)]
mod tests {
    use super::super::numbers::{of_lens, of_place};
    use super::*;
    use crate::frame::Exec;
    use crate::method::{deferred, ewa, single_pass};
    use crate::scene::{Lens, Scene};
    use crate::source::Shape;
    use crate::splat::{Kernel, Outline};
    use crate::verdict::tests::camera;
    use glam::{Mat4, Vec3};

    /// The number of a camera that another camera has wrong, and its value.
    fn fitted(session: &Session<'_>, camera: &Camera, by: &Camera) -> Option<(String, f64)> {
        let client = Client::from(&session.define::<f32>(by, true).unwrap().frame);
        let numbers: Vec<_> =
            of_lens(camera, None).into_iter().chain(of_place(camera, None)).collect();
        let shown = Shown::new(session, camera, &client)?;
        let first = shown.fit(&numbers).into_iter().next();
        first.map(|(number, value)| ((number.in_words)(value), value))
    }

    #[test]
    fn a_wrong_number_of_the_camera_is_fitted() {
        let exec = Exec::new(2, 32).unwrap();
        let outlined = |outline| {
            let right = ewa::Settings::default();
            ewa::Settings { kernel: Kernel { outline, ..right.kernel }, ..right }
        };
        let ewa: Method = outlined(Outline::Affine).into();
        for (shape, method) in [
            (Shape::Torus, ewa),
            (Shape::Sphere, ewa),
            (Shape::Sphere, outlined(Outline::RayCast).into()),
            (Shape::Sphere, single_pass::Settings::default().into()),
            (Shape::Sphere, deferred::Settings::default().into()),
        ] {
            let scene = Scene::unlit("", shape.surfels(400, 3).unwrap());
            let session = Session::new(&scene, method, &exec).unwrap();
            for lens in [None, Some(Lens::Orthographic(2.5))] {
                let camera = camera(shape, [96, 72], lens);
                for (by, what, value) in wrong(camera) {
                    let (words, found) = fitted(&session, &camera, &by).unwrap_or_else(|| {
                        panic!("{shape:?} {} {lens:?} {what} {value}", method.name())
                    });
                    assert!(words.starts_with(what), "{words}");
                    // Depths are off by a few 2^-24 of themselves, each another way.
                    let off = (found - f64::from(value)).abs();
                    assert!(off < 2e-6 * f64::from(value).abs().at_least(10.0), "{words}: {off}");
                }
                assert_eq!(fitted(&session, &camera, &camera), None, "the right camera");
                let scaled = camera.view_from_world * Mat4::from_scale(Vec3::splat(1.1));
                let scaled = Camera { view_from_world: scaled, ..camera };
                assert_eq!(fitted(&session, &camera, &scaled), None, "no single number");
            }
        }
    }

    /// Cameras with one wrong number: its words and its value.
    fn wrong(camera: Camera) -> [(Camera, &'static str, f32); 5] {
        let Camera { fx, fy, cx, cy, .. } = camera;
        let lens = "another field";
        [
            (Camera { fx: 0.9 * fx, fy: 0.9 * fy, ..camera }, lens, 0.9 * fy),
            (Camera { fx: 1.002 * fx, fy: 1.002 * fy, ..camera }, lens, 1.002 * fy),
            (Camera { fx: 1.05 * fx, ..camera }, "a wrong aspect", 1.05),
            (Camera { cx: cx - 7.25, ..camera }, "the picture is -7", -7.25),
            (Camera { cy: cy + 0.125, ..camera }, "the picture is 0.12", 0.125),
        ]
    }
}
