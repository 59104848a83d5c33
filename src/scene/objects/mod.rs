//! Scenes of objects: a geometry is in memory once, and many objects use it, each in a place that
//! may change from frame to frame.
//!
//! - [`ids`]: an object and a surfel in one number.
//! - [`motion`]: where an object is in a frame.
//! - [`detail`]: which surfels a view draws of an object whose geometry has levels of detail.
//! - [`outline`]: objects whose geometries are read when a view needs them.
//! - `place`: surfels of objects in their places.
//!
//! A surfel of an object is a surfel of its geometry, placed by [`Similarity::apply`] with the
//! object's place in the frame. It is then checked as [`Surfels::new`] checks a surfel, which makes
//! its normal a unit vector again.
//!
//! A scene has colours, opacities or half axes if an object has them, or the surfels of a geometry
//! that an object uses. It also has colours if the primitives of such a geometry have colours. If
//! nothing has a colour, the colour of the material applies. Objects that lack what others have get
//! these values:
//!
//! - the colour [`Objects::fill`]: the colour of the scene's material, (0.75, 0.75, 0.75) by
//!   default. In a hierarchy of a folder it is the colour in its index, so the material's when the
//!   folder was made;
//! - the opacity 1;
//! - the half axes of [`super::cloud::half_axes`], from the placed normal and radius, before the
//!   normal is made a unit vector again.
//!
//! The colour of an object replaces the colour of its geometry.
//!
//! `Decided:` the median radius, the unit of epsilon, is a lower median: the element of rank
//! (n - 1) / 2 over all surfels of all objects in the frame. Each surfel counts with its object's
//! median radius: the geometry's median radius times the object's scale, in f64, rounded to f32. So
//! epsilon does not change with the visible part of a scene or with how it is selected; where
//! scales move, epsilon changes from frame to frame. Objects with levels of detail instead count
//! all radii that are drawn, each once. Epsilon has to fit the discs that lie over each other, and
//! the discs of a level far away are large. Where nothing is drawn the median radius is 0.

pub mod detail;
pub mod ids;
pub mod motion;
pub mod outline;
mod place;

use super::{Boxes, Primitives, Similarity, Surfels};
use crate::error::{Error, Result};
use crate::scene::Sphere;
pub use detail::Detail;
use detail::DrawnPart;
use detail::refine::{Forest, Refinement};
use glam::{DVec3, Vec3};
pub use ids::{Ids, Split};

pub use motion::Motion;
use place::Extent;
use std::sync::Arc;

/// The model that objects are copies of: surfels and primitives in coordinates of their own.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// The geometry's name.
    pub name: String,
    /// The surfels; for a tree, all nodes.
    pub surfels: Surfels,
    /// Triangles, ribbons and tubes beside the surfels.
    pub primitives: Primitives,
    /// Which surfels are drawn, see [`Geometry::with_detail`] and [`Geometry::with_prefix`]; none
    /// means all.
    pub detail: Option<Detail>,
}

/// A geometry in a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// The object's name.
    pub name: String,
    /// The index of its geometry.
    pub geometry: usize,
    /// Where it is.
    pub motion: Motion,
    /// Linear RGB for the whole object; replaces the geometry's colour.
    pub color: Option<Vec3>,
}

/// Objects, their geometries, and where they are in a frame.
#[derive(Clone, Debug)]
pub struct Objects {
    geometries: Arc<[Geometry]>,
    objects: Arc<[Object]>,
    ids: Arc<Ids>,
    /// One extent for each geometry.
    extents: Arc<[Extent]>,
    fill: Vec3,
    frame: u32,
    places: Vec<Similarity>,
    refinement: Arc<Refinement>,
    forest: Option<Arc<Forest>>,
    /// What is drawn of each object.
    shown: Arc<[DrawnPart]>,
    median_radius: f32,
    bounding_sphere: Sphere,
    /// The hash of the files that geometries are read from, if the hash identifies them.
    source: Option<[u8; 32]>,
}

