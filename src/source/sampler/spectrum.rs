//! Measure at which frequencies points on a surface are even: their radial power spectrum.
//!
//! This is the spectrum of differences of points \[WW11\]. For points in the plane, the mean of
//! their periodogram over all directions is a sum over pairs of Bessel functions of their distance.
//! On a surface only near pairs lie in a plane. Therefore pairs count less the farther apart they
//! are, and not at all beyond the reach R. The contribution of a merely even density, the peak at
//! the frequency 0, is subtracted.
//!
//! Given are n >= 256 finite points. Squared distances are those of [`super::greedy`], in `f32`;
//! everything else is f64.
//!
//! ```text
//!   m     = min(n, 256) samples: the points floor(i n / m), i = 0, 1 ... m - 1
//!   R     = the square root of the lower median, over the samples, of the 128th least squared distance
//!           to another point
//!   bin   = floor(1024 d / R) of each ordered pair of two points, d < R the square root of their squared
//!           distance; c_b pairs are in bin b
//!   a_b   = pi (R / 1024)^2 (2 b + 1)                            the area of a bin's ring
//!   s_b   = (b + 1/2) / 1024,  v_b = (s^2 (1 - s^2))^2,  w_b = (1 - s^2)^2     of s = s_b
//!   rho   = (sum of c_b v_b) / (n sum of a_b v_b)                points an area, by pairs neither near nor far
//!   u     = sqrt(2 / (sqrt(3) rho))                              the unit of length
//!   e_b   = c_b / n - rho a_b                                    pairs more than an even density has
//!   S(f)  = 1 + sum over b of e_b w_b J0(2 pi f s_b R)           J0 is that of number::elementary
//!   power = S(k / (32 u)),  k = 8, 9 ... 128
//! ```
//!
//! Sums are in ascending b.
//!
//! u is the distance of neighbours if points of this density are packed as densely as possible in a
//! plane, in a lattice of triangles. Frequencies are in cycles a u; that lattice has its first peak
//! at 2 / sqrt(3) = 1.15.
//!
//! # How to read a spectrum
//!
//! - Random points have 1 at every frequency. Blue noise has almost nothing below a frequency of
//!   about 0.8, a peak near 1, and about 1 far above. A lattice has peaks, which are higher the
//!   further R reaches. Points chosen from a lattice or a raster have peaks at its frequencies too.
//! - Two frequencies can be told apart if they differ by about 1 / R: 0.17 cycles a u, with 128
//!   points within R. At frequencies near that, S is off because curvature and edges within R
//!   change rho, and can be below 0.
//! - The spectrum is valid where a surface is nearly flat within R, and has no edge there. A sphere
//!   need not be flat: a ball around one of its points cuts out an area of pi times the ball's
//!   squared radius.
//!
//! `Decided:` \[BJFM19, 1\] speaks of blue noise and measures no spectrum. \[WW11\] leave open how
//! pairs are weighted. Distances are straight, so that points on both sides of a wall thinner than
//! R belong to one surface here.
//!
//! \[WW11\] Wei, Wang: *Differential Domain Analysis for Non-uniform Sampling*, SIGGRAPH 2011.

use super::greedy::squared_distance;
use super::search::{LEAF, is_within};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::point_tree::{Entry, PointTree, Search};
use crate::memory;
use crate::number::elementary::bessel_j0;
use glam::Vec3;
use std::f64::consts::{PI, TAU};

/// The least number of points, and the most samples that determine the reach.
pub const FEWEST: usize = 256;
/// The median number of points within the reach.
const WITHIN: usize = 128;
const BINS: usize = 1024;
/// Frequencies in one cycle a unit, and the first and the last of all.
const STEPS: usize = 32;
const FIRST: usize = 8;
const LAST: usize = 128;
/// Points of one job.
const JOB: usize = 1024;
/// The most bytes that the tree takes for a point.
const BYTES_A_POINT: u64 = 40;

/// The spectrum, see the [module](self).
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// R, in world units.
    pub reach: f64,
    /// rho, in points a square world unit.
    pub density: f64,
    /// u, in world units.
    pub unit: f64,
    /// The power at each of [`frequencies`](Self::frequencies).
    pub power: Vec<f64>,
}

