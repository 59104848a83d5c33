//! A level in rows of numbers.

use crate::frame::NO_ID;
use crate::method::projection::fast::LANES;
pub(super) use crate::method::projection::fast::{PAD, Shape, lanes};
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

/// The shape of a level's memory.
pub(super) fn shape(size: [u32; 2], color: bool) -> Shape {
    Shape::new(size, if color { COLOR + 3 } else { COLOR })
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
        let Shape { height, stride, .. } = shape;
        Self {
            shape,
            numbers: vec![f32::NAN; height * shape.row()],
            ids: vec![NO_ID; height * stride],
            has: vec![[false; 2]; height],
        }
    }

    /// A row of cells.
    #[inline(always)]
    pub(super) fn row(&self, y: usize) -> Row<'_> {
        let (row, stride) = (self.shape.row(), self.shape.stride);
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
        let numbers = self.numbers.chunks_mut(self.shape.row());
        let rows = numbers.zip(self.ids.chunks_mut(self.shape.stride)).zip(&mut self.has);
        rows.map(|((numbers, ids), has)| RowMut { numbers, ids, has })
    }
}

impl RowMut<'_> {
    /// Finds the ellipses of [`LANES`] cells from x on, of which ids, extents and normals are
    /// there, and notes which of them stay within `reach`.
    #[inline(always)]
    pub(super) fn settle(&mut self, shape: &Shape, x: usize, reach: f32) {
        let at = |attribute: usize| shape.at(attribute, x);
        let number = |attribute: usize| lanes(self.numbers, at(attribute));
        let n = [number(NORMAL), number(NORMAL + 1), number(NORMAL + 2)];
        let extent = number(EXTENT);
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
        let at = shape.at(SQUARE, x);
        self.numbers[at..at + LANES].fill(f32::NAN);
        self.ids[PAD + x..PAD + x + LANES].fill(NO_ID);
    }
}
