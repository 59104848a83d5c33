//! Read meshes and points from OBJ, with the colours and textures of their materials.
//!
//! | line | defines | details |
//! |---|---|---|
//! | `v x y z` | a position | world units, rounded to `f32` once; a fourth number, a weight, is skipped |
//! | `v x y z r g b` | with a colour | **sRGB** in [0, 1], decoded in `f64` and rounded once ([`crate::number::srgb`]) |
//! | `vn x y z` | a normal | of any length |
//! | `f a b c ...` | a polygon | the fan of its first corner; with fewer than 3 corners it is nothing |
//!
//! | line | defines | details |
//! |---|---|---|
//! | `mtllib FILE` | materials | an MTL file beside this one; several files make one list |
//! | `usemtl NAME` | a material | for the polygons that follow |
//! | `vt u v` | texture coordinates | a third number is skipped; without v it is 0 |
//!
//! A corner is `v`, `v/vt`, `v//vn` or `v/vt/vn`. Each part is a number from 1 on, or a negative
//! number that counts backwards from the line; -1 is the last vertex, normal or texture coordinate
//! before it. All other lines are ignored. `#` begins a comment.
//!
//! The reader takes the texture and the colour of a material:
//!
//! | line of an MTL file | defines | details |
//! |---|---|---|
//! | `newmtl NAME` | a material | the lines that follow belong to it |
//! | `Kd r g b`, `Kd r` | its colour | linear, in [0, 65536]; one number is all three |
//! | `map_Kd FILE` | its texture, see [`crate::io::texture`] | a name without options |
//!
//! Either all vertices have a colour or none. The reader does not judge values of positions and
//! normals, and neither does [`super::ply`].
//!
//! # Decided
//!
//! - Colours are sRGB, because programs that paint vertices write codes of 8 bits divided by 255.
//! - A vertex becomes several points if its corners have several normals, or materials of several
//!   colours. Points are in the order of the vertices, then of the normals' numbers, then of the
//!   materials. If a corner has no normal, all normals are left out, to be derived.
//! - Texture coordinates belong to [corners](Coordinates::Corners); a corner without them has NaN.
//! - If vertices have no colours and no texture replaces the materials' colours, points take the
//!   colours of their materials. A material without Kd is then white.
//! - Kd is linear, because programs that write it have linear colours. A texture replaces Kd and is
//!   not multiplied by it, because the same programs write a Kd that nobody has chosen beside the
//!   texture.
//! - A missing material or a missing file of materials is refused, because a picture would not show
//!   what is missing. Without any `mtllib` the names of materials mean nothing.
//! - If there is no `f`, and as many `vn` as `v`, each normal belongs to the vertex of the same
//!   number, because point clouds are written so.
//!
//! The reader is our own. The one well-kept crate, tobj 4.0, gives no line number with an error. It
//! also drops silently what this page keeps or refuses: points without faces, and all texture
//! coordinates or normals of a file in which one corner has none.

mod materials;
#[cfg(test)]
mod tests;

use super::{Reason, input};
use crate::error::{Error, Result};
use crate::memory;
use crate::number::srgb;
use crate::scene::{Cloud, Coordinates};
use glam::{Vec2, Vec3};
use materials::Material;
use std::path::Path;

/// The most memory for each byte of a file: a corner of a polygon takes only two bytes of it.
const BYTES_A_BYTE: u64 = 72;

/// Stands for no normal, no coordinates and no material.
const NONE: u32 = u32::MAX;

/// Reads a file and its materials.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read; [`Error::Format`] as [`parse`], and if materials are
/// missing or cannot be read.
pub fn read(path: &Path) -> Result<Cloud> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let library = |name: &str| {
        let bytes = input::bytes(&folder.join(name)).map_err(|error| format!("{name}: {error}"))?;
        materials::parse(&bytes).map_err(|what| format!("{name}: {what}"))
    };
    parse_with(&bytes, &library).map_err(|what| Error::format(path, what))
}

/// Reads the bytes of a file, without materials.
///
/// # Errors
/// One line if there is no vertex, if a word is no number or refers to something that does not
/// exist, if only some vertices have colours, or if a colour is not in [0, 1]. It names the line,
/// the problem and the remedy.
pub fn parse(bytes: &[u8]) -> std::result::Result<Cloud, String> {
    parse_with(bytes, &|_| Ok(Vec::new()))
}

/// [`parse`] with the materials of the files that `mtllib` names.
fn parse_with(bytes: &[u8], library: &dyn Fn(&str) -> Reason<Vec<Material>>) -> Reason<Cloud> {
    memory::try_ask(BYTES_A_BYTE.saturating_mul(bytes.len() as u64), || "a mesh".into())?;
    let mut file = Lines { material: NONE, ..Lines::default() };
    for (number, line) in (1_u64..).zip(bytes.split(|&byte| byte == b'\n')) {
        let line = line.split(|&byte| byte == b'#').next().unwrap_or_default();
        let line = String::from_utf8_lossy(line);
        let (word, rest) = rest(&line);
        let words = rest.split_ascii_whitespace();
        let read = match word {
            "v" => file.vertex(words),
            "vt" => file.coordinate(words),
            "mtllib" => library(rest).map(|more| file.materials.extend(more)),
            "usemtl" => file.choose(rest),
            "vn" => numbers(words).and_then(|all| match all[..] {
                [x, y, z] => {
                    file.normal.push(Vec3::new(x as f32, y as f32, z as f32));
                    Ok(())
                }
                _ => Err(format!("a normal of {} numbers; give three", all.len())),
            }),
            "f" => file.face(words),
            _ => Ok(()),
        };
        read.map_err(|what| format!("line {number}: {what}"))?;
    }
    file.cloud()
}

