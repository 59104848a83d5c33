//! The folder `golden/nodes`, byte by byte: a tree whose every choice lies beside a limit.

use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// How far what is asked for is from its limit, as a share of it: if `r_m` of all nodes were a little off, some would be
/// drawn with one surfel more or less once the squares of `r_m` are this much off, and none before.
pub(crate) const STEP: f64 = 4e-6;
/// The size in pixels that the golden asks for; a pixel is a unit of the world.
pub(crate) const SIZE: f64 = 4.0;
/// The scale of the object, so that the radius asked for is 1 in its coordinates and 2 in the world.
const SCALE: f64 = 2.0;
/// Cells of 8 x 8 pixels in a row; each surfel has its own, drawn or not.
const COLUMNS: usize = 10;
const PICTURE: [f64; 2] = [80.0, 48.0];
const NONE: u32 = u32::MAX;

/// A node below the root.
#[derive(Clone, Copy)]
pub(crate) struct Node {
    /// What it is for.
    pub(crate) name: &'static str,
    /// On which side of its limit it is: -1 or 1.
    pub(crate) sign: f64,
    /// The node above, by its place in the list; none: the root.
    pub(crate) parent: Option<usize>,
    /// How many surfels it has, and how many are asked for.
    pub(crate) count: u32,
    pub(crate) asked: f64,
    /// Whether it has a triangle.
    pub(crate) triangle: bool,
    /// How many are drawn, by hand.
    pub(crate) drawn: u32,
    /// Where the first surfel's rim is: how far q of a pixel is from 1.
    pub(crate) rim: Option<f64>,
}

/// The nodes by levels.
pub(crate) fn nodes() -> Vec<Node> {
    let mut all = Vec::new();
    let mut below = Vec::new();
    for sign in [-1.0, 1.0] {
        let beside = 1.0 + sign * STEP;
        let more = u32::from(sign > 0.0);
        let mut add = |name, (count, asked), drawn, rim| {
            let (triangle, parent) = (name == "triangle", None);
            all.push(Node { name, sign, parent, count, asked, triangle, drawn, rim });
            Some(all.len() - 1)
        };
        add("a prefix", (5, 3.0 * beside), 3 + more, None);
        let starts = add("the fade begins", (3, 3.0 * beside), 3, None);
        // A quarter of the fade.
        let grows = add("all of it, a finer one grows", (4, 4.3), 4, None);
        // Three quarters: 2 of 4 are drawn.
        let shrinks = add("it shrinks", (4, 4.9 * beside), 3 - more, Some(sign * 1e-5));
        let ends = add("the fade ends", (2, 2.6 * beside), 1 - more, None);
        add("triangle", (3, 3.0 * beside), 3, None);
        add("discs grow", (1, 1.5625), 1, Some(sign * 6e-5));
        let mut finer = |name, parent, (count, asked), drawn, rim| {
            below.push(Node { name, sign, parent, count, asked, triangle: false, drawn, rim });
        };
        finer("finer, there or not", starts, (2, 1.6), more, None);
        // Of the weight 1/2, which is 43/3 times as much off as what is asked of the coarser one.
        let both = 1.0 + sign * (43.0 / 3.0 + 1.0) * STEP;
        finer("finer, growing", grows, (3, 2.0 * both), 1 + more, Some(sign * 1e-5));
        finer("finer, whole", shrinks, (1, 0.8), 1, None);
        finer("finer, alone", ends, (1, 0.8), 1, None);
    }
    all.extend(below);
    all
}

/// `p_m` is all of the surfels, so that `r_m` tells how many are asked for with the radius 1.
fn distance(node: &Node) -> f32 {
    (node.asked / f64::from(node.count)).sqrt() as f32
}

