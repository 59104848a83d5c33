//! The client's selection B(i): surfels by rank, ascending, each with whether it certainly is
//! selected.

use crate::frame::Plane;
use crate::method::Job;
use crate::number::ball::Profile;
use crate::verdict::marks::{TilePart, Watch};
use crate::verdict::projection::{AllPossible, SamplePlanes};

/// The surfels that a plane of ids lists, out of `total`. All of them are certain.
pub(super) fn listed(ids: &Plane<u32>, total: u64) -> Vec<(u32, bool)> {
    let mut listed = vec![false; total as usize];
    for rank in ids.values() {
        if let Some(listed) = listed.get_mut(*rank as usize) {
            *listed = true;
        }
    }
    (0..).zip(listed).filter_map(|(rank, listed)| listed.then_some((rank, true))).collect()
}

/// The surfels that may be selected if there is no such plane.
pub(super) fn possible<P: Profile>(
    job: &Job<'_>,
    points: &AllPossible<'_, P>,
    planes: &SamplePlanes<'_>,
    total: u64,
) -> Vec<(u32, bool)> {
    let tiles = Watch::All.parts(&job.grid());
    let found =
        job.exec.ordered(tiles, |(tile, rect)| points.kept(planes, TilePart { tile, rect }));
    // A surfel that may lie in several pixels may be selected in each of them.
    let mut all: Vec<Option<bool>> = vec![None; total as usize];
    for (rank, sure) in found.into_iter().flatten() {
        if let Some(known) = all.get_mut(rank as usize) {
            *known = Some(sure || *known == Some(true));
        }
    }
    (0..).zip(all).filter_map(|(rank, sure)| Some((rank, sure?))).collect()
}
