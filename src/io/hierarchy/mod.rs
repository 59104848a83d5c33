//! Approximate a large scene by a hierarchy of surfels in a folder, and load only what a view needs
//! \[BJFM19, 3.4\].
//!
//! [`SceneFile::approximate`](crate::io::scene_file::SceneFile::approximate) makes the folder; run it again to resume after an interruption. [`Hierarchy`] reads
//! the folder. It reads the index at once, and surfels and triangles one node at a time. For a view
//! it reads only the nodes that the view [draws](Hierarchy::needed_by).
//! [`crate::source::hierarchy`] defines the approximation.
//!
//! # How nodes form trees
//!
//! A scene has geometries, and objects that show them. Each geometry has a tree of *nodes* over its
//! triangles ([`mod@crate::source::hierarchy::octree`], bound [`BOUND`]). The tree is in the
//! geometry's own coordinates, however many objects show it.
//!
//! Above these trees lies one more tree of the same kind, over the objects, in world coordinates.
//! Its items are the objects that do not move, with the boxes around them. An object weighs as much
//! as the triangles of its geometry. To get the box of an object, take the box of its geometry and
//! place its eight corners, in f64. The object's box is the box around these eight points, its
//! corners rounded to `f32` and moved one `f32` outwards. Moving objects are in no node: they
//! "should \[be generated\] seperately from the static scene parts".
//!
//! Nodes are numbered from 0: first the nodes over the objects, then the nodes of geometry 0, of
//! geometry 1, ... A node over objects with only one object here and below has no surfels, because
//! the object's geometry has them.
//!
//! # Files in the folder
//!
//! Numbers are little-endian, without gaps. An absent index is `0xFFFF_FFFF`. Hashes are SHA-256.
//! A *checksum* is the CRC-32 of PNG and gzip, as `zlib.crc32` gives it, in a u32. It covers all
//! bytes from the beginning of the file, or from the checksum before it. A reader checks what it
//! reads, and refuses a file with a wrong checksum.
//!
//! | file | contents | |
//! |---|---|---|
//! | `plan` | `"splatref hierarchy 1\n"`, 64 hexadecimal digits, `"\n"` | written first: the hash of the settings and the scene |
//! | `mesh-N` | the tree and the triangles of geometry N, a decimal number | |
//! | `surfels-N` | the surfels of node N, if it is approximated | |
//! | `bounds` | the bounds of each node's surfels and triangles | written before the index; optional |
//! | `index` | all nodes, objects and geometries | written last: the hierarchy is complete |
//!
//! **mesh-N**
//!
//! ```text
//!   "splatref mesh 2\n"                     16 bytes
//!   hash of the geometry                    32
//!   u32 nodes, u32 kind                     8
//!   u64 dropped, degenerate, duplicate triangles, edges of many           32, see source::hierarchy::Flaws
//!   of each node: u32 parent, first child, children, own triangles, own vertices, 0     24
//!                 f32 low x y z, high x y z                                             24
//!                 u64 triangles here and below                                           8
//!   u32 checksum                            4
//!   of each node: of each own vertex f32 position x y z, normal x y z, then what the kind says:
//!                   colour r g b, opacity, further properties in the order of the index
//!                 of each own triangle u32 of its three vertices, counted from 0 in the node
//!                 u32 checksum of these, 0 if the node has no own triangles
//! ```
//!
//! Nodes are counted from 0 in the geometry. For a node without children, "first child" is the
//! number that its first child would have, see [`mod@crate::source::hierarchy::octree`]. The
//! colours are linear. The kind is 1 if vertices have colours, plus 2 if they have opacities, plus
//! 4 times the number of further properties.
//!
//! **surfels-N**
//!
//! ```text
//!   "splatref blue 2\n"                     16 bytes
//!   hash of the hierarchy                   32
//!   u32 node, u32 count, u32 p_m, f32 r_m   16, see scene::objects::detail::prefix::Estimate
//!   u32 checksum                            4
//!   count times, in the order:              20, the bytes of a surfel in the paper's Table 1, without further properties
//!     f32 position x y z                    12
//!     i16 u, v: the normal                  4
//!     u8 red, green, blue, opacity          4, sRGB
//!     f32 of each further property          4 each, in the order of the index
//!   after every 1,024 surfels, and after the last one: u32 checksum   4
//! ```
//!
//! These formulas encode a unit normal to two codes, and decode the codes to a normal. They are in
//! f64, and sign is 1 for 0:
//!
//! ```text
//!   s = (|x| + |y|) + |z|      a = x / s      b = y / s
//!   if z < 0:                  (a, b) = ((1 - |b|) sign a, (1 - |a|) sign b)
//!   u = floor(32767 a + 1/2)   v = floor(32767 b + 1/2)
//!
//!   a = u / 32767   b = v / 32767   z = (1 - |a|) - |b|      t = -z if z < 0, else 0
//!   x = a - t sign a                y = b - t sign b
//!   (x, y, z) divided by sqrt((x x + y y) + z z), each rounded to f32 once, plus 0
//! ```
//!
//! A node that no pixel sees has a file too, so that a later run does not look again. Its count,
//! `p_m` and `r_m` are 0.
//!
//! A normal is at most 1e-4 off. Colours are clamped to \[0, 1\], encoded by [`crate::number::srgb`],
//! and rounded as floor(255 c + 1/2). An opacity o is floor(255 o + 1/2). If any geometry of the
//! hierarchy has opacities, a surfel's opacity is code / 255, rounded to f32 once; otherwise the
//! code is 255, and surfels have no opacity. Vertices without a colour have the colour of the
//! scene's material. The estimate is computed from the surfels as they are in the file.
//!
//! `Decided:` Table 1 has 20 bytes a surfel (494.79 MB for 24.74 M) and does not say which.
//! `Decided:` light above 1 is cut, as it is in the paper's bytes.
//!
//! **index**
//!
//! ```text
//!   "splatref tree 2\n"                     16 bytes
//!   hash of the hierarchy                   32
//!   u32 nodes, of these over objects, objects, geometries                 16
//!   f32 r g b: the colour of what has none, u32 further properties        16
//!   of each node: u32 parent, first child, children, geometry             16
//!                 f32 low x y z, high x y z                               24
//!                 u64 triangles here and below; over objects, as often as they are shown 8
//!                 u32 own triangles, own vertices, u64 where they begin in the mesh's file     16
//!                 u32 first object, objects, surfels, p_m, f32 r_m, u32 0                      24
//!   of each object: u32 number in the scene, geometry, node, 1 if it has a colour + 2 if it moves      16
//!                 f32 r g b of its colour or 0, f32 0                                                  16
//!                 f64 rotation by columns, scale, translation x y z, in frame 0                       104
//!   of each geometry: u32 first node, nodes, kind, 0                      16
//!                 hash, then the flaws, as in its file                    64
//!   of each further property: u32 bytes of its name, the name in UTF-8
//!   u32 checksum                            4
//! ```
//!
//! Here nodes are counted over all trees; so are first children, for nodes without children too.
//! Where a node's own triangles begin is counted in bytes from the beginning of the file, even if
//! the node has none. Fields that do not apply are 0:
//!
//! - for a node over objects: triangles, vertices and where they begin;
//! - for a node of a geometry: the first object and the objects;
//! - for a node without surfels: their number, `p_m` and `r_m`.
//!
//! Objects are in the order of their nodes, and within a node as in the scene; moving objects come
//! last.
//!
//! **bounds**
//!
//! ```text
//!   "splatref ball 2\n"                     16 bytes
//!   hash of the hierarchy                   32
//!   u32 nodes, 0                            8
//!   of each node: f32 low x y z, high x y z 24
//!                 f64 radius                8
//!   u32 checksum                            4
//! ```
//!
//! The box is [`Scene::bounds`](crate::scene::Scene::bounds) of the node's surfels, as they are in
//! the file, and its own triangles, without what is below. The radius is
//! [`Scene::bounding_sphere`](crate::scene::Scene::bounding_sphere) of both. Here surfels have the
//! radius `r_m` sqrt(`p_m` / n), with which all surfels of a node cover. A node that has neither
//! has 0. No number is -0.
//!
//! `Decided:` the bounds are in a file of their own, so that the index did not have to change.
//! Where the file is missing, as in folders of earlier versions, the same numbers are computed from
//! all other files.
//!
//! `Decided:` a folder of an older version, without checksums, is refused: its files begin with the
//! same words and a 1, and nobody can tell whether they are damaged. Remove the folder and rerun
//! `splatref surfels`.
//!
//! `Decided:` checksums are CRC-32, because they are there to find damage. On a machine where
//! CRC-32 takes 55 GB a second, SHA-256 takes 0.35, and decoding normals alone takes 0.7: checksums
//! by SHA-256 would triple the time that loading takes, and these add about 1 %.
//!
//! # What each hash covers
//!
//! - `plan`, in this order:
//!   - `"splatref hierarchy 1\n"`;
//!   - the settings: u32 most, side; u8 sampler: 0 greedy, 1 the paper's, 2 as shipped, 3 random;
//!     u8 0 top-down, 2 bottom-up; u64 seed; u32 directions: 0 cube, 1 box, else 2 + their number
//!     and f64 x y z of each;
//!   - the f32 colour of triangles without one; u64 geometries;
//!   - u64 objects, and of each: u64 geometry; u64 keys, of each key u32 frame and f64 rotation by
//!     columns, scale, translation; u8 1 and f32 r g b of its colour, or u8 0;
//!   - of each further property u32 bytes of its name, the name.
//! - a geometry, in this order:
//!   - u64 vertices, of each f32 position and normal; u8 1 and f32 colours of all, or u8 0;
//!   - u64 triangles, of each u32 x 3;
//!   - if there are opacities u8 1 and f32 of each vertex;
//!   - of each further property u8 2, u32 bytes of its name, the name, f32 of each vertex.
//! - the hierarchy: the hash of `plan`, then the hashes of the geometries.
//!
//! # Resume after an interruption
//!
//! Each file appears in the folder only when it is complete. A new run keeps every `mesh-N` and
//! `surfels-N` that has the right hash, length and checksums, and makes the others again. A run with other settings, or with a changed
//! geometry, is refused. Every file is a function of the scene and the settings, so that two runs
//! at a time write the same bytes. A killed process may leave partial files
//! (`.splatref-*.partial`); nothing reads them, and the next run removes them. It leaves the partial
//! files of a process that still runs.
//!
//! # Memory that building and viewing need
//!
//! While the tree of a geometry is made, the whole geometry is in memory, because the readers of
//! meshes do not read parts of files. Only one geometry is in memory at a time. Afterwards, memory
//! holds the input of one node. Bottom-up, this is the node's own triangles, and a number of
//! surfels that is bounded by its surface at the resolution of its pictures. Top-down, it is all
//! triangles of the node and below.
//!
//! A view needs memory for the index (88 bytes a node), for the objects that show each node in each
//! of its places, and for the parts of files that [it draws](Hierarchy::needed_by).
//!
//! # Opacities and further properties
//!
//! Vertices of meshes have the opacities of their files, or of their model. They also have the
//! further properties that the [settings](crate::source::hierarchy::Settings::properties) name.
//! [Candidates](mod@crate::source::candidates) take these values from the vertices around them, and
//! so do surfels, even those made from surfels below. A triangle is dropped if the opacity of a
//! corner is not in [0, 1], or if a property is not finite.
//!
//! `Decided:` every method that draws triangles and discs draws them opaque, as the paper's are: a
//! picture of a folder does not depend on its opacities. The opacities are for programs that draw
//! [`Hierarchy::surfels`] and [`Hierarchy::triangles`] in another way.
//!
//! `Decided:` a geometry whose vertices all have the opacity 1 has no opacities, so that four
//! channels of colour in a mesh cost nothing. In a hierarchy with opacities, vertices without one
//! have 1.
//!
//! `Decided:` if a mesh lacks a property that the settings name, the hierarchy is refused, and the
//! error names the file: no number can stand for a roughness that nobody measured.

mod bounds;
mod build;
pub(in crate::io) mod bytes;
mod gather;
mod index;
mod kind;
mod layout;
mod mesh;
mod plan;
mod read;
mod scene;
mod surfels;
#[cfg(test)]
mod tests;
mod view;

pub use crate::source::hierarchy::BOUND;
pub use build::Built;
pub(in crate::io) use build::{Geometries, build};
pub use index::{Geometry, NONE, Node, Object};
pub use kind::Kind;
pub use read::Hierarchy;
