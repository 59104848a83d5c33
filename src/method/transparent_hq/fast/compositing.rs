//! Composite the nearest layer before the others: pass 3.

use super::nearest::FrontBlock;
use crate::composite::over::Blend;
use crate::method::clock::{Work, spend};
use crate::method::fast::layered::LayeredBlock;
use crate::method::fast::tile::{PixelBlock, ROW, Tile};
use crate::method::transparent::averaging::GroupAverage;
use crate::method::transparent::fast::AverageBlock;
use crate::method::transparent_hq::compositing::Through;
use crate::method::transparent_hq::nearest::{FrontLayer, MASK};
use crate::number::lanes::{LANES, components, each, vectorized};

/// A block of the nearest layer, its shaded colours, and the layers behind it.
type Behind<'a> = ((&'a PixelBlock, &'a FrontBlock), &'a AverageBlock);

/// The blocks of a tile before the environment.
pub(super) fn compositing(
    through: &Through<'_, f32>,
    tile: &Tile,
    fronts: &[FrontBlock],
    others: &[AverageBlock],
) -> Vec<LayeredBlock> {
    spend(Work::Over);
    let blocks = tile.blocks.iter().zip(fronts).zip(others).enumerate();
    let shown = |(index, ((nearest, front), others)): (usize, Behind<'_>)| {
        let mut block = over(nearest, front, others);
        if through.bends() {
            refract(through, &mut block, tile.grid.corner(index), nearest, front, others);
        }
        block
    };
    blocks.map(shown).collect()
}

vectorized!(
    /// Blends the nearest layer over the others.
    fn over(nearest: &PixelBlock, front: &FrontBlock, others: &AverageBlock) -> LayeredBlock {
        let AverageBlock { mut color, mut alpha, mut layers, .. } = *others;
        let (depth, front) = (nearest.nearest, *front);
        for i in 0..LANES {
            let before = Blend { color: components(&color, i), alpha: alpha[i] };
            let Blend { color: [r, g, b], alpha: a } =
                before.over(front.opacity[i], components(&front.color, i));
            let there = depth[i].is_finite();
            color[0][i] = if there { r } else { before.color[0] };
            color[1][i] = if there { g } else { before.color[1] };
            color[2][i] = if there { b } else { before.color[2] };
            alpha[i] = if there { a } else { before.alpha };
        }
        layers = each(|i| if depth[i].is_finite() { layers[i] + 1.0 } else { layers[i] });
        LayeredBlock { color, alpha, depth, id: nearest.id, layers }
    }
);

/// Composites a nearest layer that bends light, pixel by pixel, because almost all of the time goes
/// into the environment.
fn refract(
    through: &Through<'_, f32>,
    block: &mut LayeredBlock,
    (x, y): (u32, u32),
    nearest: &PixelBlock,
    front: &FrontBlock,
    others: &AverageBlock,
) {
    for i in (0..LANES).filter(|&i| nearest.nearest[i].is_finite()) {
        let near = FrontLayer {
            depth: nearest.nearest[i],
            id: nearest.id[i],
            weight: nearest.weight[i],
            normal: components(&nearest.normal, i),
            color: components(&front.color, i),
            opacity: front.opacity[i],
            mask: MASK.reference,
        };
        let behind = GroupAverage {
            blend: Blend { color: components(&others.color, i), alpha: others.alpha[i] },
            opacity: others.opacity[i],
            hidden: others.hidden[i],
            layers: others.layers[i],
            depth: others.depth[i],
            surfel: others.id[i],
        };
        let at = (x + (i % ROW) as u32, y + (i / ROW) as u32);
        let Blend { color: [r, g, b], alpha } = through.pixel(at, &near, &behind);
        (block.color[0][i], block.color[1][i], block.color[2][i]) = (r, g, b);
        block.alpha[i] = alpha;
    }
}
