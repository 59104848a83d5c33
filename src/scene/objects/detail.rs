//! Levels of detail: which surfels of an object a view draws \[GBP04, 7.2\].
//!
//! A geometry with levels of detail has the nodes of a [sequential point tree](crate::index::sequential) in the
//! place of its surfels, in the order of the list, and a threshold tau in pixels. Of an object of scale k,
//! rotation R and translation T, seen by a camera at the eye E with the focal lengths fx and fy, in f64:
//!
//! ```text
//!   e    = transpose(R) (E - T) / k             the eye in the coordinates of the geometry
//!   s    = f / tau                              f the greater of fx and fy; +inf where tau = 0
//!   r(p) = |p - e|                              of a node at p, sqrt((dx dx + dy dy) + dz dz)
//!   r    = 1 / k                                of every node, orthographic
//! ```
//!
//! A perspective camera draws the nodes that [`Sequential::holds`] at r(p) and s, an orthographic one
//! those that [`Sequential::cuts`] at r and s. Before a camera is known the surfels are drawn that
//! the geometry was made of.
//!
//! Only the first so many nodes of the list are looked at, and have [ids](super::ids) in that view:
//! [`Sequential::prefix`] of s and the least distance, `|c - e| - R - (|c| + R) / 2^20`, at least 0,
//! with c and R of the sphere around the surfels that the geometry was made of, and its primitives, in its
//! own coordinates; r of an orthographic camera.
//!
//! An object with levels of detail whose sphere is not in the view frustum draws nothing and has no ids; of
//! other objects all surfels are drawn. With the sphere in its place and in view
//! space, its depth t and radius R, in f64, it is outside if `t + R <= near`, or on one of the four sides, if it is
//! beyond the border of the picture widened by 16 pixels and tau: for the left one
//!
//! ```text
//!   fx x + (cx + m) t < -R sqrt(fx fx + (cx + m) (cx + m))        m = 16 + tau
//!   fx x + (cx + m)   < -R fx                                      orthographic
//! ```
//!
//! for the right one with -x and `width - cx`, for the upper one with fy, -y and cy, for the lower one with
//! fy, y and `height - cy`. View space is `((m0 x + m1 y) + m2 z) + m3` of the camera's matrix.
//! `Decided:` 16 pixels, more than the filter of a splat adds to it.
//! Discs of inner nodes reach beyond the surfels by tau at most.

use super::{Geometry, Objects};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::sequential::Sequential;
use crate::number::Real;
use crate::scene::objects::Ids;
use crate::scene::{Camera, Projection, Similarity, bounds};
use glam::{DMat4, DVec3};
use std::sync::Arc;

/// The largest threshold in pixels.
pub const MOST_PIXELS: f64 = 4096.0;

/// How much the picture is widened on each side, in pixels.
const MARGIN: f64 = 16.0;

/// Levels of detail of a geometry.
#[derive(Clone, Debug)]
pub struct Detail {
    list: Sequential,
    threshold: f64,
    leaves: Arc<Mask>,
    /// Of the surfels that the geometry was made of: how many, their median radius, and a sphere.
    pub(super) count: u32,
    pub(super) median_radius: f32,
    pub(super) sphere: (DVec3, f64),
}

impl Detail {
    /// When each node is drawn.
    #[must_use]
    pub fn list(&self) -> &Sequential {
        &self.list
    }

    /// tau: the error that a node may have on the screen, in pixels.
    #[must_use]
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// The surfels that the geometry was made of.
    pub(super) fn leaves(&self) -> Arc<Mask> {
        Arc::clone(&self.leaves)
    }
}

impl Geometry {
    /// The geometry with levels of detail, whose nodes are its surfels from here on. `threshold` is tau,
    /// in [0, [`MOST_PIXELS`]]. Prefiltered colours are left out: those of inner nodes are averages.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the threshold is out of range, if there are no surfels, or levels of detail
    /// already, and as [`Sequential::new`].
    pub fn with_detail(self, threshold: f64, exec: &Exec) -> Result<Self> {
        if !(0.0..=MOST_PIXELS).contains(&threshold) {
            let what = format!("levels of detail of {threshold} pixels; give 0 to {MOST_PIXELS}");
            return Err(Error::Invalid(what));
        }
        if self.detail.is_some() || self.surfels.is_empty() {
            let what = if self.surfels.is_empty() { "no surfels for" } else { "already" };
            return Err(Error::Invalid(format!("{} has {what} levels of detail", self.name)));
        }
        let (nodes, list) = Sequential::new(&self.surfels, exec)?;
        let detail = Detail {
            leaves: Arc::new(Mask::of(nodes.len(), |node| list.surfel(node).is_some())),
            list,
            threshold,
            count: self.surfels.len() as u32,
            median_radius: self.surfels.median_radius(),
            sphere: bounds::sphere(&self.surfels, &self.primitives),
        };
        Ok(Self { surfels: nodes, detail: Some(detail), ..self })
    }
}

/// A bit for each of the first so many surfels of an object: whether it is drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mask {
    words: Vec<u64>,
}

