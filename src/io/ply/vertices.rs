//! The element `vertex`: which property goes where, and how it is decoded.

use super::groups;
use super::header::{Element, PropertyKind, Scalar, quote};
use super::rows::Rows;
use super::values::{BodyValues, Event};
use crate::frame::Exec;
use crate::io::srgb;
use crate::scene::Cloud;
use glam::Vec3;
use std::ops::Range;
use std::sync::LazyLock;

/// The properties that are read, each with its place in a row.
const NAMES: [&str; 20] = [
    "x", "y", "z", "nx", "ny", "nz", "radius", "red", "green", "blue", "opacity", "tux", "tuy",
    "tuz", "tvx", "tvy", "tvz", "tx", "ty", "tz",
];
pub(super) const POSITION: Range<usize> = 0..3;
pub(super) const NORMAL: Range<usize> = 3..6;
pub(super) const RADIUS: Range<usize> = 6..7;
pub(super) const COLOR: Range<usize> = 7..10;
pub(super) const OPACITY: Range<usize> = 10..11;
pub(super) const TANGENTS: Range<usize> = 11..17;
pub(super) const TANGENT: Range<usize> = 17..20;

static SRGB_8: LazyLock<Vec<f32>> = LazyLock::new(|| srgb::table(u8::MAX.into()));
static SRGB_16: LazyLock<Vec<f32>> = LazyLock::new(|| srgb::table(u16::MAX));

/// How a number of the file becomes one of the cloud.
#[derive(Clone, Copy)]
pub(super) enum Decode {
    /// Rounded to `f32`.
    Keep,
    /// Divided by the code of 1, rounded to `f32`.
    Divide(f64),
    /// A code of sRGB, looked up.
    Srgb(&'static [f32]),
}

impl Decode {
    pub(super) fn apply(self, value: f64) -> f32 {
        match self {
            Self::Keep => value as f32,
            Self::Divide(one) => (value / one) as f32,
            Self::Srgb(table) => table[value as usize], // the type of the file bounds the code
        }
    }
}

/// What becomes of a property.
#[derive(Clone, Copy)]
pub(super) enum PropertyUse {
    Skip,
    /// A number goes to a place of the row.
    Number(usize, Decode),
    Group(groups::GroupPart),
}

/// What the vertices of a file hold.
pub(super) struct Layout {
    /// What becomes of each property.
    pub(super) slots: Vec<PropertyUse>,
    /// Whether each number of [`NAMES`] is there.
    given: [bool; NAMES.len()],
}

impl Layout {
    pub(super) fn new(element: &Element, groups: &groups::Reader) -> Result<Self, String> {
        let slots = element.properties.iter().map(|p| slot(&p.name, p.kind, groups));
        let slots: Vec<PropertyUse> = slots.collect::<Result<_, _>>()?;
        let mut given = [false; NAMES.len()];
        let numbers = slots.iter().filter_map(|slot| match slot {
            PropertyUse::Number(place, _) => Some(*place),
            PropertyUse::Skip | PropertyUse::Group(_) => None,
        });
        for place in numbers {
            if std::mem::replace(&mut given[place], true) {
                return Err("element vertex has both opacity and alpha; keep one".into());
            }
        }
        if !has(&given, POSITION)? {
            return Err("element vertex has no properties x, y, z; declare them".into());
        }
        Ok(Self { slots, given })
    }

    /// Gives `cloud` the arrays of what is there, empty.
    pub(super) fn arrays(&self, cloud: &mut Cloud) -> Result<(), String> {
        cloud.normal = has(&self.given, NORMAL)?.then(Vec::new);
        cloud.radius = has(&self.given, RADIUS)?.then(Vec::new);
        cloud.color = has(&self.given, COLOR)?.then(Vec::new);
        cloud.opacity = has(&self.given, OPACITY)?.then(Vec::new);
        cloud.tangents = has(&self.given, TANGENTS)?.then(Vec::new);
        cloud.tangent = has(&self.given, TANGENT)?.then(Vec::new);
        Ok(())
    }
}

/// Reads all vertices into the empty arrays of `cloud`.
pub(super) fn read(
    element: &Element,
    values: &mut BodyValues<'_>,
    cloud: &mut Cloud,
    groups: &mut groups::Reader,
    exec: &Exec,
) -> Result<(), String> {
    let layout = Layout::new(element, groups)?;
    layout.arrays(cloud)?;
    if let Some(rows) = Rows::new(element, &layout, values.format()) {
        let bytes = values.rows(element, rows.stride())?;
        rows.append(bytes, cloud, exec);
        return Ok(());
    }
    let mut row = [0.0; NAMES.len()];
    values.walk(element, |event| {
        match event {
            Event::Value(property, value) => match layout.slots[property] {
                PropertyUse::Skip => {}
                PropertyUse::Number(place, decode) => row[place] = decode.apply(value),
                PropertyUse::Group(part) => groups.put(part, value)?,
            },
            Event::End => {
                push(cloud, &row);
                groups.end();
            }
        }
        Ok(())
    })
}

/// Whether a vector is there, all of it or nothing.
fn has(given: &[bool], group: Range<usize>) -> Result<bool, String> {
    let missing = group.clone().find(|&i| !given[i]);
    let present = group.clone().find(|&i| given[i]);
    match (missing, present) {
        (None, _) => Ok(true),
        (Some(_), None) => Ok(false),
        (Some(missing), Some(present)) => Err(format!(
            "element vertex has property {} but no {}; declare all of the vector or rename what \
             is there",
            NAMES[present], NAMES[missing]
        )),
    }
}

/// What becomes of a property of this name and kind.
fn slot(name: &str, kind: PropertyKind, groups: &groups::Reader) -> Result<PropertyUse, String> {
    if let Some(part) = groups.part(name, kind)? {
        return Ok(PropertyUse::Group(part));
    }
    let name = if name == "alpha" { "opacity" } else { name };
    let Some(place) = NAMES.iter().position(|&known| known == name) else {
        return Ok(PropertyUse::Skip);
    };
    let PropertyKind::One(scalar) = kind else {
        let what = format!("property {} is a list, but must be one number", quote(name));
        return Err(format!("element vertex: {what}"));
    };
    if !COLOR.contains(&place) && !OPACITY.contains(&place) {
        return Ok(PropertyUse::Number(place, Decode::Keep));
    }
    let color = COLOR.contains(&place);
    let decode = match scalar {
        Scalar::F32 | Scalar::F64 => Decode::Keep,
        Scalar::U8 if color => Decode::Srgb(&SRGB_8),
        Scalar::U16 if color => Decode::Srgb(&SRGB_16),
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

/// Adds one vertex.
fn push(cloud: &mut Cloud, row: &[f32; NAMES.len()]) {
    let vector = |group: Range<usize>| Vec3::from_slice(&row[group]);
    cloud.position.push(vector(POSITION));
    if let Some(normals) = &mut cloud.normal {
        normals.push(vector(NORMAL));
    }
    if let Some(radii) = &mut cloud.radius {
        radii.push(row[RADIUS.start]);
    }
    if let Some(colors) = &mut cloud.color {
        colors.push(vector(COLOR));
    }
    if let Some(opacities) = &mut cloud.opacity {
        opacities.push(row[OPACITY.start]);
    }
    if let Some(tangents) = &mut cloud.tangents {
        let middle = TANGENTS.start + 3;
        tangents.push([vector(TANGENTS.start..middle), vector(middle..TANGENTS.end)]);
    }
    if let Some(tangents) = &mut cloud.tangent {
        tangents.push(vector(TANGENT));
    }
}
