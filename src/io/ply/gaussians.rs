//! Recognize files of 3D Gaussians, read them, and refuse them where points are read.

use super::header::{self, Element, PlyHeader, PropertyKind, Scalar, quote};
use super::values::{BodyValues, Event};
use super::vertex;
use crate::error::{Error, Result};
use crate::io::activation::{GaussianFile, opacity, scale};
use crate::io::{Reason, far, input};
use crate::memory;
use crate::scene::GaussianArrays;
use crate::scene::gaussians::{Encoding, coefficients};
use glam::Vec3;
use std::io::Read;
use std::path::Path;

/// A file with a longer header is not recognized by its start.
const MOST_HEADER: u64 = 1 << 20;

/// How the vertices of a file store Gaussians.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// One property for each number.
    Plain,
    /// Several numbers in one property.
    Packed,
}

/// How the vertices store Gaussians, if they do.
fn kind(vertices: &Element) -> Option<Kind> {
    let has = |names: &[&str]| {
        vertices.properties.iter().any(|property| names.contains(&property.name.as_str()))
    };
    let shaped = has(&["scale_0", "scaling_0"]) && has(&["rot_0", "rotation_0"]);
    if has(&["packed_position", "packed_rotation", "packed_scale"]) {
        Some(Kind::Packed)
    } else {
        (shaped || has(&["f_dc_0", "f_rest_0"])).then_some(Kind::Plain)
    }
}

/// Refuses vertices that are 3D Gaussians, whether they are stored plainly or packed.
///
/// Their opacities are logits, their scales are logarithms and their colours are coefficients of
/// spherical harmonics, so that a picture of them as points would be silently wrong.
pub(super) fn check(header: &PlyHeader) -> Reason<()> {
    match kind(vertex(header)?) {
        None => Ok(()),
        Some(Kind::Plain) => Err("this PLY holds 3D Gaussians: opacities are logits, scales are \
                                  logarithms; only `--method gaussians` draws them; give a point \
                                  cloud or a mesh"
            .into()),
        Some(Kind::Packed) => Err(PACKED.into()),
    }
}

const PACKED: &str = "this PLY holds compressed 3D Gaussians, as SuperSplat and PlayCanvas write \
                      them; splatref does not read them: export them as a plain PLY";

/// Whether the file at `path` is a PLY of 3D Gaussians, by its header.
pub(in crate::io) fn holds_gaussians(path: &Path) -> bool {
    let mut bytes = Vec::new();
    let read =
        input::open(path).and_then(|(file, _)| file.take(MOST_HEADER).read_to_end(&mut bytes));
    let Ok(header) = read.map_err(|_| ()).and_then(|_| header::parse(&bytes).map_err(|_| ()))
    else {
        return false;
    };
    vertex(&header).is_ok_and(|vertices| kind(vertices).is_some())
}

/// Reads a file of 3D Gaussians.
///
/// # Errors
/// As [`crate::io::gaussians::read`].
pub(in crate::io) fn read_gaussians(path: &Path) -> Result<GaussianFile> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    parse_gaussians(&bytes).map_err(|what| Error::format(path, what))
}

/// The places of a row that do not belong to `f_rest_*`.
const NAMES: [&str; 14] = [
    "x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3", "opacity",
    "f_dc_0", "f_dc_1", "f_dc_2",
];
const SCALE: usize = 3;
const ROTATION: usize = 6;
const OPACITY: usize = 10;
const FIRST: usize = 11;
const REST: usize = NAMES.len();

/// Where the numbers of a row go.
struct Places {
    /// For each property, its place in a row.
    of: Vec<Option<usize>>,
    degree: u32,
    /// Whether there are only two scales.
    flat: bool,
    /// Whether positions have more digits than `f32`.
    wide: bool,
}

impl Places {
    fn new(vertices: &Element) -> Reason<Self> {
        let place = |name: &str| {
            let rest = || name.strip_prefix("f_rest_")?.parse::<usize>().ok();
            let known = NAMES.iter().position(|&known| known == name);
            known.or_else(|| rest().and_then(|rest| REST.checked_add(rest)))
        };
        let mut of = Vec::new();
        let mut wide = false;
        for property in &vertices.properties {
            let place = place(&property.name);
            if let Some(place) = place {
                let name = quote(&property.name);
                match property.kind {
                    PropertyKind::One(Scalar::F32) => {}
                    PropertyKind::One(Scalar::F64) => wide |= place < SCALE,
                    PropertyKind::One(other) => {
                        let other = other.name();
                        return Err(format!(
                            "element vertex: property {name} has type {other}, but numbers of \
                             Gaussians are float or double"
                        ));
                    }
                    PropertyKind::List { .. } => {
                        return Err(format!(
                            "element vertex: property {name} is a list, but must be one number"
                        ));
                    }
                }
            }
            of.push(place);
        }
        let has = |place: usize| of.contains(&Some(place));
        let missing = (0..REST).find(|&place| !has(place) && NAMES[place] != "scale_2");
        if let Some(missing) = missing {
            return Err(format!(
                "this PLY holds 3D Gaussians, but element vertex has no property `{}`; declare x y \
                 z, scale_0 to scale_2, rot_0 to rot_3, opacity, and f_dc_0 to f_dc_2",
                NAMES[missing]
            ));
        }
        let degree = degree(&of)?;
        let flat = !has(SCALE + 2);
        Ok(Self { of, degree, flat, wide })
    }
}

