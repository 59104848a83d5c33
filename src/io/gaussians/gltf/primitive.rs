//! Read one primitive of Gaussians.

use super::accessors::{Accessors, Allowed, F32};
use super::json::{EXTENSION, Primitive, Splatting};
use crate::io::Reason;
use crate::io::activation;
use crate::scene::GaussianArrays;
use crate::scene::gaussians::{Encoding, MAX_DEGREE};
use glam::Vec3;

/// The Gaussians of a primitive, where its file has them.
pub(super) struct Part {
    pub(super) arrays: GaussianArrays,
    /// Whether scales are stored as floats, and so may be logarithms.
    float_scales: bool,
}

impl Part {
    /// Whether a scale is negative, which only a logarithm may be.
    pub(super) fn has_negative_scale(&self) -> bool {
        self.float_scales && self.arrays.scale.iter().any(|scale| scale.cmplt(Vec3::ZERO).any())
    }

    /// The Gaussians with scales, which may have been logarithms.
    pub(super) fn activated(self, logarithms: bool) -> GaussianArrays {
        let Self { mut arrays, float_scales } = self;
        if logarithms && float_scales {
            let of = |scale: f32| activation::scale(scale.into());
            arrays.scale.iter_mut().for_each(|scale| {
                *scale = Vec3::new(of(scale.x), of(scale.y), of(scale.z));
            });
        }
        arrays
    }
}

/// Reads a primitive, and adds what is to be doubted about it, each once.
pub(super) fn read(
    accessors: &Accessors<'_>,
    primitive: &Primitive,
    splatting: &Splatting,
    warnings: &mut Vec<String>,
) -> Reason<Part> {
    if primitive.mode != Some(0) {
        return Err(
            "Gaussians have mode 0 (POINTS), but the primitive has another; correct it".into()
        );
    }
    let encoding = color_space(splatting)?;
    for what in doubts(primitive, splatting) {
        if !warnings.contains(&what) {
            warnings.push(what);
        }
    }
    let attribute = |name: &str| {
        primitive.attributes.get(name).copied().ok_or_else(|| {
            let early = primitive.attributes.contains_key("_ROTATION");
            let compressed = splatting.extensions.keys().next();
            let why = match (early, compressed) {
                (_, Some(name)) => {
                    format!("they are compressed with {name:?}; export them uncompressed")
                }
                (true, None) => {
                    "the file follows an early draft of the extension; export it again".into()
                }
                (false, None) => "Gaussians need it".into(),
            };
            format!("there is no attribute {name}: {why}")
        })
    };
    let own = |name: &str| attribute(&format!("{EXTENSION}:{name}"));
    let (position, scale) = (attribute("POSITION")?, own("SCALE")?);
    let (rotation, opacity) = (own("ROTATION")?, own("OPACITY")?);
    let count = accessors.get(position)?.count;
    let vectors = |name: &str, index: usize, allowed: Allowed| -> Reason<Vec<Vec3>> {
        let found = same(accessors.read(index, allowed), name, count)?;
        Ok(found.into_iter().map(Vec3::from_array).collect())
    };
    let mut arrays = GaussianArrays {
        position: vectors("POSITION", position, Allowed::Any)?,
        scale: vectors("SCALE", scale, Allowed::AnyUnsigned)?,
        rotation: same(accessors.read(rotation, Allowed::Signed), "ROTATION", count)?,
        opacity: Vec::new(),
        degree: degree(primitive)?,
        harmonics: Vec::new(),
        encoding,
    };
    let opacities = same(accessors.read(opacity, Allowed::Unsigned), "OPACITY", count)?;
    arrays.opacity = opacities.into_iter().map(|[opacity]| opacity).collect();
    let mut coefficients = Vec::new();
    for (name, _) in names(arrays.degree) {
        coefficients.push(vectors(&name, own(&name)?, Allowed::Float)?);
    }
    let rows = 0..count as usize;
    arrays.harmonics = rows.flat_map(|i| coefficients.iter().map(move |all| all[i])).collect();
    let float_scales = accessors.get(scale)?.component_type == F32;
    Ok(Part { arrays, float_scales })
}

/// An attribute that has as many elements as the positions.
fn same<T>(found: Reason<Vec<T>>, name: &str, count: u64) -> Reason<Vec<T>> {
    let found = found.map_err(|what| format!("{name}: {what}"))?;
    if found.len() as u64 != count {
        return Err(format!(
            "{} of {name}, but {count} of POSITION: the file is damaged",
            found.len()
        ));
    }
    Ok(found)
}

/// The attributes of all coefficients up to a degree, without the prefix, with their degrees.
fn names(degree: u32) -> impl Iterator<Item = (String, u32)> {
    (0..=degree).flat_map(|l| (0..=2 * l).map(move |n| (format!("SH_DEGREE_{l}_COEF_{n}"), l)))
}

/// The degree of the coefficients, of which each degree must be whole.
fn degree(primitive: &Primitive) -> Reason<u32> {
    let has = |name: &str| primitive.attributes.contains_key(&format!("{EXTENSION}:{name}"));
    let degree = names(MAX_DEGREE).filter(|(name, _)| has(name)).map(|(_, l)| l).max().unwrap_or(0);
    match names(degree).find(|(name, _)| !has(name)) {
        None => Ok(degree),
        Some((missing, _)) if degree == 0 => {
            Err(format!("there is no attribute {EXTENSION}:{missing}: Gaussians need it"))
        }
        Some((missing, _)) => Err(format!(
            "there are coefficients of degree {degree}, but no attribute {EXTENSION}:{missing}; give \
             all of each degree"
        )),
    }
}

fn color_space(splatting: &Splatting) -> Reason<Encoding> {
    let found = splatting.color_space.as_deref();
    let all = [Encoding::Srgb, Encoding::Linear];
    let known = all.into_iter().find(|encoding| found == Some(encoding.name()));
    known.ok_or_else(|| {
        let [srgb, linear] = all.map(Encoding::name);
        match found {
            None => format!("there is no colorSpace; give {srgb} or {linear}"),
            Some(other) => format!("colorSpace {other:?}; give {srgb} or {linear}"),
        }
    })
}

/// What the file asks for that is not done.
fn doubts(primitive: &Primitive, splatting: &Splatting) -> Vec<String> {
    let choices = [
        ("kernel", &splatting.kernel, "ellipse"),
        ("projection", &splatting.projection, "perspective"),
        ("sortingMethod", &splatting.sorting_method, "cameraDistance"),
    ];
    let other = choices.into_iter().filter_map(|(key, found, known)| {
        let found = found.as_deref().filter(|found| *found != known)?;
        Some(format!("{key} {found:?} is not known, and is taken for {known:?}"))
    });
    let read: Vec<String> = names(MAX_DEGREE)
        .map(|(name, _)| name)
        .chain(["ROTATION", "SCALE", "OPACITY"].map(String::from))
        .collect();
    let unread = primitive.attributes.keys().filter_map(|name| {
        let own = name.strip_prefix(EXTENSION)?.strip_prefix(':')?;
        (!read.iter().any(|known| known == own)).then(|| format!("attribute {name:?} is not read"))
    });
    other.chain(unread).collect()
}
