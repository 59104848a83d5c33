//! The geometry pass over a block of pixels, compiled for every vector width.

use super::FastBlending;
use super::averaging::AverageBlock;
use super::projection::Layer;
use crate::composite::bins::DepthBins;
use crate::composite::decide;
use crate::frame::NO_ID;
use crate::method::fast::fragments::{fragments, inside};
use crate::method::fast::tile::Record;
use crate::method::transparent::Holes;
use crate::number::lanes::{LANES, Lanes, Mask, any, each, mask, select, select_u32, vectorized};
use crate::splat::Shared;

/// What the image of the group that is being drawn holds at the pixels of a block.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct LayersBlock {
    /// The bin of the nearest fragment so far; +inf where there is none.
    bin: Lanes,
    /// All fragments that passed, blended.
    pub(super) color: [Lanes; 3],
    pub(super) alpha: Lanes,
    /// The sum of the opacities in front of the nearest opaque fragment.
    pub(super) opacity: Lanes,
    /// 1 if an opaque fragment hides what is behind, else 0.
    pub(super) hidden: Lanes,
    /// How many fragments passed, up to 255.
    pub(super) count: Lanes,
    /// Depth of the fragment that passed last, the nearest; +inf where there is none.
    pub(super) depth: Lanes,
    /// Its surfel.
    pub(super) id: [u32; LANES],
}

impl LayersBlock {
    /// No fragment.
    const EMPTY: Self = Self {
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
pub(in crate::method) struct Nearest(pub(in crate::method) Lanes);

impl Nearest {
    /// No nearest layer: every fragment is blended.
    pub(super) const NONE: Self = Self([f32::INFINITY; LANES]);
}

impl FastBlending {
    /// Blends the layers of each group at the pixels of a block, whose first is `corner`, and
    /// averages the groups. `list` has splats of the tile, group by group and from back to front.
    pub(super) fn blend<const BEHIND: bool>(
        &self,
        average: &mut AverageBlock,
        splats: &[Record<Layer>],
        list: &[u32],
        corner: (u32, u32),
        nearest: &Nearest,
    ) {
        let shared = &self.prepared.shared;
        let blocks = (average, corner, nearest);
        if shared.ray_cast {
            blend::<true, BEHIND>(blocks, splats, list, (shared, &self.bins), self.holes);
        } else {
            blend::<false, BEHIND>(blocks, splats, list, (shared, &self.bins), self.holes);
        }
    }
}

vectorized!(
    fn blend<const RAY_CAST: bool, const BEHIND: bool>(
        (average, corner, nearest): (&mut AverageBlock, (u32, u32), &Nearest),
        splats: &[Record<Layer>],
        list: &[u32],
        (shared, bins): (&Shared<f32>, &[DepthBins<f32>]),
        holes: Holes,
    ) {
        let shared = *shared;
        let mut layers = LayersBlock::EMPTY;
        let (mut group, mut own) = (None, bins[0]);
        for &index in list {
            let splat = &splats[index as usize];
            if group != Some(splat.attributes.group) {
                if group.is_some() {
                    average.add::<BEHIND>(&layers);
                    layers = LayersBlock::EMPTY;
                }
                group = Some(splat.attributes.group);
                own = bins[usize::from(splat.attributes.group)];
            }
            let (q, w) = fragments::<RAY_CAST>(&shared, &splat.footprint, corner);
            let mut left = inside(&q, &w, shared.limit);
            if BEHIND {
                let before = nearest.0;
                left = each(|i| if left[i] >= before[i] { f32::NAN } else { left[i] });
            }
            if any(&mask(|i| !left[i].is_nan())) {
                layers.meet::<BEHIND>(splat, &left, &shared, &own);
            }
        }
        if group.is_some() {
            average.add::<BEHIND>(&layers);
        }
        average.divide::<BEHIND>(holes, bins.len());
    }
);

impl LayersBlock {
    /// The depth test against the fragments of a splat, of which NaN are none, and the blending of
    /// those that pass.
    #[inline(always)]
    fn meet<const TOTALS: bool>(
        &mut self,
        splat: &Record<Layer>,
        nearness: &Lanes,
        shared: &Shared<f32>,
        bins: &DepthBins<f32>,
    ) {
        let before = *self;
        let (mut bin, mut depth) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            depth[i] = shared.depth(nearness[i]);
            // NaN, which fails, outside.
            bin[i] = bins.bin(depth[i]);
        }
        let passes = mask(|i| bin[i] < before.bin[i]);
        let Layer { color: [r, g, b], alpha, .. } = splat.attributes;
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
        self.bin = select(&passes, &bin, &before.bin);
        self.depth = select(&passes, &depth, &before.depth);
        self.id = select_u32(&passes, &[splat.surfel; LANES], &before.id);
    }
}

/// A channel of a layer of opacity `alpha` before what was below it, where it passes; `own` is the
/// channel times alpha.
#[inline(always)]
fn over(passes: &Mask, alpha: f32, own: f32, below: &Lanes) -> Lanes {
    let through = 1.0 - alpha;
    select(passes, &each(|i| own + through * below[i]), below)
}
