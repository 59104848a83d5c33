//! Levels of detail: choose which surfels of an object a view draws.
//!
//! - [`tree`]: nodes of a sequential point tree \[GBP04, 7.2\].
//! - [`prefix`]: a prefix of an order \[BJFM19, 4.1\].
//! - [`sequential`]: the list of such a tree.
//! - [`refine`]: how much of an object and of its finer objects is drawn \[BJFM19, 4\].
//!
//! The choice is an f64 computation, and every method receives its result, as it receives the
//! camera.
//!
//! An object with levels of detail draws nothing and has no ids if its sphere is not in the view
//! frustum. Objects without levels of detail always draw all surfels. The test uses the sphere in
//! its place and in view space, with the depth t of its centre and the radius R, in f64. The sphere
//! is outside if `t + R <= near`. It is also outside if it is beyond one of the four borders of the
//! picture widened by m pixels: for the left border
//!
//! ```text
//!   fx x + (cx + m) t < -R sqrt(fx fx + (cx + m) (cx + m))
//!   fx x + (cx + m)   < -R fx                                      orthographic
//! ```
//!
//! for the right one with -x and `width - cx`, for the upper one with fy, -y and cy, for the lower
//! one with fy, y and `height - cy`. View space is `((m0 x + m1 y) + m2 z) + m3` of the camera's
//! matrix. m is 16 plus the error that nodes may have, or plus the size of discs. `Decided:` 16
//! pixels, more than the filter of a splat adds to the splat.
//!
//! **Stereo.** Both eyes of a [stereo pair](crate::scene::camera::stereo) draw the same surfels: the
//! choice is made once, by a camera in the middle between them. Its view matrix has
//! `(V03 + other) / 2` in place of V03, in f64, with the [other eye](Camera::other_eye)'s V03; its eye
//! is [`Camera::eye`] of that matrix. With s = V03 less the middle's, for each eye:
//!
//! - A sphere is in the view frustum if it is in the frustum of one of the eyes, whose x is x + s.
//! - The distance of an object, by which [zones](refine) choose a factor, is the lesser of the
//!   distances in both pictures, again with x + s in place of x.
//!
//! `Decided:` the paper renders in stereo and does not say that the eyes share the choice. Two
//! choices would show other surfels to each eye, which the viewer sees as a shimmer in depth.
//! `Departs:` its zones are "for each eye" (4.4); an object here has the finer size of the two.

pub mod prefix;
pub mod refine;
pub mod sequential;
pub mod tree;

use super::{Geometry, Objects};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::number::{MapInline, Real};
use crate::scene::objects::Ids;
use crate::scene::{Camera, Projection, Sides, Similarity, Sphere};
use glam::{DMat4, DVec3};
use prefix::Prefix;
use std::sync::Arc;
use tree::Tree;

/// How far the picture is widened on each side, in pixels.
const MARGIN: f64 = 16.0;

/// The levels of detail of a geometry.
#[derive(Clone, Debug)]
pub enum Detail {
    /// Nodes of a tree.
    Tree(Tree),
    /// Prefixes of an order.
    Prefix(Prefix),
}

impl Detail {
    /// A sphere around the geometry.
    pub(super) fn sphere(&self) -> Sphere {
        match self {
            Self::Tree(tree) => tree.sphere,
            Self::Prefix(prefix) => prefix.sphere,
        }
    }
}

impl Geometry {
    /// The tree whose nodes the surfels are, if there is one.
    #[must_use]
    pub fn tree(&self) -> Option<&Tree> {
        match &self.detail {
            Some(Detail::Tree(tree)) => Some(tree),
            _ => None,
        }
    }

    /// The order of the surfels, if it is known.
    #[must_use]
    pub fn prefix(&self) -> Option<&Prefix> {
        match &self.detail {
            Some(Detail::Prefix(prefix)) => Some(prefix),
            _ => None,
        }
    }

    /// Checks that the geometry may get levels of detail.
    fn check_plain(&self) -> Result<()> {
        if self.detail.is_none() && !self.surfels.is_empty() {
            return Ok(());
        }
        let what = if self.surfels.is_empty() { "no surfels for" } else { "already" };
        Err(Error::Invalid(format!("{} has {what} levels of detail", self.name)))
    }

    /// How many surfels are drawn before a camera is known, and their median radius.
    pub(super) fn at_rest(&self) -> (u32, f32) {
        match self.tree() {
            Some(tree) => (tree.count, tree.median_radius),
            None => (self.surfels.len() as u32, self.surfels.median_radius()),
        }
    }
}

/// The part of an object that a view draws.
#[derive(Clone, Debug)]
pub(super) struct DrawnPart {
    /// How many surfels the view looks at; these have ids.
    count: u32,
    /// Which of them are drawn; none means all.
    mask: Option<Arc<Mask>>,
    /// The discs that they are drawn as; none means their own shapes.
    pub(super) disc: Option<Disc>,
    /// Whether primitives are drawn.
    pub(super) primitives: bool,
}

/// The discs of a prefix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// The radius of every disc, in world units.
    pub radius: f32,
    /// The side of their squares in pixels.
    pub side: f32,
}

