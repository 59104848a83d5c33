//! Read MTL files: the materials of OBJ files.
//!
//! | line | defines | details |
//! |---|---|---|
//! | `newmtl NAME` | a material | the lines that follow belong to it |
//! | `Kd r g b`, `Kd r` | its colour | linear, in [0, 65536]; one number is all three |
//! | `map_Kd FILE` | its texture | beside the OBJ file |
//!
//! All other lines are ignored, among them opacity. `#` begins a comment. If several materials have
//! one name, the first holds.
//!
//! `Decided:` Kd is linear, because programs that write it have linear colours. A texture replaces
//! Kd and is not multiplied by it, because the same programs write a Kd that nobody has chosen
//! beside the texture.

use super::{numbers, rest};
use crate::io::Reason;
use crate::scene::light::{MAX_RADIANCE, is_color};
use glam::Vec3;

/// The parts of a material that are read.
#[derive(Debug, PartialEq)]
pub(super) struct Material {
    pub(super) name: String,
    pub(super) color: Option<Vec3>,
    pub(super) texture: Option<String>,
}

/// Reads the bytes of a file.
pub(super) fn parse(bytes: &[u8]) -> Reason<Vec<Material>> {
    let mut all: Vec<Material> = Vec::new();
    for (number, line) in (1_u64..).zip(bytes.split(|&byte| byte == b'\n')) {
        let line = line.split(|&byte| byte == b'#').next().unwrap_or_default();
        let line = String::from_utf8_lossy(line);
        let (word, rest) = rest(&line);
        if word == "newmtl" {
            all.push(Material { name: rest.to_owned(), color: None, texture: None });
            continue;
        }
        if !matches!(word, "Kd" | "map_Kd") {
            continue;
        }
        let read = match all.last_mut() {
            None => Err(format!("{word} before the first newmtl")),
            Some(material) if word == "Kd" => color(rest).map(|color| material.color = Some(color)),
            Some(material) => texture(rest).map(|name| material.texture = Some(name)),
        };
        read.map_err(|what| format!("line {number}: {what}"))?;
    }
    Ok(all)
}

fn color(text: &str) -> Reason<Vec3> {
    let color = match numbers(text.split_ascii_whitespace())?[..] {
        [all] => Vec3::splat(all as f32),
        [r, g, b] => Vec3::new(r as f32, g as f32, b as f32),
        ref all => return Err(format!("a Kd of {} numbers; give r g b", all.len())),
    };
    let refused = || format!("a Kd of {color}; give numbers in [0, {MAX_RADIANCE}]");
    is_color(color).then_some(color).ok_or_else(refused)
}

fn texture(name: &str) -> Reason<String> {
    match name {
        "" => Err("map_Kd without a file".into()),
        name if name.starts_with('-') => {
            Err("the options of map_Kd are not supported; remove them, or give a texture instead"
                .into())
        }
        name => Ok(name.to_owned()),
    }
}
