//! The picture of a client at a pixel: its nearest layer before the average of the others.

use crate::method::Holds;
use crate::method::algorithm::Job;
use crate::method::checks::{anything, number, triple};
use crate::method::judged::PixelMarks;
use crate::method::resolved::{ALPHA, SHADED};
use crate::method::transparent::averaging::GroupAverage;
use crate::method::transparent_hq::compositing::{count, count_by_opacity};
use crate::method::transparent_hq::nearest::FrontLayer;
use crate::method::transparent_hq::planes::{LAYERS, LAYERS_BY_OPACITY};
use crate::number::ball::Profile;
use crate::number::{Ball, Real};
use crate::verify::client::{Client, Stored};

/// The planes of the picture, each if it is there.
pub(super) struct Shown<'a> {
    color: Option<Stored<'a, [f64; 3]>>,
    alpha: Option<Stored<'a, f64>>,
    /// Counts of layers: by opacity, and as they are.
    counts: [Option<Stored<'a, f64>>; 2],
    /// Whether an environment is seen behind the layers.
    environment: bool,
}

impl<'a> Shown<'a> {
    pub(super) fn new(job: &Job<'a>, client: &'a Client) -> Self {
        Self {
            color: client.triple(&SHADED),
            alpha: client.scalar(&ALPHA),
            counts: [&LAYERS_BY_OPACITY, &LAYERS].map(|row| client.scalar(row)),
            environment: job.scene.environment.is_some(),
        }
    }

    /// The names of the planes that are judged.
    pub(super) fn names(&self) -> Vec<&'static str> {
        let scalars = self.alpha.iter().chain(self.counts.iter().flatten());
        let color = self.color.iter().map(|plane| plane.name);
        color.chain(scalars.map(|plane| plane.name)).collect()
    }

    /// Marks what is wrong with the picture at a pixel.
    pub(super) fn judge<P: Profile>(
        &self,
        at: (u32, u32),
        near: &FrontLayer<Ball<P>>,
        others: &GroupAverage<Ball<P>>,
        pixel: &mut PixelMarks<'_>,
    ) {
        let there = near.depth.is_finite();
        let over = others.blend.over(near.opacity, near.color);
        let part = |c: usize| Ball::select(there, over.color[c], others.blend.color[c]);
        let color = if self.environment { [anything(); 3] } else { [0, 1, 2].map(part) };
        let alpha = Ball::select(there, over.alpha, others.blend.alpha);
        let alpha = if self.environment { Ball::ONE.at_least(alpha) } else { alpha };
        let scalars = [
            (&self.alpha, alpha),
            (&self.counts[0], count_by_opacity(near, others)),
            (&self.counts[1], count(near, others)),
        ];
        let report = &mut |_: usize, error: f64, fault: &dyn Fn() -> _| pixel.found(error, fault);
        for (plane, truth) in scalars {
            if let Some(plane) = plane {
                number(0, plane, at, truth, report);
            }
        }
        if let Some(plane) = &self.color {
            triple(0, (plane, Holds::Color), at, color, report);
        }
    }
}
