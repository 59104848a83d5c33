//! Draw polygons beside the surfels \[GBP04, Fig. 7\]: into the depth before pass 1, and into the
//! colour after pass 5.
//!
//! [`crate::method::projection`] draws the triangles, with the corners snapped to 1/256 px and the
//! culling of the surfels. Triangles of objects are drawn in their places, in the order of the
//! scene. A pixel keeps the nearest triangle. The pixel's nearness is computed from the triangle's
//! depth. The depth of the passes and of the picture is computed from that nearness again, as for a
//! splat.
//!
//! - Pass 1 draws into this depth. If a surfel's and a polygon's fragment are equally near, the
//!   surfel's wins. A polygon has no id.
//! - Passes 2, 3 and 4 test against the depth of both.
//! - `Decided:` a pixel shows the splats where they have weight and the nearest fragment is a
//!   surfel's, else the polygon, with the weight 1. If additive splats were just drawn over
//!   polygons, splats within epsilon behind a polygon would shine through. Without pass 3, the
//!   nearest fragment of the splats is the nearest fragment of B(i), if it is nearer than the depth
//!   of pass 1.
//!
//! A pixel that shows a polygon has the polygon's depth, its normal in world space and its colour,
//! and no id. The planes of `attributes` keep the sums of splats that are not shown.
//!
//! Polygons without colours get the material's colour if no polygon has a colour, else
//! [`Objects::fill`](crate::scene::Objects::fill). If polygons alone have colours, surfels of
//! objects get `fill`, and surfels of a scene without objects get the material's colour. The colour
//! of an object is also the colour of its polygons.

use super::part::Whole;
use super::visibility::{Nearest, POLYGON};
use super::{Settings, visibility};
use crate::error::Result;
use crate::frame::raster::Snap;
use crate::frame::{Exec, Framebuffer, NO_ID, Plane};
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::projection::{self, PixelSample, SampleKind};
use crate::method::surface::SurfacePixel;
use crate::number::{Exact, MapInline};
use crate::scene::{Scene, Surfels};
use crate::splat::View;

/// The polygons as a scene of their own, and, if surfels have colours, the colour of polygons
/// without one; none if there are no polygons.
///
/// # Errors
/// As [`Whole::polygons`].
pub(crate) fn alone(job: &Job<'_>, whole: &Whole<'_>) -> Result<Option<(Scene, Option<[f32; 3]>)>> {
    let primitives = whole.polygons()?;
    if primitives.is_empty() {
        return Ok(None);
    }
    let paint = (!primitives.colored()).then(|| job.scene.material.color.to_array());
    let primitives = primitives.into_owned();
    Ok(Some((Scene { primitives, ..Scene::unlit(&job.scene.name, Surfels::none()) }, paint)))
}

/// The nearest polygon of each pixel.
pub(super) struct Polygons<R> {
    samples: Plane<PixelSample<R>>,
    view: View<R>,
    /// The colour of polygons without one, if surfels have colours.
    paint: Option<[R; 3]>,
}

impl<R: Exact> Polygons<R> {
    /// Draws the polygons of a scene; none if it has none.
    ///
    /// # Errors
    /// As [`projection::project`] and [`Whole::polygons`].
    pub(super) fn draw(
        job: &Job<'_>,
        settings: &Settings,
        whole: &Whole<'_>,
    ) -> Result<Option<Self>> {
        let Some((scene, paint)) = alone(job, whole)? else { return Ok(None) };
        spend(Work::Polygons);
        let (cull, snap) = (settings.splats.cull, Snap::default());
        let drawn = projection::project::<R>(&Job { scene: &scene, ..*job }, cull, snap)?;
        let paint = paint.map(|color| color.map_inline(R::from_f32));
        Ok(Some(Self { samples: drawn.samples, view: View::new(job.camera), paint }))
    }

    /// The fragment of a pixel.
    pub(super) fn nearest(&self, x: u32, y: u32) -> Nearest<R> {
        let sample = self.samples.at(x, y);
        if sample.kind == SampleKind::Empty {
            return visibility::empty(self.view.perspective);
        }
        let nearness = self.view.nearness(sample.depth);
        let depth = if self.view.perspective { R::ONE / nearness } else { -nearness };
        Nearest { nearness, depth, id: POLYGON }
    }

    /// The surface that a pixel shows.
    pub(super) fn surface(&self, x: u32, y: u32) -> SurfacePixel<R> {
        spend(Work::ShowPolygons);
        let sample = self.samples.at(x, y);
        if sample.kind == SampleKind::Empty {
            return SurfacePixel::EMPTY;
        }
        SurfacePixel {
            depth: self.nearest(x, y).depth,
            id: NO_ID,
            weight: R::ONE,
            normal: projection::world(&self.view, sample.normal),
            color: self.paint.unwrap_or(sample.color),
        }
    }
}

impl Polygons<f32> {
    /// Puts polygons into the pixels without weight.
    pub(super) fn fill(&self, target: &mut Framebuffer<f32>, exec: &Exec) {
        let Framebuffer { depth, weight, normal, color, .. } = target;
        let mut rows: Vec<_> = (0..)
            .zip(depth.rows_mut().zip(weight.rows_mut()))
            .map(|(y, (depth, weight))| (y, depth, weight, None, None))
            .collect();
        for (row, normal) in rows.iter_mut().zip(normal.iter_mut().flat_map(Plane::rows_mut)) {
            row.3 = Some(normal);
        }
        for (row, color) in rows.iter_mut().zip(color.iter_mut().flat_map(Plane::rows_mut)) {
            row.4 = Some(color);
        }
        exec.ordered(rows, |(y, depth, weight, mut normal, mut color)| {
            for x in 0..weight.len() {
                if weight[x] > 0.0 {
                    continue;
                }
                let shown = self.surface(x as u32, y);
                (depth[x], weight[x]) = (shown.depth, shown.weight);
                normal.iter_mut().for_each(|row| row[x] = shown.normal);
                color.iter_mut().for_each(|row| row[x] = shown.color);
            }
        });
    }
}
