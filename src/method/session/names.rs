//! Translate between the ids of surfels in objects and their indices among the drawn surfels.

use crate::error::{Error, Result};
use crate::frame::{Frame, NO_ID, Plane, Samples};
use crate::method::record::wide_id;
use crate::method::stage::{Holds, Stage};
use crate::scene::Excerpt;
use crate::scene::objects::{Ids, Objects};

/// The ids of the drawn surfels, ascending. A surfel's index is its place in this order. Methods
/// that draw surfels one by one, and every verdict, use these indices.
pub(crate) enum Names<'a> {
    /// Every surfel of the objects is drawn.
    All(&'a Ids),
    /// Of objects with levels of detail, these ids are drawn.
    Drawn(&'a Ids, Vec<u64>),
    /// Surfels of a larger scene, whose ids are their indices there.
    Excerpt(&'a Excerpt),
}

impl<'a> Names<'a> {
    pub(super) fn new(objects: &'a Objects) -> Self {
        let ids = objects.ids();
        match objects.have_detail() {
            true => Self::Drawn(ids, objects.drawn_ids()),
            false => Self::All(ids),
        }
    }

    /// Whether ids have 40 bits.
    fn is_wide(&self) -> bool {
        match self {
            Self::All(ids) | Self::Drawn(ids, _) => ids.is_wide(),
            Self::Excerpt(_) => false,
        }
    }

    /// The lowest 32 bits of the id of the surfel with this index.
    pub(super) fn id(&self, index: u32) -> Option<u32> {
        match self {
            Self::All(ids) => ids.nth(index.into()).map(|id| id as u32),
            Self::Drawn(_, drawn) => drawn.get(index as usize).map(|id| *id as u32),
            Self::Excerpt(excerpt) => excerpt.ids().get(index as usize).copied(),
        }
    }

    /// The number of drawn surfels with lower ids.
    fn index(&self, id: u64) -> Option<u32> {
        match self {
            Self::All(ids) => ids.rank(id).map(|rank| rank as u32),
            Self::Drawn(_, drawn) => drawn.binary_search(&id).ok().map(|index| index as u32),
            Self::Excerpt(excerpt) => excerpt.index(id),
        }
    }

    /// The id by which a verdict calls the surfel with this index, if 32 bits hold the whole id.
    pub(super) fn told(&self, index: u32) -> Option<u32> {
        if self.is_wide() { None } else { self.id(index) }
    }

    /// Replaces indices by ids.
    pub(super) fn name<R>(&self, frame: &mut Frame<R>) {
        each_id(frame, |index| self.id(index).unwrap_or(index));
    }

    /// Replaces ids by indices. An id that no surfel has becomes an index that no surfel has.
    pub(super) fn number<R>(&self, frame: &mut Frame<R>) -> Result<()> {
        if self.is_wide() {
            let what = "ids have 40 bits, but planes of ids hold 32 of them, which do not identify \
                        the surfel";
            return Err(Error::Invalid(what.into()));
        }
        each_id(frame, |id| self.index(id.into()).unwrap_or(NO_ID - 1));
        Ok(())
    }

    /// Replaces ids by indices in a client's planes. Planes of ids of 40 bits without the planes of
    /// their highest 8 bits are left out, because 32 bits do not identify the surfel.
    pub(crate) fn number_given<R>(&self, frame: &mut Frame<R>, stages: &[Stage]) -> Result<()> {
        if !self.is_wide() {
            return self.number(frame);
        }
        let high: Vec<(String, Plane<u8>)> = frame
            .planes
            .iter()
            .filter_map(|plane| match &plane.samples {
                Samples::Count(values) => Some((plane.name.clone(), values.clone())),
                _ => None,
            })
            .collect();
        frame.planes.retain_mut(|plane| {
            let Samples::Index(ids) = &mut plane.samples else { return true };
            let stage = stages.iter().find(|stage| stage.row(&plane.name).is_some());
            let rows = stage.map_or(&[][..], |stage| stage.leaves);
            let Some(row) = rows.iter().find(|row| row.holds == Holds::HighIndex) else {
                return true;
            };
            let Some((_, high)) = high.iter().find(|(name, _)| row.is_called(name)) else {
                return false;
            };
            let some = ids.values_mut().iter_mut().zip(high.values());
            some.filter(|(id, _)| **id != NO_ID).for_each(|(id, &high)| {
                *id = self.index(wide_id(*id, high)).unwrap_or(NO_ID - 1);
            });
            true
        });
        Ok(())
    }
}

/// Changes every id of a frame, except the id of nothing.
fn each_id<R>(frame: &mut Frame<R>, of: impl Fn(u32) -> u32) {
    for plane in &mut frame.planes {
        if let Samples::Index(ids) = &mut plane.samples {
            let some = ids.values_mut().iter_mut().filter(|id| **id != NO_ID);
            some.for_each(|id| *id = of(*id));
        }
    }
}
