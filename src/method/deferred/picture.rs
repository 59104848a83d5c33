//! Run all passes in one call, from a scene and what the last frame saw to named planes. Or run one
//! stage on a client's planes.

use super::indices::{Kept, indices, selected};
use super::part::{Part, Whole};
use super::polygons::Polygons;
use super::visibility::{NONE, Nearest, POLYGON, both, nearest};
use super::{Settings, fast, planes};
use crate::error::Result;
use crate::frame::{NO_ID, NamedPlane, Pool, Wanted};
use crate::index::seen::Seen;
use crate::memory;
use crate::method::Job;
use crate::method::clock::{Clock, Work, spend};
use crate::method::ewa::attributes::{Sums, attributes};
use crate::method::ewa::normalization::resolve;
use crate::method::ewa::planes::given_attributes;
use crate::method::input_planes::InputPlanes;
use crate::method::picture::{Picture, finish, framebuffer};
use crate::method::prepare::Prepared;
use crate::method::stage::{Keep, unknown};
use crate::method::surface::{self, SurfacePixel};
use crate::method::tiled::{Tiled, pixels};
use crate::number::Exact;
use crate::splat::Tally;
use std::borrow::Cow;

/// The stages before shading.
pub(super) const UNSHADED: [&str; 5] =
    ["visibility", "indices", "difference", "attributes", "normalization"];

/// The definition, in any number type. With `stages`, every stage leaves its planes.
pub(super) fn define<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stages: bool,
) -> Result<Picture<R>> {
    let mut clock = Clock::of_stages(&UNSHADED);
    let (whole, before) = whole(job, settings)?;
    let polygons = Polygons::draw(job, settings, &whole)?;
    let flagged = whole.part(flagged(&whole, &before)?, job.exec);
    let visible = first::<R>(job, settings, &flagged, polygons.as_ref());
    clock.lap("visibility");

    let kept = indices(job, &settings.splats, &whole, &visible);
    let list = selected(&kept);
    let now = Seen::from_selected(whole.ids(), settings.flags, &list);
    clock.lap("indices");

    // Pass 4 draws the copies, but pass 3 needs their ids.
    let part = whole.drawn(list, job);
    clock.lap("attributes");
    let depth = difference(job, settings, &whole, &before, &part, &visible);
    clock.lap("difference");

    let (sums, tally) = sums(job, settings, &part, &depth);
    clock.lap("attributes");

    let shown = shown(job, settings, &part, &depth);
    let averages = normalization(job, &shown, polygons.as_ref(), &sums);
    let wanted = Wanted {
        normal: stages || !job.scene.lights.is_empty(),
        color: whole.has_colors(),
        observed: false,
    };
    let target = surface::framebuffer(job, &averages, wanted);
    clock.lap("normalization");

    let mut left = Vec::new();
    if stages {
        let there = job.there(Keep::Stages);
        left.extend(visible.planes(&Nearest::BEFORE, 0, &there));
        left.extend(kept.planes(&Kept::PLANES, 0, &there));
        left.extend(depth.planes(&Nearest::BOTH, 0, &there));
        left.extend(sums.planes(&Sums::PLANES, 0, &there));
        left.extend(surface::colors(job, &averages));
        left.extend(planes::shown(job, &ids(&shown, &averages)));
    }
    Ok(Picture { seen: Some(now), ..finish(target, left, tally, clock, job) })
}

/// The fast path for `f32`. Without pass 3 it runs the definition, because the paper shows such
/// pictures only for their errors.
pub(super) fn draw(
    job: &Job<'_>,
    settings: &Settings,
    memory: &mut Vec<fast::Centres>,
    pool: &mut Pool,
) -> Result<Picture<f32>> {
    if !settings.second {
        return define(job, settings, false);
    }
    let wanted = Wanted {
        normal: !job.scene.lights.is_empty(),
        color: Whole::new(job.scene).has_colors(),
        observed: false,
    };
    let mut target = framebuffer(job, wanted, pool);
    let (now, tally, clock) = fast::render(job, settings, &mut target, memory)?;
    Ok(Picture { seen: Some(now), ..finish(target, Vec::new(), tally, clock, job) })
}

/// Runs one stage on a client's planes.
pub(super) fn stage<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    stage: &str,
    given: &InputPlanes<'_, R>,
) -> Result<Vec<NamedPlane<R>>> {
    let (whole, before) = whole(job, settings)?;
    let selected = || Ok(whole.drawn(planes::given_selected(job, given)?, job));
    let visible = || planes::given_visibility(job, given, &Nearest::BEFORE);
    let depth = || planes::given_visibility(job, given, &Nearest::BOTH);
    let there = job.there(Keep::Alone);
    match stage {
        "visibility" => {
            let flagged = whole.part(flagged(&whole, &before)?, job.exec);
            let polygons = Polygons::draw(job, settings, &whole)?;
            let visible = first::<R>(job, settings, &flagged, polygons.as_ref());
            Ok(visible.planes(&Nearest::BEFORE, 0, &there))
        }
        "indices" => {
            let kept = indices(job, &settings.splats, &whole, &visible()?);
            Ok(kept.planes(&Kept::PLANES, 0, &there))
        }
        "difference" => {
            let depth = difference(job, settings, &whole, &before, &selected()?, &visible()?);
            Ok(depth.planes(&Nearest::BOTH, 0, &there))
        }
        "attributes" => {
            let part = selected()?;
            let (sums, _) = sums(job, settings, &part, &depth()?);
            Ok(sums.planes(&Sums::PLANES, 0, &there))
        }
        "normalization" => {
            let (part, depth) = (selected()?, depth()?);
            let sums = given_attributes(given)?;
            let polygons = Polygons::draw(job, settings, &whole)?;
            let shown = shown(job, settings, &part, &depth);
            let averages = normalization(job, &shown, polygons.as_ref(), &sums);
            let mut left = averages.planes(&SurfacePixel::PLANES, 0, &there);
            left.extend(planes::shown(job, &ids(&shown, &averages)));
            Ok(left)
        }
        "shading" => surface::shade(job, given, whole.has_colors()),
        _ => Err(unknown(stage)),
    }
}

