//! Measure how far a picture is from a reference, e.g. from the truth, in numbers that rank
//! methods.
//!
//! - [`mod@rmse`]: RMSE and PSNR of colours.
//! - [`mod@ssim`]: structural similarity of colours \[WBSS04\].
//! - [`mod@flip`]: how visible the difference is \[ANA+20\].
//! - [`mod@coverage`]: holes and spill, by regions of the covered pixels.
//! - [`mod@visible`]: pixels inside the surface that are visibly off.
//! - [`mod@outline`]: the length of the silhouette.
//! - [`mod@depth`], [`mod@normal`]: errors of the surface in the pixels that both pictures cover.
//! - [`mod@flicker`]: errors of a sequence that are not constant, and their spectrum.
//! - [`mod@errors`]: all errors of one picture against its truth, and the table of their names and
//!   units.
//!
//! To learn whether a picture is right, use [`super::compare`]: a metric only ranks methods. Every
//! number is f64. A sum runs row by row from the top left, the rows one after the other.
//!
//! `Decided:` RMSE, PSNR and SSIM use the values as stored. For pictures these are linear and not
//! clipped, with a peak of 1, so a value that a display would clip counts in full. A NaN or an
//! infinity in a plane makes each of these three numbers NaN or infinite. The page of each other
//! metric says how it treats them.

pub mod coverage;
pub mod depth;
pub mod errors;
pub mod flicker;
pub mod flip;
pub mod normal;
pub mod outline;
pub mod rmse;
pub mod ssim;
mod summary;
pub mod visible;

pub use coverage::{Coverage, Region, coverage, regions};
pub use depth::{DepthError, depth};
pub use errors::{Better, Errors, METRICS, Metric};
pub use flicker::{Flicker, Spectrum};
pub use flip::{Flip, flip};
pub use normal::{NormalError, normal};
pub use outline::outline;
pub use rmse::{psnr, rmse};
pub use ssim::{hierarchical_ssim, ssim, ssim_map};
pub use summary::{Summary, summary};
pub use visible::visible;

use crate::error::{Error, Result};
use crate::frame::Plane;

/// Fails unless two planes have the same size.
fn same_size<A, B>(picture: &Plane<A>, reference: &Plane<B>) -> Result<()> {
    let [size, other] =
        [(picture.width(), picture.height()), (reference.width(), reference.height())];
    if size == other {
        return Ok(());
    }
    Err(Error::Invalid(format!(
        "a picture of {} x {} pixels and a reference of {} x {}; give two of one size",
        size.0, size.1, other.0, other.1
    )))
}

/// The number of an ascending list that `percent` of the numbers do not exceed: the one at ceil(n
/// percent/100), counted from 1. None for an empty list.
fn percentile(ascending: &[f64], percent: usize) -> Option<f64> {
    let rank = (ascending.len() * percent).div_ceil(100);
    ascending.get(rank.saturating_sub(1)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn plane(width: usize, height: usize, of: impl Fn(usize, usize) -> f32) -> Vec<f32> {
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| of(x, y)).collect()
    }

    pub(super) fn pattern(x: usize, y: usize) -> f32 {
        ((x * x * 7 + y * 13 + x * y * 3) % 256) as f32 / 256.0
    }

    pub(super) fn ramp(x: usize, y: usize) -> f32 {
        ((x * 4 + y * 2) % 256) as f32 / 256.0
    }

    pub(super) fn noisy(x: usize, y: usize) -> f32 {
        0.75 * ramp(x, y) + ((x * 31 + y * 17) % 64) as f32 / 256.0
    }

    #[test]
    fn percentiles_are_numbers_of_the_list() {
        let hundred: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!(percentile(&hundred, 99), Some(99.0));
        assert_eq!(percentile(&hundred, 100), Some(100.0));
        assert_eq!(percentile(&hundred[..3], 50), Some(2.0));
        assert_eq!(percentile(&hundred[..3], 99), Some(3.0));
        assert_eq!(percentile(&hundred[..1], 0), Some(1.0));
        assert_eq!(percentile(&[], 99), None);
    }

    #[test]
    fn sizes_are_one_clear_line() {
        let (a, b) = (Plane::filled(3, 2, 0.0), Plane::filled(2, 3, 0.0));
        assert!(same_size(&a, &a).is_ok());
        let said = same_size(&a, &b).unwrap_err().to_string();
        assert_eq!(
            said,
            "a picture of 3 x 2 pixels and a reference of 2 x 3; give two of one size"
        );
    }
}
