//! Laws of low-precision and Voronoi-enhanced depth \[ZP06, eq. 6 and 10\].
//!
//! The operators are `bin(range, depth)` and `voronoi(range, depth, ratio)`. Both return units of a
//! bin.

use super::search::search;
use super::{Kind, Law, Lawful, law};
use crate::composite::bins::{MAX_BINS, Range};
use crate::number::Exact;

/// Tries the laws of [`one`], [`pair`], [`clamped`] and [`infinite`] at ranges of every size, from
/// one bin to the largest number of bins.
///
/// # Errors
/// The first counterexample.
pub fn bins<R: Exact>(
    bin: &impl Fn(&Range, R) -> R,
    voronoi: &impl Fn(&Range, R, R) -> R,
) -> Lawful {
    of_kinds(&Kind::ALL, bin, voronoi)
}

/// Tries the laws of these kinds.
///
/// # Errors
/// The first counterexample.
pub fn of_kinds<R: Exact>(
    kinds: &[Kind],
    bin: &impl Fn(&Range, R) -> R,
    voronoi: &impl Fn(&Range, R, R) -> R,
) -> Lawful {
    search(5, kinds, &|inputs, asked| {
        let (nearest, extent) = (inputs.scaled::<f32>(), inputs.scaled::<f32>());
        let count = match inputs.below(4) {
            0 => inputs.of(&[1, 2, 255, 256, MAX_BINS]),
            _ => 1 + inputs.below(MAX_BINS as usize) as u32,
        };
        let range = Range { nearest, farthest: nearest + extent, count };
        let low: R = inputs.between(nearest, nearest + extent);
        // The two depths are close together, so that many pairs lie on either side of the end of a
        // bin.
        let step = inputs.between::<R>(0.0, 3.0) * R::from_f32(extent / count as f32);
        let far = inputs.between(0.0, 40.0);
        let ratios = [inputs.ratio(), inputs.ratio()];
        for t in [low, far] {
            asked.check(Kind::Algebraic, || one(bin, voronoi, &range, t, ratios))?;
            asked.check(Kind::Exact, || clamped(voronoi, &range, t))?;
            asked.check(Kind::Odd, || infinite(voronoi, &range, t))?;
        }
        asked.check(Kind::Algebraic, || pair(bin, voronoi, &range, [low, low + step], ratios))?;
        asked.check(Kind::Algebraic, || pair(bin, voronoi, &range, [low, far], ratios))
    })
}

const WHOLE: Law = Law::algebraic(
    "a bin is an integer in [0, n]",
    "a depth that is stored in few bits, without a wrap",
);
const ENDS: Law = Law::algebraic(
    "the ends are in the first and the last bin",
    "the nearest and the farthest surfels of a group",
);
const POSITION: Law = Law::algebraic(
    "a depth is in the bin of its position",
    "which of two surfels is in front, where they differ by more than a bin",
);
const BEYOND: Law = Law::algebraic(
    "a depth beyond an end is in its bin",
    "fragments before or behind the range, which no wrap may bring to the other end",
);
const INSIDE: Law = Law::algebraic(
    "a Voronoi-enhanced depth lies in its bin",
    "the ratio never hides a surfel of a nearer bin",
);
const RISES: Law = Law::algebraic(
    "it never falls as the ratio grows",
    "between surfels of one bin, the boundary that lies where the ratios are equal",
);
const CLAMPED: Law = Law::exact(
    "it no longer grows from 255/256 on",
    "fragments at the rim, whose ratio a rounding may take beyond 1",
);
const INFINITE: Law = Law::odd(
    "an infinite ratio is as the greatest",
    "fragments of a disc that is seen edge-on, whose ratio has overflowed",
);
const FALLS: Law =
    Law::algebraic("a bin never falls as depth grows", "which of two surfels is in front");
const APART: Law = Law::algebraic(
    "depths that differ by a bin are told apart",
    "which of two surfels is in front, where they differ by more than a bin",
);
const DECIDES: Law = Law::algebraic(
    "in different bins depth decides, not the ratio",
    "the ratio never shows a surfel through a nearer one",
);

