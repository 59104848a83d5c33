//! Level 0 as a picture wants it, in lanes.

use super::super::gbuffer::GBuffer;
use super::level::{FRONT, FURTHER, KIND, NORMAL, Shape, lanes};
use crate::frame::Plane;
use crate::method::projection::fast::{LANES, any_above_0, put};
use crate::method::projection::world;
use crate::number::Vector3;
use crate::splat::View;
use multiversion::multiversion;

/// A row of the picture.
#[derive(Debug)]
pub(super) struct Output<'a> {
    pub(super) kind: &'a mut [u8],
    pub(super) depth: &'a mut [f32],
    pub(super) alpha: &'a mut [f32],
    pub(super) normal: Option<&'a mut [[f32; 3]]>,
    pub(super) tangent: Option<&'a mut [[f32; 3]]>,
    pub(super) color: Option<&'a mut [[f32; 3]]>,
}

/// The rows of a picture.
pub(super) fn rows(surface: &mut GBuffer<f32>) -> impl Iterator<Item = Output<'_>> {
    let (kinds, depths) = (surface.kind.rows_mut(), surface.depth.rows_mut());
    let mut normal = surface.normal.as_mut().map(Plane::rows_mut);
    let mut tangent = surface.tangent.as_mut().map(Plane::rows_mut);
    let mut color = surface.colored.then(|| surface.color.rows_mut());
    kinds.zip(depths).zip(surface.alpha.rows_mut()).map(move |((kind, depth), alpha)| Output {
        kind,
        depth,
        alpha,
        normal: normal.as_mut().and_then(Iterator::next),
        tangent: tangent.as_mut().and_then(Iterator::next),
        color: color.as_mut().and_then(Iterator::next),
    })
}

impl Output<'_> {
    /// Overwrites the row of the picture with a row of level 0.
    pub(super) fn write(self, row: &[f32], shape: &Shape, view: &View<f32>) {
        let tangent = shape.attributes - 3;
        write(row, shape, (self.kind, self.depth, self.alpha));
        if let Some(normals) = self.normal {
            vectors(row, shape, NORMAL, Some(view), normals);
        }
        if let Some(tangents) = self.tangent {
            vectors(row, shape, tangent, Some(view), tangents);
        }
        if let Some(colors) = self.color {
            vectors(row, shape, FURTHER, None, colors);
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn write(row: &[f32], shape: &Shape, (kinds, depths, alphas): (&mut [u8], &mut [f32], &mut [f32])) {
    let number = |attribute: usize| &row[shape.at(attribute, 0)..][..shape.width];
    let found = number(KIND).iter().zip(number(FRONT));
    let pixels = kinds.iter_mut().zip(depths).zip(alphas);
    for ((found, front), ((kind, depth), alpha)) in found.zip(pixels) {
        // Kinds are integers from 0 to 4.
        *kind = *found as u8;
        *depth = if *found > 0.0 { *front } else { f32::INFINITY };
        *alpha = if *found > 0.0 { 1.0 } else { 0.0 };
    }
}

/// Vectors, turned to world space with a view, or colours; 0 where a cell is empty.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn vectors(
    row: &[f32],
    shape: &Shape,
    attribute: usize,
    view: Option<&View<f32>>,
    output: &mut [[f32; 3]],
) {
    for (x, output) in (0..).step_by(LANES).zip(output.chunks_mut(LANES)) {
        let number = |attribute: usize| lanes(row, shape.at(attribute, x));
        let kind = number(KIND);
        let mut block = [[0.0; 3]; LANES];
        if any_above_0(&kind) {
            let v = [0, 1, 2].map(|axis| number(attribute + axis));
            for i in 0..LANES {
                let own = Vector3::new(v[0][i], v[1][i], v[2][i]);
                let turned = match view {
                    Some(view) => world(view, own),
                    None => [own.x, own.y, own.z],
                };
                block[i] = if kind[i] > 0.0 { turned } else { [0.0; 3] };
            }
        }
        put(output, &block);
    }
}
