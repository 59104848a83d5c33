//! The kit of the benchmarks.
//!
//! - [`block`]: marked blocks of the pages under `docs/`.
//! - [`chart`]: a chart as an SVG.
//! - [`mesh`]: a mesh as it is.
//! - [`models`]: scans, and denser samplings of their surfaces.
//! - [`order`]: surfels in the order of a space-filling curve.
//! - [`plant`]: meshes of 12 million triangles.
//! - [`report`]: arguments, and tables on stdout and in `docs/`.
//! - [`shot`]: the planes that are measured, drawn or true.
//! - [`sphere`]: random surfels on a sphere, the workloads of speed.

#![allow(dead_code, reason = "each bench takes a part of the kit")]

pub(crate) mod block;
pub(crate) mod chart;
pub(crate) mod mesh;
pub(crate) mod models;
pub(crate) mod order;
pub(crate) mod plant;
pub(crate) mod report;
pub(crate) mod shot;
pub(crate) mod sphere;
