//! The projection of surfels in `f32` at the speed of memory: the samples of [`super::plain`], bit for bit.
//!
//! 1. **Points.** Every surfel that is seen becomes a [`Point`]: pixel, depth, id. Positions and normals are read once,
//!    [`LANES`] at a time, without a branch a surfel. A chunk of surfels sorts its points by **bands** of rows.
//! 2. **Nearest.** Each band keeps the nearest point of each pixel, in ascending id, in memory that fits the
//!    cache; one thread owns it.
//! 3. **Samples.** Each pixel that has a point computes the sample of that surfel, so that radii and colours are read
//!    for those alone.

use super::surfel::Lens;
use super::{Has, Sample};
use crate::frame::{Exec, NO_ID};
use crate::number::{Real, Vector3};
use crate::scene::{Scene, Surfels};
use crate::splat::{Fate, Tally, View};
use multiversion::multiversion;
use std::ops::Range;

/// Surfels or pixels that are treated side by side.
pub(in crate::method) const LANES: usize = 16;

/// One number for each of [`LANES`].
pub(in crate::method) type Lanes = [f32; LANES];

/// Surfels of a chunk.
const CHUNK: usize = 16_384;
/// Pixels of a band, about: with depth and id they fit a second-level cache.
const BAND: usize = 32_768;

/// A surfel that is seen, as one pixel.
#[derive(Clone, Copy, Debug, Default)]
struct Point {
    /// The pixel, counted row by row.
    pixel: u32,
    depth: f32,
    id: u32,
}

/// The points of a chunk of surfels, by bands, ascending in each.
#[derive(Debug, Default)]
struct Chunk {
    points: Vec<Point>,
    /// Where each band starts, and where the last ends.
    starts: Vec<u32>,
}

/// The points of a picture; the memory can be used for many pictures.
#[derive(Debug, Default)]
pub(in crate::method) struct Points {
    chunks: Vec<Chunk>,
    /// Rows of a band.
    rows: usize,
}

/// The nearest points of a row of pixels.
pub(in crate::method) struct Nearest<'a> {
    depth: &'a [f32],
    id: &'a [u32],
}

impl Points {
    /// Finds and sorts the points of a scene's surfels.
    pub(in crate::method) fn find(
        &mut self,
        surfels: &Surfels,
        lens: &Lens<f32>,
        exec: &Exec,
    ) -> Tally {
        let [width, height] = [lens.view.width, lens.view.height].map(|n| n.to_pixel() as usize);
        self.rows = (BAND / width).max(1);
        let bands = height.div_ceil(self.rows);
        let band = self.rows * width;
        let n = surfels.len();
        self.chunks.resize_with(n.div_ceil(CHUNK), Chunk::default);
        let ranges = (0..n).step_by(CHUNK).map(|first| first..n.min(first + CHUNK));
        let jobs = self.chunks.iter_mut().zip(ranges).collect();
        let tallies = exec.ordered(jobs, |(chunk, range): (&mut Chunk, Range<usize>)| {
            chunk.fill(surfels, lens, range, (band, bands))
        });
        tallies.iter().fold(Tally::default(), |sum, tally| sum.plus(tally))
    }

