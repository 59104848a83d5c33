//! Mistakes that the wrong pixels show directly, because they have something in common.

use super::epsilon::DEPTHS;
use super::{Case, FEWEST};
use crate::frame::Rect;
use crate::verdict::StageVerdict;

/// The mistake that all wrong pixels of a stage show directly.
pub(super) fn plain(case: &Case<'_, '_>) -> Option<String> {
    let wrong = case.wrong;
    let causes = &wrong.causes;
    let all = |count: u64| count == wrong.wrong;
    if all(causes.nan) {
        return Some(if divides_by_0(case) {
            "a missing guard: pixels without weight are divided by it".into()
        } else {
            format!("NaN in {} of its pixels", causes.nan)
        });
    }
    if all(causes.ties) {
        return Some(
            "ties: the client keeps another of the equally near surfels than it says".into(),
        );
    }
    hole(case)
}

/// A rectangle of pixels in which the client has nothing, and which has all wrong pixels.
fn hole(case: &Case<'_, '_>) -> Option<String> {
    if !matches!(case.wrong.stage, "visibility" | "projection") {
        return None;
    }
    let frame = case.client.frame();
    let depth = DEPTHS.iter().find_map(|name| frame.scalar(name).ok())?;
    let (errors, mut found) = (&case.wrong.errors, None);
    for (i, error) in errors.values().iter().enumerate().filter(|(_, error)| **error > 1.0) {
        let width = errors.width() as usize;
        let pixel = Rect::pixel(((i % width) as u32, (i / width) as u32));
        found = Some(found.map_or(pixel, |found: Rect| found.hull(&pixel)));
        if !(*error > 1.0) || depth.values()[i].is_finite() {
            return None;
        }
    }
    let Rect { x0, y0, x1, y1 } = found?;
    let is_empty = |x, y| depth.at(x, y).is_infinite();
    let empty = (y0..y1).all(|y| (x0..x1).all(|x| is_empty(x, y)));
    let large = x1 - x0 >= LEAST_SIDE && y1 - y0 >= LEAST_SIDE;
    (empty && large).then(|| {
        format!("nothing is drawn in columns {x0} to {} and rows {y0} to {}", x1 - 1, y1 - 1)
    })
}

/// The least side of a rectangle that is called a hole.
const LEAST_SIDE: u32 = 8;

/// Whether the wrong pixels of a stage are all pixels without weight.
fn divides_by_0(case: &Case<'_, '_>) -> bool {
    let frame = case.client.frame();
    let weight = ["attributes.weight", "weight"].iter().find_map(|name| frame.scalar(name).ok());
    weight.is_some_and(|weight| {
        let pixels = || weight.values().iter().zip(case.wrong.errors.values());
        pixels().all(|(weight, error)| (*weight == 0.0) == (*error > 1.0))
    })
}

/// What the wrong pixels of a stage have in common, if no changed rule explains them.
pub(super) fn common(case: &Case<'_, '_>) -> Option<String> {
    let StageVerdict { causes, wrong, .. } = case.wrong;
    let most = |count: u64| 20 * count >= 19 * wrong;
    // Where a surfel is left out, only its weight is missing later. If later stages have many more
    // wrong pixels, the shapes are wrong instead.
    let others = case.verdict.stages.iter().any(|stage| stage.wrong > 3 * wrong);
    if *wrong < FEWEST || !most(causes.lacking()) || others {
        None
    } else if causes.least_rim > 0.999 {
        Some("the cut-off is too small: fragments just inside it are left out".into())
    } else if causes.least_rim > 0.6 {
        Some("quads too small: the missing fragments lie near the rims of their splats".into())
    } else {
        None
    }
}
