//! Find the nearest point of each pixel, and its sample.

#![expect(
    clippy::needless_range_loop,
    reason = "a lane is an index into several arrays, and such a loop becomes vectors"
)]

use super::points::{CHUNK, Points, depth};
use crate::frame::{Exec, NO_ID};
use crate::method::clock::{Stopwatch, Work, spend};
use crate::method::projection::surfels::PointProjector;
use crate::number::lanes::{LANES, Lanes, each, put_vector, transposed, vector};
use crate::number::{MapInline, Real, Vector3};
use crate::scene::Surfels;
use crate::splat::ellipse;
use glam::Vec3;
use std::time::Duration;

/// No point: greater than any depth and slot.
const NONE: u64 = u64::MAX;

/// The nearest points of a row of pixels.
pub(crate) struct NearestPoints<'a> {
    points: &'a Points,
    surfels: &'a Surfels,
    lens: &'a PointProjector<f32>,
    /// The order of the depth in the upper half, and the slot: the less, the nearer. If two surfels
    /// are equally near, the lower index wins, because the slots of a pixel are in the order of the
    /// surfels.
    kept: &'a [u64],
}

/// The nearest points of a band of rows.
pub(crate) struct NearestBand<'a> {
    points: &'a Points,
    surfels: &'a Surfels,
    lens: &'a PointProjector<f32>,
    /// See [`NearestPoints::kept`], row by row.
    kept: Vec<u64>,
}

impl NearestBand<'_> {
    /// A row of pixels; `y` counts from the first row of the band.
    pub(crate) fn row(&self, y: usize) -> NearestPoints<'_> {
        let Self { points, surfels, lens, .. } = *self;
        let width = lens.view.width.to_pixel() as usize;
        NearestPoints { points, surfels, lens, kept: &self.kept[y * width..(y + 1) * width] }
    }
}

impl Points {
    /// Calls `draw` for every band, with the targets of its pairs of rows; the last row may be
    /// alone. A stopwatch starts with each band. Returns the times.
    pub(crate) fn each_band<T: Send>(
        &self,
        surfels: &Surfels,
        lens: &PointProjector<f32>,
        pairs: impl Iterator<Item = T>,
        exec: &Exec,
        draw: impl Fn(&NearestBand<'_>, Vec<T>, &mut Stopwatch<2>) + Sync + Send,
    ) -> Vec<[Duration; 2]> {
        let size = [lens.view.width, lens.view.height].map_inline(|n| n.to_pixel() as usize);
        exec.chunks(pairs, self.rows() / 2, |first, pairs| {
            let mut watch = Stopwatch::start();
            spend(Work::Project);
            let rows = self.rows().min(size[1] - 2 * first);
            let mut kept = vec![NONE; rows * size[0]];
            for slots in self.slots(2 * first / self.rows()) {
                for (slot, key) in slots.clone().zip(&self.keys[slots]) {
                    let kept = &mut kept[key.pixel()];
                    *kept = (*kept).min(u64::from(key.order) << 32 | slot as u64);
                }
            }
            draw(&NearestBand { points: self, surfels, lens, kept }, pairs, &mut watch);
            watch.times()
        })
    }
}

/// Rows in pairs, the last with nothing if it is alone.
pub(crate) fn pairs<T>(mut rows: impl Iterator<Item = T>) -> impl Iterator<Item = (T, Option<T>)> {
    std::iter::from_fn(move || Some((rows.next()?, rows.next())))
}

/// The values that the points of [`LANES`] pixels in a row carry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleLanes {
    /// +inf where there is none; the other numbers mean nothing there.
    pub(crate) depth: Lanes,
    pub(crate) radius: Lanes,
    pub(crate) extent: Lanes,
    pub(crate) normal: [Lanes; 3],
    slot: [usize; LANES],
}

impl NearestPoints<'_> {
    /// The samples of the pixels from column x on; none if there is no point.
    #[inline(always)]
    pub(crate) fn take(&self, x: usize) -> Option<SampleLanes> {
        // -- The keys of the points
        let mut kept = [NONE; LANES];
        for (lane, key) in kept.iter_mut().zip(&self.kept[x..]) {
            *lane = *key;
        }
        if kept.iter().fold(NONE, |all, kept| all & kept) == NONE {
            return None;
        }
        // -- The values that they carry
        // A pixel without a point reads slot 0, whose values are ignored, because loops of loads
        // without a branch wait for memory together.
        let slot = each(|i| if kept[i] == NONE { 0 } else { kept[i] as u32 as usize });
        let carried = each(|i| self.points.carried[slot[i]]);
        let [x, y, z, radius] = transposed(&carried);
        // -- The values that follow from the depth
        let (mut depths, mut extent) = ([f32::INFINITY; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let t = depth((kept[i] >> 32) as u32);
            depths[i] = if kept[i] == NONE { f32::INFINITY } else { t };
            let m = self.lens.scale(t);
            extent[i] = ellipse::radius_in_pixels(radius[i], self.lens.focal, m);
        }
        Some(SampleLanes { depth: depths, radius, extent, normal: [x, y, z], slot })
    }

    /// The surfels of samples; [`NO_ID`] where there is none.
    #[inline(always)]
    pub(crate) fn ids(&self, of: &SampleLanes) -> [u32; LANES] {
        each(|i| {
            // A slot and its surfel belong to the same chunk.
            let (chunk, slot) = (of.slot[i] - of.slot[i] % CHUNK, of.slot[i]);
            let own = chunk as u32 + self.points.keys[slot].surfel();
            if of.depth[i] < f32::INFINITY { own } else { NO_ID }
        })
    }

    /// The centres of these surfels in the picture; arbitrary where there is no surfel.
    #[inline(always)]
    pub(crate) fn centers(&self, id: &[u32; LANES]) -> [Lanes; 2] {
        let p = vectors(self.surfels.position(), id);
        let mut center = [[0.0; LANES]; 2];
        for i in 0..LANES {
            let placed = self.lens.place(self.lens.view.point(vector(&p, i)));
            (center[0][i], center[1][i]) = (placed.center.x, placed.center.y);
        }
        center
    }

    /// The colours of these surfels, if surfels have colours; arbitrary where there is no surfel.
    #[inline(always)]
    pub(crate) fn colors(&self, id: &[u32; LANES]) -> Option<[Lanes; 3]> {
        let colors = self.surfels.color()?;
        Some(vectors(colors, id))
    }
}

/// The vectors of these surfels; where there is no surfel, the first vector, which is ignored.
#[inline(always)]
fn vectors(of: &[Vec3], id: &[u32; LANES]) -> [Lanes; 3] {
    let mut vectors = [[0.0; LANES]; 3];
    for i in 0..LANES {
        let own = if id[i] == NO_ID { 0 } else { id[i] as usize };
        put_vector(&mut vectors, i, Vector3::from_glam(of[own]));
    }
    vectors
}