    /// Calls `draw` for every row of pixels with what the rows are drawn into, in order.
    pub(in crate::method) fn each_row<T: Send>(
        &self,
        width: usize,
        rows: impl Iterator<Item = T>,
        exec: &Exec,
        draw: impl Fn(usize, &Nearest<'_>, T) + Sync + Send,
    ) {
        let mut rows = rows.enumerate();
        let bands = std::iter::from_fn(|| {
            let band: Vec<_> = rows.by_ref().take(self.rows).collect();
            (!band.is_empty()).then_some(band)
        });
        exec.ordered(bands.enumerate().collect(), |(band, rows): (usize, Vec<(usize, T)>)| {
            let pixels = rows.len() * width;
            let mut nearest = (vec![f32::INFINITY; pixels], vec![NO_ID; pixels]);
            let first = band * self.rows * width;
            for Chunk { points, starts } in &self.chunks {
                let own = starts[band] as usize..starts[band + 1] as usize;
                for point in &points[own] {
                    let pixel = point.pixel as usize - first;
                    if point.depth < nearest.0[pixel] {
                        (nearest.0[pixel], nearest.1[pixel]) = (point.depth, point.id);
                    }
                }
            }
            for (row, (y, target)) in rows.into_iter().enumerate() {
                let pixels = row * width..(row + 1) * width;
                let (depth, id) = (&nearest.0[pixels.clone()], &nearest.1[pixels]);
                draw(y, &Nearest { depth, id }, target);
            }
        });
    }
}

impl Chunk {
    /// The points of a range of surfels, sorted into bands of `band` pixels.
    fn fill(
        &mut self,
        surfels: &Surfels,
        lens: &Lens<f32>,
        range: Range<usize>,
        (band, bands): (usize, usize),
    ) -> Tally {
        let mut found = vec![Point::default(); CHUNK + LANES];
        let (count, tally) = points(surfels, lens, range, &mut found);
        let found = &found[..count];
        // Counting sort: count, one place late, so that the sums become starts.
        self.starts.clear();
        self.starts.resize(bands + 1, 0);
        let of = |point: &Point| point.pixel as usize / band;
        for point in found {
            self.starts[of(point) + 1] += 1;
        }
        for band in 1..=bands {
            self.starts[band] += self.starts[band - 1];
        }
        self.points.clear();
        self.points.resize(count, Point::default());
        let mut next = self.starts.clone();
        for point in found {
            let next = &mut next[of(point)];
            self.points[*next as usize] = *point;
            *next += 1;
        }
        tally
    }
}

/// The points of a range of surfels, ascending, at the start of `found`, and how many.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn points(
    surfels: &Surfels,
    lens: &Lens<f32>,
    range: Range<usize>,
    found: &mut [Point],
) -> (usize, Tally) {
    let lens = *lens;
    let width = lens.view.width.to_pixel();
    let mut counts = [[0_u32; LANES]; 5];
    let mut count = 0;
    for first in range.clone().step_by(LANES) {
        // The last lanes of a range may lie beyond it: they are the last surfel again, and not counted.
        let lanes = LANES.min(range.end - first);
        let (positions, normals) = (surfels.position(), surfels.normal());
        let (mut p, mut n) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        if lanes == LANES {
            let (positions, normals) =
                (&positions[first..first + LANES], &normals[first..first + LANES]);
            for i in 0..LANES {
                [p[0][i], p[1][i], p[2][i]] = positions[i].to_array();
                [n[0][i], n[1][i], n[2][i]] = normals[i].to_array();
            }
        } else {
            for i in 0..LANES {
                let at = first + i.min(lanes - 1);
                [p[0][i], p[1][i], p[2][i]] = positions[at].to_array();
                [n[0][i], n[1][i], n[2][i]] = normals[at].to_array();
            }
        }
        let (mut fates, mut pixels) = ([0_u32; LANES], [0_u32; LANES]);
        let mut depths = [0.0; LANES];
        for i in 0..LANES {
            let n = lens.view.direction(Vector3::new(n[0][i], n[1][i], n[2][i]));
            let (placed, _, fate) = lens.fate(Vector3::new(p[0][i], p[1][i], p[2][i]), n);
            fates[i] = if i < lanes { fate as u32 } else { u32::MAX };
            // Pictures have at most 2^28 pixels.
            pixels[i] = placed.centre.y.to_pixel() * width + placed.centre.x.to_pixel();
            depths[i] = placed.t + 0.0;
        }
        for (fate, counts) in counts.iter_mut().enumerate() {
            for i in 0..LANES {
                counts[i] += u32::from(fates[i] == fate as u32);
            }
        }
        // Written whether it is seen or not, and kept only if it is: no branch to mispredict.
        let place = &mut found[count..count + LANES];
        let mut kept = 0;
        for i in 0..LANES {
            place[kept] = Point { pixel: pixels[i], depth: depths[i], id: (first + i) as u32 };
            kept += usize::from(fates[i] == Fate::Visible as u32);
        }
        count += kept;
    }
    let sum = |fate: Fate| counts[fate as usize].iter().map(|&n| u64::from(n)).sum();
    let tally = Tally {
        visible: sum(Fate::Visible),
        behind: sum(Fate::Behind),
        degenerate: sum(Fate::Degenerate),
        back_facing: sum(Fate::BackFacing),
        outside: sum(Fate::Outside),
    };
    (count, tally)
}

