//! Compute prefiltered colours from the colours of finer neighbours in the same model \[GBP04,
//! 4.4\]. A mesh with a texture gets its prefiltered colours from the texture, by
//! [`crate::source::derive`].
//!
//! The colour of level k of a surfel is a mean over everything within R = 2^k s of its centre. s is
//! its radius, or sqrt(|U x V|) for an ellipse with the half axes U and V. There may be thousands
//! of surfels around it, so they are not taken one by one. They are taken as *samples*: the surfels
//! of one cell of a grid that face one way. All in f64, from the `f32` numbers of the surfels, each
//! operation rounded in the order written.
//!
//! **Grid.** With 2^e <= R < 2^(e+1), the side of a cell is 2^(e-2): a cell is a quarter of R at
//! most, and more than an eighth. The cell of a position is floor(x / side) for each coordinate; 0
//! and -0 are one number. A grid depends on e alone, so surfels of all sizes and levels share it.
//!
//! **Samples.** The side of a surfel is the axis along which its normal is longest in magnitude,
//! among equal ones the first, with a sign: minus if the normal points backwards along the axis.
//! The order of sides is +x, -x, +y, -y, +z, -z. A sample is made of the surfels of one cell and
//! one side, in ascending order, all sums from 0. With the area a = s s, the position p, the normal
//! n and the colour c of each surfel,
//!
//! ```text
//!   A = sum of a      P = (sum of p a) / A, rounded to f32      N = sum of n a      C = (sum of c a) / A
//! ```
//!
//! Samples are ordered by their cells, by x, then y, then z, and then by their sides.
//!
//! **Mean.** d is the difference of P and the surfel's position, n the surfel's normal, and q = d.d
//! / (R R). The sums go over all samples with d.d < R R and N . n > 0, in their order:
//!
//! ```text
//!   w      = A ((1 - q) (1 - q))
//!   colour = (sum of C w) / (sum of w), rounded to f32 once, plus 0
//! ```
//!
//! Where the sum of w is not > 0, the colour is the colour of the level before. x.y is (x.x y.x +
//! x.y y.y) + x.z y.z. A model of one colour has that colour at every level, bit for bit.
//!
//! # What the paper leaves open, decided here
//!
//! - \[GBP04\] says that samples are prefiltered, but not how. Pfister et al. 2000 (*Surfels*) do
//!   it with Gaussians, on the texture that the surfels were sampled from. (1 - q)^2 is close to a
//!   Gaussian of variance R R / 8 along each axis, ends at R, and needs only arithmetic.
//! - Neighbours count by their area, because surfels are small where they are dense.
//! - Of two sheets back to back, only the sheet that faces the same way counts. Sheets that face
//!   the same way and are closer than R do mix.
//! - Cells instead of surfels: a level costs about the same whatever it covers. Cells of half the
//!   side take three times as long; the flicker of a sphere (bench `deferred`) is the same with
//!   them to 0.0001.

use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::point_tree::{Entry, PointTree, Search};
use crate::memory;
use crate::number::MapInline;
use crate::progress::Progress;
use crate::scene::mipmap::check_levels;
use crate::scene::{Mipmap, Surfels};
use glam::{DVec3, Vec3};

/// How much smaller than R cells are, as an exponent of 2.
const FINER: i32 = 2;
/// How many bytes a surfel takes while the colours are made, without the result.
const BYTES_A_SURFEL: u64 = 384;
/// Ranges of samples up to this length are searched one by one.
const LEAF: usize = 8;
/// How many surfels one job has, and how many come between two reports of progress.
const JOB: usize = 1 << 8;
const BATCH: usize = 1 << 16;

