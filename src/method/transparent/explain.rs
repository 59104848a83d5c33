//! Explain every decision at one pixel, with its operands.

use super::Settings;
use super::averaging::{GroupAverage, averages};
use super::blending::{Blending, GroupLayers};
use crate::composite::decide;
use crate::error::Result;
use crate::method::Job;
use crate::method::decisions::{Decision, Place, Touch, touch};
use crate::number::{Exact, MapInline};
use std::fmt;

/// The replay of one pixel.
#[derive(Clone, Debug)]
pub struct TransparentReplay<R> {
    /// Column and row.
    pub pixel: (u32, u32),
    /// k^2, the limit of q.
    pub limit: R,
    /// If there is a nearest layer before these, fragments up to this depth are masked.
    pub beyond: Option<R>,
    /// The groups whose splats reach the pixel, ascending.
    pub groups: Vec<BlendedGroupAt<R>>,
    /// Opacity of the average of all groups.
    pub alpha: R,
    /// Colour of the average, over black.
    pub color: [R; 3],
    /// Average count of layers.
    pub layers: R,
    /// Depth of the nearest fragment; +inf if the pixel is empty.
    pub nearest: R,
    /// Surfel of that fragment.
    pub id: u32,
}

/// A group at the pixel.
#[derive(Clone, Debug)]
pub struct BlendedGroupAt<R> {
    /// The group.
    pub group: usize,
    /// The splats whose bounds hold the pixel, from back to front. Each splat that passes is
    /// blended with the opacity that it gives.
    pub touches: Vec<Touch<R>>,
    /// How many layers were blended, up to 255.
    pub count: u8,
    /// The opacity of these layers together.
    pub alpha: R,
    /// Sum of the opacities in front of the nearest opaque layer.
    pub opacity: R,
    /// The colour of these layers, over black.
    pub color: [R; 3],
}

/// Replays both passes at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture; [`crate::Error::Invalid`] if there
/// are no groups, or if the depth test takes too many bins.
pub fn explain<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    pixel: (u32, u32),
) -> Result<TransparentReplay<R>> {
    Ok(replay(job, settings, pixel, None)?.0)
}

/// Replays both passes. If there is a depth `beyond`, fragments that are not strictly beyond it are
/// dropped. Also returns the average of the groups.
pub(crate) fn replay<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    pixel: (u32, u32),
    beyond: Option<R>,
) -> Result<(TransparentReplay<R>, GroupAverage<R>)> {
    let place = Place::new(job, pixel)?;
    let blending = Blending::<R>::project(job, settings)?;
    let stays = |_: usize, t: R| beyond.is_none_or(|limit| decide::beyond(t, limit));
    let images = blending.images(place.tile, place.rect, stays);
    let average = averages(&images, 1, settings.holes)[0];
    let GroupAverage { blend, layers, depth, surfel, .. } = average;
    let groups = geometry_pass(&blending, place, beyond).into_iter().map(|(group, touches)| {
        let GroupLayers { blend, count, opacity, .. } = images[group][0];
        let (alpha, color) = (blend.alpha, blend.color);
        BlendedGroupAt { group, touches, count, alpha, opacity, color }
    });
    let replay = TransparentReplay {
        pixel,
        limit: blending.shared().limit,
        beyond,
        groups: groups.collect(),
        alpha: blend.alpha,
        color: blend.color,
        layers,
        nearest: depth,
        id: surfel,
    };
    Ok((replay, average))
}

/// Replays the geometry pass: each group that reaches the pixel, and the splats by which it does.
fn geometry_pass<R: Exact>(
    blending: &Blending<R>,
    place: Place,
    beyond: Option<R>,
) -> Vec<(usize, Vec<Touch<R>>)> {
    let shared = blending.shared();
    let mut groups = vec![(GroupLayers::EMPTY, Vec::new()); blending.groups()];
    blending.each_in_bounds(place.tile, place.rect, |drawn, q, w| {
        let (layers, touches) = &mut groups[usize::from(drawn.group)];
        let mut seen = touch(shared, drawn.splat.surfel, q, w);
        if let Some(limit) = beyond {
            seen.decide(|| Decision::beyond(shared.depth(w), limit, ["behind ", "masked "]));
        }
        let bin = blending.bins[usize::from(drawn.group)].bin(seen.t);
        seen.decide(|| {
            let (held, words) = (layers.bin, ["blended", "dropped"]);
            Decision::new("bin", [bin, held], layers.is_behind(bin), ["< ", ">="], words)
        });
        if seen.passes() {
            layers.add(drawn, bin, seen.t);
            seen.gives = Some(("opacity", drawn.alpha));
        }
        touches.push(seen);
    });
    let reached = groups.into_iter().map(|(_, touches)| touches).enumerate();
    reached.filter(|(_, touches)| !touches.is_empty()).collect()
}

impl<R: Exact> fmt::Display for TransparentReplay<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ((x, y), n) = (self.pixel, |value: R| value.to_f64());
        writeln!(f, "pixel ({x}, {y}): groups whose splats reach it: {}", self.groups.len())?;
        let limit = n(self.limit);
        writeln!(
            f,
            "\ngeometry pass, from back to front: inside if q <= {limit}, blended if bin < before"
        )?;
        for at in &self.groups {
            writeln!(f, "  group {}", at.group)?;
            at.touches.iter().try_for_each(|touch| writeln!(f, "    {touch}"))?;
            writeln!(
                f,
                "    gives opacity {} and colour {:?} of {} layers, whose opacities sum to {}",
                n(at.alpha),
                at.color.map_inline(n),
                at.count,
                n(at.opacity)
            )?;
        }
        if self.groups.iter().all(|at| at.count == 0) {
            let nothing = self.beyond.map_or("the pixel is empty", |_| "nothing is behind");
            return writeln!(f, "\n{nothing}");
        }
        writeln!(
            f,
            "\ncompositing pass: opacity {}, colour {:?} over black, {} layers on average (nearest \
             {}, surfel {})",
            n(self.alpha),
            self.color.map_inline(n),
            n(self.layers),
            n(self.nearest),
            self.id
        )
    }
}
