//! The file of a geometry: its tree and its triangles, see the [module](super).

use super::bytes::{Hash, Reader, Writer, check_magic, checked};
use super::index::{self, NONE, Node};
use super::kind::Kind;
use crate::error::{Error, Result};
use crate::io::replace::write_atomically;
use crate::io::{Reason, checksum, input};
use crate::memory;
use crate::scene::objects::detail::prefix::Estimate;
use crate::scene::{Property, Triangles};
use crate::source::hierarchy::parts::tree;
use crate::source::hierarchy::{BOUND, Flaws, Numbers, Part};
use sha2::{Digest, Sha256};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

const MAGIC: &[u8; 16] = b"splatref mesh 2\n";
const HEADER: u64 = 88;
const OF_A_NODE: u64 = 56;
const CHECKSUM: u64 = checksum::BYTES as u64;
/// Bytes in the file: a triangle.
const TRIANGLE: u64 = 12;
/// How many times the bytes of the file a loaded block may take in memory.
const IN_MEMORY: u64 = 2;

/// The contents of a geometry's file, without its triangles.
pub(super) struct Header {
    pub(super) hash: Hash,
    pub(super) kind: Kind,
    pub(super) flaws: Flaws,
    /// Nodes by their numbers in the geometry; without surfels.
    pub(super) nodes: Vec<Node>,
}

/// The path of a geometry's file.
pub(super) fn path(folder: &Path, geometry: u32) -> PathBuf {
    folder.join(format!("mesh-{geometry}"))
}

/// The hash of a geometry.
pub(super) fn hash(triangles: &Triangles) -> Hash {
    let mut hash = Sha256::new();
    let vertices = triangles.vertices();
    let mut update = |write: &dyn Fn(&mut Writer)| {
        let mut to = Writer::default();
        write(&mut to);
        hash.update(&to.0);
    };
    update(&|to| to.long(vertices.position.len() as u64));
    for (p, n) in vertices.position.iter().zip(&vertices.direction) {
        update(&|to| {
            to.vector(*p);
            to.vector(*n);
        });
    }
    update(&|to| to.bytes(&[u8::from(vertices.color.is_some())]));
    for color in vertices.color.iter().flatten() {
        update(&|to| to.vector(*color));
    }
    update(&|to| to.long(triangles.len() as u64));
    for corners in triangles.corners() {
        update(&|to| to.words(corners));
    }
    if let Some(opacity) = &vertices.opacity {
        update(&|to| to.bytes(&[1]));
        opacity.iter().for_each(|&one| update(&|to| to.float(one)));
    }
    for Property { name, values } in &vertices.properties {
        update(&|to| {
            to.bytes(&[2]);
            to.text(name);
        });
        values.iter().for_each(|&one| update(&|to| to.float(one)));
    }
    hash.finalize().into()
}

/// Makes the tree of a geometry, and writes tree and triangles.
pub(super) fn write(
    folder: &Path,
    geometry: u32,
    hash: &Hash,
    triangles: &Triangles,
    dropped: u64,
) -> Result<()> {
    let tree = tree(triangles, BOUND)?;
    let flaws = Flaws::find(triangles, dropped);
    let mut header = Writer::default();
    header.bytes(MAGIC);
    header.bytes(hash);
    header.words(&[tree.nodes.len() as u32, Kind::from_vertices(triangles.vertices()).word()]);
    index::flaws(&mut header, flaws);
    for (number, node) in (0..).zip(&tree.nodes) {
        let own = tree.own(number);
        let vertices = Part::vertices_of(triangles, own).len() as u32;
        let (start, children) = (node.children.start, node.children.len() as u32);
        header.words(&[node.parent, start, children, own.len() as u32, vertices, 0]);
        header.vector(node.low);
        header.vector(node.high);
        header.long(node.weight);
    }
    write_atomically(&path(folder, geometry), |to| {
        to.write_all(&checksum::seal(header.0))?;
        for number in 0..tree.nodes.len() as u32 {
            let block = block(&Part::from_triangles(triangles, tree.own(number)));
            to.write_all(&checksum::seal(block))?;
        }
        Ok(())
    })
}

/// The bytes of the triangles of a node.
fn block(part: &Part) -> Vec<u8> {
    let mut to = Writer::default();
    for (i, p) in part.position.iter().enumerate() {
        to.vector(*p);
        to.vector(part.normal[i]);
        if let Some(color) = &part.color {
            to.vector(color[i]);
        }
        part.opacity.iter().for_each(|opacity| to.float(opacity[i]));
        part.properties.iter().for_each(|one| to.float(one.values[i]));
    }
    part.triangles.iter().for_each(|corners| to.words(corners));
    to.0
}

/// The bytes of a node's triangles, without their checksum.
fn size(node: &Node, kind: Kind) -> u64 {
    let vertices = u64::from(node.vertices).saturating_mul(kind.vertex());
    vertices.saturating_add(u64::from(node.triangles) * TRIANGLE)
}

