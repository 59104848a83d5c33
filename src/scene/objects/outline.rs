//! Read only the geometries that a view needs.
//!
//! What a view draws of an object with a [prefix](super::detail::prefix), and of its finer objects,
//! depends on a few numbers of each geometry, its [`Outline`]: how many surfels there are, how
//! densely they cover, and what bounds them. So you can make objects from outlines, let a camera
//! [see](Objects::seen_from) them, and then read only what is drawn. The resulting objects draw the
//! same as objects with all surfels and primitives, bit for bit.

use super::detail::prefix::{Estimate, Prefix};
use super::place::Extent;
use super::{Detail, Geometry, Object, Objects};
use crate::error::Result;
use crate::scene::{Boxes, Primitives, Surfels, bounds};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// The box and the sphere around surfels and primitives together, by the rules of
/// [`crate::scene::Scene::bounds`] and [`crate::scene::Scene::bounding_sphere`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// The corner of the box with the least coordinates.
    pub low: Vec3,
    /// The other corner.
    pub high: Vec3,
    /// The radius of the sphere around the middle of the box, (low + high) / 2 in f64.
    pub radius: f64,
}

impl Bounds {
    /// The bounds of surfels and primitives.
    #[must_use]
    pub fn of(surfels: &Surfels, primitives: &Primitives) -> Self {
        let (low, high) = bounds::corners(surfels, primitives);
        // Adding 0 turns -0 into 0.
        let (low, high) = (low + Vec3::ZERO, high + Vec3::ZERO);
        Self { low, high, radius: bounds::sphere(surfels, primitives).1 }
    }

    /// The box, and the sphere around it.
    pub(super) fn corners_and_sphere(&self) -> ([DVec3; 2], (DVec3, f64)) {
        let corners = [self.low.as_dvec3(), self.high.as_dvec3()];
        (corners, ((corners[0] + corners[1]) / 2.0, self.radius))
    }
}

/// What views need to know of a geometry that has not been read. Its surfels are in an order, all
/// have one radius and a colour, and none has half axes or prefiltered colours. It may have
/// primitives.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// The geometry's name.
    pub name: String,
    /// How many surfels there are, and how densely they cover; none without surfels.
    pub surfels: Option<(u32, Estimate)>,
    /// The radius of every surfel.
    pub radius: f32,
    /// Whether the surfels have opacities.
    pub opacity: bool,
    /// Whether the primitives have colours; none if there are no primitives.
    pub primitives: Option<bool>,
    /// The bounds of everything.
    pub bounds: Bounds,
}

/// The part of a geometry that is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needed {
    /// How many of its first surfels are drawn.
    pub surfels: u32,
    /// Whether its primitives are drawn.
    pub primitives: bool,
}

impl Extent {
    fn outlined(outline: &Outline) -> Self {
        let count = outline.surfels.map_or(0, |(count, _)| count);
        let some = count > 0;
        Self {
            boxes: Boxes::new(&Surfels::none()),
            sphere: outline.bounds.corners_and_sphere().1,
            least: if some { f64::from(outline.radius) } else { f64::INFINITY },
            count,
            at_rest: (count, if some { outline.radius } else { 0.0 }),
            has: [some, some && outline.opacity, false],
            primitives: outline.primitives.is_some(),
            colored: outline.primitives == Some(true),
        }
    }
}

impl Objects {
    /// Makes objects whose geometries have not been read. `source` is a hash that identifies what
    /// they are read from: two scenes with the same hash are the same.
    ///
    /// # Errors
    /// As [`Objects::new`].
    pub fn outlined(
        outlines: &[Outline],
        objects: Vec<Object>,
        fill: Vec3,
        source: [u8; 32],
    ) -> Result<Self> {
        let geometry = |outline: &Outline| Geometry {
            name: outline.name.clone(),
            surfels: Surfels::none(),
            primitives: Primitives::default(),
            detail: outline.surfels.map(|(count, estimate)| {
                Detail::Prefix(Prefix::outlined(count, estimate, &outline.bounds))
            }),
        };
        let extents = outlines.iter().map(Extent::outlined).collect();
        let geometries = outlines.iter().map(geometry).collect();
        let all = Self::assembled(geometries, extents, objects, fill)?;
        Ok(all.with_source(source))
    }

    /// The same objects, identified by what they are read from.
    #[must_use]
    pub(crate) fn with_source(self, source: [u8; 32]) -> Self {
        Self { source: Some(source), ..self }
    }

    /// The hash of the source that geometries are read from, as views need them; none if the
    /// objects are identified by their contents in memory.
    #[must_use]
    pub fn source(&self) -> Option<&[u8; 32]> {
        self.source.as_ref()
    }

    /// What the view draws of each geometry: the most that any of its objects draws.
    #[must_use]
    pub fn needed(&self) -> Vec<Needed> {
        let mut all = vec![Needed::default(); self.geometries.len()];
        for (number, object) in (0..).zip(self.objects.iter()) {
            let needed = &mut all[object.geometry];
            needed.surfels = needed.surfels.max(self.ids.count(number));
            let has = self.extents[object.geometry].primitives;
            needed.primitives |= has && self.shown[number as usize].primitives;
        }
        all
    }

    /// Loads what the view draws of each geometry, and nothing else. `read` gets the index of a
    /// geometry and returns the needed part of it.
    ///
    /// # Errors
    /// The errors of `read`.
    pub fn with_needed(
        mut self,
        mut read: impl FnMut(usize, Needed) -> Result<(Surfels, Primitives)>,
    ) -> Result<Self> {
        let needed = self.needed();
        let known = |geometry: &Geometry| (geometry.name.clone(), geometry.detail.clone());
        let known: Vec<_> = self.geometries.iter().map(known).collect();
        // Frees what another view needed.
        self.geometries = Arc::new([]);
        let (mut geometries, mut extents) = (Vec::new(), Vec::new());
        for (index, (needed, (name, detail))) in needed.into_iter().zip(known).enumerate() {
            let nothing = needed == Needed::default();
            let (surfels, primitives) = match nothing {
                true => (Surfels::none(), Primitives::default()),
                false => read(index, needed)?,
            };
            extents.push(Extent { boxes: Boxes::new(&surfels), ..self.extents[index].clone() });
            geometries.push(Geometry { name, surfels, primitives, detail });
        }
        Ok(Self { geometries: geometries.into(), extents: extents.into(), ..self })
    }
}
