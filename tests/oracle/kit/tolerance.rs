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

use Arithmetic::{F32, F64, F64Rounded};

/// The 2+1-pass method.
pub(crate) const EWA: &[Row] = &[
    row("visibility.Z", F32, 4.0, "three roundings of the nearness, one reciprocal"),
    row("visibility.Z", F64, 4.0, "as in f32"),
    row("visibility.Z", F64Rounded, 1.0, "half the range of depth takes the normal for a unit"),
    row("attributes.weight", F32, 4.0, "sqrt and quotients of the conic, exp, one rounding a term"),
    row("attributes.weight", F64, 4.0, "as in f32; the oracle's determinant cancels as much"),
    row(
        "attributes.weight",
        F64Rounded,
        0.5,
        "area takes the normal for a unit, the covariance not",
    ),
    row("attributes.normal", F32, 4.0, "a product more than the weight"),
    row("attributes.normal", F64, 4.0, "as in f32"),
    row("attributes.normal", F64Rounded, 0.5, "as the weight"),
    row("attributes", F32, 4.0, "a product more than the weight"),
    row("attributes", F64, 4.0, "as in f32"),
    row("attributes", F64Rounded, 0.5, "as the weight"),
    row("resolved", F32, 4.0, "errors of sum and weight partly cancel, a quotient rounds"),
    row("resolved", F64, 4.0, "as in f32"),
    row("resolved", F64Rounded, 0.25, "a common factor of the amplitudes cancels"),
    row("Z", F32, 4.0, "the same numbers as visibility.Z"),
    row("Z", F64, 4.0, "the same numbers as visibility.Z"),
    row("Z", F64Rounded, 1.0, "the same numbers as visibility.Z"),
    row("weight", F32, 4.0, "the same numbers as attributes.weight"),
    row("weight", F64, 4.0, "the same numbers as attributes.weight"),
    row("weight", F64Rounded, 0.5, "the same numbers as attributes.weight"),
    row("normal", F32, 2.0, "three components share one condition, the largest"),
    row("normal", F64, 2.0, "as in f32"),
    row("normal", F64Rounded, 0.25, "a common factor of the amplitudes cancels"),
    row("", F32, 4.0, "without lights the resolved colour; else Phong's own condition is larger"),
    row("", F64, 4.0, "as in f32"),
    row("", F64Rounded, 0.25, "as the resolved colour"),
];

/// Algorithm 1: `group` stands for the depth-image of any group.
pub(crate) const SINGLE_PASS: &[Row] = &[
    row("group.Z", F32, 4.0, "as visibility.Z: the same fragment"),
    row("group.Z", F64, 4.0, "as in f32"),
    row("group.Z", F64Rounded, 1.0, "as visibility.Z"),
    row("group.weight", F32, 4.0, "as attributes.weight, of one fragment"),
    row("group.weight", F64, 4.0, "as in f32"),
    row("group.weight", F64Rounded, 0.5, "as attributes.weight"),
    row("group.normal", F32, 4.0, "a product more than the weight"),
    row("group.normal", F64, 4.0, "as in f32"),
    row("group.normal", F64Rounded, 0.5, "as the weight"),
    row("group", F32, 4.0, "a product more than the weight"),
    row("group", F64, 4.0, "as in f32"),
    row("group", F64Rounded, 0.5, "as the weight"),
    row("group.voronoi", F32, 4.0, "the bin is exact; a root, a quotient, and the sum rounds at n"),
    row("group.voronoi", F64, 4.0, "as in f32"),
    row("group.voronoi", F64Rounded, 1.0, "q takes the normal for a unit"),
    row("sums.weight", F32, 4.0, "one rounding more for each group"),
    row("sums.weight", F64, 4.0, "as in f32"),
    row("sums.weight", F64Rounded, 0.5, "as group.weight"),
    row("sums.normal", F32, 4.0, "one rounding more for each group"),
    row("sums.normal", F64, 4.0, "as in f32"),
    row("sums.normal", F64Rounded, 0.5, "as group.weight"),
    row("sums", F32, 4.0, "one rounding more for each group"),
    row("sums", F64, 4.0, "as in f32"),
    row("sums", F64Rounded, 0.5, "as group.weight"),
    row("resolved", F32, 4.0, "errors of sum and weight partly cancel, a quotient rounds"),
    row("resolved", F64, 4.0, "as in f32"),
    row("resolved", F64Rounded, 0.25, "a common factor of the amplitudes cancels"),
    row("Z", F32, 4.0, "the same numbers as group.Z"),
    row("Z", F64, 4.0, "the same numbers as group.Z"),
    row("Z", F64Rounded, 1.0, "the same numbers as group.Z"),
    row("weight", F32, 4.0, "the same numbers as sums.weight"),
    row("weight", F64, 4.0, "the same numbers as sums.weight"),
    row("weight", F64Rounded, 0.5, "the same numbers as sums.weight"),
    row("normal", F32, 2.0, "three components share one condition, the largest"),
    row("normal", F64, 2.0, "as in f32"),
    row("normal", F64Rounded, 0.25, "a common factor of the amplitudes cancels"),
    row("", F32, 4.0, "without lights the resolved colour; else Phong's own condition is larger"),
    row("", F64, 4.0, "as in f32"),
    row("", F64Rounded, 0.25, "as the resolved colour"),
];

/// The worst deviation of each plane in each arithmetic so far.
#[derive(Default)]
pub(crate) struct Measured(pub(crate) BTreeMap<(&'static str, Arithmetic), (f64, String)>);

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

    /// Every complaint: a plane beyond its bound or without a row, a row too loose or unused.
    pub(crate) fn complaints(&self, table: &[Row]) -> Vec<String> {
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
