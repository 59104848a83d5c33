//! Average four neighbours in lanes: the formulas of [`crate::composite::mean`].

#![expect(
    clippy::needless_range_loop,
    reason = "a lane is an index into several arrays, and such a loop becomes vectors"
)]

use crate::number::Real;
use crate::number::lanes::{LANES, Lanes, each};

/// The weights of four neighbours, 0 for one that takes no part.
pub(crate) struct MeanLanes {
    weights: [Lanes; 4],
    /// 1 divided by the sum of the weights.
    scale: Lanes,
}

impl MeanLanes {
    #[inline(always)]
    pub(crate) fn new(weights: [Lanes; 4]) -> Self {
        let [a, b, c, d] = &weights;
        let scale = each(|i| 1.0 / ((a[i] + b[i]) + (c[i] + d[i])));
        Self { weights, scale }
    }

    /// The average of a number: [`Mean::average`] in lanes, spelled out in one long loop.
    ///
    /// [`Mean::average`]: crate::composite::mean::Mean::average
    #[inline(always)]
    pub(crate) fn average(&self, a: &[Lanes; 4]) -> Lanes {
        let mut average = [0.0; LANES];
        for i in 0..LANES {
            let (w, a, takes) = self.lane(i, a);
            let term = [
                if takes[0] { w[0] * a[0] } else { 0.0 },
                if takes[1] { w[1] * a[1] } else { 0.0 },
                if takes[2] { w[2] * a[2] } else { 0.0 },
                if takes[3] { w[3] * a[3] } else { 0.0 },
            ];
            let sum = (term[0] + term[1]) + (term[2] + term[3]);
            let (least, greatest) = (least(takes, a), greatest(takes, a));
            average[i] = (sum * self.scale[i]).at_least(least).at_most(greatest) + 0.0;
        }
        average
    }

    /// The least of a number.
    #[inline(always)]
    pub(crate) fn least(&self, a: &[Lanes; 4]) -> Lanes {
        each(|i| {
            let (_, a, takes) = self.lane(i, a);
            least(takes, a)
        })
    }

    /// The greatest of a number.
    #[inline(always)]
    pub(crate) fn greatest(&self, a: &[Lanes; 4]) -> Lanes {
        each(|i| {
            let (_, a, takes) = self.lane(i, a);
            greatest(takes, a)
        })
    }

    /// Weights and numbers of the four cells of a lane, and which of them take part.
    #[inline(always)]
    fn lane(&self, i: usize, a: &[Lanes; 4]) -> ([f32; 4], [f32; 4], [bool; 4]) {
        let w = [self.weights[0][i], self.weights[1][i], self.weights[2][i], self.weights[3][i]];
        let takes = [w[0] > 0.0, w[1] > 0.0, w[2] > 0.0, w[3] > 0.0];
        (w, [a[0][i], a[1][i], a[2][i], a[3][i]], takes)
    }
}

/// [`Mean::least`](crate::composite::mean::Mean::least).
#[inline(always)]
fn least(takes: [bool; 4], a: [f32; 4]) -> f32 {
    let a = [
        if takes[0] { a[0] } else { f32::INFINITY },
        if takes[1] { a[1] } else { f32::INFINITY },
        if takes[2] { a[2] } else { f32::INFINITY },
        if takes[3] { a[3] } else { f32::INFINITY },
    ];
    (a[0].at_most(a[1])).at_most(a[2].at_most(a[3]))
}

/// [`Mean::greatest`](crate::composite::mean::Mean::greatest).
#[inline(always)]
fn greatest(takes: [bool; 4], a: [f32; 4]) -> f32 {
    let a = [
        if takes[0] { a[0] } else { f32::NEG_INFINITY },
        if takes[1] { a[1] } else { f32::NEG_INFINITY },
        if takes[2] { a[2] } else { f32::NEG_INFINITY },
        if takes[3] { a[3] } else { f32::NEG_INFINITY },
    ];
    (a[0].at_least(a[1])).at_least(a[2].at_least(a[3]))
}
