//! The layers of a tile, one after the other, over any number.

use super::Settings;
use crate::composite::under::Under;
use crate::composite::{epsilon, sum};
use crate::frame::stencil::{Outcome, Stencil};
use crate::frame::{Exec, Grid, NO_ID, Rect};
use crate::method::ewa::plain::{each_inside, facing};
use crate::method::prepare::Prepared;
use crate::number::{Exact, Vector3};
use crate::scene::{Camera, Scene, Surfels};
use crate::shade::phong::Shader;
use crate::splat::{Splat, Tally, View};

/// A picture whose splats are projected and sorted into tiles.
#[derive(Debug)]
pub struct Peeling<'a, R> {
    surfels: &'a Surfels,
    grid: Grid,
    prepared: Prepared<R, Splat<R>>,
    shader: Shader<R>,
    /// The colour of surfels that have none.
    own: [R; 3],
}

/// One layer at one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer<R> {
    /// `t_j`, the depth of its nearest fragment; +inf where there is none.
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

/// A pixel and the layers it has so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel<R> {
    /// The layers, blended.
    pub blend: Under<R>,
    /// Depth of the first layer; +inf where there is none.
    pub depth: R,
    /// Surfel of the nearest fragment; [`NO_ID`] where there is none.
    pub id: u32,
    /// How many layers.
    pub layers: u32,
    /// `limit_j`: fragments beyond this depth are in none of the layers.
    pub limit: R,
}

/// What a pixel of a layer holds between visibility splatting and normalization.
#[derive(Clone, Copy)]
struct Sums<R> {
    nearest: R,
    id: u32,
    count: u8,
    weight: R,
    normal: [R; 3],
    color: [R; 3],
    opacity: R,
}

impl<'a, R: Exact> Peeling<'a, R> {
    /// Projection.
    #[must_use]
    pub fn project(scene: &'a Scene, camera: &Camera, settings: &Settings, exec: &Exec) -> Self {
        let grid = exec.grid(camera.width, camera.height);
        let surfels = &scene.surfels;
        let prepared = Prepared::splats(surfels, camera, &settings.splats, (exec, &grid));
        let shader = Shader::new(View::new(camera), &scene.lights, scene.material);
        let own = scene.material.color.to_array().map(R::from_f32);
        Self { surfels, grid, prepared, shader, own }
    }

    /// The division of the picture into tiles.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// What became of the surfels.
    #[must_use]
    pub fn tally(&self) -> Tally {
        self.prepared.tally
    }

    /// Peels at most `most` layers off the pixels of a tile, row by row, and gives also the first
    /// `keep` of the layers, or as many as there are.
    #[must_use]
    pub fn tile(
        &self,
        index: usize,
        rect: Rect,
        most: u32,
        keep: usize,
    ) -> (Vec<Pixel<R>>, Vec<Vec<Layer<R>>>) {
        let mut pixels = vec![Pixel::new(); rect.pixels()];
        let mut kept = Vec::new();
        for _ in 0..most {
            let Some(layer) = self.layer(index, rect, &pixels) else { break };
            for (pixel, layer) in pixels.iter_mut().zip(&layer) {
                pixel.add(layer, self.prepared.epsilon);
            }
            if kept.len() < keep {
                kept.push(layer);
            }
        }
        (pixels, kept)
    }

