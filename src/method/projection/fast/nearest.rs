//! The nearest point of each pixel, and its sample.

use super::points::{CHUNK, Points, depth};
use super::{LANES, Lanes};
use crate::frame::{Exec, NO_ID};
use crate::method::projection::surfel::Lens;
use crate::number::Real;
use crate::splat::ellipse;

/// No point: more than any depth and slot.
const NONE: u64 = u64::MAX;

/// The nearest points of a row of pixels.
pub(in crate::method) struct Nearest<'a, const CARRIED: usize> {
    points: &'a Points<CARRIED>,
    lens: &'a Lens<f32>,
    /// The order of the depth in the upper half, and the slot: the less, the nearer, and of two
    /// surfels equally near the one of the lower index, as the order of slots in a pixel is that of the surfels.
    kept: &'a [u64],
}

impl<const CARRIED: usize> Points<CARRIED> {
    /// Calls `draw` for every row of pixels with what the row is drawn into.
    pub(in crate::method) fn each_row<T: Send>(
        &self,
        lens: &Lens<f32>,
        rows: impl Iterator<Item = T>,
        exec: &Exec,
        draw: impl Fn(&Nearest<'_, CARRIED>, T) + Sync + Send,
    ) {
        let width = lens.view.width.to_pixel() as usize;
        exec.groups(rows, self.rows(), |first, rows| {
            let mut kept = vec![NONE; rows.len() * width];
            for slots in self.slots(first / self.rows()) {
                for (slot, key) in slots.clone().zip(&self.keys[slots]) {
                    let kept = &mut kept[key.pixel()];
                    *kept = (*kept).min(u64::from(key.order) << 32 | slot as u64);
                }
            }
            for (kept, target) in kept.chunks(width).zip(rows) {
                draw(&Nearest { points: self, lens, kept }, target);
            }
        });
    }
}

/// The samples of [`LANES`] pixels in a row.
#[derive(Clone, Copy, Debug)]
pub(in crate::method) struct SampleLanes {
    /// +inf where there is none; the other numbers mean nothing there.
    pub(in crate::method) depth: Lanes,
    /// [`NO_ID`] where there is none; only with the centre.
    pub(in crate::method) id: [u32; LANES],
    pub(in crate::method) radius: Lanes,
    pub(in crate::method) extent: Lanes,
    /// If it was carried.
    pub(in crate::method) centre: [Lanes; 2],
    pub(in crate::method) normal: [Lanes; 3],
    /// If the scene has colours.
    pub(in crate::method) color: [Lanes; 3],
}

impl<const CARRIED: usize> Nearest<'_, CARRIED> {
    /// The samples of the pixels from column x on; none if there is no point.
    #[inline(always)]
    pub(in crate::method) fn take(&self, x: usize) -> Option<SampleLanes> {
        let Self { points, lens, kept } = self;
        let count = LANES.min(kept.len() - x);
        let kept = {
            let mut own = [NONE; LANES];
            own[..count].copy_from_slice(&kept[x..x + count]);
            own
        };
        if kept.iter().fold(NONE, |all, kept| all & kept) == NONE {
            return None;
        }
        // A pixel without a point reads slot 0, which means nothing: loops of loads without a branch
        // wait for memory together.
        let (mut slot, mut carried) = ([0; LANES], [[0.0; CARRIED]; LANES]);
        for i in 0..LANES {
            slot[i] = if kept[i] == NONE { 0 } else { kept[i] as u32 as usize };
            carried[i] = points.carried[slot[i]];
        }
        let mut column = [[0.0; LANES]; CARRIED];
        for i in 0..LANES {
            for k in 0..CARRIED {
                column[k][i] = carried[i][k];
            }
        }
        let radius = column[3];
        let (mut depths, mut extent) = ([f32::INFINITY; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let t = depth((kept[i] >> 32) as u32);
            depths[i] = if kept[i] == NONE { f32::INFINITY } else { t };
            extent[i] = ellipse::radius_in_pixels(radius[i], lens.focal, lens.scale(t));
        }
        let mut sample = SampleLanes {
            depth: depths,
            id: [NO_ID; LANES],
            radius,
            extent,
            centre: [[0.0; LANES]; 2],
            normal: [column[0], column[1], column[2]],
            color: [[0.0; LANES]; 3],
        };
        if CARRIED == 6 {
            sample.centre = [column[4], column[5]];
            for i in 0..LANES {
                // A slot and its surfel are of the same chunk.
                let id = (slot[i] - slot[i] % CHUNK) as u32 + points.keys[slot[i]].surfel();
                sample.id[i] = if kept[i] == NONE { NO_ID } else { id };
            }
        }
        if !points.color.is_empty() {
            for i in 0..LANES {
                let own = points.color[slot[i]];
                let [r, g, b] = &mut sample.color;
                (r[i], g[i], b[i]) = (own.x, own.y, own.z);
            }
        }
        Some(sample)
    }
}
