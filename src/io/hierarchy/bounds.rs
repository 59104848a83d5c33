//! The file with the bounds of each node's surfels and triangles, see the [module](super).

use super::bytes::{Hash, Reader, Writer, check_magic, checked};
use super::read::Hierarchy;
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::io::replace::write_atomically;
use crate::io::{Reason, checksum, input};
use crate::progress::Progress;
use crate::scene::bounds::Bounds;
use std::io::Write;

const MAGIC: &[u8; 16] = b"splatref ball 2\n";
const HEADER: u64 = 56;
const OF_A_NODE: u64 = 32;
/// The name of the file.
const FILE: &str = "bounds";

impl Hierarchy {
    /// The bounds of all nodes: from the file, or computed from the nodes, one at a time.
    pub(super) fn bounds(&self, exec: &Exec, progress: Progress<'_>) -> Result<Vec<Bounds>> {
        let path = self.folder.join(FILE);
        if !path.exists() {
            return self.bounds_of_nodes(exec, progress);
        }
        let bytes = input::bytes(&path).map_err(|source| Error::io(&path, source))?;
        let nodes = self.nodes().len();
        parse(&bytes, nodes, &self.index.hash).map_err(|what| Error::format(&path, what))
    }

    /// Writes the bounds of all nodes.
    pub(super) fn write_bounds(&self, exec: &Exec, progress: Progress<'_>) -> Result<()> {
        let mut to = Writer::default();
        to.bytes(MAGIC);
        to.bytes(&self.index.hash);
        to.words(&[self.nodes().len() as u32, 0]);
        for Bounds { low, high, radius } in self.bounds_of_nodes(exec, progress)? {
            to.vector(low);
            to.vector(high);
            to.double(radius);
        }
        let bytes = checksum::seal(to.0);
        write_atomically(&self.folder.join(FILE), |file| file.write_all(&bytes))
    }

    fn bounds_of_nodes(&self, exec: &Exec, progress: Progress<'_>) -> Result<Vec<Bounds>> {
        let nodes = self.nodes();
        let each = (0..nodes.len() as u32).map(|number| {
            progress("bounds", u64::from(number), nodes.len() as u64);
            self.read_all(number, exec)
                .map(|(surfels, primitives)| Bounds::around(&surfels, &primitives))
        });
        each.collect()
    }
}

fn parse(bytes: &[u8], nodes: usize, hash: &Hash) -> Reason<Vec<Bounds>> {
    check_magic(bytes, MAGIC, "the bounds")?;
    let bytes = checked(bytes)?;
    let mut rest = Reader(bytes);
    rest.take::<16>()?;
    if &rest.take::<32>()? != hash {
        return Err("the bounds belong to another hierarchy than the index".into());
    }
    let [count, _] = rest.words()?;
    let length = HEADER + nodes as u64 * OF_A_NODE;
    if count as usize != nodes || bytes.len() as u64 != length {
        let found = bytes.len();
        return Err(format!(
            "bounds of {count} nodes in {found} bytes, but the index has {nodes}, which take {length}"
        ));
    }
    let one = |number: usize| {
        let (low, high) = (rest.vector()?, rest.vector()?);
        let radius = rest.scale()?;
        let boxed = low.is_finite() && high.is_finite() && low.cmple(high).all();
        if !(boxed && (0.0..f64::INFINITY).contains(&radius)) {
            return Err(format!("the bounds of node {number} are invalid"));
        }
        Ok(Bounds { low, high, radius })
    };
    (0..nodes).map(one).collect()
}
