//! Read MTL files: the materials of OBJ files.
//!
//! | line | defines | details |
//! |---|---|---|
//! | `newmtl NAME` | a material | the lines that follow belong to it |
//! | `Kd r g b`, `Kd r` | its colour | linear, in [0, 65536]; one number is all three |
//! | `map_Kd OPTIONS FILE` | its texture | beside the OBJ file; [`super::map`] has the options |
//! | `d x`, `Tr x` | its opacity, x or 1 - x | in [0, 1]; `Tr` beside `d` is ignored |
//!
//! `map_d`, and lines `d` and `Tr` of anything but one number in [0, 1], are not read, and a warning
//! says so. All other lines are ignored. [`super::lines`] says how lines end and where comments begin. If
//! several materials have one name, the first holds. `Kd spectral` and `Kd xyz` are not read, and a
//! warning says so.
//!
//! `Decided:` Kd is linear, because programs that write it have linear colours. A texture replaces
//! Kd and is not multiplied by it, because the same programs write a Kd that nobody has chosen
//! beside the texture. `d` wins over `Tr`, and `Tr 1` alone is opaque, because some programs write the
//! opacity as `Tr`.

use super::lines::{lines, numbers, shown, statement, uncommented, words};
use super::map::Map;
use crate::io::{Reason, input};
use crate::scene::light::{MAX_RADIANCE, is_color};
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
use std::path::Path;

/// The parts of a material that are read.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Material {
    pub(super) name: String,
    pub(super) color: Option<Vec3>,
    /// From the line `d`, and else from `Tr`.
    pub(super) opacity: [Option<f32>; 2],
    pub(super) texture: Option<Map>,
    /// The lines that a picture would show if they were read.
    pub(super) ignored: Vec<String>,
}

/// What the lines `mtllib` of a file give.
#[derive(Default)]
pub(super) struct Library {
    pub(super) materials: Vec<Material>,
    pub(super) warnings: Vec<String>,
    /// The names of the files that were read or are missing.
    files: BTreeSet<String>,
}

/// The words of an `mtllib` are joined to a name of at most so many words; a longer name must be
/// alone in its line.
const MOST_WORDS: usize = 8;

impl Library {
    /// Reads the files that the rest of a line `mtllib` names. A file that cannot be read gives a
    /// warning.
    ///
    /// # Errors
    /// If a file is no MTL, or larger than memory.
    pub(super) fn read(&mut self, folder: &Path, names: &str) -> Reason<()> {
        for name in files(folder, names) {
            // The same file once more would define nothing.
            if self.files.contains(&name) {
                continue;
            }
            match input::bytes(&folder.join(&name)) {
                Ok(bytes) => {
                    let more = parse(&bytes).map_err(|what| format!("{}: {what}", shown(&name)))?;
                    self.materials.extend(more.into_iter().map(|one| with_texture(one, folder)));
                }
                Err(error) if error.kind() == ErrorKind::OutOfMemory => {
                    return Err(format!("{}: {error}", shown(&name)));
                }
                Err(error) => self.warnings.push(format!(
                    "{}: {error}; without it, its polygons have the default grey",
                    shown(&name)
                )),
            }
            self.files.insert(name);
        }
        Ok(())
    }

    /// Whether any file was named.
    pub(super) fn is_named(&self) -> bool {
        !self.files.is_empty()
    }

    /// Finds materials by the names of lines `usemtl`, in this order: the first material of the
    /// whole name; of the name without its comment; the first whose name without its comment is the
    /// name; both without comments, if white space follows the `#` of the name.
    pub(super) fn finder(&self) -> impl Fn(&str) -> Option<usize> {
        let (mut whole, mut short) = (BTreeMap::new(), BTreeMap::new());
        for (i, material) in self.materials.iter().enumerate() {
            whole.entry(material.name.as_str()).or_insert(i);
            short.entry(uncommented(&material.name)).or_insert(i);
        }
        move |name| {
            let cut = uncommented(name);
            let spaced = name[cut.len()..].trim_ascii_start().starts_with("# ");
            let found = whole.get(name).or_else(|| whole.get(cut)).or_else(|| short.get(name));
            found.or_else(|| short.get(cut).filter(|_| spaced)).copied()
        }
    }
}

