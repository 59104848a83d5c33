//! What is compared, and what may differ on purpose.

use crate::error::{Error, Result};
use crate::frame::Image;

/// What may differ on purpose in a plane. The default lets nothing differ.
///
/// A pixel passes if its bits are equal or, where both values are finite floats, if it is within
/// either bound that is given. Indices and counts have no distance: a pixel of theirs passes by
/// equality alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerance {
    /// At most so many representable `f32` from one value to the other; -0 and +0 are the same one.
    pub max_ulp: Option<u32>,
    /// At most this difference of the values, taken in f64; at least 0.
    pub max_abs: Option<f32>,
    /// So many pixels of a channel may fail to pass, each by any amount.
    pub pixels: usize,
}

/// What of two pictures is compared, and by which tolerance.
///
/// A **name** stands for the channel of that name, for the three channels of the colour or the
/// vector of that name (`normal` for `normal.X`, `normal.Y` and `normal.Z`, where there are all
/// three), or, with a `*` at its end, for every channel whose name starts so (`visibility.*`, `*`).
/// The colour of the picture itself has the three names `R`, `G` and `B`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Criteria {
    /// The names of the planes to compare; none for all planes.
    pub planes: Option<Vec<String>>,
    /// The tolerance of every plane that `named` does not name.
    pub tolerance: Tolerance,
    /// A name and the whole tolerance of its planes; of several that name a channel the last holds.
    pub named: Vec<(String, Tolerance)>,
    /// Whether a plane that the reference has for observation ([`is_observation`]), and the other
    /// picture has not, is left out instead of making a difference.
    pub skip_observations: bool,
}

/// Whether a channel only observes how a picture was made: `margin`, alone or in a layer, the
/// distance of the closest decision of a pixel from being undecided. A backend has no such plane.
#[must_use]
pub fn is_observation(channel: &str) -> bool {
    channel.rsplit('.').next() == Some("margin")
}

impl Criteria {
    /// The tolerance of a channel; `all` are the names of all channels, sorted.
    pub(super) fn tolerance_of(&self, channel: &str, all: &[String]) -> Tolerance {
        let last = self.named.iter().rev().find(|(name, _)| selects(name, channel, all));
        last.map_or(self.tolerance, |(_, tolerance)| *tolerance)
    }

    /// The channels of `all` that are compared.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a name of `planes` stands for no channel of the reference, or one of
    /// `named` for none at all: what was misspelt would not be compared, or not as was meant.
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

/// Fails unless `name` stands for one of `channels`.
fn require(name: &str, channels: &[String], of: &str) -> Result<()> {
    if channels.iter().any(|channel| selects(name, channel, channels)) {
        return Ok(());
    }
    let there = channels.join(", ");
    Err(Error::Invalid(format!("no plane of {of} is called `{name}`; there are: {there}")))
}

/// Whether `name` stands for `channel`, one of `all`.
fn selects(name: &str, channel: &str, all: &[String]) -> bool {
    if let Some(start) = name.strip_suffix('*') {
        return channel.starts_with(start);
    }
    let letter = channel.strip_prefix(name).and_then(|rest| rest.strip_prefix('.'));
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
