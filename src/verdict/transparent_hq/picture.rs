//! Verify a client's picture at a pixel: its nearest layer before the average of the others.

use crate::composite::over::Blend;
use crate::method::Job;
use crate::method::surface::{ALPHA, SHADED};
use crate::method::transparent::averaging::GroupAverage;
use crate::method::transparent_hq::Settings;
use crate::method::transparent_hq::compositing::{Through, count, count_by_opacity};
use crate::method::transparent_hq::nearest::FrontLayer;
use crate::method::transparent_hq::planes::{LAYERS, LAYERS_BY_OPACITY};
use crate::number::ball::Profile;
use crate::number::{Ball, MapInline};
use crate::scene::Environment;
use crate::verdict::checks::{Backdrop, is_bounded, number, triple};
use crate::verdict::client::{Client, StoredPlane};
use crate::verdict::marks::PixelMarks;

/// The planes of the picture, each if it is there.
pub(super) struct PictureJudge<'a, P: Profile> {
    color: Option<StoredPlane<'a, [f64; 3]>>,
    alpha: Option<StoredPlane<'a, f64>>,
    /// Counts of layers: weighted by opacity, and plain.
    counts: [Option<StoredPlane<'a, f64>>; 2],
    through: Through<'a, Ball<P>>,
    backdrop: Backdrop<'a, P>,
}

impl<'a, P: Profile> PictureJudge<'a, P> {
    pub(super) fn new(job: &Job<'a>, settings: &'a Settings, client: &'a Client) -> Self {
        Self {
            color: client.triple(&SHADED),
            alpha: client.scalar(&ALPHA),
            counts: [&LAYERS_BY_OPACITY, &LAYERS].map_inline(|row| client.scalar(row)),
            through: Through::new(job, settings, Environment::enclosure),
            backdrop: Backdrop::new(job),
        }
    }

    /// The names of the planes that are judged.
    pub(super) fn names(&self) -> Vec<&'static str> {
        let scalars = self.alpha.iter().chain(self.counts.iter().flatten());
        let color = self.color.iter().map(|plane| plane.name);
        color.chain(scalars.map(|plane| plane.name)).collect()
    }

    /// Marks a wrong picture at a pixel. Returns whether its colour is judged, or is not there.
    pub(super) fn judge(
        &self,
        at: (u32, u32),
        near: &FrontLayer<Ball<P>>,
        others: &GroupAverage<Ball<P>>,
        pixel: &mut PixelMarks<'_>,
    ) -> bool {
        let layers = self.through.pixel(at, near, others);
        let Blend { color, alpha } = self.backdrop.behind(layers, at);
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
            triple(0, plane, at, color, report);
        }
        self.color.is_none() || is_bounded(&color)
    }
}
