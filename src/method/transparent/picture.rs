//! All stages in one call: from a scene to named planes.

use super::Settings;
use super::blend::{Average, Blending, Layers};
use crate::composite::over::Blend;
use crate::error::Result;
use crate::frame::{Frame, Grid, NO_ID, NamedPlane, Rect, Samples};
use crate::method::algorithm::Job;
use crate::method::picture::{Clock, Picture, before_environment, color, named, scalar};
use crate::number::Exact;
use crate::splat::Tally;

/// The definition of Algorithm 2, in any number; with `stages`, every stage leaves its planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let mut clock = Clock::default();
    let blended = blend(job, settings, stages, |_| None, |_, average| average.blend, &mut clock)?;
    let mut planes = Vec::new();
    if stages {
        planes.extend(blended.planes());
    }
    planes.extend(blended.colors(job));
    planes.push(scalar("Z", blended.plane(R::ZERO, |average| average.depth)));
    planes.push(named("id", Samples::Index(blended.plane(NO_ID, |average| average.surfel))));
    planes.push(scalar("layers", blended.plane(R::ZERO, |average| average.layers)));
    let frame = Frame { width: job.camera.width, height: job.camera.height, planes };
    Ok(Picture { frame, tally: blended.tally, timings: clock.into_laps() })
}

/// A pixel: its tile, its place in the tile, row by row, and its column and row in the picture.
#[derive(Clone, Copy, Debug)]
pub(in crate::method) struct At {
    pub(in crate::method) tile: usize,
    pub(in crate::method) pixel: usize,
    pub(in crate::method) x: u32,
    pub(in crate::method) y: u32,
}

/// The blended groups of a picture, by tile and pixel.
pub(in crate::method) struct Blended<R> {
    grid: Grid,
    groups: usize,
    /// The image of each group, if the planes of the stages are kept.
    images: Vec<Vec<Vec<Layers<R>>>>,
    averages: Vec<Vec<Average<R>>>,
    /// What each pixel shows, before the environment.
    shown: Vec<Vec<Blend<R>>>,
    pub(in crate::method) tally: Tally,
}

/// Order, projection, blending and average.
///
/// `mask` gives the depths of the nearest layer in a rectangle, if fragments up to epsilon behind
/// it are dropped; `show` makes the colour of a pixel from the average of its groups.
pub(in crate::method) fn blend<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
    mask: impl Fn(Rect) -> Option<Vec<R>> + Sync + Send,
    show: impl Fn(At, &Average<R>) -> Blend<R> + Sync + Send,
    clock: &mut Clock,
) -> Result<Blended<R>> {
    let Job { camera, exec, .. } = *job;
    let grid = exec.grid(camera.width, camera.height);
    let blending = Blending::project(job, settings)?;
    clock.lap("projection");
    let tiles = grid.rects().into_iter().enumerate().collect();
    let done = exec.ordered(tiles, |(tile, rect): (usize, Rect)| {
        let images = blending.images(tile, rect, mask(rect).as_deref());
        let columns = (rect.x1 - rect.x0) as usize;
        let pixels = (0..rect.pixels()).map(|pixel| {
            let (x, y) = (rect.x0 + (pixel % columns) as u32, rect.y0 + (pixel / columns) as u32);
            let average = blending.average(&images, pixel);
            (average, show(At { tile, pixel, x, y }, &average))
        });
        let (averages, shown): (Vec<_>, Vec<_>) = pixels.unzip();
        (stages.then_some(images), (averages, shown))
    });
    clock.lap("blending");
    let (images, pixels): (Vec<_>, Vec<_>) = done.into_iter().unzip();
    let (averages, shown) = pixels.into_iter().unzip();
    let images = images.into_iter().flatten().collect();
    let (groups, tally) = (job.index.groups()?.len(), blending.tally());
    Ok(Blended { grid, groups, images, averages, shown, tally })
}

impl<R: Exact> Blended<R> {
    /// A plane of the averages.
    pub(in crate::method) fn plane<T: Clone>(
        &self,
        fill: T,
        of: impl Fn(&Average<R>) -> T,
    ) -> crate::frame::Plane<T> {
        self.grid.assemble(fill, |t, i| of(&self.averages[t][i]))
    }

    /// A plane of the averages and the pixels they are of.
    pub(in crate::method) fn plane_at(
        &self,
        of: impl Fn((usize, usize), &Average<R>) -> R,
    ) -> crate::frame::Plane<R> {
        self.grid.assemble(R::ZERO, |t, i| of((t, i), &self.averages[t][i]))
    }

    /// The planes of blending and average.
    pub(in crate::method) fn planes(&self) -> Vec<NamedPlane<R>> {
        let mut planes = image_planes(&self.grid, &self.images, self.groups);
        planes.extend(average_planes(&self.grid, |t, i| &self.averages[t][i]));
        planes
    }

    /// Colour and opacity before the environment.
    pub(in crate::method) fn colors(&self, job: &Job<'_>) -> [NamedPlane<R>; 2] {
        let shown = |t: usize, i: usize| &self.shown[t][i];
        let colors = self.grid.assemble([R::ZERO; 3], |t, i| shown(t, i).color);
        let alphas = self.grid.assemble(R::ZERO, |t, i| shown(t, i).alpha);
        let (colors, alphas) = before_environment(job.scene, job.camera, colors, alphas, job.exec);
        [color("", colors), scalar("A", alphas)]
    }
}

/// The image of each group.
fn image_planes<R: Exact>(
    grid: &Grid,
    images: &[Vec<Vec<Layers<R>>>],
    groups: usize,
) -> Vec<NamedPlane<R>> {
    let groups = if images.is_empty() { 0 } else { groups };
    let of = |k: usize| {
        let at = |tile: usize, i: usize| &images[tile][k][i];
        let name = |plane: &str| format!("blended.group{k:02}{plane}");
        let counts = grid.assemble(0, |t, i| at(t, i).count);
        let ids = grid.assemble(NO_ID, |t, i| at(t, i).surfel);
        [
            color(&name(""), grid.assemble([R::ZERO; 3], |t, i| at(t, i).blend.color)),
            scalar(&name(".A"), grid.assemble(R::ZERO, |t, i| at(t, i).blend.alpha)),
            scalar(&name(".opacity"), grid.assemble(R::ZERO, |t, i| at(t, i).opacity)),
            scalar(&name(".bin"), grid.assemble(R::ZERO, |t, i| at(t, i).bin)),
            named(&name(".count"), Samples::Count(counts)),
            named(&name(".id"), Samples::Index(ids)),
        ]
    };
    (0..groups).flat_map(of).collect()
}

/// The averages of the compositing pass.
fn average_planes<'a, R: Exact>(
    grid: &Grid,
    at: impl Fn(usize, usize) -> &'a Average<R>,
) -> Vec<NamedPlane<R>> {
    let of = |value: &dyn Fn(&Average<R>) -> R| grid.assemble(R::ZERO, |t, i| value(at(t, i)));
    vec![
        color("blended", grid.assemble([R::ZERO; 3], |t, i| at(t, i).blend.color)),
        scalar("blended.A", of(&|average| average.blend.alpha)),
        scalar("blended.opacity", of(&|average| average.opacity)),
        scalar("blended.hidden", of(&|average| average.hidden)),
        scalar("blended.layers", of(&|average| average.layers)),
    ]
}
