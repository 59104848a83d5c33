//! Extension (1): add surfels of other groups to a group \[ZP06, section 4.2.2\].

use super::budget;
use super::clipped::{SAMPLES, areas, areas_of_groups, covered_by};
use super::disc_tree::DiscTree;
use super::extend::GroupCoverage;
use super::overlaps::Overlaps;
use super::settle::settle;
use crate::error::Result;
use crate::scene::Groups;
use std::ops::Range;
use std::sync::atomic::AtomicU8;
use std::sync::atomic::Ordering::Relaxed;

/// How many groups are extended at once; each neighbour is then looked at once for all of them.
const BATCH: usize = 4;

/// The result of adding surfels.
pub(super) struct Added {
    /// A divided by pi.
    pub(super) target: f64,
    /// (surfel, group), ascending.
    pub(super) further: Vec<(u32, u8)>,
    pub(super) groups: Vec<GroupCoverage>,
}

/// Adds surfels to all groups, and measures how much of the surface each group covers.
///
/// # Errors
/// [`crate::Error::Invalid`] if the process may not hold the added surfels.
pub(super) fn add(
    overlaps: &Overlaps<'_>,
    groups: &Groups,
    most: f32,
    progress: &dyn Fn(&str, u64, u64),
) -> Result<Added> {
    let &Overlaps { tree, exec, .. } = overlaps;
    let (n, count) = (tree.surfel.len(), groups.len());
    let mut own = Vec::new();
    exec.extend(&mut own, n, |place| groups.own()[tree.surfel[place] as usize]);
    let members = Members { overlaps, own: &own, most };
    // The sets: what all lower surfels cover, what lower surfels of the same group cover, and what
    // each group of the first batch covers of the others.
    let show = |done, of| progress("measuring the surface", done, of);
    let sets = |i: usize, j: usize, lower: bool| {
        let lower = u32::from(lower) * (1 | u32::from(own[i] == own[j]) << 1);
        lower | members.of_others(0, i, j) << 2
    };
    let measured = overlaps.covered::<2, BATCH>(sets, &show);
    let group = |surfel: usize| groups.own()[surfel].into();
    let ([target], before) = exec.join(
        || areas(tree, |place| [measured.open(place)[0]]),
        || areas_of_groups(tree, count, group, |place| measured.open(place)[1]),
    );

    let groups = members;
    let mut coverages = Vec::new();
    let mut added = vec![0_u64; n];
    for first in (0..count).step_by(BATCH) {
        let batch = first..count.min(first + BATCH);
        let show = |part: u64, done: u64, of: u64| {
            let here = (part * of + done) * batch.len() as u64;
            progress("extending groups", 3 * of * first as u64 + here, 3 * of * count as u64);
        };
        let decided = |done: u64, of: u64| show(1, done, of);
        let members = if first == 0 {
            groups.extended(batch.clone(), |place, set| measured.told(set, place), &decided)
        } else {
            let sets = |i: usize, j: usize, _: bool| groups.of_others(first, i, j);
            let covered = overlaps.covered::<0, BATCH>(sets, &|done, of| show(0, done, of));
            groups.extended(batch.clone(), |place, set| covered.told(set, place), &decided)
        };
        let sets = |i: usize, j: usize, lower: bool| {
            if lower { members[i] & members[j] } else { 0 }
        };
        let covered = overlaps.covered::<BATCH, 0>(sets, &|done, of| show(2, done, of));
        let (_, (surfels, after)) = exec.join(
            || {
                for (place, members) in members.iter().enumerate() {
                    let further = members & !groups.own(first, place);
                    if further != 0 {
                        added[tree.rank[place] as usize] |= u64::from(further) << first;
                    }
                }
            },
            || measured_groups(tree, &members, |place| covered.open(place)),
        );
        coverages.extend(batch.map(|group| {
            let (surfels, after) = (surfels[group - first], after[group - first] / target);
            let before = before[group] / target;
            GroupCoverage { surfels, scale: 1.0, converged: true, before, after }
        }));
    }
    let bits = |groups: u64| (0..count as u8).filter(move |group| groups >> group & 1 == 1);
    let of = |(surfel, groups)| bits(groups).map(move |group| (surfel, group));
    let count = added.iter().map(|groups| u64::from(groups.count_ones())).sum();
    let mut further = budget::room_for_added(count)?;
    further.extend((0..).zip(added).filter(|added| added.1 != 0).flat_map(of));
    Ok(Added { target, further, groups: coverages })
}

/// How many surfels are in each group of a batch, and the group's area, divided by pi. `members`
/// has a bit for each group at each place. `open` tells how many samples of a place the others of
/// each group leave open.
fn measured_groups(
    tree: &DiscTree,
    members: &[u32],
    open: impl Fn(usize) -> [u8; BATCH],
) -> ([u64; BATCH], [f64; BATCH]) {
    let is_member = |place: usize| -> [bool; BATCH] {
        std::array::from_fn(|set| members[place] >> set & 1 == 1)
    };
    let surfels = (0..members.len()).fold([0; BATCH], |mut surfels, place| {
        let each = surfels.iter_mut().zip(is_member(place));
        each.for_each(|(surfels, is_member)| *surfels += u64::from(is_member));
        surfels
    });
    // A place outside the group contributes no open samples.
    let of_members = |place| {
        let (open, is_member) = (open(place), is_member(place));
        std::array::from_fn::<_, BATCH, _>(|set| if is_member[set] { open[set] } else { 0 })
    };
    (surfels, areas(tree, of_members))
}

