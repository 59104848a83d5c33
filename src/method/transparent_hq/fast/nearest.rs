//! Draw the nearest layer, pass 1: the fast path of the single pass, with opacities, and its
//! shading.

use super::projection::Gathered;
use crate::composite::bins::DepthBins;
use crate::composite::sum;
use crate::error::Result;
use crate::method::Job;
use crate::method::clock::{Work, spend};
use crate::method::fast::tile::{PixelBlock, ROW, Tile};
use crate::method::single_pass;
use crate::method::single_pass::fast::images::GroupImages;
use crate::method::transparent_hq::Settings;
use crate::method::transparent_hq::nearest::single_pass as of;
use crate::number::MapInline;
use crate::number::Real;
use crate::number::lanes::{LANES, Lanes, vectorized};
use crate::scene::Scene;
use crate::shade::phong::Shader;
use crate::splat::{Shared, View};

/// The constants of the nearest layer.
pub(super) struct FastNearest<'a> {
    scene: &'a Scene,
    /// How many groups there are.
    groups: usize,
    shared: Shared<f32>,
    epsilon: f32,
    /// The bins of the Voronoi depth test; none for the plain one.
    bins: Option<DepthBins<f32>>,
    shader: Shader<f32>,
}

/// The nearest layer at the pixels of a block.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct FrontBlock {
    /// `C_F`: Phong-shaded.
    pub(super) color: [Lanes; 3],
    /// alpha: the average opacity, in [0, 1].
    pub(super) opacity: Lanes,
}

impl<'a> FastNearest<'a> {
    /// Sets up everything that is known before projection.
    pub(super) fn new(job: &Job<'a>, settings: &Settings) -> Result<Self> {
        let (scene, settings) = (job.scene, of(settings));
        let single_pass::Settings { splats, .. } = settings;
        let (groups, bins) =
            (job.index.groups()?.len(), settings.bins(&scene.surfels, job.camera)?);
        let view = View::new(job.camera);
        let shared = Shared::new(&view, &splats.kernel);
        let epsilon = splats.epsilon.resolve(&scene.surfels);
        let shader = Shader::new(view, &scene.lights, scene.material);
        Ok(Self { scene, groups, shared, epsilon, bins, shader })
    }

    /// The geometry pass over a tile that has splats.
    pub(super) fn geometry(&self, gathered: &Gathered) -> GroupImages {
        let Gathered { nearest: tile, groups, opacities, .. } = gathered;
        let (shared, empty) = (&self.shared, self.shared.empty());
        let mut images = GroupImages::new(tile, groups, self.groups, empty, Some(opacities));
        images.draw(tile, shared, self.bins.as_ref());
        images
    }

    /// Runs the compositing pass, normalization and shading. Leaves depth, surfel, weight and
    /// normal in the blocks of the tile, and the least nearness that is within epsilon.
    pub(super) fn resolve(&self, tile: &mut Tile, images: &mut GroupImages) -> Vec<FrontBlock> {
        let shared = &self.shared;
        images.nearest(tile);
        tile.limits(shared, self.epsilon);
        images.composite(tile, shared);
        tile.normalize(shared);
        let (grid, material) = (tile.grid, self.scene.material.color.to_array());
        let own = (!tile.color).then_some(material);
        spend(Work::Shade);
        let blocks = tile.blocks.iter().zip(&images.opacities).enumerate();
        let front = |(index, (block, opacity)): (usize, (&PixelBlock, &Lanes))| {
            shaded(&self.shader, block, opacity, grid.corner(index), own)
        };
        blocks.map(front).collect()
    }
}

vectorized!(
    /// The colour and the opacity of the nearest layer at a block, whose first pixel is `corner`;
    /// `own` is the colour of surfels that have none.
    fn shaded(
        shader: &Shader<f32>,
        block: &PixelBlock,
        opacity: &Lanes,
        corner: (u32, u32),
        own: Option<[f32; 3]>,
    ) -> FrontBlock {
        let surface = own.map_or(block.color, |own| own.map_inline(|value| [value; LANES]));
        let color = shader.block::<ROW>(corner, &block.nearest, &block.normal, &surface);
        let (weight, sums, mut opacity) = (block.weight, *opacity, [0.0; LANES]);
        for i in 0..LANES {
            let [alpha, ..] = sum::average([sums[i], 0.0, 0.0], weight[i]);
            // The quotient of two sums may exceed 1 by their rounding.
            opacity[i] = alpha.at_most(1.0);
        }
        FrontBlock { color, opacity }
    }
);
