//! All stages in one call: from a scene to named planes.

use super::Settings;
use super::fast;
use super::plain::Plain;
use crate::error::Result;
use crate::frame::{Exec, Frame, Samples, Wanted};
use crate::method::picture::{Clock, Picture, finish, framebuffer, named};
use crate::number::Real;
use crate::scene::{Camera, Scene};

/// Renders with the definition, in any number; with `stages`, every stage leaves its planes:
///
/// | stage | planes |
/// |---|---|
/// | visibility | `visibility.Z`, `visibility.id` |
/// | attributes | `attributes.R G B` (if the scene has colours), `attributes.normal.X Y Z`, `attributes.weight`: sums; `attributes.count`: fragments, up to 255 |
/// | | `margin`: how far the nearest decision of the pixel was from flipping, in ulp; +inf: no decision. Taken over the splats whose bounds hold the pixel |
/// | normalization | `resolved.R G B` (if the scene has colours) |
///
/// # Errors
/// [`crate::Error::Invalid`] if the camera or the settings are out of range.
pub fn render<R: Real>(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    stages: bool,
) -> Result<Picture<R>> {
    camera.check()?;
    settings.check()?;
    let mut clock = Clock::default();
    let mut planes = Vec::new();
    let mut plain =
        Plain::<R>::project(&scene.surfels, camera, settings, exec, wanted(scene, stages));
    clock.lap("projection");

    plain.visibility();
    clock.lap("visibility");
    if stages {
        planes.push(named("visibility.Z", Samples::Scalar(plain.depth())));
        planes.push(named("visibility.id", Samples::Index(plain.target.id.clone())));
    }

    clock.restart();
    plain.attributes();
    clock.lap("attributes");
    if stages {
        let target = &mut plain.target;
        planes.extend(target.color.clone().map(|p| named("attributes", Samples::Color(p))));
        planes
            .extend(target.normal.clone().map(|p| named("attributes.normal", Samples::Vector(p))));
        planes.push(named("attributes.weight", Samples::Scalar(target.weight.clone())));
        planes.extend(target.stencil.take().map(|p| named("attributes.count", Samples::Count(p))));
        planes.extend(target.margin.take().map(|p| named("margin", Samples::Scalar(p))));
    }

    clock.restart();
    plain.normalize();
    clock.lap("normalization");
    if stages {
        let color = plain.target.color.clone();
        planes.extend(color.map(|p| named("resolved", Samples::Color(p))));
    }
    let tally = plain.tally();
    Ok(finish(plain.target, planes, tally, clock, (scene, camera, exec)))
}

/// Renders in `f32` by the fast path: the bits of [`render`], without the planes of the stages.
///
/// # Errors
/// As [`render`].
pub fn render_f32(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
) -> Result<Picture<f32>> {
    render_into(scene, camera, settings, exec, None)
}

/// As [`render_f32`], in the memory of an earlier picture, which is much of the time of a small
/// one.
///
/// # Errors
/// As [`render`].
pub fn render_f32_again(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    earlier: Picture<f32>,
) -> Result<Picture<f32>> {
    render_into(scene, camera, settings, exec, Some(earlier.frame))
}

fn render_into(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    earlier: Option<Frame<f32>>,
) -> Result<Picture<f32>> {
    camera.check()?;
    settings.check()?;
    let mut target = framebuffer(camera, wanted(scene, false), earlier);
    let (tally, laps) = fast::render(&scene.surfels, camera, settings, exec, &mut target);
    Ok(finish(target, Vec::new(), tally, Clock::of(laps), (scene, camera, exec)))
}

/// The planes that a scene needs.
fn wanted(scene: &Scene, stages: bool) -> Wanted {
    Wanted {
        normal: stages || !scene.lights.is_empty(),
        color: scene.surfels.color().is_some(),
        observed: stages,
    }
}
