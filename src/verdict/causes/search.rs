//! Find a number that a client may have wrong: the value with which its errors are smallest. The
//! farther off a value is, the larger are the errors, so that a search finds the best one.

use super::depths::digits;
use super::numbers::{Number, numbers, numbers_of_camera};
use super::shown::Shown;
use super::{Case, Explanation, FEWEST, MOST_LEFT, Wrong, off_planes, pose};
use crate::error::Result;
use crate::number::Real;

/// How often the interval of the best value is made smaller, by the golden ratio.
const TURNS: usize = 20;
/// The golden ratio's inverse.
const GOLDEN: f64 = 0.618_033_988_749_895;
/// The most steps away from the right value, each twice as large as the one before.
const MOST_STEPS: usize = 9;
/// After so many turns the right number leaves less than this part of the errors.
const LEAST_TURNS: usize = 10;
const LEAST_LEFT: f64 = 0.9;
/// The part of the errors that the first step must take away.
const LEAST_GAIN: f64 = 1e-6;

/// The number with another value that explains most. With `cameras`, it may be one of the camera.
///
/// # Errors
/// As [`crate::method::Session::verify`].
pub(super) fn best(case: &Case<'_, '_>, cameras: bool) -> Result<Option<Explanation>> {
    let mut best: Option<Explanation> = None;
    if case.all.near < FEWEST {
        return Ok(best);
    }
    for number in &numbers(case) {
        keep(case, number, found(case, number)?, &mut best);
        if best.as_ref().is_some_and(|best| best.left.all == 0) {
            return Ok(best);
        }
    }
    if !cameras {
        return Ok(best);
    }
    let cameras = numbers_of_camera(case);
    // Another camera moves splats so far that a few pixels show no way to it, so that each value is
    // tried on the whole part.
    if let Some((number, tried)) = estimated(case, &cameras)?
        && keep(case, number, Some(tried), &mut best)
    {
        return Ok(best);
    }
    for number in &cameras {
        let wrong = |value| number.judge(case, value, case.client);
        keep(case, number, search(number.right, number.step, case.all, false, wrong)?, &mut best);
        if best.as_ref().is_some_and(|best| best.left.all == 0) {
            break;
        }
    }
    Ok(best)
}

/// The number of the camera that the client's pixels show to be wrong, or several numbers, if they
/// explain the wrong pixels.
///
/// # Errors
/// As [`crate::method::Session::verify`].
pub(super) fn of_camera(case: &Case<'_, '_>, shown: &Shown<'_>) -> Result<Option<Explanation>> {
    let (mut best, numbers) = (None, numbers_of_camera(case));
    // Where surfels are right, the camera is.
    if numbers.is_empty() || case.all.near < FEWEST {
        return Ok(best);
    }
    for (number, value) in shown.fit(&numbers) {
        if keep(case, number, near(case, number, value)?, &mut best) {
            return Ok(best);
        }
    }
    pose::fitted(case, shown)
}

/// A value that was fitted, or a shorter one beside it.
fn near(case: &Case<'_, '_>, number: &Number<'_>, value: f64) -> Result<Option<Tried>> {
    let mut wrong = |value| number.judge(case, value, case.client);
    let Some(left) = wrong(value)? else { return Ok(None) };
    let range = 1e-3 * (value - number.right).abs();
    let size = |value, best: &mut _| size(value, best, &mut wrong);
    rounded(number.right, Tried { value, left }, range, size).map(Some)
}

