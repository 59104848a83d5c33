//! Make points and triangles from the statements of an OBJ file.

use super::materials::Material;
use super::statements::{Corner, NONE, Statements};
use crate::io::{Reason, polygon};
use crate::scene::light::Phong;
use crate::scene::{Cloud, Coordinates};
use glam::{Vec2, Vec3};

/// At most so many warnings; a file may name any number of missing files.
const MOST_WARNINGS: usize = 12;

/// Everything that a cloud is made from, with the materials found.
struct Mesh {
    statements: Statements,
    /// The colours of the vertices, if they have some.
    color: Option<Vec<Vec3>>,
    /// The opacities of the vertices, if some are below 1.
    opacity: Option<Vec<f32>>,
    materials: Vec<Material>,
}

/// Makes the points; a vertex is split where normals or colours differ. `with_materials` says
/// whether lines `mtllib` and `usemtl` are read.
pub(super) fn cloud(mut statements: Statements, with_materials: bool) -> Reason<Cloud> {
    statements.check()?;
    let count = statements.position.len();
    if count == 0 {
        return Err("there is no line `v x y z`: the file holds no points".into());
    }
    let (color, opacity, more) = std::mem::take(&mut statements.colors).finish(count)?;
    let mut warnings = more;
    warnings.extend(cut(&mut statements));
    if with_materials {
        warnings.extend(find_materials(&mut statements));
    } else {
        statements.materials.fill(NONE);
    }
    let derives_normals = !statements.triangles.is_empty()
        && statements.triangles.iter().flatten().any(|corner| corner[1] == NONE);
    warnings.extend(statements.skipped(derives_normals));
    let more = warnings.len().saturating_sub(MOST_WARNINGS);
    warnings.truncate(MOST_WARNINGS);
    if more > 0 {
        warnings.push(format!("and {more} more"));
    }
    let materials = std::mem::take(&mut statements.library.materials);
    let mesh = Mesh { statements, color, opacity, materials };
    let cloud = if mesh.statements.triangles.is_empty() { mesh.points() } else { mesh.mesh() };
    Ok(Cloud { warnings, ..cloud })
}

/// Cuts polygons into ears where the fan leaves them. Returns what is to be said.
fn cut(statements: &mut Statements) -> Option<String> {
    let mut budget = polygon::Budget::new();
    for &[start, corners] in &statements.polygons {
        let (start, corners) = (start as usize, corners as usize);
        let fan = &mut statements.triangles[start..start + corners - 2];
        let places = polygon::corners(fan);
        let positions = places.iter().map(|corner| statements.position[corner[0] as usize]);
        if let Some(ears) = polygon::ears(&positions.collect::<Vec<_>>(), &mut budget) {
            polygon::recut(fan, &places, &ears);
        }
    }
    budget.warning()
}

/// Replaces the names of the triangles' materials by the materials. Returns what is to be said.
fn find_materials(statements: &mut Statements) -> Vec<String> {
    let library = &mut statements.library;
    let mut warnings = std::mem::take(&mut library.warnings);
    // The names that triangles use, and the material of each; a name may have none.
    let used = uses(&statements.materials, statements.names.len());
    let mut found = vec![None; statements.names.len()];
    {
        let find = library.finder();
        for &name in used.iter().filter(|name| **name != NONE) {
            found[name as usize] = find(&statements.names[name as usize].0);
        }
    }
    let names = used.iter().filter(|name| **name != NONE).map(|name| *name as usize);
    let unknown: Vec<usize> = names.filter(|name| found[*name].is_none()).collect();
    let missing = !warnings.is_empty() && library.materials.is_empty();
    if let Some(&first) = unknown.first()
        && !missing
    {
        let (name, line) = &statements.names[first];
        let more = match unknown.len() {
            1 => String::new(),
            n => format!(", nor as {} others", n - 1),
        };
        let name = super::lines::shown(name);
        warnings.push(match library.is_named() {
            true => format!(
                "line {line}: no material is called `{name}`{more}; its polygons have the default \
                 grey"
            ),
            false => format!(
                "line {line}: usemtl `{name}`, but no mtllib names a file of materials; polygons \
                 have the default grey"
            ),
        });
    }
    let used: Vec<usize> = used.iter().filter_map(|&name| *found.get(name as usize)?).collect();
    warnings.extend(ignored(used.iter().map(|&material| &library.materials[material])));
    // Polygons of unknown materials are grey among colours; without colours, the scene's colour
    // holds for all.
    let colored = used.iter().any(|&material| library.materials[material].color.is_some());
    let grey = colored.then(|| Phong::default().color);
    let unknown = library.materials.len() as u32;
    library.materials.push(Material { color: grey, ..Material::default() });
    for material in statements.materials.iter_mut().filter(|material| **material != NONE) {
        *material = found[*material as usize].map_or(unknown, |found| found as u32);
    }
    warnings
}

