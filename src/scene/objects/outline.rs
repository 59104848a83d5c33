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
use crate::frame::Exec;
use crate::scene::bounds::Bounds;
use crate::scene::{Boxes, Primitives, Surfels};
use glam::Vec3;
use std::ops::Range;
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

/// The part of a geometry that has to be read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Missing {
    /// Its surfels after those in memory; empty if enough are there.
    pub surfels: Range<u32>,
    /// Whether its primitives are missing.
    pub primitives: bool,
}

/// A geometry to read: its index, what is missing, and its surfels in memory.
pub type Job = (usize, Missing, Surfels);

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
    /// earlier view read as much. Of a geometry whose surfels in memory are too few, those after them,
    /// up to half as many again as are drawn, so that a camera that comes closer does not read it in
    /// every frame.
    #[must_use]
    pub fn missing(&self) -> Vec<Missing> {
        self.missing_of(&self.needed())
    }

    fn missing_of(&self, needed: &[Needed]) -> Vec<Missing> {
        let missing = |(index, &needed): (usize, &Needed)| {
            let (geometry, count) = (&self.geometries[index], self.extents[index].count);
            let held = geometry.surfels.len() as u32;
            let end = match held {
                _ if held >= needed.surfels => held,
                0 => needed.surfels,
                _ => count.min(needed.surfels.saturating_add(needed.surfels / 2)),
            };
            let primitives = needed.primitives && geometry.primitives.is_empty();
            Missing { surfels: held..end, primitives }
        };
        needed.iter().enumerate().map(missing).collect()
    }

    /// Loads what the view draws of each geometry. `read` gets a job for each geometry of which
    /// something [is missing](Objects::missing), and returns all its surfels and the missing primitives,
    /// in the order of the jobs. The rest is kept from an earlier view. Frees what is not drawn; of an
    /// order, what is more than twice as much as is drawn.
    ///
    /// # Errors
    /// The errors of `read`.
    pub fn with_needed(
        mut self,
        exec: &Exec,
        read: impl FnOnce(Vec<Job>) -> Result<Vec<(Surfels, Primitives)>>,
    ) -> Result<Self> {
        let needed = self.needed();
        let missing = self.missing_of(&needed);
        let (mut geometries, mut extents) = (self.taken(), self.extents.to_vec());
        // Frees first, so that memory never holds two views.
        for (index, needed) in needed.into_iter().enumerate() {
            let Geometry { surfels, primitives, .. } = &mut geometries[index];
            if surfels.len() as u64 > 2 * u64::from(needed.surfels) {
                let all = std::mem::replace(surfels, Surfels::none()).into_cloud();
                let first: Vec<u32> = (0..needed.surfels).collect();
                (*surfels, _) = Surfels::new_or_none(all.some(&first), exec)?;
                extents[index].boxes = Boxes::new(surfels);
            }
            if !needed.primitives {
                *primitives = Primitives::default();
            }
        }
        let jobs = missing.iter().cloned().enumerate();
        let jobs = jobs.filter(|(_, one)| !one.surfels.is_empty() || one.primitives);
        let take =
            |geometry: &mut Geometry| std::mem::replace(&mut geometry.surfels, Surfels::none());
        let jobs: Vec<Job> =
            jobs.map(|(index, missing)| (index, missing, take(&mut geometries[index]))).collect();
        let indices: Vec<usize> = jobs.iter().map(|job| job.0).collect();
        for (index, (surfels, primitives)) in indices.into_iter().zip(read(jobs)?) {
            let geometry = &mut geometries[index];
            if !missing[index].surfels.is_empty() {
                extents[index].boxes = Boxes::new(&surfels);
            }
            geometry.surfels = surfels;
            if missing[index].primitives {
                geometry.primitives = primitives;
            }
        }
        Ok(Self { geometries: geometries.into(), extents: extents.into(), ..self })
    }

    /// Takes the geometries out, without a copy if nobody else holds them.
    pub(super) fn taken(&mut self) -> Vec<Geometry> {
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
