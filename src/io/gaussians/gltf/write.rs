//! Write 3D Gaussians as GLB with the extension `KHR_gaussian_splatting`.

use super::buffers::{BINARY, JSON};
use super::json::EXTENSION;
use crate::io::Reason;
use crate::scene::Gaussians;
use glam::{DVec3, Vec3};
use serde_json::{Map, Value, json};
use std::io::{self, Write};

/// Arrays of floats behind each other, as the document describes them.
#[derive(Default)]
struct Arrays {
    attributes: Map<String, Value>,
    accessors: Vec<Value>,
    views: Vec<Value>,
    /// Bytes so far.
    length: u64,
}

impl Arrays {
    /// Adds `count` elements of `width` floats, and `more` keys of their accessor.
    fn add(&mut self, name: String, count: usize, width: usize, more: &[(&str, Value)]) {
        let kind = ["SCALAR", "VEC2", "VEC3", "VEC4"][width - 1];
        let bytes = (count * width * 4) as u64;
        let index = self.accessors.len();
        let mut accessor = json!({
            "bufferView": index, "componentType": 5126, "count": count, "type": kind
        });
        more.iter().for_each(|(key, value)| accessor[*key] = value.clone());
        self.accessors.push(accessor);
        self.views.push(json!({
            "buffer": 0, "byteOffset": self.length, "byteLength": bytes
        }));
        self.attributes.insert(name, json!(index));
        self.length += bytes;
    }
}

/// The names of the attributes of coefficients, in order.
fn coefficients(degree: u32) -> impl Iterator<Item = String> {
    (0..=degree)
        .flat_map(|l| (0..=2 * l).map(move |n| format!("{EXTENSION}:SH_DEGREE_{l}_COEF_{n}")))
}

/// The text of the document, and how many bytes of numbers follow.
fn document(gaussians: &Gaussians, offset: DVec3) -> (String, u64) {
    let count = gaussians.len();
    let mut arrays = Arrays::default();
    let (low, high) = gaussians.bounds();
    let corner = |corner: Vec3| json!(corner.to_array());
    let box_of = [("min", corner(low)), ("max", corner(high))];
    arrays.add("POSITION".into(), count, 3, &box_of);
    for (name, width) in [("SCALE", 3), ("ROTATION", 4), ("OPACITY", 1)] {
        arrays.add(format!("{EXTENSION}:{name}"), count, width, &[]);
    }
    coefficients(gaussians.degree()).for_each(|name| arrays.add(name, count, 3, &[]));
    let mut node = json!({ "mesh": 0 });
    if offset != DVec3::ZERO {
        node["translation"] = json!(offset.to_array());
    }
    let splatting = json!({
        "kernel": "ellipse",
        "colorSpace": gaussians.encoding().name(),
        "projection": "perspective",
        "sortingMethod": "cameraDistance"
    });
    let Arrays { attributes, accessors, views, length } = arrays;
    let text = json!({
        "asset": { "version": "2.0", "generator": "splatref" },
        "extensionsUsed": [EXTENSION],
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [node],
        "meshes": [{ "primitives": [{
            "mode": 0,
            "attributes": attributes,
            "extensions": { EXTENSION: splatting }
        }] }],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": length }]
    });
    let mut text = text.to_string();
    while !text.len().is_multiple_of(4) {
        text.push(' ');
    }
    (text, length)
}

/// Writes the bytes of a GLB, whose node moves everything by `offset`.
///
/// # Errors
/// One line if it would have 4 GiB or more, which a GLB cannot say.
pub(in crate::io::gaussians) fn write(
    gaussians: &Gaussians,
    offset: DVec3,
) -> Reason<impl FnOnce(&mut dyn Write) -> io::Result<()>> {
    let (text, length) = document(gaussians, offset);
    let total = 12 + 8 + text.len() as u64 + 8 + length;
    let total = u32::try_from(total).map_err(|_| {
        format!(
            "{} Gaussians do not fit into a GLB, which has less than 4 GiB; give a .ply",
            gaussians.len()
        )
    })?;
    Ok(move |out: &mut dyn Write| {
        out.write_all(b"glTF")?;
        let words = [2, total, text.len() as u32, JSON];
        words.iter().try_for_each(|word| out.write_all(&word.to_le_bytes()))?;
        out.write_all(text.as_bytes())?;
        [length as u32, BINARY].iter().try_for_each(|word| out.write_all(&word.to_le_bytes()))?;
        let mut put = |value: f32| out.write_all(&value.to_le_bytes());
        let vectors = gaussians.position().iter().chain(gaussians.scale());
        vectors.flat_map(Vec3::to_array).try_for_each(&mut put)?;
        gaussians.rotation().iter().flatten().copied().try_for_each(&mut put)?;
        gaussians.opacity().iter().copied().try_for_each(&mut put)?;
        for k in 0..coefficients(gaussians.degree()).count() {
            let each = (0..gaussians.len()).map(|i| gaussians.harmonics(i)[k]);
            each.flat_map(|color| color.to_array()).try_for_each(&mut put)?;
        }
        Ok(())
    })
}
