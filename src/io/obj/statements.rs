//! Read the statements of OBJ files: vertices, normals, texture coordinates, polygons.

use super::colors::Colors;
use super::lines::{numbers, shown, words};
use super::materials::Library;
use crate::io::Reason;
use glam::{Vec2, Vec3};
use std::collections::BTreeMap;

/// Stands for no normal, no coordinates and no material.
pub(super) const NONE: u32 = u32::MAX;

/// A corner: vertex, normal and coordinates.
pub(super) type Corner = [u32; 3];

/// What the lines of a file define.
#[derive(Default)]
pub(super) struct Statements {
    pub(super) position: Vec<Vec3>,
    pub(super) colors: Colors,
    pub(super) normal: Vec<Vec3>,
    pub(super) coordinate: Vec<Vec2>,
    pub(super) library: Library,
    /// The names in lines `usemtl`, and the line where each is first.
    pub(super) names: Vec<(String, u64)>,
    /// The place of each name.
    places: BTreeMap<String, u32>,
    /// The material of the next polygon: a place in `names`.
    material: u32,
    pub(super) triangles: Vec<[Corner; 3]>,
    /// The material of each triangle: a place in `names`.
    pub(super) materials: Vec<u32>,
    /// The vertices at both ends of each segment of a line.
    pub(super) edges: Vec<[u32; 2]>,
    /// The first triangle and the corners of each polygon of more than 3 corners.
    pub(super) polygons: Vec<[u32; 2]>,
    /// References to what a later line may define.
    ahead: [Vec<Ahead>; 3],
    /// Statements that are not read: how many, and the line of the first.
    skipped: Vec<(String, u64, u64)>,
}

/// A reference to something that no line before it defines.
struct Ahead {
    line: u64,
    number: i64,
}

/// What the parts of a corner refer to.
const KINDS: [&str; 3] = ["vertex", "normal", "texture coordinate"];

/// Statements that change no picture: names, groups, levels of detail, and points, because every
/// vertex is a point.
const SILENT: [&str; 8] = ["", "o", "g", "mg", "lod", "c_interp", "d_interp", "p"];

/// A file of many unknown words is probably no OBJ; so many are named.
const MOST_SKIPPED: usize = 8;

impl Statements {
    pub(super) fn new() -> Self {
        Self { material: NONE, ..Self::default() }
    }

    /// Reads a line other than `mtllib`.
    pub(super) fn read(&mut self, line: u64, word: &str, rest: &str) -> Reason<()> {
        match word {
            "v" => self.vertex(rest),
            "vt" => self.coordinate(rest),
            "vn" => self.normal(rest),
            // `fo` is how old files write `f`.
            "f" | "fo" => self.face(line, rest),
            "l" => self.line(line, rest),
            "usemtl" => {
                self.choose(line, rest);
                Ok(())
            }
            other => {
                self.skip(line, other);
                Ok(())
            }
        }
    }

    fn vertex(&mut self, rest: &str) -> Reason<()> {
        let all = numbers(words(rest))?;
        if !matches!(all.len(), 3 | 4 | 6 | 7) {
            let n = all.len();
            return Err(format!("a vertex of {n} numbers; give x y z, or x y z r g b"));
        }
        self.colors.read(self.position.len(), all.get(3..).filter(|rest| rest.len() > 1))?;
        self.position.push(Vec3::new(all[0] as f32, all[1] as f32, all[2] as f32));
        Ok(())
    }

    fn coordinate(&mut self, rest: &str) -> Reason<()> {
        let all = numbers(words(rest))?;
        match all[..] {
            [u] => self.coordinate.push(Vec2::new(u as f32, 0.0)),
            [u, v] | [u, v, _] => self.coordinate.push(Vec2::new(u as f32, v as f32)),
            _ => return Err(format!("texture coordinates of {} numbers; give u v", all.len())),
        }
        Ok(())
    }

    fn normal(&mut self, rest: &str) -> Reason<()> {
        match numbers(words(rest))?[..] {
            [x, y, z] => self.normal.push(Vec3::new(x as f32, y as f32, z as f32)),
            ref all => return Err(format!("a normal of {} numbers; give three", all.len())),
        }
        Ok(())
    }

    /// Chooses the material of the polygons that follow; without a name the default material.
    fn choose(&mut self, line: u64, name: &str) {
        self.material = match self.places.get(name) {
            _ if name.is_empty() => NONE,
            Some(&place) => place,
            None => {
                let place = self.names.len() as u32;
                self.names.push((name.to_owned(), line));
                self.places.insert(name.to_owned(), place);
                place
            }
        };
    }

