//! The mistakes that are tried: each in words and as a change, under the stage where it shows first.

use super::change::Change;
use super::{Case, Mistakes, depths, epsilon, gaussians, surfels};
use crate::method::{Method, Session};
use crate::number::MapInline;
use crate::scene::Camera;
use crate::setting::{Fields, Setting, Value};
use crate::verdict::client::{Storage, Ties};
use crate::verdict::supposed::{OtherBin, OtherRatio, Supposed};
use std::sync::Arc;

/// The stages that say where splats are.
pub(super) const SHAPES: [&str; 4] = ["visibility", "projection", "geometry", "difference"];
/// The stages that add fragments up.
pub(super) const SUMS: [&str; 4] = ["attributes", "compositing", "reconstruction", "geometry"];
/// The stages that average and shade.
const PICTURES: [&str; 3] = ["normalization", "shading", "compositing"];

/// The mistakes that show first in this stage and are made often.
pub(super) fn common(case: &Case<'_, '_>, stage: &str) -> Mistakes {
    let Case { session, camera, .. } = case;
    if let Method::Gaussians(settings) = session.method() {
        return gaussians::mistakes(case, settings);
    }
    let mut all = Mistakes::new();
    if SHAPES.contains(&stage) {
        all.extend(moved_by_half(session, camera));
        all.push(("rows are flipped".into(), Change::Flipped));
        all.extend(depths::mistakes(case));
        all.extend(settings(session, &VISIBILITY));
        let ties = if case.client.ties == Ties::Last { Ties::Lowest } else { Ties::Last };
        all.push(("ties are reversed".into(), Change::Ties(ties)));
        all.extend(depth_of_16_bits(case));
        let lacking = &case.wrong.causes.left_out;
        if lacking.len() <= MOST_MISSING {
            all.extend(surfels::missing(session, camera, lacking.keys().copied()));
        }
    }
    // With records the shapes of splats show in the projection.
    let records = stage == "projection" && case.client.records.is_some();
    all.extend(supposed(case, if records { "visibility" } else { stage }));
    if SUMS.contains(&stage) {
        all.extend(settings(session, &ATTRIBUTES));
        all.extend(epsilon::other_unit(session.method()));
        if case.client.sums_are(is_half) {
            all.push(("sums in half floats".into(), Change::Accumulator(Storage::Half)));
        }
    }
    if PICTURES.contains(&stage) {
        all.extend(of_pictures());
    }
    all
}

/// The mistakes that are made less often.
pub(super) fn rare(case: &Case<'_, '_>, stage: &str) -> Mistakes {
    let Case { session, camera, client, .. } = case;
    let mut all = Mistakes::new();
    match stage {
        "visibility" => {
            all.extend(limits(case));
            all.extend(surfels::normals(session, camera));
            all.extend(epsilon::moved(case));
        }
        "projection" | "geometry" => {
            all.extend(limits(case));
            all.extend(surfels::scaled(session, client));
            all.extend(surfels::normals(session, camera));
        }
        "attributes" | "compositing" => {
            all.extend(epsilon::bands(session, camera, client));
            all.extend(limits(case));
            all.extend(twice(case));
        }
        _ => {}
    }
    all
}

/// Whether a half float holds a number.
fn is_half(value: f64) -> bool {
    let single = value as f32;
    // Half floats have 11 digits, and are multiples of 2^-24.
    f64::from(single) == value
        && (value * 16_777_216.0).fract() == 0.0
        && (single.to_bits() & 0x1FFF == 0 || value.abs() < 1.0 / 16_384.0)
}

/// Whether a number may be a sum of a few half floats of 2^-8 and more.
fn is_of_halves(value: f64) -> bool {
    (value * 262_144.0).fract() == 0.0
}

/// A depth buffer of 16 bits: of depths, or of their reciprocals.
fn depth_of_16_bits(case: &Case<'_, '_>) -> Mistakes {
    let (Some((depth, largest)), true) = (case.client.depth_of_visibility(), case.is_one_in(4))
    else {
        return Mistakes::new();
    };
    let depth = if case.wrong.stage == "geometry" { "group##.Z" } else { depth };
    let near = f64::from(case.camera.near);
    let steps = Storage::Steps(2.0 * largest / 65_535.0);
    let buffer = Storage::DepthBuffer { step: 1.0 / 65_535.0, near, far: f64::INFINITY };
    let changes = |storage| {
        let test = ("a depth test of 16 bits".to_owned(), Change::DepthTest(storage));
        [("depth of 16 bits".to_owned(), Change::Stored(depth, storage)), test]
    };
    [steps, buffer].into_iter().flat_map(changes).collect()
}

