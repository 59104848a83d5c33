//! Scenes of objects: geometries that are in memory once, and objects that use them, each in its
//! place, which may change from frame to frame.
//!
//! - [`ids`]: an object and a surfel in one number.
//! - [`motion`]: where an object is in a frame.
//! - [`detail`]: which surfels of an object a view draws, of a geometry with levels of detail.
//! - [`outline`]: objects whose geometries are read when a view needs them.
//! - `place`: surfels of objects in their places.
//!
//! A surfel of an object is that of its geometry, placed by [`Similarity::apply`] with the object's
//! place in the frame, and then checked as [`Surfels::new`] checks a surfel, which makes its normal a
//! unit vector again. A scene has colours, opacities or half axes if an object, or the surfels of a geometry that an
//! object uses, has, and colours also if the primitives of one have; if none has a colour, that of the material holds. What only some of the objects have the others get: the colour
//! [`Objects::fill`], the opacity 1, the half axes of [`super::cloud::half_axes`], of
//! the placed normal and radius, before the normal is made a unit vector again. The colour of an object
//! stands in the place of that of its geometry.
//!
//! `Decided:` the median radius, the unit of epsilon, is the lower median, the element of rank
//! (n - 1) / 2 over all surfels of all objects in the frame, of the objects' median
//! radii, each its geometry's times the object's scale (in f64, rounded to f32) and counted once for
//! each of its surfels: neither what is seen of a scene nor how it is selected changes
//! epsilon; where scales move, epsilon does from frame to frame. Of objects with levels of detail all
//! radii that are drawn count, each once: epsilon has to be that of the discs that lie over each other,
//! and those of a level far away are large. Where nothing is drawn it is 0.

pub mod detail;
pub mod ids;
pub mod motion;
pub mod outline;
mod place;

use super::{Boxes, Primitives, Similarity, Surfels};
use crate::error::{Error, Result};
pub use detail::Detail;
use detail::DrawnPart;
use detail::refine::{Forest, Refinement};
use glam::{DVec3, Vec3};
pub use ids::{Ids, Split};

pub use motion::Motion;
use place::Extent;
use std::sync::Arc;

/// What objects are copies of: surfels and primitives in coordinates of their own.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// What it is called.
    pub name: String,
    /// Its surfels; of a tree all nodes.
    pub surfels: Surfels,
    /// What there is beside them.
    pub primitives: Primitives,
    /// Which of its surfels are drawn, see [`Geometry::with_detail`] and [`Geometry::with_prefix`]; none: all.
    pub detail: Option<Detail>,
}

/// A geometry in some place.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// What it is called.
    pub name: String,
    /// The geometry, by its index.
    pub geometry: usize,
    /// Where it is.
    pub motion: Motion,
    /// Linear RGB for all of it, in place of the geometry's.
    pub color: Option<Vec3>,
}

/// Objects, their geometries, and where they are in a frame.
#[derive(Clone, Debug)]
pub struct Objects {
    geometries: Arc<[Geometry]>,
    objects: Arc<[Object]>,
    ids: Arc<Ids>,
    /// Of each geometry.
    extents: Arc<[Extent]>,
    fill: Vec3,
    frame: u32,
    places: Vec<Similarity>,
    refinement: Arc<Refinement>,
    forest: Option<Arc<Forest>>,
    /// What is drawn of each object.
    shown: Arc<[DrawnPart]>,
    median_radius: f32,
    bounding_sphere: (DVec3, f64),
    /// The hash of what geometries are read from, if they are known by that.
    source: Option<[u8; 32]>,
}

impl Objects {
    /// Objects in frame 0. `fill` is the colour of those without one, if some have one.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no object, if one has a geometry that does not exist, if its
    /// surfels leave the range of f32, or as [`Ids::new`].
    pub fn new(geometries: Vec<Geometry>, objects: Vec<Object>, fill: Vec3) -> Result<Self> {
        let extents = geometries.iter().map(Extent::new).collect();
        Self::assembled(geometries, extents, objects, fill)
    }

    fn assembled(
        geometries: Vec<Geometry>,
        extents: Vec<Extent>,
        objects: Vec<Object>,
        fill: Vec3,
    ) -> Result<Self> {
        if objects.is_empty() {
            return Err(Error::Invalid("the scene has no objects".into()));
        }
        if let Some(object) = objects.iter().find(|object| object.geometry >= geometries.len()) {
            return Err(Error::Invalid(format!("{} has no geometry", object.name)));
        }
        let mut still = Self {
            extents: extents.into(),
            geometries: geometries.into(),
            objects: objects.into(),
            ids: Arc::new(Ids::none()),
            fill,
            frame: 0,
            places: Vec::new(),
            refinement: Arc::new(Refinement::default()),
            forest: None,
            shown: Arc::new([]),
            median_radius: 0.0,
            bounding_sphere: (DVec3::ZERO, 0.0),
            source: None,
        };
        still.ids = Arc::new(still.ids_of_all()?);
        still.at(0)
    }

    /// Ids for all surfels of all objects.
    fn ids_of_all(&self) -> Result<Ids> {
        let count = |object: &Object| self.extents[object.geometry].count;
        let counts = self.objects.iter().map(count).collect();
        Ids::new(counts, |object| self.objects[object].name.clone())
    }

