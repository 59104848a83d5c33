//! All files of a hierarchy.

use super::mesh::{Bytes, Mesh, children, shifted};
use super::octree::{self, Node};
use super::pictures::{Surfels, approximate};
use super::view::placed;
use glam::Vec3;
use splatref::scene::{Object, Similarity};
use splatref::source::candidates::Directions;
use splatref::source::hierarchy::octree::{Item, NO_NODE};
use splatref::source::hierarchy::{BOUND, Sampler, Settings, Traversal};
use splatref::source::sampler::Schedule;
use std::collections::BTreeMap;

/// A scene and what is to be computed of it.
pub(crate) struct World {
    pub(crate) meshes: Vec<Mesh>,
    pub(crate) objects: Vec<Object>,
    pub(crate) fill: Vec3,
    pub(crate) settings: Settings,
    /// The tree over the objects that rest; of its items each the object.
    pub(crate) upper: Vec<Node>,
    pub(crate) still: Vec<u32>,
    /// The surfels of nodes, by their numbers.
    pub(crate) surfels: BTreeMap<u32, Surfels>,
}

fn colored(bytes: &mut Bytes, color: Option<Vec3>) {
    bytes.0.push(u8::from(color.is_some()));
    color.iter().for_each(|c| bytes.f32(&c.to_array()));
}

fn similarity(bytes: &mut Bytes, place: &Similarity) {
    let m = place.rotation;
    [m.x_axis, m.y_axis, m.z_axis].iter().for_each(|c| bytes.f64(&c.to_array()));
    bytes.f64(&[place.scale]);
    bytes.f64(&place.translation.to_array());
}

impl World {
    pub(crate) fn new(
        meshes: Vec<Mesh>,
        objects: Vec<Object>,
        fill: Vec3,
        settings: Settings,
    ) -> Self {
        let still = |o: &u32| objects[*o as usize].motion.is_still();
        let still: Vec<u32> = (0..objects.len() as u32).filter(still).collect();
        let item = |&o: &u32| {
            let object = &objects[o as usize];
            let mesh = &meshes[object.geometry];
            let [low, high] = [mesh.tree[0].low, mesh.tree[0].high].map(|v| v.map(f64::from));
            let place = object.motion.at(0);
            let mut corners = Vec::new();
            for i in 0..8 {
                let of = |k: usize| if i >> k & 1 == 0 { low[k] } else { high[k] };
                corners.push(placed(&place, [of(0), of(1), of(2)]));
            }
            let of = |k: usize, better: fn(f64, f64) -> f64| {
                corners.iter().map(|c| c[k]).reduce(better).expect("eight") as f32
            };
            let low = [0, 1, 2].map(|k| of(k, f64::min).next_down());
            let high = [0, 1, 2].map(|k| of(k, f64::max).next_up());
            Item { low: low.into(), high: high.into(), weight: mesh.corners.len() as u64 }
        };
        let items: Vec<Item> = still.iter().map(item).collect();
        let upper = octree::model(&items, BOUND);
        let surfels = BTreeMap::new();
        let mut all = Self { meshes, objects, fill, settings, upper, still, surfels };
        let total = all.first(all.meshes.len());
        // What is below has greater numbers in its tree, and trees of geometries come last.
        for number in (0..total).rev() {
            if let Some(surfels) = approximate(&all, number) {
                all.surfels.insert(number, surfels);
            }
        }
        all
    }

    /// Whether some vertices have opacities.
    pub(crate) fn veiled(&self) -> bool {
        self.meshes.iter().any(|mesh| mesh.opacity.is_some())
    }

    /// The number of the first node of a geometry.
    pub(crate) fn first(&self, geometry: usize) -> u32 {
        let before = self.meshes[..geometry].iter().map(|mesh| mesh.tree.len()).sum::<usize>();
        (self.upper.len() + before) as u32
    }

    /// The tree of a node, the number of its first node and its geometry.
    pub(crate) fn tree_of(&self, number: u32) -> (&[Node], u32, Option<usize>) {
        let geometry = (0..self.meshes.len()).rev().find(|&g| self.first(g) <= number);
        geometry.map_or((&self.upper, 0, None), |g| (&self.meshes[g].tree, self.first(g), Some(g)))
    }

