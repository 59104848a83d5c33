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
use crate::frame::{Exec, Framebuffer, Plane, pyramid};
use crate::method::clock::{Clock, Work, spend};
use crate::method::projection::Has;
use crate::method::projection::fast::{NearestPoints, PAD, Points, RowLayout};
use crate::method::projection::surfels::PointProjector;
use crate::number::lanes::{LANES, Lanes, store, vectorized};
use crate::scene::{Camera, Scene};
use crate::splat::{Tally, View};
use level::{COLOR, CenterLevel, CenterRowMut, DEPTH, EXTENT, NORMAL, PLACE, RADIUS};
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
            if level == top { f32::INFINITY } else { settings.reach(level) }
        };
        let tally = self.project(scene, camera, settings.cull, reach(0), exec);
        clock.lap("projection");
        for level in 1..=top {
            let (finer, coarser) = self.levels.split_at_mut(level);
            let reach = [reach(level - 1), reach(level)];
            merge::merge(&finer[level - 1], &mut coarser[0], reach, exec);
        }
        clock.lap("propagation");
        self.search(camera, settings, has.color, exec, target);
        clock.lap("reconstruction and normalization");
        (tally, clock)
    }

    /// Fills level 0.
    fn project(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        cull: bool,
        reach: f32,
        exec: &Exec,
    ) -> Tally {
        let lens = PointProjector::new(View::new(camera), cull);
        let tally = self.points.find(&scene.surfels, &lens, exec);
        let level = &mut self.levels[0];
        let layout = level.layout;
        self.points.each_row(&scene.surfels, &lens, level.rows_mut(), exec, |nearest, mut row| {
            samples(nearest, &mut row, &layout, reach);
        });
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
    /// Fills a row of level 0 from the nearest points of its pixels.
    fn samples(
        nearest: &NearestPoints<'_>,
        row: &mut CenterRowMut<'_>,
        layout: &RowLayout,
        reach: f32,
    ) {
        *row.has = [false; 2];
        for x in (0..layout.width).step_by(LANES) {
            let Some(s) = nearest.take(x) else {
                row.clear(layout, x);
                continue;
            };
            let ids = nearest.ids(&s);
            let center = nearest.centers(&ids);
            let mut put = |attribute: usize, lanes: &Lanes| {
                store(row.numbers, layout.at(attribute, x), lanes);
            };
            put(DEPTH, &s.depth);
            put(RADIUS, &s.radius);
            put(EXTENT, &s.extent);
            (0..2).for_each(|axis| put(PLACE + axis, &center[axis]));
            (0..3).for_each(|axis| put(NORMAL + axis, &s.normal[axis]));
            if let Some(color) = nearest.colors(&ids) {
                (0..3).for_each(|channel| put(COLOR + channel, &color[channel]));
            }
            store(row.ids, PAD + x, &ids);
            row.settle(layout, x, reach);
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
