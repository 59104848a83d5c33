//! Boxes around neighbouring surfels: a view tests a box before it looks at each surfel.

use super::Surfels;
use glam::Vec3;
use std::ops::Range;

/// Axis-parallel boxes around the positions of each [`Boxes::SURFELS`] consecutive surfels, and of
/// all.
#[derive(Clone, Debug)]
pub struct Boxes {
    each: Vec<[Vec3; 2]>,
    all: [Vec3; 2],
}

impl Boxes {
    /// How many surfels share a box.
    pub const SURFELS: usize = 1024;

    /// Computes the boxes of surfels.
    #[must_use]
    pub fn new(surfels: &Surfels) -> Self {
        let of = |points: &[Vec3]| {
            let around = [points[0], points[0]];
            points.iter().fold(around, |[low, high], p| [low.min(*p), high.max(*p)])
        };
        let each: Vec<_> = surfels.position().chunks(Self::SURFELS).map(of).collect();
        let first = each.first().copied().unwrap_or_default();
        let join = |[low, high]: [Vec3; 2], [a, b]: &[Vec3; 2]| [low.min(*a), high.max(*b)];
        let all = each.iter().fold(first, join);
        Self { each, all }
    }

    /// The least and the greatest corner of the box around all surfels.
    #[must_use]
    pub fn all(&self) -> [Vec3; 2] {
        self.all
    }

    /// Splits a range of surfels at the borders of boxes, and gives each part with its box.
    pub fn parts(&self, range: Range<usize>) -> impl Iterator<Item = (Range<usize>, [Vec3; 2])> {
        let Range { start, end } = range;
        let chunks = start / Self::SURFELS..end.div_ceil(Self::SURFELS);
        chunks.map(move |chunk| {
            let first = chunk * Self::SURFELS;
            let part = start.max(first)..end.min(first + Self::SURFELS);
            (part, self.each[chunk])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Shape;

    #[test]
    fn a_box_holds_its_surfels() {
        let surfels = Shape::Torus.surfels(5000, 1).unwrap();
        let boxes = Boxes::new(&surfels);
        let inside = |[low, high]: [Vec3; 2], p: Vec3| p.cmpge(low).all() && p.cmple(high).all();
        for range in [0..surfels.len(), 1..2, 1000..1030, 1024..2048, 2000..4321] {
            let mut next = range.start;
            for (part, around) in boxes.parts(range.clone()) {
                assert_eq!((part.start, part.is_empty()), (next, false), "{range:?}");
                next = part.end;
                assert!(surfels.position()[part].iter().all(|&p| inside(around, p)));
            }
            assert_eq!(next, range.end);
        }
        assert_eq!(boxes.all(), [surfels.bounds().0, surfels.bounds().1]);
        assert_eq!(Boxes::new(&Surfels::none()).parts(0..0).count(), 0);
    }
}
