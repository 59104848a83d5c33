//! Blend the layers of a block of pixels: the geometry pass, compiled for every vector width.

use super::FastBlending;
use super::averaging::AverageBlock;
use super::projection::{Blended, Layer};
use crate::composite::decide;
use crate::frame::NO_ID;
use crate::index::members::Set;
use crate::method::clock::{Work, spend};
use crate::method::fast::fragments::{fragments, inside};
use crate::method::fast::tile::Record;
use crate::number::lanes::{LANES, Lanes, Mask, any, each, mask, select, select_u32, vectorized};

/// The image of the present group at the pixels of a block.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct LayersBlock {
    /// The bin of the nearest fragment so far; +inf where there is none.
    bin: Lanes,
    /// The blend of all fragments that passed.
    pub(super) color: [Lanes; 3],
    pub(super) alpha: Lanes,
    /// The sum of the opacities in front of the nearest opaque fragment.
    pub(super) opacity: Lanes,
    /// 1 if an opaque fragment hides the fragments behind it, else 0.
    pub(super) hidden: Lanes,
    /// How many fragments passed, up to 255.
    pub(super) count: Lanes,
    /// Depth of the fragment that passed last, the nearest; +inf where there is none.
    pub(super) depth: Lanes,
    /// Surfel of that fragment.
    pub(super) id: [u32; LANES],
}

impl LayersBlock {
    /// No fragment.
    pub(super) const EMPTY: Self = Self {
        bin: [f32::INFINITY; LANES],
        color: [[0.0; LANES]; 3],
        alpha: [0.0; LANES],
        opacity: [0.0; LANES],
        hidden: [0.0; LANES],
        count: [0.0; LANES],
        depth: [f32::INFINITY; LANES],
        id: [NO_ID; LANES],
    };
}

/// The least nearness at each pixel of a block that belongs to the nearest layer or lies before it.
#[repr(align(64))]
pub(crate) struct Nearest(pub(crate) Lanes);

impl Nearest {
    /// No nearest layer: every fragment is blended.
    pub(super) const NONE: Self = Self([f32::INFINITY; LANES]);
}

impl<A: Blended> FastBlending<A> {
    /// Blends the layers of each group at the pixels of a block, whose first pixel is `corner`, and
    /// averages the groups. `list` holds splats of the tile from back to front. `images` has one
    /// image for each group; their previous values are ignored.
    pub(super) fn blend<const BEHIND: bool>(
        &self,
        average: &mut AverageBlock,
        images: &mut [LayersBlock],
        splats: &[Record<A>],
        list: &[u32],
        corner: (u32, u32),
        nearest: &Nearest,
    ) {
        spend(Work::Blend);
        if self.prepared.shared.ray_cast {
            blend::<true, BEHIND, A>(self, average, images, splats, list, corner, nearest);
        } else {
            blend::<false, BEHIND, A>(self, average, images, splats, list, corner, nearest);
        }
    }
}

vectorized!(
    fn blend<const RAY_CAST: bool, const BEHIND: bool, A: Blended>(
        rules: &FastBlending<A>,
        average: &mut AverageBlock,
        images: &mut [LayersBlock],
        splats: &[Record<A>],
        list: &[u32],
        corner: (u32, u32),
        nearest: &Nearest,
    ) {
        let (shared, bins, holes) = (rules.prepared.shared, rules.bins.as_slice(), rules.holes);
        let common = bins[0];
        let groups = images.len();
        // The groups that have a fragment; the images of the others still belong to an earlier
        // block.
        let mut there: Set = 0;
        for &index in list {
            let splat = &splats[index as usize];
            let (q, w) = fragments::<RAY_CAST>(&shared, &splat.footprint, corner);
            let mut left = inside(&q, &w, shared.limit);
            if BEHIND {
                let before = nearest.0;
                left = each(|i| if left[i] >= before[i] { f32::NAN } else { left[i] });
            }
            if !any(&mask(|i| !left[i].is_nan())) {
                continue;
            }
            let (mut place, mut depth) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                depth[i] = shared.depth(left[i]);
                // NaN outside, which fails.
                place[i] = common.unmoved(depth[i]);
            }
            let layer = splat.attributes.as_ref();
            let mut rest = layer.groups;
            while rest != 0 {
                let group = rest.trailing_zeros() as usize;
                let (image, own) = (&mut images[group], bins[group]);
                let bin = each(|i| own.bin_of(own.moving(place[i])));
                if there >> group & 1 == 0 {
                    there |= 1 << group;
                    *image = LayersBlock::EMPTY;
                }
                image.meet::<BEHIND>(layer, splat.surfel, &bin, &depth);
                rest &= rest - 1;
            }
        }
        while there != 0 {
            average.add::<BEHIND>(&images[there.trailing_zeros() as usize]);
            there &= there - 1;
        }
        average.divide::<BEHIND>(holes, groups);
    }
);

impl LayersBlock {
    /// Makes the depth test against the fragments of a splat, and blends those that pass. Bins are
    /// NaN where there is no fragment.
    #[inline(always)]
    fn meet<const TOTALS: bool>(&mut self, layer: &Layer, surfel: u32, bin: &Lanes, depth: &Lanes) {
        let before = *self;
        let passes = mask(|i| bin[i] < before.bin[i]);
        let Layer { color: [r, g, b], alpha, .. } = *layer;
        let [red, green, blue] = &before.color;
        self.color = [
            over(&passes, alpha, alpha * r, red),
            over(&passes, alpha, alpha * g, green),
            over(&passes, alpha, alpha * b, blue),
        ];
        self.alpha = over(&passes, alpha, alpha, &before.alpha);
        if TOTALS {
            let (opacity, hidden) = if decide::opaque(alpha) {
                ([0.0; LANES], [1.0; LANES])
            } else {
                (each(|i| before.opacity[i] + alpha), before.hidden)
            };
            self.opacity = select(&passes, &opacity, &before.opacity);
            self.hidden = select(&passes, &hidden, &before.hidden);
        }
        let count = each(|i| if before.count[i] < 255.0 { before.count[i] + 1.0 } else { 255.0 });
        self.count = select(&passes, &count, &before.count);
        self.bin = select(&passes, bin, &before.bin);
        self.depth = select(&passes, depth, &before.depth);
        self.id = select_u32(&passes, &[surfel; LANES], &before.id);
    }
}

/// A channel of a layer with opacity `alpha` over the channel below, where the layer passes; `own`
/// is the layer's channel times alpha.
#[inline(always)]
fn over(passes: &Mask, alpha: f32, own: f32, below: &Lanes) -> Lanes {
    let through = 1.0 - alpha;
    select(passes, &each(|i| own + through * below[i]), below)
}
