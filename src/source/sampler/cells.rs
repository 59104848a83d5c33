//! Average the colours of an order over the cells of its prefixes \[BJFM19, 6\].
//!
//! "It can happen that samples are taken \[...\] from pixels with colors of minor importance \[...\]. This could
//! be circumvented, e.g., by averaging the color values of early prefixes in an additional post-processing
//! step."
//!
//! Given are n finite points with colours, an order of them, and a count m of its first picks. The
//! *cell* of a pick in a prefix is the set of points that are nearer to it than to any other pick
//! of that prefix; of equal squared distances, the earlier pick wins. Squared distances are those
//! of [`super::greedy`]. Ranks are counted from 0. The new colour of the pick of rank i < m is:
//!
//! ```text
//!   P     = the least power of 2 above i, or m if that is less
//!   color = (sum of the colours of its cell in the prefix of P picks) / (their number)
//! ```
//!
//! The formula applies to each channel in f64, with the sum from 0 in ascending index, rounded to
//! `f32` once. If the cell is empty, because an earlier pick is at the same place, the colour is
//! the pick's own.
//!
//! # Decided
//!
//! - A buffer has one colour for each pick, but the pick has a cell in every prefix that contains
//!   it. It is drawn from the prefix i + 1 on. In any prefix, the newest half of the picks have
//!   cells of the right size, within a factor of 2. Older picks have larger cells: in a prefix of P
//!   picks, P/2, P/4, P/8 ... of them have means over the cells of P, P/2, P/4 ... picks. No pick
//!   changes its colour as the prefix grows.
//! - The mean is over linear light, and over candidates, which are what is seen of the mesh, not
//!   over area.
//! - Only colours are averaged. Opacities, normals and further properties stay the pick's own. A
//!   mean of opacities or of roughness does not give the mean of the light; that depends on how a
//!   renderer shades with them.
//! - Distances are straight: a cell reaches through a wall that is thinner than the cell.

use super::greedy::Order;
use super::search::{self, Found, LEAF};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::point_tree::PointTree;
use crate::memory;
use crate::progress::Progress;
use glam::{DVec3, Vec3};

/// Points of one job.
const JOB: usize = 4096;
/// Bytes of a point, and of a pick.
const BYTES: [u64; 2] = [16, 72];