/// Where in its cell, from the centre of the middle pixel on, the first surfel is whose q at a pixel is 1 + off.
fn rim(node: &Node, off: f64) -> [f64; 2] {
    if node.name == "discs grow" {
        // The radius 2.5: the pixel is at (2.4, 0.7) or so.
        [3.0 - (6.25 * (1.0 + off) - 0.49).sqrt(), 0.3]
    } else {
        // The radius 2, or more where more surfels are asked for than there are.
        let least = node.asked / f64::from(node.count);
        let square = 4.0 * if least > 1.0 { least } else { 1.0 };
        [2.0 - (square * (1.0 + off) - 1.44).sqrt(), -0.2]
    }
}

/// Bytes that grow.
#[derive(Default)]
struct Bytes(Vec<u8>);

impl Bytes {
    fn u32(&mut self, all: &[u32]) {
        all.iter().for_each(|v| self.0.extend(v.to_le_bytes()));
    }

    fn f32(&mut self, all: &[f32]) {
        all.iter().for_each(|v| self.0.extend(v.to_le_bytes()));
    }

    /// Appends the CRC-32 of the bytes from `start` on.
    fn seal(&mut self, start: usize) {
        let crc = !self.0[start..].iter().fold(!0, |crc: u32, byte| {
            let step = |crc: u32, _| (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 };
            (0..8).fold(crc ^ u32::from(*byte), step)
        });
        self.u32(&[crc]);
    }

    fn u64(&mut self, all: &[u64]) {
        all.iter().for_each(|v| self.0.extend(v.to_le_bytes()));
    }
}

/// Where the middle pixel of a cell is, in the world.
fn middle(cell: usize) -> [f64; 2] {
    let [column, row] = [cell % COLUMNS, cell / COLUMNS].map(|i| 8.0 * i as f64 + 4.5);
    [column - PICTURE[0] / 2.0, PICTURE[1] / 2.0 - row]
}

/// A place in the coordinates of the geometry.
fn place(cell: usize, [x, y]: [f64; 2]) -> [f32; 3] {
    let [a, b] = middle(cell);
    [((a + x) / SCALE) as f32, ((b + y) / SCALE) as f32, 0.0]
}

const LOW: [f32; 3] = [-20.0, -12.0, 0.0];
const HIGH: [f32; 3] = [20.0, 12.0, 0.0];

/// Number in the tree, the numbers of its children, and how many triangles are there and below.
struct Record {
    parent: u32,
    first: u32,
    children: u32,
    triangles: u32,
    below: u64,
}

/// The records of the geometry's nodes, the root first, as they are numbered in the geometry.
fn records(nodes: &[Node]) -> Vec<Record> {
    let children = |of: Option<usize>| nodes.iter().filter(|node| node.parent == of).count() as u32;
    let all = nodes.iter().filter(|node| node.triangle).count() as u64;
    let own = children(None);
    let mut records =
        vec![Record { parent: NONE, first: 1, children: own, triangles: 0, below: all }];
    let mut first = 1 + own;
    for (i, node) in nodes.iter().enumerate() {
        let (children, triangles) = (children(Some(i)), u32::from(node.triangle));
        let parent = node.parent.map_or(0, |parent| parent as u32 + 1);
        records.push(Record { parent, first, children, triangles, below: triangles.into() });
        first += children;
    }
    records
}

/// The files by their names.
pub(crate) fn files() -> BTreeMap<String, Vec<u8>> {
    let nodes = nodes();
    let records = records(&nodes);
    let [hash, of_mesh] = ["golden/nodes", "golden/nodes/mesh-0"].map(Sha256::digest);
    let mut all = BTreeMap::new();
    let (mut cell, mut cells) = (0, Vec::new());
    for (number, node) in (2..).zip(&nodes) {
        cells.push(cell);
        let mut bytes = Bytes(b"splatref blue 2\n".to_vec());
        bytes.0.extend(hash);
        bytes.u32(&[number, node.count, node.count]);
        bytes.f32(&[distance(node)]);
        bytes.seal(0);
        let start = bytes.0.len();
        for i in 0..node.count {
            let off = node.rim.filter(|_| i == 0).map(|off| rim(node, off));
            bytes.f32(&place(cell, off.unwrap_or([0.25, 0.125])));
            // The normal (0, 0, 1), and any colour.
            bytes.0.extend([0, 0, 0, 0, 255 - 40 * i as u8, (number * 9) as u8, 128, 255]);
            cell += 1;
        }
        bytes.seal(start);
        // The triangle has the cell behind its surfels.
        cell += usize::from(node.triangle);
        all.insert(format!("surfels-{number}"), bytes.0);
    }
    let (mesh, begins) = mesh(&nodes, &records, &cells, &of_mesh);
    all.insert("mesh-0".into(), mesh);
    all.insert("index".into(), index(&nodes, &records, &begins, [&hash, &of_mesh]));
    all
}

