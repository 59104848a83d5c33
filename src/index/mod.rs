//! Build structures of a scene once, and query them for every view.
//!
//! - [`grouping`]: groups of surfels that do not overlap, so that a group shares one depth-image.
//! - [`members`]: surfels in the order of a tree, each with all its groups.
//! - [`mipmap`]: prefiltered colours of surfels.
//! - [`order`]: surfels from back to front.
//! - [`seen`]: which surfels the previous frame saw.
//! - [`sequential`]: levels of detail as a list.

pub mod grouping;
pub mod members;
pub mod mipmap;
pub mod order;
pub(crate) mod point_tree;
pub mod seen;
pub mod sequential;

use crate::error::{Error, Result};
use crate::scene::{Boxes, Camera, Groups, Surfels};
use members::Members;
use order::BackToFront;
use seen::Seen;

/// One splat of a view: a surfel, in one of its groups.
///
/// A view selects a plain list of items, and draws them in the order of the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// The surfel.
    pub surfel: u32,
    /// One of the groups that the surfel is in.
    pub group: u8,
}

/// What a method queries for every view, as far as the method needs it.
#[derive(Debug, Default)]
pub struct Index {
    /// Which surfels share a depth-image.
    pub groups: Option<Groups>,
    /// The surfels from back to front.
    pub order: Option<BackToFront>,
    /// Boxes around the surfels of a scene without objects.
    pub boxes: Option<Boxes>,
    /// What the previous frame saw; none before the first frame.
    pub seen: Option<Seen>,
    /// The surfels in the order of the tree behind `order`, if there are groups too.
    pub members: Option<Members>,
}

impl Index {
    /// The groups.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are none.
    pub fn groups(&self) -> Result<&Groups> {
        self.groups.as_ref().ok_or_else(|| missing("groups"))
    }

    /// The order from back to front.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is none.
    pub fn order(&self) -> Result<&BackToFront> {
        self.order.as_ref().ok_or_else(|| missing("an order from back to front"))
    }

    /// The surfels in the order of the tree, with their groups.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are none.
    pub(crate) fn members(&self) -> Result<&Members> {
        self.members.as_ref().ok_or_else(|| missing("groups in an order from back to front"))
    }

    /// Every surfel in each of its groups, from back to front: the list that blending draws.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are no groups or no order.
    pub fn back_to_front(&self, camera: &Camera) -> Result<Vec<Item>> {
        let (groups, order) = (self.groups()?, self.order()?);
        let (own, added) = (groups.own(), groups.added());
        // Where the further groups of each surfel end. Searching for them one by one would take
        // longer than the order.
        let mut ends = vec![0_u32; own.len()];
        let mut end = 0;
        for (surfel, place) in (0_u32..).zip(&mut ends) {
            end += added[end..].iter().take_while(|(other, _)| *other == surfel).count();
            *place = end as u32;
        }
        let mut items = Vec::with_capacity(own.len() + added.len());
        for surfel in order.walk(camera) {
            let i = surfel as usize;
            let start = if i == 0 { 0 } else { ends[i - 1] };
            items.push(Item { surfel, group: own[i] });
            let further = &added[start as usize..ends[i] as usize];
            items.extend(further.iter().map(|&(_, group)| Item { surfel, group }));
        }
        Ok(items)
    }

    /// Checks that this can be an index of these surfels: the numbers of surfels must agree.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it cannot.
    pub fn check(&self, surfels: &Surfels) -> Result<()> {
        self.groups.as_ref().map_or(Ok(()), |groups| groups.check(surfels))?;
        self.order.as_ref().map_or(Ok(()), |order| order.check(surfels))
    }
}

fn missing(what: &str) -> Error {
    Error::Invalid(format!(
        "the scene was prepared for another method, without {what}; prepare it for this method"
    ))
}
