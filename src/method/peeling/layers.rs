//! Peel the layers of a tile, one after the other, each by the two passes of
//! [`crate::method::ewa`].

use super::Settings;
use super::blending::under;
use crate::composite::under::Under;
use crate::composite::{decide, sum};
use crate::frame::{NO_ID, Rect};
use crate::method::Job;
use crate::method::buffer_formats::{Buffers, DepthKey};
use crate::method::clock::{Stopwatch, Work, spend};
use crate::method::ewa::attributes::{Sums, sums};
use crate::method::ewa::normalization::resolve;
use crate::method::ewa::visibility::{Foremost, foremost};
use crate::method::fragment::TileSplats;
use crate::method::prepare::Prepared;
use crate::method::tiled::pixels;
use crate::number::{Exact, MapInline, Vector3};
use crate::scene::Surfels;
use crate::shade::phong::Shader;
use crate::splat::{Splat, View};
use std::time::Duration;

/// A picture whose splats are projected and sorted into tiles.
#[derive(Debug)]
pub(super) struct Peeling<'a, R: Exact> {
    pub(super) surfels: &'a Surfels,
    pub(super) splats: Prepared<R, Splat<R>>,
    shader: Shader<R>,
    /// The colour of surfels that have none.
    own: [R; 3],
    /// The formats that store sums, layers, the blend and depths.
    buffers: Buffers,
    key: DepthKey,
}

/// One layer at one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeeledLayer<R> {
    /// `t_j`, the depth of the layer's nearest fragment; +inf where there is none.
    pub depth: R,
    /// The surfel of that fragment; [`NO_ID`] where there is none.
    pub id: u32,
    /// How many fragments were averaged, up to 255.
    pub count: u8,
    /// `a_j`, in [0, 1].
    pub alpha: R,
    /// `C_j`, shaded, not multiplied by `a_j`.
    pub color: [R; 3],
}

/// A pixel and its layers so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PeeledPixel<R> {
    /// The blend of the layers.
    pub(super) blend: Under<R>,
    /// Depth of the first layer; +inf where there is none.
    pub(super) depth: R,
    /// Surfel of the nearest fragment; [`NO_ID`] where there is none.
    pub(super) id: u32,
    /// The count of layers.
    pub(super) layers: u32,
    /// `limit_j`: fragments up to this depth are in the layers, or were skipped.
    pub(super) limit: R,
}

/// The pixels of a tile, row by row.
pub(super) struct PeeledTile<R> {
    pub(super) pixels: Vec<PeeledPixel<R>>,
    /// The first `keep` layers.
    pub(super) kept: Vec<Vec<PeeledLayer<R>>>,
    /// How long the layers and their blending took.
    pub(super) times: [Duration; 2],
}

impl<'a, R: Exact> Peeling<'a, R> {
    /// Projects the splats.
    pub(super) fn project(job: &Job<'a>, settings: &Settings) -> Self {
        let scene = job.scene;
        let shader = Shader::new(View::new(job.camera), &scene.lights, scene.material);
        let own = scene.material.color.to_array().map_inline(R::from_f32);
        let splats = Prepared::splats(job, &settings.splats);
        let Job { buffers, key, .. } = *job;
        Self { surfels: &scene.surfels, splats, shader, own, buffers, key }
    }

    /// Peels at most `most` layers off the pixels of a tile, and keeps the first `keep` of them.
    pub(super) fn tile(&self, tile: usize, rect: Rect, most: u32, keep: usize) -> PeeledTile<R> {
        let splats = TileSplats::new(&self.splats, tile, rect);
        let mut pixels = vec![PeeledPixel::new(); rect.pixels()];
        let (mut kept, mut watch) = (Vec::new(), Stopwatch::start());
        for _ in 0..most {
            let limits: Vec<_> = pixels.iter().map(|pixel| pixel.limit).collect();
            let layer = self.layer(&splats, &limits);
            watch.lap(0);
            let Some(layer) = layer else { break };
            for (pixel, layer) in pixels.iter_mut().zip(&layer) {
                pixel.add(layer, self.splats.epsilon);
                pixel.blend = self.buffers.under(pixel.blend);
            }
            if kept.len() < keep {
                kept.push(layer);
            }
            watch.lap(1);
        }
        // Later stages read a plane for every kept layer, so the missing ones are filled with empty
        // layers.
        kept.resize_with(keep, || vec![PeeledLayer::NONE; rect.pixels()]);
        PeeledTile { pixels, kept, times: watch.times() }
    }

    /// The layer of the fragments strictly beyond the limit of each pixel; none if no pixel has
    /// such a fragment.
    pub(super) fn layer(
        &self,
        splats: &TileSplats<'_, R>,
        limits: &[R],
    ) -> Option<Vec<PeeledLayer<R>>> {
        spend(Work::Peel);
        let shared = splats.shared();
        let beyond = |pixel: usize, w: R| decide::beyond(shared.depth(w), limits[pixel]);
        let mut nearest = foremost(splats, &self.key, beyond);
        nearest.iter_mut().for_each(|nearest| nearest.depth = self.key.stored(nearest.depth));
        if nearest.iter().all(|nearest| nearest.id == NO_ID) {
            return None;
        }
        let sums = sums(splats, self.surfels, self.buffers, &nearest, beyond);
        let found = pixels(splats.rect).zip(nearest.iter().zip(&sums));
        Some(found.map(|(at, (nearest, sums))| self.resolve(nearest, sums, at)).collect())
    }

    /// Normalizes and shades a layer at a column and row.
    pub(super) fn resolve(
        &self,
        nearest: &Foremost<R>,
        sums: &Sums<R>,
        (x, y): (u32, u32),
    ) -> PeeledLayer<R> {
        spend(Work::Shade);
        let average = resolve(nearest, sums);
        let [nx, ny, nz] = average.normal;
        let surface = if self.surfels.color().is_some() { average.color } else { self.own };
        let [alpha, ..] = sum::average([sums.opacity; 3], sums.weight);
        let alpha = self.buffers.sum(alpha);
        let (at, normal) = ((x as usize, y as usize), Vector3::new(nx, ny, nz));
        let color = self.shader.pixel(at, nearest.depth, normal, Vector3::ZERO, surface);
        let color = self.buffers.color(color);
        PeeledLayer { depth: nearest.depth, id: nearest.id, count: sums.count, alpha, color }
    }
}

impl<R: Exact> PeeledLayer<R> {
    /// No fragment is left.
    pub(super) const NONE: Self =
        Self { depth: R::INFINITY, id: NO_ID, count: 0, alpha: R::ZERO, color: [R::ZERO; 3] };
}

impl<R: Exact> PeeledPixel<R> {
    /// No layer yet; every fragment is beyond the limit.
    pub(super) fn new() -> Self {
        let (depth, limit) = (R::INFINITY, -R::INFINITY);
        Self { blend: Under::CLEAR, depth, id: NO_ID, layers: 0, limit }
    }

    /// Blends the next layer under the layers before, if the pixel has one.
    pub(super) fn add(&mut self, layer: &PeeledLayer<R>, epsilon: R) {
        if layer.id == NO_ID {
            return;
        }
        if self.layers == 0 {
            (self.depth, self.id) = (layer.depth, layer.id);
        }
        self.blend = under(self.blend, layer);
        self.layers += 1;
        self.limit = decide::limit(layer.depth, epsilon);
    }
}
