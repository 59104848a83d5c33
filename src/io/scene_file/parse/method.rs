//! The tables of the method and of the groups.

use super::super::{ExtensionChoice, GroupChoice, MethodChoice, words};
use crate::index::grouping::Coplanar;
use crate::splat::Epsilon;
use serde::de::{Deserialize, Deserializer, Visitor};
use std::fmt;

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawMethod {
    name: Option<String>,
    kernel: Option<String>,
    outline: Option<String>,
    cutoff: Option<f32>,
    low_pass: Option<f32>,
    epsilon: Option<RawEpsilon>,
    cull: Option<bool>,
    depth: Option<String>,
    bins: Option<u32>,
    holes: Option<String>,
    refraction: Option<[f32; 3]>,
    bends: Option<String>,
    peel: Option<u32>,
    weights: Option<String>,
    occluded: Option<String>,
    subpixel_bits: Option<u32>,
    template: Option<u32>,
    levels: Option<String>,
}

impl RawMethod {
    pub(super) fn choice(self) -> Result<MethodChoice, String> {
        let choice = MethodChoice {
            name: self.name.map(|word| words::method(&word)).transpose()?,
            kernel: self.kernel.map(|word| words::kernel(&word)).transpose()?,
            outline: self.outline.map(|word| words::outline(&word)).transpose()?,
            cutoff: self.cutoff,
            low_pass: self.low_pass,
            epsilon: self.epsilon.map(|epsilon| epsilon.0),
            cull: self.cull,
            voronoi: self.depth.map(|word| words::depth(&word)).transpose()?,
            bins: self.bins,
            holes: self.holes.map(|word| words::holes(&word)).transpose()?,
            refraction: self.refraction,
            bends: self.bends.map(|word| words::bends(&word)).transpose()?,
            peel: self.peel,
            weights: self.weights.map(|word| words::weights(&word)).transpose()?,
            occluded: self.occluded.map(|word| words::occluded(&word)).transpose()?,
            subpixel_bits: self.subpixel_bits,
            template: self.template,
            levels: self.levels.map(|word| words::levels(&word)).transpose()?,
        };
        choice.method().map_err(|error| error.to_string())?;
        Ok(choice)
    }
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawGroups {
    overlap: Option<f32>,
    opposite: Option<bool>,
    coplanar: Option<RawCoplanar>,
    count: Option<usize>,
    extend: Option<String>,
    most: Option<f32>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCoplanar {
    cosine: f32,
    offset: f32,
    color: f32,
}

impl RawGroups {
    pub(super) fn choice(self) -> Result<GroupChoice, String> {
        let coplanar = self.coplanar.map(|raw| Coplanar {
            cosine: raw.cosine,
            offset: raw.offset,
            color: raw.color,
        });
        let extension: Option<ExtensionChoice> =
            self.extend.map(|word| words::extension(&word)).transpose()?;
        let choice = GroupChoice {
            overlap: self.overlap,
            opposite: self.opposite,
            coplanar,
            count: self.count,
            extension,
            most: self.most,
        };
        choice.check().map_err(|error| error.to_string())?;
        Ok(choice)
    }
}

/// A number of world units, or a text as [`words::epsilon`] reads it.
struct RawEpsilon(Epsilon);

impl<'de> Deserialize<'de> for RawEpsilon {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Either;
        impl Visitor<'_> for Either {
            type Value = Epsilon;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number of world units or a text such as \"1.5r\"")
            }
            fn visit_f64<E>(self, value: f64) -> Result<Epsilon, E> {
                Ok(Epsilon::World(value as f32))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Epsilon, E> {
                Ok(Epsilon::World(value as f32))
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Epsilon, E> {
                words::epsilon(text).map_err(E::custom)
            }
        }
        from.deserialize_any(Either).map(Self)
    }
}