/// The samples of [`LANES`] pixels in a row.
#[derive(Clone, Copy, Debug)]
pub(in crate::method) struct SampleLanes {
    /// [`NO_ID`] where there is none; numbers mean nothing there, but the depth is +inf.
    pub(in crate::method) id: [u32; LANES],
    pub(in crate::method) depth: Lanes,
    pub(in crate::method) radius: Lanes,
    pub(in crate::method) extent: Lanes,
    pub(in crate::method) centre: [Lanes; 2],
    pub(in crate::method) normal: [Lanes; 3],
    pub(in crate::method) color: [Lanes; 3],
}

/// What the samples of a picture share.
#[derive(Clone, Copy, Debug)]
pub(in crate::method) struct Sampling<'a> {
    pub(in crate::method) scene: &'a Scene,
    pub(in crate::method) lens: Lens<f32>,
    pub(in crate::method) has: Has,
    /// Whether centres are wanted; else positions are read only if both sides are seen.
    pub(in crate::method) place: bool,
}

impl<'a> Sampling<'a> {
    pub(in crate::method) fn new(
        scene: &'a Scene,
        view: View<f32>,
        (cull, place): (bool, bool),
    ) -> Self {
        Self { scene, lens: Lens::new(view, cull), has: Has::of(scene), place }
    }

    /// The samples of pixels from column x of a row on; none if there is no point.
    #[inline(always)]
    pub(in crate::method) fn take(&self, nearest: &Nearest<'_>, x: usize) -> Option<SampleLanes> {
        let count = LANES.min(nearest.id.len() - x);
        let mut id = [NO_ID; LANES];
        let mut depth = [f32::INFINITY; LANES];
        id[..count].copy_from_slice(&nearest.id[x..x + count]);
        depth[..count].copy_from_slice(&nearest.depth[x..x + count]);
        if id.iter().all(|&id| id == NO_ID) {
            return None;
        }
        let surfels = &self.scene.surfels;
        let placed = self.place || !self.lens.cull;
        let (mut p, mut n, mut color) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        let mut radius = [0.0; LANES];
        for i in 0..LANES {
            if id[i] == NO_ID {
                continue;
            }
            let at = id[i] as usize;
            if placed {
                [p[0][i], p[1][i], p[2][i]] = surfels.position()[at].to_array();
            }
            radius[i] = surfels.radius()[at];
            [n[0][i], n[1][i], n[2][i]] = surfels.normal()[at].to_array();
            if self.has.color {
                let own = surfels.color().map_or(self.scene.material.color, |color| color[at]);
                [color[0][i], color[1][i], color[2][i]] = own.to_array();
            }
        }
        let mut extent = [0.0; LANES];
        let mut centre = [[0.0; LANES]; 2];
        let mut normal = [[0.0; LANES]; 3];
        for i in 0..LANES {
            let n = self.lens.view.direction(Vector3::new(n[0][i], n[1][i], n[2][i]));
            let position = self.lens.view.point(Vector3::new(p[0][i], p[1][i], p[2][i]));
            // The depth is known even where the position is not.
            let whole = self.lens.place(Vector3::new(position.x, position.y, -depth[i]));
            let g = if placed { self.lens.facing(&whole, n) } else { -1.0 };
            let sample: Sample<f32> = self.lens.sample(&whole, (n, g), radius[i], (0, [0.0; 3]));
            extent[i] = sample.extent;
            (centre[0][i], centre[1][i]) = (sample.centre.x, sample.centre.y);
            normal[0][i] = sample.normal.x;
            normal[1][i] = sample.normal.y;
            normal[2][i] = sample.normal.z;
        }
        Some(SampleLanes { id, depth, radius, extent, centre, normal, color })
    }
}

/// Every second of twice [`LANES`] values of a row from an index on: the even and the odd ones.
#[inline(always)]
pub(in crate::method) fn halves<T: Copy + Default>(row: &[T], at: usize) -> [[T; LANES]; 2] {
    let mut pairs = [T::default(); 2 * LANES];
    pairs.copy_from_slice(&row[at..at + 2 * LANES]);
    let (mut even, mut odd) = ([T::default(); LANES], [T::default(); LANES]);
    for i in 0..LANES {
        even[i] = pairs[2 * i];
        odd[i] = pairs[2 * i + 1];
    }
    [even, odd]
}
