//! All layers in one call: from a scene to named planes.

use super::{Layer, Peeling, Settings};
use crate::error::Result;
use crate::frame::{Frame, Grid, NO_ID, NamedPlane, Samples};
use crate::method::algorithm::Job;
use crate::method::picture::{Clock, Picture, before_environment, named};
use crate::number::Exact;

/// How many layers leave planes.
pub const STAGES: u32 = 8;

/// The definition, in any number; with `stages`, the first [`STAGES`] layers leave their planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let Job { scene, camera, exec, .. } = *job;
    let mut clock = Clock::default();
    let peeling = Peeling::<R>::project(scene, camera, settings, exec);
    clock.lap("projection");

    let grid = peeling.grid();
    let keep = if stages { settings.layers.min(STAGES) as usize } else { 0 };
    let tiles = grid.rects().into_iter().enumerate().collect();
    let peel = |(index, rect)| peeling.tile(index, rect, settings.layers, keep);
    let (pixels, layers): (Vec<_>, Vec<_>) = exec.ordered(tiles, peel).into_iter().unzip();
    clock.lap("layers");

    let mut planes = layer_planes(grid, &layers, keep);
    let color = grid.assemble([R::ZERO; 3], |t, i| pixels[t][i].blend.color);
    let alpha = grid.assemble(R::ZERO, |t, i| pixels[t][i].blend.alpha.at_most(R::ONE));
    let (color, alpha) = before_environment(scene, camera, color, alpha, exec);
    planes.push(named("", Samples::Color(color)));
    planes.push(named("A", Samples::Scalar(alpha)));
    let depth = grid.assemble(R::INFINITY, |t, i| pixels[t][i].depth);
    planes.push(named("Z", Samples::Scalar(depth)));
    let id = grid.assemble(NO_ID, |t, i| pixels[t][i].id);
    planes.push(named("id", Samples::Index(id)));
    let count = grid.assemble(0, |t, i| pixels[t][i].layers.min(255) as u8);
    planes.push(named("layers", Samples::Count(count)));
    clock.lap("planes");
    let frame = Frame { width: camera.width, height: camera.height, planes };
    Ok(Picture { frame, tally: peeling.tally(), timings: clock.into_laps() })
}

/// The planes of the first layers: `layers[tile][layer][pixel]`, fewer where a tile has fewer.
fn layer_planes<R: Exact>(
    grid: &Grid,
    layers: &[Vec<Vec<Layer<R>>>],
    count: usize,
) -> Vec<NamedPlane<R>> {
    let mut planes = Vec::new();
    for j in 0..count {
        let at = |tile: usize, pixel: usize| layers[tile].get(j).map(|layer| &layer[pixel]);
        let name = |plane: &str| format!("layer{}{plane}", j + 1);
        let zero = [R::ZERO; 3];
        let color = grid.assemble(zero, |t, i| at(t, i).map_or(zero, |layer| layer.color));
        planes.push(named(&name(""), Samples::Color(color)));
        let alpha = grid.assemble(R::ZERO, |t, i| at(t, i).map_or(R::ZERO, |layer| layer.alpha));
        planes.push(named(&name(".A"), Samples::Scalar(alpha)));
        let depth =
            grid.assemble(R::INFINITY, |t, i| at(t, i).map_or(R::INFINITY, |layer| layer.depth));
        planes.push(named(&name(".Z"), Samples::Scalar(depth)));
        let counts = grid.assemble(0, |t, i| at(t, i).map_or(0, |layer| layer.count));
        planes.push(named(&name(".count"), Samples::Count(counts)));
    }
    planes
}
