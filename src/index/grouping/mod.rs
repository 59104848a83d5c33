//! Divide surfels into minimal independent groups: surfels that do not overlap share one
//! depth-image \[ZP06, section 4\].
//!
//! [`group`] divides the surfels of a scene so that no two surfels of a group overlap. [`extend`]
//! then makes each group cover the surface. All numbers are f64 converted from the f32 of the
//! scene. i and j are indices of surfels, and a dot product is `(x x' + y y') + z z'`.
//!
//! # Which surfels conflict: the graph (4.1)
//!
//! Nodes are surfels. With `d = p_i - p_j`, surfels i and j are *near by a factor c* if
//!
//! ```text
//!   (d.x d.x + d.y d.y) + d.z d.z  <  m m       where  m = c (r_i + r_j)
//! ```
//!
//! which is eq. 5 for c = 1 and modification 3 for c < 1. `Decided:` r is the radius of a surfel;
//! for an ellipse it is the length of its longer half axis, `sqrt((x x + y y) + z z)`, so an
//! ellipse counts as the disc around it. Surfels that are near by the c of the [`Rules`] have an
//! edge, unless
//!
//! - `opposite` is set and `n_i . n_j < 0` (modification 2), or
//! - they are [`Coplanar`] (modification 1). `Decided:` that is `n_i . n_j >= cosine`, and for n of
//!   either `|d . n| <= offset (r_i + r_j)`, and, if surfels have colours, no component of the two
//!   differs by more than `color`.
//!
//! # How surfels get groups: the colouring (4.1)
//!
//! Largest First \[Lei79\]: take surfels in the order of their number of edges, the largest first,
//! among equal ones the lower index first. Each surfel gets the smallest colour, from 0 on, that
//! none of its neighbours has yet. The colour is the group. K is one more than the largest colour,
//! and at most one more than the largest number of edges. (The paper bounds the chromatic number by
//! the largest degree alone, which fails for complete graphs.)
//!
//! Low colours are filled first, so groups have very different sizes. For a randomly sampled
//! surface in four groups (c about 0.15), the first group covers everything, the second a fifth,
//! the last nothing.
//!
//! [`group_into`] looks for the largest c that gives at most a number of groups. `Decided:` the
//! result is defined by bisection, because K need not fall with c from one step to the next. The
//! candidates are the multiples of 1/64 up to the c of the rules. c = 0 has no edge and one group,
//! and fits. The first multiple above the rules' c does not fit. The middle of the two, rounded
//! down, is tried and replaces one of them, until they are neighbours. A graph with too many edges
//! does not fit.
//!
//! # How much of a disc others cover (4.2.2)
//!
//! `Clipped(p_i, r, k)` is the area of disc i that discs of group k overlap. `Decided:` it is
//! measured on 64 samples of disc i, so it has one of 65 values and step 2b below can test for
//! equality. With `q_m = (m + 1/2)/64` and the golden angle g = 2.399963229728653, sample m of the
//! unit disc is `sqrt(q_m) (cos(m g), sin(m g))`: each sample stands for the same area. The samples
//! of disc i lie on axes u and v of its plane. They are turned by a random multiple of 1/64 of a
//! turn, because errors would add up where surfels are regular. With n the normal of i,
//!
//! ```text
//!   s  = 1, or -1 if n.z < 0        a = -1 / (s + n.z)          b = n.x n.y a
//!   u0 = (1 + s n.x n.x a, s b, -s n.x)        v0 = (b, s + n.y n.y a, -n.y)
//!   t  = (the upper 6 bits of random::bits(0, i)) (2 pi / 64)
//!   u  = cos(t) u0 + sin(t) v0                 v  = cos(t) v0 - sin(t) u0
//! ```
//!
//! (Duff et al., *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017; products from left to
//! right, functions from [`crate::number::elementary`], bits from [`crate::number::random`].)
//!
//! `Decided:` disc j covers a sample if the sample is no farther from the centre of j than the
//! radius of j, in space as in eq. 5, and `n_i . n_j >= 0`, so that the other side of a thin wall
//! does not count:
//!
//! ```text
//!   (A x_m + B y_m) + r_i r_i q_m  <=  r_j r_j - d . d
//!   where  A = 2 r_i (d . u),  B = 2 r_i (d . v),  (x_m, y_m) = sample m of the unit disc
//! ```
//!
//! Two walls that face the same way and are less than r apart count as one wall.
//!
//! `Departs:` eq. 7 subtracts from each disc of a group what the others of the group cover of it.
//! That removes every overlap twice, once from either side. Here the covered area is
//!
//! ```text
//!   sum over the group, in ascending index, of  pi r_i r_i (samples that no j < i of it covers) / 64
//! ```
//!
//! which is the area of the union, up to sampling; and A of eq. 8 is this area for all surfels.
//! Both areas, and so the ratio of a group to the whole, are off by a few parts in a thousand.
//!
//! # Add surfels to groups (4.2.2, extension 1)
//!
//! For each group k separately, [`Extension::Add`] follows the paper's steps 1, 2, 2a and 2b. "too
//! big" is more than `most` of the area, and among equal priorities the lower index comes first.
//! `Departs:` there is no queue, because none is needed. Take a surfel that is taken out of the
//! queue at priority p and has grown. It goes back with a larger priority, while all others are at
//! p or below. So it is taken out again at once, nothing has changed, and step 2b adds it. The
//! steps therefore reduce to this: visit surfels of other groups in descending order of how much
//! the group covered of them at the beginning. Add a surfel if the group, including the surfels
//! added so far, covers at most `most` of it.
//!
//! # Enlarge the radii of groups (4.2.2, extension 2)
//!
//! For each group separately, [`Extension::Enlarge`] iterates eq. 9 from scale 1. `Decided:` radii
//! may differ, all radii of a group are multiplied by one scale s, and n pi r^2 is the sum of
//! `pi r_i^2`:
//!
//! ```text
//!   s' = sqrt((A / pi + s s (R - U)) / R)
//!   where  R = sum of r_i r_i,  U = covered area at radii s r_i, divided by pi s s
//! ```
//!
//! s' < 1 becomes 1. The iteration ends when |s' - s| <= [`SMALL_STEP`] s': the group has
//! converged. `Decided:` the group has not converged if s' reaches [`MAX_SCALE`], which then is its
//! scale, or after [`MAX_STEPS`] steps. When a group covers nearly everything, clipping grows as
//! fast as the area, and each step gains only a part of the rest: the iteration ends at about 99 %
//! of A. It fails for the last groups of a colouring, which may be a handful of surfels. The scale
//! is rounded to f32 once.

