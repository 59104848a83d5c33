//! Pass 2: test every surfel as a point against the depth of pass 1.
//!
//! The surfels are divided into as many shares as there are threads, up to [`SHARES`], in the order
//! of their ids. Each share has its own picture, and the pictures are joined. The least depth of a
//! pixel and, if depths are equal, the lowest id are the same however the surfels are divided. For
//! most surfels the position alone, and for many a box around them, shows that they are not kept.
//! Only the normals of the others are read and turned.

use super::super::Settings;
use super::super::indices::Kept;
use super::super::part::{Range, Whole};
use super::super::queries::{Limits, Queries};
use super::super::visibility::NONE;
use super::PIXELS;
use crate::composite::decide;
use crate::frame::Exec;
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::projection::surfels::{PlacedPoint, PointProjector};
use crate::number::lanes::{LANES, Lanes, each, mask, select, vectorized};
use crate::number::{Real, Vector3};
use crate::splat::View;

/// The maximum number of shares: each takes a picture, 16 bytes a pixel.
const SHARES: usize = 8;

/// B(i), ascending.
pub(super) fn selected(
    job: &Job<'_>,
    settings: &Settings,
    whole: &Whole<'_>,
    limits: &Limits,
) -> Vec<u64> {
    spend(Work::Indices);
    let points = PointProjector::new(View::new(job.camera), settings.splats.cull);
    let queries = Queries::new(job.camera, limits);
    let shares = whole.shares(job.exec.threads().min(SHARES));
    let pictures = job.exec.ordered(shares, |ranges| {
        let mut kept = vec![Kept::EMPTY; limits.values.len()];
        for range in &ranges {
            for part in range.parts(&queries) {
                draw(&points, &part, limits, &mut kept);
            }
        }
        kept
    });
    let starts = (0..limits.values.len()).step_by(PIXELS).collect();
    let parts = job.exec.ordered(starts, |start: usize| {
        let pixels = start..limits.values.len().min(start + PIXELS);
        let nearest = pixels.map(|pixel| {
            let kept = pictures.iter().map(|picture| picture[pixel]);
            // Ids of a later share are higher, so the earlier share wins a tie.
            let nearer = |kept: Kept<f32>, later: Kept<f32>| {
                if decide::before(later.depth, kept.depth) { later } else { kept }
            };
            kept.reduce(nearer).map_or(NONE, |kept| kept.id)
        });
        nearest.filter(|&id| id != NONE).collect::<Vec<_>>()
    });
    ascending(parts, limits.values.len(), job.exec)
}

/// Ids, each of which is there once, in ascending order.
fn ascending(parts: Vec<Vec<u64>>, pixels: usize, exec: &Exec) -> Vec<u64> {
    let ids = || parts.iter().flatten().copied();
    let end = ids().max().map_or(0, |last| last + 1);
    if end > 64 * pixels as u64 {
        let mut ids = parts.concat();
        exec.sort(&mut ids);
        return ids;
    }
    // A bit for each id, in no more words than there are pixels.
    let mut words = vec![0_u64; end.div_ceil(64) as usize];
    ids().for_each(|id| words[(id / 64) as usize] |= 1 << (id % 64));
    let mut sorted = Vec::with_capacity(parts.iter().map(Vec::len).sum());
    for (first, mut word) in (0..).step_by(64).zip(words) {
        while word != 0 {
            sorted.push(first + u64::from(word.trailing_zeros()));
            word &= word - 1;
        }
    }
    sorted
}

/// Draws neighbouring surfels of an object, in ascending order.
fn draw(points: &PointProjector<f32>, range: &Range<'_>, limits: &Limits, kept: &mut [Kept<f32>]) {
    let end = range.surfels.end;
    for first in range.surfels.clone().step_by(LANES) {
        let mut places = place(points, range, first, limits);
        if end - first < LANES {
            places.pass &= (1 << (end - first)) - 1;
        }
        while places.pass != 0 {
            let lane = places.pass.trailing_zeros() as usize;
            places.pass &= places.pass - 1;
            let (t, kept) = (places.t[lane], &mut kept[places.pixel[lane] as usize]);
            if decide::before(t, kept.depth)
                && range.draws(first + lane)
                && faces(points, range, first + lane)
            {
                *kept = Kept { depth: t, id: range.id(first + lane) };
            }
        }
    }
}

/// The depths of points, and their pixels.
struct Places {
    t: Lanes,
    pixel: [u32; LANES],
    /// A bit for each point that is in the picture, beyond the near plane and not hidden.
    pass: u32,
}

vectorized!(
    /// The places of [`LANES`] surfels from `first` on; beyond the last surfel, the place of the
    /// last.
    fn place(
        points: &PointProjector<f32>,
        range: &Range<'_>,
        first: usize,
        limits: &Limits,
    ) -> Places {
        let positions = range.positions(first);
        let world = range.moved(&positions);
        let (mut x, mut y, mut t) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let position = Vector3::new(world[0][i], world[1][i], world[2][i]);
            let placed = points.place(points.view.point(position));
            // Adding 0 turns -0 into +0.
            (x[i], y[i], t[i]) = (placed.center.x, placed.center.y, placed.t + 0.0);
        }
        let View { width, height, near, .. } = points.view;
        let inside = mask(|i| {
            let columns = (x[i] >= 0.0) & (x[i] < width);
            columns & (y[i] >= 0.0) & (y[i] < height) & (t[i] > near) & (t[i] < f32::INFINITY)
        });
        // Points outside read the limit of the pixel 0.
        let zero = [0.0; LANES];
        let (x, y) = (select(&inside, &x, &zero), select(&inside, &y, &zero));
        let pixel = each(|i| y[i].to_pixel() * limits.width + x[i].to_pixel());
        let limit = each(|i| limits.values[pixel[i] as usize]);
        let pass = mask(|i| decide::visible(t[i], limit[i]));
        let pass = (0..LANES).fold(0, |all, i| all | (pass[i] & inside[i] & 1) << i);
        Places { t, pixel, pass }
    }
);

/// Whether a surfel that is in the picture is drawn: g is finite and, with culling, < 0.
fn faces(points: &PointProjector<f32>, range: &Range<'_>, i: usize) -> bool {
    let (position, normal) = range.surfel(i);
    let placed: PlacedPoint<f32> = points.place(points.view.point(Vector3::from_glam(position)));
    let n = points.view.direction(Vector3::from_glam(normal));
    let g = points.facing(&placed, n);
    g.is_finite() && !(points.cull && g >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn ids_ascend_with_bits_and_by_sorting(
            ids in prop::collection::hash_set(0..20_000_u64, 0..400), parts in 1..9_usize,
        ) {
            let ids: Vec<u64> = ids.into_iter().collect();
            let mut sorted = ids.clone();
            sorted.sort_unstable();
            for pixels in [0, 300, 313] {
                let parts = ids.chunks(ids.len().div_ceil(parts).max(1)).map(<[u64]>::to_vec);
                prop_assert_eq!(&ascending(parts.collect(), pixels, &Exec::sequential()), &sorted);
            }
        }
    }
}