/// The degree for the properties `f_rest_*`.
fn degree(places: &[Option<usize>]) -> Reason<u32> {
    let count = places.iter().flatten().filter(|&&place| place >= REST).count();
    let Some(degree) = (0..=3).find(|&degree| 3 * (coefficients(degree) - 1) == count) else {
        return Err(format!(
            "element vertex has {count} properties f_rest_*; give 0, 9, 24 or 45, for degree 0, 1, \
             2 or 3 of the spherical harmonics"
        ));
    };
    match (0..count).find(|rest| !places.contains(&Some(REST + rest))) {
        None => Ok(degree),
        Some(missing) => Err(format!(
            "element vertex has {count} properties f_rest_*, but no `f_rest_{missing}`; number \
             them from 0 on"
        )),
    }
}

/// Reads the bytes of a file of 3D Gaussians.
pub(in crate::io) fn parse_gaussians(bytes: &[u8]) -> Reason<GaussianFile> {
    let header = header::parse(bytes)?;
    let vertices = vertex(&header)?;
    match kind(vertices) {
        Some(Kind::Plain) => {}
        Some(Kind::Packed) => return Err(PACKED.into()),
        None => {
            return Err("this PLY holds no Gaussians: element vertex has neither `f_dc_0`, nor \
                        `scale_0` and `rot_0`"
                .into());
        }
    }
    let places = Places::new(vertices)?;
    let each = 44 + 24 * u64::from(places.wide) + 12 * coefficients(places.degree) as u64;
    let most = vertices.count.min(bytes.len() as u64);
    memory::try_ask(most * each, || format!("{} Gaussians", vertices.count))?;
    let mut rows = Rows::new(&places);
    // Each number takes at least a byte, or else the reader refuses the count later.
    if vertices.count.saturating_mul(vertices.properties.len() as u64) <= bytes.len() as u64 {
        rows.reserve(vertices.count as usize, &places);
    }
    let mut values = BodyValues::new(bytes, &header);
    for element in &header.elements {
        let is_vertices = std::ptr::eq(element, vertices);
        let mut row = [0.0; REST + 45];
        values.walk(element, |event| {
            match event {
                _ if !is_vertices => {}
                Event::Value(property, value) => {
                    if let Some(place) = places.of[property] {
                        row[place] = value;
                    }
                }
                Event::End => rows.push(&row, &places),
            }
            Ok(())
        })?;
    }
    values.finish()?;
    rows.finish(&header, &places)
}

/// The Gaussians that were read.
struct Rows {
    arrays: GaussianArrays,
    /// Positions in f64, if the file has such.
    wide: Vec<[f64; 3]>,
    /// Whether all scales and opacities could be activated numbers.
    activated: bool,
}

impl Rows {
    fn new(places: &Places) -> Self {
        let (degree, encoding) = (places.degree, Encoding::Srgb);
        let arrays = GaussianArrays { degree, encoding, ..GaussianArrays::default() };
        Self { arrays, wide: Vec::new(), activated: true }
    }

    /// Makes room, so that no array is copied while it grows.
    fn reserve(&mut self, count: usize, places: &Places) {
        if places.wide {
            self.wide.reserve_exact(count);
        } else {
            self.arrays.position.reserve_exact(count);
        }
        self.arrays.scale.reserve_exact(count);
        self.arrays.rotation.reserve_exact(count);
        self.arrays.opacity.reserve_exact(count);
        self.arrays.harmonics.reserve_exact(count * coefficients(places.degree));
    }

    fn push(&mut self, row: &[f64; REST + 45], places: &Places) {
        let arrays = &mut self.arrays;
        let vector = |first: usize, step: usize| {
            let of = |channel: usize| row[first + channel * step] as f32;
            Vec3::new(of(0), of(1), of(2))
        };
        if places.wide {
            self.wide.push([row[0], row[1], row[2]]);
        } else {
            arrays.position.push(vector(0, 1));
        }
        let third = if places.flat { 0.0 } else { scale(row[SCALE + 2]) };
        arrays.scale.push(Vec3::new(scale(row[SCALE]), scale(row[SCALE + 1]), third));
        let [w, x, y, z] = [0, 1, 2, 3].map(|part| row[ROTATION + part] as f32);
        arrays.rotation.push([x, y, z, w]);
        arrays.opacity.push(opacity(row[OPACITY]));
        arrays.harmonics.push(vector(FIRST, 1));
        let rest = coefficients(places.degree) - 1;
        arrays.harmonics.extend((0..rest).map(|k| vector(REST + k, rest)));
        let scales = &row[SCALE..SCALE + if places.flat { 2 } else { 3 }];
        self.activated &=
            scales.iter().all(|&scale| scale >= 0.0) && (0.0..=1.0).contains(&row[OPACITY]);
    }

    fn finish(self, header: &PlyHeader, places: &Places) -> Reason<GaussianFile> {
        let Self { mut arrays, wide, activated } = self;
        let mut offset = header.offset.unwrap_or_default();
        let mut warnings = Vec::new();
        if places.wide {
            let settled = far::settle(&wide, false)?;
            arrays.position = settled.position;
            offset += settled.offset;
            warnings.extend(settled.warning);
        }
        // Fewer may be so by chance.
        if activated && arrays.opacity.len() >= 8 {
            warnings.push(
                "no scale is negative and every opacity is in [0, 1], as if they were no \
                 logarithms and logits; if the picture is wrong, write logarithms and logits"
                    .into(),
            );
        }
        let what = if places.flat {
            "PLY of 2D Gaussians: two log scales, the third scale is 0, logit opacities"
        } else {
            "PLY of 3D Gaussians: log scales, logit opacities"
        };
        let hint = if places.flat { "; draw it with --preset 2dgs" } else { "" };
        let convention = format!("{what}, quaternion w first{hint}");
        Ok(GaussianFile { arrays, offset, convention, warnings })
    }
}
