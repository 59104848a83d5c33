//! Verify a client's picture at a pixel: the nearest group, and the colour of the average.

use super::planes::GroupFound;
use super::replay::Layers;
use crate::composite::groups::WeightedFragment;
use crate::method::Job;
use crate::method::transparent::averaging::GroupAverage;
use crate::method::transparent::planes::LAYERS;
use crate::number::ball::Profile;
use crate::number::{Ball, Real};
use crate::verdict::checks::{Backdrop, is_bounded, number, triple};
use crate::verdict::client::{Client, StoredPlane};
use crate::verdict::ewa::client_planes::ClientPlanes;
use crate::verdict::marks::PixelMarks;
use crate::verdict::single_pass::compositing::Compositing;
use crate::verdict::single_pass::images::{Sample, Samples};

/// The parts that all pixels share.
pub(super) struct PictureJudge<'a, P: Profile> {
    client_planes: &'a ClientPlanes<'a>,
    layers: Option<StoredPlane<'a, f64>>,
    nearest: Compositing<'a, P>,
    backdrop: Backdrop<'a, P>,
}

impl<'a, P: Profile> PictureJudge<'a, P> {
    pub(super) fn new(
        job: &Job<'a>,
        client: &'a Client,
        client_planes: &'a ClientPlanes<'a>,
    ) -> Self {
        let nearest = Compositing::new(job, client_planes, Ball::ZERO);
        Self {
            client_planes,
            layers: client.scalar(&LAYERS),
            nearest,
            backdrop: Backdrop::new(job),
        }
    }

    /// The names of the planes that are judged.
    pub(super) fn names(&self) -> Vec<&'static str> {
        let ClientPlanes { shaded, alpha, depth, id, .. } = self.client_planes;
        let scalar = |plane: &Option<StoredPlane<'_, f64>>| plane.map(|plane| plane.name);
        let all = [
            shaded.map(|plane| plane.name),
            scalar(alpha),
            scalar(depth),
            id.map(|plane| plane.name),
            scalar(&self.layers),
        ];
        all.into_iter().flatten().collect()
    }

    /// Marks a wrong picture at a pixel. Returns whether its colour is judged, or is not there.
    pub(super) fn judge(
        &self,
        at: (u32, u32),
        groups: &[GroupFound<P>],
        average: &GroupAverage<Ball<P>>,
        pixel: &mut PixelMarks<'_>,
    ) -> bool {
        if let Some(samples) = groups.iter().map(samples).collect::<Option<Vec<_>>>() {
            self.nearest.check_nearest(at, &samples, pixel);
        }
        let shown = self.backdrop.behind(average.blend, at);
        let report = &mut |_: usize, error: f64, fault: &dyn Fn() -> _| pixel.found(error, fault);
        if let Some(plane) = &self.client_planes.shaded {
            triple(0, plane, at, shown.color, report);
        }
        if let Some(plane) = &self.client_planes.alpha {
            number(0, plane, at, shown.alpha, report);
        }
        if let Some(plane) = &self.layers {
            number(0, plane, at, average.layers, report);
        }
        self.client_planes.shaded.is_none() || is_bounded(&shown.color)
    }
}

/// The samples of a group that may be the nearest; none if they are not known.
fn samples<P: Profile>(group: &GroupFound<P>) -> Option<Samples<P>> {
    let sample = |layers: &Layers<P>| {
        let depth = group.depth.unwrap_or(layers.depth);
        // This method compares depths, so the nearness is -depth.
        let nearness = -depth;
        let read = WeightedFragment { depth, ..WeightedFragment::EMPTY };
        Sample { surfel: layers.surfel, nearness, read }
    };
    let all = group.all.as_ref()?.iter().map(sample).collect();
    Some(Samples { all, stored: false, depth_stored: group.depth.is_some() })
}
