//! Draw in `f32`, fast: the bits of [`super::pull`] and [`super::push`], from another layout.
//!
//! A level is rows of numbers, one number of all cells of a row after the other, so that 16 cells
//! of a row are 16 neighbours in memory. The pull phase computes 16 coarser cells at a time. The
//! push phase computes 16 finer cells of every second column, which have 16 consecutive parents.
//! Empty cells are passed over. Level 1 is pulled from rows of level 0 that are in the cache. The
//! push phase changes a level in place and touches only cells that are empty or occluded.

mod level;
mod mix;
mod pull;
mod push;
#[cfg(test)]
mod tests;
mod write;

use super::gbuffer::GBuffer;
use super::pull::side;
use super::{Cell, Settings};
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::frame::{Exec, pyramid};
use crate::method::Job;
use crate::method::clock::Clock;
use crate::method::projection::fast::{NearestPoints, Points, RowLayout, pairs};
use crate::method::projection::surfels::PointProjector;
use crate::method::projection::{self, Has, Projected, SampleKind};
use crate::number::lanes::{LANES, Lanes, each, store, vectorized};
use crate::scene::Camera;
use crate::splat::{Tally, View};
use level::{BACK, CellLevel, FRONT, FURTHER, KIND, NORMAL, RADIUS};
use push::PushRules;
use write::GBufferRow;

/// The levels of a picture; their memory can be used for many pictures.
#[derive(Debug, Default)]
pub struct CellLevels {
    points: Points,
    levels: Vec<CellLevel>,
    has: Has,
}

impl CellLevels {
    /// Projects a scene, pulls and pushes, and overwrites `target`, which has the size of the
    /// picture.
    ///
    /// # Errors
    /// As [`super::render`]; camera and settings must have been checked.
    pub(super) fn draw(
        &mut self,
        job: &Job<'_>,
        settings: &Settings,
        target: &mut GBuffer<f32>,
    ) -> Result<(Tally, Clock)> {
        let Job { scene, camera, exec, .. } = *job;
        let mut clock = Clock::default();
        self.reshape(camera, Has::in_scene(scene));
        let (tally, made) = self.project(job, settings, &mut clock)?;
        let tubes = self.has.tangent;
        for level in made..self.levels.len() {
            let (finer, coarser) = self.levels.split_at_mut(level);
            pull::pull(&finer[level - 1], &mut coarser[0], side(level - 1), tubes, exec);
        }
        clock.lap("pull");
        for level in (2..self.levels.len()).rev() {
            let (finer, coarser) = self.levels.split_at_mut(level);
            let rules = PushRules { side: side(level - 1), tubes, settings };
            let beside = std::iter::repeat(());
            push::push(&mut finer[level - 1], &coarser[0], &rules, exec, beside, |_, ()| {});
        }
        self.finish(&View::new(camera), settings, exec, target);
        clock.lap("push");
        Ok((tally, clock))
    }

    /// Makes the memory for a picture.
    fn reshape(&mut self, camera: &Camera, has: Has) {
        let sizes = pyramid::sizes(camera.width, camera.height);
        let layouts = sizes.into_iter().map(|size| level::layout(size, has));
        if !layouts.clone().eq(self.levels.iter().map(|level| level.layout)) {
            self.levels = layouts.map(CellLevel::new).collect();
        }
        self.has = has;
    }

