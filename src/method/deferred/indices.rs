//! Pass 2: draw every surfel as one pixel with its id \[GBP04, 4.2\].

use super::part::Whole;
use super::visibility::{NONE, Nearest};
use crate::composite::decide;
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::projection::surfels::PointProjector;
use crate::method::tiled::Tiled;
use crate::number::{Exact, Real, Vector3};
use crate::scene::Surfels;
use crate::splat::{Fate, SplatSettings, View};

/// The surfel whose centre a pixel keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kept<R> {
    /// Depth of the centre in world units; +inf where there is none.
    pub(super) depth: R,
    /// Id of the surfel; [`NONE`] where there is none.
    pub(super) id: u64,
}

impl<R: Real> Kept<R> {
    pub(super) const EMPTY: Self = Self { depth: R::INFINITY, id: NONE };
}

/// The number of surfels that are placed at a time.
const CHUNK: u32 = 1 << 16;

/// Draws every surfel that the high level left into the picture of indices. Each surfel is tested
/// against the depth of pass 1.
pub(super) fn indices<R: Exact>(
    job: &Job<'_>,
    settings: &SplatSettings,
    whole: &Whole<'_>,
    visible: &Tiled<Nearest<R>>,
) -> Tiled<Kept<R>> {
    spend(Work::Indices);
    let mut kept = visible.map(|_| Kept::EMPTY);
    let epsilon = R::from_f32(settings.epsilon.in_units(whole.median_radius()));
    each_centre(job, settings, whole, |id, [x, y], t| {
        let limit = decide::limit(visible.at(x, y).depth, epsilon);
        let pixel = kept.at_mut(x, y);
        if decide::visible(t, limit) && decide::before(job.key.depth(t), job.key.depth(pixel.depth))
        {
            *pixel = Kept { depth: t, id };
        }
    });
    kept
}

/// Calls `draw` with the id, pixel and depth of each drawn surfel whose centre is in the picture,
/// in ascending id.
pub(crate) fn each_centre<R: Exact>(
    job: &Job<'_>,
    settings: &SplatSettings,
    whole: &Whole<'_>,
    mut draw: impl FnMut(u64, [u32; 2], R),
) {
    let points = PointProjector::new(View::new(job.camera), settings.cull);
    let ids = whole.ids();
    for &object in ids.order() {
        let count = ids.count(object);
        for start in (0..count).step_by(CHUNK as usize) {
            let end = count.min(start.saturating_add(CHUNK));
            let drawn = (start..end).filter(|&surfel| whole.draws(object, surfel));
            let chunk: Vec<u64> = drawn.map(|surfel| ids.id(object, surfel)).collect();
            let surfels = whole.surfels(&chunk, job.exec);
            for (i, &id) in chunk.iter().enumerate() {
                if let Some((pixel, t)) = centre(&points, &surfels, i) {
                    draw(id, pixel, t);
                }
            }
        }
    }
}

/// The pixel and the depth of a surfel, if the surfel is drawn.
fn centre<R: Exact>(
    points: &PointProjector<R>,
    surfels: &Surfels,
    i: usize,
) -> Option<([u32; 2], R)> {
    let n = points.view.direction(Vector3::from_glam(surfels.normal()[i]));
    let (placed, _, fate) = points.fate(Vector3::from_glam(surfels.position()[i]), n);
    // Adding 0 turns -0 into +0.
    (fate == Fate::Visible).then(|| (placed.pixel(), placed.t + R::ZERO))
}

/// B(i): the kept surfels, ascending.
pub(super) fn selected<R: Exact>(kept: &Tiled<Kept<R>>) -> Vec<u64> {
    // A surfel has one centre, so no surfel is there twice.
    let mut ids: Vec<u64> = kept.iter().map(|pixel| pixel.id).filter(|&id| id != NONE).collect();
    ids.sort_unstable();
    ids
}