    /// The next layer of a tile; none if no pixel has one.
    fn layer(&self, index: usize, rect: Rect, pixels: &[Pixel<R>]) -> Option<Vec<Layer<R>>> {
        let shared = &self.prepared.shared;
        let mut sums = vec![Sums::new(shared.empty()); pixels.len()];

        // Visibility splatting.
        self.each_fragment(index, rect, |splat, (_, w), pixel| {
            let sums = &mut sums[pixel];
            if shared.depth(w) > pixels[pixel].limit && w > sums.nearest {
                sums.nearest = w;
                sums.id = splat.surfel;
            }
        });
        if sums.iter().all(|sums| sums.id == NO_ID) {
            return None;
        }

        // Attribute splatting.
        self.each_fragment(index, rect, |splat, (q, w), pixel| {
            let sums = &mut sums[pixel];
            let (t, nearest) = (shared.depth(w), shared.depth(sums.nearest));
            if t > pixels[pixel].limit && epsilon::visible(t, nearest, self.prepared.epsilon) {
                self.accumulate(sums, splat, splat.footprint.weight(q));
            }
        });

        // Normalization and shading.
        let columns = (rect.x1 - rect.x0) as usize;
        let at = |i: usize| (rect.x0 as usize + i % columns, rect.y0 as usize + i / columns);
        Some(sums.iter().enumerate().map(|(i, sums)| self.resolve(sums, at(i))).collect())
    }

    /// Adds the attributes of a fragment.
    fn accumulate(&self, sums: &mut Sums<R>, splat: &Splat<R>, weight: R) {
        let i = splat.surfel as usize;
        let normal = facing(self.surfels.normal()[i].to_array().map(R::from_f32), splat.back);
        let opacity = self.surfels.opacity().map_or(R::ONE, |all| R::from_f32(all[i]));
        if let Some(colors) = self.surfels.color() {
            sums.color = sum::add(sums.color, weight, colors[i].to_array().map(R::from_f32));
        }
        sums.normal = sum::add(sums.normal, weight, normal);
        sums.opacity = sums.opacity + weight * opacity;
        sums.weight = sums.weight + weight;
        sums.count = Stencil::COUNT.update(sums.count, Outcome::Pass);
    }

    /// Averages in place of sums, shaded.
    fn resolve(&self, sums: &Sums<R>, at: (usize, usize)) -> Layer<R> {
        let depth = self.prepared.shared.depth(sums.nearest);
        let [x, y, z] = sum::direction(sums.normal, sums.weight);
        let surface = match self.surfels.color() {
            Some(_) => sum::average(sums.color, sums.weight),
            None => self.own,
        };
        let [alpha, ..] = sum::average([sums.opacity; 3], sums.weight);
        let color = self.shader.pixel(at, depth, (Vector3::new(x, y, z), Vector3::ZERO), surface);
        Layer { depth, id: sums.id, count: sums.count, alpha, color }
    }

    /// Runs `draw` for every fragment of a tile that is inside: splat, (q, nearness), pixel.
    fn each_fragment(
        &self,
        index: usize,
        rect: Rect,
        mut draw: impl FnMut(&Splat<R>, (R, R), usize),
    ) {
        let shared = &self.prepared.shared;
        self.prepared.for_each(index, |splat| {
            each_inside(shared, splat, &rect, |pixel, q, w| draw(splat, (q, w), pixel));
        });
    }
}

impl<R: Exact> Pixel<R> {
    /// No layer yet, and every fragment beyond the last.
    fn new() -> Self {
        let (depth, limit) = (R::INFINITY, -R::INFINITY);
        Self { blend: Under::CLEAR, depth, id: NO_ID, layers: 0, limit }
    }

    /// Blends the next layer under those before, if the pixel has one.
    fn add(&mut self, layer: &Layer<R>, epsilon: R) {
        if layer.id == NO_ID {
            return;
        }
        if self.layers == 0 {
            (self.depth, self.id) = (layer.depth, layer.id);
        }
        self.blend = self.blend.under(layer.alpha, layer.color);
        self.layers += 1;
        self.limit = epsilon::limit(layer.depth, epsilon);
    }
}

impl<R: Exact> Sums<R> {
    fn new(empty: R) -> Self {
        let (weight, opacity, zero) = (R::ZERO, R::ZERO, [R::ZERO; 3]);
        Self { nearest: empty, id: NO_ID, count: 0, weight, normal: zero, color: zero, opacity }
    }
}
