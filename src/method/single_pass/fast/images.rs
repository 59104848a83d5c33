//! The depth-images of the groups in one tile: only the blocks that a splat touches.

use crate::frame::NO_ID;
use crate::method::fast::tile::{LANES, Lanes, Tile};
use crate::scene::group::Groups;

/// Colour, 1, normal and 0: what is summed is one vector.
pub(super) type Attributes = [f32; 8];

/// What the image of a group keeps at the pixels of a block.
#[repr(align(64))]
pub(super) struct Image {
    /// Nearness of the fragment.
    pub(super) nearness: Lanes,
    /// Its weight.
    pub(super) weight: Lanes,
    /// Its splat in the list of the tile, the length of that list where there is none.
    pub(super) splat: [u32; LANES],
}

/// The nearest fragment of all groups at the pixels of a block.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Nearest {
    /// Its nearness.
    pub(super) nearness: Lanes,
    /// Its splat, as in [`Image`].
    pub(super) splat: [u32; LANES],
}

/// The images of all groups in one tile.
pub(super) struct Images {
    /// The splats of the tile, by group and then ascending.
    pub(super) order: Vec<u32>,
    /// Each group that has splats: where it ends in `order`.
    pub(super) ends: Vec<usize>,
    /// Of each splat of the tile its surfel, and [`NO_ID`].
    pub(super) surfels: Vec<u32>,
    /// Of each splat of the tile, and zeros.
    pub(super) attributes: Vec<Attributes>,
    /// What has been touched.
    pub(super) images: Vec<Image>,
    /// How many images each block has.
    pub(super) counts: Vec<usize>,
    /// Which those are, by group: of each block as many places as there are `ends`.
    pub(super) lists: Vec<u32>,
    /// For each block.
    pub(super) nearest: Vec<Nearest>,
}

impl Images {
    /// Sorts the splats of a tile by group; the images are empty.
    pub(super) fn new(tile: &Tile, groups: &Groups, empty: f32) -> Self {
        let (splats, blocks) = (tile.splats.len(), tile.blocks.len());
        // Loops of their own: what they wait for is far away, and short loops wait for much at once.
        let own: Vec<u8> = tile.splats.iter().map(|s| groups.own()[s.surfel as usize]).collect();
        let mut surfels: Vec<_> = tile.splats.iter().map(|splat| splat.surfel).collect();
        let mut attributes = Vec::with_capacity(splats + 1);
        for splat in &tile.splats {
            let ([r, g, b], [x, y, z]) = (splat.color, splat.normal);
            attributes.push([r, g, b, 1.0, x, y, z, 0.0]);
        }
        let mut next = vec![0; groups.len()];
        for &group in &own {
            next[usize::from(group)] += 1;
        }
        let mut ends = Vec::new();
        let mut sum = 0;
        for count in &mut next {
            let start = sum;
            sum += *count;
            if *count > 0 {
                ends.push(sum);
            }
            *count = start;
        }
        let mut order = vec![0; splats];
        for (i, &group) in own.iter().enumerate() {
            let place = &mut next[usize::from(group)];
            order[*place] = i as u32;
            *place += 1;
        }
        surfels.push(NO_ID);
        attributes.push([0.0; 8]);
        let none = Nearest { nearness: [empty; LANES], splat: [splats as u32; LANES] };
        let pairs = ends.len() * blocks;
        Self {
            order,
            ends,
            surfels,
            attributes,
            images: Vec::with_capacity(pairs),
            counts: vec![0; blocks],
            lists: vec![0; pairs],
            nearest: vec![none; blocks],
        }
    }
}
