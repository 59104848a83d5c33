//! Largest First colouring \[Lei79\]: from the graph to groups.

use super::disc_tree::DiscTree;
use super::graded::{Graded, STEPS};
use super::graph::{Graph, conflicts};
use super::rules::Rules;
use super::settle::settle;
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::progress::Progress;
use crate::scene::groups::{MAX_GROUPS, check_count};
use crate::scene::{Groups, Surfels};
use std::borrow::Cow;
use std::mem::{swap, take};
use std::sync::atomic::Ordering::Relaxed;
use std::sync::atomic::{AtomicBool, AtomicU32};

/// The result of [`group`]: a row of Table 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupingReport {
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

/// Divides surfels into groups by the rules, see the [module](super).
///
/// # Errors
/// [`Error::Invalid`] as [`Rules::check`]; if there would be more than [`MAX_GROUPS`]; if more than
/// 64 pairs a surfel, and a million, overlap; if the process may not hold the working memory.
pub fn group(
    surfels: &Surfels,
    rules: &Rules,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<(Groups, GroupingReport)> {
    rules.check()?;
    let tree = DiscTree::of_all(surfels, f64::from(rules.overlap), exec, progress)?;
    Coloring { surfels, tree: &tree, rules, exec, progress }.group()
}

/// [`group`] with the largest c that gives at most `count` groups, as the [module](super) defines
/// it.
///
/// # Errors
/// [`Error::Invalid`] as [`Rules::check`], if `count` is not in 1 to [`MAX_GROUPS`], or if the
/// process may not hold the working memory.
pub fn group_into(
    surfels: &Surfels,
    rules: &Rules,
    count: usize,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<(Groups, GroupingReport)> {
    rules.check()?;
    check_count(count)?;
    let tree = DiscTree::of_all(surfels, f64::from(rules.overlap), exec, progress)?;
    Coloring { surfels, tree: &tree, rules, exec, progress }.group_into(count, None)
}

/// The input of a colouring.
pub(super) struct Coloring<'a> {
    pub(super) surfels: &'a Surfels,
    /// The tree of all surfels.
    pub(super) tree: &'a DiscTree,
    pub(super) rules: &'a Rules,
    pub(super) exec: &'a Exec,
    pub(super) progress: Progress<'a>,
}

impl Coloring<'_> {
    /// Makes the groups at the c of the rules.
    pub(super) fn group(&self) -> Result<(Groups, GroupingReport)> {
        let overlap = self.rules.overlap;
        let (graph, mut attempt) = (self.graph(overlap)?, Attempt::default());
        self.begin(&mut attempt, &graph);
        self.color(&attempt, &graph, 0, usize::MAX);
        let report = self.report(overlap, &attempt);
        if report.groups > MAX_GROUPS {
            return Err(Error::Invalid(format!(
                "c = {overlap} needs {} groups, but at most {MAX_GROUPS} are possible; give a \
                 lower c or smaller radii",
                report.groups
            )));
        }
        Ok((self.groups(&attempt, report.groups)?, report))
    }

    /// Makes the groups at the largest c that gives at most `count`. `overlaps` is the graph of all
    /// pairs that are near by 1, if there is one.
    pub(super) fn group_into(
        &self,
        count: usize,
        overlaps: Option<&Graph>,
    ) -> Result<(Groups, GroupingReport)> {
        let c = |steps: u8| f32::from(steps) / f32::from(STEPS);
        // No c above the c of the rules fits. c = 0 has no edges, and so fits.
        let (mut fits, mut fails) = (0, (f32::from(STEPS) * self.rules.overlap) as u8 + 1);
        let (mut best, mut next) = (self.without_edges(), Attempt::default());
        // The graph of a c that does not fit has the edges of every smaller one.
        let mut wider = overlaps.map(|graph| self.graded(Cow::Borrowed(graph))).transpose()?;
        let mut room = Graph::default();
        while fails - fits > 1 {
            let middle = u8::midpoint(fits, fails);
            let graph = match &wider {
                Some(wider) => self.upto(wider, middle, take(&mut room)),
                None => self.graph(c(middle)),
            };
            let Ok(graph) = graph else {
                fails = middle;
                continue;
            };
            // A place with fewer neighbours than `count` cannot need a colour that is too many, and
            // places with more neighbours do not wait for it. So it is coloured at the end, if its
            // graph can be made again then.
            let least = if wider.is_some() { count as u32 } else { 0 };
            self.begin(&mut next, &graph);
            let is_fit = self.color(&next, &graph, least, count);
            if is_fit {
                fits = middle;
                swap(&mut best, &mut next);
            } else {
                fails = middle;
            }
            if wider.is_some() {
                room = graph;
            } else if !is_fit {
                wider = Some(self.graded(Cow::Owned(graph))?);
            }
        }
        if let Some(wider) = wider.filter(|_| best.is_open()) {
            let graph = self.upto(&wider, fits, room)?;
            self.color(&best, &graph, 0, count);
        }
        let report = self.report(c(fits), &best);
        Ok((self.groups(&best, report.groups)?, report))
    }

    fn graph(&self, overlap: f32) -> Result<Graph> {
        let Self { surfels, tree, rules, exec, progress } = *self;
        conflicts(surfels, tree, rules, overlap, exec, progress)
    }

    fn graded<'a>(&self, graph: Cow<'a, Graph>) -> Result<Graded<'a>> {
        let Self { surfels, tree, rules, exec, progress } = *self;
        Graded::new(graph, surfels, tree, rules, exec, progress)
    }

    fn upto(&self, wider: &Graded<'_>, steps: u8, room: Graph) -> Result<Graph> {
        wider.upto(steps, room, self.tree, self.exec, self.progress)
    }

    /// Reports the groups of an attempt.
    fn report(&self, overlap: f32, attempt: &Attempt) -> GroupingReport {
        let n = self.surfels.len();
        let color = attempt.color.iter().map(|color| color.load(Relaxed));
        let edges = attempt.degree.iter().map(|&degree| u64::from(degree)).sum::<u64>() / 2;
        GroupingReport {
            surfels: n as u64,
            overlap,
            groups: color.fold(0, u32::max) as usize + 1,
            edges,
            max_degree: attempt.degree.iter().copied().fold(0, u32::max),
            average_degree: 2.0 * edges as f64 / n as f64,
        }
    }

    /// The groups of an attempt.
    fn groups(&self, attempt: &Attempt, groups: usize) -> Result<Groups> {
        let mut own = vec![0; attempt.color.len()];
        for (&surfel, color) in self.tree.surfel.iter().zip(&attempt.color) {
            own[surfel as usize] = color.load(Relaxed) as u8;
        }
        Groups::new(own, Vec::new(), vec![1.0; groups])
    }
}

