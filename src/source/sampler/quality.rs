//! Measure how evenly a prefix of an order is spread \[BJFM19, 3.3\].
//!
//! Squared distances are those of [`super::greedy`], in `f32`. For the prefix Q of points P:
//!
//! ```text
//!   nearest_q = the least d(q, q') of another member q' of Q, +inf if there is none
//!   packing   = the least of them
//!   covering  = the largest, over all p of P, of the least d(p, q) of a member q of Q
//! ```
//!
//! `Decided:` "another member" means another position in the prefix, so that equal points are 0
//! apart. The paper draws the square roots of `nearest`, divided by one common length, as violins.

use super::search::{self, LEAF};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::point_tree::PointTree;
use crate::memory;
use glam::Vec3;

/// How a prefix is spread; all numbers are squared distances.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// For each point of the prefix, the distance to the nearest other one.
    pub nearest: Vec<f32>,
    /// The least of `nearest`.
    pub packing: f32,
    /// The largest distance from any point to the nearest point of the prefix.
    pub covering: f32,
}

/// Points of one job.
const JOB: usize = 4096;
/// The most bytes that the tree and the distances take for a point of the prefix.
const BYTES_A_POINT: u64 = 48;

/// The quality of the points with these indices, such as a [prefix](super::Order).
///
/// # Errors
/// [`Error::Invalid`] if there is no index, if one belongs to no point, if a point is not finite,
/// or if there are 2^32 indices or more.
pub fn quality(points: &[Vec3], prefix: &[u32], exec: &Exec) -> Result<Quality> {
    let invalid = |what| Err(Error::Invalid(what));
    if prefix.is_empty() || u32::try_from(prefix.len()).is_err() {
        return invalid(format!("a prefix of {}; give 1 to 2^32 - 1 indices", prefix.len()));
    }
    if let Some(at) = points.iter().position(|point| !point.is_finite()) {
        return invalid(format!(
            "point {at} is not finite, so it has no distance to others; remove it"
        ));
    }
    if let Some(index) = prefix.iter().find(|index| **index as usize >= points.len()) {
        return invalid(format!("index {index}, but there are {} points", points.len()));
    }
    let bytes = prefix.len() as u64 * BYTES_A_POINT;
    memory::ask(bytes, || format!("distances among {} points", prefix.len()))?;
    let members: Vec<Vec3> = prefix.iter().map(|&index| points[index as usize]).collect();
    let tree = PointTree::new(&members, LEAF, exec);
    let jobs: Vec<_> = members.chunks(JOB).enumerate().collect();
    let least = |point, own| search::nearest(&tree, point, own, (f32::INFINITY, u32::MAX)).0;
    let nearest = exec.ordered(jobs, |(job, some)| {
        let ids = (job * JOB) as u32..;
        some.iter().zip(ids).map(|(&point, own)| least(point, own)).collect::<Vec<_>>()
    });
    let nearest = nearest.concat();
    let covering = exec.ordered(points.chunks(JOB).collect(), |some| {
        let nearest = some.iter().map(|&point| least(point, u32::MAX));
        nearest.fold(0.0, |most, d| if d > most { d } else { most })
    });
    let packing = nearest.iter().fold(f32::INFINITY, |least, &d| if d < least { d } else { least });
    let covering = covering.into_iter().fold(0.0, |most, d| if d > most { d } else { most });
    Ok(Quality { nearest, packing, covering })
}

#[cfg(test)]
mod tests {
    use super::super::greedy::squared_distance;
    use super::*;
    use crate::index::point_tree::given;
    use crate::source::sampler::{Greedy, Start};
    use proptest::prelude::*;

    proptest! {
        /// Every pair of points, and for a greedy prefix what its laws say.
        #[test]
        fn quality_is_that_of_all_pairs(points in given::points(), count in 1_usize..60) {
            let greedy = Greedy { start: Start::Index(0) };
            let order = greedy.define(&points, count + 1).unwrap();
            let prefix = &order.index[..count.min(points.len())];
            let found = quality(&points, prefix, &Exec::sequential()).unwrap();
            let least = |all: &mut dyn Iterator<Item = f32>| {
                all.fold(f32::INFINITY, |a, b| if b < a { b } else { a })
            };
            let d = |a: u32, b: u32| squared_distance(points[a as usize], points[b as usize]);
            for (&q, &nearest) in prefix.iter().zip(&found.nearest) {
                let others = prefix.iter().filter(|other| **other != q);
                prop_assert_eq!(least(&mut others.map(|&other| d(other, q))), nearest);
            }
            let mut covering = 0.0;
            for p in 0..points.len() as u32 {
                let reach = least(&mut prefix.iter().map(|&q| d(q, p)));
                covering = if reach > covering { reach } else { covering };
            }
            prop_assert_eq!(covering, found.covering);
            prop_assert_eq!(found.packing, least(&mut found.nearest.iter().copied()));
            let next = order.distance.get(prefix.len()).copied().unwrap_or(0.0);
            prop_assert_eq!(covering, next, "the next pick is what is covered worst");
            prop_assert_eq!(found.packing, order.distance[prefix.len() - 1]);
        }
    }

    #[test]
    fn three_on_a_line_by_hand_and_what_is_refused() {
        let points = [0.0, 1.0, 3.0, 10.0].map(|x| Vec3::new(x, 5.0, 5.0));
        let exec = Exec::new(2, 32).unwrap();
        let found = quality(&points, &[2, 0, 1], &exec).unwrap();
        let by_hand = Quality { nearest: vec![4.0, 1.0, 1.0], packing: 1.0, covering: 49.0 };
        assert_eq!(found, by_hand);
        let alone = quality(&points, &[3], &exec).unwrap();
        assert_eq!((alone.packing, alone.covering), (f32::INFINITY, 100.0));
        assert_eq!(quality(&points, &[1, 1], &exec).unwrap().packing, 0.0);
        for (points, prefix) in
            [(&points[..], &[] as &[u32]), (&points, &[4]), (&[Vec3::NAN], &[0]), (&[], &[0])]
        {
            assert!(quality(points, prefix, &exec).is_err(), "{points:?} {prefix:?}");
        }
    }
}