    fn face(&mut self, line: u64, rest: &str) -> Reason<()> {
        let start = self.triangles.len();
        let (mut first, mut previous) = (None, None);
        for word in words(rest) {
            let corner = self.corner(line, word)?;
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
        self.materials.resize(self.triangles.len(), self.material);
        let triangles = self.triangles.len() - start;
        if triangles > 1 {
            self.polygons.push([start as u32, triangles as u32 + 2]);
        }
        Ok(())
    }

    fn line(&mut self, line: u64, rest: &str) -> Reason<()> {
        let mut previous = None;
        for word in words(rest) {
            let [vertex, ..] = self.corner(line, word)?;
            self.edges.extend(previous.map(|previous| [previous, vertex]));
            previous = Some(vertex);
        }
        Ok(())
    }

    fn corner(&mut self, line: u64, word: &str) -> Reason<Corner> {
        let mut parts = word.split('/');
        let vertex = parts.next().unwrap_or_default();
        let coordinate = parts.next().unwrap_or_default();
        let normal = parts.next().unwrap_or_default();
        if parts.next().is_some() {
            let word = shown(word);
            return Err(format!("`{word}` is not a corner; give v, v/vt, v//vn or v/vt/vn"));
        }
        let counts = [self.position.len(), self.normal.len(), self.coordinate.len()];
        let mut corner = [NONE; 3];
        for (kind, text) in [vertex, normal, coordinate].into_iter().enumerate() {
            if text.is_empty() && kind > 0 {
                continue;
            }
            let number: i64 = text
                .parse()
                .map_err(|_| format!("`{}`: not the number of a {}", shown(word), KINDS[kind]))?;
            let count = counts[kind] as i64;
            let place = if number < 0 { number.checked_add(count) } else { number.checked_sub(1) };
            let place = place.and_then(|place| u32::try_from(place).ok());
            let Some(place) = place.filter(|&place| place != NONE) else {
                let (word, what) = (shown(word), KINDS[kind]);
                return Err(format!(
                    "`{word}`: there is no {what} {number}, as {count} came before"
                ));
            };
            if number > count {
                self.refer_ahead(kind, Ahead { line, number });
            }
            corner[kind] = place;
        }
        Ok(corner)
    }

    /// Remembers a reference to a later line, if its number is larger than all before it: only such
    /// a reference can be the first that refers to nothing.
    fn refer_ahead(&mut self, kind: usize, reference: Ahead) {
        let known = &mut self.ahead[kind];
        if known.last().is_none_or(|last| last.number < reference.number) {
            known.push(reference);
        }
    }

    fn skip(&mut self, line: u64, word: &str) {
        if word.starts_with('#') || SILENT.contains(&word) {
            return;
        }
        if let Some((_, count, _)) = self.skipped.iter_mut().find(|(known, ..)| known == word) {
            *count += 1;
        } else if self.skipped.len() < MOST_SKIPPED {
            self.skipped.push((word.to_owned(), 1, line));
        }
    }

    /// Checks, after the last line, that everything exists that corners refer to.
    pub(super) fn check(&self) -> Reason<()> {
        let counts = [self.position.len(), self.normal.len(), self.coordinate.len()];
        let missing = (0..3).filter_map(|kind| {
            let count = counts[kind] as i64;
            let first = self.ahead[kind].iter().find(|reference| reference.number > count)?;
            Some((first.line, KINDS[kind], first.number, count))
        });
        match missing.min_by_key(|&(line, ..)| line) {
            Some((line, what, number, count)) => Err(format!(
                "line {line}: there is no {what} {number}, as the file has {count}; the file may \
                 be cut off"
            )),
            None => Ok(()),
        }
    }

    /// Says once what was not read; smoothing groups matter only for derived normals.
    pub(super) fn skipped(&self, derives_normals: bool) -> Option<String> {
        let said = |(word, ..): &&(String, u64, u64)| derives_normals || word != "s";
        let one = |(word, count, line): &(String, u64, u64)| match count {
            1 => format!("{} (line {line})", shown(word)),
            _ => format!("{} ({count} lines, first line {line})", shown(word)),
        };
        let all: Vec<String> = self.skipped.iter().filter(said).map(one).collect();
        (!all.is_empty()).then(|| format!("these statements are not read: {}", all.join(", ")))
    }
}