mod add;
mod budget;
mod clipped;
mod color;
mod coverage;
mod curve;
mod disc;
mod disc_tree;
mod enlarge;
mod extend;
mod graded;
mod graph;
mod overlaps;
mod parts;
mod rules;
mod samples;
mod scales;
mod settle;
#[cfg(test)]
mod tests;

pub use color::{GroupingReport, group, group_into};
pub use coverage::{Extended, GroupCoverage};
pub(crate) use curve::interleaved;
pub use enlarge::{MAX_SCALE, MAX_STEPS, SMALL_STEP};
pub use extend::{Extension, extend};
pub use rules::{Coplanar, Rules};

use crate::error::Result;
use crate::frame::Exec;
use crate::number::Real;
use crate::progress::Progress;
use crate::scene::groups::check_count;
use crate::scene::{Groups, Surfels};
use crate::setting::{Field, Fields, Slot, Visit};
use color::Coloring;
use disc_tree::DiscTree;
use extend::Work;
use graph::Graph;

/// How surfels are divided into groups.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grouping {
    /// Which surfels may not share a group.
    pub rules: Rules,
    /// The most groups, see [`group_into`]; none means as many as the rules need.
    pub count: Option<usize>,
    /// How groups are made to cover the surface.
    pub extension: Extension,
}

impl Fields for Grouping {
    fn fields(&mut self, each: &mut Visit<'_>) {
        self.rules.fields(each);
        let mut count = self.count.map(|count| count as u32);
        let help = "use the largest overlap that gives at most this many groups; `any` makes as \
                    many as the overlap needs";
        each(
            Field::new("count", help, Slot::CountOr(&mut count, "any"))
                .option("groups")
                .range("1 to 64"),
        );
        self.count = count.map(|count| count as usize);
        self.extension.fields(each);
    }
}

impl Grouping {
    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if one is not.
    pub fn check(&self) -> Result<()> {
        self.rules.check()?;
        self.extension.check()?;
        self.count.map_or(Ok(()), check_count)
    }

    /// Makes the groups, and reports what was found and what the extension did.
    ///
    /// `progress` receives the name of a step, how much of it is done, and how much there is.
    ///
    /// # Errors
    /// As [`group()`], [`group_into`] and [`extend()`].
    pub fn groups(
        &self,
        surfels: &Surfels,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<(Groups, GroupingReport, Option<Extended>)> {
        self.rules.check()?;
        self.extension.check()?;
        self.count.map_or(Ok(()), check_count)?;
        let factor = f64::from(self.rules.overlap).at_least(self.extension.reach());
        let tree = DiscTree::of_all(surfels, factor, exec, progress)?;
        // To add surfels, the extension needs the graph of all overlaps, which contains the edges
        // of every other graph. If it has too many edges, the groups may still succeed.
        let overlaps = match self.extension {
            Extension::Add { .. } => Graph::new(&tree, 1.0, |_, _| true, exec, progress).map(Some),
            Extension::None | Extension::Enlarge => Ok(None),
        };
        let wider = overlaps.as_ref().ok().and_then(Option::as_ref);
        let coloring = Coloring { surfels, tree: &tree, rules: &self.rules, exec, progress };
        let (groups, report) = match self.count {
            None => coloring.group()?,
            Some(count) => coloring.group_into(count, wider)?,
        };
        if self.extension == Extension::None {
            return Ok((groups, report, None));
        }
        let work = Work { surfels, tree: &tree, exec, progress };
        let (groups, extended) = work.extend(&groups, &self.extension, overlaps?)?;
        Ok((groups, report, Some(extended)))
    }
}
