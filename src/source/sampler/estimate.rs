//! Estimate how densely an order covers \[BJFM19, 4.1\].

use super::geodesic::alike;
use super::greedy::squared_distance;
use crate::scene::objects::detail::prefix::Estimate;
use glam::Vec3;

/// `p_m` for orders with at least this many points: the paper's example.
pub const COUNT: usize = 1000;

/// The estimate for ordered points, each with a normal. `p_m` is the lesser of [`COUNT`], 1000, and
/// the number of points. The squared distances are those of [`super::greedy`] in `f32`, among the first
/// `p_m` points:
///
/// ```text
///   nearest_i = the least squared distance to another of them that faces alike, as in super::geodesic
///   r_m       = the square root of the lower median of those nearest_i that are there, of rank (k - 1) / 2
///               of k, in f64, rounded to f32 once; 0 if there are none
/// ```
///
/// A squared distance that exceeds `f32` is ignored, so that `r_m` is finite.
///
/// `Decided:` points that face the other way do not count; the paper does not mention them. The two
/// sides of a wall that is thinner than the distance of surfels are near to each other, but neither
/// side covers the other.
///
/// # Panics
/// If there are fewer normals than points.
#[must_use]
pub fn estimate(points: &[Vec3], normals: &[Vec3]) -> Estimate {
    let count = points.len().min(COUNT);
    let nearest = |i: usize| {
        let others = (0..count).filter(|&j| j != i && alike(normals[i], normals[j]));
        let distances = others.map(|j| squared_distance(points[i], points[j]));
        distances.fold(f32::INFINITY, |least, d| if d < least { d } else { least })
    };
    let mut all: Vec<f32> = (0..count).map(nearest).filter(|d| d.is_finite()).collect();
    all.sort_by(f32::total_cmp);
    let median = all.get(all.len().saturating_sub(1) / 2).copied().unwrap_or(0.0);
    Estimate { count: count as u32, distance: f64::from(median).sqrt() as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate_of(xs: &[f32], normals: &[Vec3]) -> Estimate {
        let points: Vec<Vec3> = xs.iter().map(|&x| Vec3::new(x, 2.0, 2.0)).collect();
        estimate(&points, normals)
    }

    #[test]
    fn points_on_a_line_by_hand() {
        let up = [Vec3::Z; 2000];
        // Nearest: 1, 1, 2, 4, of which the second is the lower median.
        let four = estimate_of(&[0.0, 1.0, 3.0, 7.0], &up);
        assert_eq!(four, Estimate { count: 4, distance: 1.0 });
        let three = estimate_of(&[0.0, 2.0, 5.0], &up);
        assert_eq!(three, Estimate { count: 3, distance: 2.0 });
        assert_eq!(estimate_of(&[9.0], &up), Estimate { count: 1, distance: 0.0 });
        assert_eq!(estimate_of(&[], &up), Estimate { count: 0, distance: 0.0 });
        // Only the first 1000 count.
        let many: Vec<f32> = (0..2000).map(|i| if i < 1000 { i as f32 } else { 0.25 }).collect();
        assert_eq!(estimate_of(&many, &up), Estimate { count: 1000, distance: 1.0 });
    }

    #[test]
    fn the_other_side_of_a_wall_does_not_count() {
        let both = [Vec3::Z, -Vec3::Z, Vec3::Z, -Vec3::Z];
        let found = estimate_of(&[0.0, 0.125, 4.0, 5.125], &both);
        assert_eq!(found, Estimate { count: 4, distance: 4.0 });
        let alone = estimate_of(&[0.0, 0.125], &both[..2]);
        assert_eq!(alone, Estimate { count: 2, distance: 0.0 });
    }
}
