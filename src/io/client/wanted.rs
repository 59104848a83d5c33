//! The planes that a TOML file promises.

use super::parse::{DepthKeys, Encoding, PlaneKeys};
use crate::method::{Holds, PlaneRow};

/// A plane that is looked for.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    /// What the TOML file calls it, as it is written there.
    pub(super) key: String,
    /// The name of the plane.
    pub(super) name: String,
    pub(super) row: &'static PlaneRow,
    /// What is said of it, and of all depths.
    pub(super) keys: PlaneKeys,
    /// What is said of it alone.
    pub(super) own_depth: DepthKeys,
}

impl Wanted {
    pub(super) fn new(
        key: &str,
        name: &str,
        row: &'static PlaneRow,
        keys: PlaneKeys,
        all: DepthKeys,
    ) -> Self {
        let own_depth = keys.depth;
        let keys = PlaneKeys { depth: own_depth.or(all), ..keys };
        let key = if key.contains('.') { format!("\"{key}\"") } else { key.to_owned() };
        Self { key, name: name.into(), row, keys, own_depth }
    }

    /// Whether it holds depths t.
    pub(super) fn is_depth(&self) -> bool {
        self.row.holds == Holds::Scalar && (self.name == "Z" || self.name.ends_with(".Z"))
    }

    /// Whether it holds unit vectors in two numbers a pixel.
    pub(super) fn is_octahedral(&self) -> bool {
        self.keys.encoding == Some(Encoding::Octahedral)
    }

    /// The names that the crate has for its channels; of two numbers those of the first two.
    pub(super) fn channels(&self) -> Vec<String> {
        let mut channels = self.row.holds.channels(&self.name);
        channels.truncate(if self.is_octahedral() { 2 } else { 3 });
        channels
    }
}
