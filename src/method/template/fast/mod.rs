//! Draw in `f32`, fast: the bits of [`super::reconstruction`], from another layout.
//!
//! A level is rows of numbers, one number of all cells of a row after the other. An ellipse is
//! computed once for each centre, not once for each visit. 16 pixels of a row search together: at
//! level 0 for centres that lie beside one another in memory, at coarser levels for one centre
//! after the other. Rows and levels where no centre stays are passed over. Each pixel meets its
//! centres in the order of the definition.

mod level;
mod merge;
mod search;
#[cfg(test)]
mod tests;

use super::{Falloff, Settings, propagation};
use crate::frame::{Exec, Framebuffer, NO_ID, Plane, pyramid};
use crate::method::clock::{Clock, Work, spend};
use crate::method::projection::Has;
use crate::method::projection::fast::{NearestPoints, Points, RowLayout, pairs};
use crate::method::projection::surfels::PointProjector;
use crate::number::lanes::{LANES, any, mask, vectorized};
use crate::scene::{Camera, Scene};
use crate::splat::{Tally, View};
use level::{CenterLevel, CenterRowMut, SampledLanes};
use search::Target;

/// The levels of a picture; their memory can be used for many pictures.
#[derive(Debug, Default)]
pub struct CenterLevels {
    points: Points,
    levels: Vec<CenterLevel>,
}

impl CenterLevels {
    /// Projects a scene, propagates and reconstructs. Every pixel of `target` is overwritten,
    /// except in the stencil and the margin.
    ///
    /// # Panics
    /// If the framebuffer does not have the size of the camera's picture.
    pub(super) fn draw(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        settings: &Settings,
        exec: &Exec,
        target: &mut Framebuffer<f32>,
    ) -> (Tally, Clock) {
        assert_eq!((target.width, target.height), (camera.width, camera.height), "its size");
        let mut clock = Clock::default();
        let has = Has::in_scene(scene);
        let sizes = pyramid::sizes(camera.width, camera.height);
        let top = propagation::top(settings, &sizes);
        let layouts = sizes[..=top].iter().map(|&size| level::layout(size, has.color));
        if !layouts.clone().eq(self.levels.iter().map(|level| level.layout)) {
            self.levels = layouts.map(CenterLevel::new).collect();
        }
        let reach = |level: usize| {
            if level >= top { f32::INFINITY } else { settings.reach(level) }
        };
        let lens = PointProjector::new(View::new(camera), settings.cull);
        let tally = self.project(scene, &lens, [reach(0), reach(1)], exec, &mut clock);
        for level in 2..=top {
            let (finer, coarser) = self.levels.split_at_mut(level);
            let reach = [reach(level - 1), reach(level)];
            merge::merge(&finer[level - 1], &mut coarser[0], reach, exec);
        }
        clock.lap("propagation");
        self.search(camera, settings, has.color, exec, target);
        clock.lap("reconstruction and normalization");
        (tally, clock)
    }

    /// Fills level 0 with the centres that stay there, and level 1 from the others, which no later
    /// stage needs. Their rows lie in memory that fits the cache.
    fn project(
        &mut self,
        scene: &Scene,
        lens: &PointProjector<f32>,
        reach: [f32; 2],
        exec: &Exec,
        clock: &mut Clock,
    ) -> Tally {
        let surfels = &scene.surfels;
        let tally = self.points.find(surfels, lens, exec);
        clock.lap("projection");
        let (finest, coarser) = self.levels.split_at_mut(1);
        let (finest, coarser) = (&mut finest[0], coarser.first_mut());
        let layout = finest.layout;
        let layouts = [layout, coarser.as_ref().map_or(layout, |coarse| coarse.layout)];
        let coarse = coarser.into_iter().flat_map(CenterLevel::rows_mut).map(Some);
        let jobs = pairs(finest.rows_mut()).zip(coarse.chain(std::iter::repeat_with(|| None)));
        let times = self.points.each_band(surfels, lens, jobs, exec, |band, jobs, watch| {
            let mut moving = CenterLevel::new(RowLayout { height: 2, ..layout });
            for (y, ((mut upper, mut lower), coarse)) in (0..).step_by(2).zip(jobs) {
                let rows = [Some(&mut upper), lower.as_mut()].into_iter().flatten();
                for ((y, row), mut moving) in (y..).zip(rows).zip(moving.rows_mut()) {
                    samples(&band.row(y), row, &mut moving, &layout, reach[0]);
                }
                watch.lap(0);
                if let Some(mut coarse) = coarse {
                    let lower = lower.map(|_| moving.row(1));
                    merge::merge_pair(moving.row(0), lower, &mut coarse, &layouts, reach);
                }
                watch.lap(1);
            }
        });
        clock.shares(["projection", "propagation"], &times);
        tally
    }