/// Says once which lines of the materials are not read.
fn ignored<'a>(materials: impl Iterator<Item = &'a Material>) -> Option<String> {
    let mut words: Vec<&str> = Vec::new();
    let (mut first, mut several) = (None, false);
    for material in materials {
        let options = material.texture.iter().flat_map(|map| &map.ignored);
        for word in material.ignored.iter().chain(options).map(String::as_str) {
            several |= *first.get_or_insert(&material.name) != &material.name;
            if words.len() < MOST_WARNINGS && !words.contains(&word) {
                words.push(word);
            }
        }
    }
    let name = super::lines::shown(first?);
    let more = if several { " and others" } else { "" };
    Some(format!("material `{name}`{more}: {} is not read", words.join(", ")))
}

/// The materials that triangles use, each once, in the order of their first use. There are `count`,
/// and [`NONE`].
fn uses(materials: &[u32], count: usize) -> Vec<u32> {
    let mut first = vec![true; count + 1];
    let mut uses = Vec::new();
    for &material in materials {
        if std::mem::replace(&mut first[(material as usize).min(count)], false) {
            uses.push(material);
        }
    }
    uses
}

impl Mesh {
    /// The points of a file without polygons.
    fn points(self) -> Cloud {
        let Statements { position, normal, edges, .. } = self.statements;
        let normal = (normal.len() == position.len()).then_some(normal);
        let Self { color, opacity, .. } = self;
        Cloud { position, normal, color, opacity, edges, ..Cloud::default() }
    }

