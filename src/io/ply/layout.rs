//! Find the place of each property of a vertex, and how to decode it.

use super::decode::Decode;
use super::header::{Element, PropertyKind, Scalar, quote};
use super::{colors, groups};
use crate::scene::mipmap::MOST_LEVELS;
use crate::scene::{Cloud, Coordinates, Mipmap};
use glam::DVec3;
use std::ops::Range;

/// The properties that are read; the index of a name is its place in a row.
const NAMES: [&str; 22] = [
    "x", "y", "z", "nx", "ny", "nz", "radius", "red", "green", "blue", "opacity", "tux", "tuy",
    "tuz", "tvx", "tvy", "tvz", "tx", "ty", "tz", "u", "v",
];
/// Other names of some of them.
const ALIASES: [(&str, &str); 5] =
    [("alpha", "opacity"), ("s", "u"), ("t", "v"), ("texture_u", "u"), ("texture_v", "v")];
pub(super) const POSITION: Range<usize> = 0..3;
pub(super) const NORMAL: Range<usize> = 3..6;
pub(super) const RADIUS: Range<usize> = 6..7;
pub(super) const COLOR: Range<usize> = 7..10;
pub(super) const OPACITY: Range<usize> = 10..11;
pub(super) const TANGENTS: Range<usize> = 11..17;
pub(super) const TANGENT: Range<usize> = 17..20;
pub(super) const COORDINATE: Range<usize> = 20..22;
/// The first place of prefiltered colours; each level takes three.
pub(super) const MIPMAP: usize = 22;

/// How a property is used.
#[derive(Clone, Copy)]
pub(super) enum PropertyUse {
    Skip,
    /// The number goes to this place in the row.
    Number(usize, Decode),
    Group(groups::GroupPart),
}

/// The layout of a file's vertices.
pub(super) struct Layout {
    /// How each property is used.
    pub(super) slots: Vec<PropertyUse>,
    /// Whether the file has each number of [`NAMES`], and then each number of the levels up to the
    /// last.
    given: Vec<bool>,
}

impl Layout {
    /// `color_range` is the code of white, if the caller knows it.
    pub(super) fn new(
        element: &Element,
        groups: &groups::Reader,
        color_range: Option<f64>,
    ) -> Result<Self, String> {
        let named = |name: &str| element.properties.iter().any(|p| p.name == name);
        // `s` or `t` alone is a time or some other scalar.
        let pair = named("s") && named("t");
        let channels = colors::channels(element);
        let slots = element.properties.iter().enumerate().map(|(i, p)| match p.name.as_str() {
            "s" | "t" if !pair => Ok(PropertyUse::Skip),
            name => {
                let channel = channels.iter().position(|&channel| channel == Some(i));
                let color = channel.map(|channel| COLOR.start + channel);
                match color.map_or_else(|| prefiltered(name), |place| Ok(Some(place)))? {
                    Some(place) => {
                        let decode = colors::decode(element, i, color_range)?;
                        Ok(PropertyUse::Number(place, decode))
                    }
                    None => slot(name, p.kind, groups),
                }
            }
        });
        let slots: Vec<PropertyUse> = slots.collect::<Result<_, _>>()?;
        let numbers = slots.iter().filter_map(|slot| match slot {
            PropertyUse::Number(place, _) => Some(*place),
            PropertyUse::Skip | PropertyUse::Group(_) => None,
        });
        let last = numbers.clone().fold(NAMES.len() - 1, |last, place| last.max(place));
        let levels = (last + 1 - NAMES.len()).div_ceil(3);
        let mut given = vec![false; NAMES.len() + 3 * levels];
        for place in numbers {
            if std::mem::replace(&mut given[place], true) {
                let what = if COORDINATE.contains(&place) {
                    "several texture coordinates; keep u and v, s and t, or texture_u and texture_v"
                } else {
                    "both opacity and alpha; keep one"
                };
                return Err(format!("element vertex has {what}"));
            }
        }
        if !has(&given, POSITION)? {
            return Err("element vertex has no properties x, y, z; declare them".into());
        }
        if given[COORDINATE.start] != given[COORDINATE.start + 1] {
            let what = "one texture coordinate alone; declare u and v, or texture_u and texture_v";
            return Err(format!("element vertex has {what}"));
        }
        let colored = has(&given, COLOR)?;
        for level in 1..=levels {
            if !colored || !has(&given, level_places(level))? {
                let before = if level == 1 || !colored { COLOR } else { level_places(level - 1) };
                return Err(missing_level(&given, level, before.start));
            }
        }
        Ok(Self { slots, given })
    }

    /// Subtracts an offset from all positions.
    pub(super) fn shift(&mut self, offset: DVec3) {
        for slot in &mut self.slots {
            if let PropertyUse::Number(place, decode) = slot
                && POSITION.contains(place)
                && offset[*place - POSITION.start] != 0.0
            {
                *decode = Decode::Shift(offset[*place - POSITION.start]);
            }
        }
    }

    /// How many numbers a row has.
    pub(super) fn width(&self) -> usize {
        self.given.len()
    }

