//! Find a number that a client may have wrong: the value with which the fewest pixels are wrong. The
//! farther off a value is, the more pixels are wrong, so that a search finds the best one.

use super::depths::digits;
use super::{Change, wrong_of};
use crate::error::Result;
use crate::method::Session;
use crate::number::Real;
use crate::scene::Camera;
use crate::setting::{Fields, Value};
use crate::verdict::Verdict;
use crate::verdict::client::Client;

/// The factors of the first steps, the large one first: a number may be off by less than half of it.
const FIRST_STEPS: [f64; 2] = [1.1, 1.01];
/// The most steps away from the right value.
const STEPS: usize = 24;
/// How often the interval of the best value is made smaller, by the golden ratio.
const TURNS: usize = 18;
/// The golden ratio's inverse.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// A number that is searched: its right value, how it is changed, and the mistake in words.
struct Number<'a> {
    right: f64,
    change: Box<dyn Fn(f64) -> Option<Change> + 'a>,
    in_words: fn(f64, f64) -> String,
}

/// The numbers that change visibility.
fn numbers<'a>(session: &'a Session<'_>, camera: &'a Camera) -> Vec<Number<'a>> {
    let setting = |name: &'static str, in_words| {
        let own = session.method().values().into_iter().find(|(own, _)| *own == name)?.1;
        let Value::Number(right) = own else { return None };
        let change = move |value: f64| {
            let mut changed = *session.method();
            changed.set(name, &Value::Number(value as f32)).ok()?;
            changed.check().is_ok().then_some(Change::Method(changed))
        };
        (right > 0.0).then(|| Number { right: right.into(), change: Box::new(change), in_words })
    };
    let low_pass = setting("low_pass", |found, right| {
        format!("the low-pass filter has another variance: {found} px^2, not {right}")
    });
    let cutoff = setting("cutoff", |found, right| format!("the cut-off is {found}, not {right}"));
    let focal = Number {
        right: camera.fy.into(),
        change: Box::new(|value| {
            let by = (value / f64::from(camera.fy)) as f32;
            let camera = Camera { fx: camera.fx * by, fy: value as f32, ..*camera };
            Some(Change::Camera(camera))
        }),
        in_words: |found, right| {
            let right = digits(right);
            format!("another field of view: the focal length is {found} px, not {right}")
        },
    };
    [low_pass, cutoff, Some(focal)].into_iter().flatten().collect()
}

/// The number with another value that explains most: the wrong pixels that it leaves, and the
/// mistake in words. `all` are the wrong pixels as [`wrong_of`] counts them.
///
/// # Errors
/// As [`Session::verify`].
pub(super) fn best(
    session: &Session<'_>,
    camera: &Camera,
    client: &Client,
    (stage, verdict): (&str, &Verdict),
) -> Result<Option<(u64, String)>> {
    let all = wrong_of(verdict, stage);
    let mut best: Option<(u64, String)> = None;
    for number in numbers(session, camera) {
        let wrong = |value: f64| -> Result<[u64; 2]> {
            let Some(change) = (number.change)(value) else { return Ok([u64::MAX; 2]) };
            let judged = change.judge(session, camera, client, verdict.budget)?;
            Ok(judged.map_or([u64::MAX; 2], |verdict| wrong_of(&verdict, stage)))
        };
        let Some((value, [cured, left])) = search(number.right, all, wrong)? else { continue };
        if 5 * cured <= all[0] && best.as_ref().is_none_or(|(least, _)| left < *least) {
            best = Some((left, (number.in_words)(digits(value), number.right)));
        }
    }
    Ok(best)
}

/// The value that leaves the fewest wrong pixels, and how many. None if no value near the right one
/// leaves fewer than `all`.
fn search(
    right: f64,
    all: [u64; 2],
    mut wrong: impl FnMut(f64) -> Result<[u64; 2]>,
) -> Result<Option<(f64, [u64; 2])>> {
    let mut found = None;
    for step in FIRST_STEPS {
        let [up, down] = [wrong(right * step)?, wrong(right / step)?];
        if up.min(down) < all {
            found = Some((if up <= down { step } else { 1.0 / step }, [up, down]));
            break;
        }
    }
    let Some((factor, [up, down])) = found else { return Ok(None) };
    let (mut before, mut at, mut least) = (right, right * factor, up.min(down));
    for _ in 0..STEPS {
        let next = wrong(at * factor)?;
        if next >= least {
            break;
        }
        (before, at, least) = (at, at * factor, next);
    }
    let (mut low, mut high) = (before, at * factor);
    let inner = |low: f64, high: f64| [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let [mut a, mut b] = inner(low, high);
    let [mut at_a, mut at_b] = [wrong(a)?, wrong(b)?];
    for _ in 0..TURNS {
        if at_a <= at_b {
            (high, b, at_b) = (b, a, at_a);
            a = inner(low, high)[0];
            at_a = wrong(a)?;
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = inner(low, high)[1];
            at_b = wrong(b)?;
        }
        // People choose short numbers, and only the very number leaves nothing wrong.
        let short = digits((low + high) / 2.0);
        let range = low.at_most(high)..low.at_least(high);
        if range.contains(&short) && (high - low).abs() < 0.01 * right {
            let round = [10.0, 100.0].map(|by: f64| (short * by).round() / by);
            for value in round.into_iter().filter(|value| range.contains(value)) {
                let left = wrong(value)?;
                if left[1] == 0 {
                    return Ok(Some((value, left)));
                }
            }
        }
    }
    Ok(Some(if at_a <= at_b { (a, at_a) } else { (b, at_b) }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_value_is_found() {
        for (right, best) in
            [(0.25, 0.3), (0.25, 0.1), (2.0, 2.5), (2.0, 1.234_567), (900.0, 905.0)]
        {
            let mut asked = 0;
            let wrong = |value: f64| {
                asked += 1;
                let off = (1e5 * (value - best).abs() / right).round() as u64;
                Ok([off, off])
            };
            let off = (1e5 * (right - best).abs() / right).round() as u64;
            let (found, left) = search(right, [off; 2], wrong).unwrap().unwrap();
            assert!((found - best).abs() < 1e-4 * right, "{found}, {left:?}, not {best}");
            assert!(asked < 60, "{asked}");
        }
        assert!(search(2.0, [7; 2], |_| Ok([8; 2])).unwrap().is_none(), "another mistake");
    }
}
