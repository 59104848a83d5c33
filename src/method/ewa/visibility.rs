//! Visibility splatting: the nearest fragment of each pixel \[GBP04, section 3\].

use crate::composite::decide;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::buffer_formats::DepthKey;
use crate::method::fragment::TileSplats;
use crate::method::prepare::Prepared;
use crate::method::tiled::Tiled;
use crate::number::Exact;
use crate::splat::{Shared, Splat};

/// The nearest fragment of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Foremost<R> {
    /// Its nearness; that of an empty pixel where there is none.
    pub(crate) nearness: R,
    /// Its depth in world units; +inf where there is none.
    pub(crate) depth: R,
    /// Its surfel; [`NO_ID`] where there is none.
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

/// Of the fragments that are inside and for which `candidate` holds (the pixel, counted row by row,
/// and the nearness), each pixel keeps the greatest nearness; ties: the lower surfel index.
pub(crate) fn foremost<R: Exact>(
    tile: &TileSplats<'_, R>,
    key: &DepthKey,
    candidate: impl Fn(usize, R) -> bool,
) -> Vec<Foremost<R>> {
    let shared = tile.shared();
    let mut pixels = vec![Foremost::none(shared); tile.rect.pixels()];
    tile.each_inside(|splat, pixel, _, w| {
        let held = &mut pixels[pixel];
        let compared = |w| key.nearness(w, || shared.depth(w));
        if candidate(pixel, w) && decide::nearer(compared(w), compared(held.nearness)) {
            (held.nearness, held.id) = (w, splat.surfel);
        }
    });
    for pixel in &mut pixels {
        pixel.depth = shared.depth(pixel.nearness);
    }
    pixels
}
