//! Which surfels share a depth-image: groups from a file, or groups that [`crate::index::grouping`]
//! makes.

use crate::error::{Error, Result};

/// The most groups that a scene may need; a GPU at the time of the paper had 16 texture units.
pub const MAX_GROUPS: usize = 64;

/// Checks that there may be this many groups.
///
/// # Errors
/// [`Error::Invalid`] if not.
pub fn check_count(groups: usize) -> Result<()> {
    if (1..=MAX_GROUPS).contains(&groups) {
        Ok(())
    } else {
        Err(Error::Invalid(format!("{groups} groups; give 1 to {MAX_GROUPS}")))
    }
}

/// The groups of a scene's surfels.
///
/// Every surfel has one group of its own; an extension may have added the surfel to other groups.
#[derive(Clone, Debug, PartialEq)]
pub struct Groups {
    /// The group of each surfel, below `scale.len()`.
    own: Vec<u8>,
    /// Surfels that were added to further groups: (surfel, group), ascending, without doubles.
    added: Vec<(u32, u8)>,
    /// The factor on the radii of each group's surfels: 1 unless enlarged.
    scale: Vec<f32>,
}

impl Groups {
    /// How many groups there are: 1 to [`MAX_GROUPS`].
    #[must_use]
    #[expect(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.scale.len()
    }

    /// The group of each surfel, in the order of the surfels.
    #[must_use]
    pub fn own(&self) -> &[u8] {
        &self.own
    }

    /// Surfels that are in further groups too: (surfel, group), ascending, without doubles.
    #[must_use]
    pub fn added(&self) -> &[(u32, u8)] {
        &self.added
    }

    /// The factor on the radii of each group's surfels.
    #[must_use]
    pub fn scale(&self) -> &[f32] {
        &self.scale
    }
}

impl Groups {
    /// Takes groups that were made elsewhere: the group of each surfel, further ones as (surfel,
    /// group) in any order, and the scale of each group.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are not 1 to [`MAX_GROUPS`] scales, if one is not finite and >
    /// 0, or if a surfel or a group does not exist.
    pub fn new(own: Vec<u8>, added: Vec<(u32, u8)>, scale: Vec<f32>) -> Result<Self> {
        let groups = scale.len();
        check_count(groups)?;
        if let Some(wrong) = scale.iter().find(|scale| !(**scale > 0.0 && scale.is_finite())) {
            return Err(Error::Invalid(format!("groups: a scale of {wrong}; give a number > 0")));
        }
        let all = own.iter().enumerate().map(|(surfel, &group)| (surfel as u64, group));
        let further = added.iter().map(|&(surfel, group)| (u64::from(surfel), group));
        let exists = |(surfel, group): &(u64, u8)| {
            *surfel < own.len() as u64 && usize::from(*group) < groups
        };
        if let Some((surfel, group)) = all.chain(further).find(|member| !exists(member)) {
            return Err(Error::Invalid(format!(
                "surfel {surfel} is in group {group}, but there are {} surfels and {groups} groups",
                own.len()
            )));
        }
        let mut added = added;
        added.retain(|&(surfel, group)| own[surfel as usize] != group);
        added.sort_unstable();
        added.dedup();
        Ok(Self { own, added, scale })
    }

    /// Keeps the groups of the marked surfels, in order; a group may become empty.
    pub(crate) fn retain(self, keep: &[bool]) -> Self {
        if keep.iter().all(|&keep| keep) {
            return self;
        }
        let mut kept = 0;
        let index: Vec<Option<u32>> = keep
            .iter()
            .map(|&keep| {
                kept += u32::from(keep);
                keep.then(|| kept - 1)
            })
            .collect();
        let own = self.own.iter().zip(keep).filter(|pair| *pair.1).map(|pair| *pair.0);
        let added = self.added.iter().filter_map(|&(i, group)| Some((index[i as usize]?, group)));
        Self { own: own.collect(), added: added.collect(), scale: self.scale }
    }

    /// The groups of some surfels, in the order of the indices; a group may become empty.
    pub(crate) fn some(&self, indices: &[u32]) -> Self {
        let own = indices.iter().map(|&i| self.own[i as usize]).collect();
        let added = (0..)
            .zip(indices)
            .flat_map(|(new, &old)| self.of_surfel(old).skip(1).map(move |group| (new, group)));
        Self { own, added: added.collect(), scale: self.scale.clone() }
    }

    /// The groups that contain a surfel: its own group, then the groups that it was added to.
    pub fn of_surfel(&self, surfel: u32) -> impl Iterator<Item = u8> + '_ {
        let first = self.added.partition_point(|&(added, _)| added < surfel);
        let added = self.added[first..].iter().take_while(move |(added, _)| *added == surfel);
        std::iter::once(self.own[surfel as usize]).chain(added.map(|&(_, group)| group))
    }
}
