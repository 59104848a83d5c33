//! Find a number that a client may have wrong: the value with which its errors are smallest. The
//! farther off a value is, the larger are the errors, so that a search finds the best one.

use super::change::Change;
use super::depths::digits;
use super::mistakes::{SHAPES, SUMS};
use super::{Case, Explanation, FEWEST, MOST_LEFT, Wrong, epsilon, surfels};
use crate::error::Result;
use crate::number::Real;
use crate::scene::Camera;
use crate::setting::{Fields, Value};
use crate::splat::record::project_records;
use crate::verdict::supposed::Supposed;
use glam::{Mat4, Vec3};

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

/// A number that is searched: its right value, the first step, how it is changed, and the mistake
/// in words.
struct Number<'a> {
    right: f64,
    step: f64,
    change: Box<dyn Fn(f64) -> Option<Change> + 'a>,
    in_words: Box<dyn Fn(f64) -> String + 'a>,
    is_of_camera: bool,
}

/// The numbers that may be wrong in the first wrong stage.
fn numbers<'a>(case: &'a Case<'_, '_>) -> Vec<Number<'a>> {
    let is_in = |some: &[&str]| case.stages.iter().any(|stage| some.contains(stage));
    let mut all = Vec::new();
    // Weights tell of the filter and the cut-off too, where no rim does.
    if is_in(&SHAPES) || is_in(&SUMS) {
        all.extend(of_settings(case));
    }
    if is_in(&SHAPES) {
        all.extend(of_sizes(case));
        all.extend(of_clamps(case));
        all.extend(of_cameras(case.camera));
    }
    if is_in(&SUMS) {
        all.extend(of_epsilon(case));
    }
    if is_in(&["shading"]) {
        all.push(Number {
            right: 1.0,
            step: 0.02,
            is_of_camera: false,
            change: Box::new(|gamma| (gamma > 0.1).then_some(Change::Power(gamma))),
            in_words: Box::new(|gamma| format!("the picture is encoded with a gamma of {gamma}")),
        });
    }
    all
}

/// The numbers that are settings.
fn of_settings<'a>(case: &'a Case<'_, '_>) -> impl Iterator<Item = Number<'a>> {
    let method = case.session.method();
    let setting = |name: &'static str, least: f64| {
        let own = method.values().into_iter().find(|(own, _)| *own == name)?.1;
        let Value::Number(right) = own else { return None };
        let right = f64::from(right);
        let change = move |value: f64| {
            let mut changed = *method;
            changed.set(name, &Value::Number(value as f32)).ok()?;
            changed.check().is_ok().then_some(Change::Method(changed))
        };
        Some((right, right.at_least(least) * 0.01, Box::new(change) as Box<dyn Fn(f64) -> _>))
    };
    let low_pass = setting("low_pass", 0.1).map(|(right, step, change)| Number {
        right,
        step,
        is_of_camera: false,
        change,
        in_words: Box::new(move |found| {
            format!("the low-pass filter has another variance: {found} px^2, not {right}")
        }),
    });
    let cutoff = setting("cutoff", 0.0).map(|(right, step, change)| Number {
        right,
        step,
        is_of_camera: false,
        change,
        in_words: Box::new(move |found| format!("the cut-off is {found}, not {right}")),
    });
    [low_pass, cutoff].into_iter().flatten()
}

/// The sizes of splats, as factors.
fn of_sizes<'a>(case: &'a Case<'_, '_>) -> impl Iterator<Item = Number<'a>> {
    let radii = Number {
        right: 1.0,
        step: 0.01,
        is_of_camera: false,
        change: Box::new(|by| {
            let by = by as f32;
            let in_range = (0.4..2.5).contains(&by);
            in_range.then(|| surfels::of_radii(case.session, |radius| radius * by)).flatten()
        }),
        in_words: Box::new(|by| format!("radii are {by} times as large")),
    };
    let quads = Number {
        right: 1.0,
        step: -0.01,
        is_of_camera: false,
        change: Box::new(|by| {
            (0.4..2.5).contains(&by).then_some(Change::Supposed(Supposed::Quads(by)))
        }),
        in_words: Box::new(|by| format!("quads too small: {by} times their size")),
    };
    let limit = Number {
        right: 1.0,
        step: 0.01,
        is_of_camera: false,
        change: Box::new(|by| {
            (0.4..2.5).contains(&by).then_some(Change::Supposed(Supposed::Limit(by)))
        }),
        in_words: Box::new(|by| format!("the limit of q is {by} times k^2")),
    };
    let splats = case.session.method().splats().is_some();
    let of_splats = [quads, limit].into_iter().filter(move |_| splats);
    std::iter::once(radii).chain(of_splats)
}

/// The largest sizes of splats.
fn of_clamps<'a>(case: &'a Case<'_, '_>) -> impl Iterator<Item = Number<'a>> {
    let radii_of = case.session.scene().surfels.radius();
    let largest = f64::from(radii_of.iter().fold(0.0_f32, |most, radius| most.at_least(*radius)));
    let no_larger = Number {
        right: largest,
        step: -0.02 * largest,
        is_of_camera: false,
        change: Box::new(move |most| {
            let most = most as f32;
            let in_range = most > 0.0;
            in_range.then(|| surfels::of_radii(case.session, |own| own.at_most(most))).flatten()
        }),
        in_words: Box::new(|most| format!("large splats are clamped: no radius is above {most}")),
    };
    let clamped = largest_half(case).map(|largest| Number {
        right: largest,
        step: -0.02 * largest,
        is_of_camera: false,
        change: Box::new(|most| {
            (most > 0.5).then_some(Change::Supposed(Supposed::QuadsAtMost(most)))
        }),
        in_words: Box::new(|most| {
            format!("large splats are clamped: no quad reaches farther than {most} px")
        }),
    });
    clamped.into_iter().chain([no_larger])
}

