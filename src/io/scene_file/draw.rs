//! As what a model is drawn.

use crate::scene::hybrid::HalfSpace;

/// As what a model is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Draw {
    /// Its points as surfels.
    #[default]
    Points,
    /// Its triangles as polygons.
    Polygons,
    /// Triangles in this half space, in the model's own coordinates, as polygons, the rest as
    /// surfels: [`crate::scene::hybrid::split`].
    Hybrid(HalfSpace),
    /// Its edges as ribbons.
    Ribbons,
    /// Its edges as tubes.
    Tubes,
}

impl Draw {
    /// What the keys `draw` and `split` say.
    ///
    /// # Errors
    /// One line if the word is none, if a hybrid has no split or something else has one, or as
    /// [`HalfSpace::new`].
    pub(super) fn choose(word: Option<&str>, split: Option<[f64; 4]>) -> Result<Self, String> {
        match (word, split) {
            (Some("hybrid"), Some(split)) => {
                let half = HalfSpace::new(split).map_err(|error| error.to_string())?;
                Ok(Self::Hybrid(half))
            }
            (Some("hybrid"), None) => {
                Err("a hybrid needs split = [a, b, c, d]: polygons where a x + b y + c z >= d"
                    .into())
            }
            (_, Some(_)) => {
                Err("`split` means nothing without draw = \"hybrid\": remove it".into())
            }
            (None | Some("points"), None) => Ok(Self::Points),
            (Some("polygons"), None) => Ok(Self::Polygons),
            (Some("ribbons"), None) => Ok(Self::Ribbons),
            (Some("tubes"), None) => Ok(Self::Tubes),
            (Some(word), None) => {
                Err(format!("draw `{word}`; give one of points, polygons, hybrid, ribbons, tubes"))
            }
        }
    }

    /// The word for it.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::Points => "points",
            Self::Polygons => "polygons",
            Self::Hybrid(_) => "hybrid",
            Self::Ribbons => "ribbons",
            Self::Tubes => "tubes",
        }
    }
}
