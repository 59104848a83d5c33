//! Peel the layers of a block of pixels, compiled for every vector width: each by the two passes of
//! [`crate::method::ewa`] over the fragments that are left.

use super::fragments::{FragmentBlock, Fragments};
use super::{Attributes, FastPeeling};
use crate::composite::under::Under;
use crate::composite::{decide, sum};
use crate::frame::NO_ID;
use crate::method::clock::{Work, spend};
use crate::method::fast::fragments::add;
use crate::method::fast::layered::LayeredBlock;
use crate::method::fast::resolve::least_nearness;
use crate::method::fast::tile::ROW;
use crate::number::MapInline;
use crate::number::Real;
use crate::number::lanes::{
    LANES, Lanes, any, components, each, mask, select, select_u32, vectorized,
};
use crate::shade::phong::Shader;
use crate::splat::Shared;

/// The nearest fragments that are left.
struct Foremost {
    nearness: Lanes,
    /// The surfels of these fragments; [`NO_ID`] where no fragment is left.
    id: [u32; LANES],
}

/// The sums of a layer, in the order of [`Attributes`].
type Sums = [Lanes; 8];

/// A layer of a block: its nearest fragments, its sums, and whether no layer is before it.
#[derive(Clone, Copy)]
struct Layer<'a> {
    nearest: &'a Foremost,
    sums: &'a Sums,
    first: bool,
}

impl FastPeeling<'_> {
    /// Peels the layers off the pixels of a block, whose first pixel is `corner`.
    pub(super) fn peel(
        &self,
        block: &mut LayeredBlock,
        fragments: &mut Fragments,
        attributes: &[Attributes],
        corner: (u32, u32),
    ) {
        let shared = &self.prepared.shared;
        let mut through = [1.0; LANES];
        for layer in 0..self.most {
            spend(Work::Peel);
            let Some(nearest) = foremost(fragments, shared) else { break };
            let sums = sums(fragments, attributes, &nearest, shared, self.prepared.epsilon);
            if layer == 0 {
                block.id = nearest.id;
            }
            spend(Work::Blend);
            let layer = Layer { nearest: &nearest, sums: &sums, first: layer == 0 };
            resolve(block, &mut through, layer, corner, self.own, &self.shader, shared);
        }
        for alpha in &mut block.alpha {
            *alpha = alpha.at_most(1.0);
        }
    }
}

vectorized!(
    /// Visibility splatting: none if no pixel has a fragment left.
    fn foremost(fragments: &Fragments, shared: &Shared<f32>) -> Option<Foremost> {
        let (mut nearest, mut id) = ([shared.empty(); LANES], [NO_ID; LANES]);
        for (left, &[surfel, _]) in fragments.left.iter().zip(&fragments.splats) {
            let nearness = left.nearness;
            let nearer = mask(|i| nearness[i] > nearest[i]);
            nearest = select(&nearer, &nearness, &nearest);
            id = select_u32(&nearer, &[surfel; LANES], &id);
        }
        any(&mask(|i| id[i] != NO_ID)).then_some(Foremost { nearness: nearest, id })
    }
);

vectorized!(
    /// Attribute splatting; a fragment that has been added is no longer left.
    fn sums(
        fragments: &mut Fragments,
        attributes: &[Attributes],
        nearest: &Foremost,
        shared: &Shared<f32>,
        epsilon: f32,
    ) -> Sums {
        let shared = *shared;
        let least = each(|i| {
            let limit = decide::limit(shared.depth(nearest.nearness[i]), epsilon);
            least_nearness(&shared, limit)
        });
        let Fragments { left, splats } = fragments;
        let (mut sums, mut kept) = ([[0.0; LANES]; 8], 0);
        for index in 0..left.len() {
            let FragmentBlock { nearness, weight } = left[index];
            let visible = mask(|i| nearness[i] >= least[i]);
            let mut rest = nearness;
            if any(&visible) {
                let weight = select(&visible, &weight, &[0.0; LANES]);
                let attributes = &attributes[splats[index][1] as usize];
                add_all(&mut sums, &weight, attributes);
                rest = select(&visible, &[f32::NAN; LANES], &nearness);
                if !any(&mask(|i| !rest[i].is_nan())) {
                    continue;
                }
            }
            left[kept] = FragmentBlock { nearness: rest, weight };
            splats[kept] = splats[index];
            kept += 1;
        }
        left.truncate(kept);
        splats.truncate(kept);
        sums
    }
);

/// Adds the attributes of a splat, times its weights. Written line by line, because a loop over the
/// sums would become the vector, and its lanes would be gathered and scattered.
#[inline(always)]
fn add_all(sums: &mut Sums, weight: &Lanes, attributes: &Attributes) {
    add(&mut sums[0], weight, attributes[0]);
    add(&mut sums[1], weight, attributes[1]);
    add(&mut sums[2], weight, attributes[2]);
    add(&mut sums[3], weight, attributes[3]);
    add(&mut sums[4], weight, attributes[4]);
    add(&mut sums[5], weight, attributes[5]);
    add(&mut sums[6], weight, attributes[6]);
    add(&mut sums[7], weight, attributes[7]);
}

vectorized!(
    /// Normalization, shading, and blending under the layers before.
    fn resolve(
        block: &mut LayeredBlock,
        through: &mut Lanes,
        Layer { nearest, sums, first }: Layer<'_>,
        corner: (u32, u32),
        own: Option<[f32; 3]>,
        shader: &Shader<f32>,
        shared: &Shared<f32>,
    ) {
        let (shared, nearest_id) = (*shared, nearest.id);
        let [r, g, b, opacity, x, y, z, weight] = *sums;
        let (mut depth, mut alpha) = ([0.0; LANES], [0.0; LANES]);
        let (mut normal, mut surface) = ([x, y, z], [r, g, b]);
        for i in 0..LANES {
            depth[i] = shared.depth(nearest.nearness[i]);
            let [nx, ny, nz] = sum::direction(components(&normal, i), weight[i]);
            (normal[0][i], normal[1][i], normal[2][i]) = (nx, ny, nz);
            let [cr, cg, cb] = sum::average(components(&surface, i), weight[i]);
            (surface[0][i], surface[1][i], surface[2][i]) = (cr, cg, cb);
            let [a, ..] = sum::average([opacity[i], 0.0, 0.0], weight[i]);
            // A pixel without a layer keeps its values.
            alpha[i] = if nearest_id[i] == NO_ID { 0.0 } else { a };
        }
        if let Some(own) = own {
            surface = own.map_inline(|value| [value; LANES]);
        }
        if first {
            block.depth = depth;
        }
        let color = shader.block::<ROW>(corner, &depth, &normal, &surface);
        let mut blended = *block;
        for i in 0..LANES {
            let before = Under {
                color: components(&blended.color, i),
                alpha: blended.alpha[i],
                through: through[i],
            };
            let Under { color: [r, g, b], alpha, through: behind } =
                before.under(alpha[i], components(&color, i));
            (blended.color[0][i], blended.color[1][i], blended.color[2][i]) = (r, g, b);
            (blended.alpha[i], through[i]) = (alpha, behind);
        }
        blended.layers =
            each(|i| blended.layers[i] + if nearest_id[i] == NO_ID { 0.0 } else { 1.0 });
        *block = blended;
    }
);
