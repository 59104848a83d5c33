//! The definition: every pass, one fragment at a time, over any number.

use super::Settings;
use crate::composite::{epsilon, sum};
use crate::frame::stencil::{Outcome, Stencil};
use crate::frame::{Exec, Framebuffer, FramebufferTile, Grid, Plane, Rect, Wanted};
use crate::method::prepare::Prepared;
use crate::number::{Exact, Real, Vector2};
use crate::scene::{Camera, Surfels};
use crate::splat::{Shared, Splat, Tally};

/// A picture between its passes.
#[derive(Debug)]
pub struct Plain<'a, R> {
    surfels: &'a Surfels,
    exec: &'a Exec,
    grid: Grid,
    prepared: Prepared<R, Splat<R>>,
    /// What has been drawn so far.
    pub target: Framebuffer<R>,
}

impl<'a, R: Exact> Plain<'a, R> {
    /// Projection. `wanted` chooses the planes; colours need a scene that has them.
    #[must_use]
    pub fn project(
        surfels: &'a Surfels,
        camera: &Camera,
        settings: &Settings,
        exec: &'a Exec,
        wanted: Wanted,
    ) -> Self {
        let grid = exec.grid(camera.width, camera.height);
        let prepared = Prepared::splats(surfels, camera, settings, (exec, &grid));
        let target = Framebuffer::new(camera.width, camera.height, prepared.shared.empty(), wanted);
        Self { surfels, exec, grid, prepared, target }
    }

    /// What became of the surfels.
    #[must_use]
    pub fn tally(&self) -> Tally {
        self.prepared.tally
    }

    /// The depth of the nearest fragments, between visibility splatting and normalization.
    #[must_use]
    pub fn depth(&self) -> Plane<R> {
        self.target.depth.map(|&nearness| self.prepared.shared.depth(nearness))
    }

    /// Visibility splatting: the greatest nearness, and whose it is.
    pub fn visibility(&mut self) {
        let shared = self.prepared.shared;
        self.each_fragment(|splat, (q, w), tile, (x, y)| {
            let nearest = &mut tile.depth.row(y)[x];
            if q <= shared.limit && w > *nearest {
                *nearest = w;
                tile.id.row(y)[x] = splat.surfel;
            }
        });
    }

    /// Attribute splatting: weighted sums over the fragments that pass the epsilon-z test.
    pub fn attributes(&mut self) {
        let (shared, epsilon) = (self.prepared.shared, self.prepared.epsilon);
        let (normals, colors) = (self.surfels.normal(), self.surfels.color());
        self.each_fragment(|splat, (q, w), tile, (x, y)| {
            let nearest = shared.depth(tile.depth.row(y)[x]);
            let t = shared.depth(w);
            if let Some(margin) = &mut tile.margin {
                let margin = &mut margin.row(y)[x];
                let limit = epsilon::limit(nearest, epsilon);
                let is_nearest = tile.id.row(y)[x] == splat.surfel;
                let decisions = Decisions { q, t, w, nearest: tile.depth.row(y)[x], limit };
                *margin = margin.at_most(decisions.margin(&shared, is_nearest));
            }
            if q <= shared.limit && epsilon::visible(t, nearest, epsilon) {
                let i = splat.surfel as usize;
                let weight = splat.footprint.weight(q);
                if let Some(sums) = &mut tile.normal {
                    let normal = facing(normals[i].to_array().map(R::from_f32), splat.back);
                    let sums = &mut sums.row(y)[x];
                    *sums = sum::add(*sums, weight, normal);
                }
                if let (Some(sums), Some(colors)) = (&mut tile.color, colors) {
                    let sums = &mut sums.row(y)[x];
                    *sums = sum::add(*sums, weight, colors[i].to_array().map(R::from_f32));
                }
                let total = &mut tile.weight.row(y)[x];
                *total = *total + weight;
                if let Some(count) = &mut tile.stencil {
                    let count = &mut count.row(y)[x];
                    *count = Stencil::COUNT.update(*count, Outcome::Pass);
                }
            }
        });
    }

    /// Normalization: depths, averages and directions in place of nearness and sums.
    pub fn normalize(&mut self) {
        let shared = self.prepared.shared;
        self.each_tile(|_, mut tile| {
            for y in 0..(tile.rect.y1 - tile.rect.y0) as usize {
                for x in 0..(tile.rect.x1 - tile.rect.x0) as usize {
                    let weight = tile.weight.row(y)[x];
                    let depth = &mut tile.depth.row(y)[x];
                    *depth = shared.depth(*depth);
                    if let Some(normal) = &mut tile.normal {
                        let normal = &mut normal.row(y)[x];
                        *normal = sum::direction(*normal, weight);
                    }
                    if let Some(color) = &mut tile.color {
                        let color = &mut color.row(y)[x];
                        *color = sum::average(*color, weight);
                    }
                }
            }
        });
    }