/// Makes levels 1 to `levels` for surfels with colours. `progress` receives the name of the step,
/// how many colours are done, and how many there are.
///
/// # Errors
/// [`Error::Invalid`] if the surfels have no colours, as [`Mipmap::new`], or if the process may not
/// hold the colours.
pub fn build(
    surfels: &Surfels,
    levels: usize,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Mipmap> {
    check_levels(levels)?;
    let colors = colors(surfels)?;
    let count = surfels.len();
    let bytes = count as u64 * (BYTES_A_SURFEL + 12 * levels as u64);
    memory::ask(bytes, || format!("mipmaps of {count} surfels"))?;
    let all = count as u64 * levels as u64;
    let mut made = vec![Vec3::ZERO; count * levels];
    let exponents: Vec<i32> = (0..count).map(|i| exponent(size(surfels, i))).collect();
    let [least, most] = ends(&exponents);
    let mut done = 0;
    // A level of a surfel comes after the level before, because its R is twice as large.
    for e in least + 1..=most + levels as i32 {
        let level = |i: usize| usize::try_from(e - exponents[i]).ok();
        let wanted: Vec<(usize, usize)> = (0..count)
            .filter_map(|i| level(i).filter(|k| (1..=levels).contains(k)).map(|k| (i, k)))
            .collect();
        if wanted.is_empty() {
            continue;
        }
        let samples = Samples::new(surfels, colors, e, exec);
        for batch in wanted.chunks(BATCH) {
            progress("mipmaps", done, all);
            let means = exec.ordered(batch.chunks(JOB).collect(), |some| samples.means(some));
            for (&(i, k), mean) in batch.iter().zip(means.into_iter().flatten()) {
                let before = if k == 1 { colors[i] } else { made[i * levels + k - 2] };
                made[i * levels + k - 1] = mean.unwrap_or(before);
            }
            done += batch.len() as u64;
        }
    }
    progress("mipmaps", all, all);
    Mipmap::new(levels, made)
}

fn colors(surfels: &Surfels) -> Result<&[Vec3]> {
    surfels.color().ok_or_else(|| {
        Error::Invalid("mipmaps need colours, but the points have none; remove the mipmaps".into())
    })
}

/// The least and the greatest exponent; without exponents (0, -1024), an empty range.
fn ends(exponents: &[i32]) -> [i32; 2] {
    let least = exponents.iter().copied().min().unwrap_or(0);
    let most = exponents.iter().copied().max().unwrap_or(-1024);
    [least, most]
}

/// s: the size of a surfel.
fn size(surfels: &Surfels, i: usize) -> f64 {
    match surfels.tangents() {
        None => surfels.radius()[i].into(),
        Some(tangents) => {
            let [u, v] = tangents[i].map_inline(Vec3::as_dvec3);
            let across = u.cross(v);
            dot(across, across).sqrt().sqrt()
        }
    }
}

fn dot(a: DVec3, b: DVec3) -> f64 {
    (a.x * b.x + a.y * b.y) + a.z * b.z
}

/// The e with 2^e <= x < 2^(e+1), for a normal number > 0.
fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52) as i32 - 1023
}

/// 2^e, if that is a normal number.
fn power(e: i32) -> f64 {
    f64::from_bits(((e + 1023) as u64) << 52)
}

/// The sort key of a surfel: cell, side, index.
type Key = ([u64; 3], u8, u32);

/// The samples of one grid.
struct Samples<'a> {
    surfels: &'a Surfels,
    /// The positions P, for the search.
    tree: PointTree,
    all: Vec<Sample>,
}

/// The surfels of a cell that face one way.
struct Sample {
    position: DVec3,
    normal: DVec3,
    color: DVec3,
    area: f64,
}

