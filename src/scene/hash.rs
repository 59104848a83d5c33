//! Identify a scene by one hash over everything that a picture depends on, except camera and
//! settings.

use super::gaussians::{Encoding, Gaussians};
use super::indexed::Indexed;
use super::{Environment, Light, Mipmap, Objects, Phong, Primitives, Scene, Surface, Surfels};
use crate::frame::NO_ID;
use crate::scene::Groups;
use crate::scene::objects::Detail;
use crate::scene::objects::detail::refine::Refinement;
use glam::Vec3;
use sha2::{Digest, Sha256};

impl Scene {
    /// SHA-256 in lower-case hexadecimal; the name is not part of it.
    ///
    /// The hash covers these bytes, numbers in little-endian order and `f32` by their bits:
    ///
    /// ```text
    ///   "splatref scene 1\n"
    ///   u64 count of surfels
    ///   position (3 f32 each), normal (3 f32), radius (f32)
    ///   colour (3 f32), opacity (f32), tangents (6 f32): each after a byte 1, or a byte 0 alone
    ///   u64 count of lights; each a byte 0 directional, 1 headlight, 2 point; then direction or
    ///     position (3 f32), colour (3 f32)
    ///   material: ambient, diffuse, specular, shininess (f32), colour (3 f32)
    ///   environment: nothing if there is none; a byte 1 for the sky; or a byte 2, then width and
    ///     height (u64), and the pixels (3 f32 each) row by row from the top left
    ///   primitives: nothing if there is none; else a byte 3, then triangles, ribbons and tubes,
    ///     each: u64 count of vertices; position (3 f32), direction (3 f32), radius (f32); colour
    ///     (3 f32) after a byte 1, or a byte 0 alone; u64 count of primitives; the vertices of
    ///     each (u32)
    ///   objects: nothing if there are none; else a byte 4, then
    ///     u64 count of geometries, each: surfels as above, from their count to their tangents; then
    ///       triangles, ribbons and tubes as above, without the byte 3, and all three lists even if
    ///       they are empty; of a hierarchy in a folder, of which a view reads what it needs, the count
    ///       and the hash of the hierarchy (32 bytes)
    ///     the colour of objects without one (3 f32)
    ///     u64 count of objects, each: geometry (u64), colour (3 f32) after a byte 1, or a byte 0
    ///       alone; rotation row by row, scale and translation in the frame (13 f64)
    ///     each geometry with levels of detail: a byte 6, its index (u64), its threshold (f64); or a
    ///       byte 7, its index (u64), p_m (u32) and r_m (f32)
    ///     if a geometry has a byte 7: a byte 8, size (f32), budget (u32) or 0, u64 count of zones, their
    ///       numbers (2 f32 each); of each object the one that it is a finer one of (u32), or
    ///       0xFFFF_FFFF
    ///   prefiltered colours: nothing if no surfel has any; else a byte 5, then for the surfels, or for
    ///     those of each geometry, u64 count of levels, and the colours surfel by surfel (3 f32 each)
    ///   Gaussians: nothing if there are none; else a byte 9, then u64 count; position (3 f32 each),
    ///     scale (3 f32), rotation (x, y, z, w), opacity (f32); a byte for the degree, and one for the
    ///     encoding, 0 sRGB or 1 linear; the coefficients of each (3 f32 each)
    ///   surface: nothing if there is none; else a byte 10, then width and height (u64), the depths (f32),
    ///     and the colours (3 f32 each), row by row from the top left
    /// ```
    ///
    /// A list of primitives without vertices takes 17 bytes: a count of 0, the byte for colours, a
    /// count of 0. The byte for colours is 1 in all three lists if the geometry's model has a
    /// `color`, because this colour replaces the colours of all lists, the empty ones too. Else it
    /// is 0 in a list without colours.
    ///
    /// A scene of objects has no surfels and no primitives except the ones of its geometries,
    /// whether it is [flat](mod@crate::source::flatten) or not.
    #[must_use]
    pub fn sha256(&self) -> String {
        let none = (Surfels::none(), Primitives::default());
        let (surfels, primitives) = match &self.objects {
            None => (&self.surfels, &self.primitives),
            Some(_) => (&none.0, &none.1),
        };
        let mut hash = match &self.excerpt {
            Some(excerpt) => Hasher(excerpt.hash.clone()),
            None => {
                let mut hash = Hasher(begin(surfels.len() as u64));
                hash.surfels(surfels);
                hash
            }
        };
        hash.count(self.lights.len());
        for light in &self.lights {
            let (kind, place, color) = match *light {
                Light::Directional { towards, color } => (0, towards, color),
                Light::Headlight { towards, color } => (1, towards, color),
                Light::Point { position, color } => (2, position, color),
            };
            hash.0.update([kind]);
            hash.floats(place.to_array().into_iter().chain(color.to_array()));
        }
        let Phong { ambient, diffuse, specular, shininess, color } = self.material;
        hash.floats([ambient, diffuse, specular, shininess].into_iter().chain(color.to_array()));
        hash.environment(self.environment.as_ref());
        if !primitives.is_empty() {
            hash.0.update([3]);
            hash.primitives(primitives);
        }
        if let Some(objects) = &self.objects {
            hash.0.update([4]);
            hash.objects(objects);
        }
        let all: Vec<&Surfels> = match &self.objects {
            None => vec![surfels],
            Some(objects) => objects.geometries().iter().map(|g| &g.surfels).collect(),
        };
        if all.iter().any(|surfels| surfels.mipmap().is_some()) {
            hash.0.update([5]);
            all.iter().for_each(|surfels| hash.mipmap(surfels));
        }
        if let Some(gaussians) = &self.gaussians {
            hash.0.update([9]);
            hash.gaussians(gaussians);
        }
        if let Some(surface) = &self.surface {
            hash.0.update([10]);
            hash.surface(surface);
        }
        hash.finish()
    }
}

