//! Choose which planes to compare, and how much each may differ.

use crate::error::{Error, Result};
use crate::frame::Image;

/// How much a plane may differ. The default allows no difference.
///
/// A pixel passes if its bits are equal. Where both values are finite floats, a pixel also passes
/// if it is within either bound that is given. Indices and counts have no distance: their pixels
/// pass only if they are equal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerance {
    /// The most representable `f32` from one value to the other; -0 and +0 are the same one.
    pub max_ulp: Option<u32>,
    /// The largest difference of the values, taken in f64; at least 0.
    pub max_abs: Option<f32>,
    /// This many pixels of a channel may fail, each by any amount.
    pub pixels: usize,
}

/// Which planes of two pictures to compare, and with which tolerance.
///
/// A **name** selects channels in three ways:
///
/// - The channel of that name.
/// - The three channels of the colour or vector of that name: `normal` selects `normal.X`,
///   `normal.Y` and `normal.Z`, if there are all three.
/// - With a `*` at its end, every channel whose name starts so (`visibility.*`, `*`).
///
/// The colour of the picture itself has the three names `R`, `G` and `B`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Criteria {
    /// The names of the planes to compare; none to compare all planes.
    pub planes: Option<Vec<String>>,
    /// The tolerance for every plane that `named` does not name.
    pub tolerance: Tolerance,
    /// A name and the whole tolerance of its planes. If several names select a channel, the last
    /// holds.
    pub named: Vec<(String, Tolerance)>,
    /// Whether to skip a plane that only the reference has, if the plane is an observation
    /// ([`is_observation`]). Otherwise the missing plane counts as a difference.
    pub skip_observations: bool,
}

/// Whether a channel only observes how a picture was made. The one observation is `margin`, alone
/// or in a layer: the distance of the closest decision of a pixel from being undecided. A backend
/// has no such plane.
#[must_use]
pub fn is_observation(channel: &str) -> bool {
    channel.rsplit('.').next() == Some("margin")
}

impl Criteria {
    /// The tolerance of a channel. `all` holds the names of all channels, sorted.
    #[must_use]
    pub fn tolerance_of(&self, channel: &str, all: &[String]) -> Tolerance {
        let last = self.named.iter().rev().find(|(name, _)| selects(name, channel, all));
        last.map_or(self.tolerance, |(_, tolerance)| *tolerance)
    }

    /// The channels of `all` to compare.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a name of `planes` selects no channel of the reference, or a name of
    /// `named` selects no channel at all. Otherwise a misspelt plane would silently not be
    /// compared, or with the wrong tolerance.
    pub(super) fn chosen(&self, reference: &Image, all: &[String]) -> Result<Vec<String>> {
        let in_reference: Vec<String> = reference.channels.iter().map(|c| c.0.clone()).collect();
        for name in self.planes.iter().flatten() {
            require(name, &in_reference, "the reference")?;
        }
        for (name, _) in &self.named {
            require(name, all, "either picture")?;
        }
        let wanted = |channel: &String| match &self.planes {
            None => true,
            Some(names) => names.iter().any(|name| selects(name, channel, all)),
        };
        Ok(all.iter().filter(|channel| wanted(channel)).cloned().collect())
    }
}

/// Fails unless `name` selects one of `channels`.
fn require(name: &str, channels: &[String], of: &str) -> Result<()> {
    if channels.iter().any(|channel| selects(name, channel, channels)) {
        return Ok(());
    }
    let there = channels.join(", ");
    Err(Error::Invalid(format!("no plane of {of} is called `{name}`; there are: {there}")))
}

/// Whether `name` selects `channel`, one of `all`.
fn selects(name: &str, channel: &str, all: &[String]) -> bool {
    if let Some(start) = name.strip_suffix('*') {
        return channel.starts_with(start);
    }
    let letter = channel.strip_prefix(name).and_then(|rest| rest.strip_prefix('.'));
    // All three letters must be there: a lone `n.X` is no vector, and `a.Z` is the depth of a
    // layer.
    let component_of = |letters: [&str; 3]| {
        letter.is_some_and(|letter| letters.contains(&letter))
            && letters.iter().all(|letter| all.iter().any(|c| *c == format!("{name}.{letter}")))
    };
    channel == name || component_of(["X", "Y", "Z"]) || component_of(["R", "G", "B"])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stands_for_a_plane_and_no_more() {
        let all = ["R", "Z", "a.R", "a.G", "a.B", "a.Z", "n.X", "n.Y", "n.Z", "n.weight", "v.Z"];
        let all = all.map(String::from);
        let selected = |name: &str| -> Vec<&str> {
            all.iter().filter(|c| selects(name, c, &all)).map(String::as_str).collect()
        };
        assert_eq!(selected("Z"), ["Z"]);
        assert_eq!(selected("n"), ["n.X", "n.Y", "n.Z"], "the vector, not the layer");
        assert_eq!(selected("a"), ["a.R", "a.G", "a.B"], "Z is no component of a colour");
        assert_eq!(selected("n.Y"), ["n.Y"]);
        assert_eq!(selected("v"), [""; 0], "a depth is no component of a vector");
        assert_eq!(selected("n.*"), ["n.X", "n.Y", "n.Z", "n.weight"]);
        assert_eq!(selected("*").len(), all.len());
        assert_eq!(selected(""), [""; 0]);
    }

    #[test]
    fn margins_are_observations() {
        for (name, is) in [("margin", true), ("group00.margin", true), ("margin.X", false)] {
            assert_eq!(is_observation(name), is, "{name}");
        }
    }
}