/// The largest half side of a splat's bounds, in pixels.
fn largest_half(case: &Case<'_, '_>) -> Option<f64> {
    let splats = case.session.method().splats()?;
    let surfels = &case.session.scene().surfels;
    let (records, _) = project_records(surfels, case.camera, &splats.kernel, splats.cull);
    let side = |[x0, y0, x1, y1]: [u32; 4]| (x1 - x0).max(y1 - y0);
    records.iter().map(|record| side(record.bounds)).max().map(|side| 0.5 * f64::from(side))
}

/// The numbers of the camera.
fn of_cameras<'a>(camera: &'a Camera) -> Vec<Number<'a>> {
    let (fx, fy) = (f64::from(camera.fx), f64::from(camera.fy));
    let focal = Number {
        right: fy,
        step: 0.01 * fy,
        is_of_camera: true,
        change: Box::new(move |value| {
            let by = (value / fy) as f32;
            let camera = Camera { fx: camera.fx * by, fy: value as f32, ..*camera };
            (0.4..2.5).contains(&by).then_some(Change::Camera(camera))
        }),
        in_words: Box::new(move |found| {
            let right = digits(fy);
            format!("another field of view: the focal length is {found} px, not {right}")
        }),
    };
    let aspect = Number {
        right: 1.0,
        step: 0.01,
        is_of_camera: true,
        change: Box::new(move |by| {
            let camera = Camera { fx: (fx * by) as f32, ..*camera };
            (0.4..2.5).contains(&by).then_some(Change::Camera(camera))
        }),
        in_words: Box::new(|by| format!("a wrong aspect: the picture is {by} times as wide")),
    };
    let across = Number {
        right: 0.0,
        step: 0.02,
        is_of_camera: true,
        change: Box::new(move |by| {
            Some(Change::Camera(Camera { cx: camera.cx + by as f32, ..*camera }))
        }),
        in_words: Box::new(|by| format!("the picture is {by} px too far right")),
    };
    let down = Number {
        right: 0.0,
        step: 0.02,
        is_of_camera: true,
        change: Box::new(move |by| {
            Some(Change::Camera(Camera { cy: camera.cy + by as f32, ..*camera }))
        }),
        in_words: Box::new(|by| format!("the picture is {by} px too far down")),
    };
    let roll = Number {
        right: 0.0,
        step: 0.1,
        is_of_camera: true,
        change: Box::new(move |degrees| {
            let turn = Mat4::from_axis_angle(Vec3::Z, (degrees as f32).to_radians());
            let view_from_world = turn * camera.view_from_world;
            Some(Change::Camera(Camera { view_from_world, ..*camera }))
        }),
        in_words: Box::new(|degrees| format!("the camera is tilted by {degrees} degrees")),
    };
    vec![focal, aspect, across, down, roll]
}

/// Epsilon.
fn of_epsilon<'a>(case: &'a Case<'_, '_>) -> Option<Number<'a>> {
    let method = case.session.method();
    epsilon::scaled(method, 1.0)?;
    Some(Number {
        right: 1.0,
        step: 0.01,
        is_of_camera: false,
        change: Box::new(move |by| {
            let mut changed = *method;
            changed.set("epsilon", &epsilon::scaled(method, by as f32)?).ok()?;
            changed.check().is_ok().then_some(Change::Method(changed))
        }),
        in_words: Box::new(|by| format!("epsilon is {by} times as wide")),
    })
}

/// The number with another value that explains most.
///
/// # Errors
/// As [`crate::method::Session::verify`].
pub(super) fn best(case: &Case<'_, '_>) -> Result<Option<Explanation>> {
    let mut best: Option<Explanation> = None;
    if case.all.near < FEWEST {
        return Ok(best);
    }
    for number in numbers(case) {
        let Some(Tried { value, left }) = found(case, &number)? else { continue };
        let least = best.as_ref().is_none_or(|best| left.all < best.left.all);
        if case.explains(left, MOST_LEFT) && least {
            let Some(change) = (number.change)(value) else { continue };
            let (what, most) = ((number.in_words)(digits(value)), MOST_LEFT);
            best = Some(Explanation { what, change, most, left });
            if left.all == 0 {
                break;
            }
        }
    }
    Ok(best)
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
    let judge = |value: f64, client| match (number.change)(value) {
        Some(change) => case.judge_client(&change, client),
        None => Ok(None),
    };
    let in_part = || search(right, step, case.all, false, |value| judge(value, case.client));
    // Another camera moves splats so far that a few pixels show no way to it.
    let pilot = case.pilot.filter(|_| !number.is_of_camera);
    let Some((pilot, all)) = pilot else { return in_part() };
    let found = search(right, step, all, true, |value| judge(value, pilot))?;
    let found = found.filter(|found| !found.left.is_hopeless(all));
    let Some(Tried { value, .. }) = found else { return Ok(None) };
    let Some(left) = judge(value, case.client)? else { return Ok(None) };
    if left.all == 0 {
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
    rounded(right, best, (high - low).abs(), size)
}

/// The best value, or a shorter one beside it that leaves nothing wrong: people choose short numbers.
fn rounded(
    right: f64,
    mut best: Tried,
    range: f64,
    mut size: impl FnMut(f64, &mut Tried) -> Result<f64>,
) -> Result<Tried> {
    let range = range.at_least(0.01 * right.abs());
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
