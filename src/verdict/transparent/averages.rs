//! The average of a client's groups at a pixel.

use super::planes::GroupFound;
use crate::composite::over::Blend;
use crate::method::Holds;
use crate::method::transparent::Holes;
use crate::method::transparent::averaging::GroupAverage;
use crate::method::transparent::planes::AVERAGES;
use crate::number::Ball;
use crate::number::ball::Profile;
use crate::verdict::checks::{anything, input, inputs, number, triple};
use crate::verdict::client::{Client, StoredPlane};
use crate::verdict::marks::PixelMarks;

/// The planes of the averages, each if it is there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AveragePlanes<'a> {
    color: Option<StoredPlane<'a, [f64; 3]>>,
    /// Opacity, sum of opacities, what is hidden, and count of layers.
    scalars: [Option<StoredPlane<'a, f64>>; 4],
}

impl<'a> AveragePlanes<'a> {
    pub(crate) fn new(client: &'a Client) -> Self {
        let [color, scalars @ ..] = &AVERAGES;
        Self {
            color: client.triple(color),
            scalars: scalars.each_ref().map(|row| client.scalar(row)),
        }
    }

    /// The names of those that are there.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        let scalars = self.scalars.iter().flatten().map(|plane| plane.name);
        self.color.iter().map(|plane| plane.name).chain(scalars).collect()
    }

    /// Marks what is wrong with the average at a pixel; gives it as the next pass reads it, without
    /// depth and surfel.
    pub(crate) fn judge<P: Profile>(
        &self,
        at: (u32, u32),
        (groups, holes): (&[GroupFound<P>], Holes),
        pixel: &mut PixelMarks<'_>,
    ) -> GroupAverage<Ball<P>> {
        let average = average(groups, holes);
        let report = &mut |_: usize, error: f64, fault: &dyn Fn() -> _| pixel.found(error, fault);
        let GroupAverage { blend, opacity, hidden, layers, .. } = average;
        let truths = [blend.alpha, opacity, hidden, layers];
        for (plane, truth) in self.scalars.iter().zip(truths) {
            if let Some(plane) = plane {
                number(0, plane, at, truth, report);
            }
        }
        if let Some(plane) = &self.color {
            triple(0, (plane, Holds::Color), at, blend.color, report);
        }
        let read = |i: usize| self.scalars[i].map_or(truths[i], |plane| input(&plane, at));
        GroupAverage {
            blend: Blend {
                color: self.color.map_or(blend.color, |plane| inputs(&plane, at)),
                alpha: read(0),
            },
            opacity: read(1),
            hidden: read(2),
            layers: read(3),
            ..average
        }
    }
}

/// Sums in the order of the groups, divided once.
fn average<P: Profile>(groups: &[GroupFound<P>], holes: Holes) -> GroupAverage<Ball<P>> {
    let mut sum = GroupAverage::EMPTY;
    let mut taken = Some(0_u8);
    for group in groups {
        let takes = |count: u8| u8::from(count > 0 || holes == Holes::Background);
        taken = match (taken, holes, group.count) {
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
    match taken {
        Some(0) => sum,
        Some(count) => sum.divided(Ball::exact(count.into())),
        None => sum.divided(anything()),
    }
}