/// The first word of a line, and the text after it.
fn rest(line: &str) -> (&str, &str) {
    let line = line.trim();
    let (word, rest) = line.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((line, ""));
    (word, rest.trim())
}

/// What the lines so far have defined.
#[derive(Default)]
struct Lines {
    position: Vec<Vec3>,
    color: Vec<Vec3>,
    normal: Vec<Vec3>,
    coordinate: Vec<Vec2>,
    materials: Vec<Material>,
    /// The material of the next polygon.
    material: u32,
    triangles: Vec<Triangle>,
}

/// A corner: vertex, normal and coordinates.
type Corner = [u32; 3];

/// A triangle and its material.
struct Triangle {
    corners: [Corner; 3],
    material: u32,
}

impl Lines {
    fn vertex<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Reason<()> {
        let all = numbers(words)?;
        let color = match all.len() {
            3 | 4 => None,
            6 => Some(&all[3..]),
            n => return Err(format!("a vertex of {n} numbers; give x y z, or x y z r g b")),
        };
        let before = self.position.len();
        let fits = if color.is_some() { self.color.len() == before } else { self.color.is_empty() };
        if !fits {
            return Err("only some vertices have colours; give all or none".into());
        }
        if let Some(color) = color {
            if let Some(wrong) = color.iter().find(|c| !(0.0..=1.0).contains(*c)) {
                return Err(format!("a colour of {wrong}; give numbers in [0, 1]"));
            }
            let linear = |i: usize| srgb::to_linear(color[i]) as f32;
            self.color.push(Vec3::new(linear(0), linear(1), linear(2)));
        }
        self.position.push(Vec3::new(all[0] as f32, all[1] as f32, all[2] as f32));
        Ok(())
    }

    fn coordinate<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Reason<()> {
        let all = numbers(words)?;
        match all[..] {
            [u] => self.coordinate.push(Vec2::new(u as f32, 0.0)),
            [u, v] | [u, v, _] => self.coordinate.push(Vec2::new(u as f32, v as f32)),
            _ => return Err(format!("texture coordinates of {} numbers; give u v", all.len())),
        }
        Ok(())
    }

    fn choose(&mut self, name: &str) -> Reason<()> {
        // Without any material, the names mean nothing.
        if self.materials.is_empty() {
            return Ok(());
        }
        let found = self.materials.iter().position(|material| material.name == name);
        let shown = || name.chars().take(40).flat_map(char::escape_debug).collect::<String>();
        let found = found.ok_or_else(|| format!("no material is called `{}`", shown()))?;
        self.material = found as u32;
        Ok(())
    }

    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Reason<()> {
        let (mut first, mut previous) = (None, None);
        for word in words {
            let corner = self.corner(word)?;
            match (first, previous) {
                (Some(first), Some(previous)) => {
                    let (corners, material) = ([first, previous, corner], self.material);
                    self.triangles.push(Triangle { corners, material });
                }
                (Some(_), None) => {}
                (None, _) => {
                    first = Some(corner);
                    continue;
                }
            }
            previous = Some(corner);
        }
        Ok(())
    }

    fn corner(&self, word: &str) -> Reason<Corner> {
        let shown = || word.chars().take(40).flat_map(char::escape_debug).collect::<String>();
        let mut parts = word.split('/');
        let vertex = parts.next().unwrap_or_default();
        let coordinate = parts.next().unwrap_or_default();
        let normal = parts.next().unwrap_or_default();
        if parts.next().is_some() {
            return Err(format!("`{}` is not a corner; give v, v/vt, v//vn or v/vt/vn", shown()));
        }
        let index = |text: &str, what: &str, count: usize| {
            let number: i64 =
                text.parse().map_err(|_| format!("`{}`: not the number of a {what}", shown()))?;
            let place =
                if number < 0 { number.checked_add(count as i64) } else { number.checked_sub(1) };
            let found = place.and_then(|place| u32::try_from(place).ok());
            found.filter(|&place| (place as usize) < count).ok_or_else(|| {
                format!("`{}`: there is no {what} {number}, as {count} came before", shown())
            })
        };
        let vertex = index(vertex, "vertex", self.position.len())?;
        let optional = |text: &str, what: &str, count: usize| {
            if text.is_empty() { Ok(NONE) } else { index(text, what, count) }
        };
        let normal = optional(normal, "normal", self.normal.len())?;
        Ok([vertex, normal, optional(coordinate, "texture coordinate", self.coordinate.len())?])
    }

