//! Find distinct positions, because neighbours treat points at one place as one.

use crate::number::MapInline;
use glam::Vec3;

/// The distinct places of some points.
#[derive(Debug)]
pub(super) struct Distinct {
    /// The places, in the order of the lowest point at each.
    pub(super) place: Vec<Vec3>,
    /// The place of each point.
    pub(super) of: Vec<u32>,
}

impl Distinct {
    /// The places of fewer than 2^32 finite positions; -0 and +0 are equal.
    pub(super) fn new(points: &[Vec3]) -> Self {
        let key = |i: u32| points[i as usize].to_array().map_inline(|c| c + 0.0); // -0 + 0 is +0
        let equal = |a: u32, b: u32| key(a) == key(b);
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        order.sort_unstable_by(|&a, &b| {
            let ([ax, ay, az], [bx, by, bz]) = (key(a), key(b));
            let by_place = ax.total_cmp(&bx).then(ay.total_cmp(&by)).then(az.total_cmp(&bz));
            by_place.then(a.cmp(&b))
        });
        // Each point first gets the lowest point at its place, which then gets a number.
        let mut of = vec![0; points.len()];
        for same in order.chunk_by(|&a, &b| equal(a, b)) {
            for &i in same {
                of[i as usize] = same[0];
            }
        }
        let mut place = Vec::new();
        for i in 0..points.len() {
            let lowest = of[i] as usize;
            if lowest == i {
                of[i] = place.len() as u32;
                place.push(points[i]);
            } else {
                of[i] = of[lowest]; // lowest < i, so that it has its number
            }
        }
        Self { place, of }
    }

    /// Copies the result for each place to all points at it.
    pub(super) fn spread<T: Copy>(&self, found: &[T]) -> Vec<T> {
        self.of.iter().map(|&place| found[place as usize]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_numbered_by_their_first_point() {
        let [a, b] = [Vec3::new(5.0, 0.0, 1.0), Vec3::new(-5.0, 2.0, 1.0)];
        let distinct = Distinct::new(&[a, b, a, b, Vec3::ZERO, -Vec3::ZERO]);
        assert_eq!(distinct.place, [a, b, Vec3::ZERO]);
        assert_eq!(distinct.of, [0, 1, 0, 1, 2, 2]);
        assert_eq!(distinct.spread(&['a', 'b', 'c']), ['a', 'b', 'a', 'b', 'c', 'c']);
    }
}