    /// How many levels of prefiltered colours there are.
    fn levels(&self) -> usize {
        (self.given.len() - NAMES.len()) / 3
    }

    /// Gives `cloud` an empty array for each attribute; no texture coordinates of vertices if
    /// corners have them.
    pub(super) fn arrays(&self, cloud: &mut Cloud) -> Result<(), String> {
        cloud.normal = has(&self.given, NORMAL)?.then(Vec::new);
        cloud.radius = has(&self.given, RADIUS)?.then(Vec::new);
        cloud.color = has(&self.given, COLOR)?.then(Vec::new);
        cloud.opacity = has(&self.given, OPACITY)?.then(Vec::new);
        cloud.tangents = has(&self.given, TANGENTS)?.then(Vec::new);
        cloud.tangent = has(&self.given, TANGENT)?.then(Vec::new);
        if has(&self.given, COORDINATE)? && cloud.coordinates.is_none() {
            cloud.coordinates = Some(Coordinates::Points(Vec::new()));
        }
        let levels = self.levels();
        cloud.mipmap = (levels > 0).then(|| Mipmap::empty(levels));
        Ok(())
    }
}

/// Whether a vector is declared; an error if only a part of it is.
fn has(given: &[bool], group: Range<usize>) -> Result<bool, String> {
    let missing = group.clone().find(|&i| !given[i]);
    let present = group.clone().find(|&i| given[i]);
    match (missing, present) {
        (None, _) => Ok(true),
        (Some(_), None) => Ok(false),
        (Some(missing), Some(present)) => Err(format!(
            "element vertex has property {} but no {}; declare all of the vector or rename what \
             is there",
            name(present),
            name(missing)
        )),
    }
}

/// The places of a level, from 1 on.
fn level_places(level: usize) -> Range<usize> {
    MIPMAP + 3 * (level - 1)..MIPMAP + 3 * level
}

/// The name of the property of a place.
fn name(place: usize) -> String {
    match place.checked_sub(MIPMAP) {
        None => NAMES[place].into(),
        Some(beyond) => format!("mip{}_{}", beyond / 3 + 1, NAMES[COLOR.start + beyond % 3]),
    }
}

/// The place of a prefiltered colour, if a property is named like one: `mip3_green`.
fn prefiltered(name: &str) -> Result<Option<usize>, String> {
    let Some((level, color)) = name.strip_prefix("mip").and_then(|rest| rest.split_once('_'))
    else {
        return Ok(None);
    };
    let channel = NAMES[COLOR].iter().position(|&known| known == color);
    let digits = !level.is_empty() && level.bytes().all(|b| b.is_ascii_digit());
    let Some(channel) = channel.filter(|_| digits && !level.starts_with('0')) else {
        return Ok(None);
    };
    match level.parse() {
        Ok(level @ 1..=MOST_LEVELS) => Ok(Some(level_places(level).start + channel)),
        _ => Err(format!(
            "element vertex has property {}, but prefiltered colours have at most {MOST_LEVELS} \
             levels; remove those above",
            quote(name)
        )),
    }
}

/// The error for a level that lacks a number, or lacks the level before it.
fn missing_level(given: &[bool], level: usize, before: usize) -> String {
    let first = (level_places(level).start..given.len()).find(|&place| given[place]);
    let there = name(first.unwrap_or(MIPMAP));
    let missing = if given[before] { level_places(level).start } else { before };
    format!(
        "element vertex has property {there} but no {}; levels are declared from 1 on, beside red, \
         green, blue",
        name(missing)
    )
}

/// How a property of this name and kind is used, if it is no colour.
fn slot(name: &str, kind: PropertyKind, groups: &groups::Reader) -> Result<PropertyUse, String> {
    if let Some(part) = groups.part(name, kind)? {
        return Ok(PropertyUse::Group(part));
    }
    let name = ALIASES.iter().find(|(alias, _)| *alias == name).map_or(name, |(_, name)| name);
    let known = NAMES.iter().position(|&known| known == name);
    let Some(place) = known else { return Ok(PropertyUse::Skip) };
    let PropertyKind::One(scalar) = kind else {
        let what = format!("property {} is a list, but must be one number", quote(name));
        return Err(format!("element vertex: {what}"));
    };
    // Only colours and opacities have codes; other integers are numbers.
    if !OPACITY.contains(&place) {
        return Ok(PropertyUse::Number(place, Decode::Keep));
    }
    let decode = match scalar {
        Scalar::F32 | Scalar::F64 => Decode::Keep,
        Scalar::U8 => Decode::Divide(u8::MAX.into()),
        Scalar::U16 => Decode::Divide(u16::MAX.into()),
        Scalar::I8 | Scalar::I16 | Scalar::I32 | Scalar::U32 => {
            return Err(format!(
                "element vertex: property {} has type {}, but its range is known for uchar, \
                 ushort, float and double only",
                quote(name),
                scalar.name()
            ));
        }
    };
    Ok(PropertyUse::Number(place, decode))
}
