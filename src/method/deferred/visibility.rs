//! Passes 1 and 3: visibility splatting of the surfels that the last frame saw, and of the selected
//! surfels that it did not see.

use super::part::Part;
use crate::composite::decide;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::ewa::visibility::{Foremost, visibility};
use crate::method::prepare::Prepared;
use crate::method::tiled::Tiled;
use crate::number::Exact;
use crate::splat::SplatSettings;

/// The id of no surfel; its lowest 32 bits are [`NO_ID`].
pub(crate) const NONE: u64 = u64::MAX;

/// The id of a polygon, higher than the id of any surfel. Its lowest 32 bits are [`NO_ID`].
pub(super) const POLYGON: u64 = NONE - (1 << 32);

/// The nearest fragment of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest<R> {
    pub(super) nearness: R,
    /// Depth in world units; +inf where there is none.
    pub(super) depth: R,
    /// Id of the surfel; [`NONE`] where there is no fragment, [`POLYGON`] for a polygon.
    pub(super) id: u64,
}

/// No fragment.
pub(super) fn empty<R: Exact>(perspective: bool) -> Nearest<R> {
    let nearness = if perspective { R::ZERO } else { -R::INFINITY };
    Nearest { nearness, depth: R::INFINITY, id: NONE }
}

impl<R: Exact> Nearest<R> {
    /// The fragment as attribute splatting reads it. It names no surfel, because an index has no
    /// meaning there.
    pub(super) fn foremost(&self) -> Foremost<R> {
        Foremost { nearness: self.nearness, depth: self.depth, id: NO_ID }
    }
}

/// Runs visibility splatting, the pass of `ewa`, on a part of the scene.
pub(super) fn nearest<R: Exact>(
    job: &Job<'_>,
    settings: &SplatSettings,
    part: &Part,
) -> Tiled<Nearest<R>> {
    let job = part.job(job);
    let found = visibility::<R>(&job, &Prepared::splats(&job, settings));
    found.map(|&Foremost { nearness, depth, id }| Nearest { nearness, depth, id: part.id(id) })
}

/// Combines two passes into one depth buffer: the nearer fragment stays. Ties: the lower id.
pub(super) fn both<R: Exact>(
    job: &Job<'_>,
    first: &Tiled<Nearest<R>>,
    second: &Tiled<Nearest<R>>,
) -> Tiled<Nearest<R>> {
    let compared = |at: &Nearest<R>| (job.key.nearness(at.nearness, || at.depth), at.id);
    first.with(second, |first, second| {
        let wins = decide::nearer_or_lower(compared(second), compared(first));
        if wins { *second } else { *first }
    })
}