impl Spectrum {
    /// The frequencies of [`power`](Self::power), in cycles a unit: from 1/4 to 4.
    pub fn frequencies() -> impl Iterator<Item = f64> {
        (FIRST..=LAST).map(|k| k as f64 / STEPS as f64)
    }

    /// The mean power from 1/4 to 3/4 of a cycle a unit; for blue noise almost nothing.
    #[must_use]
    pub fn below(&self) -> f64 {
        let band = &self.power[..=3 * STEPS / 4 - FIRST];
        band.iter().sum::<f64>() / band.len() as f64
    }

    /// The frequency of the greatest power up to 2 cycles a unit, and this power; of equal powers
    /// the lowest frequency.
    #[must_use]
    pub fn peak(&self) -> [f64; 2] {
        let all = Self::frequencies().zip(&self.power).take_while(|(f, _)| *f <= 2.0);
        all.fold([0.0, f64::NEG_INFINITY], |a, (f, &p)| if p > a[1] { [f, p] } else { a })
    }
}

/// The spectrum of points, see the [module](self).
///
/// # Errors
/// [`Error::Invalid`] if there are fewer than [`FEWEST`] points, or 2^32 or more, or if a point is
/// not finite. Also if points are so close that R is 0, so far apart that R is infinite, or such
/// that no pair has a weight.
pub fn spectrum(points: &[Vec3], exec: &Exec) -> Result<Spectrum> {
    let (n, invalid) = (points.len(), |what| Err(Error::Invalid(what)));
    if n < FEWEST || u32::try_from(n).is_err() {
        return invalid(format!("a spectrum of {n} points; give {FEWEST} to 2^32 - 1"));
    }
    if let Some(at) = points.iter().position(|point| !point.is_finite()) {
        return invalid(format!(
            "point {at} is not finite, so it has no distance to others; remove it"
        ));
    }
    memory::ask(n as u64 * BYTES_A_POINT, || format!("a spectrum of {n} points"))?;
    let reach2 = reach2(points, exec);
    let reach = f64::from(reach2).sqrt();
    if !(reach > 0.0 && reach < f64::INFINITY) {
        return invalid(format!(
            "the spectrum needs points at distances above 0, but 129 are within {reach}"
        ));
    }
    let pairs = pairs(points, reach2, exec);
    let count = n as f64;
    let side = reach / BINS as f64;
    let area = |b: usize| PI * (side * side) * (2 * b + 1) as f64;
    let middle = |b: usize| (b as f64 + 0.5) / BINS as f64;
    // Leave out near pairs, which samplers keep apart, and far pairs, where a surface curves.
    let outer = |b| {
        let s2 = middle(b) * middle(b);
        (s2 * (1.0 - s2)) * (s2 * (1.0 - s2))
    };
    let weighed = pairs.iter().enumerate().fold(0.0, |sum, (b, &c)| sum + c as f64 * outer(b));
    let areas = (0..BINS).fold(0.0, |sum, b| sum + area(b) * outer(b));
    let density = weighed / (count * areas);
    if !(density > 0.0) {
        return invalid(
            "the spectrum needs points spread evenly, but these are in clusters far from each other"
                .into(),
        );
    }
    let unit = (2.0 / (3.0_f64.sqrt() * density)).sqrt();
    let excess = |(b, &pairs): (usize, &u64)| {
        let s = middle(b);
        let weight = (1.0 - s * s) * (1.0 - s * s);
        [s * reach, (pairs as f64 / count - density * area(b)) * weight]
    };
    let excess: Vec<[f64; 2]> = pairs.iter().enumerate().map(excess).collect();
    let power = |k| {
        let f = k as f64 / (STEPS as f64 * unit);
        excess.iter().fold(1.0, |sum, [d, e]| sum + e * bessel_j0(TAU * f * d))
    };
    Ok(Spectrum { reach, density, unit, power: (FIRST..=LAST).map(power).collect() })
}

