//! Geometries of a hierarchy: their triangles, what is wrong with them, their trees and their files.

use super::octree::{self, Node};
use crate::oracle::kit::eye::{cross, sub, wide};
use glam::Vec3;
use sha2::{Digest, Sha256};
use splatref::scene::{Property, Triangles};
use splatref::source::hierarchy::octree::{Item, NO_NODE};
use std::collections::BTreeMap;

/// Bytes that grow.
#[derive(Default)]
pub(crate) struct Bytes(pub(crate) Vec<u8>);

impl Bytes {
    pub(crate) fn begin(text: &str) -> Self {
        Self(text.as_bytes().to_vec())
    }

    pub(crate) fn u32(&mut self, all: &[u32]) {
        all.iter().for_each(|v| self.0.extend(v.to_le_bytes()));
    }

    pub(crate) fn u64(&mut self, all: &[u64]) {
        all.iter().for_each(|v| self.0.extend(v.to_le_bytes()));
    }

    pub(crate) fn f32(&mut self, all: &[f32]) {
        all.iter().for_each(|v| self.0.extend(v.to_le_bytes()));
    }

    pub(crate) fn f64(&mut self, all: &[f64]) {
        all.iter().for_each(|v| self.0.extend(v.to_le_bytes()));
    }

    pub(crate) fn name(&mut self, name: &str) {
        self.u32(&[name.len() as u32]);
        self.0.extend(name.as_bytes());
    }

    /// Appends the CRC-32 of the bytes from `start` on, bit by bit as the standard writes it.
    pub(crate) fn seal(&mut self, start: usize) {
        let crc = !self.0[start..].iter().fold(!0, |crc: u32, byte| {
            let step = |crc: u32, _| (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 };
            (0..8).fold(crc ^ u32::from(*byte), step)
        });
        self.u32(&[crc]);
    }

    pub(crate) fn hash(&self) -> [u8; 32] {
        Sha256::digest(&self.0).into()
    }
}

/// Triangles with what every corner has.
pub(crate) struct Mesh {
    pub(crate) position: Vec<Vec3>,
    pub(crate) normal: Vec<Vec3>,
    pub(crate) color: Option<Vec<Vec3>>,
    pub(crate) opacity: Option<Vec<f32>>,
    pub(crate) properties: Vec<Property>,
    pub(crate) corners: Vec<[u32; 3]>,
    /// Triangles that were dropped.
    pub(crate) dropped: u64,
    /// The tree over the triangles.
    pub(crate) tree: Vec<Node>,
}

impl Mesh {
    pub(crate) fn new(triangles: &Triangles, dropped: u64, bound: u64) -> Self {
        let vertices = triangles.vertices();
        let item = |corners: &[u32; 3]| {
            let all = corners.map(|v| vertices.position[v as usize]);
            let of = |better: fn(f32, f32) -> f32| {
                Vec3::from_array([0, 1, 2].map(|k| better(better(all[0][k], all[1][k]), all[2][k])))
            };
            Item { low: of(f32::min), high: of(f32::max), weight: 1 }
        };
        let items: Vec<Item> = triangles.corners().iter().map(item).collect();
        Self {
            position: vertices.position.clone(),
            normal: vertices.direction.clone(),
            color: vertices.color.clone(),
            opacity: vertices.opacity.clone(),
            properties: vertices.properties.clone(),
            corners: triangles.corners().to_vec(),
            dropped,
            tree: octree::model(&items, bound),
        }
    }

    pub(crate) fn hash(&self) -> [u8; 32] {
        let mut bytes = Bytes::default();
        bytes.u64(&[self.position.len() as u64]);
        for (p, n) in self.position.iter().zip(&self.normal) {
            bytes.f32(&p.to_array());
            bytes.f32(&n.to_array());
        }
        bytes.0.push(u8::from(self.color.is_some()));
        self.color.iter().flatten().for_each(|c| bytes.f32(&c.to_array()));
        bytes.u64(&[self.corners.len() as u64]);
        self.corners.iter().for_each(|c| bytes.u32(c));
        if let Some(all) = &self.opacity {
            bytes.0.push(1);
            bytes.f32(all);
        }
        for one in &self.properties {
            bytes.0.push(2);
            bytes.name(&one.name);
            bytes.f32(&one.values);
        }
        bytes.hash()
    }