fn mesh(nodes: &[Node], records: &[Record], cells: &[usize], hash: &[u8]) -> (Vec<u8>, Vec<u64>) {
    let mut bytes = Bytes(b"splatref mesh 2\n".to_vec());
    bytes.0.extend(hash);
    bytes.u32(&[records.len() as u32, 1]);
    bytes.u64(&[0; 4]);
    for Record { parent, first, children, triangles, below } in records {
        bytes.u32(&[*parent, *first, *children, *triangles, 3 * triangles, 0]);
        bytes.f32(&LOW);
        bytes.f32(&HIGH);
        bytes.u64(&[*below]);
    }
    bytes.seal(0);
    let mut begins = vec![bytes.0.len() as u64];
    // The root has no triangles.
    bytes.u32(&[0]);
    for (node, cell) in nodes.iter().zip(cells) {
        begins.push(bytes.0.len() as u64);
        if node.triangle {
            for at in [[-2.3, -2.3], [2.7, -1.7], [-0.3, 2.6]] {
                bytes.f32(&place(cell + node.count as usize, at));
                bytes.f32(&[0.0, 0.0, 1.0, 0.125, 0.5, 0.875]);
            }
            bytes.u32(&[0, 1, 2]);
        }
        bytes.seal(begins[begins.len() - 1] as usize);
    }
    (bytes.0, begins)
}

fn index(nodes: &[Node], records: &[Record], begins: &[u64], [hash, mesh]: [&[u8]; 2]) -> Vec<u8> {
    let mut bytes = Bytes(b"splatref tree 2\n".to_vec());
    bytes.0.extend(hash);
    bytes.u32(&[1 + records.len() as u32, 1, 1, 1]);
    bytes.f32(&[0.5; 3]);
    bytes.u32(&[0]);
    // The node over the one object.
    bytes.u32(&[NONE, 1, 0, NONE]);
    bytes.f32(&[-40.0, -24.0, 0.0, 40.0, 24.0, 0.0]);
    bytes.u64(&[records[0].below]);
    bytes.u32(&[0, 0]);
    bytes.u64(&[0]);
    bytes.u32(&[0, 1, 0, 0, 0, 0]);
    for (i, record) in records.iter().enumerate() {
        let Record { parent, first, children, triangles, below } = record;
        let parent = if *parent == NONE { NONE } else { parent + 1 };
        bytes.u32(&[parent, first + 1, *children, 0]);
        bytes.f32(&LOW);
        bytes.f32(&HIGH);
        bytes.u64(&[*below]);
        bytes.u32(&[*triangles, 3 * triangles]);
        bytes.u64(&[begins[i]]);
        let node = i.checked_sub(1).map(|i| &nodes[i]);
        let count = node.map_or(0, |node| node.count);
        bytes.u32(&[0, 0, count, count]);
        bytes.f32(&[node.map_or(0.0, distance)]);
        bytes.u32(&[0]);
    }
    bytes.u32(&[0, 0, 0, 0]);
    bytes.f32(&[0.0; 4]);
    for v in [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, SCALE, 0.0, 0.0, 0.0_f64] {
        bytes.0.extend(v.to_le_bytes());
    }
    bytes.u32(&[1, records.len() as u32, 1, 0]);
    bytes.0.extend(mesh);
    bytes.u64(&[0; 4]);
    bytes.seal(0);
    bytes.0
}
