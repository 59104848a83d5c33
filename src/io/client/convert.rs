//! Convert the numbers of a file to a plane of the crate, and say how exactly the file stores them.

use super::files::Kind;
use super::format::{F16_LOSS, F32_STEP, Format, Loss};
use super::numbers::Numbers;
use super::parse::{DepthKeys, Encoding, Meaning, PlaneKeys};
use super::wanted::Wanted;
use crate::frame::{NO_ID, Plane, Samples};
use crate::io::Reason;
use crate::method::Holds;
use crate::number::Real;
use crate::number::srgb;
use crate::verdict::client::Storage;

/// How much a product, a division by t and storing may lose in `f32`, because shading languages
/// promise a division only to 2.5 units in the last place.
const DIVISION: Loss = Loss { relative: 4.0 * F32_STEP, least: 0.0 };
/// How much the power of the sRGB encoding may lose in `f32`, for codes up to 1. Shading languages
/// compute it as exp2(y log2(x)), each to a few units in the last place.
const POWER: Loss = Loss { relative: 32.0 * F32_STEP, least: 32.0 * F32_STEP };

/// Converts the numbers of a file to a plane of the crate.
pub(super) fn plane(
    wanted: &Wanted,
    kind: Kind,
    numbers: Numbers,
) -> Reason<(Samples<f64>, Storage)> {
    check_keys(wanted, kind)?;
    check_encoding(wanted)?;
    let (holds, keys, file) = (wanted.row.holds.plain(), &wanted.keys, numbers.file);
    let format = keys.format.unwrap_or(file);
    if !format.fits(file) {
        let (format, file) = (format.word(), file.word());
        return Err(format!("format is {format}, but a file of {file} can hold other numbers"));
    }
    let [width, height] = numbers.size;
    match holds {
        Holds::Index => {
            let plane = Plane::from_values(width, height, indices(keys, format, &numbers)?);
            Ok((Samples::Index(plane), Storage::Single))
        }
        Holds::Count => {
            let counts = wholes(format, &numbers, 255.0, &|value| value)?;
            let counts = counts.into_iter().map(|count| count as u8).collect();
            Ok((Samples::Count(Plane::from_values(width, height, counts)), Storage::Single))
        }
        _ => {
            let numbers = Scaled::new(keys, format, numbers)?;
            let (components, storage) = if wanted.is_octahedral() {
                octahedral(keys, numbers)
            } else if wanted.is_depth() {
                depths(keys, numbers)?
            } else if holds == Holds::Color {
                colors(keys, kind, numbers)?
            } else {
                let storage = numbers.storage;
                (numbers.map(|v| ranged(v, keys.range)), storage)
            };
            Ok((samples(holds, [width, height], components), storage))
        }
    }
}

/// Refuses keys that mean nothing to the plane or its file.
fn check_keys(wanted: &Wanted, kind: Kind) -> Reason<()> {
    let Wanted { keys, row, .. } = wanted;
    let (is_depth, is_raw) = (wanted.is_depth(), kind == Kind::Raw);
    let holds = row.holds.plain();
    let (is_color, is_index) = (holds == Holds::Color, holds == Holds::Index);
    let is_vector = holds == Holds::Vector;
    let has_channels = matches!(kind, Kind::Exr | Kind::Png | Kind::Npz);
    let is_number = !is_index && holds != Holds::Count;
    for (key, given, means) in [
        ("channel", keys.channel.is_some(), has_channels),
        ("offset", keys.offset.is_some(), is_raw),
        ("row_stride", keys.row_stride.is_some(), is_raw),
        ("pixel_stride", keys.pixel_stride.is_some(), is_raw),
        ("empty", keys.empty.is_some(), is_depth || is_index),
        ("id_base", keys.id_base.is_some(), is_index),
        ("premultiplied", keys.premultiplied.is_some(), is_color),
        ("encoding", keys.encoding.is_some(), is_color || is_vector),
        ("range", keys.range.is_some(), is_number),
        ("meaning", wanted.own_depth.meaning.is_some(), is_depth),
        ("near", wanted.own_depth.near.is_some(), is_depth),
        ("far", wanted.own_depth.far.is_some(), is_depth),
    ] {
        if given && !means {
            let of = match (key, kind) {
                ("channel" | "offset" | "row_stride" | "pixel_stride", Kind::Exr) => "an EXR",
                ("channel" | "offset" | "row_stride" | "pixel_stride", Kind::Npy) => "an NPY",
                ("channel" | "offset" | "row_stride" | "pixel_stride", Kind::Npz) => "an NPZ",
                ("channel" | "offset" | "row_stride" | "pixel_stride", Kind::Png) => "a PNG",
                ("channel" | "offset" | "row_stride" | "pixel_stride", Kind::Raw) => "a raw file",
                ("channel" | "offset" | "row_stride" | "pixel_stride", Kind::Array) => "an array",
                _ if is_depth => "depths",
                _ => row.holds.words(),
            };
            return Err(format!("`{key}` does not apply to {of}: remove it"));
        }
    }
    Ok(())
}