    /// Reconstructs and normalizes the picture, a few pixels at a time.
    fn search(
        &self,
        camera: &Camera,
        settings: &Settings,
        colored: bool,
        exec: &Exec,
        target: &mut Framebuffer<f32>,
    ) {
        spend(Work::Search);
        let searched = self.levels.iter().enumerate().filter(|(_, level)| level.is_searched());
        let (which, levels): (Vec<usize>, Vec<&CenterLevel>) = searched.unzip();
        let (view, half) = (View::new(camera), settings.half() as usize);
        exec.ordered(rows(target).enumerate().collect(), |(y, mut row): (usize, Target<'_>)| {
            let search = match (colored, settings.falloff) {
                (false, Falloff::Linear) => search::search_row::<false, false>,
                (false, Falloff::Gaussian) => search::search_row::<false, true>,
                (true, Falloff::Linear) => search::search_row::<true, false>,
                (true, Falloff::Gaussian) => search::search_row::<true, true>,
            };
            search(&levels, &which, half, y, &view, &mut row);
        });
    }
}

vectorized!(
    /// Fills a row of level 0 from the nearest points of its pixels: the centres that stay there, and
    /// in `moving` the others.
    fn samples(
        nearest: &NearestPoints<'_>,
        row: &mut CenterRowMut<'_>,
        moving: &mut CenterRowMut<'_>,
        layout: &RowLayout,
        reach: f32,
    ) {
        (*row.has, *moving.has) = ([false; 2], [false; 2]);
        for x in (0..layout.width).step_by(LANES) {
            let Some(s) = nearest.take(x) else {
                row.clear(layout, x);
                moving.clear(layout, x);
                continue;
            };
            let ids = nearest.ids(&s);
            let centers = SampledLanes {
                ids,
                place: nearest.centers(&ids),
                depth: s.depth,
                radius: s.radius,
                extent: s.extent,
                normal: s.normal,
                color: nearest.colors(&ids),
            };
            let there = |i: usize| ids[i] != NO_ID;
            if any(&mask(|i| there(i) & (s.extent[i] <= reach))) {
                row.put(layout, x, &centers);
                row.settle(layout, x, reach);
            } else {
                row.clear(layout, x);
            }
            if any(&mask(|i| there(i) & !(s.extent[i] <= reach))) {
                moving.put(layout, x, &centers);
                moving.has[1] = true;
            } else {
                moving.clear(layout, x);
            }
        }
    }
);

/// The rows of a framebuffer.
fn rows(target: &mut Framebuffer<f32>) -> impl Iterator<Item = Target<'_>> {
    let planes = target.depth.rows_mut();
    let planes = planes.zip(target.id.rows_mut());
    let planes = planes.zip(target.weight.rows_mut());
    let mut normal = target.normal.as_mut().map(Plane::rows_mut);
    let mut color = target.color.as_mut().map(Plane::rows_mut);
    planes.map(move |((depth, id), weight)| Target {
        depth,
        id,
        weight,
        normal: normal.as_mut().and_then(Iterator::next),
        color: color.as_mut().and_then(Iterator::next),
    })
}
