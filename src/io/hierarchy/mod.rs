//! Hierarchies of surfel approximations as folders \[BJFM19, 3.4\].
//!
//! What is in them is defined by [`crate::source::hierarchy`]. [`SceneFile::approximate`](crate::io::scene_file::SceneFile::approximate) makes a folder, and goes on with one that was
//! begun; [`Hierarchy`] reads it: the index at once, surfels and triangles a node at a time, of a view
//! only those of the nodes that it [draws](Hierarchy::needed_by).
//!
//! # The tree
//!
//! A scene has geometries and objects that show them. Each geometry has a tree of *nodes* over its triangles
//! ([`mod@crate::source::hierarchy::octree`], bound [`BOUND`]) in its own coordinates, however many objects show it. A tree of the same
//! kind over the objects, in world coordinates, lies above these trees: its items are the objects that rest, by the boxes
//! around them, and weigh as much as the triangles of their geometries. The box of an object is that around the eight corners
//! of its geometry's box in their places, in f64, its corners rounded to `f32` and one `f32` outwards. Objects that move are in no node: they "should
//! \[be generated\] seperately from the static scene parts".
//!
//! Nodes are numbered from 0: those of the tree over the objects, then those of geometry 0, of geometry 1, ... A node of the
//! first tree with one object here and below has no surfels, because the object's geometry has them.
//!
//! # Files
//!
//! Numbers are little-endian, without gaps. Indices that are none are `0xFFFF_FFFF`. Hashes are SHA-256.
//!
//! | file | | |
//! |---|---|---|
//! | `plan` | `"splatref hierarchy 1\n"`, 64 hexadecimal digits, `"\n"` | written first: the hash of what is computed |
//! | `mesh-N` | the tree and the triangles of geometry N, a decimal number | |
//! | `surfels-N` | the surfels of node N, if it is approximated | |
//! | `bounds` | what bounds the surfels and the triangles of each node | written before the index; not needed |
//! | `index` | all nodes, objects and geometries | written last: the hierarchy is whole |
//!
//! **mesh-N**
//!
//! ```text
//!   "splatref mesh 1\n"                     16 bytes
//!   hash of the geometry                    32
//!   u32 nodes, u32 kind                     8
//!   u64 dropped, degenerate, duplicate triangles, edges of many           32, see source::hierarchy::Flaws
//!   of each node: u32 parent, first child, children, own triangles, own vertices, 0     24
//!                 f32 low x y z, high x y z                                             24
//!                 u64 triangles here and below                                           8
//!   of each node: of each own vertex f32 position x y z, normal x y z, then what the kind says:
//!                   colour r g b, opacity, further properties in the order of the index
//!                 of each own triangle u32 of its three vertices, counted from 0 in the node
//! ```
//!
//! Nodes are counted from 0 in the geometry. A node without children has as its first child the number that it would have, see
//! [`mod@crate::source::hierarchy::octree`]. The colours are linear. The kind is 1 if vertices have colours, plus 2 if they have
//! opacities, plus 4 times the number of further properties.
//!
//! **surfels-N**
//!
//! ```text
//!   "splatref blue 1\n"                     16 bytes
//!   hash of the hierarchy                   32
//!   u32 node, u32 count, u32 p_m, f32 r_m   16, see scene::objects::detail::prefix::Estimate
//!   count times, in the order:              20, the bytes of a surfel in the paper's Table 1, without further properties
//!     f32 position x y z                    12
//!     i16 u, v: the normal                  4
//!     u8 red, green, blue, opacity          4, sRGB
//!     f32 of each further property          4 each, in the order of the index
//! ```
//!
//! The codes of a unit normal, in f64, and the normal of codes, where sign is 1 for 0:
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
//! A node of which no pixel sees anything has a file too, with the count, `p_m` and `r_m` 0, so that nobody looks again.
//!
//! A normal is at most 1e-4 off. Colours are clamped to \[0, 1\], encoded by [`crate::number::srgb`], and rounded as
//! floor(255 c + 1/2). An opacity o is floor(255 o + 1/2), and where a vertex of a geometry has one, code / 255 is that of a surfel, rounded to f32
//! once; else the code is 255, and surfels have none. `Decided:` Table 1 has 20 bytes a surfel (494.79 MB for 24.74 M) and does not say which. `Decided:` light above 1 is cut, as
//! it is in the paper's bytes. What has no colours has that of the scene's material. The estimate is that of the surfels as they are in the file.
//!
//! **index**
//!
//! ```text
//!   "splatref tree 1\n"                     16 bytes
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
//! ```
//!
//! Here nodes are those of all trees, and so are their first children, of nodes without children too. Where the own triangles of a node
//! begin is counted in bytes from the beginning of the file, also if it has none. What a node has none of is 0: of a node over
//! objects triangles, vertices and where they begin; of a node of a geometry the first object and the objects; of a node without surfels their
//! number, `p_m` and `r_m`. Objects are in the order of their nodes, in a node as in the scene, then those that move.
//!
//! **bounds**
//!
//! ```text
//!   "splatref ball 1\n"                     16 bytes
//!   hash of the hierarchy                   32
//!   u32 nodes, 0                            8
//!   of each node: f32 low x y z, high x y z 24
//!                 f64 radius                8
//! ```
//!
//! The box is that of [`Scene::bounds`](crate::scene::Scene::bounds) around the node's surfels, as they are in the file, and its own triangles, not those
//! below; the radius is that of [`Scene::bounding_sphere`](crate::scene::Scene::bounding_sphere) around both, surfels having the radius
//! `r_m` sqrt(`p_m` / n) with which all of a node cover. A node that has neither has 0. No number is -0. `Decided:` a file of its own: the index is what it was, and
//! where the bounds are missing, as in folders of earlier versions, the same numbers are computed from all other files.
//!
//! # Which hash is of what
//!
//! - `plan`: `"splatref hierarchy 1\n"`; the settings (u32 most, side; u8 sampler: 0 greedy, 1 the paper's, 2 as shipped, 3 random; u8 1 if
//!   bottom-up; u64 seed; u32 directions: 0 cube, 1 box, else 2 + their number and f64 x y z of each); the f32 colour of what has none; u64 geometries; u64 objects, of each
//!   u64 geometry, u64 keys, of each key u32 frame and f64 rotation by columns, scale, translation; u8 1 and f32 r g b of its colour, or u8 0; of each further property u32 bytes of its name, the
//!   name.
//! - a geometry: u64 vertices, of each f32 position and normal; u8 1 and f32 colours of all, or u8 0; u64 triangles, of each u32 x 3;
//!   if there are opacities u8 1 and f32 of each vertex; of each further property u8 2, u32 bytes of its name, the name, f32 of each vertex.
//! - the hierarchy: the hash of `plan`, those of the geometries.
//!
//! # Interruption
//!
//! Each file is put in its place when it is whole. A run finds what is there: a `mesh-N` or a `surfels-N` of the right
//! hash and length stays as it is. A run of other settings, or of a geometry that has changed, is refused. Every file is a function
//! of the scene and the settings, so that two runs at a time write the same bytes. Of a process that was
//! killed without a warning partial files may stay (`.splatref-*.partial`); nobody reads them.
//!
//! # Memory
//!
//! A geometry at a time is in memory as a whole, while its tree is made; the readers of meshes do not read parts of files.
//! Afterwards what is in memory is what one node is approximated of: bottom-up a number of surfels that is bounded by its
//! surface at the resolution of its pictures and its own triangles, top-down all its triangles.
//!
//! A view has the index in memory, 88 bytes a node, what shows each node in each of its places, and of the files
//! [what it draws](Hierarchy::needed_by).
//!
//! # Opacities and further properties
//!
//! Vertices of meshes have the opacities of their files, or that of their model, and the further properties that
//! [settings](crate::source::hierarchy::Settings::properties) name. [Candidates](mod@crate::source::candidates) have what the vertices around them have, and so have surfels, those of
//! surfels below too. A triangle with a corner whose opacity is not in [0, 1], or of which a property is not finite, is dropped.
//!
//! `Decided:` every method that draws triangles draws them, and discs, opaque, as the paper's are: what a folder shows does not depend on its
//! opacities. They are for whoever draws [`Hierarchy::surfels`] and [`Hierarchy::triangles`] in another way.
//!
//! `Decided:` a geometry of which every vertex has the opacity 1 has no opacities, so that four channels of colour in a mesh cost
//! nothing. In a hierarchy with opacities vertices without have 1.
//!
//! `Decided:` where a mesh lacks a property that is named the hierarchy is refused, and the line names the file: no number
//! can stand for a roughness that nobody measured.

mod bounds;
mod build;
mod bytes;
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
