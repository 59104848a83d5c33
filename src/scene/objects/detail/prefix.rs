//! Draw a prefix of the ordered surfels, as many as the view needs \[BJFM19, 4.1\].
//!
//! The surfels of the geometry are in an order whose every prefix covers the surface, such as the
//! order of a [sampler](crate::source::sampler). A view draws the first p(r) of them as discs of
//! one radius r, in the coordinates of the geometry. r is s / 2 pixels where the object is nearest.
//! In f64:
//!
//! ```text
//!   d_p  = (t / f) / k      the width of a pixel where the object is nearest; orthographic: (1 / f) / k
//!   r    = s d_p / 2        s: the size in pixels that the view chooses
//!   p(r) = p_m (q q)        q = r_m / r
//! ```
//!
//! f is the greater of fx and fy, k the scale of the object, and `r_m` the [`Estimate::distance`]
//! of a prefix of `p_m` = [`Estimate::count`] surfels. t is the depth of the object's nearest point
//! c, in its place, but at least the depth of the near plane. c is the point of the box around the
//! geometry that is closest to the eye e, both in the coordinates of the geometry:
//! `c = max(low, min(e, high))` for each component. The box is around the positions of all surfels
//! and of the vertices that a primitive uses, without their radii. e is the eye of [`super::tree`].
//! A place is one of [`crate::scene::Similarity`], but is not rounded to f32 here.
//!
//! `Departs:` the paper prints r = s / (2 `d_p`), with which discs shrink where pixels become
//! wider.
//!
//! `Decided:` `d_p` is taken at the closest point, as in the paper's example. Discs farther away
//! are smaller than s on the screen, so a long object gets more of them than it needs, as the paper
//! says in its section 6.

use super::{Detail, Eye};
use crate::error::{Error, Result};
use crate::number::Real;
use crate::scene::bounds::Bounds;
use crate::scene::objects::Geometry;
use crate::scene::{Projection, Similarity, Sphere, bounds};
use glam::DVec3;

/// How densely an order covers: "\[`r_m`\] is the precomputed median minimum distance for a fixed
/// prefix length \[`p_m`\]".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// `p_m`: how many surfels the prefix has.
    pub count: u32,
    /// `r_m`: the lower median of the distances from each surfel to the nearest other that faces
    /// alike, see [`mod@crate::source::sampler::estimate`]; 0 if there is no other.
    pub distance: f32,
}

/// The order of a geometry.
#[derive(Clone, Debug)]
pub struct Prefix {
    estimate: Estimate,
    /// n: the number of all surfels.
    count: u32,
    /// The box around the geometry.
    corners: [DVec3; 2],
    pub(super) sphere: Sphere,
}

impl Prefix {
    /// Makes the prefix of a geometry from its outline alone.
    pub(in crate::scene::objects) fn outlined(
        count: u32,
        estimate: Estimate,
        bounds: &Bounds,
    ) -> Self {
        let (corners, sphere) = bounds.corners_and_sphere();
        Self { estimate, count, corners, sphere }
    }

    /// How densely the order covers.
    #[must_use]
    pub fn estimate(&self) -> Estimate {
        self.estimate
    }

    /// n: how many surfels there are.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.count
    }

    /// p(r): how many surfels of this radius cover the surface.
    #[must_use]
    pub fn covering(&self, radius: f64) -> f64 {
        let q = f64::from(self.estimate.distance) / radius;
        f64::from(self.estimate.count) * (q * q)
    }

    /// The radius with which all surfels cover, by the same estimate: where p(r) is their number.
    #[must_use]
    pub fn radius_of_all(&self) -> f64 {
        let Estimate { count, distance } = self.estimate;
        f64::from(distance) * (f64::from(count) / f64::from(self.count)).sqrt()
    }

    /// `d_p` of an object in its place.
    pub(super) fn pixel(&self, place: &Similarity, eye: &Eye) -> f64 {
        if eye.camera.projection == Projection::Orthographic {
            return 1.0 / eye.focal() / place.scale;
        }
        let [low, high] = self.corners;
        let at = eye.before(place);
        let component = |i: usize| at[i].at_most(high[i]).at_least(low[i]);
        let closest = DVec3::new(component(0), component(1), component(2));
        let world = place.rotation * (closest * place.scale) + place.translation;
        let depth = -eye.view_from_world.transform_point3(world).z;
        depth.at_least(f64::from(eye.camera.near)) / eye.focal() / place.scale
    }
}

impl Geometry {
    /// Gives the geometry the order of its surfels. From here on no view draws the radii of the
    /// surfels. They are used where no camera is known, and in the sphere around the geometry: the
    /// test of the view frustum, the zones and the bounding sphere of the scene read this sphere.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are no surfels, or levels of detail already; if the estimate
    /// counts no surfel or more than there are; or if its distance is not finite or less than 0.
    pub fn with_prefix(self, estimate: Estimate) -> Result<Self> {
        self.check_plain()?;
        let Estimate { count, distance } = estimate;
        let all = self.surfels.len() as u32;
        if !(1..=all).contains(&count) || !(0.0..f32::INFINITY).contains(&distance) {
            let what = format!("{count} of {all} surfels, {distance} apart, define no density");
            return Err(Error::Invalid(format!("{}: {what}", self.name)));
        }
        let (low, high) = bounds::corners(&self.surfels, &self.primitives);
        let prefix = Prefix {
            estimate,
            count: all,
            corners: [low.as_dvec3(), high.as_dvec3()],
            sphere: bounds::sphere(&self.surfels, &self.primitives),
        };
        Ok(Self { detail: Some(Detail::Prefix(prefix)), ..self })
    }
}