    /// The surfels of a node, if it has some.
    pub(crate) fn surfels_of(&self, number: u32) -> Option<&Surfels> {
        self.surfels.get(&number).filter(|surfels| surfels.header().0 > 0)
    }

    /// The number of surfels that a node is to have.
    pub(crate) fn wanted(&self, number: u32) -> u32 {
        let (tree, first, geometry) = self.tree_of(number);
        let node = &tree[(number - first) as usize];
        if node.weight < 1000 || (geometry.is_none() && node.items == 1) {
            return 0;
        }
        (node.weight / 2).min(self.settings.most.into()) as u32
    }

    fn plan(&self) -> [u8; 32] {
        let mut bytes = Bytes::begin("splatref hierarchy 1\n");
        let settings = &self.settings;
        bytes.u32(&[settings.most, settings.side]);
        bytes.0.push(match settings.sampler {
            Sampler::Greedy => 0,
            Sampler::Progressive(Schedule::Paper) => 1,
            Sampler::Progressive(Schedule::AsShipped) => 2,
            Sampler::Random => 3,
        });
        bytes.0.push(if settings.traversal == Traversal::BottomUp { 2 } else { 0 });
        bytes.u64(&[settings.seed]);
        match &settings.directions {
            Directions::Cube => bytes.u32(&[0]),
            Directions::Box => bytes.u32(&[1]),
            Directions::These(all) => {
                bytes.u32(&[2 + all.len() as u32]);
                all.iter().for_each(|d| bytes.f64(&d.to_array()));
            }
        }
        bytes.f32(&self.fill.to_array());
        bytes.u64(&[self.meshes.len() as u64, self.objects.len() as u64]);
        for object in &self.objects {
            bytes.u64(&[object.geometry as u64, object.motion.keys().len() as u64]);
            for (frame, place) in object.motion.keys() {
                bytes.u32(&[*frame]);
                similarity(&mut bytes, place);
            }
            colored(&mut bytes, object.color);
        }
        settings.properties.iter().for_each(|name| bytes.name(name));
        bytes.hash()
    }

    /// The objects in the order of the index: each with its node.
    pub(crate) fn order(&self) -> Vec<(u32, u32)> {
        let mut all = Vec::new();
        for (number, node) in (0..).zip(&self.upper) {
            all.extend(node.own.iter().map(|&i| (self.still[i as usize], number)));
        }
        let moves = |o: &u32| !self.objects[*o as usize].motion.is_still();
        all.extend((0..self.objects.len() as u32).filter(moves).map(|o| (o, NO_NODE)));
        all
    }

    /// What bounds the surfels and the own triangles of each node.
    fn bounds(&self, hash: &[u8; 32]) -> Vec<u8> {
        let mut bytes = Bytes::begin("splatref ball 2\n");
        bytes.0.extend(hash);
        let total = self.first(self.meshes.len());
        bytes.u32(&[total, 0]);
        for number in 0..total {
            let (tree, first, geometry) = self.tree_of(number);
            let node = &tree[(number - first) as usize];
            let own = geometry.map_or(Vec::new(), |g| {
                let mesh = &self.meshes[g];
                let at = |&v: &u32| (mesh.position[v as usize], 0.0);
                mesh.vertices(node).iter().map(at).collect()
            });
            let around = [node.low, node.high].map(Vec3::from);
            let discs = self.surfels.get(&number).map(|surfels| surfels.discs(around));
            let all: Vec<(Vec3, f32)> = discs.unwrap_or_default().into_iter().chain(own).collect();
            let corner = |better: fn(f32, f32) -> f32| {
                let of = |k: usize| all.iter().map(|(p, _)| p[k]).reduce(better);
                [0, 1, 2].map(|k| of(k).unwrap_or(0.0) + 0.0)
            };
            let (low, high) = (corner(f32::min), corner(f32::max));
            let middle = [0, 1, 2].map(|k| (f64::from(low[k]) + f64::from(high[k])) / 2.0);
            let reach = |(p, r): &(Vec3, f32)| {
                let d = [0, 1, 2].map(|k| f64::from(p[k]) - middle[k]);
                ((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]).sqrt() + f64::from(*r)
            };
            bytes.f32(&low);
            bytes.f32(&high);
            bytes.f64(&[all.iter().map(reach).fold(0.0, f64::max)]);
        }
        bytes.seal(0);
        bytes.0
    }