impl Objects {
    /// Makes objects in frame 0. `fill` is the colour of objects without one, if some have one.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no object, if an object's geometry does not exist, if an
    /// object's surfels leave the range of f32, or as [`Ids::new`].
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
            bounding_sphere: Sphere::default(),
            source: None,
        };
        still.ids = Arc::new(still.ids_of_all()?);
        still.at(0)
    }

    /// Makes ids for all surfels of all objects.
    fn ids_of_all(&self) -> Result<Ids> {
        let count = |object: &Object| self.extents[object.geometry].count;
        let counts = self.objects.iter().map(count).collect();
        Ids::new(counts, |object| self.objects[object].name.clone())
    }

    /// Moves the objects to another frame, with all their surfels. Objects with levels of detail
    /// get the surfels that they were made of.
    ///
    /// # Errors
    /// [`Error::Invalid`] if surfels of an object leave the range of f32 there, and as
    /// [`Ids::new`].
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
                    "{} leaves the range of f32 in frame {frame}; make its scale smaller, or move \
                     it closer",
                    object.name
                )));
            }
        }
        moved.median_radius = moved.median_of_medians();
        moved.bounding_sphere = moved.sphere_of_spheres();
        Ok(moved)
    }

    /// Replaces geometries, given with their indices, by geometries with as many surfels: the same
    /// surfels in another frame, to which [`Objects::at`] then moves the objects.
    #[must_use]
    pub(crate) fn with_geometries(mut self, replaced: Vec<(usize, Geometry)>) -> Self {
        let (mut geometries, mut extents) = (self.taken(), self.extents.to_vec());
        for (index, geometry) in replaced {
            extents[index] = Extent::new(&geometry);
            geometries[index] = geometry;
        }
        Self { geometries: geometries.into(), extents: extents.into(), ..self }
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

    /// The place of each object.
    #[must_use]
    pub fn places(&self) -> &[Similarity] {
        &self.places
    }

    /// Replaces the ids by another split, which holds until the next frame; none if the split does
    /// not fit.
    #[must_use]
    pub fn split_as(&self, split: Split) -> Option<Self> {
        Some(Self { ids: Arc::new(self.ids.split_as(split)?), ..self.clone() })
    }

    /// The ids of the surfels.
    #[must_use]
    pub fn ids(&self) -> &Ids {
        &self.ids
    }

    /// The colour of objects without one, if some have one: the material's, see the
    /// [module](self).
    #[must_use]
    pub fn fill(&self) -> Vec3 {
        self.fill
    }

    /// The frame that the objects are in.
    #[must_use]
    pub fn frame(&self) -> u32 {
        self.frame
    }

    /// Whether the objects have the same places in every frame.
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

    /// How many surfels the geometry of an object has, whether they have been read or not.
    pub(super) fn count_of_all(&self, object: u32) -> u32 {
        self.extents[self.objects[object as usize].geometry].count
    }

    /// The boxes around the surfels of an object, in the coordinates of its geometry.
    #[must_use]
    pub fn boxes(&self, object: u32) -> &Boxes {
        &self.extents[self.objects[object as usize].geometry].boxes
    }

    /// A sphere around all surfels and primitives of an object: middle and radius, in f64. It is
    /// the sphere of the geometry by the rule of [`super::Scene::bounding_sphere`]. Its middle is
    /// placed as a point is, its radius is scaled, and nothing is rounded to f32.
    #[must_use]
    pub fn sphere(&self, object: u32) -> Sphere {
        let place = &self.places[object as usize];
        let Sphere { center: middle, radius } =
            self.extents[self.objects[object as usize].geometry].sphere;
        let center = place.rotation * (middle * place.scale) + place.translation;
        Sphere { center, radius: radius * place.scale }
    }

    /// Whether some object has primitives.
    #[must_use]
    pub fn have_primitives(&self) -> bool {
        self.objects.iter().any(|object| self.extents[object.geometry].primitives)
    }

    /// A sphere around everything: the middle of the box around the objects' spheres, and the
    /// farthest distance that one of the spheres reaches from there; in f64.
    #[must_use]
    pub fn bounding_sphere(&self) -> Sphere {
        self.bounding_sphere
    }

    fn sphere_of_spheres(&self) -> Sphere {
        let spheres = (0..self.objects.len() as u32).map(|object| self.sphere(object));
        let spheres: Vec<_> = spheres.collect();
        let mut corners = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for sphere in &spheres {
            corners[0] = corners[0].min(sphere.center - sphere.radius);
            corners[1] = corners[1].max(sphere.center + sphere.radius);
        }
        let center = (corners[0] + corners[1]) / 2.0;
        let far = spheres.iter().map(|sphere| (sphere.center - center).length() + sphere.radius);
        let radius = far.fold(0.0, |most, far| if far > most { far } else { most });
        Sphere { center, radius }
    }

    fn median_of_medians(&self) -> f32 {
        let of = |(object, place): (&Object, &Similarity)| {
            let (count, median) = self.extents[object.geometry].at_rest;
            // The median of scaled radii is the scaled median, because rounding keeps their order.
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
