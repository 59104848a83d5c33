//! The graph of section 4.1: which surfels may not share a group.

use super::budget::Budget;
use super::disc::dot;
use super::disc_tree::{DiscTree, NearBlocks};
use super::parts::Parts;
use super::rules::{Coplanar, Rules};
use crate::error::Result;
use crate::frame::Exec;
use crate::number::MapInline;
use crate::number::lanes::vectorized;
use crate::progress::Progress;
use crate::scene::Surfels;
use std::mem;
use std::ops::Range;

/// The neighbours of every place of a tree.
#[derive(Clone, Debug, Default)]
pub(super) struct Graph(Parts<Rows>);

/// The neighbours of the places of a part.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    /// The start of each place's row, and one more that marks where all rows end.
    starts: Vec<Start>,
    neighbour: Vec<u32>,
}

/// Where the row of a place starts, and how many of its neighbours are surfels of a lower index.
#[derive(Clone, Copy, Debug)]
struct Start {
    at: u32,
    lower: u32,
}

/// The neighbours of a place; the first `lower` of them are surfels of a lower index.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row<'a> {
    pub(super) all: &'a [u32],
    pub(super) lower: usize,
}

vectorized!(
    /// The rows of some places.
    fn near_rows(
        tree: &DiscTree,
        places: Range<usize>,
        factor: f64,
        keep: &impl Fn(usize, usize) -> bool,
        budget: &Budget,
    ) -> Result<Rows> {
        let mut rows = Rows::with_capacity(places.len());
        let (mut room, mut found, mut seen) = (NearBlocks::default(), Vec::new(), 0);
        let end = places.end;
        for i in places {
            let mut count = 0;
            tree.near(i, factor, &mut room, |near, so_many| {
                // All entries are written; the ones that do not count are overwritten later.
                if found.len() < count + near.len() {
                    found.resize(2 * (count + near.len()), 0);
                }
                if let Some(free) = found[count..].first_chunk_mut() {
                    *free = near;
                }
                count += so_many;
                true
            });
            seen += count as u64;
            budget.spend_many(&mut seen)?;
            let kept = kept(&mut found[..count], |j| keep(i, j as usize));
            rows.make_room(kept.len(), end - i);
            rows.push(kept, |j| tree.surfel[j as usize] < tree.surfel[i]);
            budget.fits(rows.len())?;
        }
        budget.spend(seen)?;
        rows.neighbour.shrink_to_fit();
        Ok(rows)
    }
);

/// Moves the kept entries of a list to its start, and returns them.
#[inline(always)]
fn kept(list: &mut [u32], keep: impl Fn(u32) -> bool) -> &[u32] {
    let Some(mut count) = list.iter().position(|&one| !keep(one)) else { return list };
    for at in count + 1..list.len() {
        let one = list[at];
        list[count] = one;
        count += usize::from(keep(one));
    }
    &list[..count]
}

impl Rows {
    fn with_capacity(places: usize) -> Self {
        let mut starts = Vec::with_capacity(places + 1);
        starts.push(Start { at: 0, lower: 0 });
        Self { starts, neighbour: Vec::new() }
    }

    /// Reserves room for a row of this many neighbours, and for as many at each of the remaining
    /// places. Without the reserve, rows would be copied again and again as memory grows.
    #[inline(always)]
    fn make_room(&mut self, row: usize, places: usize) {
        // One row may be far longer than all others, so the guess for the rest is bounded.
        const MOST: usize = 1 << 16;
        if self.neighbour.capacity() - self.neighbour.len() < row {
            self.neighbour.reserve(row.max(MOST.min(row.saturating_mul(places))));
        }
    }

    /// Appends the neighbours of the next place.
    #[inline(always)]
    fn push(&mut self, neighbours: &[u32], is_lower: impl Fn(u32) -> bool) {
        let start = self.neighbour.len();
        self.neighbour.resize(start + neighbours.len(), 0);
        let row = &mut self.neighbour[start..];
        // Each neighbour is written to both ends of the free part, because a branch on which end it
        // belongs to would be mispredicted.
        let (mut lower, mut above) = (0, row.len());
        for &neighbour in neighbours {
            (row[lower], row[above - 1]) = (neighbour, neighbour);
            let is_lower = usize::from(is_lower(neighbour));
            lower += is_lower;
            above -= 1 - is_lower;
        }
        self.end_row(lower, self.neighbour.len());
    }

    /// Ends the row of the next place here; `lower` of its neighbours have a lower index.
    fn end_row(&mut self, lower: usize, end: usize) {
        if let Some(start) = self.starts.last_mut() {
            start.lower = lower as u32;
        }
        self.starts.push(Start { at: end as u32, lower: 0 });
    }

