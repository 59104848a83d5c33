//! The definition: draw every primitive in its order, tile by tile.

use super::primitives;
use super::{PixelSample, Projected, SceneProjector};
use crate::composite::decide;
use crate::error::{Error, Result};
use crate::frame::raster::Snap;
use crate::frame::{Bins, Plane, Rect};
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::number::{Exact, MapInline, Vector3};
use crate::splat::{Fate, Tally};
use std::ops::Range;

/// An item that is drawn as a whole.
enum DrawnItem<R> {
    /// A surfel: its pixel and its sample.
    Pixel([u32; 2], PixelSample<R>),
    /// A piece of a triangle, a ribbon or a tube.
    Piece(primitives::Piece<R>),
}

impl<R: Exact> DrawnItem<R> {
    fn bounds(&self) -> Rect {
        match self {
            Self::Pixel([x, y], _) => Rect::pixel((*x, *y)),
            Self::Piece(piece) => piece.bounds,
        }
    }
}

/// Projects a scene; `snap` applies to triangles and lines.
///
/// # Errors
/// [`Error::Invalid`] if there are more primitives than ids.
pub(crate) fn project<R: Exact>(job: &Job<'_>, cull: bool, snap: Snap) -> Result<Projected<R>> {
    from(job, cull, snap, 0)
}

/// Projects everything beside the surfels; the ids are those of the whole scene.
///
/// # Errors
/// As [`project`].
pub(crate) fn beside<R: Exact>(job: &Job<'_>, cull: bool, snap: Snap) -> Result<Projected<R>> {
    from(job, cull, snap, job.scene.surfels.len())
}

/// Projects everything whose id is `first` or higher.
fn from<R: Exact>(job: &Job<'_>, cull: bool, snap: Snap, first: usize) -> Result<Projected<R>> {
    let (Job { scene, camera, .. }, [width, height]) = (*job, job.size());
    let samples = Plane::filled(width, height, PixelSample::empty());
    let mut projected = Projected { samples, tally: Tally::default() };
    let count = scene.surfels.len() + scene.primitives.len();
    if count as u64 >= u64::from(u32::MAX) {
        let what = format!("{count} primitives, but ids have 32 bits: split the scene");
        return Err(Error::Invalid(what));
    }
    let projector = SceneProjector::new(scene, camera, cull, snap);
    draw(&projector, job, first..count, &mut projected);
    Ok(projected)
}

/// Draws the primitives of a range of ids over samples that have lower ids.
fn draw<R: Exact>(
    projector: &SceneProjector<'_, R>,
    job: &Job<'_>,
    ids: Range<usize>,
    projected: &mut Projected<R>,
) {
    let (exec, grid) = (job.exec, job.strips());
    let nearer = |t: R, kept: R| decide::before(job.key.depth(t), job.key.depth(kept));
    let size = (ids.len() / 64).min(8192).max(2 * grid.len());
    let ranges = ids.clone().step_by(size).map(|first| first..ids.end.min(first + size));
    let batches = exec.ordered(ranges.collect(), |range: Range<usize>| {
        spend(Work::Project);
        let mut drawn = Vec::with_capacity(range.len());
        let mut tally = Tally::default();
        for id in range {
            if id < projector.scene.surfels.len() {
                surfel(projector, id, &mut tally, &mut drawn);
            } else {
                primitives::pieces(projector, id, |piece| drawn.push(DrawnItem::Piece(piece)));
            }
        }
        job.keep_touching(&mut drawn, DrawnItem::bounds);
        let bins = Bins::new(&grid, drawn.len(), |i| drawn[i].bounds());
        ((drawn, bins), tally)
    });
    let Projected { samples, tally } = projected;
    *tally = batches.iter().fold(*tally, |sum, (_, tally)| sum.plus(tally));
    exec.ordered(grid.cut(samples, exec), |mut pixels| {
        spend(Work::Project);
        let rect = pixels.rect;
        for ((drawn, bins), _) in &batches {
            bins.for_each(pixels.index, |i| match &drawn[i as usize] {
                DrawnItem::Pixel(at, sample) => {
                    let kept = pixels.at(*at);
                    if nearer(sample.depth, kept.depth) {
                        *kept = *sample;
                    }
                }
                DrawnItem::Piece(piece) => piece.for_each(&rect, |at| {
                    let kept = pixels.at([at.x, at.y]);
                    if nearer(-at.p.z, kept.depth) {
                        *kept = piece.sample(projector, &at);
                    }
                }),
            });
        }
    });
}

/// Draws one surfel as a pixel, if it is seen.
fn surfel<R: Exact>(
    projector: &SceneProjector<'_, R>,
    i: usize,
    tally: &mut Tally,
    drawn: &mut Vec<DrawnItem<R>>,
) {
    let (surfels, points) = (&projector.scene.surfels, &projector.points);
    let n = points.view.direction(Vector3::from_glam(surfels.normal()[i]));
    let (placed, g, fate) = points.fate(Vector3::from_glam(surfels.position()[i]), n);
    tally.count(fate);
    if fate != Fate::Visible {
        return;
    }
    let color = surfels.color().map_or(projector.scene.material.color, |color| color[i]);
    let color =
        if projector.has.color { color.to_array().map_inline(R::from_f32) } else { [R::ZERO; 3] };
    let radius = R::from_f32(surfels.radius()[i]);
    let sample = points.sample(i as u32, &placed, n, g, radius, color);
    drawn.push(DrawnItem::Pixel(placed.pixel(), sample));
}