/// The algebraic laws of one depth t >= 0: its bin, and its Voronoi-enhanced depths for ratios >= 0.
///
/// - A bin is an integer in \[0, n\]. The nearest depth and all depths before it are in bin 0. The
///   farthest depth and all depths behind it are in bin n.
/// - A depth inside the range is in the bin of its position `(t - d_min) / (d_max - d_min) n`,
///   which rounding may move by 2^-5.
/// - The Voronoi-enhanced depth lies between its bin and 255/256 above its bin. It never falls as
///   the ratio grows.
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
    law(&WHOLE, whole, &inputs, &format_args!("one of these"), &found)?;
    let [low, high] = [range.nearest, range.farthest].map(R::from_f32);
    let ends = [bin(range, low), bin(range, high)];
    law(&ENDS, ends == [R::ZERO, n], &inputs, &[R::ZERO, n], &ends)?;
    if low <= t && t <= high {
        let [t, low, high] = [t, low, high].map(R::to_f64);
        let position = (t - low) / (high - low) * f64::from(range.count);
        let (found, slack) = (found.to_f64(), 1.0 / 32.0);
        let holds = found <= position + slack && position - slack < found + 1.0;
        law(&POSITION, holds, &inputs, &position, &found)?;
    } else {
        let end = if t < low { R::ZERO } else { n };
        law(&BEYOND, found == end, &inputs, &end, &found)?;
    }
    let most = R::from_f32(255.0 / 256.0);
    let (small, large) =
        if ratios[0] < ratios[1] { (ratios[0], ratios[1]) } else { (ratios[1], ratios[0]) };
    let z = [small, large, most].map(|ratio| voronoi(range, t, ratio));
    let inside = z.iter().all(|z| found <= *z && *z <= found + most);
    let bounds = [found, found + most];
    law(&INSIDE, inside, &inputs, &bounds, &z)?;
    law(&RISES, z[0] <= z[1], &inputs, &z[1], &z[0])
}

/// Exact law: a Voronoi-enhanced depth no longer grows from a ratio of 255/256 on.
///
/// # Errors
/// The counterexample.
pub fn clamped<R: Exact>(voronoi: &impl Fn(&Range, R, R) -> R, range: &Range, t: R) -> Lawful {
    stays(&CLAMPED, voronoi, range, t, R::from_f32(2.0))
}

/// A law of odd inputs: an infinite ratio is as 255/256.
///
/// # Errors
/// The counterexample.
pub fn infinite<R: Exact>(voronoi: &impl Fn(&Range, R, R) -> R, range: &Range, t: R) -> Lawful {
    stays(&INFINITE, voronoi, range, t, R::INFINITY)
}

/// Returns a counterexample unless this ratio gives the depth of 255/256.
fn stays<R: Exact>(
    what: &Law,
    voronoi: &impl Fn(&Range, R, R) -> R,
    range: &Range,
    t: R,
    ratio: R,
) -> Lawful {
    let expected = voronoi(range, t, R::from_f32(255.0 / 256.0));
    let found = voronoi(range, t, ratio);
    let inputs = format_args!("t = {t:?}, ratio = {ratio:?} in {range:?}");
    law(what, found == expected, &inputs, &expected, &found)
}

/// The algebraic laws of two depths >= 0, with a ratio each.
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
    law(&FALLS, found[0] <= found[1], &inputs, &expected, &found)?;
    let [low, high] = [range.nearest, range.farthest].map(f64::from);
    let apart = (high - low) / f64::from(range.count) * (1.0 + 1.0 / 32.0);
    if low <= a.to_f64() && b.to_f64() <= high && b.to_f64() - a.to_f64() >= apart {
        law(&APART, found[0] < found[1], &inputs, &format_args!("different bins"), &found)?;
        let z = [voronoi(range, a, ratios[0]), voronoi(range, b, ratios[1])];
        law(&DECIDES, z[0] < z[1], &inputs, &expected, &z)?;
    }
    Ok(())
}
