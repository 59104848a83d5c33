//! The numbers that a client may have wrong: settings, sizes, the camera, epsilon and a gamma.

use super::cameras::{self, Moved};
use super::change::Change;
use super::depths::{digits, median};
use super::mistakes::{HALF_DOWN, HALF_RIGHT, SHAPES, SUMS};
use super::{Case, Wrong, epsilon, surfels};
use crate::error::Result;
use crate::number::Real;
use crate::scene::Camera;
use crate::setting::{Fields, Value};
use crate::splat::record::project_records;
use crate::verdict::client::Client;
use crate::verdict::supposed::Supposed;
use glam::{Mat4, Vec3};

/// A number that is searched: its right value, the first step, how it is changed, and the mistake
/// in words.
pub(super) struct Number<'a> {
    pub(super) right: f64,
    pub(super) step: f64,
    pub(super) change: Box<dyn Fn(f64) -> Option<Change> + 'a>,
    pub(super) in_words: Box<dyn Fn(f64) -> String + 'a>,
    /// The number, estimated from the colours or the surfels that the client shows.
    pub(super) estimate: Option<f64>,
}

impl Number<'_> {
    /// The wrong pixels of a client if the number had this value; none if it cannot have it.
    pub(super) fn judge(
        &self,
        case: &Case<'_, '_>,
        value: f64,
        client: &Client,
    ) -> Result<Option<Wrong>> {
        match (self.change)(value) {
            Some(change) => case.judge_client(&change, client),
            None => Ok(None),
        }
    }
}

/// The numbers that may be wrong in the first wrong stage, but for those of the camera.
pub(super) fn numbers<'a>(case: &'a Case<'_, '_>) -> Vec<Number<'a>> {
    let is_in = |some: &[&str]| case.stages.iter().any(|stage| some.contains(stage));
    let mut all = Vec::new();
    // Weights tell of the filter and the cut-off too, where no rim does.
    if is_in(&SHAPES) || is_in(&SUMS) {
        all.extend(of_settings(case));
    }
    if is_in(&SHAPES) {
        all.extend(of_sizes(case));
        all.extend(of_clamps(case));
    }
    if is_in(&SUMS) {
        all.extend(of_epsilon(case));
    }
    if is_in(&["shading"]) {
        all.push(Number {
            right: 1.0,
            step: 0.02,
            estimate: gamma(case),
            change: Box::new(|gamma| (gamma > 0.1).then_some(Change::Power(gamma))),
            in_words: Box::new(|gamma| format!("the picture is encoded with a gamma of {gamma}")),
        });
    }
    all
}

/// The power that turns the client's colours into the right ones, by the median over all colours.
fn gamma(case: &Case<'_, '_>) -> Option<f64> {
    let picture = case.session.draw_whole(case.camera).ok()?;
    let (own, right) = (case.client.frame().color("").ok()?, picture.frame.color("").ok()?);
    let colors = own.values().as_flattened().iter().zip(right.values().as_flattened());
    // Black and white are themselves to any power.
    let is_grey = |value: f64| value > 0.01 && value < 0.99;
    let powers = colors.filter_map(|(&own, &right)| {
        let right = f64::from(right);
        (is_grey(own) && is_grey(right)).then(|| libm::log(right) / libm::log(own))
    });
    Some(median(powers.collect())).filter(|power| power.is_finite())
}

