//! Drop whole clusters of surfels whose fate is known.
//!
//! A view tests the bounds of a [`Cluster`] before it projects the surfels. Any answer but none is the
//! [`Fate`] of every surfel of the cluster in [`mod@super::project`], in `f32` with all its rounding
//! errors and in exact arithmetic. So the picture and the tally stay as they are. The tests are
//! evaluated in `f64`.
//!
//! **Place.** c and a are the cluster's centre and axis in view space. M is the rotation of the view
//! matrix, with the third column m. L, the root of the greatest absolute row sum of M M^T, bounds
//! |M v|/|v|. `f32` rounds a component of a point in view space four times, so it is off by less than
//! 2^-22 of the sum of its terms. So every centre is, before and after rounding, within
//!
//! ```text
//!   e = L radius + 2^-20 (L (|centre| + radius) + |m.x| + |m.y| + |m.z|) + 10^-18
//! ```
//!
//! of c, and its depth within [t0, t1], which is t - e to t + e.
//!
//! **Behind**: t1 <= near. All other answers need t0 > near.
//!
//! **Facing.** With n = a + b, |b| <= L spread, and p = c + q, |q| <= e, the product g t = n . p of
//! each surfel differs from a . c by at most
//!
//! ```text
//!   f = L (1 + 2^-10) e + L spread (|c| + e)
//! ```
//!
//! Under an orthographic camera g = -n.z differs from -a.z by at most f = L spread. The cluster shows
//! its back if a . c - f >= t1/32, and its front if a . c + f <= -t1/32 (orthographic: -a.z and 1/32).
//! Then |g| >= 1/32, and rounding moves g by less than 2^-16.
//!
//! **Sound.** Any number that would make a surfel degenerate lies beyond 2^96, or an amplitude below
//! 2^-96. No surfel is degenerate if all of these hold:
//!
//! - Every absolute row sum of M M^T - I is at most 2^-14. fx and fy are in [2^-20, 2^20], and
//!   neither is more than 2^8 times the other. |cx|, |cy| <= 2^40, and |c| + e <= 2^20.
//! - Under a perspective camera near >= 10^-18, t0 >= 2^-20, and |c.x| + e and |c.y| + e are at most 16
//!   t0. So |d.x|, |d.y| <= 16.
//! - reach fx/(k t0), reach fy/(k t0) <= 2^16, and least fx/(k t1), least fy/(k t1) >= 2^-16. These are
//!   standard deviations in px (orthographic: without t).
//! - t0 >= 2 reach, if a perspective camera does not draw affine outlines. `rest` is then in [3/4, 1].
//!
//! The reasons, with R the reach over k:
//!
//! - The vectors c and e of a disc are at most 17 long, so xx <= (17 sx R)^2, and so for yy and for
//!   ellipses.
//! - For a disc area >= sx sy R^2/32. An ellipse has |N| >= R^2/16, and N/|N| in the place of n still gives
//!   |g| >= 1/64. So area >= sx sy R^2/1024 >= 2^-42.
//! - xx yy - xy^2 = area^2, so sqrt(yy) >= area/sqrt(xx) >= 2^-15 sy R. Rounding changes the components that
//!   are squared by less than 2^-18 sy R.
//! - The rank-one update of an exact outline only adds to xx, yy and area.
//! - So, with h <= 16, amplitude >= 2^-42/2^40, ux <= 2^64, |uy| <= 2 sqrt(xx)/area <= 2^64 and vy <= 2^32,
//!   all but the amplitude times at most 2^20 if rays are cast. The gradient of nearness is at most 2^46.
//!
//! **Fate.** A sound cluster that shows its back is `BackFacing` where backs are culled. Any other sound
//! cluster that shows its back or its front is `Outside` if for one side of the view
//!
//! ```text
//!   fx c.x + cx t < -(((reach + e) slope + (k sqrt(h)) (t + e)) (1 + 2^-10)
//!                     + 2^-18 (slope |c| + |cx|))
//! ```
//!
//! with slope = sqrt(fx fx + cx cx), and so for the other sides. (Orthographic: t and t + e are 1, and
//! slope is fx.) In every other case nothing is known.

use super::frustum::Frustum;
use super::{Fate, Kernel, Outline, Projector, View};
use crate::index::clusters::Cluster;
use crate::number::{Real, Vector3};

/// A view that asks clusters.
pub(crate) struct ClusterView {
    view: View<f64>,
    frustum: Frustum<f64>,
    /// k.
    cutoff: f64,
    affine: bool,
    cull: bool,
    /// L.
    stretch: f64,
    /// |m.x| + |m.y| + |m.z|.
    shift: f64,
    /// Whether the numbers of the camera are in the ranges of a sound cluster.
    sound: bool,
}