impl Groups {
    /// SHA-256 in lower-case hexadecimal.
    ///
    /// The hash covers the bytes `"splatref groups 1\n"`, the u64 count of groups and the scale of
    /// each (f32), the u64 count of surfels and the own group of each (a byte), the u64 count of
    /// additions, each a u32 surfel and a byte, ascending; numbers in little-endian order.
    #[must_use]
    pub fn sha256(&self) -> String {
        let mut hash = Hasher(Sha256::new());
        hash.0.update(b"splatref groups 1\n");
        hash.count(self.len());
        hash.floats(self.scale().iter().copied());
        hash.count(self.own().len());
        hash.0.update(self.own());
        hash.count(self.added().len());
        for (surfel, group) in self.added() {
            hash.0.update(surfel.to_le_bytes());
            hash.0.update([*group]);
        }
        hash.finish()
    }
}

/// How many attributes of surfels are hashed one after the other.
pub(crate) const ATTRIBUTES: usize = 6;

/// Begins the hash of a scene of so many surfels. Then come the [`ATTRIBUTES`], each as its [`head`]
/// and its [`part`]s: in one part, or in several in the order of the surfels.
pub(crate) fn begin(count: u64) -> Sha256 {
    let hash = Sha256::new().chain_update(b"splatref scene 1\n");
    hash.chain_update(count.to_le_bytes())
}

/// What is hashed before the values of an attribute: whether there are any, unless there must be.
/// `there` is of colours, opacities and tangents.
pub(crate) fn head(hash: &mut Sha256, attribute: usize, there: [bool; 3]) {
    if let Some(&there) = attribute.checked_sub(3).and_then(|i| there.get(i)) {
        hash.update([u8::from(there)]);
    }
}

/// Hashes the values of an attribute of some surfels.
pub(crate) fn part(hash: &mut Sha256, attribute: usize, surfels: &Surfels) {
    let vectors = |hash: &mut Sha256, all: &[Vec3]| {
        let numbers = all.iter().flat_map(Vec3::to_array);
        numbers.for_each(|value| hash.update(value.to_le_bytes()));
    };
    let numbers = |hash: &mut Sha256, all: &[f32]| {
        all.iter().for_each(|value| hash.update(value.to_le_bytes()));
    };
    match attribute {
        0 => vectors(hash, surfels.position()),
        1 => vectors(hash, surfels.normal()),
        2 => numbers(hash, surfels.radius()),
        3 => vectors(hash, surfels.color().unwrap_or_default()),
        4 => numbers(hash, surfels.opacity().unwrap_or_default()),
        _ => vectors(hash, surfels.tangents().unwrap_or_default().as_flattened()),
    }
}

