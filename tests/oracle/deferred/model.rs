//! The passes of a frame, one pixel at a time, over all splats of the scene.
//!
//! The splats and their fragments are those of the oracle of `ewa`; which of them a pass draws, what
//! it leaves, and where rounding may decide is said here.

use crate::oracle::deferred::view::View;
use crate::oracle::ewa::model::{Entry, Oracle, Seen};
use crate::oracle::kit::number::Num;
use crate::oracle::kit::projection::Candidate;
use std::collections::{BTreeMap, BTreeSet};

/// What a frame saw: the flags, object and group, and how many surfels of each object.
#[derive(Clone, Default)]
pub(crate) struct Flags {
    m: u32,
    set: BTreeSet<(usize, u32)>,
    counts: BTreeMap<usize, u32>,
}

impl Flags {
    pub(crate) fn of(m: u32, selected: impl IntoIterator<Item = (usize, u32)>) -> Self {
        let mut flags = Self { m, ..Self::default() };
        for (o, s) in selected {
            flags.set.insert((o, s / m));
            *flags.counts.entry(o).or_default() += 1;
        }
        flags
    }

    /// How many surfels of an object were selected.
    pub(crate) fn selected(&self, object: usize) -> u32 {
        self.counts.get(&object).copied().unwrap_or(0)
    }

    pub(crate) fn has(&self, (object, surfel): (usize, u32)) -> bool {
        self.m > 0 && self.set.contains(&(object, surfel / self.m))
    }
}

/// Which surfels, by their place in the order of ids, are drawn by which pass.
pub(crate) struct Sets {
    /// Pass 1.
    pub(crate) flagged: Vec<bool>,
    /// Pass 3, or none.
    pub(crate) fresh: Vec<bool>,
    /// Pass 4: B(i).
    pub(crate) selected: Vec<bool>,
}

impl Sets {
    pub(crate) fn new(
        View { numbers, every, left, .. }: &View,
        flags: &Flags,
        selected: &BTreeSet<u64>,
        second: bool,
    ) -> Self {
        let flagged: Vec<_> = every.iter().map(|&of| flags.has(of) && !left[of.0]).collect();
        let selected: Vec<_> =
            every.iter().map(|&(o, s)| selected.contains(&numbers.id(o, s))).collect();
        let fresh = selected.iter().zip(&flagged).map(|(s, f)| second && *s && !*f).collect();
        Self { flagged, fresh, selected }
    }
}

/// What visibility splatting leaves at a pixel.
pub(crate) struct Nearest {
    /// Depth; none: the pixel is empty.
    pub(crate) depth: Option<Entry>,
    /// The places of those that may be the nearest.
    pub(crate) who: Vec<u32>,
    /// Whether rounding may decide whether the nearest is there.
    pub(crate) open: bool,
}

/// What the last passes leave at a pixel.
pub(crate) struct Sums {
    pub(crate) count: usize,
    /// The places of those that the pixel may name; none: the pixel is empty.
    pub(crate) who: Vec<u32>,
    pub(crate) entries: Vec<Entry>,
    pub(crate) open: bool,
    /// Whether the pixel shows a polygon.
    pub(crate) covered: bool,
}

fn inside<'a>(oracle: &Oracle<'_>, all: &[Seen<'a>]) -> Vec<Seen<'a>> {
    all.iter().filter(|(_, f)| f.value.q <= oracle.limit()).copied().collect()
}

/// Whether one that may be inside, or not, may be no farther than a depth.
fn unsure(oracle: &Oracle<'_>, all: &[Seen<'_>], reach: f64) -> bool {
    all.iter().any(|seen| {
        let near = seen.1.value.q - oracle.limit() <= oracle.margin(&seen.1);
        near && oracle.unsure(seen) && seen.1.value.t - oracle.slack(&seen.1) <= reach
    })
}

/// Those of a set.
pub(crate) fn of<'a>(all: &[Seen<'a>], set: &[bool]) -> Vec<Seen<'a>> {
    all.iter().filter(|(s, _)| set[s.index]).copied().collect()
}

/// Of surfels that are the same the lowest id alone may be the nearest.
fn without_twins(oracle: &Oracle<'_>, who: &[u32]) -> Vec<u32> {
    let surfels = &oracle.scene.surfels;
    let of = |w: u32| {
        let i = w as usize;
        let axes = surfels.tangents().map(|all| all[i]);
        (surfels.position()[i], surfels.normal()[i], surfels.radius()[i], axes)
    };
    let first = |w: &u32| !who.iter().any(|k| k < w && of(*k) == of(*w));
    who.iter().copied().filter(first).collect()
}