    /// Makes the points; a vertex is split where normals or colours differ.
    fn cloud(self) -> Reason<Cloud> {
        if self.position.is_empty() {
            return Err("there is no line `v x y z`: the file holds no points".into());
        }
        let colored = !self.color.is_empty();
        if self.triangles.is_empty() {
            let normal = (self.normal.len() == self.position.len()).then_some(self.normal);
            let color = colored.then_some(self.color);
            return Ok(Cloud { position: self.position, normal, color, ..Cloud::default() });
        }
        let coordinates = self.coordinates();
        let textures = self.textures();
        let own = !colored && (coordinates.is_none() || textures.is_empty());
        let paints = if own { self.paints() } else { Vec::new() };
        let corners = || self.triangles.iter().flat_map(|triangle| &triangle.corners);
        let has_normals = corners().all(|corner| corner[1] != NONE);
        let point = |corner: &Corner, material: u32| {
            let normal = if has_normals { corner[1] } else { NONE };
            [corner[0], normal, paints.get(material as usize).copied().unwrap_or(NONE)]
        };
        let mut used = vec![false; self.position.len()];
        corners().for_each(|corner| used[corner[0] as usize] = true);
        // Vertices that no polygon uses stay in the cloud.
        let unused = (0..).zip(&used).filter(|(_, used)| !**used).map(|(i, _)| [i, NONE, NONE]);
        let drawn = self.triangles.iter().map(|one| one.corners.map(|c| point(&c, one.material)));
        let count = 3 * self.triangles.len() + used.iter().filter(|used| !**used).count();
        let mut points: Vec<[u32; 3]> = Vec::with_capacity(count);
        points.extend(drawn.clone().flatten().chain(unused));
        points.sort_unstable();
        points.dedup();
        let place = |corner: [u32; 3]| points.partition_point(|point| *point < corner) as u32;
        let triangles = drawn.map(|corners| corners.map(place)).collect();
        let color = if colored {
            Some(points.iter().map(|point| self.color[point[0] as usize]).collect())
        } else {
            let painted = |point: &[u32; 3]| self.materials.get(point[2] as usize)?.color;
            let of = |point: &[u32; 3]| painted(point).unwrap_or(Vec3::ONE);
            (!paints.is_empty()).then(|| points.iter().map(of).collect())
        };
        Ok(Cloud {
            triangles,
            position: points.iter().map(|point| self.position[point[0] as usize]).collect(),
            color,
            // A vertex of no polygon has no normal.
            normal: has_normals.then(|| {
                let of = |point: &[u32; 3]| self.normal.get(point[1] as usize).copied();
                points.iter().map(|point| of(point).unwrap_or(Vec3::ZERO)).collect()
            }),
            coordinates,
            textures,
            ..Cloud::default()
        })
    }

    /// The texture coordinates of all corners, if any corner has some.
    fn coordinates(&self) -> Option<Coordinates> {
        let of =
            |corner: Corner| self.coordinate.get(corner[2] as usize).copied().unwrap_or(Vec2::NAN);
        let mut corners = self.triangles.iter().flat_map(|triangle| &triangle.corners);
        corners.any(|corner| corner[2] != NONE).then(|| {
            Coordinates::Corners(self.triangles.iter().map(|one| one.corners.map(of)).collect())
        })
    }

    /// The textures of the triangles in the order of their first use, with an empty name where
    /// there is none. Empty if no triangle has a texture.
    fn textures(&self) -> Vec<String> {
        let mut names: Vec<&str> = Vec::new();
        for used in self.uses() {
            let material = self.materials.get(used as usize);
            let name = material.and_then(|material| material.texture.as_deref()).unwrap_or("");
            if !names.contains(&name) {
                names.push(name);
            }
        }
        if names == [""] { Vec::new() } else { names.into_iter().map(str::to_owned).collect() }
    }

    /// For each material the first one of the same colour; empty if no triangle has a colour.
    fn paints(&self) -> Vec<u32> {
        let color = |material: u32| self.materials.get(material as usize)?.color;
        if !self.uses().into_iter().any(|used| color(used).is_some()) {
            return Vec::new();
        }
        let same = |of: &Material| {
            self.materials.iter().position(|other| other.color == of.color).unwrap_or(0) as u32
        };
        self.materials.iter().map(same).collect()
    }

    /// The materials that triangles use, each once, in the order of their first use.
    fn uses(&self) -> Vec<u32> {
        let mut first = vec![true; self.materials.len() + 1];
        let mut uses = Vec::new();
        for &Triangle { material, .. } in &self.triangles {
            let place = (material as usize).min(self.materials.len());
            if std::mem::replace(&mut first[place], false) {
                uses.push(material);
            }
        }
        uses
    }
}

/// Parses words as numbers.
fn numbers<'a>(words: impl Iterator<Item = &'a str>) -> Reason<Vec<f64>> {
    // Eight words are enough: no line has more than six that are read.
    let number = |word: &str| {
        word.parse().map_err(|_| {
            let shown: String = word.chars().take(40).flat_map(char::escape_debug).collect();
            format!("`{shown}` is not a number")
        })
    };
    words.take(8).map(number).collect()
}
