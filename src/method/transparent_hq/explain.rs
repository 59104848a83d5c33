//! Explain every decision at one pixel, with its operands.

use super::Settings;
use super::compositing::Through;
use super::nearest::{Shading, single_pass};
use super::picture::check;
use crate::composite::decide;
use crate::composite::over::Blend;
use crate::error::Result;
use crate::method::Job;
use crate::method::decisions::Place;
use crate::method::single_pass::compositing::composites;
use crate::method::single_pass::explain::{GroupsReplay, explain as explain_nearest};
use crate::method::single_pass::geometry::Geometry;
use crate::method::transparent::explain::{TransparentReplay, replay};
use crate::number::{Exact, MapInline};
use crate::scene::Environment;
use std::fmt;

/// The replay of one pixel.
#[derive(Clone, Debug)]
pub struct HighQualityReplay<R> {
    /// Pass 1: the nearest layer.
    pub nearest: GroupsReplay<R>,
    /// Average opacity of the nearest layer.
    pub alpha: R,
    /// Colour of the nearest layer, shaded.
    pub color: [R; 3],
    /// The end of the layer's band: fragments up to this depth are masked.
    pub band: R,
    /// Pass 2: the other layers.
    pub others: TransparentReplay<R>,
    /// Pass 3: the pixel before the environment.
    pub shown: Blend<R>,
}

/// Replays the three passes at one pixel.
///
/// # Errors
/// [`crate::Error::Usage`] if the pixel is outside the picture; else the errors of a picture.
pub fn explain<R: Exact>(
    job: &Job<'_>,
    settings: &Settings,
    pixel: (u32, u32),
) -> Result<HighQualityReplay<R>> {
    check(job, settings)?;
    let first = single_pass(settings);
    let nearest = explain_nearest::<R>(job, &first, pixel)?;
    let place = Place::new(job, pixel)?;
    let geometry = Geometry::<R>::project(job, &first)?;
    let images = geometry.images(place.tile, place.rect);
    let composite = composites(&images, 1, nearest.epsilon, geometry.shared().empty())[0];
    let layer = Shading::new(job).layer(pixel, &composite);

    let band = decide::limit(layer.depth, nearest.epsilon);
    let (others, average) = replay(job, &settings.layers, pixel, Some(band))?;
    let shown = Through::new(job, settings, Environment::radiance).pixel(pixel, &layer, &average);
    let (alpha, color) = (layer.opacity, layer.color);
    Ok(HighQualityReplay { nearest, alpha, color, band, others, shown })
}

impl<R: Exact> fmt::Display for HighQualityReplay<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let n = |value: R| value.to_f64();
        write!(f, "nearest layer: {}", self.nearest)?;
        if self.nearest.nearest == R::INFINITY {
            return Ok(());
        }
        writeln!(f, "  gives opacity {} and colour {:?}", n(self.alpha), self.color.map_inline(n))?;
        write!(f, "\nother layers, behind depth {}: {}", n(self.band), self.others)?;
        let Blend { color, alpha } = self.shown;
        writeln!(
            f,
            "\nthe nearest layer before the others: opacity {}, colour {:?}",
            n(alpha),
            color.map_inline(n)
        )
    }
}
