//! Draw the projection of a region, and go on from the projection of the whole picture.
//!
//! A pixel of the projection depends on what projects into that pixel alone, so a region of it can be
//! drawn alone. The stages that follow need the whole picture, but nothing of the scene except what
//! [`Joined`] holds, its lights and its material.

use super::{Has, Projected};
use crate::frame::Plane;
use crate::method::Job;
use crate::method::clock::{Clock, Work, spend};
use crate::method::picture::Picture;
use crate::method::stage::{Holds, PlaneRow};
use crate::number::Exact;
use crate::splat::View;

/// The plane of a region beside the planes of the projection, if the scene has an environment: the
/// light that arrives along the ray of each pixel, [`crate::scene::Environment::radiance`].
pub(crate) const BEHIND: PlaneRow =
    PlaneRow::new("environment", Holds::Color, "the light behind the pixel");

/// What the stages after the projection need of a scene beside its lights and its material.
#[derive(Clone, Debug, Default)]
pub(crate) struct Joined {
    /// Whether the scene has colours and tubes.
    pub(crate) has: Has,
    /// The light behind each pixel, if it does not come from the environment of the scene.
    pub(crate) behind: Option<Plane<[f32; 3]>>,
}

impl<R: Exact> Projected<R> {
    /// Makes the picture of a region: the planes of the projection alone. They end its lap.
    pub(crate) fn alone(self, job: &Job<'_>, mut clock: Clock) -> Picture<R> {
        let mut planes = self.planes(job);
        if let Some(environment) = &job.scene.environment {
            spend(Work::Environment);
            let view = View::<R>::new(job.camera);
            let light = |x, y| environment.radiance(view.ray(x, y));
            planes.push(BEHIND.triple(0, Plane::of_window(job.window, light)));
        }
        clock.lap("projection");
        let (frame, timings) = (job.frame(planes), clock.into_laps());
        Picture { frame, tally: self.tally, timings, seen: None }
    }
}
