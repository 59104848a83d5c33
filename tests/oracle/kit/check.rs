//! Planes of a picture against numbers that bound their rounding.
//!
//! Stage by stage: each is computed from what the crate left of the one before, so that errors do
//! not pile up, and a plane is compared in units of its running error bound. Where rounding may
//! decide, any outcome is accepted, and such pixels are counted.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::number::{BITS, N3, Num};
use crate::oracle::kit::planes::{at, value};
use crate::oracle::kit::projection::{Candidate, Projected};
use crate::oracle::kit::tolerance::{Arithmetic, Measured};
use splatref::frame::{Frame, NO_ID};
use splatref::number::Exact;
use splatref::splat::Tally;
use std::collections::BTreeMap;

/// One number: the row of the table, what it should be, what it is.
pub(crate) type Number<const P: u32> = (&'static str, Num<P>, f64);

pub(crate) fn vector<const P: u32>(
    row: &'static str,
    truth: N3<P>,
    found: [f64; 3],
) -> [Number<P>; 3] {
    [0, 1, 2].map(|i| (row, truth[i], found[i]))
}

/// Cells that were compared, and those of which rounding may decide something, by stage.
#[derive(Debug, Default)]
pub(crate) struct Open(pub(crate) BTreeMap<&'static str, [u64; 2]>);

pub(crate) const PROJECTION: &str = "projection";
pub(crate) const FAR: &str = "projection of what is far away";

impl Open {
    pub(crate) fn count(&mut self, stage: &'static str, open: bool) {
        let entry = self.0.entry(stage).or_default();
        entry[0] += 1;
        entry[1] += u64::from(open);
    }

    pub(crate) fn get(&self, stage: &str) -> [u64; 2] {
        self.0.get(stage).copied().unwrap_or_default()
    }
}

/// One picture under test.
pub(crate) struct Check<'a, R, const P: u32> {
    pub(crate) name: &'a str,
    pub(crate) frame: &'a Frame<R>,
    pub(crate) arithmetic: Arithmetic,
    pub(crate) measured: &'a mut Measured,
    pub(crate) open: &'a mut Open,
}

impl<R: Exact, const P: u32> Check<'_, R, P> {
    pub(crate) fn number(&self, plane: &str, i: usize) -> f64 {
        self.value(plane, i)[0]
    }

    pub(crate) fn value(&self, plane: &str, i: usize) -> [f64; 3] {
        value(self.frame, plane, i)
    }

    pub(crate) fn optional(&self, plane: &str, i: usize) -> Option<[f64; 3]> {
        self.frame.plane(plane).map(|samples| at(samples, i))
    }

    /// The best of several outcomes, whose numbers are measured.
    pub(crate) fn best(&mut self, outcomes: Vec<Vec<Number<P>>>, place: impl Fn() -> String) {
        let worst = |numbers: &Vec<Number<P>>| {
            numbers.iter().map(|(_, truth, found)| truth.deviation(*found)).fold(0.0, f64::max)
        };
        let best = outcomes.iter().min_by(|a, b| worst(a).total_cmp(&worst(b)));
        let best = best.unwrap_or_else(|| panic!("{} of {}: no outcome fits", place(), self.name));
        if P == BITS {
            let wrong: Vec<_> = best.iter().filter(|(_, t, found)| t.v != *found).collect();
            assert!(wrong.is_empty(), "{wrong:?}: {} of {}", place(), self.name);
            return;
        }
        for (row, truth, found) in best {
            self.measured.add(row, self.arithmetic, truth.deviation(*found), || {
                format!("{} of {}: {found} for {truth:?}", place(), self.name)
            });
        }
    }

    /// The planes of the projection to single pixels.
    pub(crate) fn projection<S>(&mut self, case: &Case<S>, truth: &Projected<P>, tally: &Tally) {
        truth.fates.check(tally, case.scene.surfels.len(), self.name);
        for (i, x, y) in case.pixels() {
            let all = &truth.pixels[i];
            let id = self.number("projection.id", i) as u32;
            let place = format!("projected pixel ({x}, {y})");
            let open = all.iter().any(|c| !c.certain);
            if id == NO_ID {
                let sure = all.iter().find(|c| c.certain);
                assert!(sure.is_none(), "{place} of {}: lacks {sure:?}", self.name);
                self.empty(i, &place);
                self.open.count(PROJECTION, open);
                continue;
            }
            if truth.loose.contains(&id) {
                self.open.count(FAR, false);
                continue;
            }
            let may: Vec<_> = all.iter().filter(|c| c.id == id && !c.is_hidden(all)).collect();
            let outcomes = may.iter().map(|c| self.sample(c, i)).collect();
            self.best(outcomes, || format!("{place}, id {id}, candidates {all:?}"));
            let rival = |k: &Candidate<P>| k.id != id && !may.iter().all(|c| c.is_before(k));
            self.open.count(PROJECTION, open || all.iter().any(rival));
        }
    }

    fn empty(&self, i: usize, place: &str) {
        let expected = [0.0, f64::INFINITY, 0.0, 0.0, 0.0, 0.0];
        let names = ["kind", "Z", "extent", "radius", "center.X", "center.Y"];
        let found = names.map(|name| self.number(&format!("projection.{name}"), i));
        assert_eq!(found, expected, "{place} is empty");
        for name in ["projection.normal", "projection.tangent", "projection"] {
            assert_eq!(self.optional(name, i).unwrap_or_default(), [0.0; 3], "{place}");
        }
    }

    fn sample(&self, c: &Candidate<P>, i: usize) -> Vec<Number<P>> {
        let plane = |name: &str| self.value(&format!("projection.{name}"), i);
        let mut all = vec![
            ("projection.kind", Num::exact(c.kind.into()), plane("kind")[0]),
            ("projection.Z", c.t, plane("Z")[0]),
            ("projection.extent", c.extent, plane("extent")[0]),
            ("projection.radius", c.radius, plane("radius")[0]),
            ("projection.center", c.center[0], plane("center.X")[0]),
            ("projection.center", c.center[1], plane("center.Y")[0]),
        ];
        all.extend(vector("projection.normal", c.normal, plane("normal")));
        if let Some(found) = self.optional("projection", i) {
            all.extend(vector("projection", c.color, found));
        }
        if let Some(found) = self.optional("projection.tangent", i) {
            all.extend(vector("projection.tangent", c.tangent, found));
        }
        all
    }
}
