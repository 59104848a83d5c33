//! A level in rows of numbers.

use crate::frame::NO_ID;
use crate::method::projection::fast::LANES;
use crate::number::Vector3;
use crate::splat::Ellipse;

/// The numbers of a centre, by their place in a row: place in the picture, two numbers.
pub(super) const PLACE: usize = 0;
/// The ellipse's tilt, two numbers.
pub(super) const TILT: usize = 2;
/// The ellipse's square; NaN, of which no form is within, if no centre stays here.
pub(super) const SQUARE: usize = 4;
pub(super) const DEPTH: usize = 5;
pub(super) const RADIUS: usize = 6;
pub(super) const EXTENT: usize = 7;
/// The normal, three numbers. After it the colour, three, if the scene has colours.
pub(super) const NORMAL: usize = 8;
/// The first number that not every scene has.
pub(super) const COLOR: usize = 11;

/// Cells before the first and after the last of a row that are always empty.
pub(super) const PAD: usize = LANES;

/// The shape of a level's memory: rows of `attributes` times `stride` numbers, cell x of a number
/// at [`PAD`] + x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) attributes: usize,
    pub(super) stride: usize,
}

impl Shape {
    pub(super) fn new([width, height]: [u32; 2], color: bool) -> Self {
        let (width, height) = (width as usize, height as usize);
        let attributes = if color { COLOR + 3 } else { COLOR };
        let stride = PAD + width.next_multiple_of(2 * LANES) + PAD;
        Self { width, height, attributes, stride }
    }
}

/// A row of a level, to be written.
#[derive(Debug)]
pub(super) struct RowMut<'a> {
    pub(super) numbers: &'a mut [f32],
    /// Of each cell, [`PAD`] cells first; [`NO_ID`] where there is no centre.
    pub(super) ids: &'a mut [u32],
    /// Whether a centre stays in the row, and whether one moves on.
    pub(super) has: &'a mut [bool; 2],
}

/// A row of a level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row<'a> {
    pub(super) numbers: &'a [f32],
    pub(super) ids: &'a [u32],
    pub(super) has: [bool; 2],
}

/// A level.
#[derive(Debug)]
pub(super) struct Level {
    pub(super) shape: Shape,
    numbers: Vec<f32>,
    ids: Vec<u32>,
    has: Vec<[bool; 2]>,
}

impl Level {
    /// An empty level.
    pub(super) fn new(shape: Shape) -> Self {
        let Shape { height, attributes, stride, .. } = shape;
        Self {
            shape,
            numbers: vec![f32::NAN; height * attributes * stride],
            ids: vec![NO_ID; height * stride],
            has: vec![[false; 2]; height],
        }
    }

    /// A row of cells.
    #[inline(always)]
    pub(super) fn row(&self, y: usize) -> Row<'_> {
        let Shape { attributes, stride, .. } = self.shape;
        let row = attributes * stride;
        Row {
            numbers: &self.numbers[y * row..(y + 1) * row],
            ids: &self.ids[y * stride..(y + 1) * stride],
            has: self.has[y],
        }
    }

    /// Whether a centre stays at the level.
    pub(super) fn is_searched(&self) -> bool {
        self.has.iter().any(|[stays, _]| *stays)
    }

    /// All rows, to be written.
    pub(super) fn rows_mut(&mut self) -> impl Iterator<Item = RowMut<'_>> {
        let Shape { attributes, stride, .. } = self.shape;
        let numbers = self.numbers.chunks_mut(attributes * stride);
        let rows = numbers.zip(self.ids.chunks_mut(stride)).zip(&mut self.has);
        rows.map(|((numbers, ids), has)| RowMut { numbers, ids, has })
    }
}

impl RowMut<'_> {
    /// Finds the ellipses of [`LANES`] cells from x on, of which ids, extents and normals are
    /// there, and notes which of them stay within `reach`.
    #[inline(always)]
    pub(super) fn settle(&mut self, shape: &Shape, x: usize, reach: f32) {
        let at = |attribute: usize| attribute * shape.stride + PAD + x;
        let lanes = |attribute: usize| {
            let mut lanes = [0.0; LANES];
            lanes.copy_from_slice(&self.numbers[at(attribute)..at(attribute) + LANES]);
            lanes
        };
        let (extent, n) = (lanes(EXTENT), [0, 1, 2].map(|axis| lanes(NORMAL + axis)));
        let mut ids = [0; LANES];
        ids.copy_from_slice(&self.ids[PAD + x..PAD + x + LANES]);
        let (mut tilt, mut square) = ([[0.0; LANES]; 2], [0.0; LANES]);
        let mut has = [0_u32; 2];
        for i in 0..LANES {
            let ellipse = Ellipse::new(Vector3::new(n[0][i], n[1][i], n[2][i]), extent[i]);
            let (valid, near) = (ids[i] != NO_ID, extent[i] <= reach);
            (tilt[0][i], tilt[1][i]) = (ellipse.tilt.x, ellipse.tilt.y);
            square[i] = if valid & near { ellipse.square } else { f32::NAN };
            has[0] |= u32::from(valid & near);
            has[1] |= u32::from(valid & !near);
        }
        for (k, lanes) in [(TILT, &tilt[0]), (TILT + 1, &tilt[1]), (SQUARE, &square)] {
            self.numbers[at(k)..at(k) + LANES].copy_from_slice(lanes);
        }
        self.has[0] |= has[0] != 0;
        self.has[1] |= has[1] != 0;
    }

    /// Marks [`LANES`] cells from x on as empty.
    #[inline(always)]
    pub(super) fn clear(&mut self, shape: &Shape, x: usize) {
        let at = SQUARE * shape.stride + PAD + x;
        self.numbers[at..at + LANES].fill(f32::NAN);
        self.ids[PAD + x..PAD + x + LANES].fill(NO_ID);
    }
}