    fn index(&self, hash: &[u8; 32], begins: &[Vec<u64>]) -> Vec<u8> {
        let mut bytes = Bytes::begin("splatref tree 2\n");
        bytes.0.extend(hash);
        let total = self.first(self.meshes.len());
        let of = [self.upper.len(), self.objects.len(), self.meshes.len()].map(|n| n as u32);
        bytes.u32(&[total, of[0], of[1], of[2]]);
        bytes.f32(&self.fill.to_array());
        bytes.u32(&[self.settings.properties.len() as u32]);
        let mut objects = 0;
        for number in 0..total {
            let (tree, first, geometry) = self.tree_of(number);
            let node = &tree[(number - first) as usize];
            let [child, count] = children(tree, (number - first) as usize);
            let of = geometry.map_or(NO_NODE, |g| g as u32);
            bytes.u32(&[shifted(node.parent, first), child + first, count, of]);
            bytes.f32(&node.low);
            bytes.f32(&node.high);
            bytes.u64(&[node.weight]);
            let own = node.own.len() as u32;
            if let Some(g) = geometry {
                let vertices = self.meshes[g].vertices(node).len() as u32;
                bytes.u32(&[own, vertices]);
                bytes.u64(&[begins[g][(number - first) as usize]]);
                bytes.u32(&[0, 0]);
            } else {
                bytes.u32(&[0, 0]);
                bytes.u64(&[0]);
                bytes.u32(&[objects, own]);
                objects += own;
            }
            let (count, p, r) = self.surfels.get(&number).map_or((0, 0, 0.0), Surfels::header);
            bytes.u32(&[count, p]);
            bytes.f32(&[r]);
            bytes.u32(&[0]);
        }
        self.rest(&mut bytes);
        bytes.seal(0);
        bytes.0
    }

    /// The objects and the geometries of the index.
    fn rest(&self, bytes: &mut Bytes) {
        for (number, node) in self.order() {
            let object = &self.objects[number as usize];
            let moves = !object.motion.is_still();
            let kind = u32::from(object.color.is_some()) + 2 * u32::from(moves);
            bytes.u32(&[number, object.geometry as u32, node, kind]);
            bytes.f32(&object.color.unwrap_or(Vec3::ZERO).to_array());
            bytes.f32(&[0.0]);
            similarity(bytes, &object.motion.at(0));
        }
        for (g, mesh) in self.meshes.iter().enumerate() {
            let nodes = mesh.tree.len() as u32;
            bytes.u32(&[self.first(g), nodes, mesh.kind(), 0]);
            bytes.0.extend(mesh.hash());
            bytes.u64(&mesh.flaws());
        }
        self.settings.properties.iter().for_each(|name| bytes.name(name));
    }

    /// All files by their names.
    pub(crate) fn files(&self) -> BTreeMap<String, Vec<u8>> {
        let mut all = BTreeMap::new();
        let plan = self.plan();
        let digits: String = plan.iter().map(|byte| format!("{byte:02x}")).collect();
        all.insert("plan".into(), format!("splatref hierarchy 1\n{digits}\n").into_bytes());
        let mut hash = Bytes(plan.to_vec());
        self.meshes.iter().for_each(|mesh| hash.0.extend(mesh.hash()));
        let hash = hash.hash();
        let mut begins = Vec::new();
        for (g, mesh) in self.meshes.iter().enumerate() {
            let (bytes, begin) = mesh.file();
            all.insert(format!("mesh-{g}"), bytes);
            begins.push(begin);
        }
        for (number, surfels) in &self.surfels {
            all.insert(
                format!("surfels-{number}"),
                surfels.file(&hash, *number, self.settings.properties.len()),
            );
        }
        all.insert("bounds".into(), self.bounds(&hash));
        all.insert("index".into(), self.index(&hash, &begins));
        all
    }
}
