//! The fast path for `f32`: the bits of [`super::pull`] and [`super::push`], from another layout.
//!
//! A level is rows of numbers, one number of all cells of a row after the other, so that 16 cells
//! of a row are 16 neighbours in memory. The pull phase computes 16 coarser cells at a time, the
//! push phase 16 finer ones of every second column, which have 16 consecutive parents. What is
//! empty is passed over; the push phase changes a level in place and touches only cells that are
//! empty or occluded.

mod level;
mod mix;
mod output;
mod pull;
mod push;

use super::gbuffer::GBuffer;
use super::pull::side;
use super::{Cell, Settings};
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::frame::{Exec, pyramid};
use crate::method::projection::fast::{LANES, Lanes, Nearest, Points};
use crate::method::projection::surfels::PointProjector;
use crate::method::projection::{self, Has, Projected, SampleKind};
use crate::scene::{Camera, Scene};
use crate::splat::{Tally, View};
use level::{BACK, FRONT, FURTHER, KIND, Level, NORMAL, RADIUS, Shape};
use multiversion::multiversion;
use output::Output;
use std::time::{Duration, Instant};

/// Wall times of the stages.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Timings {
    /// Projection to single pixels.
    pub(super) project: Duration,
    /// The pull phase.
    pub(super) pull: Duration,
    /// The push phase, and the picture.
    pub(super) push: Duration,
}

/// The levels of a picture, which can be used for many pictures.
#[derive(Debug, Default)]
pub struct Levels {
    points: Points,
    levels: Vec<Level>,
    has: Has,
}

impl Levels {
    /// Projects a scene, pulls and pushes, and overwrites `surface`, which has the size of the
    /// picture.
    ///
    /// # Errors
    /// As [`super::render`]; camera and settings must have been checked.
    pub(super) fn draw(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        settings: &Settings,
        exec: &Exec,
        surface: &mut GBuffer<f32>,
    ) -> Result<(Tally, Timings)> {
        let start = Instant::now();
        self.reshape(camera, Has::of(scene));
        let tally = self.project(scene, camera, settings, exec)?;
        let projected = Instant::now();
        let tubes = self.has.tangent;
        for level in 1..self.levels.len() {
            let (finer, coarser) = self.levels.split_at_mut(level);
            pull::pull(&finer[level - 1], &mut coarser[0], side(level - 1), tubes, exec);
        }
        let pulled = Instant::now();
        for level in (2..self.levels.len()).rev() {
            let (finer, coarser) = self.levels.split_at_mut(level);
            let (fine, how) = (&mut finer[level - 1], (side(level - 1), tubes, settings));
            push::push(fine, &coarser[0], how, exec, std::iter::repeat(()), |_, ()| {});
        }
        self.finish(&View::new(camera), settings, exec, surface);
        let times = Timings {
            project: projected - start,
            pull: pulled - projected,
            push: pulled.elapsed(),
        };
        Ok((tally, times))
    }

    /// The memory for a picture.
    fn reshape(&mut self, camera: &Camera, has: Has) {
        let sizes = pyramid::sizes(camera.width, camera.height);
        let shapes = sizes.into_iter().map(|size| level::shape(size, has));
        if !shapes.clone().eq(self.levels.iter().map(|level| level.shape)) {
            self.levels = shapes.map(Level::new).collect();
        }
        self.has = has;
    }

    /// Level 0.
    fn project(
        &mut self,
        scene: &Scene,
        camera: &Camera,
        settings: &Settings,
        exec: &Exec,
    ) -> Result<Tally> {
        let level = &mut self.levels[0];
        if !scene.primitives.is_empty() {
            let snap = Snap::new(settings.subpixel_bits)?;
            let projected = projection::project(scene, camera, settings.cull, snap, exec)?;
            store(&projected, self.has, level, exec);
            return Ok(projected.tally);
        }
        let lens = PointProjector::new(View::new(camera), settings.cull);
        let tally = self.points.find(&scene.surfels, &lens, exec);
        let (shape, from) = (level.shape, (&scene.surfels, &lens));
        self.points.each_row(from, level.rows_mut(), exec, |nearest, row| {
            samples(nearest, row, &shape);
        });
        Ok(tally)
    }

    /// The push to level 0, and the picture.
    fn finish(
        &mut self,
        view: &View<f32>,
        settings: &Settings,
        exec: &Exec,
        surface: &mut GBuffer<f32>,
    ) {
        let (finest, coarser) = self.levels.split_at_mut(1);
        let (fine, outputs) = (&mut finest[0], output::rows(surface));
        let shape = fine.shape;
        let write = |row: &[f32], output: Output<'_>| output.write(row, &shape, view);
        match coarser.first() {
            Some(coarse) => {
                let how = (side(0), self.has.tangent, settings);
                push::push(fine, coarse, how, exec, outputs, write);
            }
            // One pixel.
            None => fine.rows_mut().zip(outputs).for_each(|(row, output)| write(row, output)),
        }
    }
}

/// A row of level 0 from the nearest points of its pixels.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn samples(nearest: &Nearest<'_>, row: &mut [f32], shape: &Shape) {
    for x in (0..shape.width).step_by(LANES) {
        let mut put = |attribute: usize, lanes: &Lanes| {
            let at = shape.at(attribute, x);
            row[at..at + LANES].copy_from_slice(lanes);
        };
        let Some(s) = nearest.take(x) else {
            put(KIND, &[0.0; LANES]);
            continue;
        };
        let (mut kind, mut back) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            kind[i] = if s.depth[i] < f32::INFINITY { SURFACE } else { 0.0 };
            back[i] = s.depth[i] + s.radius[i];
        }
        put(KIND, &kind);
        put(FRONT, &s.depth);
        put(BACK, &back);
        put(RADIUS, &s.extent);
        (0..3).for_each(|axis| put(NORMAL + axis, &s.normal[axis]));
        if let Some(color) = nearest.colors(&nearest.ids(&s)) {
            (0..3).for_each(|channel| put(FURTHER + channel, &color[channel]));
        }
    }
}

/// [`SampleKind::Surface`] as a number.
const SURFACE: f32 = SampleKind::Surface as u8 as f32;

/// The samples of a projected scene as level 0.
fn store(projected: &Projected<f32>, has: Has, level: &mut Level, exec: &Exec) {
    let shape = level.shape;
    let samples = projected.samples.values().chunks(shape.width);
    let jobs = level.rows_mut().zip(samples).collect();
    exec.ordered(jobs, |(row, samples): (&mut [f32], &[_])| {
        for (x, sample) in samples.iter().enumerate() {
            let cell = Cell::new(sample);
            let mut put = |at: usize, values: &[f32]| {
                for (k, value) in values.iter().enumerate() {
                    row[shape.at(at + k, x)] = *value;
                }
            };
            let (n, t) = (cell.normal, cell.tangent);
            put(KIND, &[f32::from(cell.kind as u8), cell.front, cell.back, cell.extent]);
            put(NORMAL, &[n.x, n.y, n.z]);
            if has.color {
                put(FURTHER, &cell.color);
            }
            if has.tangent {
                put(shape.attributes - 3, &[t.x, t.y, t.z]);
            }
        }
    });
}

#[cfg(test)]
mod tests;
