//! Find the colours of vertices and faces, decode them, and doubt the ones that cannot be meant.

use super::decode::Decode;
use super::header::{Element, PropertyKind, Scalar, quote};
use crate::number::{Real, srgb};
use glam::Vec3;
use std::sync::LazyLock;

/// The names of the channels. Other programs use those after the first.
const FAMILIES: [[&str; 3]; 3] =
    [["red", "green", "blue"], ["diffuse_red", "diffuse_green", "diffuse_blue"], ["r", "g", "b"]];

static SRGB_8: LazyLock<Vec<f32>> = LazyLock::new(|| srgb::table(u8::MAX.into()));
static SRGB_16: LazyLock<Vec<f32>> = LazyLock::new(|| srgb::table(u16::MAX));

/// The channel that each property means: the first family of which the element has all channels.
///
/// `Decided:` `red`, `green` and `blue` win, even if one of them is missing, which is an error. The
/// other names count in any case of letters, and only all three together, because `r` alone is a
/// radius or a range.
pub(super) fn channels(element: &Element) -> [Option<usize>; 3] {
    let exact = |name: &str| element.properties.iter().position(|p| p.name == name);
    let own = FAMILIES[0].map(exact);
    if own.iter().any(Option::is_some) {
        return own;
    }
    let is_one = |kind| matches!(kind, PropertyKind::One(_));
    let alike = |name: &str| {
        let mut properties = element.properties.iter();
        properties.position(|p| p.name.eq_ignore_ascii_case(name) && is_one(p.kind))
    };
    let found = FAMILIES.map(|family| family.map(alike));
    found.into_iter().find(|family| family.iter().all(Option::is_some)).unwrap_or([None; 3])
}

/// How a colour of this property is decoded; `range` is the code of white, if the caller knows it.
pub(super) fn decode(
    element: &Element,
    property: usize,
    range: Option<f64>,
) -> Result<Decode, String> {
    let property = &element.properties[property];
    let PropertyKind::One(scalar) = property.kind else {
        let what = format!("property {} is a list, but must be one number", quote(&property.name));
        return Err(format!("element {}: {what}", element.name));
    };
    Ok(match (range, scalar) {
        (Some(range), _) => Decode::Encoded(range),
        (None, Scalar::F32 | Scalar::F64) => Decode::Keep,
        (None, Scalar::U8) => Decode::Srgb(&SRGB_8),
        (None, Scalar::U16) => Decode::Srgb(&SRGB_16),
        // Nobody uses the range of these types: they hold bytes.
        (None, Scalar::I16 | Scalar::I32 | Scalar::U32) => Decode::Encoded(255.0),
        (None, Scalar::I8) => {
            return Err(format!(
                "element {}: property {} has type char, which cannot hold a colour of 0 to 255; \
                 declare it as uchar, or give `color_range` in a scene file",
                element.name,
                quote(&property.name)
            ));
        }
    })
}

/// Says what is wrong with colours whose range is not that of their type, and what mends it.
pub(super) fn doubt(element: &Element, range: Option<f64>, colors: &[Vec3]) -> Option<String> {
    let property = channels(element)[0]?;
    let PropertyKind::One(scalar) = element.properties[property].kind else { return None };
    let most = colors.iter().filter(|c| c.is_finite()).map(|c| c.max_element());
    let most = most.fold(0.0, Real::at_least);
    let mend = |range| {
        format!("if they are codes of 0 to {range}, write `color_range = {range}` in a scene file")
    };
    match (range, scalar) {
        (Some(range), _) if most > 1.0 => {
            Some(format!("colours are greater than their color_range of {range}"))
        }
        // Reflectances are at most 1, and few programs go far beyond.
        (None, Scalar::F32 | Scalar::F64) if most > 8.0 => {
            let range = if most > 255.0 { 65535 } else { 255 };
            let what = format!("colours reach {most}, but float colours are linear and white is 1");
            Some(format!("{what}; {}", mend(range)))
        }
        (None, Scalar::U16) if most > 0.0 && most <= SRGB_16[255] => {
            let what = "no 16-bit colour is above 255, where white is 65535: all is almost black";
            Some(format!("{what}; {}", mend(255)))
        }
        (None, Scalar::I16 | Scalar::I32 | Scalar::U32) if most > 1.0 => {
            let what = "colours of integers are greater than 255, which is white";
            Some(format!("{what}; {}", mend(65535)))
        }
        _ => None,
    }
}
