//! Ask which boxes are hidden: occlusion queries of boxes against the depth of pass 1 \[GBP04,
//! 7.1\].
//!
//! A query looks at the pixels whose square may hold the centre of a surfel in a box. It counts in
//! how many of these pixels the nearest depth of the box passes the test of pass 2. If the count is
//! 0, no surfel of the box is selected, and pass 2 skips them.
//!
//! The pixels are the rectangle around the corners of the box on the screen. A box that reaches the
//! near plane has the whole picture, and the depth of the near plane. Everything is computed in f64
//! and widened by more than the positions, their places and the projection lose in `f32`: by 2^-20
//! of the greatest coordinate, in world units, and by 1/4 px. `Decided:` \[GBP04\] draws the box
//! itself. Here that would lose surfels at the rim of the box, because a surfel is drawn into the
//! pixel of its centre even where the faces of the box do not cover the centre of that pixel.

use crate::frame::Rect;
use crate::number::MapInline;
use crate::number::Vector3;
use crate::scene::{Camera, Similarity};
use crate::splat::View;
use glam::{DVec3, Vec3};

/// The greatest depth at each pixel that passes the test of pass 2.
#[derive(Clone, Debug)]
pub struct Limits {
    /// Width of the picture in pixels.
    pub width: u32,
    /// The depths, row by row.
    pub values: Vec<f32>,
}

/// Occlusion queries against one picture.
#[derive(Clone, Debug)]
pub struct Queries<'a> {
    view: View<f64>,
    size: [u32; 2],
    limits: &'a Limits,
}

impl<'a> Queries<'a> {
    /// Queries against the depth of a picture.
    #[must_use]
    pub fn new(camera: &Camera, limits: &'a Limits) -> Self {
        Self { view: View::new(camera), size: camera.size(), limits }
    }

    /// How many pixels pass for a box; the box is in coordinates that `place` moves.
    #[must_use]
    pub fn count(&self, corners: [Vec3; 2], place: Option<&Similarity>) -> u64 {
        self.passing(corners, place).count() as u64
    }

    /// Whether any pixel passes.
    pub(super) fn any(&self, corners: [Vec3; 2], place: Option<&Similarity>) -> bool {
        self.passing(corners, place).next().is_some()
    }

    /// The limits of the pixels that pass.
    fn passing(
        &self,
        corners: [Vec3; 2],
        place: Option<&Similarity>,
    ) -> impl Iterator<Item = &f32> {
        let (rect, nearest) = self.reach(corners, place).unwrap_or((Rect::default(), 0.0));
        let (width, columns) = (self.limits.width as usize, rect.x0 as usize..rect.x1 as usize);
        let row = move |y: u32| &self.limits.values[y as usize * width..][columns.clone()];
        (rect.y0..rect.y1).flat_map(row).filter(move |&&limit| nearest <= f64::from(limit))
    }

    /// The pixels that a box may reach, and its nearest depth; none if the box is not in the
    /// picture.
    fn reach(&self, [low, high]: [Vec3; 2], place: Option<&Similarity>) -> Option<(Rect, f64)> {
        let (mut largest, mut seen) = (0.0_f64, [DVec3::ZERO; 8]);
        for (corner, seen) in seen.iter_mut().enumerate() {
            let part = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
            let mut p = DVec3::new(part(0).into(), part(1).into(), part(2).into());
            if let Some(place) = place {
                p = place.rotation * (p * place.scale) + place.translation;
                largest = greater(largest, place.translation.length());
            }
            let Vector3 { x, y, z } = self.view.point(Vector3::new(p.x, p.y, p.z));
            *seen = DVec3::new(x, y, z);
            largest = greater(largest, greater(p.length(), seen.length()));
        }
        let lost = largest / 1_048_576.0;
        let depths = seen.map_inline(|p| -p.z);
        let [mut nearest, mut farthest] = [depths[0]; 2];
        for t in depths {
            (nearest, farthest) = (-greater(-nearest, -t), greater(farthest, t));
        }
        (nearest, farthest) = (nearest - lost, farthest + lost);
        let [width, height] = self.size;
        if !(farthest > self.view.near) {
            return None;
        }
        // A box that reaches the near plane has no corners to project.
        if !(nearest > self.view.near) {
            return Some((Rect { x0: 0, y0: 0, x1: width, y1: height }, self.view.near));
        }
        let (mut columns, mut rows) = (Span::NONE, Span::NONE);
        for p in seen {
            let t = if self.view.perspective { -p.z } else { 1.0 };
            let near = if self.view.perspective { nearest } else { 1.0 };
            let slack = |at: f64| lost * (1.0 + at.abs()) / near;
            let (x, y) = (p.x / t, p.y / t);
            let View { fx, fy, cx, cy, .. } = self.view;
            columns.add(cx + fx * x, fx * slack(x) + 0.25);
            rows.add(cy - fy * y, fy * slack(y) + 0.25);
        }
        let ([x0, x1], [y0, y1]) = (columns.pixels(width)?, rows.pixels(height)?);
        Some((Rect { x0, y0, x1, y1 }, nearest))
    }
}