/// Feeds numbers, as bytes, into a hash.
struct Hasher(Sha256);

impl Hasher {
    fn count(&mut self, count: usize) {
        self.0.update((count as u64).to_le_bytes());
    }

    fn floats(&mut self, values: impl IntoIterator<Item = f32>) {
        values.into_iter().for_each(|value| self.0.update(value.to_le_bytes()));
    }

    /// The surfels, after their count.
    fn surfels(&mut self, surfels: &Surfels) {
        let there =
            [surfels.color().is_some(), surfels.opacity().is_some(), surfels.tangents().is_some()];
        for attribute in 0..ATTRIBUTES {
            head(&mut self.0, attribute, there);
            part(&mut self.0, attribute, surfels);
        }
    }

    fn environment(&mut self, environment: Option<&Environment>) {
        match environment {
            None => {}
            Some(Environment::Sky) => self.0.update([1]),
            Some(Environment::Map(map)) => {
                let pixels = map.pixels();
                self.0.update([2]);
                self.count(pixels.width() as usize);
                self.count(pixels.height() as usize);
                self.floats(pixels.values().iter().flatten().copied());
            }
        }
    }

    fn surface(&mut self, surface: &Surface) {
        surface.size().into_iter().for_each(|side| self.count(side as usize));
        self.floats(surface.depths().values().iter().copied());
        self.floats(surface.colors().values().iter().flatten().copied());
    }

    fn mipmap(&mut self, surfels: &Surfels) {
        self.count(surfels.mipmap().map_or(0, Mipmap::levels));
        let colors = surfels.mipmap().map(Mipmap::colors).unwrap_or_default();
        self.floats(colors.iter().flat_map(Vec3::to_array));
    }

    fn gaussians(&mut self, gaussians: &Gaussians) {
        self.count(gaussians.len());
        self.floats(gaussians.position().iter().flat_map(Vec3::to_array));
        self.floats(gaussians.scale().iter().flat_map(Vec3::to_array));
        self.floats(gaussians.rotation().iter().flatten().copied());
        self.floats(gaussians.opacity().iter().copied());
        let linear = u8::from(gaussians.encoding() == Encoding::Linear);
        self.0.update([gaussians.degree() as u8, linear]);
        self.floats(gaussians.all_harmonics().iter().flat_map(Vec3::to_array));
    }

    fn primitives(&mut self, primitives: &Primitives) {
        self.indexed(&primitives.triangles);
        self.indexed(&primitives.ribbons);
        self.indexed(&primitives.tubes);
    }

    fn objects(&mut self, objects: &Objects) {
        self.count(objects.geometries().len());
        match objects.source() {
            // What is read of the geometries depends on the view, so the hash of their source
            // stands for them.
            Some(source) => self.0.update(source),
            None => objects.geometries().iter().for_each(|geometry| {
                self.count(geometry.surfels.len());
                self.surfels(&geometry.surfels);
                self.primitives(&geometry.primitives);
            }),
        }
        self.floats(objects.fill().to_array());
        self.count(objects.objects().len());
        for (object, place) in objects.objects().iter().zip(objects.places()) {
            self.count(object.geometry);
            self.optional(object.color.as_ref().map(std::slice::from_ref), |c| c.to_array());
            let rows = place.rotation.transpose().to_cols_array();
            let place = rows.into_iter().chain([place.scale]).chain(place.translation.to_array());
            place.for_each(|value| self.0.update(value.to_le_bytes()));
        }
        for (index, geometry) in objects.geometries().iter().enumerate() {
            match &geometry.detail {
                None => {}
                Some(Detail::Tree(tree)) => {
                    self.0.update([6]);
                    self.count(index);
                    self.0.update(tree.threshold().to_le_bytes());
                }
                Some(Detail::Prefix(prefix)) => {
                    self.0.update([7]);
                    self.count(index);
                    self.0.update(prefix.estimate().count.to_le_bytes());
                    self.floats([prefix.estimate().distance]);
                }
            }
        }
        if objects.have_prefixes() {
            let Refinement { surfel_size, budget, zones } = objects.refinement();
            self.0.update([8]);
            self.floats([*surfel_size]);
            self.0.update(budget.unwrap_or(0).to_le_bytes());
            self.count(zones.len());
            self.floats(zones.iter().flatten().copied());
            let coarser = (0..objects.objects().len() as u32).map(|object| objects.coarser(object));
            coarser.for_each(|of| self.0.update(of.unwrap_or(NO_ID).to_le_bytes()));
        }
    }

