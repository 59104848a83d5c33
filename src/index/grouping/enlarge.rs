//! Extension (2): enlarge the radii of a group until it covers the surface \[ZP06, section 4.2.2\].

use super::scales::Scales;
use crate::error::Result;

/// The largest factor on radii.
pub const MAX_SCALE: f32 = 8.0;
/// The most steps of the iteration.
pub const MAX_STEPS: u32 = 64;
/// The iteration ends when a step changes the scale by at most this part of it: 2^-9.
pub const SMALL_STEP: f32 = 1.0 / 512.0;

/// The result of the iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Enlarged {
    pub(super) scale: f32,
    pub(super) converged: bool,
}

/// Iterates eq. 9 for a group. `target` is A divided by pi, and `area_at_1` and `sum_at_1` are the
/// result of [`Scales::area`] at scale 1.
pub(super) fn enlarged(
    group: &mut Scales<'_>,
    area_at_1: f64,
    sum_at_1: f64,
    target: f64,
) -> Result<Enlarged> {
    let mut scale = 1.0;
    for step in 0..MAX_STEPS {
        let (area, sum) = if step == 0 { (area_at_1, sum_at_1) } else { group.area(scale)? };
        let square = scale * scale;
        let next = ((target + square * (sum - area)) / sum).sqrt();
        // NaN fails this comparison.
        if !(next < f64::from(MAX_SCALE)) {
            return Ok(Enlarged { scale: MAX_SCALE, converged: false });
        }
        let next = if next < 1.0 { 1.0 } else { next };
        let step = (next - scale).abs();
        scale = next;
        if step <= f64::from(SMALL_STEP) * scale {
            return Ok(Enlarged { scale: scale as f32, converged: true });
        }
    }
    Ok(Enlarged { scale: scale as f32, converged: false })
}
