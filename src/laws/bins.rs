//! Laws of low-precision and Voronoi-enhanced depth \[ZP06, eq. 6 and 10\].
//!
//! The operators are `bin(range, depth)` and `voronoi(range, depth, ratio)`. Both return units of a
//! bin.

use super::inputs::{CASES, Inputs};
use super::{Lawful, law};
use crate::composite::bins::{MAX_BINS, Range};
use crate::number::Exact;

/// Tries the laws of [`one`] and [`pair`] at ranges of every size, from one bin to the largest
/// number of bins.
///
/// # Errors
/// The first counterexample.
pub fn bins<R: Exact>(
    bin: &impl Fn(&Range, R) -> R,
    voronoi: &impl Fn(&Range, R, R) -> R,
) -> Lawful {
    let mut inputs = Inputs::new(5);
    for _ in 0..CASES {
        let nearest: f32 = inputs.between(0.01, 10.0);
        let extent: f32 = inputs.between(0.1, 10.0);
        let count = match inputs.below(4) {
            0 => inputs.of(&[1, 2, 255, 256, MAX_BINS]),
            _ => 1 + inputs.below(MAX_BINS as usize) as u32,
        };
        let range = Range { nearest, farthest: nearest + extent, count };
        let low: R = inputs.between(nearest, nearest + extent);
        // The two depths are close together, so that many pairs lie on either side of the end of a
        // bin.
        let step = inputs.between::<R>(0.0, 3.0) * R::from_f32(extent / count as f32);
        let far = inputs.between(0.0, 30.0);
        let ratios = [inputs.between(0.0, 1.25), R::from_f32(inputs.of(&[0.0, 1.0, 1e-40]))];
        one(bin, voronoi, &range, low, ratios)?;
        one(bin, voronoi, &range, far, ratios)?;
        pair(bin, voronoi, &range, [low, low + step], ratios)?;
        pair(bin, voronoi, &range, [low, far], ratios)?;
    }
    Ok(())
}

/// The laws of one depth t >= 0: its bin, and its Voronoi-enhanced depths for ratios >= 0.
///
/// - A bin is an integer in \[0, n\]. The nearest depth and all depths before it are in bin 0. The
///   farthest depth and all depths behind it are in bin n.
/// - A depth inside the range is in the bin of its position `(t - d_min) / (d_max - d_min) n`,
///   which rounding may move by 2^-5.
/// - The Voronoi-enhanced depth lies between its bin and 255/256 above its bin. It never falls as
///   the ratio grows, and it no longer grows from 255/256 on.
///
/// # Errors
/// The first counterexample.
pub fn one<R: Exact>(
    bin: &impl Fn(&Range, R) -> R,
    voronoi: &impl Fn(&Range, R, R) -> R,
    range: &Range,
    t: R,
    ratios: [R; 2],
) -> Lawful {
    let inputs = format_args!("t = {t:?}, ratios {ratios:?} in {range:?}");
    let n = R::from_f32(range.count as f32);
    let found = bin(range, t);
    let whole = R::ZERO <= found && found <= n && found.floor() == found;
    law("a bin is an integer in [0, n]", whole, &inputs, &format_args!("one of these"), &found)?;
    let [low, high] = [range.nearest, range.farthest].map(R::from_f32);
    let ends = [bin(range, low), bin(range, high)];
    law(
        "the ends are in the first and the last bin",
        ends == [R::ZERO, n],
        &inputs,
        &[R::ZERO, n],
        &ends,
    )?;
    if low <= t && t <= high {
        let [t, low, high] = [t, low, high].map(R::to_f64);
        let position = (t - low) / (high - low) * f64::from(range.count);
        let (found, slack) = (found.to_f64(), 1.0 / 32.0);
        let holds = found <= position + slack && position - slack < found + 1.0;
        law("a depth is in the bin of its position", holds, &inputs, &position, &found)?;
    } else {
        let end = if t < low { R::ZERO } else { n };
        law("a depth beyond an end is in its bin", found == end, &inputs, &end, &found)?;
    }
    let most = R::from_f32(255.0 / 256.0);
    let (small, large) =
        if ratios[0] < ratios[1] { (ratios[0], ratios[1]) } else { (ratios[1], ratios[0]) };
    let z = [small, large, most, R::INFINITY].map(|ratio| voronoi(range, t, ratio));
    let inside = z.iter().all(|z| found <= *z && *z <= found + most);
    let bounds = [found, found + most];
    law("a Voronoi-enhanced depth lies in its bin", inside, &inputs, &bounds, &z)?;
    law("it never falls as the ratio grows", z[0] <= z[1], &inputs, &z[1], &z[0])?;
    law("it no longer grows from 255/256 on", z[2] == z[3], &inputs, &z[2], &z[3])
}

/// The laws of two depths >= 0, with a ratio each.
///
/// - The bin never falls as depth grows.
/// - Depths in the range that differ by at least `(1 + 2^-5) (d_max - d_min) / n` are in different
///   bins. Their Voronoi-enhanced depths are then in the same order, whatever the ratios.
///
/// # Errors
/// The first counterexample.
pub fn pair<R: Exact>(
    bin: &impl Fn(&Range, R) -> R,
    voronoi: &impl Fn(&Range, R, R) -> R,
    range: &Range,
    depths: [R; 2],
    ratios: [R; 2],
) -> Lawful {
    let [a, b] = if depths[0] < depths[1] { depths } else { [depths[1], depths[0]] };
    let inputs = format_args!("the depths {a:?} and {b:?}, ratios {ratios:?} in {range:?}");
    let found = [bin(range, a), bin(range, b)];
    let expected = format_args!("ascending");
    law("a bin never falls as depth grows", found[0] <= found[1], &inputs, &expected, &found)?;
    let [low, high] = [range.nearest, range.farthest].map(f64::from);
    let apart = (high - low) / f64::from(range.count) * (1.0 + 1.0 / 32.0);
    if low <= a.to_f64() && b.to_f64() <= high && b.to_f64() - a.to_f64() >= apart {
        let what = "depths that differ by a bin are told apart";
        law(what, found[0] < found[1], &inputs, &format_args!("different bins"), &found)?;
        let z = [voronoi(range, a, ratios[0]), voronoi(range, b, ratios[1])];
        let what = "in different bins depth decides, not the ratio";
        law(what, z[0] < z[1], &inputs, &expected, &z)?;
    }
    Ok(())
}
