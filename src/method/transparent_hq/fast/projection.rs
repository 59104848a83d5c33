//! The splats of both passes.

use crate::error::Result;
use crate::frame::Rect;
use crate::index::members::Set;
use crate::method::algorithm::Job;
use crate::method::fast::prepare;
use crate::method::fast::tile::{Record, Tile};
use crate::method::prepare::Prepared;
use crate::method::transparent::fast::{FastBlending, LayerOfSurface};
use crate::method::transparent_hq::Settings;
use crate::splat::Tally;

/// The splats of a picture, projected and sorted into tiles.
pub(super) struct Splats {
    /// Those of the other layers.
    pub(super) blending: FastBlending<LayerOfSurface>,
    /// Those of the nearest layer, where groups enlarge their surfels; else they are the others.
    own: Option<Prepared<f32, Record>>,
}

impl Splats {
    /// Projection: of every surfel once, or once more for each scale of its groups.
    pub(super) fn project(job: &Job<'_>, settings: &Settings) -> Result<Self> {
        let keep_radii = job.index.members()?.keep_radii();
        let own = (!keep_radii).then(|| prepare(job, &settings.layers.splats));
        // As the nearest layer has it: once, whatever groups it is in.
        let once = |_: Set| 1;
        Ok(Self { blending: FastBlending::project(job, &settings.layers, once)?, own })
    }

    /// What became of the surfels as the nearest layer draws them.
    pub(super) fn tally(&self) -> Tally {
        self.own.as_ref().map_or(self.blending.tally(), |own| own.tally)
    }

    /// The splats of a tile: of the other layers from back to front, and, in the tile, of the nearest
    /// layer in ascending order.
    pub(super) fn gather(
        &self,
        index: usize,
        rect: Rect,
        layers: &mut Vec<Record<LayerOfSurface>>,
        tile: &mut Tile,
    ) {
        self.blending.prepared.gather_f32(index, &rect, layers);
        tile.splats.clear();
        match &self.own {
            Some(own) => own.gather_f32(index, &rect, &mut tile.splats),
            None => tile.splats.extend(ascending(layers)),
        }
        tile.empty(rect, self.blending.prepared.shared.empty());
    }
}

/// Splats of different surfels in ascending order.
fn ascending(layers: &[Record<LayerOfSurface>]) -> impl Iterator<Item = Record> {
    let mut order: Vec<_> =
        (0_u64..).zip(layers).map(|(i, l)| u64::from(l.surfel) << 32 | i).collect();
    order.sort_unstable();
    order.into_iter().map(|key| {
        let Record { footprint, surfel, bounds, attributes } = layers[key as u32 as usize];
        Record { footprint, surfel, bounds, attributes: attributes.surface }
    })
}
