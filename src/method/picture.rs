//! The result that every method leaves: named planes, counts and times.

use super::algorithm::Job;
use super::clock::{Clock, Laps, Work, spend};
use super::surface::{ALPHA, DEPTH, ID, NORMAL, SHADED, WEIGHT};
use crate::composite::over::Blend;
use crate::frame::{Frame, Framebuffer, NamedPlane, Plane, Pool, Rect, Wanted};
use crate::index::seen::Seen;
use crate::number::{Exact, MapInline, Real, Truth};
use crate::shade::phong::Shader;
use crate::splat::{Tally, View};

/// A picture, with the counts and times of its drawing.
#[derive(Clone, Debug)]
pub struct Picture<R> {
    /// The planes: the shaded colour (`R G B`), `A` (1 where a surfel or the environment is seen,
    /// else 0), `Z`, `normal` (world space; not in an unlit scene), `weight`, `id`. If you asked
    /// for the planes of the stages, they come first.
    pub frame: Frame<R>,
    /// How many surfels were drawn or dropped, and why.
    pub tally: Tally,
    /// The laps, in the order of the stages: the name of each stage, and its wall time.
    ///
    /// - A lap holds the work of its stage and no other work. A fast path may run several stages as
    ///   one loop; one lap then holds them all, under all their names: `blending and averaging`.
    ///   Every stage that ran is in exactly one lap.
    /// - The splats of a tile are gathered in the lap of the stage that draws them. The planes of the
    ///   picture are written in the lap of the stage that finishes a tile or a row of them.
    /// - Stages that run one after the other on each tile share the wall time in proportion to their
    ///   time on all tiles.
    /// - No lap holds the planes of stages that [`Session::define`](super::Session::define) keeps.
    pub timings: Laps,
    /// What the frame saw, if its method carries that to the next frame.
    pub seen: Option<Seen>,
}

/// Shades a framebuffer, and makes the planes of the picture.
pub(crate) fn finish<R: Exact>(
    target: Framebuffer<R>,
    mut planes: Vec<NamedPlane<R>>,
    tally: Tally,
    mut clock: Clock,
    job: &Job<'_>,
) -> Picture<R> {
    let Framebuffer { width, height, depth, id, weight, normal, color, .. } = target;
    clock.restart();
    let (color, alpha) = shaded(job, &depth, normal.as_ref(), &weight, color);
    clock.lap("shading");
    planes.extend([SHADED.triple(0, color), ALPHA.scalar(0, alpha), DEPTH.scalar(0, depth)]);
    planes.extend(normal.map(|normal| NORMAL.triple(0, normal)));
    planes.extend([WEIGHT.scalar(0, weight), ID.index(0, id)]);
    Picture {
        frame: Frame { width, height, planes },
        tally,
        timings: clock.into_laps(),
        seen: None,
    }
}

/// The colour and the opacity of a picture: deferred shading, in front of the environment of the
/// scene.
pub(crate) fn shaded<R: Exact>(
    job: &Job<'_>,
    depth: &Plane<R>,
    normal: Option<&Plane<[R; 3]>>,
    weight: &Plane<R>,
    color: Option<Plane<[R; 3]>>,
) -> (Plane<[R; 3]>, Plane<R>) {
    let Job { scene, camera, exec, window, .. } = *job;
    spend(Work::Shade);
    let shader = Shader::new(View::new(camera), &scene.lights, scene.material);
    let shader = shader.from_pixel([window.x0, window.y0]);
    let color = shader.shade(depth, normal, None, color, exec);
    let alpha = weight.map(|&w| if w > R::ZERO { R::ONE } else { R::ZERO });
    before_environment(job, color, alpha)
}

/// Lays colours multiplied by their opacity over the environment of the scene, or over the light of
/// joined planes, if there is one.
pub(crate) fn before_environment<R: Exact>(
    job: &Job<'_>,
    mut color: Plane<[R; 3]>,
    mut alpha: Plane<R>,
) -> (Plane<[R; 3]>, Plane<R>) {
    let (environment, behind) =
        (job.scene.environment.as_ref(), job.joined.and_then(|joined| joined.behind.as_ref()));
    let (view, Rect { x0, y0, .. }) = (View::new(job.camera), job.window);
    let light = |x, y| match (behind, environment) {
        (Some(behind), _) => behind.at(x, y).map_inline(R::from_f32),
        (None, Some(environment)) => environment.radiance(view.ray(x, y)),
        (None, None) => [R::ZERO; 3],
    };
    if behind.is_none() && environment.is_none() {
        return (color, alpha);
    }
    spend(Work::Environment);
    let rows = color.rows_mut().zip(alpha.rows_mut());
    job.exec.ordered((y0..).zip(rows).collect(), |(y, (colors, alphas)): (u32, _)| {
        let colors: &mut [[R; 3]] = colors;
        let alphas: &mut [R] = alphas;
        for (x, (color, alpha)) in (x0..).zip(colors.iter_mut().zip(alphas)) {
            let layers = Blend { color: *color, alpha: *alpha };
            let whole = before_light(layers, || light(x, y));
            (*color, *alpha) = (whole.color, whole.alpha);
        }
    });
    (color, alpha)
}

/// Lays a pixel over the light behind it. The light is computed only where the pixel is not opaque.
pub(crate) fn before_light<R: Real>(layers: Blend<R>, light: impl FnOnce() -> [R; 3]) -> Blend<R> {
    let open = layers.alpha.lt(R::ONE);
    if !open.possibly() {
        return layers;
    }
    let whole = layers.before(light());
    let color = [0, 1, 2].map_inline(|c| R::select(open, whole.color[c], layers.color[c]));
    Blend { color, alpha: R::select(open, whole.alpha, layers.alpha) }
}

/// A framebuffer for the planes of a job, in reused memory: it may hold any values.
pub(crate) fn framebuffer(job: &Job<'_>, wanted: Wanted, pool: &mut Pool) -> Framebuffer<f32> {
    let size = job.size();
    Framebuffer {
        width: size[0],
        height: size[1],
        depth: pool.scalar(size),
        id: pool.index(size),
        weight: pool.scalar(size),
        normal: wanted.normal.then(|| pool.triple(size)),
        color: wanted.color.then(|| pool.triple(size)),
        stencil: None,
        margin: None,
    }
}