/// The greater of two numbers; neither is NaN.
fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// An interval in pixels.
#[derive(Clone, Copy)]
struct Span(f64, f64);

impl Span {
    const NONE: Self = Self(f64::INFINITY, f64::NEG_INFINITY);

    fn add(&mut self, at: f64, slack: f64) {
        *self = Self(-greater(-self.0, slack - at), greater(self.1, at + slack));
    }

    /// The first pixel and the one after the last, in a row or column of `count` pixels.
    fn pixels(self, count: u32) -> Option<[u32; 2]> {
        if self.1 < 0.0 || self.0 >= f64::from(count) {
            return None;
        }
        // Conversions saturate, so that infinite ends are safe.
        Some([self.0 as u32, count.min((self.1 as u32).saturating_add(1))])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::projection::surfels::PointProjector;
    use crate::scene::transform::rotation;
    use crate::scene::{Lens, Pose};
    use crate::splat::Fate;
    use proptest::prelude::*;

    proptest! {
        /// A point that is drawn at a pixel where it passes is in no box that a query reports
        /// hidden.
        #[test]
        fn no_point_that_passes_is_in_a_hidden_box(
            low in prop::array::uniform3(-2.0..2.0_f32), size in prop::array::uniform3(0.0..1.5_f32),
            inside in prop::array::uniform3(0.0..=1.0_f32), view in (1..40_u32, 1..30_u32, any::<bool>(), 0.5..6.0_f64),
            far in prop_oneof![Just(0.0), 0.0..1e5_f64], turn in 0.0..360.0_f64, depth in 0.25..9.0_f32,
        ) {
            let (width, height, ortho, distance) = view;
            let place = Similarity {
                rotation: rotation(DVec3::new(1.0, 0.5, 0.25), turn),
                scale: 0.75,
                translation: DVec3::new(far, -far, 0.5 * far),
            };
            let lens = if ortho { Lens::Orthographic(3.0) } else { Lens::FieldOfView(60.0) };
            let eye = place.translation + DVec3::new(0.3, 0.2, distance);
            let pose = Pose { eye, target: place.translation, up: DVec3::Y };
            let camera = Camera::new(width, height, pose, lens).unwrap();
            let (low, size) = (Vec3::from_array(low), Vec3::from_array(size));
            let corners = [low, low + size];
            let p = (low + size * Vec3::from_array(inside)).clamp(corners[0], corners[1]);
            let points = PointProjector::<f32>::new(View::new(&camera), false);
            let toward = Vector3::new(0.0, 0.0, 1.0);
            let (placed, _, fate) = points.fate(Vector3::from_glam(place.point(p)), toward);
            prop_assume!(fate == Fate::Visible && placed.t <= depth);
            let [x, y] = placed.pixel();
            // Only this pixel passes.
            let mut values = vec![0.0; (width * height) as usize];
            values[(y * width + x) as usize] = depth;
            let limits = Limits { width, values };
            prop_assert_eq!(Queries::new(&camera, &limits).count(corners, Some(&place)), 1);
        }
    }

    #[test]
    fn a_box_behind_a_wall_is_hidden_and_counted_beside_it() {
        let pose = Pose { eye: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y };
        // One pixel is 1/8 wide at depth 1.
        let camera = Camera::new(16, 16, pose, Lens::Focal(8.0)).unwrap();
        let mut values = vec![2.0; 256];
        let (low, high) = (Vec3::new(-0.4, -0.4, -3.5), Vec3::new(0.4, 0.4, -3.2));
        let count = |values: &[f32]| {
            let limits = Limits { width: 16, values: values.to_vec() };
            Queries::new(&camera, &limits).count([low, high], None)
        };
        assert_eq!(count(&values), 0, "behind the wall");
        // The box has the columns and rows 6.75 to 9.25, widened 7 +- 1/4 or so: 6 to 9.
        values[7 * 16 + 8] = 3.25;
        values[2 * 16 + 8] = 9.0;
        assert_eq!(count(&values), 1, "through a hole in front of the box, not beside it");
        assert_eq!(count(&[9.0; 256]), 16);
        let limits = Limits { width: 16, values: vec![9.0; 256] };
        let queries = Queries::new(&camera, &limits);
        let behind = [Vec3::new(-1.0, -1.0, 2.0), Vec3::new(1.0, 1.0, 3.0)];
        assert_eq!(queries.count(behind, None), 0, "behind the eye");
        let around = [Vec3::splat(-1.0), Vec3::splat(1.0)];
        assert_eq!(queries.count(around, None), 256, "it reaches the near plane");
    }
}