/// R squared, from the least distances of samples to all points.
fn reach2(points: &[Vec3], exec: &Exec) -> f32 {
    let n = points.len();
    let samples = (0..FEWEST).map(|i| i * n / FEWEST).collect();
    let mut found = exec.ordered(samples, |own| {
        let mut all: Vec<f32> = points.iter().map(|p| squared_distance(points[own], *p)).collect();
        all.swap_remove(own);
        *all.select_nth_unstable_by(WITHIN - 1, f32::total_cmp).1
    });
    *found.select_nth_unstable_by((FEWEST - 1) / 2, f32::total_cmp).1
}

/// The number of ordered pairs in each bin.
fn pairs(points: &[Vec3], reach2: f32, exec: &Exec) -> Vec<u64> {
    let tree = PointTree::new(points, LEAF, exec);
    let scale = BINS as f64 / f64::from(reach2).sqrt();
    let count = |some: &[Entry]| {
        let (entries, from) = (tree.entries(), some[0]);
        let mut pairs = Pairs { entries, from, reach2, scale, bins: vec![0; BINS] };
        for &from in some {
            pairs.from = from;
            tree.search(from.point, &mut pairs);
        }
        pairs.bins
    };
    let found = exec.ordered(tree.entries().chunks(JOB).collect(), count);
    let mut bins = vec![0; BINS];
    found.iter().flatten().zip((0..BINS).cycle()).for_each(|(c, b)| bins[b] += c);
    bins
}

/// The search of all pairs of a point that are nearer than R.
struct Pairs<'a> {
    entries: &'a [Entry],
    from: Entry,
    reach2: f32,
    /// Bins of a unit of length.
    scale: f64,
    bins: Vec<u64>,
}

