//! Numbers that are coarser than the client says. These widen what is allowed, so they are tried
//! last, and only where many pixels are wrong.

use super::change::Change;
use super::mistakes::SUMS;
use super::{Case, Explanation, FEWEST, MOST_LEFT_WIDENED, Mistakes, Wrong};
use crate::error::Result;
use crate::verdict::client::{Rounding, Storage};
use crate::verdict::supposed::Supposed;

/// Mistakes that make sums and weights coarser.
pub(super) fn mistakes(case: &Case<'_, '_>) -> Mistakes {
    let mut all = Mistakes::new();
    if !case.stages.iter().any(|stage| SUMS.contains(stage)) || !case.is_one_in(2) {
        return all;
    }
    if case.client.sums_are(|value| ((value * 255.0).round() - value * 255.0).abs() < 1e-3) {
        let steps = Storage::Steps(1.0 / 255.0);
        all.push(("sums in 8 bits".into(), Change::Accumulator(steps)));
    }
    let parts = (8..17).rev().map(|bits| 1.0 / f64::from(1_u32 << bits));
    all.extend(parts.map(|part| {
        let what = format!("a coarse `exp`: weights are up to {part:.0e} off");
        (what, Change::Supposed(Supposed::CoarseExp(part)))
    }));
    all
}

/// Sums that a weaker promise grants. Decisions that this promise leaves open explain nothing.
///
/// # Errors
/// As [`crate::method::Session::verify`].
pub(super) fn promised(case: &Case<'_, '_>) -> Result<Option<Explanation>> {
    let weaker: &[(Rounding, &str)] = match case.client.rounding {
        Rounding::Ieee => &[
            (Rounding::Precise, "a coarse `exp`, quotient or root: `--promise precise` grants it"),
            (Rounding::Gpu, "sums in another order: `--promise gpu` grants it"),
        ],
        Rounding::Precise => &[(Rounding::Gpu, "sums in another order: `--promise gpu` grants it")],
        Rounding::Gpu => &[],
    };
    if !SUMS.contains(&case.wrong.stage) || case.all.near < FEWEST {
        return Ok(None);
    }
    for (rounding, what) in weaker {
        let change = Change::Rounding(*rounding);
        let budget = case.verdict.budget;
        let found = change.judge(case.session, case.camera, case.client, budget)?;
        let Some(found) = found else { continue };
        let Some(stage) = found.stages.iter().find(|own| own.stage == case.wrong.stage) else {
            continue;
        };
        let now = stage.errors.values().iter().zip(stage.doubts.values());
        let both = case.wrong.errors.values().iter().zip(now);
        let wrong = both.filter(|(before, _)| **before > 1.0);
        let open = wrong.filter(|(_, (error, doubts))| **error > 1.0 || **doubts != 0).count();
        let later = Wrong::of(&found, case.wrong.stage);
        let left = Wrong { near: open as u64, all: later.all.max(open as u64), ..later };
        if case.explains(left, MOST_LEFT_WIDENED) {
            let (what, most) = ((*what).to_owned(), MOST_LEFT_WIDENED);
            return Ok(Some(Explanation { what, change, most, left }));
        }
    }
    Ok(None)
}