/// Half a pixel along one axis.
pub(super) const HALF_RIGHT: &str = "half a pixel to the right";
pub(super) const HALF_DOWN: &str = "half a pixel down";

/// The ways in which pictures are moved by half a pixel.
pub(super) const HALVES: [(&str, f32, f32); 4] = [
    ("half a pixel to the right and down", 0.5, 0.5),
    ("half a pixel to the left and up", -0.5, -0.5),
    (HALF_RIGHT, 0.5, 0.0),
    (HALF_DOWN, 0.0, 0.5),
];

/// The picture moved by half a pixel.
fn moved_by_half(session: &Session<'_>, camera: &Camera) -> Mistakes {
    let splats = session.method().splats().is_some();
    let both = HALVES.into_iter().flat_map(|(what, dx, dy)| {
        let moved = Camera { cx: camera.cx + dx, cy: camera.cy + dy, ..*camera };
        // Fragments alone are moved within their quads, or the pixels of points, or points, or
        // whatever the camera shows.
        let drawn = || Change::Drawn(Arc::new((session.scene().clone(), moved)));
        let some = match splats {
            true => vec![Change::Supposed(Supposed::Moved([dx, dy]))],
            false => vec![Change::Part(is_of_points, Box::new(drawn())), drawn()],
        };
        let all = some.into_iter().chain([Change::Camera(moved)]);
        all.map(|change| (what.to_owned(), change)).collect::<Vec<_>>()
    });
    both.collect()
}

/// Whether a plane says which points are in which pixels.
fn is_of_points(name: &str) -> bool {
    name.starts_with("projection") && !name.starts_with("projection.center")
}

/// Mistakes with the picture and its averages.
fn of_pictures() -> Mistakes {
    let mut all: Mistakes = vec![
        ("sRGB where linear colours are expected".into(), Change::Decoded(1)),
        ("sRGB twice: an encoded picture is encoded again".into(), Change::Decoded(2)),
        ("normals are stored in [0, 1], not in [-1, 1]".into(), Change::Unsigned),
    ];
    for order in [[2, 1, 0], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1]] {
        let letters = order.map_inline(|component| ["R", "G", "B"][component]).concat();
        let what = format!("channels are swapped: red, green and blue are in {letters}");
        all.push((what, Change::Swapped(order)));
    }
    all
}

/// Another rule for splats or sums: the stages where it shows, the rule, and the mistake in words.
type OtherRule = (&'static [&'static str], Supposed, &'static str);

const SPLATS: [&str; 2] = ["visibility", "geometry"];

/// The rules of splats and their fragments.
const OF_SPLATS: [OtherRule; 13] = [
    (&SPLATS, Supposed::CentersWhole, "centres are rounded to the centres of pixels"),
    (&SPLATS, Supposed::Limit(1e9), "there is no cut-off: whole quads are drawn"),
    (&SPLATS, Supposed::Mirrored, "ellipses lean to the wrong side: the sign of their tilt"),
    (&SPLATS, Supposed::Transposed, "ellipses are transposed: columns and rows are exchanged"),
    (
        &SPLATS,
        Supposed::FilterOnRadius,
        "the low-pass filter is added to the radius, not to the variance",
    ),
    (&SPLATS, Supposed::SlopeAcross, "depth changes the wrong way across the screen"),
    (&SPLATS, Supposed::SlopeDown, "depth changes the wrong way down the screen"),
    (&SPLATS, Supposed::DepthOfCenter, "a splat has the depth of its centre everywhere"),
    (&SPLATS, Supposed::DepthNotClamped, "depths are not clamped to those of the disc"),
    (
        &SPLATS,
        Supposed::QuadsWhole,
        "quads too small: their half sides are rounded down to whole pixels",
    ),
    (&SUMS, Supposed::NoAmplitude, "weights lack the amplitude of the low-pass filter"),
    (&SUMS, Supposed::ExpWithoutHalf, "the weight is exp(-q), not exp(-q/2)"),
    (&SUMS, Supposed::BacksNotTurned, "normals of surfels seen from behind are not turned"),
];

