//! All stages in one call: from a scene to named planes.

use super::Settings;
use super::nearest::First;
use crate::composite::over::Blend;
use crate::error::{Error, Result};
use crate::frame::Frame;
use crate::method::Picture;
use crate::method::algorithm::Job;
use crate::method::picture::{Clock, scalar};
use crate::method::transparent::blend::Average;
use crate::method::transparent::picture::{At, blend};
use crate::number::{Exact, Vector3};
use crate::scene::Scene;
use crate::shade::optics::{self, Behind, Nearest};
use crate::splat::View;

/// The definition of Algorithm 3, in any number; with `stages`, every stage leaves its planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let Job { scene, camera, .. } = *job;
    if settings.refraction.is_some() && scene.environment.is_none() {
        let what = "refraction: there is nothing to be seen through it; give an environment";
        return Err(Error::Invalid(what.into()));
    }
    let mut clock = Clock::default();
    let mut planes = Vec::new();
    let first = First::new(job, settings, stages, &mut planes)?;
    clock.lap("nearest layer");
    let tail = Tail { scene, settings, view: View::new(camera), first: &first };
    let mask = |rect| Some(first.mask(rect));
    let show = |at: At, average: &Average<R>| tail.pixel(at, average);
    let blended = blend(job, &settings.layers, stages, mask, show, &mut clock)?;
    if stages {
        planes.extend(blended.planes());
        planes.push(scalar("l", blended.plane_at(|at, average| first.layers(at, average))));
    }
    planes.extend(blended.colors(job));
    let (tally, counts) = (first.tally, blended.plane(R::ZERO, |average| average.layers));
    planes.extend(first.planes(&counts));
    let frame = Frame { width: camera.width, height: camera.height, planes };
    Ok(Picture { frame, tally, timings: clock.into_laps() })
}

/// The last step: what the layers of a pixel make together, and what is refracted through them.
struct Tail<'a, R> {
    scene: &'a Scene,
    settings: &'a Settings,
    view: View<R>,
    first: &'a First<R>,
}

impl<R: Exact> Tail<'_, R> {
    /// The colour and the opacity of a pixel.
    fn pixel(&self, at: At, others: &Average<R>) -> Blend<R> {
        let (first, At { tile, pixel, x, y }) = (self.first, at);
        if !first.target.depth.at(x, y).is_finite() {
            return others.blend;
        }
        let (alpha, near) = (first.alpha[tile][pixel], *first.color.at(x, y));
        let (Some(refraction), Some(environment)) =
            (&self.settings.refraction, &self.scene.environment)
        else {
            return others.blend.over(alpha, near);
        };
        let normal = first.target.normal.as_ref().map(|plane| *plane.at(x, y));
        let [nx, ny, nz] = normal.unwrap_or([R::ZERO; 3]);
        let nearest = Nearest { color: near, opacity: alpha, normal: Vector3::new(nx, ny, nz) };
        let Average { blend, opacity, hidden, .. } = *others;
        let behind = Behind { color: blend.color, opacity, hidden };
        let view = -self.view.ray(x, y).normalized();
        let color = optics::shade(environment, refraction, view, &nearest, &behind);
        Blend { color, alpha: R::ONE }
    }
}
