//! Project the splats of both passes.

use crate::error::Result;
use crate::frame::Rect;
use crate::index::members::Set;
use crate::method::Job;
use crate::method::fast::groups::own;
use crate::method::fast::prepare;
use crate::method::fast::tile::{Record, Tile};
use crate::method::prepare::Prepared;
use crate::method::transparent::fast::{FastBlending, Layer, LayerOfSurface};
use crate::method::transparent_hq::Settings;
use crate::scene::{Groups, Surfels};
use crate::splat::Tally;

/// The splats of a picture, projected and sorted into tiles.
pub(super) struct Splats<'a> {
    surfels: &'a Surfels,
    groups: &'a Groups,
    /// The splats of the other layers.
    pub(super) blending: FastBlending<LayerOfSurface>,
    /// The splats of the nearest layer, if groups enlarge their surfels; else both passes share the
    /// splats.
    nearest: Option<Prepared<f32, Record>>,
}

/// The splats of a tile.
pub(super) struct Gathered {
    /// The splats of the other layers, from back to front.
    pub(super) layers: Vec<Record<LayerOfSurface>>,
    /// The splats of the nearest layer in ascending order, and the empty blocks of the tile.
    pub(super) nearest: Tile,
    /// The own group of each splat of the nearest layer.
    pub(super) groups: Vec<u8>,
    /// The opacity of each splat of the nearest layer.
    pub(super) opacities: Vec<f32>,
}

impl<'a> Splats<'a> {
    /// Projects every surfel once, or once more for each scale of its groups.
    pub(super) fn project(job: &Job<'a>, settings: &Settings) -> Result<Self> {
        let keep_radii = job.index.members()?.keep_radii();
        let nearest = (!keep_radii).then(|| prepare(job, &settings.layers.splats));
        // Each surfel counts once, whatever groups it is in, as in the nearest layer.
        let once = |_: Set| 1;
        let blending = FastBlending::project(job, &settings.layers, once)?;
        Ok(Self { surfels: &job.scene.surfels, groups: job.index.groups()?, blending, nearest })
    }

    /// Counts the fates of the surfels as the nearest layer draws them.
    pub(super) fn tally(&self) -> Tally {
        self.nearest.as_ref().map_or(self.blending.tally(), |nearest| nearest.tally)
    }

    /// The splats of a tile of these pixels.
    pub(super) fn gather(&self, index: usize, rect: Rect) -> Gathered {
        let surfels = self.surfels;
        let mut layers = Vec::new();
        self.blending.prepared.gather_f32(index, &rect, &mut layers);
        let mut nearest = Tile::new([true, surfels.color().is_some()]);
        let (groups, opacities) = if let Some(alone) = &self.nearest {
            alone.gather_f32(index, &rect, &mut nearest.splats);
            let opacities =
                nearest.splats.iter().map(|splat| surfels.opacity_of(splat.surfel as usize));
            (own(&nearest.splats, self.groups), opacities.collect())
        } else {
            // A layer carries its group and its opacity: with two million surfels, fetching them
            // from the scene took a tenth of a frame and more.
            nearest.splats.reserve(layers.len());
            let beside = ascending(&layers).map(|splat| {
                nearest.splats.push(LayerOfSurface::surface(splat));
                let Layer { own, alpha, .. } = *splat.attributes.as_ref();
                (own, alpha)
            });
            beside.unzip()
        };
        nearest.empty(rect, self.blending.prepared.shared.empty());
        Gathered { layers, nearest, groups, opacities }
    }
}

/// Splats of different surfels in ascending order.
fn ascending(layers: &[Record<LayerOfSurface>]) -> impl Iterator<Item = &Record<LayerOfSurface>> {
    let mut order: Vec<_> =
        (0_u64..).zip(layers).map(|(i, l)| u64::from(l.surfel) << 32 | i).collect();
    order.sort_unstable();
    order.into_iter().map(|key| &layers[key as u32 as usize])
}
