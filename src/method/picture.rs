//! The result that every method leaves: named planes, counts and times.

use super::algorithm::Job;
use super::surface::{ALPHA, DEPTH, ID, NORMAL, SHADED, WEIGHT};
use crate::composite::over::Blend;
use crate::frame::{Frame, Framebuffer, NamedPlane, Plane, Pool, Rect, Wanted};
use crate::index::seen::Seen;
use crate::number::{Exact, MapInline, Real, Truth};
use crate::shade::phong::Shader;
use crate::splat::{Tally, View};
use std::time::{Duration, Instant};

/// A picture, with the counts and times of its drawing.
#[derive(Clone, Debug)]
pub struct Picture<R> {
    /// The planes: the shaded colour (`R G B`), `A` (1 where a surfel or the environment is seen,
    /// else 0), `Z`, `normal` (world space; not in an unlit scene), `weight`, `id`. If you asked
    /// for the planes of the stages, they come first.
    pub frame: Frame<R>,
    /// How many surfels were drawn or dropped, and why.
    pub tally: Tally,
    /// The wall time of each stage, in order.
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

/// The stages in order, and the wall time of each.
pub type Laps = Vec<(&'static str, Duration)>;

/// Divides the wall time among stages in proportion to their time in all tiles.
pub(crate) fn wall_shares<const N: usize>(
    wall: Duration,
    tiles: &[[Duration; N]],
) -> [Duration; N] {
    let sums: [Duration; N] = std::array::from_fn(|i| tiles.iter().map(|tile| tile[i]).sum());
    let total: Duration = sums.iter().sum();
    sums.map_inline(|part| match total.as_secs_f64() {
        0.0 => Duration::ZERO,
        total => wall.mul_f64(part.as_secs_f64() / total),
    })
}

/// Measures the wall times of stages.
pub(crate) struct Clock {
    start: Instant,
    laps: Laps,
}

impl Default for Clock {
    fn default() -> Self {
        Self { start: Instant::now(), laps: Vec::new() }
    }
}

impl Clock {
    /// A clock for stages that were timed elsewhere.
    pub(crate) fn from_laps(laps: Laps) -> Self {
        Self { laps, ..Self::default() }
    }

    pub(crate) fn restart(&mut self) {
        self.start = Instant::now();
    }

    /// The stages and their wall times.
    pub(crate) fn into_laps(self) -> Laps {
        self.laps
    }

    /// Ends stages that ran one after the other in every tile. Each stage gets a share of the wall
    /// time in proportion to its time in all tiles.
    pub(crate) fn shares<const N: usize>(
        &mut self,
        names: [&'static str; N],
        tiles: &[[Duration; N]],
    ) {
        let shares = wall_shares(self.start.elapsed(), tiles);
        for (name, time) in names.into_iter().zip(shares) {
            self.add(name, time);
        }
        self.start = Instant::now();
    }

    /// Ends work on a stage that began at the last call or at `restart`.
    pub(crate) fn lap(&mut self, name: &'static str) {
        self.add(name, self.start.elapsed());
        self.start = Instant::now();
    }

    /// Adds time to a stage, which may have been worked on before.
    pub(crate) fn add(&mut self, name: &'static str, time: Duration) {
        match self.laps.iter_mut().find(|(stage, _)| *stage == name) {
            Some((_, sum)) => *sum += time,
            None => self.laps.push((name, time)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_in_two_parts_has_one_lap() {
        let ms = Duration::from_millis;
        let mut clock = Clock::from_laps(vec![("visibility", ms(1))]);
        clock.add("attributes", ms(2));
        clock.shares(["difference", "attributes"], &[[ms(0); 2]]);
        clock.add("difference", ms(8));
        clock.add("attributes", ms(16));
        let laps = [("visibility", ms(1)), ("attributes", ms(18)), ("difference", ms(8))];
        assert_eq!(clock.into_laps(), laps);
    }
}