/// The files that the rest of a line `mtllib` names.
///
/// The whole rest may be one name, see [`existing`]. Otherwise the longest run of words that is an
/// existing file is a name, from the first word on. Other words are names of missing files, which
/// end at `.mtl`.
fn files(folder: &Path, names: &str) -> Vec<String> {
    if let Some(name) = existing(folder, names) {
        return vec![name];
    }
    let words: Vec<&str> = uncommented(names).split_ascii_whitespace().collect();
    let (mut found, mut missing) = (Vec::new(), Vec::new());
    let mut at = 0;
    while at < words.len() {
        let most = words.len().min(at + MOST_WORDS);
        let runs = (at + 1..=most).rev();
        let name = runs.map(|end| (existing(folder, &words[at..end].join(" ")), end));
        let name = name.filter_map(|(name, end)| Some((name?, end))).next();
        let is_end = |word: &str| word.to_ascii_lowercase().ends_with(".mtl");
        match name {
            Some((name, end)) => {
                found.extend(missing_name(&mut missing));
                found.push(name);
                at = end;
            }
            None => {
                missing.push(words[at]);
                if is_end(words[at]) {
                    found.extend(missing_name(&mut missing));
                }
                at += 1;
            }
        }
    }
    found.extend(missing_name(&mut missing));
    found
}

/// Joins the words of a missing file, if there are any, and forgets them.
fn missing_name(words: &mut Vec<&str>) -> Option<String> {
    let name = words.join(" ");
    words.clear();
    (!name.is_empty()).then_some(name)
}

/// The name of the file in this folder that a name means: the name itself, or with `/` in place of
/// `\`, or both without a comment. `None` if there is no such file.
fn existing(folder: &Path, name: &str) -> Option<String> {
    let names = [name, uncommented(name)];
    let names = names.into_iter().flat_map(|name| [name.to_owned(), name.replace('\\', "/")]);
    names.filter(|name| !name.is_empty()).find(|name| folder.join(name).exists())
}

/// The material with the name of its texture as a file beside the OBJ has it.
fn with_texture(mut material: Material, folder: &Path) -> Material {
    if let Some(map) = &mut material.texture {
        let name = existing(folder, &map.name);
        map.name = name.unwrap_or_else(|| uncommented(&map.name).to_owned());
    }
    material
}

/// Reads the bytes of a file.
pub(super) fn parse(bytes: &[u8]) -> Reason<Vec<Material>> {
    let mut all: Vec<Material> = Vec::new();
    for (number, line) in lines(bytes)? {
        let (word, rest) = statement(&line);
        if word == "newmtl" {
            all.push(Material { name: rest.to_owned(), ..Material::default() });
            continue;
        }
        if !matches!(word, "Kd" | "map_Kd" | "d" | "Tr" | "map_d") {
            continue;
        }
        let read = match all.last_mut() {
            None if matches!(word, "Kd" | "map_Kd") => {
                Err(format!("{word} before the first newmtl"))
            }
            None => Ok(()),
            Some(material) => material.read(word, rest),
        };
        read.map_err(|what| format!("line {number}: {what}"))?;
    }
    Ok(all)
}

impl Material {
    fn read(&mut self, word: &str, rest: &str) -> Reason<()> {
        match word {
            "map_Kd" if uncommented(rest).is_empty() => return Err("map_Kd without a file".into()),
            "map_Kd" => self.texture = Some(Map::parse(rest)),
            "Kd" => match words(rest).next() {
                Some(kind @ ("spectral" | "xyz")) => self.ignore(&format!("Kd {kind}")),
                _ => self.color = Some(color(rest)?),
            },
            "map_d" => self.ignore("map_d"),
            // Not `d -halo 0.5`, which depends on the angle of view.
            _ => match (word, opacity(rest)) {
                (_, None) => self.ignore(word),
                ("d", opacity) => self.opacity[0] = opacity,
                (_, opacity) => self.opacity[1] = opacity.map(|value| 1.0 - value),
            },
        }
        Ok(())
    }

    /// The opacity of its surfaces.
    pub(super) fn opacity(&self) -> f32 {
        let [d, tr] = self.opacity;
        d.or(tr.filter(|opacity| *opacity > 0.0)).unwrap_or(1.0)
    }

    fn ignore(&mut self, what: &str) {
        if !self.ignored.iter().any(|known| known == what) {
            self.ignored.push(what.to_owned());
        }
    }
}

fn opacity(text: &str) -> Option<f32> {
    match numbers(words(text)).ok()?[..] {
        [value] if (0.0..=1.0).contains(&value) => Some(value as f32),
        _ => None,
    }
}

fn color(text: &str) -> Reason<Vec3> {
    let color = match numbers(words(text))?[..] {
        [all] => Vec3::splat(all as f32),
        [r, g, b] => Vec3::new(r as f32, g as f32, b as f32),
        ref all => return Err(format!("a Kd of {} numbers; give r g b", all.len())),
    };
    let refused = || format!("a Kd of {color}; give numbers in [0, {MAX_RADIANCE}]");
    is_color(color).then_some(color).ok_or_else(refused)
}