impl Mask {
    fn of(count: usize, is_drawn: impl Fn(usize) -> bool) -> Self {
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
    /// The same objects as a camera sees them: which surfels those with [levels of detail](self) draw, their ids,
    /// and the unit of epsilon.
    ///
    /// # Errors
    /// As [`Ids::new`].
    pub fn seen_from(&self, camera: &Camera, exec: &Exec) -> Result<Self> {
        if !self.have_detail() {
            return Ok(self.clone());
        }
        let seen = Eye::new(camera);
        let all: Vec<u32> = (0..self.objects.len() as u32).collect();
        let drawn = exec.ordered(all, |object| {
            let (geometry, place) = (self.geometry(object), &self.places[object as usize]);
            let detail = geometry.detail.as_ref()?;
            Some(seen.drawn(geometry, detail, place, self.sphere(object)))
        });
        let mut counts = Vec::with_capacity(drawn.len());
        let mut masks = Vec::with_capacity(drawn.len());
        for (object, drawn) in (0_u32..).zip(drawn) {
            let all = self.ids.all(object);
            counts.push(drawn.as_ref().map_or(all, |(count, _)| *count));
            masks.push(drawn.map(|(_, mask)| Arc::new(mask)));
        }
        let all: Vec<u32> = (0..self.objects.len() as u32).map(|o| self.ids.all(o)).collect();
        let ids = Ids::first(counts, all, |object| self.objects[object].name.clone())?;
        let mut seen = Self { ids: Arc::new(ids), drawn: masks.into(), ..self.clone() };
        seen.median_radius = seen.median_of_drawn(exec);
        Ok(seen)
    }

    /// Whether some objects have levels of detail.
    #[must_use]
    pub fn have_detail(&self) -> bool {
        self.geometries.iter().any(|geometry| geometry.detail.is_some())
    }

    /// Which surfels of an object are drawn; none: all.
    #[must_use]
    pub fn drawn(&self, object: u32) -> Option<&Mask> {
        self.drawn[object as usize].as_deref()
    }

    /// How many surfels are drawn.
    #[must_use]
    pub fn drawn_total(&self) -> u64 {
        let of = |object| match self.drawn(object) {
            Some(mask) => mask.count(),
            None => self.ids.count(object).into(),
        };
        (0..self.objects.len() as u32).map(of).sum()
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

    /// The lower median of all radii that are drawn; an object without levels of detail has its median radius as
    /// often as it has surfels.
    fn median_of_drawn(&self, exec: &Exec) -> f32 {
        let middle = self.drawn_total().saturating_sub(1) / 2;
        // Radii are positive, so that their bits ascend as they do: first the high half, then the low.
        let (high, before) = nth(&self.histogram(exec, |bits| Some(bits >> 16)), middle);
        let low = |bits: u32| (bits >> 16 == high).then_some(bits & 0xFFFF);
        let (low, _) = nth(&self.histogram(exec, low), middle - before);
        f32::from_bits(high << 16 | low)
    }

    /// How many radii that are drawn have which of 2^16 keys.
    fn histogram(&self, exec: &Exec, key: impl Fn(u32) -> Option<u32> + Sync) -> Vec<u64> {
        let objects: Vec<u32> = (0..self.objects.len() as u32).collect();
        let share = objects.len().div_ceil(4 * exec.threads());
        let shares = exec.ordered(objects.chunks(share).collect(), |objects: &[u32]| {
            let mut counts = vec![0_u64; 1 << 16];
            for &object in objects {
                let (surfels, scale) =
                    (&self.geometry(object).surfels, self.places[object as usize].scale);
                let mut add = |radius: f32, times: u64| {
                    let scaled = (f64::from(radius) * scale) as f32;
                    if let Some(key) = key(scaled.to_bits()) {
                        counts[key as usize] += times;
                    }
                };
                match self.drawn(object) {
                    Some(mask) => mask.surfels().for_each(|i| add(surfels.radius()[i], 1)),
                    None => add(surfels.median_radius(), self.ids.count(object).into()),
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

/// The key of which the element of a rank is, and how many come before those of the key.
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

/// A camera as levels of detail see it.
struct Eye {
    camera: Camera,
    view_from_world: DMat4,
    eye: DVec3,
}

impl Eye {
    fn new(camera: &Camera) -> Self {
        let view_from_world = camera.view_from_world.as_dmat4();
        Self { camera: *camera, view_from_world, eye: camera.eye() }
    }

    /// How many nodes of an object are looked at, and which of them are drawn.
    fn drawn(
        &self,
        geometry: &Geometry,
        detail: &Detail,
        place: &Similarity,
        sphere: (DVec3, f64),
    ) -> (u32, Mask) {
        if !self.may_see(sphere, MARGIN + detail.threshold) {
            return (0, Mask::default());
        }
        let list = &detail.list;
        let scale = f64::from(self.camera.fx.at_least(self.camera.fy)) / detail.threshold;
        if self.camera.projection == Projection::Orthographic {
            let distance = 1.0 / place.scale;
            let count = list.prefix(distance, scale);
            return (count as u32, Mask::of(count, |node| list.cuts(node, distance, scale)));
        }
        let eye = place.rotation.transpose() * (self.eye - place.translation) / place.scale;
        let (middle, radius) = detail.sphere;
        let lost = (middle.length() + radius) / 1_048_576.0;
        let least = ((middle - eye).length() - radius - lost).at_least(0.0);
        let count = list.prefix(least, scale);
        if scale == f64::INFINITY {
            return (count as u32, (*detail.leaves).clone());
        }
        let points = geometry.surfels.position();
        let word = |first| list.holding(first..count.min(first + 64), points, eye, scale);
        (count as u32, Mask { words: (0..count).step_by(64).map(word).collect() })
    }

    /// Whether a sphere reaches into the picture, widened by so many pixels.
    fn may_see(&self, (middle, radius): (DVec3, f64), margin: f64) -> bool {
        let Camera { width, height, projection, fx, fy, cx, cy, near, .. } = self.camera;
        let [fx, fy, cx, cy, near] = [fx, fy, cx, cy, near].map(f64::from);
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
        t + radius > near
            && inside(fx, x, cx)
            && inside(fx, -x, f64::from(width) - cx)
            && inside(fy, -y, cy)
            && inside(fy, y, f64::from(height) - cy)
    }
}

#[cfg(test)]
mod tests;