/// The rules of sums, averages and levels.
const OF_SUMS: [OtherRule; 15] = [
    (&PICTURES, Supposed::ColorsByCount, "colours are divided by the count, not by the weight"),
    (&PICTURES, Supposed::ColorsNotDivided, "colours multiplied by the weight"),
    (&["attributes", "compositing"], Supposed::ColorsSaturate, "sums of colours end at 1"),
    (&["attributes", "compositing"], Supposed::CountFromOne, "the count begins at 1"),
    (&["attributes"], Supposed::NearestTwice, "the nearest fragment is added twice"),
    (
        &["normalization", "compositing"],
        Supposed::NormalsNotUnit,
        "normals are averages that are not made unit vectors",
    ),
    (&["shading"], Supposed::LitUnturned, "normals are lit without being turned to the camera"),
    (
        &["normalization", "shading"],
        Supposed::NormalsOfView,
        "normals of the picture are in view space, not in world space",
    ),
    (
        &["pull"],
        Supposed::PullSide(2.0),
        "a level off by one: the pull takes cells of twice the side",
    ),
    (
        &["pull"],
        Supposed::PullSide(0.5),
        "a level off by one: the pull takes cells of half the side",
    ),
    (
        &["push"],
        Supposed::PushSide(2.0),
        "a level off by one: the push takes cells of twice the side",
    ),
    (
        &["push"],
        Supposed::PushSide(0.5),
        "a level off by one: the push takes cells of half the side",
    ),
    (&["pull", "push"], Supposed::SidesOf1, "cells have the side 1 at every level"),
    (
        &["pull", "push"],
        Supposed::AllOverlap,
        "cells are averaged whether or not their intervals of depth overlap",
    ),
    (&["push"], Supposed::NothingOccluded, "occluded cells are kept"),
];

/// The rules of bins.
const OF_BINS: [OtherRule; 10] = [
    (&["geometry"], Supposed::Ratio(OtherRatio::Missing), "the ratio of Voronoi depths is missing"),
    (&["geometry"], Supposed::Ratio(OtherRatio::Subtracted), "the ratio is subtracted"),
    (&["geometry"], Supposed::Ratio(OtherRatio::Squared), "the ratio is q/k^2, not its root"),
    (&["geometry"], Supposed::Ratio(OtherRatio::NotByCutoff), "the ratio is not divided by k"),
    (&["geometry"], Supposed::Ratio(OtherRatio::UpTo1), "the ratio of Voronoi depths goes up to 1"),
    (&["geometry"], Supposed::Ratio(OtherRatio::Reversed), "the ratio is reversed: rims win"),
    (&["geometry"], Supposed::Bin(OtherBin::Nearest), "depths are rounded to the nearest bin"),
    (&["geometry"], Supposed::Bin(OtherBin::Up), "depths are rounded up to a bin"),
    (&["geometry"], Supposed::Bin(OtherBin::One), "all depths are in one bin"),
    (&["geometry"], Supposed::Bin(OtherBin::Next), "a bin off by one: bins are counted from 1"),
];

/// The other rules that show first in a stage.
fn supposed(case: &Case<'_, '_>, stage: &str) -> Mistakes {
    let session = case.session;
    let shows = |(stages, _, _): &&OtherRule| stages.contains(&stage);
    let all = OF_SPLATS.iter().chain(&OF_SUMS).chain(&OF_BINS).filter(shows);
    let mut all: Mistakes =
        all.map(|(_, rule, what)| ((*what).to_owned(), Change::Supposed(*rule))).collect();
    if SUMS.contains(&stage) && case.client.sums_are(is_of_halves) {
        let halves = Change::Supposed(Supposed::HalfWeights);
        all.push(("weights in half floats".into(), halves));
    }
    if let (true, Some(splats)) = (SPLATS.contains(&stage), session.method().splats()) {
        let k = f64::from(splats.kernel.cutoff);
        for (by, what) in [(k, "is the radius, not"), (1.0 / k, "is divided by k twice, not once:")]
        {
            let what = format!("the standard deviation of a splat {what} the radius by k");
            all.push((what, Change::Supposed(Supposed::Spread(by))));
        }
        let limit = Supposed::Limit(1.0 / k);
        all.push(("q is compared with k, not with k^2".into(), Change::Supposed(limit)));
    }
    all
}

