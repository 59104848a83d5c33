//! The splats of a picture in balls: every surfel that a right implementation may draw.

use super::Settings;
use crate::frame::Rect;
use crate::method::Job;
use crate::method::part::Part;
use crate::method::prepare::Prepared;
use crate::number::ball::{Common, Profile};
use crate::number::{Ball, Real, Truth};
use crate::scene::Surfels;
use crate::splat::project::project_each;
use crate::splat::{Disc, Projector, Splat, Tally, View, batch, enclosed};
use std::ops::Range;

/// A surfel that may be drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PossibleSplat<P: Profile> {
    pub(crate) splat: Splat<Ball<P>>,
    /// Whether the surfel is certainly drawn, and certainly with this outline.
    pub(crate) certain: bool,
}

/// The splats of a picture, each with the pixels that may be inside.
pub(crate) type PossibleSplats<P> = Prepared<Ball<P>, PossibleSplat<P>>;

/// Projects the surfels that may be drawn.
pub(crate) fn project<P: Profile>(job: &Job<'_>, settings: &Settings) -> PossibleSplats<P> {
    project_into(job, settings, |possible| possible, |possible| possible.splat.bounds)
}

/// As [`project`], with other records; `bounds` returns the pixels of a record.
pub(crate) fn project_into<P: Profile, S: Copy + Send>(
    job: &Job<'_>,
    settings: &Settings,
    record: impl Fn(PossibleSplat<P>) -> S + Sync + Send,
    bounds: impl Fn(&S) -> Rect + Sync + Send,
) -> Prepared<Ball<P>, S> {
    let surfels = &job.scene.surfels;
    let picture = job.picture();
    let common = Projector::new(View::new(job.camera), &settings.kernel, settings.cull);
    let part = job.part.filter(Part::is_small);
    let project = |projector: &_, range, list: Option<&[usize]>, splats: &mut Vec<S>| {
        let each = &mut |mut splat: Splat<Ball<P>>, certain| {
            splat.bounds = splat.bounds.intersection(&picture);
            if splat.bounds.is_empty() {
                return;
            }
            let possible = record(PossibleSplat { splat, certain });
            if part.is_none_or(|part| part.touches(&bounds(&possible))) {
                splats.push(possible);
            }
        };
        each_of_range(projector, &common, surfels, range, list, each);
        Tally::default()
    };
    let (grid, count) = (job.grid(), surfels.len());
    match near(job, settings) {
        Some(list) => {
            let all = |projector: &_, list: Vec<usize>, splats: &mut _| {
                project(projector, 0..count, Some(&list), splats)
            };
            Prepared::of_batches(job, &grid, settings, vec![list], all, &bounds)
        }
        None => {
            let some =
                |projector: &_, range, splats: &mut _| project(projector, range, None, splats);
            Prepared::new(job, &grid, settings, count, some, &bounds)
        }
    }
}

/// The surfels of a job that may touch the part that is judged, ascending, if that part is small.
pub(crate) fn near(job: &Job<'_>, settings: &Settings) -> Option<Vec<usize>> {
    let kernel = &settings.kernel;
    // A client may add the filter to the radius.
    let filter = f64::from(kernel.low_pass);
    let skirt = f64::from(kernel.cutoff) * filter.sqrt().at_least(filter);
    job.part?.near(job, skirt, |i| job.scene.surfels.reach_of(i))
}

/// [`each_possible`] for a range of surfels, or for those of a list in it, in ascending order. Affine
/// outlines are computed in lanes, except for the surfels that the lanes cannot decide.
pub(crate) fn each_of_range<P: Profile>(
    projector: &Projector<Ball<P>>,
    common: &Projector<Ball<Common<P>>>,
    surfels: &Surfels,
    range: Range<usize>,
    list: Option<&[usize]>,
    each: &mut dyn FnMut(Splat<Ball<P>>, bool),
) {
    let rest = range.start + batch::in_full_lanes(projector.outline, range.len());
    let parts = list.map(|list| list.split_at(list.partition_point(|i| *i < rest)));
    let (in_lanes, listed) = (range.start..rest, parts.map(|parts| parts.0));
    enclosed::affine_surfels(common, surfels, in_lanes, listed, &mut |i, splat| match splat {
        Some(splat) => each(splat, true),
        None => each_possible(projector, &batch::disc(surfels, i), i as u32, each),
    });
    let mut one = |i| each_possible(projector, &batch::disc(surfels, i), i as u32, each);
    match parts {
        Some((_, last)) => last.iter().for_each(|&i| one(i)),
        None => (rest..range.end).for_each(one),
    }
}

/// Calls `each` for every splat that a surfel may become: one splat, two if it is not certain
/// whether the surfel reaches the near plane, or none; and says whether the splat is certain.
/// Compiled once for all callers, because it takes 120 kB.
#[inline(never)]
pub(crate) fn each_possible<P: Profile>(
    projector: &Projector<Ball<P>>,
    disc: &Disc<Ball<P>>,
    surfel: u32,
    each: &mut dyn FnMut(Splat<Ball<P>>, bool),
) {
    project_each(projector, disc, surfel, |splat, reasons, crosses| {
        let dropped = reasons.any();
        if !dropped.certainly() {
            each(splat, !dropped.possibly() && crosses.decided().is_some());
        }
    });
}