/// The ids of the surfels that pass 1 draws, ascending.
///
/// # Errors
/// [`crate::Error::Invalid`] if the process may not hold the surfels.
pub(super) fn flagged(whole: &Whole<'_>, before: &Seen) -> Result<Vec<u64>> {
    let ranges = before.ranges(whole.ids());
    let count: u64 = ranges.iter().map(|(_, range)| range.len() as u64).sum();
    memory::ask(count * OF_A_FLAGGED, || format!("{count} flagged surfels"))?;
    Ok(whole.first(ranges))
}

/// Bytes of a surfel that pass 1 draws. The surfel is placed, is there twice while the surfels are
/// put together, and is projected in f64 with its bins.
const OF_A_FLAGGED: u64 = 512;

/// The surfels of a frame, and what the last frame saw.
pub(crate) fn whole<'a>(job: &Job<'a>, settings: &Settings) -> Result<(Whole<'a>, Cow<'a, Seen>)> {
    let whole = Whole::of_job(job);
    let before = seen(job, settings, &whole)?;
    Ok((whole.after(&before, settings), before))
}

/// What the last frame saw; nothing before the first frame.
fn seen<'a>(job: &Job<'a>, settings: &Settings, whole: &Whole<'_>) -> Result<Cow<'a, Seen>> {
    match &job.index.seen {
        None => Ok(Cow::Owned(Seen::nothing(whole.ids(), settings.flags))),
        Some(seen) => {
            seen.check(whole.ids(), settings.flags)?;
            Ok(Cow::Borrowed(seen))
        }
    }
}

/// Pass 1: the depth of polygons and of the flagged surfels.
pub(super) fn first<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    flagged: &Part,
    polygons: Option<&Polygons<R>>,
) -> Tiled<Nearest<R>> {
    let surfels = nearest(job, &settings.splats, flagged);
    let Some(polygons) = polygons else { return surfels };
    let below =
        Tiled::new(job, |_, rect| pixels(rect).map(|(x, y)| polygons.nearest(x, y)).collect());
    both(job, &below, &surfels)
}

/// Pass 3: the depth of pass 1 and of the selected surfels whose flags are not set.
fn difference<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    whole: &Whole<'_>,
    before: &Seen,
    selected: &Part,
    visible: &Tiled<Nearest<R>>,
) -> Tiled<Nearest<R>> {
    if !settings.second {
        return visible.map(|pixel| *pixel);
    }
    let fresh = whole.part(unseen(whole, before, selected.ids()), job.exec);
    both(job, visible, &nearest(job, &settings.splats, &fresh))
}

/// The ids of `ids`, ascending, that pass 1 did not draw: their flags are not set, or it left out
/// their object.
pub(super) fn unseen(whole: &Whole<'_>, before: &Seen, ids: &[u64]) -> Vec<u64> {
    spend(Work::Difference);
    let mut new = Vec::new();
    for (object, run) in whole.ids().runs(ids) {
        let first = whole.ids().id(object, 0);
        let drawn = |id: u64| !whole.leaves_out(object) && before.has(object, (id - first) as u32);
        new.extend(run.iter().filter(|&&id| !drawn(id)));
    }
    new
}

/// Pass 4: attribute splatting of B(i), with the tally of its surfels.
fn sums<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    selected: &Part,
    depth: &Tiled<Nearest<R>>,
) -> (Tiled<Sums<R>>, Tally) {
    let job = selected.job(job);
    let splats = Prepared::splats(&job, &settings.splats);
    let sums = attributes(&job, &splats, &depth.map(Nearest::foremost));
    (sums, splats.tally)
}

/// The fragments whose depth and id a picture shows where splats are seen.
fn shown<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    selected: &Part,
    depth: &Tiled<Nearest<R>>,
) -> Tiled<Nearest<R>> {
    // With pass 3 every fragment of B(i) has its own depth, or a depth in front of it.
    if settings.second {
        return depth.map(|pixel| *pixel);
    }
    depth.with(&nearest::<R>(job, &settings.splats, selected), |pixel, own| {
        let takes = pixel.id == NONE || pixel.id == POLYGON && own.nearness > pixel.nearness;
        if takes { *own } else { *pixel }
    })
}

/// All bits of the ids of a picture.
fn ids<R: Exact>(shown: &Tiled<Nearest<R>>, averages: &Tiled<SurfacePixel<R>>) -> Tiled<u64> {
    shown.with(averages, |nearest, shown| if shown.id == NO_ID { NONE } else { nearest.id })
}

/// Pass 5: normalization, with polygons where no splats are shown.
fn normalization<R: Exact>(
    job: &Job<'_>,
    shown: &Tiled<Nearest<R>>,
    polygons: Option<&Polygons<R>>,
    sums: &Tiled<Sums<R>>,
) -> Tiled<SurfacePixel<R>> {
    let splats = shown.with(sums, |nearest, sums| {
        if !(sums.weight > R::ZERO) || nearest.id == POLYGON {
            return SurfacePixel::EMPTY;
        }
        SurfacePixel { id: nearest.id as u32, ..resolve(&nearest.foremost(), sums) }
    });
    let Some(polygons) = polygons else { return splats };
    let below =
        Tiled::new(job, |_, rect| pixels(rect).map(|(x, y)| polygons.surface(x, y)).collect());
    splats.with(&below, |splats, below| if splats.weight > R::ZERO { *splats } else { *below })
}
