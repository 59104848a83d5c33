//! All stages in one call: from a scene to named planes.

use super::Settings;
use super::fast;
use super::plain::Plain;
use crate::error::Result;
use crate::frame::{Exec, Frame, Framebuffer, NamedPlane, Plane, Samples};
use crate::number::Real;
use crate::scene::{Camera, Scene};
use crate::shade::phong::Shader;
use crate::splat::{Shared, Tally, View};
use std::time::{Duration, Instant};

/// A picture and how it came about.
#[derive(Clone, Debug)]
pub struct Picture<R> {
    /// The planes: the shaded colour (`R G B`), `A` (1 where a surfel is seen, else 0), `Z`,
    /// `normal` (world space), `weight`, `id`; before them those of the stages, if asked for.
    pub frame: Frame<R>,
    /// What became of the surfels.
    pub tally: Tally,
    /// The wall time of each stage, in order.
    pub timings: Vec<(&'static str, Duration)>,
}

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
    let mut plain = Plain::<R>::project(&scene.surfels, camera, settings, exec, stages);
    clock.lap("projection");

    plain.visibility();
    clock.lap("visibility");
    if stages {
        let shared = Shared::<R>::new(&View::new(camera), &settings.kernel);
        let depth = plain.target.depth.map(|&w| shared.depth(w));
        planes.push(named("visibility.Z", Samples::Scalar(depth)));
        planes.push(named("visibility.id", Samples::Index(plain.target.id.clone())));
    }

    clock.restart();
    plain.attributes();
    clock.lap("attributes");
    if stages {
        let target = &mut plain.target;
        planes.extend(target.color.clone().map(|p| named("attributes", Samples::Color(p))));
        planes.push(named("attributes.normal", Samples::Vector(target.normal.clone())));
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
    camera.check()?;
    settings.check()?;
    let color = scene.surfels.color().is_some();
    let mut target = Framebuffer::new(camera.width, camera.height, 0.0, color, false);
    let (tally, times) = fast::render(&scene.surfels, camera, settings, exec, &mut target);
    let clock = Clock {
        laps: vec![
            ("projection", times.project),
            ("visibility", times.visibility),
            ("attributes", times.attributes),
            ("normalization", times.normalize),
        ],
        ..Clock::default()
    };
    Ok(finish(target, Vec::new(), tally, clock, (scene, camera, exec)))
}

/// Deferred shading, and the planes of the picture.
fn finish<R: Real>(
    target: Framebuffer<R>,
    mut planes: Vec<NamedPlane<R>>,
    tally: Tally,
    mut clock: Clock,
    (scene, camera, exec): (&Scene, &Camera, &Exec),
) -> Picture<R> {
    let Framebuffer { width, height, depth, id, weight, normal, color, .. } = target;
    clock.restart();
    let shader = Shader::new(View::new(camera), &scene.lights, scene.material);
    let color = shader.shade(&depth, &normal, color, exec);
    clock.lap("shading");
    let alpha: Plane<R> = weight.map(|&w| if w > R::ZERO { R::ONE } else { R::ZERO });
    planes.push(named("", Samples::Color(color)));
    planes.push(named("A", Samples::Scalar(alpha)));
    planes.push(named("Z", Samples::Scalar(depth)));
    planes.push(named("normal", Samples::Vector(normal)));
    planes.push(named("weight", Samples::Scalar(weight)));
    planes.push(named("id", Samples::Index(id)));
    Picture { frame: Frame { width, height, planes }, tally, timings: clock.laps }
}

fn named<R>(name: &str, samples: Samples<R>) -> NamedPlane<R> {
    NamedPlane { name: name.to_owned(), samples }
}

/// Wall times of stages.
struct Clock {
    start: Instant,
    laps: Vec<(&'static str, Duration)>,
}

impl Default for Clock {
    fn default() -> Self {
        Self { start: Instant::now(), laps: Vec::new() }
    }
}

impl Clock {
    fn restart(&mut self) {
        self.start = Instant::now();
    }

    /// Ends a stage that began at the last call, or at `restart`.
    fn lap(&mut self, name: &'static str) {
        self.laps.push((name, self.start.elapsed()));
        self.start = Instant::now();
    }
}
