//! Cut the polygons of files into triangles.
//!
//! A polygon of n corners becomes n - 2 triangles. It is the fan of its first corner, a b c, a c d
//! ..., if no triangle of the fan is turned the wrong way. A convex polygon always is, and so is a
//! concave one that its first corner sees as a whole. Otherwise the polygon is cut into ears:
//!
//! 1. The polygon is projected along the axis of which its normal has the largest component: x if
//!    |x| >= |y| and |x| >= |z|, else y if |y| >= |z|, else z. The normal is the sum of
//!    (b - a) x (c - a) over the fan, in f64. Dropping x keeps (y, z), dropping y keeps (z, x),
//!    dropping z keeps (x, y). The polygon is mirrored if the component is negative.
//! 2. Start at the first corner. A corner is an ear if it turns left, and if its triangle, with its
//!    edges, holds no other corner that does not turn left. Corners at one of the triangle's own
//!    three places do not count, because bridges to holes visit places twice.
//! 3. Cut an ear off as the triangle (corner before, corner, corner after), and go on with the second
//!    corner after it. At any other corner, go on with the next corner.
//! 4. If no corner left is an ear, cut off the first corner that neither turns left nor right, from
//!    the current one on. Three corners left are the last triangle.
//!
//! The sign of a turn is exact, whatever the coordinates. Triangles keep the direction in which the
//! polygon runs.
//!
//! `Decided:` the fan stays in these cases, because no triangles would be right:
//!
//! - The normal is 0 or not finite, for example because all corners are on one line.
//! - The polygon crosses itself in the projection, so that step 4 finds no corner.
//! - Its ears take too long. The polygons of a file together may try 2^30 times whether a corner is in
//!   a triangle, and 64 times more for each corner of a polygon that is cut into ears. A warning says
//!   how many polygons stay uncut. Polygons of a million corners are cut, if few of them turn right.
//!
//! Corners that are not in one plane are cut as their projection is. The method is by Meisters,
//! "Polygons have ears", 1975.

mod ears;
#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// How much work the polygons of one file may take.
pub(super) struct Budget {
    /// How often it may still be tried whether a corner is in a triangle.
    tries: u64,
    /// Polygons that kept their fan because there were no tries left.
    uncut: u64,
}

impl Budget {
    pub(super) fn new() -> Self {
        Self { tries: 1 << 30, uncut: 0 }
    }

    /// What is to be said, once all polygons are cut.
    pub(super) fn warning(&self) -> Option<String> {
        (self.uncut > 0).then(|| {
            format!(
                "{} polygons have so many corners that cutting them into ears would take too long; \
                 they are drawn as fans, which is wrong where they are concave: triangulate them",
                self.uncut
            )
        })
    }
}

/// The corners of the polygon that was cut into this fan.
pub(super) fn corners<T: Copy>(fan: &[[T; 3]]) -> Vec<T> {
    let first = fan.first().into_iter().flat_map(|first| &first[..2]);
    first.chain(fan.iter().map(|triangle| &triangle[2])).copied().collect()
}

/// Replaces the fan of a polygon by the ears that [`ears`] found, from the polygon's corners.
pub(super) fn recut<T: Copy>(fan: &mut [[T; 3]], corners: &[T], ears: &[[u32; 3]]) {
    for (triangle, ear) in fan.iter_mut().zip(ears) {
        *triangle = ear.map(|corner| corners[corner as usize]);
    }
}

/// Cuts a polygon into ears; `None` if its fan stays.
pub(super) fn ears(corners: &[Vec3], budget: &mut Budget) -> Option<Vec<[u32; 3]>> {
    if corners.len() < 4 {
        return None;
    }
    let flat = project(corners)?;
    let wrong = |k: usize| turn(flat[0], flat[k], flat[k + 1]) == Ordering::Less;
    if !(1..flat.len() - 1).any(wrong) {
        return None;
    }
    budget.tries += 64 * corners.len() as u64;
    let cut = ears::Cutter::new(&flat, &mut budget.tries).cut();
    budget.uncut += u64::from(cut.is_none() && budget.tries == 0);
    cut
}

/// A corner in the plane of the projection.
type Flat = [f64; 2];

/// Projects a polygon so that it runs to the left; `None` if it has no normal.
fn project(corners: &[Vec3]) -> Option<Vec<Flat>> {
    let at = |corner: &Vec3| corner.as_dvec3();
    let first = at(&corners[0]);
    let fan = corners[1..].windows(2);
    let normal: DVec3 = fan.map(|pair| (at(&pair[0]) - first).cross(at(&pair[1]) - first)).sum();
    let size = normal.abs();
    if !normal.is_finite() || normal == DVec3::ZERO {
        return None;
    }
    let (component, kept) = if size.x >= size.y && size.x >= size.z {
        (normal.x, [1, 2])
    } else if size.y >= size.z {
        (normal.y, [2, 0])
    } else {
        (normal.z, [0, 1])
    };
    // Negation is exact.
    let side = if component < 0.0 { -1.0 } else { 1.0 };
    let flat = |corner: &Vec3| {
        let of = |axis: usize| f64::from(corner[axis]);
        [side * of(kept[0]), of(kept[1])]
    };
    Some(corners.iter().map(flat).collect())
}

/// Which way the path a b c turns: `Greater` to the left, `Less` to the right, `Equal` if the three
/// are on one line. Coordinates are those of `f32`, so that products are exact in f64, and the sum
/// of the six products is exact as an expansion [Shewchuk 1997, Grow-Expansion].
fn turn(a: Flat, b: Flat, c: Flat) -> Ordering {
    let products =
        [a[0] * b[1], -(a[1] * b[0]), b[0] * c[1], -(b[1] * c[0]), c[0] * a[1], -(c[1] * a[0])];
    let mut parts = [0.0; 6];
    for (k, &product) in products.iter().enumerate() {
        let mut sum = product;
        for part in &mut parts[..k] {
            let rounded = sum + *part;
            let kept = rounded - sum;
            // What the rounded sum lacks.
            *part = (sum - (rounded - kept)) + (*part - kept);
            sum = rounded;
        }
        parts[k] = sum;
    }
    // The last part that is not 0 is larger than all before it together.
    let largest = parts.iter().rev().find(|part| **part != 0.0).copied().unwrap_or(0.0);
    largest.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}
