//! The settings of Algorithms 2 and 3 as one type: a test varies both.

use splatref::method::single_pass::{BinCount, DepthTest};
use splatref::method::transparent::{BinEdges, Holes};
use splatref::method::{Method, transparent, transparent_hq};
use splatref::shade::optics::Refraction;
use splatref::splat::SplatSettings;

/// Algorithm 3 if there is a nearest layer, else Algorithm 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Settings {
    pub(crate) splats: SplatSettings,
    pub(crate) bins: BinCount,
    pub(crate) bin_edges: BinEdges,
    pub(crate) holes: Holes,
    pub(crate) nearest: Option<DepthTest>,
    /// Of Algorithm 3.
    pub(crate) refraction: Option<Refraction>,
}

impl Default for Settings {
    fn default() -> Self {
        transparent::Settings::default().into()
    }
}

impl From<transparent::Settings> for Settings {
    fn from(settings: transparent::Settings) -> Self {
        let transparent::Settings { splats, bins, bin_edges, holes } = settings;
        Self { splats, bins, bin_edges, holes, nearest: None, refraction: None }
    }
}

impl From<transparent_hq::Settings> for Settings {
    fn from(settings: transparent_hq::Settings) -> Self {
        let transparent_hq::Settings { layers, nearest, refraction } = settings;
        Self { nearest: Some(nearest), refraction, ..layers.into() }
    }
}

impl From<Settings> for Method {
    fn from(settings: Settings) -> Self {
        let Settings { splats, bins, bin_edges, holes, nearest, refraction } = settings;
        let layers = transparent::Settings { splats, bins, bin_edges, holes };
        match nearest {
            None => layers.into(),
            Some(nearest) => transparent_hq::Settings { layers, nearest, refraction }.into(),
        }
    }
}