    /// Keeps the neighbours whose grade is at most `most`; `grades` has one grade for each
    /// neighbour, in their order. Reuses the memory of other rows, if there are any.
    pub(super) fn upto(&self, most: u8, grades: &[u8], room: Option<Self>) -> Self {
        let mut kept = room.unwrap_or_else(|| Self::with_capacity(self.starts.len() - 1));
        kept.starts.truncate(1);
        let count = grades.iter().filter(|&&grade| grade <= most).count();
        // Each entry is written where the next one goes, kept or not, because a branch would be
        // mispredicted.
        let (mut neighbour, mut end) = (mem::take(&mut kept.neighbour), 0);
        neighbour.resize(count + 1, 0);
        let mut keep = |entries: Range<usize>| {
            let before = end;
            for (&other, &grade) in self.neighbour[entries.clone()].iter().zip(&grades[entries]) {
                neighbour[end] = other;
                end += usize::from(grade <= most);
            }
            (end - before, end)
        };
        for row in self.starts.windows(2) {
            let [from, to] = [row[0].at, row[1].at].map_inline(|at| at as usize);
            let middle = from + row[0].lower as usize;
            let (lower, _) = keep(from..middle);
            let (_, end) = keep(middle..to);
            kept.end_row(lower, end);
        }
        neighbour.truncate(count);
        kept.neighbour = neighbour;
        kept
    }

    /// The neighbours of a place of the part.
    #[inline(always)]
    pub(super) fn row(&self, place: usize) -> Row<'_> {
        let Start { at, lower } = self.starts[place];
        Row {
            all: &self.neighbour[at as usize..self.starts[place + 1].at as usize],
            lower: lower as usize,
        }
    }

    /// How many neighbours there are in all.
    pub(super) fn len(&self) -> usize {
        self.neighbour.len()
    }
}

impl Row<'_> {
    /// Visits up to 64 neighbours from index `from` on: with their number from there, their place,
    /// and whether their surfel has a lower index.
    #[inline(always)]
    pub(super) fn visit_64(&self, from: usize, mut visit: impl FnMut(usize, usize, bool)) {
        let end = self.all.len().min(from + 64);
        for (number, &other) in self.all[from..end].iter().enumerate() {
            visit(number, other as usize, from + number < self.lower);
        }
    }
}

impl Graph {
    /// Makes the graph of the pairs of places that are [near](DiscTree::near) and kept.
    pub(super) fn new(
        tree: &DiscTree,
        factor: f64,
        keep: impl Fn(usize, usize) -> bool + Sync + Send,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Self> {
        let budget = Budget::new(tree.surfel.len(), factor);
        let rows = |places, _| near_rows(tree, places, factor, &keep, &budget);
        Self::of_rows(Self::default(), tree, rows, exec, progress)
    }

    /// Makes the graph from the rows of one part at a time, in the memory of another graph's rows.
    pub(super) fn of_rows(
        room: Self,
        tree: &DiscTree,
        rows: impl Fn(Range<usize>, Option<Rows>) -> Result<Rows> + Sync + Send,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Self> {
        let show = |done, of| progress("finding overlaps", done, of);
        Parts::in_place_of(room.0, tree, exec, &show, rows).map(Self)
    }

    /// The neighbours of a place.
    #[inline(always)]
    pub(super) fn row(&self, place: usize) -> Row<'_> {
        let (rows, place) = self.0.with(place);
        rows.row(place)
    }

    /// The rows of the part that begins with this place.
    pub(super) fn part(&self, place: usize) -> &Rows {
        self.0.with(place).0
    }

    pub(super) fn degree(&self, place: usize) -> u32 {
        self.row(place).all.len() as u32
    }
}

/// The graph of the rules, at their c or another one.
pub(super) fn conflicts(
    surfels: &Surfels,
    tree: &DiscTree,
    rules: &Rules,
    overlap: f32,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Graph> {
    let keep = |i: usize, j: usize| !relaxed(surfels, tree, rules, i, j);
    Graph::new(tree, f64::from(overlap), keep, exec, progress)
}

/// Whether modification 1 or 2 removes the edge between two places.
#[inline(always)]
pub(super) fn relaxed(
    surfels: &Surfels,
    tree: &DiscTree,
    rules: &Rules,
    i: usize,
    j: usize,
) -> bool {
    let is_opposite = || tree.discs[i].cosine(&tree.discs[j]) < 0.0;
    (rules.opposite && is_opposite())
        || rules.coplanar.as_ref().is_some_and(|rule| are_coplanar(surfels, tree, rule, i, j))
}

fn are_coplanar(surfels: &Surfels, tree: &DiscTree, rule: &Coplanar, i: usize, j: usize) -> bool {
    let cosine = tree.discs[i].cosine(&tree.discs[j]);
    let [i, j] = [i, j].map_inline(|place| tree.surfel[place] as usize);
    cosine >= f64::from(rule.cosine)
        && within_planes(surfels, rule, i, j)
        && of_one_color(surfels, rule, i, j)
}

fn within_planes(surfels: &Surfels, rule: &Coplanar, i: usize, j: usize) -> bool {
    let [p, q] = [i, j].map_inline(|i| surfels.position()[i].as_dvec3());
    let d = p - q;
    let radius = super::disc_tree::radii(surfels);
    let most = f64::from(rule.offset) * (radius(i as u32) + radius(j as u32));
    [i, j].into_iter().all(|i| dot(d, surfels.normal()[i].as_dvec3()).abs() <= most)
}

fn of_one_color(surfels: &Surfels, rule: &Coplanar, i: usize, j: usize) -> bool {
    surfels.color().is_none_or(|color| {
        let [a, b] = [i, j].map_inline(|i| color[i].as_dvec3().to_array());
        a.into_iter().zip(b).all(|(a, b)| (a - b).abs() <= f64::from(rule.color))
    })
}
