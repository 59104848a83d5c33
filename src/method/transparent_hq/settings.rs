//! The settings of the method.

use crate::error::Result;
use crate::method::single_pass::{BinCount, DepthTest};
use crate::method::transparent;
use crate::setting::{Field, Fields, Slot, Visit};
use crate::shade::optics::{BendingLayers, Refraction};

/// The settings of the method; each of them may change the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// How the other layers are blended; the nearest layer has the same footprints, epsilon and
    /// culling.
    pub layers: transparent::Settings,
    /// Which fragment of a group the nearest layer keeps.
    pub nearest: DepthTest,
    /// How light is bent at the nearest layer; you see refraction only with an environment.
    pub refraction: Option<Refraction>,
}

impl Default for Settings {
    /// Voronoi depth with bins as deep as epsilon; nothing is refracted.
    fn default() -> Self {
        Self {
            layers: transparent::Settings::default(),
            nearest: DepthTest::Voronoi(BinCount::Epsilon),
            refraction: None,
        }
    }
}

impl Fields for Settings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        self.layers.fields(each);
        each(self.nearest.field());
        // Both layers share one number of bins.
        if let DepthTest::Voronoi(bins) = &mut self.nearest {
            *bins = self.layers.bins;
        }
        let mut ratio = self.refraction.map(|refraction| refraction.ratio);
        let mut layers =
            self.refraction.map_or(BendingLayers::Multiple, |refraction| refraction.layers);
        let help = "refract by these ratios for red, green and blue: the index outside over the \
                    index inside, 0.6667 from air to glass";
        each(Field::new("refraction", help, Slot::Ratios(&mut ratio)).range("above 0 to 4"));
        let bends =
            Field::new("bends", "choose how many layers bend light", Slot::Word(&mut layers));
        each(if ratio.is_some() { bends } else { bends.idle("without a `refraction`") });
        self.refraction = ratio.map(|ratio| Refraction { ratio, layers });
    }
}

impl Settings {
    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if a number is not.
    pub fn check(&self) -> Result<()> {
        self.layers.check()?;
        if let DepthTest::Voronoi(bins) = &self.nearest {
            bins.check()?;
        }
        self.refraction.as_ref().map_or(Ok(()), Refraction::check)
    }
}
