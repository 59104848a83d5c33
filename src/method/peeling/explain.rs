//! Explain every decision at one pixel, with its operands.

use super::Settings;
use super::layers::{PeeledLayer, PeeledPixel, Peeling};
use crate::composite::decide;
use crate::composite::under::Under;
use crate::error::Result;
use crate::frame::NO_ID;
use crate::method::Job;
use crate::method::decisions::{Place, Touch};
use crate::method::ewa::explain::{TwoPasses, two_passes};
use crate::number::{Exact, MapInline};
use std::fmt;

/// The replay of one pixel.
#[derive(Clone, Debug)]
pub struct PeelingReplay<R> {
    /// Column and row.
    pub pixel: (u32, u32),
    /// k^2, the limit of q.
    pub limit: R,
    /// The depth of a layer's band in world units.
    pub epsilon: R,
    /// The layers, from the front.
    pub layers: Vec<LayerAt<R>>,
    /// The splats whose bounds hold the pixel, if the pixel has no layer.
    pub touches: Vec<Touch<R>>,
    /// The blend of the layers.
    pub blend: Under<R>,
}

/// A layer at the pixel.
#[derive(Clone, Debug)]
pub struct LayerAt<R> {
    /// Visibility splatting: the splats whose bounds hold the pixel, in ascending surfel index.
    pub touches: Vec<Touch<R>>,
    /// Attribute splatting: the splats of `touches` that are inside and not yet peeled; each gives
    /// its weight, if it is in the layer.
    pub visible: Vec<Touch<R>>,
    /// The layer.
    pub layer: PeeledLayer<R>,
}

/// Replays the layers at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture.
pub fn explain<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    pixel: (u32, u32),
) -> Result<PeelingReplay<R>> {
    let place = Place::new(job, pixel)?;
    let peeling = Peeling::<R>::project(job, settings);
    let splats = place.splats(&peeling.splats);
    let (limit, epsilon) = (splats.shared().limit, splats.epsilon());
    let mut seen = PeeledPixel::new();
    let (mut layers, mut reached) = (Vec::new(), Vec::new());
    for _ in 0..settings.layers {
        let beyond = (seen.layers > 0).then_some(seen.limit);
        let TwoPasses { nearest, sums, touches, visible } =
            two_passes(&splats, peeling.surfels, beyond);
        if nearest.id == NO_ID {
            reached = touches;
            break;
        }
        let layer = peeling.resolve(&nearest, &sums, pixel);
        seen.add(&layer, epsilon);
        layers.push(LayerAt { touches, visible, layer });
    }
    let touches = if layers.is_empty() { reached } else { Vec::new() };
    Ok(PeelingReplay { pixel, limit, epsilon, layers, touches, blend: seen.blend })
}

impl<R: Exact> fmt::Display for PeelingReplay<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ((x, y), n) = (self.pixel, |value: R| value.to_f64());
        let first = self.layers.first().map_or(&self.touches, |at| &at.touches);
        writeln!(f, "pixel ({x}, {y}): {} splats reach it", first.len())?;
        if self.layers.is_empty() {
            writeln!(f, "\nvisibility splatting: inside if q <= {}", n(self.limit))?;
            self.touches.iter().try_for_each(|touch| writeln!(f, "  {touch}"))?;
            return writeln!(f, "\nthe pixel is empty");
        }
        for (number, at) in (1..).zip(&self.layers) {
            let LayerAt { touches, visible, layer } = at;
            writeln!(
                f,
                "\nlayer {number}, visibility splatting: inside if q <= {}",
                n(self.limit)
            )?;
            // A fragment that is outside, or already peeled, has been printed with the layers
            // before.
            let mut left = touches.iter().filter(|touch| number == 1 || touch.gives.is_some());
            left.try_for_each(|touch| writeln!(f, "  {touch}"))?;
            writeln!(
                f,
                "layer {number}, attribute splatting: visible if depth <= {} (nearest {}, surfel \
                 {}, + epsilon {})",
                n(decide::limit(layer.depth, self.epsilon)),
                n(layer.depth),
                layer.id,
                n(self.epsilon)
            )?;
            visible.iter().try_for_each(|touch| writeln!(f, "  {touch}"))?;
            let PeeledLayer { count, alpha, color, .. } = layer;
            let color = color.map_inline(n);
            writeln!(f, "  gives opacity {} and colour {color:?} of {count}", n(*alpha))?;
        }
        let Under { color, alpha, through } = self.blend;
        let count = self.layers.len();
        writeln!(
            f,
            "\nblending of {count} layers: opacity {}, colour {:?} over black, {} of what is behind",
            n(alpha),
            color.map_inline(n),
            n(through)
        )
    }
}
