//! Levels of detail of \[BJFM19\], from their pages alone, to the last bit: how densely an order covers,
//! what a view draws of prefixes and finer objects, and the folder of a hierarchy, byte by byte.

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
