//! The planes that a TOML file promises.

use super::parse::{DepthKeys, Encoding, PlaneKeys};
use crate::method::{Holds, PlaneRow};

/// A plane to look for.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    /// The key of the plane, as the TOML file spells it.
    pub(super) key: String,
    /// The name of the plane.
    pub(super) name: String,
    pub(super) row: &'static PlaneRow,
    /// The keys of the plane, completed by the keys for all depths.
    pub(super) keys: PlaneKeys,
    /// The depth keys of this plane alone.
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

    /// Whether the plane holds depths t.
    pub(super) fn is_depth(&self) -> bool {
        self.row.holds == Holds::Depth
    }

    /// Whether the plane holds unit vectors in two numbers a pixel.
    pub(super) fn is_octahedral(&self) -> bool {
        self.keys.encoding == Some(Encoding::Octahedral)
    }

    /// The crate's names for the channels; the first two for vectors in two numbers.
    pub(super) fn channels(&self) -> Vec<String> {
        let mut channels = self.row.holds.channels(&self.name);
        channels.truncate(if self.is_octahedral() { 2 } else { 3 });
        channels
    }

    /// The channels of the key `channel`. One name stands for all channels of a colour or a vector:
    /// `ViewLayer.Combined` for `ViewLayer.Combined.R` and so on.
    pub(super) fn chosen(&self) -> Option<Vec<String>> {
        let names = self.keys.channel.as_ref()?;
        let own = self.channels();
        let [one] = names.as_slice() else { return Some(names.clone()) };
        if own.len() == 1 {
            return Some(names.clone());
        }
        let ends = own.iter().filter_map(|name| name.rsplit('.').next());
        Some(ends.map(|end| format!("{one}.{end}")).collect())
    }
}