    /// What its vertices have.
    pub(crate) fn kind(&self) -> u32 {
        let has = [self.color.is_some(), self.opacity.is_some()].map(u32::from);
        has[0] + 2 * has[1] + 4 * self.properties.len() as u32
    }

    /// Dropped, degenerate and duplicate triangles, and edges of more than two.
    pub(crate) fn flaws(&self) -> [u64; 4] {
        let place = |v: u32| self.position[v as usize].to_array().map(|c| (c + 0.0).to_bits());
        let [mut degenerate, mut duplicate] = [0; 2];
        let mut before = Vec::new();
        let mut edges: BTreeMap<_, u64> = BTreeMap::new();
        for corners in &self.corners {
            let mut places = corners.map(place);
            let [a, b, c] = corners.map(|v| wide(self.position[v as usize]));
            let area = cross(sub(b, a), sub(c, a));
            let meet = places[0] == places[1] || places[1] == places[2] || places[2] == places[0];
            let flat = meet || area == [0.0; 3];
            degenerate += u64::from(flat);
            if !flat {
                for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                    let (a, b) = (places[i].min(places[j]), places[i].max(places[j]));
                    *edges.entry((a, b)).or_default() += 1;
                }
            }
            places.sort_unstable();
            before.push(places);
        }
        before.sort_unstable();
        duplicate += before.windows(2).filter(|pair| pair[0] == pair[1]).count() as u64;
        let many = edges.values().filter(|count| **count > 2).count() as u64;
        [self.dropped, degenerate, duplicate, many]
    }

    /// The vertices of the own triangles of a node, ascending.
    pub(crate) fn vertices(&self, node: &Node) -> Vec<u32> {
        let own = node.own.iter().flat_map(|&t| self.corners[t as usize]);
        let mut all: Vec<u32> = own.collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// The bytes of its file, and where the own triangles of each node begin.
    pub(crate) fn file(&self) -> (Vec<u8>, Vec<u64>) {
        let mut bytes = Bytes::begin("splatref mesh 2\n");
        bytes.0.extend(self.hash());
        bytes.u32(&[self.tree.len() as u32, self.kind()]);
        bytes.u64(&self.flaws());
        for (number, node) in self.tree.iter().enumerate() {
            let own = self.vertices(node).len() as u32;
            bytes.u32(&[node.parent]);
            bytes.u32(&children(&self.tree, number));
            bytes.u32(&[node.own.len() as u32, own, 0]);
            bytes.f32(&node.low);
            bytes.f32(&node.high);
            bytes.u64(&[node.weight]);
        }
        bytes.seal(0);
        let mut begin = Vec::new();
        for node in &self.tree {
            begin.push(bytes.0.len() as u64);
            let vertices = self.vertices(node);
            for &v in &vertices {
                bytes.f32(&self.position[v as usize].to_array());
                bytes.f32(&self.normal[v as usize].to_array());
                if let Some(colors) = &self.color {
                    bytes.f32(&colors[v as usize].to_array());
                }
                self.opacity.iter().for_each(|all| bytes.f32(&[all[v as usize]]));
                self.properties.iter().for_each(|one| bytes.f32(&[one.values[v as usize]]));
            }
            for &t in &node.own {
                let at = |v| vertices.iter().position(|own| *own == v).expect("a vertex") as u32;
                bytes.u32(&self.corners[t as usize].map(at));
            }
            bytes.seal(begin[begin.len() - 1] as usize);
        }
        (bytes.0, begin)
    }
}

/// First child and how many: a node without children has an empty range where they would be.
pub(crate) fn children(tree: &[Node], number: usize) -> [u32; 2] {
    let before: usize = tree[..number].iter().map(|node| node.children.len()).sum();
    [1 + before as u32, tree[number].children.len() as u32]
}

/// A number in one tree as one in all.
pub(crate) fn shifted(number: u32, by: u32) -> u32 {
    if number == NO_NODE { number } else { number + by }
}
