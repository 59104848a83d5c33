//! Extend groups so that each covers the surface \[ZP06, section 4.2.2\].

use super::clipped::{area, by_lower};
use super::coverage::{Extended, GroupCoverage};
use super::disc_tree::DiscTree;
use super::graph::Graph;
use super::overlaps::Overlaps;
use super::scales::Scales;
use super::{add, enlarge};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::progress::Progress;
use crate::scene::{Groups, Surfels};
use crate::setting::{Field, Slot, Visit, Words};
use std::f64::consts::PI;

/// How groups are changed to cover more of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extension {
    /// Leave the groups as they are.
    None,
    /// Add surfels of other groups (the paper's extension 1).
    Add {
        /// The most of a surfel that may be covered already, as a part of its area. In [0, 1].
        most: f32,
    },
    /// Enlarge the radii (extension 2).
    Enlarge,
}

/// The default of how much of a surfel may be covered already if the surfel is added to a group.
const MOST: f32 = 0.5;

impl Words for Extension {
    const WORDS: &'static [(&'static str, Self)] =
        &[("none", Self::None), ("add", Self::Add { most: MOST }), ("enlarge", Self::Enlarge)];
}

impl Extension {
    /// The rows of the extension.
    pub(super) fn fields(&mut self, each: &mut Visit<'_>) {
        let extend = "make each group cover the surface by adding surfels of other groups, or by \
                      enlarging radii";
        each(Field::new("extend", extend, Slot::Word(self)));
        let help = "add a splat only if at most this fraction of its area is covered already";
        let row = |most| Field::new("most", help, Slot::Number(most)).range("0 to 1");
        match self {
            Self::Add { most } => each(row(most)),
            Self::None | Self::Enlarge => each(row(&mut { MOST }).idle("unless splats are added")),
        }
    }

    /// The factor by which surfels are near whose neighbourhood is kept.
    pub(super) fn reach(&self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Add { .. } | Self::Enlarge => 1.0,
        }
    }

    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if one is not.
    pub fn check(&self) -> Result<()> {
        match *self {
            Self::Add { most } if !(0.0..=1.0).contains(&most) => {
                Err(Error::Invalid(format!("most: {most}; give 0 to 1")))
            }
            Self::None | Self::Add { .. } | Self::Enlarge => Ok(()),
        }
    }
}

/// Extends groups, see the [module](super), and measures how much of the surface each group covers.
///
/// The changes of an earlier extension are undone first. `progress` receives the name of a step,
/// how much of it is done, and how much there is. The result depends only on the surfels, the
/// groups and the extension.
///
/// # Errors
/// [`Error::Invalid`] in any of these cases:
///
/// - As [`Extension::check`].
/// - The groups belong to another number of surfels.
/// - More than 64 pairs a surfel, and a million, overlap at c = 1, or, if radii are enlarged, in a
///   group; then pairs whose samples are all covered by others are not counted.
/// - The process may not hold the working memory.
pub fn extend(
    surfels: &Surfels,
    groups: &Groups,
    extension: &Extension,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<(Groups, Extended)> {
    extension.check()?;
    groups.check(surfels)?;
    let tree = DiscTree::of_all(surfels, extension.reach(), exec, progress)?;
    Work { surfels, tree: &tree, exec, progress }.extend(groups, extension, None)
}

/// The input of an extension.
pub(super) struct Work<'a> {
    pub(super) surfels: &'a Surfels,
    /// The tree of all surfels.
    pub(super) tree: &'a DiscTree,
    pub(super) exec: &'a Exec,
    pub(super) progress: Progress<'a>,
}

impl Work<'_> {
    /// Extends groups; `overlaps` is the graph of all overlaps, if it exists already.
    pub(super) fn extend(
        &self,
        groups: &Groups,
        extension: &Extension,
        overlaps: Option<Graph>,
    ) -> Result<(Groups, Extended)> {
        let &Self { tree, exec, progress, .. } = self;
        let (target, further, coverages) = match *extension {
            Extension::Add { most } => {
                let graph = match overlaps {
                    Some(graph) => graph,
                    None => Graph::new(tree, 1.0, |_, _| true, exec, progress)?,
                };
                let overlaps = Overlaps { tree, graph: &graph, exec };
                let found = add::add(&overlaps, groups, most, progress)?;
                (found.target, found.further, found.groups)
            }
            Extension::None | Extension::Enlarge => {
                let (target, coverages) =
                    self.measured(groups, *extension == Extension::Enlarge)?;
                (target, Vec::new(), coverages)
            }
        };
        let added = further.len() as u64;
        let scale = coverages.iter().map(|group| group.scale).collect();
        let extended = Groups::new(groups.own().to_vec(), further, scale)?;
        let percent = 100.0 * added as f64 / self.surfels.len() as f64;
        Ok((extended, Extended { area: PI * target, added, percent, groups: coverages }))
    }

    /// A divided by pi, and the coverage of each group, with radii enlarged or not.
    fn measured(&self, groups: &Groups, enlarge: bool) -> Result<(f64, Vec<GroupCoverage>)> {
        let show = |done, of| (self.progress)("measuring the surface", done, of);
        let (target, _) = area(self.tree, &by_lower(self.tree, 1.0, self.exec, &show)?);
        let mut coverages = Vec::new();
        for k in 0..groups.len() {
            (self.progress)("extending groups", k as u64, groups.len() as u64);
            let own = (0_u32..).zip(groups.own()).filter(|g| usize::from(*g.1) == k).map(|g| g.0);
            let tree = DiscTree::new(self.surfels, own, self.exec);
            let mut scales = Scales::new(&tree, self.exec);
            // The search at scale 1 is used again by the larger scales.
            let (area_at_1, sum_at_1) = if enlarge {
                scales.area(1.0)?
            } else {
                area(&tree, &by_lower(&tree, 1.0, self.exec, &|_, _| ())?)
            };
            let before = area_at_1 / target;
            let mut coverage = GroupCoverage {
                surfels: tree.surfel.len() as u64,
                scale: 1.0,
                converged: true,
                before,
                after: before,
            };
            if enlarge && tree.surfel.is_empty() {
                coverage.converged = false;
            } else if enlarge {
                let enlarged = enlarge::enlarged(&mut scales, area_at_1, sum_at_1, target)?;
                (coverage.scale, coverage.converged) = (enlarged.scale, enlarged.converged);
                let scale = f64::from(enlarged.scale);
                coverage.after = scale * scale * scales.area(scale)?.0 / target;
            }
            coverages.push(coverage);
        }
        (self.progress)("extending groups", groups.len() as u64, groups.len() as u64);
        Ok((target, coverages))
    }
}
