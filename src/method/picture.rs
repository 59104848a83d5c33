//! What every method leaves: named planes, counts and times.

use crate::composite::over::Blend;
use crate::frame::{Exec, Frame, Framebuffer, NamedPlane, Plane, Samples, Wanted};
use crate::number::Real;
use crate::scene::{Camera, Scene};
use crate::shade::phong::Shader;
use crate::splat::{Tally, View};
use std::time::{Duration, Instant};

/// A picture and how it came about.
#[derive(Clone, Debug)]
pub struct Picture<R> {
    /// The planes: the shaded colour (`R G B`), `A` (1 where a surfel or the environment is seen,
    /// else 0), `Z`, `normal` (world space; not of an unlit scene), `weight`, `id`; before them
    /// those of the stages, if asked for.
    pub frame: Frame<R>,
    /// What became of the surfels.
    pub tally: Tally,
    /// The wall time of each stage, in order.
    pub timings: Laps,
}

/// Deferred shading, and the planes of the picture.
pub(super) fn finish<R: Real>(
    target: Framebuffer<R>,
    mut planes: Vec<NamedPlane<R>>,
    tally: Tally,
    mut clock: Clock,
    (scene, camera, exec): (&Scene, &Camera, &Exec),
) -> Picture<R> {
    let Framebuffer { width, height, depth, id, weight, normal, color, .. } = target;
    clock.restart();
    let shader = Shader::new(View::new(camera), &scene.lights, scene.material);
    let color = shader.shade(&depth, normal.as_ref(), None, color, exec);
    clock.lap("shading");
    let alpha: Plane<R> = weight.map(|&w| if w > R::ZERO { R::ONE } else { R::ZERO });
    let (color, alpha) = before_environment(scene, camera, color, alpha, exec);
    planes.push(named("", Samples::Color(color)));
    planes.push(named("A", Samples::Scalar(alpha)));
    planes.push(named("Z", Samples::Scalar(depth)));
    planes.extend(normal.map(|p| named("normal", Samples::Vector(p))));
    planes.push(named("weight", Samples::Scalar(weight)));
    planes.push(named("id", Samples::Index(id)));
    Picture { frame: Frame { width, height, planes }, tally, timings: clock.into_laps() }
}

/// Colours multiplied by their opacity before the environment of the scene, if it has one.
pub(super) fn before_environment<R: Real>(
    scene: &Scene,
    camera: &Camera,
    mut color: Plane<[R; 3]>,
    mut alpha: Plane<R>,
    exec: &Exec,
) -> (Plane<[R; 3]>, Plane<R>) {
    let Some(environment) = &scene.environment else { return (color, alpha) };
    let view = View::new(camera);
    let rows = color.rows_mut().zip(alpha.rows_mut());
    exec.ordered((0..).zip(rows).collect(), |(y, (colors, alphas)): (u32, _)| {
        let colors: &mut [[R; 3]] = colors;
        let alphas: &mut [R] = alphas;
        for (x, (color, alpha)) in (0..).zip(colors.iter_mut().zip(alphas)) {
            if *alpha < R::ONE {
                let layers = Blend { color: *color, alpha: *alpha };
                let whole = layers.before(environment.radiance(view.ray(x, y)));
                (*color, *alpha) = (whole.color, whole.alpha);
            }
        }
    });
    (color, alpha)
}

/// A framebuffer for a camera's picture: the memory of an earlier frame, if that had the same
/// planes.
pub(super) fn framebuffer(
    camera: &Camera,
    wanted: Wanted,
    earlier: Option<Frame<f32>>,
) -> Framebuffer<f32> {
    let (width, height) = (camera.width, camera.height);
    let whole = |w: u32, h: u32| (w, h) == (width, height);
    let fits = |target: &Framebuffer<f32>| {
        whole(target.depth.width(), target.depth.height())
            && whole(target.id.width(), target.id.height())
            && whole(target.weight.width(), target.weight.height())
            && (target.normal.is_some(), target.color.is_some()) == (wanted.normal, wanted.color)
    };
    let earlier = earlier.map(|frame| recycle(frame, wanted)).filter(fits);
    earlier.unwrap_or_else(|| Framebuffer::new(width, height, 0.0, wanted))
}

/// The planes of a frame as a framebuffer; what it lacks has no pixels.
fn recycle(frame: Frame<f32>, wanted: Wanted) -> Framebuffer<f32> {
    let Frame { width, height, planes } = frame;
    let none = Wanted { normal: false, color: false, observed: false };
    let mut target = Framebuffer { width, height, ..Framebuffer::new(0, 0, 0.0, none) };
    for NamedPlane { name, samples } in planes {
        match (name.as_str(), samples) {
            ("Z", Samples::Scalar(plane)) => target.depth = plane,
            ("weight", Samples::Scalar(plane)) => target.weight = plane,
            ("id", Samples::Index(plane)) => target.id = plane,
            ("normal", Samples::Vector(plane)) => target.normal = Some(plane),
            // That of a scene without colours is its material's, and not the framebuffer's.
            ("", Samples::Color(plane)) if wanted.color => target.color = Some(plane),
            _ => {}
        }
    }
    target
}

pub(super) fn scalar<R>(name: &str, plane: Plane<R>) -> NamedPlane<R> {
    named(name, Samples::Scalar(plane))
}

pub(super) fn color<R>(name: &str, plane: Plane<[R; 3]>) -> NamedPlane<R> {
    named(name, Samples::Color(plane))
}

pub(super) fn named<R>(name: &str, samples: Samples<R>) -> NamedPlane<R> {
    NamedPlane { name: name.to_owned(), samples }
}

/// Stages, in order, and the wall time of each.
pub type Laps = Vec<(&'static str, Duration)>;

/// Takes the wall times of stages.
pub(super) struct Clock {
    start: Instant,
    laps: Laps,
}

impl Default for Clock {
    fn default() -> Self {
        Self { start: Instant::now(), laps: Vec::new() }
    }
}

impl Clock {
    /// A clock whose stages have been timed elsewhere.
    pub(super) fn of(laps: Laps) -> Self {
        Self { laps, ..Self::default() }
    }

    pub(super) fn restart(&mut self) {
        self.start = Instant::now();
    }

    /// The stages and how long they took.
    pub(super) fn into_laps(self) -> Laps {
        self.laps
    }

    /// Ends a stage that began at the last call, or at `restart`.
    pub(super) fn lap(&mut self, name: &'static str) {
        self.laps.push((name, self.start.elapsed()));
        self.start = Instant::now();
    }
}
