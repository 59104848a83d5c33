//! Minimal independent groups: surfels that do not overlap share one depth-image \[ZP06, section 4\].

use crate::error::{Error, Result};

/// The most groups that a scene may need; a GPU of the paper's time had 16 texture units.
pub const MAX_GROUPS: usize = 64;

/// Which surfels may not share a group \[ZP06, section 4.1\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// c: surfels conflict if |p_i - p_j| < c (r_i + r_j). In [0, 1].
    pub overlap: f32,
    /// Whether surfels with n_i . n_j < 0 never conflict (the paper's modification 2).
    pub opposite: bool,
    /// Which surfels are virtually co-planar and so never conflict (modification 1); none: all may.
    pub coplanar: Option<Coplanar>,
}

/// When two surfels are virtually co-planar and of one colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coplanar {
    /// The least n_i . n_j. In [0, 1].
    pub cosine: f32,
    /// The most that either centre is off the other's plane, as a part of r_i + r_j. In [0, 1].
    pub offset: f32,
    /// The most that any component of the colours differs. In [0, inf].
    pub color: f32,
}

impl Default for Rules {
    /// c = 1, nothing relaxed: groups do not overlap.
    fn default() -> Self {
        Self { overlap: 1.0, opposite: false, coplanar: None }
    }
}

impl Rules {
    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if one is not.
    pub fn check(&self) -> Result<()> {
        let unit = 0.0..=1.0;
        if !unit.contains(&self.overlap) {
            let what = format!("overlap: c = {}; give 0 to 1", self.overlap);
            return Err(Error::Invalid(what));
        }
        let Some(Coplanar { cosine, offset, color }) = self.coplanar else { return Ok(()) };
        if unit.contains(&cosine) && unit.contains(&offset) && color >= 0.0 {
            Ok(())
        } else {
            let what = format!(
                "coplanar: cosine {cosine}, offset {offset}, color {color}; give 0 to 1, 0 to 1, >= 0"
            );
            Err(Error::Invalid(what))
        }
    }
}

/// The groups of a scene's surfels.
///
/// Every surfel is in one group of its own; an extension may have added it to others.
#[derive(Clone, Debug, PartialEq)]
pub struct Groups {
    /// The group of each surfel, below `scale.len()`.
    own: Vec<u8>,
    /// Surfels that were added to further groups: (surfel, group), ascending, without doubles.
    added: Vec<(u32, u8)>,
    /// For each group, what the radii of its surfels are multiplied by: 1 unless enlarged.
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

    /// For each group, what the radii of its surfels are multiplied by.
    #[must_use]
    pub fn scale(&self) -> &[f32] {
        &self.scale
    }
}

impl Groups {
    /// Groups that somebody else has made: the group of each surfel, further ones as (surfel, group)
    /// in any order, and the scale of each group.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there are not 1 to [`MAX_GROUPS`] scales, if one is not finite and > 0,
    /// or if a surfel or a group does not exist.
    pub fn new(own: Vec<u8>, added: Vec<(u32, u8)>, scale: Vec<f32>) -> Result<Self> {
        let groups = scale.len();
        if !(1..=MAX_GROUPS).contains(&groups) {
            return Err(Error::Invalid(format!("{groups} groups; give 1 to {MAX_GROUPS}")));
        }
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
                "surfel {surfel} in group {group}: there are {} surfels and {groups} groups",
                own.len()
            )));
        }
        let mut added = added;
        added.retain(|&(surfel, group)| own[surfel as usize] != group);
        added.sort_unstable();
        added.dedup();
        Ok(Self { own, added, scale })
    }

    /// The groups that a surfel is in: its own, then those it was added to.
    pub fn of(&self, surfel: u32) -> impl Iterator<Item = u8> + '_ {
        let first = self.added.partition_point(|&(added, _)| added < surfel);
        let added = self.added[first..].iter().take_while(move |(added, _)| *added == surfel);
        std::iter::once(self.own[surfel as usize]).chain(added.map(|&(_, group)| group))
    }
}