    fn optional<T, const N: usize>(&mut self, values: Option<&[T]>, of: impl Fn(&T) -> [f32; N]) {
        self.0.update([u8::from(values.is_some())]);
        self.floats(values.unwrap_or_default().iter().flat_map(of));
    }

    fn indexed<const N: usize>(&mut self, primitives: &Indexed<N>) {
        let vertices = primitives.vertices();
        self.count(vertices.position.len());
        self.floats(vertices.position.iter().flat_map(Vec3::to_array));
        self.floats(vertices.direction.iter().flat_map(Vec3::to_array));
        self.floats(vertices.radius.iter().copied());
        self.optional(vertices.color.as_deref(), |c| c.to_array());
        self.count(primitives.len());
        let corners = primitives.corners().iter().flatten();
        corners.for_each(|corner| self.0.update(corner.to_le_bytes()));
    }

    fn finish(self) -> String {
        self.0.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Plane;
    use crate::scene::environment::Map;
    use crate::scene::{Cloud, Polylines, Primitives, Surfels, Vertices};

    fn scene(cloud: Cloud) -> Scene {
        let lights = vec![Light::Point { position: Vec3::X, color: Vec3::ONE }];
        let surfels = Surfels::new(cloud).unwrap().0;
        Scene { lights, ..Scene::unlit("a", surfels) }
    }

    fn cloud() -> Cloud {
        Cloud {
            position: vec![Vec3::new(1.0, 2.0, 3.0)],
            normal: Some(vec![Vec3::Z]),
            radius: Some(vec![0.5]),
            ..Cloud::default()
        }
    }

    /// The documented bytes, written out by hand.
    fn documented() -> Vec<u8> {
        let mut bytes = b"splatref scene 1\n".to_vec();
        bytes.extend(1_u64.to_le_bytes());
        for value in [1.0_f32, 2.0, 3.0, 0.0, 0.0, 1.0, 0.5] {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend([0, 0, 0]);
        bytes.extend(1_u64.to_le_bytes());
        bytes.push(2);
        for value in [1.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0] {
            bytes.extend(value.to_le_bytes());
        }
        for value in [0.125_f32, 0.75, 0.25, 32.0, 0.75, 0.75, 0.75] {
            bytes.extend(value.to_le_bytes());
        }
        bytes
    }

    /// Hashes with the crate that `sha256sum` checks.
    fn hash(bytes: &[u8]) -> String {
        Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
    }

    #[test]
    fn the_bytes_are_those_documented() {
        let mut bytes = documented();
        assert_eq!(scene(cloud()).sha256(), hash(&bytes));

        let surrounded = |environment| Scene { environment: Some(environment), ..scene(cloud()) };
        let sky = [&bytes[..], &[1]].concat();
        assert_eq!(surrounded(Environment::Sky).sha256(), hash(&sky));
        bytes.push(2);
        bytes.extend([2_u64, 1].into_iter().flat_map(u64::to_le_bytes));
        bytes.extend([0.5_f32, 0.25, 0.0, 1.0, 2.0, 3.0].into_iter().flat_map(f32::to_le_bytes));
        let pixels = vec![[0.5, 0.25, 0.0], [1.0, 2.0, 3.0]];
        let map = Map::new(Plane::from_values(2, 1, pixels)).unwrap();
        assert_eq!(surrounded(Environment::Map(map)).sha256(), hash(&bytes));
    }

    #[test]
    fn the_bytes_of_primitives_are_those_documented() {
        let (bare, mut with) = (scene(cloud()), scene(cloud()));
        let vertices = Vertices {
            position: vec![Vec3::X, Vec3::Y],
            direction: vec![Vec3::Z; 2],
            radius: vec![0.5, 0.25],
            color: None,
            ..Vertices::default()
        };
        // Vertices without a primitive do not count, so nothing is hashed for them.
        with.primitives.tubes = Polylines::new(vertices.clone(), vec![]).unwrap().0;
        assert_eq!(with.sha256(), bare.sha256());
        let mut all = vec![bare.sha256()];
        let color = Some(vec![Vec3::ONE, Vec3::ZERO]);
        for vertices in [vertices.clone(), Vertices { color, ..vertices }] {
            let (line, _) = Polylines::new(vertices, vec![[1, 0]]).unwrap();
            let none = Primitives::default;
            with.primitives = Primitives { tubes: line.clone(), ..none() };
            all.push(with.sha256());
            with.primitives = Primitives { ribbons: line, ..none() };
            all.push(with.sha256());
        }
        let count = all.len();
        let ribbon = all[2].clone();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), count, "all different");

        // The bytes of the scene so far, then the bytes of the ribbon.
        let mut bytes = documented();
        bytes.push(3);
        let counts = |bytes: &mut Vec<u8>, count: u64| bytes.extend(count.to_le_bytes());
        counts(&mut bytes, 0);
        bytes.push(0);
        counts(&mut bytes, 0);
        counts(&mut bytes, 2);
        for value in [1.0_f32, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.5, 0.25] {
            bytes.extend(value.to_le_bytes());
        }
        bytes.push(0);
        counts(&mut bytes, 1);
        bytes.extend([1_u32, 0].into_iter().flat_map(u32::to_le_bytes));
        counts(&mut bytes, 0);
        bytes.push(0);
        counts(&mut bytes, 0);
        assert_eq!(ribbon, hash(&bytes));
    }

