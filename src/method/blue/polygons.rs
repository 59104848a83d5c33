//! Draw triangles beside the discs, see the page of [`super`].

use super::Settings;
use crate::composite::decide;
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::frame::{Framebuffer, Plane};
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::projection::{self, PixelSample};
use crate::number::{Exact, MapInline};
use crate::splat::View;

/// The nearest triangle of each pixel.
pub(super) struct Polygons<R> {
    samples: Plane<PixelSample<R>>,
    view: View<R>,
}

impl<R: Exact> Polygons<R> {
    /// Draws the triangles of a scene; none if it has none.
    ///
    /// # Errors
    /// As [`projection::beside`].
    pub(super) fn draw(job: &Job<'_>, settings: &Settings) -> Result<Option<Self>> {
        if job.scene.primitives.is_empty() {
            return Ok(None);
        }
        let drawn = projection::beside(job, settings.cull, Snap::default())?;
        Ok(Some(Self { samples: drawn.samples, view: View::new(job.camera) }))
    }

    /// Puts triangles into the pixels where they are nearer than the disc.
    pub(super) fn over(&self, target: &mut Framebuffer<R>, job: &Job<'_>) {
        spend(Work::Polygons);
        let Framebuffer { depth, id, weight, normal, color, .. } = target;
        let rows = depth.rows_mut().zip(id.rows_mut()).zip(weight.rows_mut());
        let mut rows: Vec<_> = (0..)
            .zip(rows)
            .map(|(y, ((depth, id), weight))| (y, depth, id, weight, None, None))
            .collect();
        for (row, normal) in rows.iter_mut().zip(normal.iter_mut().flat_map(Plane::rows_mut)) {
            row.4 = Some(normal);
        }
        for (row, color) in rows.iter_mut().zip(color.iter_mut().flat_map(Plane::rows_mut)) {
            row.5 = Some(color);
        }
        job.exec.ordered(rows, |(y, depth, id, weight, mut normal, mut color)| {
            for x in 0..depth.len() {
                let sample = self.samples.at(x as u32, y);
                if !decide::before(job.key.depth(sample.depth), job.key.depth(depth[x])) {
                    continue;
                }
                (depth[x], id[x], weight[x]) = (sample.depth + R::ZERO, sample.id, R::ONE);
                if let Some(row) = &mut normal {
                    row[x] = projection::world(&self.view, sample.normal);
                }
                if let Some(row) = &mut color {
                    row[x] = sample.color.map_inline(|part| part + R::ZERO);
                }
            }
        });
    }
}