/// Refuses an encoding that does not fit what the plane holds.
fn check_encoding(wanted: &Wanted) -> Reason<()> {
    let holds = wanted.row.holds;
    match wanted.keys.encoding {
        Some(Encoding::Octahedral) if holds != Holds::Normal => {
            let unit = "normal and projection.normal";
            Err(format!("encoding is octahedral, which needs unit vectors: {unit}"))
        }
        Some(Encoding::Linear | Encoding::Srgb) if holds.plain() == Holds::Vector => {
            Err("encoding is for colours; for vectors give \"octahedral\", or remove it".into())
        }
        _ => Ok(()),
    }
}

/// The two numbers of unit vectors, from -1 to 1, and a third that is 0 until they are decoded.
fn octahedral(keys: &PlaneKeys, numbers: Scaled) -> (Vec<Vec<f64>>, Storage) {
    let whole = keys.range.is_none() && numbers.format.is_unorm();
    let range = if whole { Some([-1.0, 1.0]) } else { keys.range };
    let [low, high] = range.unwrap_or([0.0, 1.0]);
    let storage = numbers.format.storage(high - low);
    let mut components = numbers.map(|v| ranged(v, range));
    let zeros = vec![0.0; components.first().map_or(0, Vec::len)];
    components.push(zeros);
    (components, storage)
}

/// The surfel indices of a plane.
fn indices(keys: &PlaneKeys, format: Format, numbers: &Numbers) -> Reason<Vec<u32>> {
    let base = f64::from(keys.id_base.unwrap_or(0));
    // By default an empty pixel has all bits set, or the number before the first surfel.
    let empty = keys.empty.unwrap_or(match (base > 0.0, numbers.file) {
        (true, _) => base - 1.0,
        (_, Format::I32) => -1.0,
        _ => NO_ID.into(),
    });
    let empty = numbers.file.nearest(empty);
    let id = |value: f64| if is(value, empty) { NO_ID.into() } else { value - base };
    wholes(format, numbers, NO_ID.into(), &id)
}

/// Whole numbers up to `most`, each passed through `whole`.
fn wholes(
    format: Format,
    numbers: &Numbers,
    most: f64,
    whole: &dyn Fn(f64) -> f64,
) -> Reason<Vec<u32>> {
    if format.codes().is_some() {
        let word = format.word();
        return Err(format!(
            "format is {word}, but indices and counts are whole: give u8, u16, u32, \
                            i32, f32 or f16"
        ));
    }
    let width = numbers.size[0] as usize;
    let wholes = numbers.components[0].iter().enumerate().map(|(i, &value)| {
        let (x, y) = (i % width, i / width);
        let found = whole(value);
        // A cast truncates, saturates, and turns NaN into 0; the round trip exposes all three.
        if f64::from(found as u32) != found || found > most {
            return Err(format!(
                "{value} at pixel ({x}, {y}) is not a whole number from 0 to {most}; set `empty` \
                 and `id_base`"
            ));
        }
        // From here on two different numbers may have been stored as one.
        let all = numbers.file.most_whole().at_most(format.most_whole());
        if value >= all && found < f64::from(NO_ID) {
            return Err(format!(
                "{value} at pixel ({x}, {y}), but the format is exact only below {all}; store them \
                 as u32"
            ));
        }
        Ok(found as u32)
    });
    wholes.collect()
}

/// Whether a stored number marks an empty pixel.
fn is(value: f64, empty: f64) -> bool {
    value == empty || (value.is_nan() && empty.is_nan())
}

/// Numbers and the format that they passed through.
struct Scaled {
    components: Vec<Vec<f64>>,
    /// The format that they passed through.
    format: Format,
    /// How exact they are as they stand.
    storage: Storage,
    /// The format that rounds a number as the file's numbers were rounded.
    stored: Format,
}

