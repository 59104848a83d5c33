//! \[ZP06, Algorithm 1\] by brute force: every fragment of every surfel of a group, at one pixel.
//!
//! Which fragment a depth-image keeps can hang on rounding. So an [`Kept`] is the list of all that
//! may be kept: whoever compares asks which of them was, and goes on from there.

use crate::oracle::ewa::model::{Entry, Oracle, Seen};
use crate::oracle::ewa::splat::Fragment;
use splatref::composite::bins::Range;

/// A fragment that a depth-image may keep.
pub(crate) struct KeptFragment<'a> {
    pub(crate) seen: Seen<'a>,
    /// What the depth test compares, from its least to its greatest value under rounding.
    order: [f64; 2],
    /// Whether it is inside for certain.
    sure: bool,
}

/// A depth-image at a pixel.
pub(crate) struct Kept<'a> {
    /// Every fragment that may be kept: none is certainly before it.
    pub(crate) candidates: Vec<KeptFragment<'a>>,
    /// Whether there may be none.
    pub(crate) may_be_empty: bool,
}

impl Kept<'_> {
    /// Whether rounding decides what is kept.
    pub(crate) fn undecided(&self) -> bool {
        self.candidates.len() + usize::from(self.may_be_empty) > 1
    }
}

/// The method before a scene.
pub(crate) struct Algorithm1<'a> {
    pub(crate) oracle: Oracle<'a>,
    /// The group of each surfel.
    pub(crate) own: &'a [u8],
    pub(crate) count: usize,
    /// The bins of the Voronoi depth test.
    pub(crate) range: Option<Range>,
}

impl Algorithm1<'_> {
    /// The depth-images of all groups at a point of the picture.
    pub(crate) fn images(&self, at: [f64; 2]) -> Vec<Kept<'_>> {
        let fragments = self.oracle.fragments(at);
        (0..self.count).map(|group| self.image(&fragments, group)).collect()
    }

    fn image<'b>(&self, fragments: &[Seen<'b>], group: usize) -> Kept<'b> {
        let oracle = &self.oracle;
        let limit = oracle.limit();
        let members = fragments.iter().filter(|(s, _)| usize::from(self.own[s.index]) == group);
        let mut candidates: Vec<_> = members
            .filter(|seen| seen.1.value.q <= limit || oracle.unsure(seen))
            .filter(|(_, f)| f.value.q - limit <= oracle.margin(f))
            .map(|seen| {
                let sure = !oracle.unsure(seen);
                KeptFragment { seen: *seen, order: self.order(&seen.1), sure }
            })
            .collect();
        let certain = candidates.iter().filter(|c| c.sure).map(|c| c.order[1]);
        let first = certain.fold(f64::INFINITY, f64::min);
        candidates.retain(|c| c.order[0] <= first);
        Kept { candidates, may_be_empty: first == f64::INFINITY }
    }

    /// What the depth test compares.
    fn order(&self, f: &Fragment) -> [f64; 2] {
        let slack = self.oracle.slack(f);
        let Some(range) = &self.range else { return [f.value.t - slack, f.value.t + slack] };
        let [low, high] = self.bins(range, 0.0, f);
        let [near, far] = self.ratios(f, self.oracle.guard);
        let rounding = self.oracle.guard * self.oracle.step * (high + 1.0);
        [low + near - rounding, high + far + rounding]
    }

    /// The bins that a fragment may fall into, eq. 6.
    pub(crate) fn bins(&self, range: &Range, shift: f64, f: &Fragment) -> [f64; 2] {
        let (nearest, farthest) = (f64::from(range.nearest), f64::from(range.farthest));
        let (extent, n) = (farthest - nearest, f64::from(range.count));
        let position = (f.value.t - nearest) / extent * n + shift;
        let error = self.oracle.slack(f) / extent * n;
        let error = error + self.oracle.guard * self.oracle.step * position.abs();
        [position - error, position + error].map(|p| p.floor().clamp(0.0, n))
    }

    /// The distance from the centre as a part of the radius, eq. 10; `guard` conditions either way.
    fn ratios(&self, f: &Fragment, guard: f64) -> [f64; 2] {
        let q = f.value.q;
        let error = guard * (f.spread.q + self.oracle.step * q);
        let of = |q: f64| (q.max(0.0).sqrt() / self.oracle.optics.k).min(255.0 / 256.0);
        [of(q - error), of(q + error)]
    }

    /// The Voronoi-enhanced depth of a fragment, if its bin is certain.
    fn voronoi(&self, range: &Range, f: &Fragment) -> Option<Entry> {
        let [low, high] = self.bins(range, 0.0, f);
        let [near, far] = self.ratios(f, 1.0);
        let [ratio, _] = self.ratios(f, 0.0);
        let z = low + ratio;
        let condition = (far - near) + self.oracle.step * z;
        let entry = Entry { plane: ".voronoi", value: [z; 3], condition: [condition; 3] };
        (low == high).then_some(entry)
    }

    /// What a depth-image holds that keeps this fragment: planes by the end of their name.
    pub(crate) fn planes(&self, at: [f64; 2], seen: Seen<'_>) -> Vec<Entry> {
        let mut planes = Vec::new();
        for entry in self.oracle.entries(at, &[seen], &[seen]) {
            let plane = match entry.plane {
                "attributes.weight" => ".weight",
                "attributes.normal" => ".normal",
                "attributes" => "",
                "Z" => ".Z",
                _ => continue,
            };
            planes.push(Entry { plane, ..entry });
        }
        planes.extend(self.range.as_ref().and_then(|range| self.voronoi(range, &seen.1)));
        planes
    }
}
