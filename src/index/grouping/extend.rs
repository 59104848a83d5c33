//! Groups that each cover the surface \[ZP06, section 4.2.2\].

use super::clipped::{area, by_lower};
use super::disc_tree::DiscTree;
use super::graph::Graph;
use super::{add, enlarge};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::scene::{Groups, Surfels};
use crate::setting::{Field, Slot, Visit, Words};
use std::f64::consts::PI;

/// How groups are changed so as to cover more of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extension {
    /// Not at all.
    None,
    /// Surfels of other groups are added (the paper's extension 1).
    Add {
        /// The most of a surfel that may be covered already, as a part of its area. In [0, 1].
        most: f32,
    },
    /// Radii are enlarged (extension 2).
    Enlarge,
}

/// What [`extend`] did.
#[derive(Clone, Debug, PartialEq)]
pub struct Extended {
    /// A: the area of the surface, in square world units.
    pub area: f64,
    /// How many surfels were added to groups, each counted once for each group.
    pub added: u64,
    /// What that is in per cent of the surfels.
    pub percent: f64,
    /// Each group.
    pub groups: Vec<GroupCoverage>,
}

/// What [`extend`] did to a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupCoverage {
    /// Surfels in the group, those added included.
    pub surfels: u64,
    /// What its radii are multiplied by.
    pub scale: f32,
    /// Whether the iteration of eq. 9 converged; true where there was none.
    pub converged: bool,
    /// The area that the group covers without the extension, eq. 7, as a part of A.
    pub before: f64,
    /// The same with the extension.
    pub after: f64,
}

/// How far a surfel may be covered that is added to a group, if nobody says.
const MOST: f32 = 0.5;

impl Words for Extension {
    const WORDS: &'static [(&'static str, Self)] =
        &[("none", Self::None), ("add", Self::Add { most: MOST }), ("enlarge", Self::Enlarge)];
}

impl Extension {
    /// The rows of the extension.
    pub(super) fn fields(&mut self, each: &mut Visit<'_>) {
        let extend = "how groups are made to cover the surface: surfels of others are added, or \
                      radii are enlarged";
        each(Field::new("extend", extend, Slot::Word(self)));
        let help = "the most of a splat that is covered already if the splat is added, as a part \
                    of its area";
        let row = |most| Field::new("most", help, Slot::Number(most)).range("0 to 1");
        match self {
            Self::Add { most } => each(row(most)),
            Self::None | Self::Enlarge => each(row(&mut { MOST }).idle("unless splats are added")),
        }
    }

    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if one is not.
    pub fn check(&self) -> Result<()> {
        match *self {
            Self::Add { most } if !(0.0..=1.0).contains(&most) => {
                Err(Error::Invalid(format!("add: a surfel covered to {most}; give 0 to 1")))
            }
            Self::None | Self::Add { .. } | Self::Enlarge => Ok(()),
        }
    }
}

/// Extends groups, see the [module](super), and measures how much of the surface each covers.
///
/// What an earlier extension did to the groups is undone first. `progress` is told the name of a
/// step, how much of it is done, and of how much. The result depends on the surfels, the groups and
/// the extension alone.
///
/// # Errors
/// [`Error::Invalid`] as [`Extension::check`]; if the groups are of another number of surfels; if
/// more than 64 pairs a surfel, and a million, overlap at c = 1, or do so in a group.
pub fn extend(
    surfels: &Surfels,
    groups: &Groups,
    extension: &Extension,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Groups, Extended)> {
    extension.check()?;
    groups.check(surfels)?;
    let (n, count) = (surfels.len(), groups.len());
    progress("sorting surfels", 0, 1);
    let tree = DiscTree::new(surfels, 0..n as u32);
    let show = |done, of| progress("measuring the surface", done, of);
    let (target, _) = area(&tree, &by_lower(&tree, 1.0, exec, &show)?);
    let graph = match extension {
        Extension::Add { .. } => Graph::new(&tree, 1.0, |_, _| true, exec, progress)?,
        Extension::None | Extension::Enlarge => Graph::default(),
    };
    let work = Work { surfels, groups, extension, tree, graph, target, exec };

    let (mut further, mut scale, mut coverages) = (Vec::new(), Vec::new(), Vec::new());
    // Groups in parallel, a few at a time so that it is seen how far it is.
    let all: Vec<u8> = (0..count as u8).collect();
    for batch in all.chunks(2 * exec.threads()) {
        progress("extending groups", batch[0].into(), count as u64);
        for (&k, found) in batch.iter().zip(exec.ordered(batch.to_vec(), |k| work.extend(k))) {
            let (added, coverage) = found?;
            further.extend(added.into_iter().map(|surfel| (surfel, k)));
            scale.push(coverage.scale);
            coverages.push(coverage);
        }
    }
    progress("extending groups", count as u64, count as u64);
    let added = further.len() as u64;
    let extended = Groups::new(groups.own().to_vec(), further, scale)?;
    let percent = 100.0 * added as f64 / n as f64;
    Ok((extended, Extended { area: PI * target, added, percent, groups: coverages }))
}

/// What the groups share.
struct Work<'a> {
    surfels: &'a Surfels,
    groups: &'a Groups,
    extension: &'a Extension,
    /// Of all surfels.
    tree: DiscTree,
    /// Of those that overlap, if surfels are to be added.
    graph: Graph,
    /// A divided by pi.
    target: f64,
    exec: &'a Exec,
}

impl Work<'_> {
    /// Extends a group; the surfels that are added to it.
    fn extend(&self, k: u8) -> Result<(Vec<u32>, GroupCoverage)> {
        let own: Vec<u32> =
            (0_u32..).zip(self.groups.own()).filter(|g| *g.1 == k).map(|g| g.0).collect();
        let before = self.coverage(own.iter().copied(), 1.0)?;
        let mut added = Vec::new();
        let mut coverage = GroupCoverage {
            surfels: own.len() as u64,
            scale: 1.0,
            converged: true,
            before,
            after: before,
        };
        match *self.extension {
            Extension::None => {}
            Extension::Add { most } => {
                added = add::added(&self.tree, &self.graph, self.groups.own(), k, most);
                coverage.surfels += added.len() as u64;
                coverage.after =
                    self.coverage(own.into_iter().chain(added.iter().copied()), 1.0)?;
            }
            Extension::Enlarge if own.is_empty() => coverage.converged = false,
            Extension::Enlarge => {
                let tree = DiscTree::new(self.surfels, own.iter().copied());
                let enlarged = enlarge::enlarged(&tree, self.target, self.exec)?;
                (coverage.scale, coverage.converged) = (enlarged.scale, enlarged.converged);
                coverage.after = self.coverage(own.into_iter(), enlarged.scale.into())?;
            }
        }
        Ok((added, coverage))
    }

    /// The area that some surfels cover, all radii times `scale`, as a part of A.
    fn coverage(&self, members: impl Iterator<Item = u32>, scale: f64) -> Result<f64> {
        let tree = DiscTree::new(self.surfels, members);
        let (area, _) = area(&tree, &by_lower(&tree, scale, self.exec, &|_, _| ())?);
        Ok(scale * scale * area / self.target)
    }
}