    fn leveled(cloud: &mut Cloud, levels: usize, color: Vec3) {
        cloud.color = Some(vec![Vec3::ZERO]);
        cloud.mipmap = Some(Mipmap::new(levels, vec![color; levels]).unwrap());
    }

    #[test]
    fn the_bytes_of_prefiltered_colours_are_those_documented() {
        let mut cloud = cloud();
        leveled(&mut cloud, 2, Vec3::X);
        let mut bytes = documented();
        // The colour, in the place of the byte that says there is none.
        let at = 17 + 8 + 7 * 4;
        bytes.splice(at..=at, [1].into_iter().chain([0; 12]));
        bytes.push(5);
        bytes.extend(2_u64.to_le_bytes());
        let colors = [1.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0];
        bytes.extend(colors.into_iter().flat_map(f32::to_le_bytes));
        assert_eq!(scene(cloud).sha256(), hash(&bytes));
    }

    #[test]
    fn every_part_counts_and_the_name_does_not() {
        let of = |change: fn(&mut Cloud)| {
            let mut cloud = cloud();
            change(&mut cloud);
            scene(cloud).sha256()
        };
        let mut lit = scene(cloud());
        lit.lights.clear();
        let mut dull = scene(cloud());
        dull.material.specular = 0.0;
        let mut all = vec![
            of(|_| ()),
            of(|c| c.position[0].x = -1.0),
            of(|c| c.normal = Some(vec![Vec3::Y])),
            of(|c| c.radius = Some(vec![0.25])),
            of(|c| c.color = Some(vec![Vec3::ZERO])),
            of(|c| c.opacity = Some(vec![0.0])),
            of(|c| c.tangents = Some(vec![[Vec3::X, Vec3::Y]])),
            of(|c| leveled(c, 1, Vec3::ZERO)),
            of(|c| leveled(c, 2, Vec3::ZERO)),
            of(|c| leveled(c, 2, Vec3::X)),
            lit.sha256(),
            dull.sha256(),
        ];
        let mut named = scene(cloud());
        named.name = "b".into();
        assert_eq!(named.sha256(), all[0]);
        let count = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), count, "all different");
    }
}