impl Scaled {
    fn new(keys: &PlaneKeys, format: Format, numbers: Numbers) -> Reason<Self> {
        let Numbers { file, mut components, size: [width, _] } = numbers;
        let codes = match format.codes() {
            Some(codes) => codes,
            None if format.is_whole() => {
                return Err(format!(
                    "whole numbers ({}), but the plane holds others; give the `format` that they \
                     passed through: unorm8, unorm16, unorm24",
                    format.word()
                ));
            }
            None => 1.0,
        };
        // An integer file stores codes of `format`, so that format decides the rounding.
        let stored = if file.is_whole() { format } else { file };
        if file.is_whole() {
            for (i, value) in components.iter_mut().flat_map(|c| c.iter_mut().enumerate()) {
                // A larger code shows that `format` is wrong.
                if *value > codes {
                    let (x, y) = (i % width as usize, i / width as usize);
                    let word = format.word();
                    return Err(format!("{value} at pixel ({x}, {y}) is not a code of {word}"));
                }
                *value /= codes;
            }
        }
        if keys.range.is_some() && !format.is_unorm() {
            let word = format.word();
            return Err(format!("`range` does not apply to {word}, only to unorm: remove it"));
        }
        let [low, high] = keys.range.unwrap_or([0.0, 1.0]);
        let storage = format.storage(high - low);
        Ok(Self { components, format, storage, stored })
    }

    /// Applies `value` to each number.
    fn map(mut self, value: impl Fn(f64) -> f64) -> Vec<Vec<f64>> {
        for component in &mut self.components {
            for number in component {
                *number = value(*number);
            }
        }
        self.components
    }
}

/// Converts stored numbers to depths t.
fn depths(keys: &PlaneKeys, numbers: Scaled) -> Reason<(Vec<Vec<f64>>, Storage)> {
    let meaning = keys.depth.meaning.unwrap_or_default();
    if keys.range.is_some() && meaning != Meaning::T {
        return Err(format!("`range` does not apply to {}: remove it", meaning.word()));
    }
    let (near, far) = ends(&keys.depth, meaning, "depth")?;
    let format = numbers.format;
    let storage = match meaning {
        Meaning::T => numbers.storage,
        _ => depth_storage(meaning, near, far, format),
    };
    let empty = match meaning {
        Meaning::T => f64::INFINITY,
        Meaning::Inverse | Meaning::NearOver | Meaning::ReversedZ => 0.0,
        Meaning::ZBuffer | Meaning::Linear => 1.0,
    };
    let empty = numbers.stored.nearest(keys.empty.unwrap_or(empty));
    let slope = 1.0 / near - 1.0 / far;
    let components = numbers.map(|v| match meaning {
        _ if is(v, empty) => f64::INFINITY,
        Meaning::T => ranged(v, keys.range),
        Meaning::Inverse => 1.0 / v,
        Meaning::NearOver => near / v,
        Meaning::ZBuffer => 1.0 / (1.0 / near - v * slope),
        Meaning::ReversedZ => 1.0 / (1.0 / far + v * slope),
        Meaning::Linear => near + v * (far - near),
    });
    Ok((components, storage))
}

/// How exactly depths are stored that mean something else than t.
fn depth_storage(meaning: Meaning, near: f64, far: f64, format: Format) -> Storage {
    match (meaning, format.codes()) {
        (Meaning::T, _) => format.storage(1.0),
        (Meaning::Inverse, _) => inverse(1.0, format),
        (Meaning::NearOver, _) => inverse(near, format),
        (Meaning::ZBuffer | Meaning::ReversedZ, Some(codes)) => {
            Storage::DepthBuffer { step: 1.0 / codes, near, far }
        }
        // For floats, take the step near 1, because nearly all of a depth buffer lies there.
        (Meaning::ZBuffer, None) => {
            let step = if format == Format::F16 { F16_LOSS.relative } else { F32_STEP };
            Storage::DepthBuffer { step, near, far }
        }
        // v is at most scale / t, so the relative error of a float is no larger.
        (Meaning::ReversedZ, None) => inverse(1.0 / (1.0 / near - 1.0 / far), format),
        (Meaning::Linear, _) => linear(near, far, format),
    }
}