/// The colours of a graph.
#[derive(Default)]
struct Attempt {
    /// The number of neighbours of every place.
    degree: Vec<u32>,
    /// The colour of every place, or [`NONE`].
    color: Vec<AtomicU32>,
}

/// No colour yet.
const NONE: u32 = u32::MAX;

impl Attempt {
    /// Whether a place has no colour yet.
    fn is_open(&self) -> bool {
        self.color.iter().any(|color| color.load(Relaxed) == NONE)
    }
}

impl Coloring<'_> {
    /// Without edges, all places have one colour.
    fn without_edges(&self) -> Attempt {
        let color = (0..self.surfels.len()).map(|_| AtomicU32::new(0)).collect();
        Attempt { color, ..Attempt::default() }
    }

    /// Starts to colour a graph, in the memory of another attempt, because the system clears memory
    /// that it has taken back before it returns it.
    fn begin(&self, Attempt { degree, color }: &mut Attempt, graph: &Graph) {
        let n = self.surfels.len();
        degree.clear();
        self.exec.extend(degree, n, |place| graph.degree(place));
        color.clear();
        self.exec.extend(color, n, |_| AtomicU32::new(NONE));
    }

    /// Colours all places that have at least `least` neighbours. Places with more neighbours come
    /// first, among equal ones the surfel of the lower index. Each place gets the smallest colour
    /// that no neighbour has. Returns false if a place gets the colour `most` or a larger one; then
    /// other places may have no colour.
    fn color(&self, attempt: &Attempt, graph: &Graph, least: u32, most: usize) -> bool {
        let Attempt { degree, color } = attempt;
        let color_of = |place: usize| color[place].load(Relaxed);
        let too_many = AtomicBool::new(false);
        let show = |done, of| (self.progress)("colouring", done, of);
        settle(color.len(), 1, self.exec, &show, |_, open| {
            let place = open.place;
            // Decided already, left for the end, or one place has needed too many colours and all
            // has failed.
            if color_of(place) != NONE || degree[place] < least || too_many.load(Relaxed) {
                return None;
            }
            // Among equally many neighbours, the lower index comes first.
            let own = degree[place];
            let before = |other: usize, lower: bool| degree[other] + u32::from(lower) > own;
            let row = graph.row(place);
            loop {
                while let Some(other) = open.first_of(open.waits, &row) {
                    let theirs = color_of(other);
                    // A neighbour that comes first has no colour yet: `settle` decides it before.
                    if theirs == NONE {
                        return Some(other);
                    }
                    open.mask |= u64::from(theirs < 64) << (theirs % 64);
                    open.waits &= open.waits - 1;
                }
                if open.asked >= row.all.len() {
                    break;
                }
                let (mut taken, mut waits) = (open.mask, 0_u64);
                row.visit_64(open.asked, |number, other, lower| {
                    let (before, theirs) = (before(other, lower), color_of(other));
                    waits |= u64::from(before & (theirs == NONE)) << number;
                    taken |= u64::from(before & (theirs < 64)) << (theirs % 64);
                });
                (open.mask, open.waits) = (taken, waits);
                open.asked += 64;
            }
            let (mut free, mut full) = (open.mask.trailing_ones(), open.mask == u64::MAX);
            while full {
                // Look at the next 64 colours; all places that come before have their colours by
                // now.
                let all =
                    row.all.iter().enumerate().map(|(at, &other)| (other as usize, at < row.lower));
                let taken = all.filter(|&(other, lower)| before(other, lower));
                let taken = taken.map(|(other, _)| color_of(other));
                let here = taken.filter(|taken| taken / 64 == free / 64);
                let mask = here.fold(0_u64, |mask, taken| mask | 1 << (taken % 64));
                (free, full) = (free + mask.trailing_ones(), mask == u64::MAX);
            }
            color[place].store(free, Relaxed);
            if free as usize >= most {
                too_many.store(true, Relaxed);
            }
            None
        });
        !too_many.into_inner()
    }
}
