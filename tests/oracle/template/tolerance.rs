//! How far each plane of the reconstruction with templates may be from the oracle, and why.
//!
//! The unit is the running error bound of [`crate::oracle::kit::number`]: the sum of all roundings on the
//! way, which the same operations cannot exceed. In f64 the oracle rounds as the documentation says,
//! so that no bit may differ, but in exponentials and the power of Phong's formula.

use crate::oracle::kit::tolerance::Arithmetic::{F32, F64};
use crate::oracle::kit::tolerance::{Row, row};

const SAME: &str = "the documented operations in the documented order";

const EXP: &str = "std's exp is off by a unit or so, the rest is the same";

const COPIED: &str = "given, not computed";

pub(crate) const TEMPLATE: &[Row] = &[
    row("projection.kind", F32, 0.0, COPIED),
    row("projection.kind", F64, 0.0, COPIED),
    row("projection.radius", F32, 0.0, COPIED),
    row("projection.radius", F64, 0.0, COPIED),
    row("projection", F32, 0.0, COPIED),
    row("projection", F64, 0.0, COPIED),
    row("projection.Z", F32, 1.0, "a row of the view matrix"),
    row("projection.Z", F64, 0.0, SAME),
    row("projection.normal", F32, 1.0, "a row of the view matrix"),
    row("projection.normal", F64, 0.0, SAME),
    row("projection.extent", F32, 1.0, "a root, three products, and a quotient by a depth"),
    row("projection.extent", F64, 0.0, SAME),
    row("projection.center", F32, 1.0, "two rows of the view matrix, a quotient, a product, a sum"),
    row("projection.center", F64, 0.0, SAME),
    row("level.Z", F32, 1.0, "up to three sums, and a quotient where there are three"),
    row("level.Z", F64, 0.0, SAME),
    row("level.radius", F32, 1.0, "as level.Z"),
    row("level.radius", F64, 0.0, SAME),
    row("level.extent", F32, 1.0, "as level.Z"),
    row("level.extent", F64, 0.0, SAME),
    row("level.center", F32, 1.0, "as level.Z"),
    row("level.center", F64, 0.0, SAME),
    row("level.normal", F32, 1.0, "as level.Z"),
    row("level.normal", F64, 0.0, SAME),
    row("level", F32, 1.0, "as level.Z"),
    row("level", F64, 0.0, SAME),
    row(
        "gathered.weight",
        F32,
        1.0,
        "the form, a quotient, a root, a difference, one sum a centre",
    ),
    row("gathered.weight", F64, 0.0, SAME),
    row("gathered.depths", F32, 1.0, "a product more than the weight"),
    row("gathered.depths", F64, 0.0, SAME),
    row("gathered.normal", F32, 1.0, "a product more than the weight"),
    row("gathered.normal", F64, 0.0, SAME),
    row("gathered", F32, 1.0, "a product more than the weight"),
    row("gathered", F64, 0.0, SAME),
    row("gaussian.weight", F32, 1.0, "the form, a quotient, an exponential, one sum a centre"),
    row("gaussian.weight", F64, 0.5, EXP),
    row("gaussian.depths", F32, 1.0, "a product more than the weight"),
    row("gaussian.depths", F64, 0.5, EXP),
    row("gaussian.normal", F32, 1.0, "a product more than the weight"),
    row("gaussian.normal", F64, 0.5, EXP),
    row("gaussian", F32, 1.0, "a product more than the weight"),
    row("gaussian", F64, 0.5, EXP),
    row("Z", F32, 1.0, "one quotient"),
    row("Z", F64, 0.0, SAME),
    row("normal", F32, 1.0, "a quotient, a column of the view matrix, a length, a quotient"),
    row("normal", F64, 0.0, SAME),
    row("", F32, 1.0, "a quotient, then Phong's sums and products"),
    row("", F64, 0.5, "std's pow is off by a unit or so, the rest is the same"),
];
