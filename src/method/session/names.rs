//! Surfels of objects by their ids, and by their order among those that are drawn.

use crate::error::{Error, Result};
use crate::frame::{Frame, NO_ID, Plane, Samples};
use crate::method::record::wide_id;
use crate::method::stage::{Holds, Stage};
use crate::scene::objects::{Ids, Objects};

/// The ids of the surfels that are drawn, ascending: by these a method that draws surfels one by one, and
/// every verdict, counts them.
pub(crate) struct Names<'a> {
    ids: &'a Ids,
    /// Of objects with levels of detail; else all ids are drawn.
    drawn: Option<Vec<u64>>,
}

impl<'a> Names<'a> {
    pub(super) fn new(objects: &'a Objects) -> Self {
        let drawn = objects.have_detail().then(|| objects.drawn_ids());
        Self { ids: objects.ids(), drawn }
    }

    /// The lowest 32 bits of the id of a surfel that has been counted.
    pub(super) fn id(&self, index: u32) -> Option<u32> {
        let id = match &self.drawn {
            Some(drawn) => drawn.get(index as usize).copied(),
            None => self.ids.nth(index.into()),
        };
        id.map(|id| id as u32)
    }

    /// How many surfels are drawn whose ids are less.
    fn index(&self, id: u64) -> Option<u32> {
        match &self.drawn {
            Some(drawn) => drawn.binary_search(&id).ok().map(|index| index as u32),
            None => self.ids.rank(id).map(|rank| rank as u32),
        }
    }

    /// What a verdict calls a surfel that has been counted: by its id, if 32 bits say all of it.
    pub(super) fn told(&self, index: u32) -> Option<u32> {
        if self.ids.is_wide() { None } else { self.id(index) }
    }

    /// Puts ids in the place of indices.
    pub(super) fn name<R>(&self, frame: &mut Frame<R>) {
        each_id(frame, |index| self.id(index).unwrap_or(index));
    }

    /// Puts indices in the place of ids. What is the id of none is the index of none.
    pub(super) fn number<R>(&self, frame: &mut Frame<R>) -> Result<()> {
        if self.ids.is_wide() {
            let what = "ids have 40 bits, but planes of ids hold 32 of them, which do not identify \
                        the surfel";
            return Err(Error::Invalid(what.into()));
        }
        each_id(frame, |id| self.index(id.into()).unwrap_or(NO_ID - 1));
        Ok(())
    }

    /// The same of what somebody hands in. Planes of ids of 40 bits that come without their highest 8 do not
    /// say the surfel, and are left out.
    pub(crate) fn number_given<R>(&self, frame: &mut Frame<R>, stages: &[Stage]) -> Result<()> {
        if !self.ids.is_wide() {
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

/// Changes every id of a frame that is that of something.
fn each_id<R>(frame: &mut Frame<R>, of: impl Fn(u32) -> u32) {
    for plane in &mut frame.planes {
        if let Samples::Index(ids) = &mut plane.samples {
            let some = ids.values_mut().iter_mut().filter(|id| **id != NO_ID);
            some.for_each(|id| *id = of(*id));
        }
    }
}