    /// The same objects in another frame, with all their surfels: of those with levels of detail
    /// the ones that they were made of.
    ///
    /// # Errors
    /// [`Error::Invalid`] if surfels of an object leave the range of f32 there, and as [`Ids::new`].
    pub fn at(&self, frame: u32) -> Result<Self> {
        let places: Vec<_> = self.objects.iter().map(|object| object.motion.at(frame)).collect();
        let at_rest = |object: &Object| {
            let all = self.extents[object.geometry].count;
            DrawnPart::at_rest(&self.geometries[object.geometry], all)
        };
        let shown = self.objects.iter().map(at_rest).collect();
        let mut moved = Self { frame, places, shown, ..self.clone() };
        if self.have_detail() {
            moved.ids = Arc::new(self.ids_of_all()?);
        }
        for (object, place) in moved.objects.iter().zip(&moved.places) {
            if !moved.extents[object.geometry].is_in_range(place) {
                return Err(Error::Invalid(format!(
                    "{} leaves the range of f32 in frame {frame}: its scale or its place is out of \
                     bounds",
                    object.name
                )));
            }
        }
        moved.median_radius = moved.median_of_medians();
        moved.bounding_sphere = moved.sphere_of_spheres();
        Ok(moved)
    }

    /// The geometries.
    #[must_use]
    pub fn geometries(&self) -> &[Geometry] {
        &self.geometries
    }

    /// The objects, in the order of the scene.
    #[must_use]
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// Where each object is.
    #[must_use]
    pub fn places(&self) -> &[Similarity] {
        &self.places
    }

    /// The same objects with ids by another split, which stands until the next frame; none if it does not fit.
    #[must_use]
    pub fn split_as(&self, split: Split) -> Option<Self> {
        Some(Self { ids: Arc::new(self.ids.split_as(split)?), ..self.clone() })
    }

    /// The ids of their surfels.
    #[must_use]
    pub fn ids(&self) -> &Ids {
        &self.ids
    }

    /// The colour of objects without one, if some have one.
    #[must_use]
    pub fn fill(&self) -> Vec3 {
        self.fill
    }

    /// The frame in which they are.
    #[must_use]
    pub fn frame(&self) -> u32 {
        self.frame
    }

    /// Whether they are at the same places in every frame.
    #[must_use]
    pub fn are_still(&self) -> bool {
        self.objects.iter().all(|object| object.motion.is_still())
    }

    /// The unit of epsilon, see the [module](self).
    #[must_use]
    pub fn median_radius(&self) -> f32 {
        self.median_radius
    }

    /// The geometry of an object.
    #[must_use]
    pub fn geometry(&self, object: u32) -> &Geometry {
        &self.geometries[self.objects[object as usize].geometry]
    }

    /// How many surfels the geometry of an object has, read or not.
    pub(super) fn count_of_all(&self, object: u32) -> u32 {
        self.extents[self.objects[object as usize].geometry].count
    }

    /// The boxes of the surfels of an object, in the coordinates of its geometry.
    #[must_use]
    pub fn boxes(&self, object: u32) -> &Boxes {
        &self.extents[self.objects[object as usize].geometry].boxes
    }

    /// A sphere around all surfels and primitives of an object: middle and radius, in f64. It is that of the
    /// geometry by the rule of [`super::Scene::bounding_sphere`], whose middle is placed as a point is, and
    /// whose radius is scaled; nothing is rounded to f32.
    #[must_use]
    pub fn sphere(&self, object: u32) -> (DVec3, f64) {
        let place = &self.places[object as usize];
        let (middle, radius) = self.extents[self.objects[object as usize].geometry].sphere;
        (place.rotation * (middle * place.scale) + place.translation, radius * place.scale)
    }

    /// Whether there are primitives in an object.
    #[must_use]
    pub fn have_primitives(&self) -> bool {
        self.objects.iter().any(|object| self.extents[object.geometry].primitives)
    }

    /// A sphere around everything: the middle of the box around the objects' spheres, and the
    /// farthest that one of them reaches from there; in f64.
    #[must_use]
    pub fn bounding_sphere(&self) -> (DVec3, f64) {
        self.bounding_sphere
    }

    fn sphere_of_spheres(&self) -> (DVec3, f64) {
        let spheres = (0..self.objects.len() as u32).map(|object| self.sphere(object));
        let spheres: Vec<_> = spheres.collect();
        let mut corners = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for (middle, radius) in &spheres {
            corners[0] = corners[0].min(*middle - *radius);
            corners[1] = corners[1].max(*middle + *radius);
        }
        let center = (corners[0] + corners[1]) / 2.0;
        let far = spheres.iter().map(|(middle, radius)| (*middle - center).length() + radius);
        (center, far.fold(0.0, |most, far| if far > most { far } else { most }))
    }

    fn median_of_medians(&self) -> f32 {
        let of = |(object, place): (&Object, &Similarity)| {
            let (count, median) = self.extents[object.geometry].at_rest;
            // The median of radii that are scaled is the median, scaled: rounding keeps their order.
            ((f64::from(median) * place.scale) as f32, u64::from(count))
        };
        let mut medians: Vec<_> = self.objects.iter().zip(&self.places).map(of).collect();
        medians.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: u64 = medians.iter().map(|(_, count)| count).sum();
        let middle = total.saturating_sub(1) / 2;
        let mut before = 0;
        let median = medians.iter().find(|(_, count)| {
            before += count;
            before > middle
        });
        median.map_or(0.0, |&(radius, _)| radius)
    }
}

#[cfg(test)]
mod tests;