    fn mesh(self) -> Cloud {
        let all = &self.statements;
        let coordinates = self.coordinates();
        let textures = self.textures();
        let own = self.color.is_none() && (coordinates.is_none() || textures.is_empty());
        let paints = self.paints(own);
        let corners = || all.triangles.iter().flatten();
        let has_normals = corners().all(|corner| corner[1] != NONE);
        let point = |corner: &Corner, material: u32| {
            let normal = if has_normals { corner[1] } else { NONE };
            [corner[0], normal, paints.get(material as usize).copied().unwrap_or(NONE)]
        };
        let mut used = vec![false; all.position.len()];
        corners().for_each(|corner| used[corner[0] as usize] = true);
        // Vertices that no polygon uses stay in the cloud.
        let unused = (0..).zip(&used).filter(|(_, used)| !**used).map(|(i, _)| [i, NONE, NONE]);
        let triangles = all.triangles.iter().zip(&all.materials);
        let drawn = triangles.map(|(corners, &material)| corners.map(|c| point(&c, material)));
        let count = 3 * all.triangles.len() + used.iter().filter(|used| !**used).count();
        let mut points: Vec<[u32; 3]> = Vec::with_capacity(count);
        points.extend(drawn.clone().flatten().chain(unused));
        points.sort_unstable();
        points.dedup();
        let place = |corner: [u32; 3]| points.partition_point(|point| *point < corner) as u32;
        let triangles = drawn.map(|corners| corners.map(place)).collect();
        let vertices = || points.iter().map(|point| point[0] as usize);
        let material = |point: &[u32; 3]| self.materials.get(point[2] as usize);
        let painted = |point: &[u32; 3]| material(point)?.color;
        let color = match &self.color {
            Some(color) => Some(vertices().map(|vertex| color[vertex]).collect()),
            None => (own && self.uses_any(|material| material.color.is_some()))
                .then(|| points.iter().map(|point| painted(point).unwrap_or(Vec3::ONE)).collect()),
        };
        let veiled = self.uses_any(|material| material.opacity() < 1.0);
        let opacity = (veiled || self.opacity.is_some()).then(|| {
            let own = |vertex: u32| self.opacity.as_ref().map_or(1.0, |all| all[vertex as usize]);
            let of =
                |point: &[u32; 3]| own(point[0]) * material(point).map_or(1.0, Material::opacity);
            points.iter().map(of).collect()
        });
        // A line goes to the first point of a vertex.
        let first = |vertex: u32| points.partition_point(|point| point[0] < vertex) as u32;
        let edges = all.edges.iter().map(|ends| ends.map(first)).collect();
        // A vertex of no polygon has no normal.
        let normal = |point: &[u32; 3]| all.normal.get(point[1] as usize).copied();
        Cloud {
            triangles,
            position: vertices().map(|vertex| all.position[vertex]).collect(),
            color,
            opacity,
            edges,
            normal: has_normals
                .then(|| points.iter().map(|point| normal(point).unwrap_or(Vec3::ZERO)).collect()),
            coordinates,
            textures,
            ..Cloud::default()
        }
    }

    /// The texture coordinates of all corners, if any corner has some.
    fn coordinates(&self) -> Option<Coordinates> {
        let all = &self.statements;
        if all.triangles.iter().flatten().all(|corner| corner[2] == NONE) {
            return None;
        }
        let of = |corner: Corner, material: u32| {
            let at = all.coordinate.get(corner[2] as usize).copied().unwrap_or(Vec2::NAN);
            let material = self.materials.get(material as usize);
            material.and_then(|one| one.texture.as_ref()).map_or(at, |map| map.place(at))
        };
        let triangles = all.triangles.iter().zip(&all.materials);
        let placed = triangles.map(|(corners, &material)| corners.map(|c| of(c, material)));
        Some(Coordinates::Corners(placed.collect()))
    }

    /// The textures of the triangles in the order of their first use, with an empty name where
    /// there is none. Empty if no triangle has a texture.
    fn textures(&self) -> Vec<String> {
        let mut names: Vec<&str> = Vec::new();
        for used in uses(&self.statements.materials, self.materials.len()) {
            let material = self.materials.get(used as usize);
            let texture = material.and_then(|material| material.texture.as_ref());
            let name = texture.map_or("", |map| &map.name);
            if !names.contains(&name) {
                names.push(name);
            }
        }
        if names == [""] { Vec::new() } else { names.into_iter().map(str::to_owned).collect() }
    }

    /// Whether any triangle has such a material.
    fn uses_any(&self, such: impl Fn(&Material) -> bool) -> bool {
        let used = uses(&self.statements.materials, self.materials.len());
        used.into_iter().filter_map(|used| self.materials.get(used as usize)).any(such)
    }

    /// For each material the first one of the same opacity and, if materials give the colours, of the
    /// same colour; empty if no triangle has any.
    fn paints(&self, colored: bool) -> Vec<u32> {
        let look = |of: &Material| (of.color.filter(|_| colored), of.opacity());
        if !self.uses_any(|material| look(material) != (None, 1.0)) {
            return Vec::new();
        }
        let same = |of: &Material| {
            self.materials.iter().position(|other| look(other) == look(of)).unwrap_or(0) as u32
        };
        self.materials.iter().map(same).collect()
    }
}