impl ClusterView {
    pub(crate) fn new(projector: &Projector<f32>) -> Self {
        let view = projector.view.map_f64();
        let kernel = Kernel {
            outline: projector.outline,
            cutoff: projector.cutoff,
            low_pass: projector.low_pass,
        };
        let [x, y, z] = &view.rows;
        let dot = |a: &[f64; 4], b: &[f64; 4]| (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
        let (xx, yy, zz) = (dot(x, x), dot(y, y), dot(z, z));
        let [xy, xz, yz] = [dot(x, y).abs(), dot(x, z).abs(), dot(y, z).abs()];
        let most = |sums: [f64; 3]| sums[0].at_least(sums[1]).at_least(sums[2]);
        let row_sums = |x: f64, y: f64, z: f64| most([x + xy + xz, y + xy + yz, z + xz + yz]);
        let length = row_sums(xx, yy, zz);
        let rigid =
            row_sums((xx - 1.0).abs(), (yy - 1.0).abs(), (zz - 1.0).abs()) <= 1.0 / 16_384.0;
        let usual = |f: f64| (SMALL..=LARGE).contains(&f);
        let sound = rigid
            && [view.fx, view.fy].iter().all(|f| usual(*f))
            && (view.fx <= 256.0 * view.fy && view.fy <= 256.0 * view.fx)
            && [view.cx, view.cy].iter().all(|c| c.abs() <= LARGE * LARGE)
            && (!view.perspective || view.near >= TINY);
        Self {
            frustum: Frustum::new(&view, &kernel),
            view,
            cutoff: kernel.cutoff.into(),
            affine: projector.outline == Outline::Affine,
            cull: projector.cull,
            stretch: length.sqrt() * (1.0 + ROUNDING),
            shift: x[3].abs() + y[3].abs() + z[3].abs(),
            sound,
        }
    }

    /// The fate of every surfel of a cluster, if it is known; see the module page.
    #[inline(always)]
    pub(crate) fn fate(&self, cluster: &Cluster) -> Option<Fate> {
        let Self { view, stretch, .. } = self;
        let (center, radius) = (Vector3::from_glam(cluster.center), f64::from(cluster.radius));
        let p = view.point(center);
        let terms = stretch * (center.length() + radius) + self.shift;
        let around = stretch * radius + terms * ROUNDING + TINY;
        let [first, last] = [-p.z - around, -p.z + around];
        if last <= view.near {
            return Some(Fate::Behind);
        }
        let (axis, spread) =
            (view.direction(Vector3::from_glam(cluster.axis)), f64::from(cluster.spread));
        let (toward, open, depth) = if view.perspective {
            let most = stretch * (1.0 + 1.0 / 1024.0) * around;
            (axis.dot(p), most + stretch * spread * (p.length() + around), last)
        } else {
            (-axis.z, stretch * spread, 1.0)
        };
        let [back, front] = [toward - open >= depth / 32.0, toward + open <= -depth / 32.0];
        let fate = if self.cull && back {
            Fate::BackFacing
        } else if (back || front) && self.frustum.misses(p, around, f64::from(cluster.reach)) {
            Fate::Outside
        } else {
            return None;
        };
        (first > view.near && self.is_sound(cluster, p, [around, first, last])).then_some(fate)
    }

    /// Whether no surfel of the cluster can be degenerate, if each shows its back or its front.
    #[inline(always)]
    fn is_sound(
        &self,
        cluster: &Cluster,
        p: Vector3<f64>,
        [around, first, last]: [f64; 3],
    ) -> bool {
        let View { fx, fy, perspective, .. } = self.view;
        let (reach, least) = (f64::from(cluster.reach), f64::from(cluster.least));
        let (narrow, wide) = if fx < fy { (fx, fy) } else { (fy, fx) };
        let [near, far] = if perspective { [first, last] } else { [1.0; 2] };
        let limit = 16.0 * first;
        let sides = p.x.abs() + around <= limit && p.y.abs() + around <= limit;
        let apart = sides && first >= SMALL && (self.affine || first >= 2.0 * reach);
        let size = reach * wide <= 65_536.0 * (self.cutoff * near)
            && least * narrow * 65_536.0 >= self.cutoff * far;
        self.sound && size && (apart || !perspective) && p.length() + around <= LARGE
    }
}

/// 2^-20: more than what rounding moves a point by, in units of the terms of its sums.
const ROUNDING: f64 = 1.0 / 1_048_576.0;
/// 10^-18: more than what numbers lose that are too small for `f32`, and their squares.
const TINY: f64 = 1e-18;
/// 2^-20.
const SMALL: f64 = 1.0 / LARGE;
/// 2^20.
const LARGE: f64 = 1_048_576.0;

#[cfg(test)]
pub(crate) mod tests;
