//! The pixels that a splat may touch.

use crate::oracle::gaussians::model::Model;
use crate::oracle::kit::condition::Conditioned;
use splatref::method::gaussians::{Settings, Support};

/// The pixels from the first to the last column and row, none if `last` is before `first`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds(pub(crate) [[f64; 2]; 2]);

impl Bounds {
    pub(crate) fn hold(&self, pixel: [f64; 2]) -> bool {
        (0..2).all(|a| self.0[a][0] <= pixel[a] && pixel[a] <= self.0[a][1])
    }

    pub(crate) fn any(&self) -> bool {
        self.0.iter().all(|[first, last]| first <= last)
    }
}

impl Model<'_> {
    /// How far a splat reaches in x and y: of (least, likely, most) extents by rounding.
    fn extents(
        &self,
        support: Support,
        (v, det, o): (&[Conditioned; 3], Conditioned, Conditioned),
    ) -> [[f64; 2]; 2] {
        let Settings { cutoff, least_alpha, .. } = *self.settings;
        let (k, least) = (f64::from(cutoff), f64::from(least_alpha));
        let [xx, yy] = [v[0], v[2]];
        let roomy = 1.0 + (-10.0_f64).exp2();
        let both = |raw: f64, error: f64, ceil: bool| {
            let margin = (1e-6 * raw).max(16.0 * error);
            [raw - margin, raw + margin].map(|e| if ceil { e.ceil() } else { e * roomy + 1.0 })
        };
        let along = |factor: f64, ceil: bool| {
            [xx, yy].map(|v| {
                let deviation = v.value.sqrt();
                both(factor * deviation, factor * v.condition / deviation, ceil)
            })
        };
        match support {
            Support::None => along((2.0 * (o.value / least).ln()).sqrt(), false),
            Support::Ellipse => along(k, false),
            Support::Boxes => along((2.0 * (255.0 * o.value).ln()).sqrt().min(k), true),
            Support::Tiles => {
                let half = (xx.value - yy.value) / 2.0;
                let apart = half.hypot(v[1].value).max(0.1_f64.sqrt());
                let greater = (xx.value + yy.value) / 2.0 + apart;
                let error = xx.condition + yy.condition + det.condition / greater;
                let side = both(k * greater.sqrt(), k * error / greater.sqrt(), true);
                [side, side]
            }
        }
        .map(|[narrow, wide]| if wide.is_nan() { [-1e9, -1e9] } else { [narrow, wide] })
    }

    /// The bounds that a splat may have, and those that it has for certain.
    pub(crate) fn bounds(
        &self,
        screen: &[Conditioned; 2],
        v: &[Conditioned; 3],
        det: Conditioned,
        o: Conditioned,
    ) -> [Bounds; 2] {
        let own = self.settings.support;
        let all = self.bounds_by(own, screen, (v, det, o));
        if own == Support::None || self.settings.least_alpha == 0.0 {
            return all;
        }
        // Nor is there anything where alpha is less than the least.
        let dense = self.bounds_by(Support::None, screen, (v, det, o));
        [0, 1].map(|i| {
            let axis = |a: usize| {
                let ([first, last], [from, to]) = (all[i].0[a], dense[i].0[a]);
                [first.max(from), last.min(to)]
            };
            Bounds([0, 1].map(axis))
        })
    }

    /// The bounds by one rule.
    fn bounds_by(
        &self,
        support: Support,
        screen: &[Conditioned; 2],
        ellipse: (&[Conditioned; 3], Conditioned, Conditioned),
    ) -> [Bounds; 2] {
        let extents = self.extents(support, ellipse);
        let size = [self.camera.width, self.camera.height].map(f64::from);
        [1, 0].map(|wide| {
            Bounds([0, 1].map(|a| {
                let (at, e) = (screen[a].value, extents[a][wide]);
                let slack = (1e-6 * (at.abs() + e)).max(16.0 * screen[a].condition);
                let slack = if wide == 1 { slack } else { -slack };
                let (low, high) = (at - e - slack, at + e + slack);
                let [first, last] = if e < 0.0 {
                    [0.0, -1.0]
                } else if support == Support::Tiles {
                    let [low, high] = [low - 0.5, high - 1.5];
                    [(low / 16.0).floor() * 16.0, (high / 16.0).floor() * 16.0 + 15.0]
                } else if support == Support::Boxes {
                    [(low / 16.0).floor() * 16.0, (high / 16.0).floor() * 16.0 + 15.0]
                } else {
                    [(low - 0.5).ceil(), (high - 0.5).floor()]
                };
                [first.max(0.0), last.min(size[a] - 1.0)]
            }))
        })
    }
}
