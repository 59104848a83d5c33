//! Oracle for the levels of detail of \[BJFM19\], written from their pages alone and exact to the
//! last bit:
//!
//! - how densely an order covers a surface
//! - which prefixes and finer objects a view draws
//! - the folder of a hierarchy, byte by byte

mod estimates;
mod folder;
mod forest;
mod loaded;
mod mesh;
mod numbers;
mod octree;
mod pictures;
mod stages;
mod ties;
mod view;
mod whole;