/// The group of each place, and the rule for adding.
struct Members<'a> {
    overlaps: &'a Overlaps<'a>,
    /// The group of each place.
    own: &'a [u8],
    most: f32,
}

impl Members<'_> {
    /// The bit of a place's group, if the group is one of the batch that begins with `first`.
    #[inline(always)]
    fn own(&self, first: usize, place: usize) -> u32 {
        let group = usize::from(self.own[place]).wrapping_sub(first);
        if group < BATCH { 1 << group } else { 0 }
    }

    /// The bit of the group of place j, if place i is in another group.
    #[inline(always)]
    fn of_others(&self, first: usize, i: usize, j: usize) -> u32 {
        self.own(first, j) & !self.own(first, i)
    }

    /// For each place, a bit for each group of a batch that it is in, or is added to. `covered`
    /// tells which samples of a place a group of the batch covers at the beginning.
    fn extended(
        &self,
        batch: Range<usize>,
        covered: impl Fn(usize, usize) -> u64 + Sync + Send,
        progress: &dyn Fn(u64, u64),
    ) -> Vec<u32> {
        let Overlaps { exec, .. } = *self.overlaps;
        let first = batch.start;
        let states = self.added(batch, covered, progress);
        let mut members = Vec::new();
        exec.extend(&mut members, self.own.len(), |place| {
            (0..).zip(&states).fold(self.own(first, place), |members, (set, state)| {
                let added = state[place].load(Relaxed) >= ADDED;
                members | u32::from(added) << set
            })
        });
        members
    }
}

/// The state of a place that is no candidate, or no longer one. The state of a candidate is its
/// priority plus one.
const OUT: u8 = 0;
/// The flag of a candidate that was added; the lower bits stay.
const ADDED: u8 = 128;

impl Members<'_> {
    /// Whether too many samples of a surfel are covered for it to be added.
    #[inline(always)]
    fn is_too_big(&self, covered: u64) -> bool {
        covered.count_ones() as f32 / SAMPLES as f32 > self.most
    }

    /// For each group of a batch, the state of each place before anything is added (the paper's
    /// step 1).
    fn undecided(
        &self,
        batch: Range<usize>,
        covered: impl Fn(usize, usize) -> u64 + Sync + Send,
    ) -> Vec<Vec<AtomicU8>> {
        let state = |group: usize| {
            let mut state = Vec::new();
            self.overlaps.exec.extend(&mut state, self.own.len(), |place| {
                let covered = covered(place, group - batch.start);
                let out = usize::from(self.own[place]) == group || self.is_too_big(covered);
                AtomicU8::new(if out { OUT } else { covered.count_ones() as u8 + 1 })
            });
            state
        };
        batch.clone().map(state).collect()
    }

    /// Decides each place for each group of a batch; states from [`ADDED`] on mean that the place
    /// is added to the group. `covered` tells what the group covers of each place at the beginning.
    ///
    /// The paper's queue is not needed. A surfel is taken out at the priority p; if it has grown
    /// since, it goes back with a larger priority. All others were at p or below and have not been
    /// looked at since. So the surfel is the first again, nothing has changed, and step 2b adds it.
    /// Each surfel is therefore decided when its turn comes, in the order of the priorities from
    /// step 1.
    fn added(
        &self,
        batch: Range<usize>,
        covered: impl Fn(usize, usize) -> u64 + Sync + Send,
        progress: &dyn Fn(u64, u64),
    ) -> Vec<Vec<AtomicU8>> {
        let &Overlaps { tree, graph, exec } = self.overlaps;
        let states = self.undecided(batch.clone(), &covered);
        let is_open = |state: u8| state != OUT && state < ADDED;
        settle(self.own.len(), batch.len(), exec, progress, |set, open| {
            let state = &states[set];
            let place = open.place;
            let own = state[place].load(Relaxed);
            if !is_open(own) {
                return None;
            }
            if open.asked == 0 {
                open.mask = covered(place, set);
            }
            let (row, mut samples) = (graph.of(place), None);
            loop {
                // Neighbours that come first and were not decided: each is decided before this
                // place.
                while let Some(other) = open.first_of(open.waits, &row) {
                    let theirs = state[other].load(Relaxed);
                    if is_open(theirs) {
                        return Some(other);
                    }
                    let left = open.waits & (open.waits - 1);
                    open.decided |= if theirs == OUT { 0 } else { open.waits ^ left };
                    open.waits = left;
                }
                // Neighbours that were added: what they cover may make this place too big.
                while let Some(other) = open.first_of(open.decided, &row) {
                    let samples = samples.get_or_insert_with(|| tree.samples(place));
                    open.mask |= covered_by(samples, &tree.discs[other]);
                    if self.is_too_big(open.mask) {
                        state[place].store(OUT, Relaxed);
                        return None;
                    }
                    open.decided &= open.decided - 1;
                }
                if open.asked >= row.all.len() {
                    break;
                }
                let (mut added, mut waits) = (0_u64, 0_u64);
                row.visit_64(open.asked, |number, other, lower| {
                    let theirs = state[other].load(Relaxed);
                    // A place that is out has a state of 0 and must not count as earlier, even with
                    // a lower index.
                    let first = (theirs & !ADDED) + u8::from(lower) > own;
                    added |= u64::from(first & (theirs >= ADDED)) << number;
                    waits |= u64::from(first & (theirs < ADDED)) << number;
                });
                (open.decided, open.waits) = (added, waits);
                open.asked += 64;
            }
            state[place].store(ADDED | own, Relaxed);
            None
        });
        states
    }
}