impl Default for DrawnPart {
    fn default() -> Self {
        Self { count: 0, mask: None, disc: None, primitives: true }
    }
}

impl DrawnPart {
    fn nothing() -> Self {
        Self { mask: Some(Arc::default()), primitives: false, ..Self::default() }
    }

    /// Everything that an object has, before a camera is known.
    pub(super) fn at_rest(geometry: &Geometry, all: u32) -> Self {
        Self { count: all, mask: geometry.tree().map(Tree::leaves), ..Self::default() }
    }
}

/// One bit for each surfel at the beginning of an object: whether the surfel is drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mask {
    words: Vec<u64>,
}

impl Mask {
    fn from_fn(count: usize, is_drawn: impl Fn(usize) -> bool) -> Self {
        let word = |first: usize| {
            let bits = first..count.min(first + 64);
            bits.fold(0, |word, i| word | u64::from(is_drawn(i)) << (i - first))
        };
        Self { words: (0..count).step_by(64).map(word).collect() }
    }

    /// Whether a surfel is drawn.
    #[inline(always)]
    #[must_use]
    pub fn has(&self, surfel: usize) -> bool {
        self.words.get(surfel / 64).is_some_and(|word| word >> (surfel % 64) & 1 != 0)
    }

    /// How many are drawn.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.words.iter().map(|word| u64::from(word.count_ones())).sum()
    }

    /// The surfels that are drawn, ascending.
    pub fn surfels(&self) -> impl Iterator<Item = usize> {
        self.words.iter().enumerate().flat_map(|(i, &word)| {
            let rest = |bits: &u64| Some(bits & bits.wrapping_sub(1));
            let left = std::iter::successors(Some(word), rest).take_while(|&bits| bits != 0);
            left.map(move |bits| i * 64 + bits.trailing_zeros() as usize)
        })
    }
}

impl Objects {
    /// Chooses what a camera sees of the objects: which surfels the objects with [levels of
    /// detail](self) draw, the ids of these surfels, and the unit of epsilon.
    ///
    /// # Errors
    /// As [`Ids::new`].
    pub fn seen_from(&self, camera: &Camera, exec: &Exec) -> Result<Self> {
        if !self.have_detail() {
            return Ok(self.clone());
        }
        let shown = self.refined(&Eye::new(camera), exec);
        let counts = shown.iter().map(|shown| shown.count).collect();
        let all = (0..self.objects.len() as u32).map(|object| self.count_of_all(object));
        let ids = Ids::first(counts, all.collect(), |object| self.objects[object].name.clone())?;
        let mut seen = Self { ids: Arc::new(ids), shown: shown.into(), ..self.clone() };
        seen.median_radius = seen.median_of_drawn(exec);
        Ok(seen)
    }

    /// Whether some objects have levels of detail.
    #[must_use]
    pub fn have_detail(&self) -> bool {
        self.forest.is_some() || self.geometries.iter().any(|geometry| geometry.detail.is_some())
    }

    /// Which surfels of an object are drawn; none means all.
    #[must_use]
    pub fn drawn(&self, object: u32) -> Option<&Mask> {
        self.shown[object as usize].mask.as_deref()
    }

    /// The discs that the surfels of an object are drawn as; none means their own shapes.
    #[must_use]
    pub fn disc(&self, object: u32) -> Option<Disc> {
        self.shown[object as usize].disc
    }

    /// The squares of all surfels that are drawn, in the order of their ids; none if no object has
    /// squares.
    pub(crate) fn sides(&self) -> Result<Option<Sides>> {
        let objects = || self.ids.order().iter().filter(|&&object| self.drawn_of(object) > 0);
        if objects().all(|&object| self.disc(object).is_none()) {
            return Ok(None);
        }
        let mut first = 0;
        let runs = objects().map(|&object| {
            let run = (first, self.disc(object).map(|disc| disc.side));
            first += self.drawn_of(object) as u32;
            run
        });
        Sides::new(runs.collect()).map(Some)
    }

    /// How many surfels of an object are drawn.
    fn drawn_of(&self, object: u32) -> u64 {
        match self.drawn(object) {
            Some(mask) => mask.count(),
            None => self.ids.count(object).into(),
        }
    }

    /// How many surfels are drawn.
    #[must_use]
    pub fn drawn_total(&self) -> u64 {
        (0..self.objects.len() as u32).map(|object| self.drawn_of(object)).sum()
    }

    /// How many triangles, ribbons and tubes all objects draw.
    #[must_use]
    pub fn drawn_primitives(&self) -> u64 {
        let drawn = (0..).zip(self.shown.iter()).filter(|(_, shown)| shown.primitives);
        drawn.map(|(object, _)| self.geometry(object).primitives.len() as u64).sum()
    }

    /// The ids of all surfels that are drawn, ascending.
    #[must_use]
    pub fn drawn_ids(&self) -> Vec<u64> {
        let mut ids = Vec::new();
        for &object in self.ids.order() {
            let first = self.ids.id(object, 0);
            match self.drawn(object) {
                Some(mask) => ids.extend(mask.surfels().map(|surfel| first + surfel as u64)),
                None => ids.extend(first..first + u64::from(self.ids.count(object))),
            }
        }
        ids
    }