impl<'a> Samples<'a> {
    fn new(surfels: &'a Surfels, colors: &[Vec3], e: i32, exec: &Exec) -> Self {
        let side = power(e - FINER);
        let mut keys: Vec<Key> = Vec::with_capacity(surfels.len());
        exec.extend(&mut keys, surfels.len(), |i| {
            let (position, normal) = (surfels.position()[i], surfels.normal()[i]);
            (cell(position, side), way(normal), i as u32)
        });
        exec.sort(&mut keys);
        let cells: Vec<&[Key]> = keys.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).collect();
        let mut all = Vec::with_capacity(cells.len());
        exec.extend(&mut all, cells.len(), |i| Sample::new(surfels, colors, cells[i]));
        let points: Vec<Vec3> =
            all.iter().map(|sample: &Sample| sample.position.as_vec3()).collect();
        Self { surfels, tree: PointTree::new(&points, LEAF, exec), all }
    }

    /// The means around some surfels at some levels; none where nothing has weight.
    fn means(&self, some: &[(usize, usize)]) -> Vec<Option<Vec3>> {
        let (entries, center) = (self.tree.entries(), DVec3::ZERO);
        let mut within = Within { entries, center, reach2: 0.0, found: Vec::new() };
        let mean = |&(i, k): &(usize, usize)| {
            let point = self.surfels.position()[i];
            let center = point.as_dvec3();
            let reach = power(k as i32) * size(self.surfels, i);
            let reach2 = reach * reach;
            (within.center, within.reach2) = (center, reach2);
            within.found.clear();
            self.tree.search(point, &mut within);
            within.found.sort_unstable();
            let near = within.found.iter().map(|&id| &self.all[id as usize]);
            mean(near, center, self.surfels.normal()[i].as_dvec3(), reach2)
        };
        some.iter().map(mean).collect()
    }
}

/// The search of all samples that are nearer than R.
struct Within<'a> {
    entries: &'a [Entry],
    center: DVec3,
    reach2: f64,
    found: Vec<u32>,
}

impl Search for Within<'_> {
    #[inline]
    fn look(&mut self, rank: usize) {
        let entry = &self.entries[rank];
        let d = entry.point.as_dvec3() - self.center;
        if dot(d, d) < self.reach2 {
            self.found.push(entry.id);
        }
    }

    #[inline]
    fn reaches(&self, offset: [f64; 3]) -> bool {
        let away = DVec3::from_array(offset);
        // The far half matters only if the plane is within R.
        dot(away, away) < self.reach2
    }
}

/// The mean of samples, in their order, around a surfel with this position and normal.
fn mean<'s>(
    samples: impl Iterator<Item = &'s Sample>,
    center: DVec3,
    normal: DVec3,
    reach2: f64,
) -> Option<Vec3> {
    let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
    for sample in samples {
        let d = sample.position - center;
        let d2 = dot(d, d);
        if !(d2 < reach2 && dot(sample.normal, normal) > 0.0) {
            continue;
        }
        let rest = 1.0 - d2 / reach2;
        let w = sample.area * (rest * rest);
        sum += sample.color * w;
        weight += w;
    }
    (weight > 0.0).then(|| (sum / weight).as_vec3() + Vec3::ZERO)
}

impl Sample {
    /// Makes the sample of the surfels of one cell that face one way.
    fn new(surfels: &Surfels, colors: &[Vec3], members: &[Key]) -> Self {
        let mut sum =
            Self { position: DVec3::ZERO, normal: DVec3::ZERO, color: DVec3::ZERO, area: 0.0 };
        for &(_, _, i) in members {
            let i = i as usize;
            let s = size(surfels, i);
            let area = s * s;
            sum.position += surfels.position()[i].as_dvec3() * area;
            sum.normal += surfels.normal()[i].as_dvec3() * area;
            sum.color += colors[i].as_dvec3() * area;
            sum.area += area;
        }
        sum.position = (sum.position / sum.area).as_vec3().as_dvec3();
        sum.color /= sum.area;
        sum
    }
}

/// The cell of a position, as integers in the order of the cell's coordinates.
fn cell(position: Vec3, side: f64) -> [u64; 3] {
    position.to_array().map_inline(|x| {
        let bits = ((f64::from(x) / side).floor() + 0.0).to_bits();
        // The bits of numbers >= 0 ascend with the numbers; the bits of negative numbers descend.
        if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
    })
}

/// The side of a surfel: 0 to 5.
fn way(normal: Vec3) -> u8 {
    let size = normal.abs();
    let mut axis = 0;
    for other in 1..3 {
        if size[other] > size[axis] {
            axis = other;
        }
    }
    2 * axis as u8 + u8::from(normal[axis] < 0.0)
}

#[cfg(test)]
mod tests;