/// Depth and rounding error of the nearest polygon; +inf where there is none.
pub(crate) type Behind = (f64, f64);

pub(crate) const NOTHING: Behind = (f64::INFINITY, 0.0);

/// Whether rounding decides which of two is nearer.
fn even(first: (f64, f64), wall: Behind) -> bool {
    wall.0.is_finite() && (first.0 - wall.0).abs() <= first.1 + wall.1
}

/// Visibility splatting of some fragments at a pixel, before a polygon.
pub(crate) fn nearest(
    oracle: &Oracle<'_>,
    all: &[Seen<'_>],
    wall: Behind,
    plane: &'static str,
) -> Nearest {
    let inside = inside(oracle, all);
    let (first, slack) = oracle.first(&inside);
    let even = even((first, slack), wall);
    if wall.0 < first {
        let condition = [wall.1 / oracle.guard; 3];
        let depth = Some(Entry { plane, value: [wall.0; 3], condition });
        let open = even || unsure(oracle, all, wall.0 + wall.1);
        return Nearest { depth, who: Vec::new(), open };
    }
    let who = oracle.nearest(&inside);
    let close = inside.iter().filter(|(s, _)| who.contains(&(s.index as u32)));
    let spread = close.map(|(_, f)| f.spread.t).fold(0.0, f64::max);
    let condition = [spread + oracle.step * first.abs(); 3];
    let who = without_twins(oracle, &who);
    let depth = first.is_finite().then_some(Entry { plane, value: [first; 3], condition });
    Nearest { depth, who, open: even || unsure(oracle, all, first + slack) }
}

/// Attribute splatting of the `selected` among the fragments, against the nearest of the `drawn`,
/// and normalization.
pub(crate) fn sums(
    oracle: &Oracle<'_>,
    at: [f64; 2],
    [drawn, selected]: [&[Seen<'_>]; 2],
    wall: Behind,
) -> Sums {
    let (depths, own) = (inside(oracle, drawn), inside(oracle, selected));
    let splat = oracle.first(&depths);
    let (first, slack) = if wall.0 < splat.0 { wall } else { splat };
    // Without pass 3 splats may be in front of all depths.
    let foremost = if wall.0 < splat.0 { oracle.first(&own) } else { splat };
    let covered = wall.0 < foremost.0;
    let undecided = even(splat, wall) || even(foremost, wall);
    // +inf where no pass left a depth: then all are in the sums.
    let limit = first + oracle.epsilon;
    let band = oracle.band();
    let seen: Vec<_> = own.iter().filter(|(_, f)| f.value.t <= limit).copied().collect();
    let grazes = own.iter().any(|(_, f)| {
        let room = oracle.slack(f) + slack + band;
        limit.is_finite() && f.value.t != first && (f.value.t - limit).abs() <= room
    });
    // The nearest, if it is selected, passes its own test; but another may be the nearest.
    let rival = own.iter().any(|(_, f)| f.value.t == first)
        && depths.iter().any(|(_, k)| {
            let room = oracle.slack(k) + slack + band;
            k.value.t != first && (k.value.t + oracle.epsilon) - first <= room
        });
    let open = undecided
        || grazes
        || rival
        || unsure(oracle, drawn, first + slack)
        || unsure(oracle, selected, limit + slack + band);
    let shown = if depths.is_empty() || wall.0 < splat.0 { &own } else { &depths };
    let who = if seen.is_empty() { Vec::new() } else { oracle.nearest(shown) };
    let who = without_twins(oracle, &who);
    let entries = oracle.entries(at, shown, &seen);
    let covered = wall.0.is_finite() && (covered || seen.is_empty());
    Sums { count: seen.len(), who, entries, open, covered }
}

/// The places of those that pass 2 may keep in a pixel, and whether it may keep none.
pub(crate) fn kept<const P: u32>(
    all: &[Candidate<P>],
    before: f64,
    epsilon: f64,
) -> (Vec<Candidate<P>>, bool) {
    let limit = Num::exact(before) + Num::exact(epsilon);
    let drawn = |c: &Candidate<P>| c.t.at_most_as(limit);
    let sure: Vec<_> = all.iter().filter(|c| c.certain && drawn(c) == Some(true)).collect();
    let may = all.iter().filter(|c| drawn(c) != Some(false));
    let may = may.filter(|c| !sure.iter().any(|k| k.id != c.id && k.is_before(c)));
    (may.copied().collect(), sure.is_empty())
}
