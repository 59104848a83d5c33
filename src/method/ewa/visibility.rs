//! Visibility splatting: the nearest fragment of each pixel \[GBP04, section 3\].

use crate::composite::decide;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::buffer_formats::DepthKey;
use crate::method::clock::{Work, spend};
use crate::method::fragment::TileSplats;
use crate::method::prepare::Prepared;
use crate::method::tiled::Tiled;
use crate::number::Exact;
use crate::splat::{Shared, Splat};

/// The nearest fragment of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Foremost<R> {
    /// Nearness of the fragment; where there is none, the nearness of an empty pixel.
    pub(crate) nearness: R,
    /// Depth of the fragment in world units; +inf where there is none.
    pub(crate) depth: R,
    /// Surfel of the fragment; [`NO_ID`] where there is none.
    pub(crate) id: u32,
}

impl<R: Exact> Foremost<R> {
    /// An empty pixel.
    fn none(shared: &Shared<R>) -> Self {
        Self { nearness: shared.empty(), depth: R::INFINITY, id: NO_ID }
    }
}

/// Visibility splatting over the picture.
pub(crate) fn visibility<R: Exact>(
    job: &Job<'_>,
    splats: &Prepared<R, Splat<R>>,
) -> Tiled<Foremost<R>> {
    Tiled::new(job, |tile, rect| {
        foremost(&TileSplats::new(splats, tile, rect), &job.key, |_, _| true)
    })
}

/// Each pixel keeps the greatest nearness of the fragments that are inside and for which
/// `candidate` holds. `candidate` receives the pixel, counted row by row, and the nearness. Ties:
/// the lower surfel index.
pub(crate) fn foremost<R: Exact>(
    tile: &TileSplats<'_, R>,
    key: &DepthKey,
    candidate: impl Fn(usize, R) -> bool,
) -> Vec<Foremost<R>> {
    spend(Work::Visibility);
    let shared = tile.shared();
    let mut pixels = vec![Foremost::none(shared); tile.rect.pixels()];
    tile.each_inside(|splat, pixel, _, w| {
        let held = &mut pixels[pixel];
        let compared = |w| key.nearness(w, || shared.depth(w));
        if candidate(pixel, w) && decide::nearer(compared(w), compared(held.nearness)) {
            (held.nearness, held.id) = (w, splat.surfel);
        }
    });
    // The depth is computed once, for the fragment that stayed.
    for pixel in &mut pixels {
        pixel.depth = shared.depth(pixel.nearness);
    }
    pixels
}
