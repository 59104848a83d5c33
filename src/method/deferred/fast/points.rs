//! Pass 2: test every surfel as a point against the depth of pass 1.
//!
//! The surfels are divided into as many shares as there are threads, up to [`SHARES`], in the order
//! of their ids. Each share has its own centres, and they are joined. The least depth of a pixel and,
//! if depths are equal, the lowest id are the same however the surfels are divided. For most surfels
//! the position alone, and for many a box around them, shows that they are not kept. Only the normals
//! of the others are read and turned.

use super::super::Settings;
use super::super::part::{Range, Whole};
use super::super::queries::{Limits, Queries};
use crate::composite::decide;
use crate::frame::Exec;
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::projection::surfels::PointProjector;
use crate::number::lanes::{LANES, Lanes, each, mask, select, vectorized};
use crate::number::{Real, Vector2, Vector3};
use crate::splat::View;
use glam::Vec3;

/// The maximum number of shares: each takes a picture, 4 bytes a pixel.
const SHARES: usize = 8;

/// B(i), ascending.
pub(super) fn selected(
    job: &Job<'_>,
    settings: &Settings,
    whole: &Whole<'_>,
    limits: &Limits,
    memory: &mut Vec<Centres>,
) -> Vec<u64> {
    spend(Work::Indices);
    let points = PointProjector::new(View::new(job.camera), settings.splats.cull);
    let queries = Queries::new(job.camera, limits);
    let shares = whole.shares(job.exec.threads().min(SHARES));
    let pixels = limits.values.len();
    memory.resize_with(shares.len(), Centres::default);
    let jobs = shares.into_iter().zip(&mut *memory).collect();
    job.exec.ordered(jobs, |(ranges, centres): (Vec<Range<'_>>, &mut Centres)| {
        centres.clear(pixels);
        for range in &ranges {
            for part in range.parts(&queries) {
                draw(&points, &part, limits, centres);
            }
        }
    });
    let Some((all, later)) = memory.split_first_mut() else { return Vec::new() };
    // Ids of a later share are higher, so the earlier share wins a tie.
    for &centre in later.iter().flat_map(|share| &share.kept) {
        if decide::before(centre.depth, all.depth(centre.pixel)) {
            all.put(centre);
        }
    }
    ascending(all.kept.iter().map(|centre| centre.id).collect(), pixels, job.exec)
}

/// The centre of a surfel, and the pixel that keeps it.
#[derive(Clone, Copy, Debug)]
struct Centre {
    depth: f32,
    pixel: u32,
    id: u64,
}

/// The centres that pixels keep, one at most each. They are not a picture of centres, because most
/// pixels of a large picture keep none, and memory costs time when it is touched. A session keeps them
/// for its next frame: to get the memory anew took 6 % of a frame of 285,000 surfels.
#[derive(Debug, Default)]
pub struct Centres {
    /// Of each pixel, 1 more than the place of its centre; 0 if it has none.
    places: Vec<u32>,
    kept: Vec<Centre>,
}

impl Centres {
    /// Empties a picture of so many pixels.
    fn clear(&mut self, pixels: usize) {
        self.places.clear();
        self.places.resize(pixels, 0);
        self.kept.clear();
    }

    /// The depth of the centre that a pixel keeps; +inf if it keeps none.
    #[inline]
    fn depth(&self, pixel: u32) -> f32 {
        let place = self.places[pixel as usize] as usize;
        if place == 0 { f32::INFINITY } else { self.kept[place - 1].depth }
    }

    /// Replaces the centre that a pixel keeps.
    #[inline]
    fn put(&mut self, centre: Centre) {
        let place = &mut self.places[centre.pixel as usize];
        if *place == 0 {
            self.kept.push(centre);
            *place = self.kept.len() as u32;
        } else {
            self.kept[*place as usize - 1] = centre;
        }
    }
}

/// Ids, each of which is there once, in ascending order.
fn ascending(mut ids: Vec<u64>, pixels: usize, exec: &Exec) -> Vec<u64> {
    let end = ids.iter().max().map_or(0, |last| last + 1);
    if end > 64 * pixels as u64 {
        exec.sort(&mut ids);
        return ids;
    }
    // A bit for each id, in no more words than there are pixels.
    let mut words = vec![0_u64; end.div_ceil(64) as usize];
    ids.iter().for_each(|id| words[(id / 64) as usize] |= 1 << (id % 64));
    let mut sorted = Vec::with_capacity(ids.len());
    for (first, mut word) in (0..).step_by(64).zip(words) {
        while word != 0 {
            sorted.push(first + u64::from(word.trailing_zeros()));
            word &= word - 1;
        }
    }
    sorted
}

/// Draws neighbouring surfels of an object, in ascending order.
fn draw(points: &PointProjector<f32>, range: &Range<'_>, limits: &Limits, centres: &mut Centres) {
    let end = range.surfels.end;
    for first in range.surfels.clone().step_by(LANES) {
        let mut places = place(points, range, first, limits);
        if end - first < LANES {
            places.pass &= (1 << (end - first)) - 1;
        }
        while places.pass != 0 {
            let lane = places.pass.trailing_zeros() as usize;
            places.pass &= places.pass - 1;
            let (depth, pixel) = (places.t[lane], places.pixel[lane]);
            if decide::before(depth, centres.depth(pixel))
                && range.draws(first + lane)
                && faces(
                    points,
                    [places.ray[0][lane], places.ray[1][lane]],
                    range.normal(first + lane),
                )
            {
                centres.put(Centre { depth, pixel, id: range.id(first + lane) });
            }
        }
    }
}

/// The depths of points, and their pixels.
struct Places {
    t: Lanes,
    /// x/t and y/t in view space, or x and y.
    ray: [Lanes; 2],
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
        let world = range.positions(first);
        let (mut x, mut y, mut t) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let mut ray = [[0.0; LANES]; 2];
        for i in 0..LANES {
            let position = Vector3::new(world[0][i], world[1][i], world[2][i]);
            let placed = points.place(points.view.point(position));
            // Adding 0 turns -0 into +0.
            (x[i], y[i], t[i]) = (placed.center.x, placed.center.y, placed.t + 0.0);
            (ray[0][i], ray[1][i]) = (placed.p.x * placed.m, placed.p.y * placed.m);
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
        Places { t, ray, pixel, pass }
    }
);

/// Whether a surfel that is in the picture is drawn: g is finite and, with culling, < 0.
fn faces(points: &PointProjector<f32>, [x, y]: [f32; 2], normal: Vec3) -> bool {
    let n = points.view.direction(Vector3::from_glam(normal));
    let g = points.facing_along(Vector2::new(x, y), n);
    g.is_finite() && !(points.cull && g >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn ids_ascend_with_bits_and_by_sorting(
            ids in prop::collection::hash_set(0..20_000_u64, 0..400),
        ) {
            let ids: Vec<u64> = ids.into_iter().collect();
            let mut sorted = ids.clone();
            sorted.sort_unstable();
            for pixels in [0, 300, 313] {
                prop_assert_eq!(&ascending(ids.clone(), pixels, &Exec::sequential()), &sorted);
            }
        }
    }
}