/// The number whose estimate explains most, with the best value near it.
fn estimated<'n, 'c>(
    case: &Case<'_, '_>,
    numbers: &'n [Number<'c>],
) -> Result<Option<(&'n Number<'c>, Tried)>> {
    let mut nearest: Option<(&Number<'_>, Tried)> = None;
    for number in numbers {
        let Some(value) = number.estimate else { continue };
        let Some(left) = number.judge(case, value, case.client)? else { continue };
        if nearest.as_ref().is_none_or(|(_, nearest)| left.size < nearest.left.size) {
            nearest = Some((number, Tried { value, left }));
        }
    }
    let Some((number, tried)) = nearest else { return Ok(None) };
    Ok(Some((number, around(case, number, tried)?)))
}

/// The best value near one that was estimated.
fn around(case: &Case<'_, '_>, number: &Number<'_>, tried: Tried) -> Result<Tried> {
    // The estimate is off by a few hundredths of its distance, or of the first step.
    let range = (0.05 * (tried.value - number.right).abs()).at_least(0.05 * number.step.abs());
    let ends = [tried.value - range, tried.value + range];
    let wrong = |value| number.judge(case, value, case.client);
    narrowed(number.right, ends, tried, case.all, false, wrong)
}

/// Keeps the value of a number if it explains the wrong pixels, and more than the best one; says whether it
/// does.
fn keep(
    case: &Case<'_, '_>,
    number: &Number<'_>,
    tried: Option<Tried>,
    best: &mut Option<Explanation>,
) -> bool {
    let Some(Tried { value, left }) = tried else { return false };
    let least = best.as_ref().is_none_or(|best| left.all < best.left.all);
    if !least || !case.explains(left, MOST_LEFT) {
        return false;
    }
    let Some(change) = (number.change)(value) else { return false };
    let (what, most) = ((number.in_words)(digits(value)), MOST_LEFT);
    *best = Some(Explanation { what, change, most, left });
    true
}

/// A value of a number, and the pixels that stay wrong with it.
#[derive(Clone, Copy)]
struct Tried {
    value: f64,
    left: Wrong,
}

/// The value of a number that explains most, and the pixels that stay wrong.
fn found(case: &Case<'_, '_>, number: &Number<'_>) -> Result<Option<Tried>> {
    let Number { right, step, .. } = *number;
    // No value of these numbers moves the planes of surfels.
    if (number.change)(right + step).is_some_and(|change| off_planes::rejects(case, &change)) {
        return Ok(None);
    }
    let judge = |value: f64, client| number.judge(case, value, client);
    if let Some(value) = number.estimate {
        let Some(tried) = near(case, number, value)? else { return Ok(None) };
        if tried.left.is_hopeless(case.all) || case.explains(tried.left, MOST_LEFT) {
            return Ok(Some(tried));
        }
        return around(case, number, tried).map(Some);
    }
    let in_part = || search(right, step, case.all, false, |value| judge(value, case.client));
    let pilot = case.pilot;
    let Some((pilot, all)) = pilot else { return in_part() };
    let found = search(right, step, all, true, |value| judge(value, pilot))?;
    let found = found.filter(|found| !found.left.is_hopeless(all));
    let Some(Tried { value, .. }) = found else { return Ok(None) };
    let Some(left) = judge(value, case.client)? else { return Ok(None) };
    // What is left here may be wrong for another reason.
    if case.explains(left, 2 * MOST_LEFT) {
        return Ok(Some(Tried { value, left }));
    }
    // The few pixels tell about where the best value is.
    let range = (0.2 * (value - right).abs()).at_least(step.abs());
    let (ends, tried) = ([value - range, value + range], Tried { value, left });
    let wrong = |value| judge(value, case.client);
    let found = narrowed(right, ends, tried, left, false, wrong)?;
    // Where errors grow only close to the best value, it lies between others.
    if case.explains(found.left, MOST_LEFT) { Ok(Some(found)) } else { in_part() }
}

/// The size of the errors with a value. Keeps the value if it is the best one.
fn size(
    value: f64,
    best: &mut Tried,
    wrong: &mut impl FnMut(f64) -> Result<Option<Wrong>>,
) -> Result<f64> {
    let Some(left) = wrong(value)? else { return Ok(f64::INFINITY) };
    if (left.size, left.all) < (best.left.size, best.left.all) {
        *best = Tried { value, left };
    }
    Ok(left.size)
}

/// The value that leaves the smallest errors, and the wrong pixels. None if no value near the right
/// one leaves smaller errors. `all` has the wrong pixels. With `leaves` the search ends early where the
/// errors hardly become smaller.
fn search(
    right: f64,
    step: f64,
    all: Wrong,
    leaves: bool,
    mut wrong: impl FnMut(f64) -> Result<Option<Wrong>>,
) -> Result<Option<Tried>> {
    let mut best = Tried { value: right, left: all };
    let mut size = |value, best: &mut _| size(value, best, &mut wrong);
    let [up, down] = [size(right + step, &mut best)?, size(right - step, &mut best)?];
    let (sign, mut least) = if up <= down { (step, up) } else { (-step, down) };
    if !(least < all.size * (1.0 - LEAST_GAIN)) {
        return Ok(None);
    }
    let (mut before, mut at, mut next) = (right, right + sign, right + 3.0 * sign);
    for turn in 1..MOST_STEPS {
        let own = size(next, &mut best)?;
        if own >= least {
            break;
        }
        (before, at, least) = (at, next, own);
        next = at + sign * f64::from(1_u32 << (turn + 1));
    }
    narrowed(right, [before, next], best, all, leaves, wrong).map(Some)
}

/// The best value between two ends, with the fewest digits.
fn narrowed(
    right: f64,
    [mut low, mut high]: [f64; 2],
    mut best: Tried,
    all: Wrong,
    leaves: bool,
    mut wrong: impl FnMut(f64) -> Result<Option<Wrong>>,
) -> Result<Tried> {
    let mut size = |value, best: &mut _| size(value, best, &mut wrong);
    let inner = |low: f64, high: f64| [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let [mut a, mut b] = inner(low, high);
    let [mut at_a, mut at_b] = [size(a, &mut best)?, size(b, &mut best)?];
    for turn in 0..TURNS {
        if best.left.all == 0 {
            break;
        }
        if leaves && turn == LEAST_TURNS && best.left.size > LEAST_LEFT * all.size {
            return Ok(best);
        }
        if at_a <= at_b {
            (high, b, at_b) = (b, a, at_a);
            a = inner(low, high)[0];
            at_a = size(a, &mut best)?;
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = inner(low, high)[1];
            at_b = size(b, &mut best)?;
        }
    }
    let range = (high - low).abs().at_least(0.01 * right.abs());
    rounded(right, best, range, size)
}

/// The best value, or a shorter one beside it that leaves nothing wrong: people choose short numbers.
fn rounded(
    right: f64,
    mut best: Tried,
    range: f64,
    mut size: impl FnMut(f64, &mut Tried) -> Result<f64>,
) -> Result<Tried> {
    for by in [1.0, 10.0, 100.0, 1000.0] {
        let value = (best.value * by).round() / by;
        if (value - best.value).abs() > range || value == right {
            continue;
        }
        let left = Wrong { near: u64::MAX, all: u64::MAX, size: f64::INFINITY };
        let mut own = Tried { value, left };
        size(value, &mut own)?;
        if own.left.all == 0 || own.left.size < best.left.size {
            best = own;
            break;
        }
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_value_is_found() {
        let off = |value: f64, best: f64| {
            let off = (1e5 * (value - best).abs()).round();
            Wrong { near: off as u64, all: off as u64, size: off }
        };
        for (right, best, step) in [
            (0.25, 0.3, 0.0025),
            (0.25, 0.1, 0.0025),
            (2.0, 2.5, 0.02),
            (2.0, 1.234_567, 0.02),
            (1.0, 0.9, -0.01),
            (0.0, -26.57, 0.1),
        ] {
            let mut asked = 0;
            let found = search(right, step, off(right, best), false, |value| {
                asked += 1;
                Ok(Some(off(value, best)))
            });
            let Tried { value: found, left } = found.unwrap().unwrap();
            assert!((found - best).abs() < 0.01 * step.abs(), "{found}, {left:?}, not {best}");
            assert!(asked < 50, "{asked}");
        }
        let same = off(1.0, 2.0);
        assert!(
            search(2.0, 0.1, same, true, |_| Ok(Some(same))).unwrap().is_none(),
            "another mistake"
        );
    }
}
