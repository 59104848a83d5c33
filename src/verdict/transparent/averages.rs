//! Verify the average of a client's groups at a pixel.

use super::planes::GroupFound;
use crate::composite::over::Blend;
use crate::method::Job;
use crate::method::stage::{Conditions, Keep};
use crate::method::transparent::Holes;
use crate::method::transparent::averaging::GroupAverage;
use crate::number::Ball;
use crate::number::ball::Profile;
use crate::verdict::checks::anything;
use crate::verdict::client::Client;
use crate::verdict::marks::PixelMarks;
use crate::verdict::planes::RecordPlanes;

/// The planes of the averages.
#[derive(Clone, Debug)]
pub(crate) struct AveragePlanes<'a> {
    planes: RecordPlanes<'a>,
    there: Conditions,
}

impl<'a> AveragePlanes<'a> {
    pub(crate) fn new(job: &Job<'_>, client: &'a Client) -> Self {
        let planes = RecordPlanes::new(client, &GroupAverage::<f32>::PLANES, 0);
        Self { planes, there: job.there(Keep::Alone) }
    }

    /// The names of the planes that are there.
    pub(crate) fn names(&self) -> Vec<&'static str> {
        self.planes.names().to_vec()
    }

    /// Marks a wrong average at a pixel. Returns the average as the next pass reads it, without
    /// depth and surfel.
    pub(crate) fn judge<P: Profile>(
        &self,
        at: (u32, u32),
        groups: &[GroupFound<P>],
        holes: Holes,
        pixel: &mut PixelMarks<'_>,
    ) -> GroupAverage<Ball<P>> {
        let mut average = average(groups, holes);
        let report = &mut |_: usize, error: f64, fault: &dyn Fn() -> _| pixel.found(error, fault);
        self.planes.check(0, &GroupAverage::PLANES, at, &average, report);
        self.planes.read(&GroupAverage::PLANES, &self.there, at, &mut average);
        average
    }
}

/// Sums the groups in their order, and divides once.
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
