//! Read 3D Gaussians from glTF and GLB with the extension `KHR_gaussian_splatting`.

mod accessors;
mod buffers;
mod json;
mod nodes;
mod primitive;
mod stretch;
#[cfg(test)]
mod tests;
mod write;

pub(super) use write::write;

use super::GaussianFile;
use crate::error::{Error, Result};
use crate::io::{Reason, far, input};
use crate::memory;
use crate::scene::GaussianArrays;
use crate::scene::gaussians::coefficients;
use accessors::Accessors;
use buffers::{Buffers, container};
use glam::{DVec3, Vec3};
use json::{Document, EXTENSION};
use nodes::Place;
use primitive::Part;
use std::path::Path;

/// How many times the length of the text its document may take.
const DOCUMENT_IN_MEMORY: u64 = 20;

/// Reads a file.
///
/// # Errors
/// As [`super::read`].
pub(super) fn read(path: &Path) -> Result<GaussianFile> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    let format = |what: String| Error::format(path, what);
    let container = container(&bytes).map_err(format)?;
    let document = document(container.text).map_err(format)?;
    let buffers = Buffers::read(&document, container.binary, path)?;
    join(&Accessors { document: &document, buffers: &buffers }).map_err(format)
}

/// Parses the text of a file, and checks that nothing in it is beyond this reader.
fn document(text: &[u8]) -> Reason<Document> {
    let length = text.len() as u64;
    memory::try_ask(length.saturating_mul(DOCUMENT_IN_MEMORY), || {
        format!("parsing {length} bytes of JSON")
    })?;
    let document: Document =
        serde_json::from_slice(text).map_err(|error| format!("no glTF: {error}"))?;
    let version = &document.asset.version;
    if !version.starts_with("2.") {
        return Err(format!("glTF of version {version:?}; only version 2 is read"));
    }
    // Materials and textures do not change Gaussians.
    let known = |name: &str| {
        [EXTENSION, "KHR_mesh_quantization"].contains(&name)
            || ["KHR_materials_", "KHR_texture_"].iter().any(|start| name.starts_with(start))
    };
    match document.extensions_required.iter().find(|name| !known(name)) {
        None => Ok(document),
        Some(name) => Err(format!(
            "the file requires the extension {name:?}, which splatref does not read; export it \
             without, uncompressed"
        )),
    }
}

/// Reads all primitives of Gaussians, and joins them in the order of the nodes.
fn join(accessors: &Accessors<'_>) -> Reason<GaussianFile> {
    let document = accessors.document;
    let mut parts: Vec<(Part, Place)> = Vec::new();
    let (mut others, mut warnings) = (0_u64, Vec::new());
    for (node, mesh, matrix) in nodes::meshes(document)? {
        let of = document.meshes.get(mesh).ok_or_else(|| buffers::missing("mesh", mesh))?;
        for (index, primitive) in of.primitives.iter().enumerate() {
            let Some(splatting) = &primitive.extensions.gaussians else {
                others += 1;
                continue;
            };
            let part = primitive::read(accessors, primitive, splatting, &mut warnings)
                .map_err(|what| format!("mesh {mesh}, primitive {index}: {what}"))?;
            parts.push((part, Place::new(node, &matrix)?));
        }
    }
    let Some((first, _)) = parts.first() else {
        return Err(format!(
            "no node of the scene draws a primitive with {EXTENSION}; splatref reads no meshes from \
             glTF: give a PLY or an OBJ"
        ));
    };
    if others > 0 {
        warnings.push(format!(
            "{others} primitives without {EXTENSION} are not drawn; a scene of 3D Gaussians has \
             nothing else"
        ));
    }
    let encoding = first.arrays.encoding;
    if parts.iter().any(|(part, _)| part.arrays.encoding != encoding) {
        return Err("primitives of different color spaces cannot be blended; give them one".into());
    }
    let logarithms = parts.iter().any(|(part, _)| part.has_negative_scale());
    let total: u64 = parts.iter().map(|(part, _)| part.arrays.position.len() as u64).sum();
    let degree = parts.iter().map(|(part, _)| part.arrays.degree).max().unwrap_or(0);
    let each = 68 + 12 * coefficients(degree) as u64;
    memory::try_ask(total * each, || format!("{total} Gaussians"))?;
    let mut all = Joined {
        arrays: GaussianArrays { degree, encoding, ..GaussianArrays::default() },
        wide: Vec::new(),
        moved: parts.iter().any(|(_, place)| !place.is_nowhere()),
    };
    for (part, place) in parts {
        all.add(part.activated(logarithms), &place);
    }
    let scales = match logarithms {
        true => "log scales, because some are negative, as in a draft of the extension",
        false => "linear scales",
    };
    let convention =
        format!("glTF with {EXTENSION}: {scales}, opacities in [0, 1], quaternion x y z w");
    all.finish(convention, warnings)
}

/// Primitives in one array, in their places.
struct Joined {
    arrays: GaussianArrays,
    /// Positions in f64, if a node moves something.
    wide: Vec<[f64; 3]>,
    moved: bool,
}

impl Joined {
    fn add(&mut self, mut part: GaussianArrays, place: &Place) {
        if self.moved {
            self.wide.extend(part.position.iter().map(|p| place.point(*p).to_array()));
        } else {
            self.arrays.position.append(&mut part.position);
        }
        place.apply(&mut part);
        self.arrays.scale.append(&mut part.scale);
        self.arrays.rotation.append(&mut part.rotation);
        self.arrays.opacity.append(&mut part.opacity);
        let (own, each) = (coefficients(part.degree), coefficients(self.arrays.degree));
        for coefficients in part.harmonics.chunks(own) {
            self.arrays.harmonics.extend_from_slice(coefficients);
            // What a lower degree lacks is 0.
            self.arrays.harmonics.extend((own..each).map(|_| Vec3::ZERO));
        }
    }

    fn finish(self, convention: String, mut warnings: Vec<String>) -> Reason<GaussianFile> {
        let Self { mut arrays, wide, moved } = self;
        let mut offset = DVec3::ZERO;
        if moved {
            let settled = far::settle(&wide, false)?;
            (arrays.position, offset) = (settled.position, settled.offset);
            warnings.extend(settled.warning);
        }
        Ok(GaussianFile { arrays, offset, convention, warnings })
    }
}