    /// The lower median of all radii that are drawn. An object without levels of detail contributes
    /// its median radius as often as it has surfels, if it is drawn.
    fn median_of_drawn(&self, exec: &Exec) -> f32 {
        let middle = self.drawn_total().saturating_sub(1) / 2;
        // Radii are positive, so their bits ascend as the radii do: first find the high half, then
        // the low.
        let (high, before) = nth(&self.histogram(exec, |bits| Some(bits >> 16)), middle);
        let low = |bits: u32| (bits >> 16 == high).then_some(bits & 0xFFFF);
        let (low, _) = nth(&self.histogram(exec, low), middle - before);
        f32::from_bits(high << 16 | low)
    }

    /// Counts the drawn radii for each of 2^16 keys.
    fn histogram(&self, exec: &Exec, key: impl Fn(u32) -> Option<u32> + Sync) -> Vec<u64> {
        let objects: Vec<u32> = (0..self.objects.len() as u32).collect();
        let share = objects.len().div_ceil(4 * exec.threads());
        let shares = exec.ordered(objects.chunks(share).collect(), |objects: &[u32]| {
            let mut counts = vec![0_u64; 1 << 16];
            for &object in objects {
                let (surfels, scale) =
                    (&self.geometry(object).surfels, self.places[object as usize].scale);
                let scaled = |radius: f32| (f64::from(radius) * scale) as f32;
                let mut add = |radius: f32, times: u64| {
                    if let Some(key) = key(radius.to_bits()) {
                        counts[key as usize] += times;
                    }
                };
                let all = u64::from(self.ids.count(object));
                match (self.drawn(object), self.disc(object)) {
                    (Some(mask), _) => {
                        mask.surfels().for_each(|i| add(scaled(surfels.radius()[i]), 1));
                    }
                    (None, Some(disc)) => add(disc.radius, all),
                    (None, None) => add(scaled(surfels.median_radius()), all),
                }
            }
            counts
        });
        shares.into_iter().fold(vec![0; 1 << 16], |mut sum, share| {
            sum.iter_mut().zip(share).for_each(|(sum, count)| *sum += count);
            sum
        })
    }
}

/// The key of the element with this rank, and how many elements have lower keys.
fn nth(counts: &[u64], rank: u64) -> (u32, u64) {
    let mut before = 0;
    for (key, &count) in (0..).zip(counts) {
        if rank < before + count {
            return (key, before);
        }
        before += count;
    }
    (0, 0)
}

/// A camera in the numbers that levels of detail need; of a stereo pair, the camera in the middle.
struct Eye {
    camera: Camera,
    view_from_world: DMat4,
    eye: DVec3,
    /// Added to x of view space, this gives x of each eye's view space; 0 without a pair.
    shifts: [f64; 2],
}

impl Eye {
    fn new(camera: &Camera) -> Self {
        let mut view_from_world = camera.view_from_world.as_dmat4();
        let own = view_from_world.w_axis.x;
        let other = camera.other_eye.map_or(own, f64::from);
        // Both eyes get the same bits, because f64 holds the sum of two f32 of like size exactly, and
        // a sum does not depend on the order of two numbers.
        let middle = (own + other) / 2.0;
        view_from_world.w_axis.x = middle;
        let eye = view_from_world.inverse().w_axis.truncate();
        Self { camera: *camera, view_from_world, eye, shifts: [own - middle, other - middle] }
    }

    /// The eye in the coordinates of an object's geometry.
    fn before(&self, place: &Similarity) -> DVec3 {
        place.rotation.transpose() * (self.eye - place.translation) / place.scale
    }

    /// The greater focal length.
    fn focal(&self) -> f64 {
        f64::from(self.camera.fx.at_least(self.camera.fy))
    }

    /// Whether a sphere reaches into the picture of an eye, widened by `margin` pixels.
    fn may_see(&self, Sphere { center: middle, radius }: Sphere, margin: f64) -> bool {
        let Camera { width, height, projection, fx, fy, cx, cy, near, .. } = self.camera;
        let [fx, fy, cx, cy, near] = [fx, fy, cx, cy, near].map_inline(f64::from);
        let DVec3 { x, y, z } = self.view_from_world.transform_point3(middle);
        let t = -z;
        let inside = |focal: f64, at: f64, border: f64| {
            let border = border + margin;
            match projection {
                Projection::Perspective => {
                    let normal = (focal * focal + border * border).sqrt();
                    focal * at + border * t >= -radius * normal
                }
                Projection::Orthographic => focal * at + border >= -radius * focal,
            }
        };
        let across = |x: f64| inside(fx, x, cx) && inside(fx, -x, f64::from(width) - cx);
        t + radius > near
            && self.shifts.iter().any(|shift| across(x + shift))
            && inside(fy, -y, cy)
            && inside(fy, y, f64::from(height) - cy)
    }
}

#[cfg(test)]
mod tests;