/// The new colours of the first `count` picks of an order, see the [module](self). `progress` gets
/// the name of the step, the number of prefixes done, and their total.
///
/// # Errors
/// [`Error::Invalid`] if there are not as many colours as points, if a point or a colour is not
/// finite, if a pick is no point, or if the order has fewer than `count` picks.
pub fn averaged(
    points: &[Vec3],
    colors: &[Vec3],
    order: &Order,
    count: usize,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Vec<Vec3>> {
    check(points, colors, order, count)?;
    let bytes = points.len() as u64 * BYTES[0] + count as u64 * BYTES[1];
    memory::ask(bytes, || format!("the cells of {} points", points.len()))?;
    let picks = &order.index[..count];
    let mut new = Vec::with_capacity(count);
    // All points belong to the first pick until another is nearer.
    let mut nearest: Vec<Found> = vec![(f32::INFINITY, 0); points.len()];
    let prefixes = u64::from(count.next_power_of_two().ilog2()) + u64::from(count > 0);
    for done in 0..prefixes {
        progress("averaging colours", done, prefixes);
        let last = (1 << done).min(count);
        let added = new.len()..last;
        let places: Vec<Vec3> = picks[added.clone()].iter().map(|&i| points[i as usize]).collect();
        closer(points, &mut nearest, &places, added.start as u32, exec);
        let mut sums = vec![(DVec3::ZERO, 0_u64); places.len()];
        for (&(_, rank), color) in nearest.iter().zip(colors) {
            if let Some((sum, number)) =
                (rank as usize).checked_sub(added.start).and_then(|cell| sums.get_mut(cell))
            {
                *sum += color.as_dvec3();
                *number += 1;
            }
        }
        let own = picks[added].iter().map(|&i| colors[i as usize]);
        new.extend(sums.iter().zip(own).map(|(&(sum, number), own)| match number {
            0 => own,
            number => (sum / number as f64).as_vec3(),
        }));
    }
    progress("averaging colours", prefixes, prefixes);
    Ok(new)
}

fn check(points: &[Vec3], colors: &[Vec3], order: &Order, count: usize) -> Result<()> {
    let invalid = |what| Err(Error::Invalid(what));
    if points.len() != colors.len() {
        return invalid(format!("{} colours, but {} points", colors.len(), points.len()));
    }
    for (what, all) in [("point", points), ("the colour of point", colors)] {
        if let Some(at) = all.iter().position(|value| !value.is_finite()) {
            return invalid(format!("{what} {at} is not finite"));
        }
    }
    if let Some(pick) = order.index.iter().find(|pick| **pick as usize >= points.len()) {
        return invalid(format!("pick {pick}, but there are {} points", points.len()));
    }
    if count > order.index.len() {
        let picks = order.index.len();
        return invalid(format!("colours of {count} points, but the order has {picks}"));
    }
    Ok(())
}

/// Updates the nearest pick of each point with further picks, whose ranks begin at `first`.
fn closer(points: &[Vec3], nearest: &mut [Found], more: &[Vec3], first: u32, exec: &Exec) {
    let tree = PointTree::new(more, LEAF, exec);
    let jobs = points.chunks(JOB).zip(nearest.chunks_mut(JOB)).collect();
    exec.ordered(jobs, |(points, nearest): (&[Vec3], &mut [Found])| {
        for (&point, found) in points.iter().zip(nearest) {
            // A tie must not replace an earlier pick: index 0 is the lowest of the tree, so the
            // search keeps it.
            let (distance, index) = search::nearest(&tree, point, u32::MAX, (found.0, 0));
            if distance < found.0 {
                *found = (distance, first + index);
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::index::point_tree::given;
    use crate::source::sampler::{Greedy, Start, greedy::squared_distance};
    use proptest::prelude::*;

    fn averaged_colors(
        points: &[Vec3],
        colors: &[Vec3],
        index: &[u32],
        exec: &Exec,
    ) -> Result<Vec<Vec3>> {
        let order = Order { index: index.into(), distance: vec![0.0; index.len()] };
        averaged(points, colors, &order, index.len(), exec, &|_, _, _| ())
    }

    proptest! {
        /// Every pick of the prefix for every point.
        #[test]
        fn cells_are_those_of_all_distances(points in given::points(), count in 1_usize..70) {
            let colors: Vec<Vec3> =
                (0..points.len()).map(|i| Vec3::new(i as f32, (i * i % 7) as f32, 0.25)).collect();
            let greedy = Greedy { start: Start::Index(0) };
            let index = greedy.define(&points, count).unwrap().index;
            let found = averaged_colors(&points, &colors, &index, &Exec::sequential()).unwrap();
            prop_assert_eq!(found.len(), index.len());
            for (rank, &color) in found.iter().enumerate() {
                let prefix = [1, 2, 4, 8, 16, 32, 64, 128].into_iter().find(|p| *p > rank).unwrap();
                let prefix = &index[..prefix.min(index.len())];
                let mut cell = Vec::new();
                for (point, color) in points.iter().zip(&colors) {
                    let mut best = 0;
                    for (other, &pick) in prefix.iter().enumerate() {
                        let d = |i: u32| squared_distance(*point, points[i as usize]);
                        if d(pick) < d(prefix[best]) {
                            best = other;
                        }
                    }
                    if best == rank {
                        cell.push(color.as_dvec3());
                    }
                }
                let mean = match cell.len() {
                    0 => colors[index[rank] as usize],
                    n => (cell.iter().sum::<DVec3>() / n as f64).as_vec3(),
                };
                prop_assert_eq!(color, mean, "rank {}", rank);
            }
        }
    }

    #[test]
    fn five_on_a_line_by_hand() {
        let points = [0.0, 1.0, 2.0, 8.0, 9.0].map(|x| Vec3::new(x, 0.0, 0.0));
        let colors = [1.0, 2.0, 4.0, 8.0, 16.0].map(Vec3::splat);
        let exec = Exec::new(2, 32).unwrap();
        // The cell of all points; then the right points; with three picks the middle ones, as 1 is
        // as near to 0 as to 2.
        let found = averaged_colors(&points, &colors, &[0, 4, 2], &exec).unwrap();
        assert_eq!(found, [31.0 / 5.0, 12.0, 4.0].map(|v: f32| Vec3::splat(v)));
        let twice = [points[0], points[0], points[4]];
        let found = averaged_colors(&twice, &colors[..3], &[0, 1], &exec).unwrap();
        assert_eq!(found, [Vec3::splat((7.0_f64 / 3.0) as f32), colors[1]], "an empty cell");
        assert!(averaged_colors(&points, &colors, &[], &exec).unwrap().is_empty());
    }

    /// For random colours of variance v, the square error of a pick's own colour is 2 v on average,
    /// and of the mean of a large cell v, the least possible for one colour.
    #[test]
    fn a_mean_halves_the_square_error_of_colours_by_chance() {
        let points = crate::source::Shape::Torus.surfels(20_000, 3).unwrap().position().to_vec();
        let colors: Vec<Vec3> =
            (0..20_000).map(|i| Vec3::splat(crate::number::random::unit(8, i))).collect();
        let exec = Exec::new(2, 32).unwrap();
        let greedy = Greedy { start: Start::Index(0) };
        let order = greedy.order(&points, 256, &exec, &|_, _, _| ()).unwrap();
        let new = averaged_colors(&points, &colors, &order.index, &exec).unwrap();
        let own: Vec<Vec3> = order.index.iter().map(|&i| colors[i as usize]).collect();
        let square = |of_picks: &[Vec3]| {
            let of_point = |(point, color): (&Vec3, &Vec3)| {
                let d =
                    |rank: &usize| squared_distance(*point, points[order.index[*rank] as usize]);
                let near = (0..256).reduce(|a, b| if d(&b) < d(&a) { b } else { a }).unwrap();
                f64::from(of_picks[near].x - color.x) * f64::from(of_picks[near].x - color.x)
            };
            points.iter().zip(&colors).map(of_point).sum::<f64>() / 20_000.0
        };
        let (own, new) = (square(&own), square(&new));
        assert!((own - 2.0 / 12.0).abs() < 0.02 && (new - 1.0 / 12.0).abs() < 0.004, "{own} {new}");
    }

    #[test]
    fn what_has_no_mean_is_refused() {
        let (points, colors) = ([Vec3::ZERO, Vec3::ONE], [Vec3::ONE; 2]);
        let order = Order { index: vec![0], distance: vec![0.0] };
        let run = |points: &[Vec3], colors: &[Vec3], count| {
            let done = averaged(points, colors, &order, count, &Exec::sequential(), &|_, _, _| ());
            done.unwrap_err().to_string()
        };
        assert_eq!(run(&points, &colors[..1], 1), "1 colours, but 2 points");
        assert_eq!(run(&[Vec3::ZERO, Vec3::NAN], &colors, 1), "point 1 is not finite");
        let nan = run(&points, &[Vec3::INFINITY, Vec3::ONE], 1);
        assert_eq!(nan, "the colour of point 0 is not finite");
        assert_eq!(run(&points, &colors, 2), "colours of 2 points, but the order has 1");
        assert_eq!(run(&[], &[], 0), "pick 0, but there are 0 points");
    }
}
