//! How far each plane may be from the oracle, and why.
//!
//! The unit is the **condition** of the value at that pixel: by how much the oracle's value
//! changes, summed over all inputs of all surfels that the pixel sees, when each input moves by the
//! rounding of the arithmetic (2^-24 of its magnitude for `f32`, 2^-53 for `f64`). A backward
//! stable formula stays within a small number of conditions however thin, near or grazing a splat
//! is, so one number a row holds for every scene. A row that is 16 times looser than what all
//! scenes together show fails: it must be tightened.

use std::collections::BTreeMap;

/// The arithmetic that is tested, and how well the scene's input is known to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Arithmetic {
    /// `f32`, plain and fast.
    F32,
    /// `f64` on scenes whose normals have length 1 exactly.
    F64,
    /// `f64` on scenes whose normals and view matrix were rounded to `f32`: a unit normal is then
    /// an assumption that is wrong by 2^-24, and formulas that use it differently differ by that.
    F64Rounded,
}

impl Arithmetic {
    /// The step in which conditions are measured, and the rounding in units of it. Steps below
    /// 2^-40 would drown in the oracle's own rounding.
    pub(crate) fn step(self) -> (f64, f64) {
        match self {
            Self::F32 | Self::F64Rounded => ((-24.0_f64).exp2(), 1.0),
            Self::F64 => ((-40.0_f64).exp2(), (-13.0_f64).exp2()),
        }
    }
}

/// A bound in conditions.
pub(crate) struct Row {
    pub(crate) plane: &'static str,
    pub(crate) arithmetic: Arithmetic,
    pub(crate) bound: f64,
    pub(crate) reason: &'static str,
}

pub(crate) const fn row(
    plane: &'static str,
    arithmetic: Arithmetic,
    bound: f64,
    reason: &'static str,
) -> Row {
    Row { plane, arithmetic, bound, reason }
}

/// The worst deviation of each plane in each arithmetic so far.
#[derive(Default)]
pub(crate) struct Measured(BTreeMap<(&'static str, Arithmetic), (f64, String)>);

impl Measured {
    pub(crate) fn add(
        &mut self,
        plane: &'static str,
        arithmetic: Arithmetic,
        deviation: f64,
        place: impl FnOnce() -> String,
    ) {
        let entry = self.0.entry((plane, arithmetic)).or_insert((0.0, String::new()));
        if !(deviation <= entry.0) {
            *entry = (deviation, place());
        }
    }

    /// Prints what was measured, and asserts that there is no complaint.
    pub(crate) fn check(&self, table: &[Row]) {
        for (key, (worst, place)) in &self.0 {
            println!("{key:?}: {worst:.3e} {place}");
        }
        let complaints = self.complaints(table);
        assert!(complaints.is_empty(), "{}", complaints.join("\n"));
    }

    /// As [`Self::check`], of scenes that need not reach all that the table has.
    pub(crate) fn within(&self, table: &[Row]) {
        for (&(plane, arithmetic), (worst, place)) in &self.0 {
            let row = table.iter().find(|r| r.plane == plane && r.arithmetic == arithmetic);
            let bound = row.map_or(0.0, |r| r.bound);
            assert!(*worst <= bound, "plane '{plane}', {arithmetic:?}: {worst:.3} at {place}");
        }
    }

    /// Every complaint: a plane beyond its bound or without a row, a row too loose or unused.
    fn complaints(&self, table: &[Row]) -> Vec<String> {
        let mut all = Vec::new();
        for (&(plane, arithmetic), (worst, place)) in &self.0 {
            let row = table.iter().find(|r| r.plane == plane && r.arithmetic == arithmetic);
            let name = format!("plane '{plane}', {arithmetic:?}: worst {worst:.3} at {place}");
            match row {
                None => all.push(format!("{name}: no row in the table")),
                Some(r) if !(*worst <= r.bound) => {
                    all.push(format!("{name}: beyond the bound {} ({})", r.bound, r.reason));
                }
                Some(r) if r.bound > 16.0 * worst => {
                    all.push(format!("{name}: the row's bound {} can be tightened", r.bound));
                }
                Some(_) => {}
            }
        }
        for r in table {
            if !self.0.contains_key(&(r.plane, r.arithmetic)) {
                all.push(format!("row '{}', {:?}: nothing was measured", r.plane, r.arithmetic));
            }
        }
        all
    }
}