    /// Runs `draw` for every fragment of every splat: splat, (q, nearness), tile, pixel in the
    /// tile.
    fn each_fragment(
        &mut self,
        draw: impl Fn(&Splat<R>, (R, R), &mut FramebufferTile<'_, R>, (usize, usize)) + Sync + Send,
    ) {
        let shared = self.prepared.shared;
        self.each_tile(|splats, mut tile| {
            splats(&mut |splat| {
                let Rect { x0, y0, x1, y1 } = splat.bounds.intersection(&tile.rect);
                for y in y0..y1 {
                    for x in x0..x1 {
                        let fragment = fragment(&shared, splat, x, y);
                        let at = ((x - tile.rect.x0) as usize, (y - tile.rect.y0) as usize);
                        draw(splat, fragment, &mut tile, at);
                    }
                }
            });
        });
    }

    /// Runs `job` for every tile, with a function that visits the splats of the tile.
    fn each_tile(
        &mut self,
        job: impl Fn(&dyn Fn(&mut dyn FnMut(&Splat<R>)), FramebufferTile<'_, R>) + Sync + Send,
    ) {
        let prepared = &self.prepared;
        let tiles = self.target.tiles(&self.grid, self.exec).into_iter().enumerate().collect();
        self.exec.ordered(tiles, |(index, tile)| {
            job(&|visit| prepared.for_each(index, visit), tile);
        });
    }
}

/// q and nearness of a splat at the centre of a pixel.
pub(in crate::method) fn fragment<R: Exact>(
    shared: &Shared<R>,
    splat: &Splat<R>,
    x: u32,
    y: u32,
) -> (R, R) {
    let Vector2 { x: cx, y: cy } = splat.footprint.center;
    let dx = R::from_f32(x as f32 + 0.5) - cx;
    let dy = R::from_f32(y as f32 + 0.5) - cy;
    splat.footprint.fragment(shared, dx, dy)
}

/// Runs `draw` for every fragment of a splat that is inside, in some pixels: the pixel, counted row
/// by row in `rect`, q and nearness.
#[inline(always)]
pub(in crate::method) fn each_inside<R: Exact>(
    shared: &Shared<R>,
    splat: &Splat<R>,
    rect: &Rect,
    mut draw: impl FnMut(usize, R, R),
) {
    let columns = rect.x1 - rect.x0;
    let Rect { x0, y0, x1, y1 } = splat.bounds.intersection(rect);
    for y in y0..y1 {
        for x in x0..x1 {
            let (q, w) = fragment(shared, splat, x, y);
            if q <= shared.limit {
                draw(((y - rect.y0) * columns + (x - rect.x0)) as usize, q, w);
            }
        }
    }
}

/// The normal, reversed if the back is seen.
#[inline(always)]
pub(in crate::method) fn facing<R: Exact>(normal: [R; 3], back: bool) -> [R; 3] {
    if back { normal.map(|component| -component) } else { normal }
}

/// The operands of the decisions on one fragment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Decisions<R> {
    pub(super) q: R,
    pub(super) t: R,
    pub(super) w: R,
    /// Nearness of the nearest fragment of the pixel.
    pub(super) nearest: R,
    /// The greatest visible depth of the pixel.
    pub(super) limit: R,
}

impl<R: Exact> Decisions<R> {
    /// How far the closest decision on this fragment is from flipping, in units of the last place.
    ///
    /// Inside: q against k^2, if the fragment is visible; a hidden one changes nothing. Epsilon: t
    /// against the limit, if it is inside. Depth: nearness against that of the nearest, if it is
    /// inside and another one.
    fn margin(&self, shared: &Shared<R>, is_nearest: bool) -> R {
        let (inside, visible) = (self.q <= shared.limit, self.t <= self.limit);
        let mut margin = f32::INFINITY;
        if visible {
            margin = margin.at_most(self.q.ulps_to(shared.limit));
        }
        if inside {
            margin = margin.at_most(self.t.ulps_to(self.limit));
            if !is_nearest {
                margin = margin.at_most(self.w.ulps_to(self.nearest));
            }
        }
        R::from_f32(margin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, Lens, Pose};
    use crate::splat::{Kernel, View};
    use glam::DVec3;

    fn shared() -> Shared<f32> {
        let pose = Pose { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y };
        let camera = Camera::new(8, 8, pose, Lens::Focal(8.0)).unwrap();
        Shared::new(&View::new(&camera), &Kernel::DEFAULT)
    }

    /// A number some steps up from another.
    fn up(value: f32, steps: u32) -> f32 {
        f32::from_bits(value.to_bits() + steps)
    }

    #[test]
    fn the_margin_is_that_of_the_closest_decision_that_matters() {
        let nearest = Decisions { q: 1.0, t: 2.0, w: 0.5, nearest: 0.5, limit: up(2.0, 700) };
        assert_eq!(nearest.margin(&shared(), true), 700.0, "epsilon: t against the limit");
        let rim = Decisions { q: up(4.0, 3), ..nearest };
        assert_eq!(rim.margin(&shared(), false), 3.0, "inside: q against k^2 = 4");
        let second = Decisions { w: up(0.5, 5), nearest: up(0.5, 7), ..nearest };
        assert_eq!(second.margin(&shared(), false), 2.0, "depth: against the nearest");
        let hidden = Decisions { q: up(4.0, 3), t: 3.0, ..nearest };
        assert_eq!(hidden.margin(&shared(), false), f32::INFINITY, "outside and hidden: no matter");
        let behind = Decisions { t: up(2.0, 709), w: 0.25, ..nearest };
        assert_eq!(behind.margin(&shared(), false), 9.0, "inside, but beyond the limit by 9");
    }
}
