//! Run all stages in one call, from a scene to named planes. Or run one stage on a client's planes.

use super::Settings;
use super::blending::{Blending, GaussianPixel, Rules};
use super::order::Splats;
use super::planes::STAGES;
use super::splats::{Source, in_space};
use crate::error::Result;
use crate::frame::{NamedPlane, Plane, Rect};
use crate::method::Job;
use crate::method::clock::{Clock, Work, spend};
use crate::method::input_planes::InputPlanes;
use crate::method::picture::Picture;
use crate::method::stage::{Keep, unknown};
use crate::method::surface::{ALPHA, SHADED};
use crate::method::tiled::{Tiled, pixels};
use crate::number::{Exact, MapInline, Real, srgb};
use crate::scene::gaussians::Encoding;

/// The definition, in any number type.
pub(super) fn define<R: Exact>(job: &Job<'_>, settings: &Settings, stages: bool) -> Picture<R> {
    let mut clock = Clock::default();
    let source = Source::<R>::new(job.scene, job.camera, settings);
    let splats = Splats::new(job, &job.grid(), &source);
    clock.lap(STAGES[0].name);
    let blended = blend(job, source, &splats);
    let keep = if stages { Keep::Stages } else { Keep::Picture };
    let mut planes = blended.planes(&GaussianPixel::PLANES, 0, &job.there(keep));
    let color = blended.plane(|pixel| pixel.blend.color);
    let through = blended.plane(|pixel| pixel.blend.through);
    clock.lap(STAGES[1].name);
    let copies = (color.clone(), through.clone());
    planes.extend(display(job, &source, (&color, &through), copies));
    clock.lap(STAGES[2].name);
    let (frame, timings) = (job.frame(planes), clock.into_laps());
    Picture { frame, tally: splats.tally, timings, seen: None }
}

fn blend<R: Exact>(
    job: &Job<'_>,
    source: Source<'_, R>,
    splats: &Splats<R>,
) -> Tiled<GaussianPixel<R>> {
    let rules = Rules::new(source.settings);
    let blending = Blending { source, splats, rules, buffers: job.buffers, key: job.key };
    Tiled::new(job, |tile, rect| blending.tile(tile, rect))
}

/// The planes of the picture: the layers before the surface or the environment, as linear light. `shown` and
/// `alpha` come as copies of `color` and `through`, in memory that the caller chooses.
pub(super) fn display<R: Exact>(
    job: &Job<'_>,
    source: &Source<'_, R>,
    (color, through): (&Plane<[R; 3]>, &Plane<R>),
    (mut shown, mut alpha): (Plane<[R; 3]>, Plane<R>),
) -> [NamedPlane<R>; 2] {
    spend(Work::Display);
    // A power a number is enough work to run in parallel.
    let Rect { x0, y0, .. } = job.window;
    let (environment, surface) = (&job.scene.environment, source.surface());
    job.exec.ordered((y0..).zip(shown.rows_mut()).collect(), |(y, row): (u32, &mut [[R; 3]])| {
        if environment.is_some() || surface.is_some() {
            for (x, pixel) in (x0..).zip(&mut *row) {
                let around =
                    || Some(environment.as_ref()?.radiance(source.projector.view.ray(x, y)));
                let opaque = surface.and_then(|surface| surface.at(x, y));
                let light = opaque.map(|(_, light)| light.map_inline(R::from_f32)).or_else(around);
                let Some(light) = light else { continue };
                *pixel = before(source, *pixel, *through.at(x - x0, y - y0), light);
            }
        }
        if source.space == Encoding::Srgb {
            srgb::decode(row.as_flattened_mut());
        }
    });
    let closed = environment.is_some();
    let values = alpha.values_mut().iter_mut();
    values.for_each(|alpha| *alpha = if closed { R::ONE } else { R::ONE - *alpha });
    if let Some(surface) = surface {
        for (x, y) in pixels(job.window) {
            let Some((_, light)) = surface.at(x, y) else { continue };
            let i = (y - y0) as usize * job.window.columns() + (x - x0) as usize;
            alpha.values_mut()[i] = R::ONE;
            // Encoding and decoding again would round a colour that nothing was blended over.
            if (color.values()[i], through.values()[i]) == ([R::ZERO; 3], R::ONE) {
                shown.values_mut()[i] = light.map_inline(R::from_f32);
            }
        }
    }
    [SHADED.triple(0, shown), ALPHA.scalar(0, alpha)]
}

/// The blended colours before this light, in the space of blending.
pub(crate) fn before<R: Real>(
    source: &Source<'_, R>,
    color: [R; 3],
    through: R,
    light: [R; 3],
) -> [R; 3] {
    let light = in_space(light, source.space);
    let mut whole = color;
    for (whole, light) in whole.iter_mut().zip(light) {
        *whole = *whole + through * light;
    }
    whole
}

/// Runs one stage on a client's planes.
pub(super) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    let source = Source::<R>::new(job.scene, job.camera, settings);
    match stage {
        "blending" => {
            let splats = Splats::new(job, &job.grid(), &source);
            let blended = blend(job, source, &splats);
            Ok(blended.planes(&GaussianPixel::PLANES, 0, &job.there(Keep::Alone)))
        }
        "display" => {
            let color = given.triple(&GaussianPixel::<R>::COLOR.row, 0)?;
            let through = given.scalar(&GaussianPixel::<R>::THROUGH.row, 0)?;
            let copies = (color.clone(), through.clone());
            Ok(display(job, &source, (color, through), copies).into())
        }
        _ => Err(unknown(stage)),
    }
}
