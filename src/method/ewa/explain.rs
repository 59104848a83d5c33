//! Explain every decision at one pixel, with its operands.

use super::Settings;
use super::attributes::{Sums, sums};
use super::visibility::{Foremost, foremost};
use crate::composite::decide;
use crate::error::Result;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::buffer_formats::{Buffers, DepthKey};
use crate::method::decisions::{Decision, Place, Touch, touch};
use crate::method::fragment::TileSplats;
use crate::method::prepare::Prepared;
use crate::number::Exact;
use crate::scene::Surfels;
use std::fmt;

/// The replay of one pixel.
#[derive(Clone, Debug)]
pub struct EwaReplay<R> {
    /// Column and row.
    pub pixel: (u32, u32),
    /// k^2, the limit of q.
    pub limit: R,
    /// The depth of the visible band in world units.
    pub epsilon: R,
    /// Depth of the nearest fragment; +inf if the pixel is empty.
    pub nearest: R,
    /// The surfel of the nearest fragment.
    pub id: Option<u32>,
    /// Visibility splatting: the splats whose bounds hold the pixel, in ascending surfel index.
    pub touches: Vec<Touch<R>>,
    /// Attribute splatting: the splats of `touches` that are inside; each gives its weight, if it
    /// is visible.
    pub visible: Vec<Touch<R>>,
}

/// Replays both passes at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture.
pub fn explain<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    pixel: (u32, u32),
) -> Result<EwaReplay<R>> {
    let place = Place::new(job, pixel)?;
    let prepared = Prepared::splats(job, settings);
    let tile = place.splats(&prepared);
    let (limit, epsilon) = (tile.shared().limit, tile.epsilon());
    let TwoPasses { nearest, touches, visible, .. } = two_passes(&tile, &job.scene.surfels, None);
    let id = (nearest.id != NO_ID).then_some(nearest.id);
    Ok(EwaReplay { pixel, limit, epsilon, nearest: nearest.depth, id, touches, visible })
}

/// Both passes at one pixel: what they leave, and why.
pub(crate) struct TwoPasses<R> {
    pub(crate) nearest: Foremost<R>,
    pub(crate) sums: Sums<R>,
    pub(crate) touches: Vec<Touch<R>>,
    pub(crate) visible: Vec<Touch<R>>,
}

/// Replays both passes at the one pixel of a rectangle. If there is a depth `beyond`, only
/// fragments strictly beyond it take part.
pub(crate) fn two_passes<R: Exact>(
    tile: &TileSplats<'_, R>,
    surfels: &Surfels,
    beyond: Option<R>,
) -> TwoPasses<R> {
    let (shared, epsilon) = (tile.shared(), tile.epsilon());
    let candidate =
        |_: usize, w: R| beyond.is_none_or(|limit| decide::beyond(shared.depth(w), limit));
    let nearest = foremost(tile, &DepthKey::WHOLE, candidate);
    let sums = sums(tile, surfels, Buffers::F32, &nearest, candidate)[0];
    let nearest = nearest[0];

    let (mut touches, mut visible) = (Vec::new(), Vec::new());
    let mut held = shared.empty();
    tile.each_in_bounds(|splat, _, q, w| {
        let mut seen = touch(shared, splat.surfel, q, w);
        if let Some(limit) = beyond {
            seen.decide(|| Decision::beyond(shared.depth(w), limit, ["beyond ", "peeled "]));
        }
        if seen.passes() {
            let decisions = vec![Decision::visible(seen.t, nearest.depth, epsilon)];
            let mut part = Touch { decisions, ..seen.clone() };
            part.gives = part.passes().then(|| ("weight", splat.footprint.weight(q)));
            visible.push(part);
            seen.gives = Some(("depth", seen.t));
        }
        seen.decide(|| Decision::nearer(w, held, ["nearest", "farther"]));
        if seen.passes() {
            held = w;
        }
        touches.push(seen);
    });
    TwoPasses { nearest, sums, touches, visible }
}

impl<R: Exact> fmt::Display for EwaReplay<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = self.pixel;
        let n = |value: R| value.to_f64();
        writeln!(f, "pixel ({x}, {y}): {} splats reach it", self.touches.len())?;
        writeln!(f, "\nvisibility splatting: inside if q <= {}", n(self.limit))?;
        for touch in &self.touches {
            writeln!(f, "  {touch}")?;
        }
        let Some(id) = self.id else {
            return writeln!(f, "\nthe pixel is empty");
        };
        writeln!(
            f,
            "\nattribute splatting: visible if depth <= {} (nearest {}, surfel {id}, + epsilon {})",
            n(decide::limit(self.nearest, self.epsilon)),
            n(self.nearest),
            n(self.epsilon)
        )?;
        for touch in &self.visible {
            writeln!(f, "  {touch}")?;
        }
        Ok(())
    }
}
