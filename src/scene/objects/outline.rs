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
use crate::scene::bounds::Bounds;
use crate::scene::{Boxes, Primitives, Surfels};
use glam::Vec3;
use std::sync::Arc;

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

    /// What has to be read of each geometry before memory holds all that the view draws: nothing, if an
    /// earlier view read as much, and at most twice as many surfels. Of a geometry whose surfels in memory
    /// are too few, up to half as many again as are drawn, so that a camera that comes closer does not
    /// read it in every frame.
    #[must_use]
    pub fn missing(&self) -> Vec<Needed> {
        self.missing_of(&self.needed())
    }

    fn missing_of(&self, needed: &[Needed]) -> Vec<Needed> {
        let missing = |(index, &needed): (usize, &Needed)| {
            let (geometry, count) = (&self.geometries[index], self.extents[index].count);
            let held = geometry.surfels.len() as u32;
            let surfels = match held {
                _ if keeps(held, needed) => 0,
                0 => needed.surfels,
                held if held > needed.surfels => needed.surfels,
                _ => count.min(needed.surfels.saturating_add(needed.surfels / 2)),
            };
            let primitives = needed.primitives && geometry.primitives.is_empty();
            Needed { surfels, primitives }
        };
        needed.iter().enumerate().map(missing).collect()
    }

    /// Loads what the view draws of each geometry: what [is missing](Objects::missing) comes from
    /// `read`, which gets the index of a geometry and what to read of it, and the rest is kept from an
    /// earlier view. Frees what is not drawn.
    ///
    /// # Errors
    /// The errors of `read`.
    pub fn with_needed(
        mut self,
        mut read: impl FnMut(usize, Needed) -> Result<(Surfels, Primitives)>,
    ) -> Result<Self> {
        let needed = self.needed();
        let missing = self.missing_of(&needed);
        let (mut geometries, mut extents) = (self.taken(), self.extents.to_vec());
        // Frees first, so that memory never holds two views.
        for (index, needed) in needed.into_iter().enumerate() {
            let geometry = &mut geometries[index];
            if !keeps(geometry.surfels.len() as u32, needed) {
                geometry.surfels = Surfels::none();
                extents[index].boxes = Boxes::new(&geometry.surfels);
            }
            if !needed.primitives {
                geometry.primitives = Primitives::default();
            }
        }
        for (missing, index) in missing.into_iter().zip(0..) {
            if missing == Needed::default() {
                continue;
            }
            let (surfels, primitives) = read(index, missing)?;
            let geometry = &mut geometries[index];
            if missing.surfels > 0 {
                extents[index].boxes = Boxes::new(&surfels);
                geometry.surfels = surfels;
            }
            if missing.primitives {
                geometry.primitives = primitives;
            }
        }
        Ok(Self { geometries: geometries.into(), extents: extents.into(), ..self })
    }

    /// Takes the geometries out, without a copy if nobody else holds them.
    fn taken(&mut self) -> Vec<Geometry> {
        let mut all = std::mem::replace(&mut self.geometries, Arc::new([]));
        let Some(all) = Arc::get_mut(&mut all) else { return all.to_vec() };
        let taken = |geometry: &mut Geometry| Geometry {
            name: std::mem::take(&mut geometry.name),
            surfels: std::mem::replace(&mut geometry.surfels, Surfels::none()),
            primitives: std::mem::take(&mut geometry.primitives),
            detail: geometry.detail.take(),
        };
        all.iter_mut().map(taken).collect()
    }
}

/// Whether a view keeps the surfels of a geometry that are in memory: all that it draws are there, and
/// not too many more.
fn keeps(held: u32, needed: Needed) -> bool {
    (needed.surfels..=needed.surfels.saturating_mul(2)).contains(&held)
}
