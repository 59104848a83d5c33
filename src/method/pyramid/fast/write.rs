//! Write level 0 into the planes of the picture, in lanes.

use super::super::gbuffer::GBuffer;
use super::level::{FRONT, FURTHER, KIND, NORMAL};
use crate::frame::Plane;
use crate::method::clock::{Work, spend};
use crate::method::projection::fast::RowLayout;
use crate::method::projection::world;
use crate::number::MapInline;
use crate::number::lanes::{LANES, any_above_0, load, store_first, vector, vectorized};
use crate::splat::View;

/// A row of the picture, to be written.
#[derive(Debug)]
pub(super) struct GBufferRow<'a> {
    pub(super) kind: &'a mut [u8],
    pub(super) depth: &'a mut [f32],
    pub(super) alpha: &'a mut [f32],
    pub(super) normal: Option<&'a mut [[f32; 3]]>,
    pub(super) tangent: Option<&'a mut [[f32; 3]]>,
    pub(super) color: Option<&'a mut [[f32; 3]]>,
}

/// The rows of a picture.
pub(super) fn rows(target: &mut GBuffer<f32>) -> impl Iterator<Item = GBufferRow<'_>> {
    let (kinds, depths) = (target.kind.rows_mut(), target.depth.rows_mut());
    let mut normal = target.normal.as_mut().map(Plane::rows_mut);
    let mut tangent = target.tangent.as_mut().map(Plane::rows_mut);
    let mut color = target.colored.then(|| target.color.rows_mut());
    kinds.zip(depths).zip(target.alpha.rows_mut()).map(move |((kind, depth), alpha)| GBufferRow {
        kind,
        depth,
        alpha,
        normal: normal.as_mut().and_then(Iterator::next),
        tangent: tangent.as_mut().and_then(Iterator::next),
        color: color.as_mut().and_then(Iterator::next),
    })
}

impl GBufferRow<'_> {
    /// Overwrites the row of the picture with a row of level 0.
    pub(super) fn write(self, cells: &[f32], layout: &RowLayout, view: &View<f32>) {
        spend(Work::Store);
        let tangent = layout.attributes - 3;
        write(cells, layout, self.kind, self.depth, self.alpha);
        if let Some(normals) = self.normal {
            vectors(cells, layout, NORMAL, Some(view), normals);
        }
        if let Some(tangents) = self.tangent {
            vectors(cells, layout, tangent, Some(view), tangents);
        }
        if let Some(colors) = self.color {
            vectors(cells, layout, FURTHER, None, colors);
        }
    }
}

vectorized!(
    fn write(
        cells: &[f32],
        layout: &RowLayout,
        kinds: &mut [u8],
        depths: &mut [f32],
        alphas: &mut [f32],
    ) {
        let number = |attribute: usize| &cells[layout.at(attribute, 0)..][..layout.width];
        let found = number(KIND).iter().zip(number(FRONT));
        let pixels = kinds.iter_mut().zip(depths).zip(alphas);
        for ((found, front), ((kind, depth), alpha)) in found.zip(pixels) {
            // Kinds are integers from 0 to 4.
            *kind = *found as u8;
            *depth = if *found > 0.0 { *front } else { f32::INFINITY };
            *alpha = if *found > 0.0 { 1.0 } else { 0.0 };
        }
    }
);

vectorized!(
    /// Writes vectors, turned to world space with a view, or colours; 0 where a cell is empty.
    fn vectors(
        cells: &[f32],
        layout: &RowLayout,
        attribute: usize,
        view: Option<&View<f32>>,
        pixels: &mut [[f32; 3]],
    ) {
        for (x, pixels) in (0..).step_by(LANES).zip(pixels.chunks_mut(LANES)) {
            let number = |attribute: usize| load(cells, layout.at(attribute, x));
            let kind = number(KIND);
            let mut vectors = [[0.0; 3]; LANES];
            if any_above_0(&kind) {
                let v = [0, 1, 2].map_inline(|axis| number(attribute + axis));
                for i in 0..LANES {
                    let own = vector(&v, i);
                    let turned = match view {
                        Some(view) => world(view, own),
                        None => [own.x, own.y, own.z],
                    };
                    vectors[i] = if kind[i] > 0.0 { turned } else { [0.0; 3] };
                }
            }
            store_first(pixels, &vectors);
        }
    }
);
