//! Grow a tree of triangles, and convert leaves to ribbons and branches to tubes.
//!
//! \[MKC08, section 4.3\] converts a published model of an apple tree, 200,496 triangles of leaves
//! and 351,184 of bark, to ribbons and tubes. [`apple_tree`] grows a tree of the same structure
//! and, by default, the same size. [`ribbons`] and [`tubes`] convert any mesh of that structure.
//!
//! | count | \[MKC08\] | here |
//! |---|---|---|
//! | leaves, of 4 triangles | 50,124 | 50,124 |
//! | triangles of the bark | 351,184 | 353,088 |
//! | triangles of the trunk, kept | 227 | 240 |
//! | segments of ribbons | 150,372 | 150,372 |
//! | segments of tubes | 63,887 | 58,848 |
//! | vertices of tubes | 69,604 | 65,051 |
//!
//! ```
//! let tree = splatref::source::plant::apple_tree(500, 0)?;
//! let lines = tree.lines()?;
//! assert_eq!(lines.ribbons.len(), 3 * 500);
//! assert_eq!(lines.triangles.len(), tree.trunk.len(), "all the rest has become lines");
//! # Ok::<(), splatref::Error>(())
//! ```

mod grow;
mod mesh;
mod parts;
mod ribbons;
#[cfg(test)]
mod tests;
mod tubes;

use crate::error::{Error, Result};
use crate::number::MapInline;
use crate::scene::{Polylines, Primitives, Triangles, Vertices};
use glam::{DVec3, Vec3};
pub use ribbons::ribbons;
pub use tubes::tubes;

/// The number of leaves of the tree in \[MKC08\], and the default.
pub const LEAVES: usize = 50_124;
/// The largest number of leaves that you can ask for: 2^20.
pub const MAX_LEAVES: usize = 1 << 20;

/// Triangles that are not converted to lines, as corners in the vertices of their mesh.
pub type Rest = Vec<[u32; 3]>;

/// A tree of triangles; radii are 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plant {
    /// Leaves of four triangles over six vertices, with the normals of the upper side.
    pub leaves: Triangles,
    /// Branches: rows of rings of three vertices, with radial normals.
    pub bark: Triangles,
    /// The trunk, which is too thick for a tube.
    pub trunk: Triangles,
}

/// An apple tree about 3 world units high, +y up, its foot around the origin in the plane y = 0.
///
/// It has exactly `leaves` leaves. Each branch divides its leaves among its own branches, by the
/// squares of their lengths. A branch with at most sixteen leaves is a twig, and bears them itself,
/// one on each segment. The radius of a branch grows with the number of its leaves to the power
/// 0.45, and tapers to the radius of its last branch, which continues it. Every branch starts on
/// the axis of its parent, with a ring of its own. A tree with fewer leaves has fewer orders of
/// branches, and larger leaves.
///
/// The seed decides everything else; a tree is a function of the two arguments, bit for bit.
///
/// # Errors
/// [`Error::Invalid`] if `leaves` is 0 or more than [`MAX_LEAVES`].
pub fn apple_tree(leaves: usize, seed: u64) -> Result<Plant> {
    if leaves == 0 || leaves > MAX_LEAVES {
        return Err(Error::Invalid(format!("a tree of {leaves} leaves; give 1 to {MAX_LEAVES}")));
    }
    grow::grow(leaves, seed)
}

impl Plant {
    /// The leaves as ribbons and the bark as tubes. The trunk stays triangles, and so do triangles
    /// that are neither leaf nor branch, in the order trunk, leaves, bark.
    ///
    /// # Errors
    /// The errors of [`ribbons`] and [`tubes`]; [`Error::Invalid`] if ids of 32 bits do not
    /// suffice.
    pub fn lines(&self) -> Result<Primitives> {
        let (ribbons, leaves) = ribbons(&self.leaves)?;
        let (tubes, bark) = tubes(&self.bark)?;
        let triangles = joined([
            (&self.trunk, self.trunk.corners()),
            (&self.leaves, &leaves),
            (&self.bark, &bark),
        ])?;
        Ok(Primitives { triangles, ribbons, tubes })
    }

    /// Everything as triangles, in the order trunk, leaves, bark.
    ///
    /// # Errors
    /// [`Error::Invalid`] if ids of 32 bits do not suffice.
    pub fn polygons(&self) -> Result<Primitives> {
        let triangles = joined(
            [&self.trunk, &self.leaves, &self.bark].map_inline(|mesh| (mesh, mesh.corners())),
        )?;
        Ok(Primitives { triangles, ..Primitives::default() })
    }
}

/// Joins some triangles of several meshes into one mesh, with the vertices that they use in their
/// order. If only some meshes have colours, the others are white.
fn joined(meshes: [(&Triangles, &[[u32; 3]]); 3]) -> Result<Triangles> {
    let used = || meshes.iter().filter(|(_, corners)| !corners.is_empty());
    let mut color = used().any(|(mesh, _)| mesh.vertices().color.is_some()).then(Vec::new);
    let mut to = Vertices::default();
    let mut all = Vec::new();
    for (mesh, corners) in used() {
        let from = mesh.vertices();
        let mut number = vec![None; from.position.len()];
        for &corner in corners.as_flattened() {
            number[corner as usize] = Some(0);
        }
        for (i, number) in number.iter_mut().enumerate() {
            let Some(number) = number else { continue };
            *number = to.position.len();
            to.position.push(from.position[i]);
            to.direction.push(from.direction[i]);
            to.radius.push(from.radius[i]);
            if let Some(color) = &mut color {
                color.push(from.color.as_ref().map_or(Vec3::ONE, |from| from[i]));
            }
        }
        // An id that does not fit means too many vertices, which are refused below.
        let new = |corner: u32| number[corner as usize].unwrap_or_default() as u32;
        all.extend(corners.iter().map(|corners| corners.map_inline(new)));
    }
    Triangles::new(Vertices { color, ..to }, all).map(|(triangles, _)| triangles)
}

/// The mean, in f64 and rounded once.
fn mean(values: impl ExactSizeIterator<Item = Vec3>) -> Vec3 {
    let count = values.len() as f64;
    (values.map(Vec3::as_dvec3).sum::<DVec3>() / count).as_vec3()
}

/// The vector divided by its length, unless that is less than 2^-80.
fn unit(v: DVec3) -> Option<DVec3> {
    let length = v.length();
    (length >= 1.0 / 1_208_925_819_614_629_174_706_176.0).then(|| v / length)
}

/// Checks lines whose vertices are all valid, unless a radius is too large.
fn lines(vertices: Vertices, segments: Vec<[u32; 2]>) -> Result<Polylines> {
    match Polylines::new(vertices, segments)? {
        (lines, 0) => Ok(lines),
        (_, n) => Err(Error::Invalid(format!(
            "{n} segments are too wide for 32-bit floats; make the tree smaller"
        ))),
    }
}
