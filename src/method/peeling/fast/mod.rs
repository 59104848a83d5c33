//! Draw in `f32`, fast: the bits of the definition, from another layout, see [`crate::method`].
//!
//! Block after block is finished. The fragments of a block's splats are computed once, with their
//! weights, and then layer after layer is taken from them. A fragment that is in a layer is struck
//! out, and a splat without fragments left is dropped. So a layer costs only the fragments at it
//! and beyond it. Splats stay in ascending order, and so do the sums. A layer is blended at once, so
//! both stages have one lap.

mod fragments;
mod layers;

use super::{Settings, planes};
use crate::frame::{Pool, Rect};
use crate::method::Job;
use crate::method::clock::Clock;
use crate::method::fast::layered::{LayeredBlock, LayeredPlanes};
use crate::method::fast::lists::BlockLists;
use crate::method::fast::prepare;
use crate::method::fast::tile::{BlockGrid, Record, Surface};
use crate::method::picture::{Picture, before_environment};
use crate::method::prepare::Prepared;
use crate::scene::Surfels;
use crate::shade::phong::Shader;
use crate::splat::View;
use fragments::Fragments;

/// A picture whose splats are projected and sorted into tiles.
struct FastPeeling<'a> {
    surfels: &'a Surfels,
    prepared: Prepared<f32, Record>,
    shader: Shader<f32>,
    /// The colour of surfels that have none.
    own: Option<[f32; 3]>,
    /// The maximum number of layers of a pixel.
    most: u32,
}

/// The attributes of a splat that are averaged: colour, opacity, normal, and 1, so that one list
/// holds all sums of a pixel.
type Attributes = [f32; 8];

/// Draws the picture.
pub(super) fn draw(job: &Job<'_>, settings: &Settings, pool: &mut Pool) -> Picture<f32> {
    let mut clock = Clock::default();
    let peeling = FastPeeling::project(job, settings);
    clock.lap("projection");
    let (size, grid) = (job.size(), job.strips());
    let mut target = LayeredPlanes::new(size, pool.count(size), pool);
    job.exec.ordered(target.cut(&grid, job.exec), |mut pixels| {
        match peeling.tile(pixels.depth.index, pixels.depth.rect) {
            Some(blocks) => pixels.store(&blocks, |layers| layers as u8),
            None => pixels.clear(0),
        }
    });
    let LayeredPlanes { color, alpha, depth, id, layers } = target;
    let (color, alpha) = before_environment(job, color, alpha);
    let mut left: Vec<_> = planes::shown(color, alpha).into();
    left.extend(planes::pixel_planes(depth, id, layers));
    clock.lap("layers and blending");
    let (frame, timings) = (job.frame(left), clock.into_laps());
    Picture { frame, tally: peeling.prepared.tally, timings, seen: None }
}

impl<'a> FastPeeling<'a> {
    fn project(job: &Job<'a>, settings: &Settings) -> Self {
        let scene = job.scene;
        let colored = scene.surfels.color().is_some();
        Self {
            surfels: &scene.surfels,
            prepared: prepare(job, &settings.splats),
            shader: Shader::new(View::new(job.camera), &scene.lights, scene.material),
            own: (!colored).then(|| scene.material.color.to_array()),
            most: settings.layers,
        }
    }

    /// The layers of the blocks of a tile; none if it has no splats.
    fn tile(&self, tile: usize, rect: Rect) -> Option<Vec<LayeredBlock>> {
        let mut splats = Vec::new();
        self.prepared.gather_f32(tile, &rect, &mut splats);
        if splats.is_empty() {
            return None;
        }
        let (grid, shared) = (BlockGrid::new(rect), &self.prepared.shared);
        let lists = BlockLists::new(&splats, &grid, shared);
        let attributes: Vec<_> = splats.iter().map(|splat| self.attributes(splat)).collect();
        let mut fragments = Fragments::default();
        let mut blocks = vec![LayeredBlock::EMPTY; grid.len()];
        for (block, list) in lists.blocks() {
            let corner = grid.corner(block);
            fragments.collect(&splats, list, corner, shared);
            self.peel(&mut blocks[block], &mut fragments, &attributes, corner);
        }
        Some(blocks)
    }

    fn attributes(&self, splat: &Record) -> Attributes {
        let Surface { normal: [x, y, z], color: [r, g, b] } = splat.attributes;
        let opacity = self.surfels.opacity_of(splat.surfel as usize);
        [r, g, b, opacity, x, y, z, 1.0]
    }
}