/// A limit of q that is a little off. Few fragments lie so close to it, so few pixels are wrong.
fn limits(case: &Case<'_, '_>) -> Mistakes {
    if case.session.method().splats().is_none() || case.is_one_in(20) {
        return Mistakes::new();
    }
    let sizes = (0..8).map(|i| 1e-6 * f64::from(1_u32 << (2 * i)));
    let all = sizes.flat_map(|size| [(size, "large"), (-size, "small")]);
    all.map(|(size, word)| {
        let what = format!("the limit of q is too {word}, by about {:.0e} of it", size.abs());
        (what, Change::Supposed(Supposed::Limit(1.0 + size)))
    })
    .collect()
}

/// One of the surfels at the worst pixel is drawn twice.
fn twice(case: &Case<'_, '_>) -> Mistakes {
    let Some(worst) = &case.wrong.worst else { return Mistakes::new() };
    let Ok(weights) = case.session.weights(case.camera, worst.pixel) else {
        return Mistakes::new();
    };
    let some = weights.into_iter().take(MOST_TWICE).map(|(surfel, _)| {
        let what = format!("surfel {surfel} is added twice");
        (what, Change::Supposed(Supposed::Twice(surfel)))
    });
    some.collect()
}

/// The most surfels that are tried as the one that is missing.
const MOST_MISSING: usize = 4;

/// The most surfels that are tried as the one that is drawn twice.
const MOST_TWICE: usize = 8;

/// A wrong setting: its name, the wrong value computed from the right one, and the mistake in
/// words.
type WrongSetting = (&'static str, fn(&Method, f32) -> Option<Value>, &'static str);

const VISIBILITY: [WrongSetting; 4] = [
    ("low_pass", |_, _| Some(Value::Number(0.0)), "the low-pass filter is missing"),
    ("low_pass", |_, h| Some(Value::Number(2.0 * h)), "the low-pass filter is added twice"),
    ("low_pass", |_, h| Some(Value::Number(0.5 * h)), "half of the low-pass filter is missing"),
    ("cull", switched, "culling is on where it should be off, or off where it should be on"),
];

const ATTRIBUTES: [WrongSetting; 4] = [
    ("epsilon", |method, _| epsilon::scaled(method, 0.5), "epsilon is half as wide"),
    ("epsilon", |method, _| epsilon::scaled(method, 2.0), "epsilon is twice as wide"),
    ("epsilon", |method, _| epsilon::scaled(method, 0.0), "epsilon is 0"),
    (
        "epsilon",
        |_, _| Some(Value::Text("inf".into())),
        "epsilon is ignored, or in a unit in which everything is within it",
    ),
];

/// The other value of a switch.
fn switched(method: &Method, _: f32) -> Option<Value> {
    let cull = method.values().into_iter().find(|(name, _)| *name == "cull")?.1;
    if let Value::Switch(on) = cull { Some(Value::Switch(!on)) } else { None }
}

/// The method with each of some wrong settings. Settings that the method does not have are left
/// out.
fn settings(session: &Session<'_>, wrong: &[WrongSetting]) -> Mistakes {
    let method = session.method();
    let with = |(name, value, what): &WrongSetting| {
        let own = method.values().into_iter().find(|(own, _)| own == name)?.1;
        let number = match own {
            Value::Number(number) => number,
            _ => 0.0,
        };
        let changed = other(method, name, &value(method, number)?)?;
        Some(((*what).to_owned(), Change::Method(changed)))
    };
    wrong.iter().filter_map(with).collect()
}

/// The method with another value of a setting, if that is allowed.
fn other(method: &Method, name: &str, value: &Value) -> Option<Method> {
    let mut changed = *method;
    changed.set(name, value).ok()?;
    (changed != *method && changed.check().is_ok()).then_some(changed)
}

/// Every other choice of a setting that is one of several words, and counts that are a little off.
pub(super) fn choices(session: &Session<'_>) -> Mistakes {
    let method = session.method();
    let mut all = Mistakes::new();
    for setting in Setting::of([(method.name(), *method)]) {
        let Some((_, Some(own))) = setting.owners.first() else { continue };
        let others: Vec<Value> = match own {
            Value::Whole(own) => [-2, -1, 1, 2].iter().map(|by| Value::Whole(own + by)).collect(),
            Value::Text(_) => {
                setting.words.iter().map(|word| Value::Text((*word).to_owned())).collect()
            }
            _ => Vec::new(),
        };
        for value in others.into_iter().filter(|value| value != own && setting.name != "epsilon") {
            if let Some(changed) = other(method, setting.name, &value) {
                let what = format!("`{}` is {}, not {}", setting.name, value.text(), own.text());
                all.push((what, Change::Method(changed)));
            }
        }
    }
    all
}
