//! Largest First colouring \[Lei79\]: from the graph to groups.

use super::disc_tree::DiscTree;
use super::graded::Graded;
use super::graph::{Graph, conflicts};
use super::rules::Rules;
use super::settle::settle;
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::scene::groups::{MAX_GROUPS, check_count};
use crate::scene::{Groups, Surfels};
use std::cell::OnceCell;
use std::mem::take;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::atomic::{AtomicBool, AtomicU32};

/// c is tried in multiples of one in so many.
pub(super) const STEPS: u8 = 64;

/// What [`group`] found: a row of Table 1.
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
/// 64 pairs a surfel, and a million, overlap; if the process may not hold what it takes.
pub fn group(
    surfels: &Surfels,
    rules: &Rules,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Groups, GroupingReport)> {
    rules.check()?;
    let tree = DiscTree::of_all(surfels, f64::from(rules.overlap), exec, progress)?;
    Coloring { surfels, tree: &tree, rules, exec, progress }.group()
}

/// As [`group`], with the largest c that gives at most `count` groups, as the [module](super)
/// defines it.
///
/// # Errors
/// [`Error::Invalid`] as [`Rules::check`], if `count` is not in 1 to [`MAX_GROUPS`], or if the process may not
/// hold what it takes.
pub fn group_into(
    surfels: &Surfels,
    rules: &Rules,
    count: usize,
    exec: &Exec,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<(Groups, GroupingReport)> {
    rules.check()?;
    check_count(count)?;
    let tree = DiscTree::of_all(surfels, f64::from(rules.overlap), exec, progress)?;
    Coloring { surfels, tree: &tree, rules, exec, progress }.group_into(count, None)
}

/// What is coloured, and how.
pub(super) struct Coloring<'a> {
    pub(super) surfels: &'a Surfels,
    /// Of all surfels.
    pub(super) tree: &'a DiscTree,
    pub(super) rules: &'a Rules,
    pub(super) exec: &'a Exec,
    pub(super) progress: &'a dyn Fn(&str, u64, u64),
}

impl Coloring<'_> {
    /// The groups at the c of the rules.
    pub(super) fn group(&self) -> Result<(Groups, GroupingReport)> {
        let overlap = self.rules.overlap;
        let graph = self.graph(overlap)?;
        let (color, report) = self
            .color(&graph, overlap, usize::MAX, &mut Room::default())
            .expect("as many colours as it takes");
        if report.groups > MAX_GROUPS {
            return Err(Error::Invalid(format!(
                "c = {overlap} needs {} groups, and at most {MAX_GROUPS} can be: give a lower c or \
                 smaller radii",
                report.groups
            )));
        }
        Ok((groups(self.tree, &color, report.groups)?, report))
    }

    /// The groups at the largest c that gives at most `count`. `overlaps` is the graph of all pairs
    /// that are near by 1, if there is one.
    pub(super) fn group_into(
        &self,
        count: usize,
        overlaps: Option<&Graph>,
    ) -> Result<(Groups, GroupingReport)> {
        // What is above the c of the rules does not fit. The graph of a c that does not has the
        // edges of every smaller one.
        let (mut fits, mut fails) = (0, (f32::from(STEPS) * self.rules.overlap) as u8 + 1);
        let (mut best, wider, mut room) = (None, OnceCell::new(), Room::default());
        let mut graded = overlaps.map(|graph| self.graded(graph)).transpose()?;
        while fails - fits > 1 {
            let middle = u8::midpoint(fits, fails);
            let overlap = f32::from(middle) / f32::from(STEPS);
            let graph = match &graded {
                Some(graded) => {
                    graded.upto(middle, take(&mut room.graph), self.tree, self.exec, self.progress)
                }
                None => self.graph(overlap),
            };
            let graph = graph.ok();
            let found =
                graph.as_ref().and_then(|graph| self.color(graph, overlap, count, &mut room));
            let fit = found.is_some();
            match found {
                Some(found) => (fits, best) = (middle, Some(found)),
                None => fails = middle,
            }
            match graph {
                Some(graph) if graded.is_none() && !fit => {
                    graded = Some(self.graded(wider.get_or_init(|| graph))?);
                }
                graph => room.graph = graph.unwrap_or_default(),
            }
        }
        // c = 0 has no edges, and so fits.
        let (color, report) =
            best.unwrap_or_else(|| (vec![0; self.surfels.len()], self.report(0.0, 1, None)));
        Ok((groups(self.tree, &color, report.groups)?, report))
    }

    fn graph(&self, overlap: f32) -> Result<Graph> {
        let Self { surfels, tree, rules, exec, progress } = *self;
        conflicts(surfels, tree, rules, overlap, exec, progress)
    }

    fn graded<'a>(&self, graph: &'a Graph) -> Result<Graded<'a>> {
        let Self { surfels, tree, rules, exec, progress } = *self;
        Graded::new(graph, surfels, tree, rules, exec, progress)
    }

    /// The colour of every place; none if it takes more than `most`.
    fn color(
        &self,
        graph: &Graph,
        overlap: f32,
        most: usize,
        room: &mut Room,
    ) -> Option<(Vec<u32>, GroupingReport)> {
        let show = |done, of| (self.progress)("colouring", done, of);
        let color = largest_first(graph, self.surfels.len(), most, room, self.exec, &show)?;
        let groups = color.iter().fold(0, |most, &color| most.max(color)) as usize + 1;
        let report = self.report(overlap, groups, Some(graph));
        Some((color, report))
    }

    /// What is told of a graph; without one there are no edges.
    fn report(&self, overlap: f32, groups: usize, graph: Option<&Graph>) -> GroupingReport {
        let n = self.surfels.len();
        let edges = graph.map_or(0, Graph::edges);
        GroupingReport {
            surfels: n as u64,
            overlap,
            groups,
            edges,
            max_degree: graph.map_or(0, Graph::max_degree),
            average_degree: 2.0 * edges as f64 / n as f64,
        }
    }
}