/// The numbers of the camera, if the first wrong stage shows where surfels are.
pub(super) fn numbers_of_camera<'a>(case: &'a Case<'_, '_>) -> Vec<Number<'a>> {
    // The centres of another camera lie in other pixels.
    let tells = |stage: &&str| SHAPES.contains(stage) || *stage == "indices";
    if !case.stages.iter().any(tells) {
        return Vec::new();
    }
    let moved = cameras::moved(case.session, case.camera, case.client);
    of_lens(case.camera, moved).into_iter().chain(of_place(case.camera, moved)).collect()
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
        estimate: None,
        change,
        in_words: Box::new(move |found| {
            format!("the low-pass filter has another variance: {found} px^2, not {right}")
        }),
    });
    let cutoff = setting("cutoff", 0.0).map(|(right, step, change)| Number {
        right,
        step,
        estimate: None,
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
        estimate: None,
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
        estimate: None,
        change: Box::new(|by| {
            (0.4..2.5).contains(&by).then_some(Change::Supposed(Supposed::Quads(by)))
        }),
        in_words: Box::new(|by| format!("quads too small: {by} times their size")),
    };
    let limit = Number {
        right: 1.0,
        step: 0.01,
        estimate: None,
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
        estimate: None,
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
        estimate: None,
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

/// The numbers of the lens.
pub(super) fn of_lens<'a>(camera: &'a Camera, moved: Option<Moved>) -> [Number<'a>; 2] {
    let estimate = |of: fn(&Moved) -> f64| moved.as_ref().map(of);
    let (fx, fy) = (f64::from(camera.fx), f64::from(camera.fy));
    let focal = Number {
        right: fy,
        step: 0.01 * fy,
        estimate: estimate(|moved| 0.5 * (moved.x.x + moved.y.y)).map(|by| fy * by),
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
        estimate: estimate(|moved| moved.x.x),
        change: Box::new(move |by| {
            let camera = Camera { fx: (fx * by) as f32, ..*camera };
            (0.4..2.5).contains(&by).then_some(Change::Camera(camera))
        }),
        in_words: Box::new(|by| format!("a wrong aspect: the picture is {by} times as wide")),
    };
    [focal, aspect]
}

/// The numbers that move or turn the picture.
pub(super) fn of_place<'a>(camera: &'a Camera, moved: Option<Moved>) -> [Number<'a>; 3] {
    let estimate = |of: fn(&Moved) -> f64| moved.as_ref().map(of);
    let shift =
        |estimate, way: &'a str, half: &'a str, shifted: fn(&Camera, f32) -> Camera| Number {
            right: 0.0,
            step: 0.02,
            estimate,
            change: Box::new(move |by| Some(Change::Camera(shifted(camera, by as f32)))),
            in_words: Box::new(move |by| match by {
                0.5 => half.to_owned(),
                _ => format!("the picture is {by} px too far {way}"),
            }),
        };
    let across = shift(estimate(|moved| moved.x.z), "right", HALF_RIGHT, |camera, by| Camera {
        cx: camera.cx + by,
        ..*camera
    });
    let down = shift(estimate(|moved| moved.y.z), "down", HALF_DOWN, |camera, by| Camera {
        cy: camera.cy + by,
        ..*camera
    });
    let roll = Number {
        right: 0.0,
        step: 0.1,
        estimate: estimate(|moved| {
            libm::atan2(moved.x.y - moved.y.x, moved.x.x + moved.y.y).to_degrees()
        }),
        change: Box::new(move |degrees| {
            let turn = Mat4::from_axis_angle(Vec3::Z, (degrees as f32).to_radians());
            let view_from_world = turn * camera.view_from_world;
            Some(Change::Camera(Camera { view_from_world, ..*camera }))
        }),
        in_words: Box::new(|degrees| format!("the camera is tilted by {degrees} degrees")),
    };
    [across, down, roll]
}

/// Epsilon.
fn of_epsilon<'a>(case: &'a Case<'_, '_>) -> Option<Number<'a>> {
    let method = case.session.method();
    epsilon::scaled(method, 1.0)?;
    Some(Number {
        right: 1.0,
        step: 0.01,
        estimate: None,
        change: Box::new(move |by| {
            let mut changed = *method;
            changed.set("epsilon", &epsilon::scaled(method, by as f32)?).ok()?;
            changed.check().is_ok().then_some(Change::Method(changed))
        }),
        in_words: Box::new(|by| format!("epsilon is {by} times as wide")),
    })
}