    /// Fills level 0, and also level 1 from surfels alone. Returns how many levels are filled.
    fn project(
        &mut self,
        job: &Job<'_>,
        settings: &Settings,
        clock: &mut Clock,
    ) -> Result<(Tally, usize)> {
        let Job { scene, camera, exec, .. } = *job;
        if !scene.primitives.is_empty() {
            let snap = Snap::new(settings.subpixel_bits)?;
            let projected = projection::project(job, settings.cull, snap)?;
            fill(&projected, self.has, &mut self.levels[0], exec);
            clock.lap("projection");
            return Ok((projected.tally, 1));
        }
        let lens = PointProjector::new(View::new(camera), settings.cull);
        let tally = self.points.find(&scene.surfels, &lens, exec);
        clock.lap("projection");
        let (finest, coarser) = self.levels.split_at_mut(1);
        let (finest, coarser) = (&mut finest[0], coarser.first_mut());
        let layout = finest.layout;
        let layouts = [layout, coarser.as_ref().map_or(layout, |coarse| coarse.layout)];
        let coarse = coarser.map(CellLevel::rows_mut).into_iter().flatten().map(Some);
        let jobs = pairs(finest.rows_mut()).zip(coarse.chain(std::iter::repeat_with(|| None)));
        let empty = vec![0.0; layout.row()];
        let times =
            self.points.each_band(&scene.surfels, &lens, jobs, exec, |band, jobs, watch| {
                for (y, ((upper, mut lower), coarse)) in (0..).step_by(2).zip(jobs) {
                    samples(&band.row(y), upper, &layout);
                    if let Some(lower) = &mut lower {
                        samples(&band.row(y + 1), lower, &layout);
                    }
                    watch.lap(0);
                    if let Some(coarse) = coarse {
                        let finer = [&*upper, lower.as_deref().unwrap_or(&empty)];
                        pull::pull_pair(finer, coarse, &layouts, side(0), false);
                    }
                    watch.lap(1);
                }
            });
        clock.shares(["projection", "pull"], &times);
        Ok((tally, 2))
    }

    /// Pushes to level 0, and writes the picture.
    fn finish(
        &mut self,
        view: &View<f32>,
        settings: &Settings,
        exec: &Exec,
        target: &mut GBuffer<f32>,
    ) {
        let (finest, coarser) = self.levels.split_at_mut(1);
        let (fine, rows) = (&mut finest[0], write::rows(target));
        let layout = fine.layout;
        let write = |cells: &[f32], row: GBufferRow<'_>| row.write(cells, &layout, view);
        match coarser.first() {
            Some(coarse) => {
                let rules = PushRules { side: side(0), tubes: self.has.tangent, settings };
                push::push(fine, coarse, &rules, exec, rows, write);
            }
            // A picture of one pixel has no coarser level.
            None => fine.rows_mut().zip(rows).for_each(|(cells, row)| write(cells, row)),
        }
    }
}

vectorized!(
    /// Fills a row of level 0 from the nearest points of its pixels.
    fn samples(nearest: &NearestPoints<'_>, row: &mut [f32], layout: &RowLayout) {
        for x in (0..layout.width).step_by(LANES) {
            let mut put = |attribute: usize, lanes: &Lanes| {
                store(row, layout.at(attribute, x), lanes);
            };
            let Some(s) = nearest.take(x) else {
                put(KIND, &[0.0; LANES]);
                continue;
            };
            put(KIND, &each(|i| if s.depth[i] < f32::INFINITY { SURFACE } else { 0.0 }));
            put(FRONT, &s.depth);
            put(BACK, &each(|i| s.depth[i] + s.radius[i]));
            put(RADIUS, &s.extent);
            (0..3).for_each(|axis| put(NORMAL + axis, &s.normal[axis]));
            if let Some(color) = nearest.colors(&nearest.ids(&s)) {
                (0..3).for_each(|channel| put(FURTHER + channel, &color[channel]));
            }
        }
    }
);

/// [`SampleKind::Surface`] as a number.
const SURFACE: f32 = SampleKind::Surface as u8 as f32;

/// Stores the samples of a projected scene as level 0.
fn fill(projected: &Projected<f32>, has: Has, level: &mut CellLevel, exec: &Exec) {
    let layout = level.layout;
    let samples = projected.samples.values().chunks(layout.width);
    let jobs = level.rows_mut().zip(samples).collect();
    exec.ordered(jobs, |(row, samples): (&mut [f32], &[_])| {
        for (x, sample) in samples.iter().enumerate() {
            let cell = Cell::new(sample);
            let mut put = |at: usize, values: &[f32]| {
                for (k, value) in values.iter().enumerate() {
                    row[layout.at(at + k, x)] = *value;
                }
            };
            let (n, t) = (cell.normal, cell.tangent);
            put(KIND, &[f32::from(cell.kind as u8), cell.front, cell.back, cell.extent]);
            put(NORMAL, &[n.x, n.y, n.z]);
            if has.color {
                put(FURTHER, &cell.color);
            }
            if has.tangent {
                put(layout.attributes - 3, &[t.x, t.y, t.z]);
            }
        }
    });
}