/// Reads the header of a geometry's file, if there is a file, and checks all of the file; its nodes
/// get the number of the geometry.
pub(super) fn read(folder: &Path, geometry: u32) -> Result<Option<Header>> {
    let path = path(folder, geometry);
    if !path.exists() {
        return Ok(None);
    }
    let io = |source| Error::io(&path, source);
    let format = |what| Error::format(&path, what);
    let (mut file, length) = input::open(&path).map_err(io)?;
    let mut start = vec![0; length.min(HEADER) as usize];
    file.read_exact(&mut start).map_err(io)?;
    let (mut header, nodes) = beginning(&start).map_err(format)?;
    let records = u64::from(nodes) * OF_A_NODE + CHECKSUM;
    if records > length - HEADER {
        let what = format!("{nodes} nodes need more bytes than the {length} of the file");
        return Err(format(what));
    }
    start.extend(input::rest(&file, records).map_err(io)?);
    let records = checked(&start).map_err(format)?.get(HEADER as usize..).unwrap_or_default();
    header.nodes = records_of(records, nodes, geometry, header.kind, length).map_err(format)?;
    for node in &header.nodes {
        let bytes = size(node, header.kind) + CHECKSUM;
        checked(&input::rest(&file, bytes).map_err(io)?).map_err(format)?;
    }
    Ok(Some(header))
}

fn beginning(start: &[u8]) -> Reason<(Header, u32)> {
    check_magic(start, MAGIC, "a geometry")?;
    let mut rest = Reader(start);
    rest.take::<16>()?;
    let hash = rest.take()?;
    let [nodes, kind] = rest.words()?;
    let flaws = index::read_flaws(&mut rest)?;
    Ok((Header { hash, kind: Kind::of_word(kind), flaws, nodes: Vec::new() }, nodes))
}

fn records_of(
    bytes: &[u8],
    nodes: u32,
    geometry: u32,
    kind: Kind,
    length: u64,
) -> Reason<Vec<Node>> {
    let mut rest = Reader(bytes);
    let mut offset = HEADER + bytes.len() as u64 + CHECKSUM;
    let mut all = Vec::with_capacity(nodes as usize);
    for _ in 0..nodes {
        let [parent, first, children, triangles, vertices, _] = rest.words()?;
        let (low, high, below) = (rest.vector()?, rest.vector()?, rest.long()?);
        let node = Node {
            parent,
            children: index::range(first, children)?,
            geometry,
            low,
            high,
            below,
            triangles,
            vertices,
            offset,
            objects: 0..0,
            surfels: 0,
            estimate: Estimate { count: 0, distance: 0.0 },
        };
        offset = offset.saturating_add(size(&node, kind)).saturating_add(CHECKSUM);
        all.push(node);
    }
    if offset != length {
        return Err(format!(
            "its triangles end at byte {offset}, but the file ends at byte {length}"
        ));
    }
    Ok(all)
}

/// Reads the triangles of a node, from where the index says they are.
pub(super) fn part(
    folder: &Path,
    hash: &Hash,
    node: &Node,
    kind: Kind,
    numbers: &Numbers,
) -> Result<Part> {
    let part = Part {
        color: kind.colored.then(Vec::new),
        opacity: kind.veiled.then(Vec::new),
        properties: numbers.of_none(),
        ..Part::default()
    };
    if node.triangles == 0 || node.geometry == NONE {
        return Ok(part);
    }
    let path = path(folder, node.geometry);
    let io = |source| Error::io(&path, source);
    let (mut file, length) = input::open(&path).map_err(io)?;
    let mut start = vec![0; length.min(HEADER) as usize];
    file.read_exact(&mut start).map_err(io)?;
    let format = |what: String| Error::format(&path, what);
    let (header, _) = beginning(&start).map_err(format)?;
    // The hash says whether the offsets of the index belong to this file.
    if header.hash != *hash || header.kind != kind {
        return Err(format("the geometry belongs to another index".into()));
    }
    let bytes = size(node, kind).saturating_add(CHECKSUM);
    if node.offset.checked_add(bytes).is_none_or(|end| end > length) {
        return Err(format("the triangles of a node lie beyond the end of the file".into()));
    }
    memory::ask(bytes.saturating_mul(IN_MEMORY), || format!("{} triangles", node.triangles))?;
    file.seek(SeekFrom::Start(node.offset)).map_err(io)?;
    let bytes = input::rest(file, bytes).map_err(io)?;
    checked(&bytes).and_then(|bytes| parse(bytes, node, part)).map_err(format)
}

fn parse(bytes: &[u8], node: &Node, mut part: Part) -> Reason<Part> {
    let mut rest = Reader(bytes);
    for _ in 0..node.vertices {
        part.position.push(rest.vector()?);
        part.normal.push(rest.vector()?);
        if let Some(color) = &mut part.color {
            color.push(rest.vector()?);
        }
        if let Some(opacity) = &mut part.opacity {
            opacity.push(rest.float()?);
        }
        for one in &mut part.properties {
            one.values.push(rest.float()?);
        }
    }
    for _ in 0..node.triangles {
        let corners = rest.words()?;
        if let Some(corner) = corners.iter().find(|corner| **corner >= node.vertices) {
            return Err(format!("vertex {corner} does not exist; the node has {}", node.vertices));
        }
        part.triangles.push(corners);
    }
    Ok(part)
}
