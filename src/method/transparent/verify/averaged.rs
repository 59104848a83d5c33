//! The average of a client's groups at a pixel.

use super::planes::{AveragePlanes, GroupFound};
use super::replayed::Layers;
use crate::composite::groups::WeightedFragment;
use crate::composite::over::Blend;
use crate::method::Holds;
use crate::method::algorithm::Job;
use crate::method::checks::{anything, input, inputs, number, triple};
use crate::method::ewa::verify::handed::Handed;
use crate::method::judged::PixelMarks;
use crate::method::single_pass::verify::compositing::Compositing;
use crate::method::single_pass::verify::images::{Sample, Samples};
use crate::method::transparent::Holes;
use crate::number::ball::Profile;
use crate::number::{Ball, Real};

/// What all pixels share.
pub(super) struct Averaging<'a, P: Profile> {
    nearest: Compositing<'a, P>,
    holes: Holes,
    /// Whether an environment is seen behind the layers.
    environment: bool,
}

/// The average of all groups.
struct Average<P: Profile> {
    blend: Blend<Ball<P>>,
    opacity: Ball<P>,
    hidden: Ball<P>,
    layers: Ball<P>,
}

impl<'a, P: Profile> Averaging<'a, P> {
    pub(super) fn new(job: &Job<'a>, holes: Holes, handed: &'a Handed<'a>) -> Self {
        let nearest = Compositing::new(job, handed, Ball::ZERO);
        Self { nearest, holes, environment: job.scene.environment.is_some() }
    }

    /// Marks what is wrong with the average at a pixel.
    pub(super) fn judge(
        &self,
        at: (u32, u32),
        groups: &[GroupFound<P>],
        planes: &AveragePlanes<'_>,
        pixel: &mut PixelMarks<'_>,
    ) {
        if let Some(samples) = groups.iter().map(samples).collect::<Option<Vec<_>>>() {
            self.nearest.check_nearest(at, &samples, pixel);
        }
        let Average { blend, opacity, hidden, layers } = self.average(groups);
        let report = &mut |_: usize, error: f64, fault: &dyn Fn() -> _| pixel.found(error, fault);
        let scalars = [
            (&planes.alpha, blend.alpha),
            (&planes.opacity, opacity),
            (&planes.hidden, hidden),
            (&planes.layers, layers),
        ];
        for (plane, truth) in scalars {
            if let Some(plane) = plane {
                number(0, plane, at, truth, report);
            }
        }
        if let Some(plane) = &planes.color {
            triple(0, (plane, Holds::Color), at, blend.color, report);
        }
        // The picture is made of the client's own average.
        let color = planes.color.map_or(blend.color, |plane| inputs(&plane, at));
        let alpha = planes.alpha.map_or(blend.alpha, |plane| input(&plane, at));
        let layers = planes.layers.map_or(layers, |plane| input(&plane, at));
        if let Some(plane) = &planes.shown {
            let color = if self.environment { [anything(); 3] } else { color };
            triple(0, (plane, Holds::Color), at, color, report);
        }
        if let Some(plane) = &planes.shown_alpha {
            // Averages of opacities may round to a little more than 1, and then no environment is seen.
            let alpha = if self.environment { Ball::ONE.at_least(alpha) } else { alpha };
            number(0, plane, at, alpha, report);
        }
        if let Some(plane) = &planes.shown_layers {
            number(0, plane, at, layers, report);
        }
    }

    /// Sums in the order of the groups, divided once.
    fn average(&self, groups: &[GroupFound<P>]) -> Average<P> {
        let mut sum = Average {
            blend: Blend::CLEAR,
            opacity: Ball::ZERO,
            hidden: Ball::ZERO,
            layers: Ball::ZERO,
        };
        let mut taken = Some(0_u8);
        for group in groups {
            let takes = |count: u8| u8::from(count > 0 || self.holes == Holes::Background);
            taken = match (taken, self.holes, group.count) {
                (Some(taken), Holes::Background, _) => Some(taken + 1),
                (Some(taken), _, Some(count)) => Some(taken + takes(count)),
                _ => None,
            };
            sum.blend = sum.blend.plus(&Blend { color: group.color, alpha: group.alpha });
            sum.opacity = sum.opacity + group.opacity;
            sum.hidden = sum.hidden + group.hidden;
            let count = group.count.map_or(anything(), |count| Ball::exact(count.into()));
            sum.layers = sum.layers + count;
        }
        let count = match taken {
            Some(0) => return sum,
            Some(count) => Ball::exact(count.into()),
            None => anything(),
        };
        Average {
            blend: Blend {
                color: sum.blend.color.map(|part| part / count),
                alpha: sum.blend.alpha / count,
            },
            opacity: sum.opacity / count,
            hidden: sum.hidden / count,
            layers: sum.layers / count,
        }
    }
}

/// What may be the nearest of a group; none if that is not known.
fn samples<P: Profile>(group: &GroupFound<P>) -> Option<Samples<P>> {
    let sample = |layers: &Layers<P>| {
        let depth = group.depth.unwrap_or(layers.depth);
        // Depths decide.
        let nearness = -depth;
        let read = WeightedFragment { depth, ..WeightedFragment::EMPTY };
        Sample { surfel: layers.surfel, nearness, read }
    };
    let all = group.all.as_ref()?.iter().map(sample).collect();
    Some(Samples { all, stored: false, depth_stored: group.depth.is_some() })
}
