//! Normalization: turn sums into averages and directions.

use super::attributes::Sums;
use super::visibility::Foremost;
use crate::composite::sum;
use crate::method::clock::{Work, spend};
use crate::method::surface::SurfacePixel;
use crate::number::Exact;

/// The surface at one pixel: depth of the nearest fragment; colour = sum / weight; normal =
/// direction of sum / weight.
pub(crate) fn resolve<R: Exact>(nearest: &Foremost<R>, sums: &Sums<R>) -> SurfacePixel<R> {
    spend(Work::Normalize);
    SurfacePixel {
        depth: nearest.depth,
        id: nearest.id,
        weight: sums.weight,
        normal: sum::direction(sums.normal, sums.weight),
        color: sum::average(sums.color, sums.weight),
    }
}
