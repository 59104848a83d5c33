//! Choose the primitives that a model is drawn as.

use super::Source;
use crate::source::hybrid::HalfSpace;

/// The primitives that a model is drawn as.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Draw {
    /// Facets for a mesh whose points have no extent of their own, points for anything else:
    /// [`crate::source::derive::facets_or_surfels`].
    Surfels,
    /// Its points as surfels.
    Points,
    /// Its triangles as elliptical surfels, one for each: [`crate::source::derive::facets`].
    Facets,
    /// Its triangles as polygons.
    Polygons,
    /// Triangles in this half space, in the model's own coordinates, as polygons; the rest as
    /// surfels: [`crate::source::hybrid::split`].
    Hybrid(HalfSpace),
    /// Its edges as ribbons.
    Ribbons,
    /// Its edges as tubes.
    Tubes,
    /// Leaves as ribbons, branches as tubes, the trunk as polygons: [`crate::source::plant`].
    Lines,
}

impl Draw {
    /// The default for a model from this source.
    pub(super) fn default_for(source: &Source) -> Self {
        match source {
            Source::File { .. } => Self::Surfels,
            Source::Shape { .. } => Self::Points,
            Source::Tree { .. } => Self::Lines,
        }
    }

    /// Checks that a model from this source can be drawn this way.
    ///
    /// # Errors
    /// One line if it cannot.
    pub(super) fn check(self, source: &Source) -> Result<(), String> {
        let (fits, choice) = match source {
            Source::File { .. } => {
                (self != Self::Lines, "surfels, points, facets, polygons, hybrid, ribbons or tubes")
            }
            Source::Shape { .. } => (self == Self::Points, "points"),
            Source::Tree { .. } => {
                (matches!(self, Self::Lines | Self::Polygons), "lines or polygons")
            }
        };
        if fits {
            return Ok(());
        }
        let (name, word) = (source.name(), self.word());
        Err(format!("{name} is drawn as {choice}, not as {word}: change or remove `draw`"))
    }

    /// The choice that the keys `draw` and `split` make for a model from this source.
    ///
    /// # Errors
    /// One line if the word is unknown, if a hybrid has no split or another choice has one, or as
    /// [`HalfSpace::new`] and [`Draw::check`].
    pub(super) fn choose(
        word: Option<&str>,
        split: Option<[f64; 4]>,
        source: &Source,
    ) -> Result<Self, String> {
        let draw = match (word, split) {
            (Some("hybrid"), Some(split)) => {
                Self::Hybrid(HalfSpace::new(split).map_err(|error| error.to_string())?)
            }
            (Some("hybrid"), None) => {
                let what =
                    "a hybrid needs split = [a, b, c, d]: polygons where a x + b y + c z >= d";
                return Err(what.into());
            }
            (_, Some(_)) => {
                return Err("`split` has no effect without draw = \"hybrid\": remove it".into());
            }
            (None, None) => Self::default_for(source),
            (Some("surfels"), None) => Self::Surfels,
            (Some("points"), None) => Self::Points,
            (Some("facets"), None) => Self::Facets,
            (Some("polygons"), None) => Self::Polygons,
            (Some("ribbons"), None) => Self::Ribbons,
            (Some("tubes"), None) => Self::Tubes,
            (Some("lines"), None) => Self::Lines,
            (Some(word), None) => {
                let all = "surfels, points, facets, polygons, hybrid, ribbons, tubes, lines";
                return Err(format!("draw `{word}`; give one of {all}"));
            }
        };
        draw.check(source)?;
        Ok(draw)
    }

    /// The word of a scene file.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Surfels => "surfels",
            Self::Points => "points",
            Self::Facets => "facets",
            Self::Polygons => "polygons",
            Self::Hybrid(_) => "hybrid",
            Self::Ribbons => "ribbons",
            Self::Tubes => "tubes",
            Self::Lines => "lines",
        }
    }
}