impl Search for Pairs<'_> {
    #[inline]
    fn look(&mut self, rank: usize) {
        let entry = &self.entries[rank];
        let d2 = squared_distance(self.from.point, entry.point);
        if entry.id != self.from.id && d2 < self.reach2 {
            // Rounding may lead to one bin beyond the last.
            self.bins[((f64::from(d2).sqrt() * self.scale) as usize).min(BINS - 1)] += 1;
        }
    }

    #[inline]
    fn reaches(&self, offset: [f64; 3]) -> bool {
        is_within(offset, self.reach2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::random;
    use crate::source::Shape;
    use crate::source::sampler::{Greedy, Start, shuffled};

    fn spectrum_of(points: &[Vec3]) -> Spectrum {
        spectrum(points, &Exec::new(2, 32).unwrap()).unwrap()
    }

    /// The mean power between two frequencies.
    fn mean(found: &Spectrum, from: f64, to: f64) -> f64 {
        let band =
            Spectrum::frequencies().zip(&found.power).filter(|(f, _)| from <= *f && *f <= to);
        let all: Vec<f64> = band.map(|(_, power)| *power).collect();
        all.iter().sum::<f64>() / all.len() as f64
    }

    #[test]
    fn points_by_chance_on_a_sphere_have_the_power_1() {
        let unit = |i: u64| f64::from(random::unit(3, i));
        let on_sphere = |i: u64| {
            let (z, a) = (2.0 * unit(2 * i) - 1.0, TAU * unit(2 * i + 1));
            let r = (1.0 - z * z).sqrt();
            let [x, y] = [crate::number::elementary::cos(a), crate::number::elementary::sin(a)];
            Vec3::new((r * x) as f32, (r * y) as f32, z as f32)
        };
        let points: Vec<Vec3> = (0..20_000).map(on_sphere).collect();
        let found = spectrum_of(&points);
        let area = 20_000.0 / found.density;
        assert!((area / (4.0 * PI) - 1.0).abs() < 0.01, "the area of the sphere: {area}");
        for (from, to) in [(0.25, 0.5), (0.5, 1.0), (1.0, 2.0), (2.0, 4.0)] {
            let power = mean(&found, from, to);
            assert!((power - 1.0).abs() < 0.05, "{power} from {from} to {to}");
        }
    }

    #[test]
    fn a_greedy_prefix_is_blue_and_one_by_chance_is_not() {
        let points = Shape::Torus.surfels(60_000, 1).unwrap().position().to_vec();
        let exec = Exec::new(2, 32).unwrap();
        let greedy = Greedy { start: Start::Index(0) };
        let order = greedy.order(&points, 6000, &exec, &|_, _, _| ()).unwrap();
        let some = |order: &[u32]| order.iter().map(|i| points[*i as usize]).collect::<Vec<_>>();
        let blue = spectrum_of(&some(&order.index));
        let [at, peak] = blue.peak();
        assert!((0.9..1.2).contains(&at) && peak > 1.5, "{peak} at {at}");
        assert!(blue.below() < 0.2, "{}", blue.below());
        assert!((mean(&blue, 3.0, 4.0) - 1.0).abs() < 0.1);
        let white = spectrum_of(&some(&shuffled(&points, 1, 6000, &|_, _, _| ()).unwrap().index));
        assert!((white.below() - 1.0).abs() < 0.15, "{}", white.below());
    }

    #[test]
    fn lattices_have_their_peaks() {
        // Triangles of side 3, and squares of side 3, of which u is 1.0746 sides.
        let half_root = 3.0_f32.sqrt() / 2.0;
        for (shift, height, first) in [(0.5, half_root, 1.1547), (0.0, 1.0, 1.0746)] {
            let at = |i: usize| {
                let (column, row) = ((i % 150) as f32, (i / 150) as f32);
                Vec3::new(3.0 * (column + shift * (row % 2.0)), 7.0, 3.0 * height * row)
            };
            let found = spectrum_of(&(0..150 * 150).map(at).collect::<Vec<_>>());
            let unit = 3.0 * first / if shift > 0.0 { 2.0 / 3.0_f64.sqrt() } else { 1.0 };
            assert!((found.unit / unit - 1.0).abs() < 0.05, "{} is not {unit}", found.unit);
            let [f, power] = found.peak();
            assert!((f - first).abs() < 0.06 && power > 4.0, "{power} at {f}, not at {first}");
            assert!(mean(&found, 0.3, 0.8) < 0.1, "{}", mean(&found, 0.3, 0.8));
        }
    }

    /// Every pair, and J0 as the mean of cos(x sin t) over half a turn.
    #[test]
    fn bins_lose_little_of_the_sum_over_all_pairs() {
        let points = Shape::Torus.surfels(400, 5).unwrap().position().to_vec();
        let found = spectrum_of(&points);
        let j0 = |x: f64| {
            let steps = 256;
            let angle = |i: i32| PI * (f64::from(i) + 0.5) / f64::from(steps);
            let cos = |t| crate::number::elementary::cos(x * crate::number::elementary::sin(t));
            (0..steps).map(|i| cos(angle(i))).sum::<f64>() / f64::from(steps)
        };
        let weight = |s: f64| (1.0 - s * s) * (1.0 - s * s);
        for (f, power) in Spectrum::frequencies().zip(&found.power).step_by(16) {
            let wave = TAU * f / found.unit;
            let mut sum = 1.0;
            for p in &points {
                for d in points.iter().map(|q| q.as_dvec3().distance(p.as_dvec3())) {
                    if d > 0.0 && d < found.reach {
                        sum += weight(d / found.reach) * j0(wave * d) / points.len() as f64;
                    }
                }
            }
            let fine = 4000;
            for i in 0..fine {
                let s = (f64::from(i) + 0.5) / f64::from(fine);
                let ring = TAU * s * found.reach * found.reach / f64::from(fine);
                sum -= found.density * ring * weight(s) * j0(wave * s * found.reach);
            }
            assert!((sum - power).abs() < 0.02, "{power} at {f}, not {sum}");
        }
    }

    #[test]
    fn threads_change_nothing_and_what_has_no_spectrum_is_refused() {
        let points = Shape::Torus.surfels(3000, 5).unwrap().position().to_vec();
        let one = spectrum(&points, &Exec::sequential()).unwrap();
        assert_eq!(one, spectrum(&points, &Exec::new(3, 32).unwrap()).unwrap());
        let mut nowhere = points.clone();
        nowhere[9].x = f32::NAN;
        let far = (0..300).map(|i| Vec3::X * if i % 2 == 0 { 0.0 } else { 3e38 }).collect();
        for (points, what) in [
            (points[..255].to_vec(), "255 points; give 256"),
            (nowhere, "point 9 is not finite"),
            (vec![Vec3::ONE; 300], "within 0"),
            (far, "within 0"),
        ] {
            let error = spectrum(&points, &Exec::sequential()).unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
        }
    }
}
