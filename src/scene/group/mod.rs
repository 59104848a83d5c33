//! Minimal independent groups: surfels that do not overlap share one depth-image \[ZP06, section 4\].

mod add;
mod clipped;
mod color;
mod enlarge;
mod extend;
mod graph;
#[cfg(test)]
mod tests;
mod tree;

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::scene::Surfels;
use tree::Tree;

pub use enlarge::{MAX_SCALE, MAX_STEPS, SMALL_STEP};
pub use extend::{Coverage, Extended, Extension, extend};

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
    /// Of the colour of every place of a tree.
    fn of_colors(tree: &Tree, color: &[u32], groups: usize) -> Self {
        let mut own = vec![0; color.len()];
        for (&surfel, &color) in tree.surfel.iter().zip(color) {
            own[surfel as usize] = color as u8;
        }
        Self { own, added: Vec::new(), scale: vec![1.0; groups] }
    }

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

/// What [`group`] found: a row of Table 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Surfels of the scene.
    pub surfels: u64,
    /// c.
    pub overlap: f32,
    /// K.
    pub groups: usize,
    /// Edges of the graph.
    pub edges: u64,
    /// The most edges at one surfel.
    pub max_degree: u32,
    /// Edges at a surfel, on the average.
    pub average_degree: f64,
}

/// Divides surfels into groups by the rules, see the module.
///
/// # Errors
/// [`Error::Invalid`] as [`Rules::check`]; if there would be more than [`MAX_GROUPS`]; if more than
/// 64 pairs a surfel, and a million, overlap.
pub fn group(
    surfels: &Surfels,
    rules: &Rules,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Groups, Report)> {
    rules.check()?;
    progress("sorting surfels", 0, 1);
    let tree = Tree::new(surfels, 0..surfels.len() as u32);
    let (color, report) = color(surfels, &tree, rules, rules.overlap, exec, progress)?;
    if report.groups > MAX_GROUPS {
        return Err(Error::Invalid(format!(
            "c = {} needs {} groups, and at most {MAX_GROUPS} can be: give a lower c or smaller radii",
            rules.overlap, report.groups
        )));
    }
    Ok((Groups::of_colors(&tree, &color, report.groups), report))
}

/// Whether there can be so many groups.
///
/// # Errors
/// [`Error::Invalid`] if there cannot.
pub fn check_count(groups: usize) -> Result<()> {
    if (1..=MAX_GROUPS).contains(&groups) {
        Ok(())
    } else {
        Err(Error::Invalid(format!("{groups} groups; give 1 to {MAX_GROUPS}")))
    }
}

/// As [`group`], with the c of [`fitting`] that gives at most `count` groups.
///
/// # Errors
/// [`Error::Invalid`] as [`Rules::check`], and if `count` is not in 1 to [`MAX_GROUPS`].
pub fn group_into(
    surfels: &Surfels,
    rules: &Rules,
    count: usize,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Groups, Report)> {
    rules.check()?;
    check_count(count)?;
    progress("sorting surfels", 0, 1);
    let tree = Tree::new(surfels, 0..surfels.len() as u32);
    let colored = |c: f32| color(surfels, &tree, rules, c, exec, progress);
    // c = 0 has no edges, and so fits; what is above the c of the rules does not.
    let mut best = colored(0.0)?;
    let (mut fits, mut fails) = (0, (64.0 * rules.overlap) as u16 + 1);
    while fails - fits > 1 {
        let middle = u16::midpoint(fits, fails);
        match colored(f32::from(middle) / 64.0) {
            Ok(found) if found.1.groups <= count => (fits, best) = (middle, found),
            _ => fails = middle,
        }
    }
    let (color, report) = best;
    Ok((Groups::of_colors(&tree, &color, report.groups), report))
}

/// The colour of every place, by the rules with another c.
fn color(
    surfels: &Surfels,
    tree: &Tree,
    rules: &Rules,
    overlap: f32,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Vec<u32>, Report)> {
    let graph = graph::conflicts(surfels, tree, rules, overlap, exec, progress)?;
    progress("colouring", 0, 1);
    let color = color::largest_first(&graph, &tree.surfel);
    let n = surfels.len();
    let report = Report {
        surfels: n as u64,
        overlap,
        groups: color.iter().fold(0, |most, &color| most.max(color)) as usize + 1,
        edges: graph.edges(),
        max_degree: (0..n).map(|place| graph.degree(place)).fold(0, u32::max),
        average_degree: 2.0 * graph.edges() as f64 / n as f64,
    };
    Ok((color, report))
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
