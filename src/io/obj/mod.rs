//! OBJ: meshes and points as text, in.
//!
//! | line | | |
//! |---|---|---|
//! | `v x y z` | a position | world units, rounded to `f32` once; a fourth number, a weight, is skipped |
//! | `v x y z r g b` | with a colour | **sRGB** in [0, 1], decoded in `f64` and rounded once ([`crate::io::srgb`]) |
//! | `vn x y z` | a normal | of any length |
//! | `f a b c ...` | a polygon | the fan of its first corner; with fewer than 3 corners it is nothing |
//!
//! A corner is `v`, `v/vt`, `v//vn` or `v/vt/vn`: the number of a vertex from 1 on, or, below 0, of the
//! last ones before the line, of which -1 is the last; the same for a normal. Texture coordinates are
//! not looked at, nor are other lines, materials among them. `#` begins a comment.
//!
//! All vertices have a colour or none has. Values of positions and normals are not judged, as
//! [`super::ply`] does not judge them.
//!
//! # Decided
//!
//! - Colours are sRGB: programs that paint vertices write codes of 8 bits divided by 255.
//! - A vertex whose corners have several normals becomes several points, in the order of the normals'
//!   numbers; points are in the order of the vertices. If a corner has no normal, all normals are
//!   left out, to be derived.
//! - Without any `f` and with as many `vn` as `v` normals belong to vertices one by one: point clouds
//!   are written so.
//!
//! The reader is our own because the one well-kept crate, tobj 4.0, says of no error in which line it is,
//! and drops without a word what this page keeps or refuses: points without faces, and all texture
//! coordinates or normals of a file in which a corner has none.

#[cfg(test)]
mod tests;

use super::{Reason, input, srgb};
use crate::error::{Error, Result};
use crate::memory;
use crate::scene::Cloud;
use glam::Vec3;
use std::path::Path;

/// What a byte of a file comes to at most: a corner of a polygon takes two bytes.
const BYTES_A_BYTE: u64 = 48;

/// The number of no normal.
const NO_NORMAL: u32 = u32::MAX;

/// Reads a file.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read, [`Error::Format`] as [`parse`].
pub fn read(path: &Path) -> Result<Cloud> {
    let bytes = input::bytes(path).map_err(|source| Error::io(path, source))?;
    parse(&bytes).map_err(|what| Error::format(path, what))
}

/// Reads the bytes of a file.
///
/// # Errors
/// One line if there is no vertex, if a word is no number or names what is not there, if only some
/// vertices have colours, or if a colour is not in [0, 1]: the line, what is wrong and what to do.
pub fn parse(bytes: &[u8]) -> std::result::Result<Cloud, String> {
    memory::try_ask(BYTES_A_BYTE.saturating_mul(bytes.len() as u64), || "a mesh".into())?;
    let mut file = Lines::default();
    for (number, line) in (1_u64..).zip(bytes.split(|&byte| byte == b'\n')) {
        let line = line.split(|&byte| byte == b'#').next().unwrap_or_default();
        let line = String::from_utf8_lossy(line);
        let mut words = line.split_ascii_whitespace();
        let read = match words.next() {
            Some("v") => file.vertex(words),
            Some("vn") => numbers(words).and_then(|all| match all[..] {
                [x, y, z] => {
                    file.normal.push(Vec3::new(x as f32, y as f32, z as f32));
                    Ok(())
                }
                _ => Err(format!("a normal of {} numbers; give three", all.len())),
            }),
            Some("f") => file.face(words),
            _ => Ok(()),
        };
        read.map_err(|what| format!("line {number}: {what}"))?;
    }
    file.cloud()
}

/// What the lines have given so far.
#[derive(Default)]
struct Lines {
    position: Vec<Vec3>,
    color: Vec<Vec3>,
    normal: Vec<Vec3>,
    /// Corners of triangles: vertex and normal.
    triangles: Vec<[[u32; 2]; 3]>,
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

    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Reason<()> {
        let (mut first, mut previous) = (None, None);
        for word in words {
            let corner = self.corner(word)?;
            match (first, previous) {
                (Some(first), Some(previous)) => self.triangles.push([first, previous, corner]),
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

    fn corner(&self, word: &str) -> Reason<[u32; 2]> {
        let shown = || word.chars().take(40).flat_map(char::escape_debug).collect::<String>();
        let mut parts = word.split('/');
        let vertex = parts.next().unwrap_or_default();
        let _texture = parts.next();
        let normal = parts.next().unwrap_or_default();
        if parts.next().is_some() {
            return Err(format!("`{}` is no corner; give v, v/vt, v//vn or v/vt/vn", shown()));
        }
        let index = |text: &str, what: &str, count: usize| {
            let number: i64 =
                text.parse().map_err(|_| format!("`{}`: no number of a {what}", shown()))?;
            let place =
                if number < 0 { number.checked_add(count as i64) } else { number.checked_sub(1) };
            let found = place.and_then(|place| u32::try_from(place).ok());
            found.filter(|&place| (place as usize) < count).ok_or_else(|| {
                format!("`{}`: there is no {what} {number}, as {count} came before", shown())
            })
        };
        let vertex = index(vertex, "vertex", self.position.len())?;
        let normal = match normal {
            "" => NO_NORMAL,
            text => index(text, "normal", self.normal.len())?,
        };
        Ok([vertex, normal])
    }

    /// Points, split where their normals differ.
    fn cloud(self) -> Reason<Cloud> {
        let Self { position, color, normal, mut triangles } = self;
        if position.is_empty() {
            return Err("there is no line `v x y z`: the file holds no points".into());
        }
        let colored = !color.is_empty();
        if triangles.is_empty() {
            let normal = (normal.len() == position.len()).then_some(normal);
            return Ok(Cloud {
                position,
                normal,
                color: colored.then_some(color),
                ..Cloud::default()
            });
        }
        let has_normals = triangles.iter().flatten().all(|corner| corner[1] != NO_NORMAL);
        if !has_normals {
            triangles.iter_mut().flatten().for_each(|corner| corner[1] = NO_NORMAL);
        }
        let mut used = vec![false; position.len()];
        triangles.iter().flatten().for_each(|corner| used[corner[0] as usize] = true);
        let unused = (0..).zip(&used).filter(|(_, used)| !**used).map(|(i, _)| [i, NO_NORMAL]);
        let mut points: Vec<[u32; 2]> = triangles.iter().flatten().copied().chain(unused).collect();
        points.sort_unstable();
        points.dedup();
        let place = |corner: [u32; 2]| points.partition_point(|point| *point < corner) as u32;
        Ok(Cloud {
            triangles: triangles.iter().map(|corners| corners.map(place)).collect(),
            position: points.iter().map(|point| position[point[0] as usize]).collect(),
            color: colored.then(|| points.iter().map(|point| color[point[0] as usize]).collect()),
            // Vertices of no polygon have none.
            normal: has_normals.then(|| {
                let of = |point: &[u32; 2]| normal.get(point[1] as usize).copied();
                points.iter().map(|point| of(point).unwrap_or(Vec3::ZERO)).collect()
            }),
            ..Cloud::default()
        })
    }
}

/// Words as numbers.
fn numbers<'a>(words: impl Iterator<Item = &'a str>) -> Reason<Vec<f64>> {
    // No line has more than six that are read.
    let number = |word: &str| {
        word.parse().map_err(|_| {
            let shown: String = word.chars().take(40).flat_map(char::escape_debug).collect();
            format!("`{shown}` is no number")
        })
    };
    words.take(8).map(number).collect()
}
