//! Level 0 as a picture wants it, in lanes.

use super::level::{FRONT, FURTHER, KIND, NORMAL, PAD, Shape, lanes};
use crate::method::projection::fast::LANES;
use crate::method::projection::world;
use crate::number::Vector3;
use crate::splat::View;
use multiversion::multiversion;

/// A row of level 0 and of the picture.
#[derive(Debug)]
pub(super) struct Output<'a> {
    pub(super) row: &'a [f32],
    pub(super) kind: &'a mut [u8],
    pub(super) depth: &'a mut [f32],
    pub(super) normal: Option<&'a mut [[f32; 3]]>,
    pub(super) tangent: Option<&'a mut [[f32; 3]]>,
    pub(super) color: Option<&'a mut [[f32; 3]]>,
}

impl Output<'_> {
    /// Overwrites the row of the picture.
    pub(super) fn write(&mut self, shape: &Shape, view: &View<f32>) {
        let tangent = shape.attributes - 3;
        write(self.row, shape, self.kind, self.depth);
        if let Some(normals) = &mut self.normal {
            vectors(self.row, shape, NORMAL, Some(view), normals);
        }
        if let Some(tangents) = &mut self.tangent {
            vectors(self.row, shape, tangent, Some(view), tangents);
        }
        if let Some(colors) = &mut self.color {
            vectors(self.row, shape, FURTHER, None, colors);
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn write(row: &[f32], shape: &Shape, kinds: &mut [u8], depths: &mut [f32]) {
    for (x, (kind, depth)) in kinds.iter_mut().zip(depths).enumerate() {
        let found = row[KIND * shape.stride + PAD + x];
        // Kinds are integers from 0 to 4.
        *kind = found as u8;
        let front = row[FRONT * shape.stride + PAD + x];
        *depth = if found > 0.0 { front } else { f32::INFINITY };
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
        let number = |attribute: usize| lanes(row, attribute * shape.stride + PAD + x);
        let kind = number(KIND);
        let mut block = [[0.0; 3]; LANES];
        if kind.iter().any(|&kind| kind > 0.0) {
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
        output.copy_from_slice(&block[..output.len()]);
    }
}
