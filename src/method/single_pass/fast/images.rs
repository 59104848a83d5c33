//! Hold the depth-images of the groups in one tile: only the blocks that a splat touches.

use crate::frame::NO_ID;
use crate::method::fast::groups::sorted;
use crate::method::fast::tile::{Surface, Tile};
use crate::number::lanes::{LANES, Lanes};

/// Colour, 1, normal and opacity of a splat, so that one vector holds all sums of a pixel.
pub(super) type Attributes = [f32; 8];

/// The fragments that the image of a group keeps at the pixels of a block.
#[repr(align(64))]
pub(super) struct ImageBlock {
    /// Nearness of the fragment.
    pub(super) nearness: Lanes,
    /// Weight of the fragment; where there is no fragment, an arbitrary number.
    pub(super) weight: Lanes,
    /// The fragment's splat in the list of the tile; where there is none, the length of that list.
    pub(super) splat: [u32; LANES],
}

/// The nearest fragment of all groups at the pixels of a block.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct NearestFragments {
    /// Nearness of the fragment.
    pub(super) nearness: Lanes,
    /// The fragment's splat, as in [`ImageBlock`].
    pub(super) splat: [u32; LANES],
}

/// The images of all groups in one tile.
pub(crate) struct GroupImages {
    /// The splats of the tile, by group and then ascending.
    pub(super) order: Vec<u32>,
    /// For each group that has splats: its end in `order`.
    pub(super) ends: Vec<usize>,
    /// The surfel of each splat of the tile; then [`NO_ID`].
    pub(super) surfels: Vec<u32>,
    /// The attributes of each splat of the tile; then zeros.
    pub(super) attributes: Vec<Attributes>,
    /// The blocks that are touched, group by group.
    pub(super) images: Vec<ImageBlock>,
    /// The images that each block has, by group; every block has as many places as there are
    /// `ends`.
    pub(super) lists: Vec<u32>,
    /// How many of those places are in use.
    pub(super) counts: Vec<usize>,
    /// The nearest fragments of each block.
    pub(super) nearest: Vec<NearestFragments>,
    /// The sums of weighted opacities of each block, if they are wanted.
    pub(crate) opacities: Vec<Lanes>,
}

impl GroupImages {
    /// Sorts the splats of a tile by group; nothing is touched yet. The arguments are the group of
    /// each splat, the count of all groups, and the opacity of each splat, if opacities are wanted.
    /// `empty` is the nearness of an empty pixel.
    pub(crate) fn new(
        tile: &Tile,
        groups: &[u8],
        count: usize,
        empty: f32,
        opacities: Option<&[f32]>,
    ) -> Self {
        let (splats, blocks) = (tile.splats.len(), tile.blocks.len());
        let (order, ends) = sorted(groups, count);
        let mut surfels = Vec::with_capacity(splats + 1);
        let mut attributes = Vec::with_capacity(splats + 1);
        for (i, splat) in tile.splats.iter().enumerate() {
            let Surface { normal: [x, y, z], color: [r, g, b] } = splat.attributes;
            surfels.push(splat.surfel);
            let opacity = opacities.map_or(0.0, |all| all[i]);
            attributes.push([r, g, b, 1.0, x, y, z, opacity]);
        }
        surfels.push(NO_ID);
        attributes.push([0.0; 8]);
        let none = NearestFragments { nearness: [empty; LANES], splat: [splats as u32; LANES] };
        let most = ends.len() * blocks;
        Self {
            order,
            ends,
            surfels,
            attributes,
            // Memory that is never written takes no room.
            images: Vec::with_capacity(most),
            lists: vec![0; most],
            counts: vec![0; blocks],
            nearest: vec![none; blocks],
            opacities: opacities.map_or_else(Vec::new, |_| vec![[0.0; LANES]; blocks]),
        }
    }
}
