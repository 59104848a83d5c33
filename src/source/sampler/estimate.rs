//! How densely an order covers \[BJFM19, 4.1\].

use super::quality::quality;
use crate::error::Result;
use crate::frame::Exec;
use crate::scene::objects::detail::prefix::Estimate;
use glam::Vec3;

/// p_m, where there are so many points: the paper's example.
pub const COUNT: usize = 1000;

/// The estimate of points in an order: p_m the lesser of [`COUNT`] and their number, r_m the lower median, of
/// rank (p_m - 1) / 2, of the squared distances in `f32` from each of the first p_m to the nearest other of
/// them, its square root in f64, rounded to `f32` once; 0 if there is one point alone.
///
/// # Errors
/// As [`quality`].
pub fn estimate(points: &[Vec3], exec: &Exec) -> Result<Estimate> {
    let points = &points[..points.len().min(COUNT)];
    let prefix: Vec<u32> = (0..points.len() as u32).collect();
    let mut nearest = quality(points, &prefix, exec)?.nearest;
    nearest.sort_by(f32::total_cmp);
    let median = nearest[(nearest.len() - 1) / 2];
    let distance = if nearest.len() == 1 { 0.0 } else { f64::from(median).sqrt() as f32 };
    Ok(Estimate { count: nearest.len() as u32, distance })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_a_line_by_hand() {
        let exec = Exec::sequential();
        let points = |all: &[f32]| all.iter().map(|&x| Vec3::new(x, 2.0, 2.0)).collect::<Vec<_>>();
        // Nearest: 1, 1, 2, 4, of which the second is the lower median.
        let four = estimate(&points(&[0.0, 1.0, 3.0, 7.0]), &exec).unwrap();
        assert_eq!(four, Estimate { count: 4, distance: 1.0 });
        let three = estimate(&points(&[0.0, 2.0, 5.0]), &exec).unwrap();
        assert_eq!(three, Estimate { count: 3, distance: 2.0 });
        assert_eq!(estimate(&points(&[9.0]), &exec).unwrap(), Estimate { count: 1, distance: 0.0 });
        assert!(estimate(&[], &exec).is_err());
        // Only the first 1000 count.
        let many: Vec<f32> = (0..2000).map(|i| if i < 1000 { i as f32 } else { 0.25 }).collect();
        assert_eq!(
            estimate(&points(&many), &exec).unwrap(),
            Estimate { count: 1000, distance: 1.0 }
        );
    }
}
