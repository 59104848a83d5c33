//! The depth-images of the groups in one tile: only the blocks that a splat touches.

use crate::method::fast::tile::{LANES, Lanes, Tile};
use crate::scene::group::Groups;

/// No image.
pub(super) const NONE: u32 = u32::MAX;

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

/// The images of all groups in one tile.
pub(super) struct Images {
    /// The splats of the tile, by group and then ascending.
    pub(super) order: Vec<u32>,
    /// Each group that has splats: where it ends in `order`.
    pub(super) ends: Vec<usize>,
    /// For each of these groups and each block, which of `images`, or [`NONE`].
    pub(super) slots: Vec<u32>,
    /// Of each splat of the tile, and zeros.
    pub(super) attributes: Vec<Attributes>,
    /// What has been touched.
    pub(super) images: Vec<Image>,
}

impl Images {
    /// Sorts the splats of a tile by group; the images are empty.
    pub(super) fn new(tile: &Tile, groups: &Groups) -> Self {
        let own: Vec<u8> =
            tile.splats.iter().map(|splat| groups.own()[splat.surfel as usize]).collect();
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
        let mut order = vec![0; own.len()];
        for (i, &group) in own.iter().enumerate() {
            let place = &mut next[usize::from(group)];
            order[*place] = i as u32;
            *place += 1;
        }
        let mut attributes = Vec::with_capacity(own.len() + 1);
        attributes.extend(tile.splats.iter().map(|splat| {
            let ([r, g, b], [x, y, z]) = (splat.color, splat.normal);
            [r, g, b, 1.0, x, y, z, 0.0]
        }));
        attributes.push([0.0; 8]);
        let pairs = ends.len() * tile.blocks.len();
        let images = Vec::with_capacity(pairs);
        Self { order, ends, slots: vec![NONE; pairs], attributes, images }
    }
}