/// How exactly a depth test compares depths: as `format` stores them, and as `f32` computes them
/// from t.
pub(super) fn depth_test(format: Format, keys: DepthKeys) -> Reason<Storage> {
    let meaning = keys.meaning.unwrap_or_default();
    let refused = |what: String| format!("depth-test: {what}");
    let (near, far) = ends(&keys, meaning, "depth-test").map_err(refused)?;
    if format.codes().is_none() && !matches!(format, Format::F32 | Format::F16) {
        return Err(refused(format!("format is {}; give f32, f16 or unorm", format.word())));
    }
    if meaning == Meaning::T && format.codes().is_some() {
        let what = format!("format is {}, which holds 0 to 1; give a `meaning`", format.word());
        return Err(refused(what));
    }
    let (relative, step) = (DIVISION.relative, DIVISION.relative);
    Ok(match depth_storage(meaning, near, far, format) {
        Storage::DepthBuffer { step: own, near, far } => {
            Storage::DepthBuffer { step: own + step, near, far }
        }
        Storage::Inverse { scale, relative: own, least } => {
            Storage::Inverse { scale, relative: own.at_least(relative), least }
        }
        Storage::Steps(own) => Storage::Steps(own + step * near.at_least(far)),
        other => other,
    })
}

/// Maps a number from [0, 1] to its range, if there is one.
#[inline]
fn ranged(v: f64, range: Option<[f64; 2]>) -> f64 {
    range.map_or(v, |[low, high]| low + v * (high - low))
}

/// The depths that 0 and 1 stand for, as far as a meaning has them.
pub(super) fn ends(keys: &DepthKeys, meaning: Meaning, table: &str) -> Reason<(f64, f64)> {
    let far = || keys.far.ok_or("far");
    let found = match (meaning, keys.near.ok_or("near")) {
        (Meaning::T | Meaning::Inverse, _) => return Ok((1.0, f64::INFINITY)),
        (Meaning::NearOver, near) => near.map(|near| (near, f64::INFINITY)),
        (_, near) => near.and_then(|near| Ok((near, far()?))),
    };
    let word = meaning.word();
    let (near, far) = found
        .map_err(|key| format!("meaning is {word}, which needs `{key}`: give it in [{table}]"))?;
    let can_be = match meaning {
        Meaning::Linear => near != far && near.is_finite() && far.is_finite(),
        _ => near > 0.0 && near < far,
    };
    if can_be {
        return Ok((near, far));
    }
    Err(format!("meaning is {word}, but near = {near} and far = {far} are impossible"))
}

/// How exactly `scale / t` is stored.
fn inverse(scale: f64, format: Format) -> Storage {
    let Loss { relative, least } = format.loss(DIVISION);
    Storage::Inverse { scale, relative, least }
}

/// How exactly `(t - near) / (far - near)` is stored.
fn linear(near: f64, far: f64, format: Format) -> Storage {
    match format {
        // An absolute error, because the difference keeps the errors of t and near.
        Format::F32 => Storage::Steps(F32_STEP * near.at_least(far)),
        Format::F16 => {
            let Loss { relative, least } = F16_LOSS;
            Storage::Linear { near, far, relative, least }
        }
        _ => format.storage(far - near),
    }
}

/// Converts stored numbers to linear light.
fn colors(keys: &PlaneKeys, kind: Kind, numbers: Scaled) -> Reason<(Vec<Vec<f64>>, Storage)> {
    let usual = if kind == Kind::Png { Encoding::Srgb } else { Encoding::Linear };
    match (keys.encoding.unwrap_or(usual), keys.range) {
        // `check_encoding` has refused octahedral colours.
        (Encoding::Linear | Encoding::Octahedral, range) => {
            let storage = numbers.storage;
            Ok((numbers.map(|v| ranged(v, range)), storage))
        }
        (Encoding::Srgb, None) => {
            let Loss { relative, least } = numbers.format.loss(POWER);
            Ok((numbers.map(srgb::to_linear), Storage::Srgb { relative, least }))
        }
        (Encoding::Srgb, Some(_)) => {
            Err("`range` does not apply to sRGB: remove it, or give encoding = \"linear\"".into())
        }
    }
}

fn samples(holds: Holds, [width, height]: [u32; 2], components: Vec<Vec<f64>>) -> Samples<f64> {
    match (holds, components.as_slice()) {
        (Holds::Color | Holds::Vector, [x, y, z]) => {
            let triples = x.iter().zip(y).zip(z).map(|((&x, &y), &z)| [x, y, z]).collect();
            let plane = Plane::from_values(width, height, triples);
            if holds == Holds::Color { Samples::Color(plane) } else { Samples::Vector(plane) }
        }
        _ => {
            let values = components.into_iter().next().unwrap_or_default();
            Samples::Scalar(Plane::from_values(width, height, values))
        }
    }
}