/// Memory that one c after the other is tried in: what the system has taken back it clears before it gives it
/// again.
#[derive(Default)]
struct Room {
    graph: Graph,
    degree: Vec<u32>,
    color: Vec<AtomicU32>,
}

/// The groups of the colour of every place.
fn groups(tree: &DiscTree, color: &[u32], groups: usize) -> Result<Groups> {
    let mut own = vec![0; color.len()];
    for (&surfel, &color) in tree.surfel.iter().zip(color) {
        own[surfel as usize] = color as u8;
    }
    Groups::new(own, Vec::new(), vec![1.0; groups])
}

/// The colour of all `n` places: those with more neighbours first, of those with equally many the
/// surfel of the lower index; each gets the smallest colour that no neighbour has. None if one gets
/// `most` or a larger one.
fn largest_first(
    graph: &Graph,
    n: usize,
    most: usize,
    room: &mut Room,
    exec: &Exec,
    progress: &dyn Fn(u64, u64),
) -> Option<Vec<u32>> {
    const NONE: u32 = u32::MAX;
    let Room { degree, color, .. } = room;
    degree.clear();
    exec.extend(degree, n, |place| graph.degree(place));
    color.clear();
    exec.extend(color, n, |_| AtomicU32::new(NONE));
    let color_of = |place: usize| color[place].load(Relaxed);
    let too_many = AtomicBool::new(false);
    settle(n, 1, exec, progress, |_, open| {
        let place = open.place;
        if color_of(place) != NONE || too_many.load(Relaxed) {
            return None;
        }
        // Of equally many neighbours, the lower index comes first.
        let own = degree[place];
        let before = |other: usize, lower: bool| degree[other] + u32::from(lower) > own;
        let row = graph.of(place);
        loop {
            while let Some(other) = open.first_of(open.waits, &row) {
                let theirs = color_of(other);
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
            // The next 64 colours; all that come before are coloured by now.
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
    let fits = !too_many.into_inner();
    fits.then(|| take(color).into_iter().map(AtomicU32::into_inner).collect())
}
