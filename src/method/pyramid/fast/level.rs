//! A level in rows of numbers.

use crate::method::projection::fast::{LANES, Lanes};
use crate::method::projection::{Has, Kind};

/// The numbers of a cell, by their place in a row; [`KIND`] is the [`Kind`] as a number.
pub(super) const KIND: usize = 0;
pub(super) const FRONT: usize = 1;
pub(super) const BACK: usize = 2;
pub(super) const RADIUS: usize = 3;
/// The displacement: two numbers; not of level 0, where it is 0 until the push, and then not
/// wanted.
pub(super) const PLACE: usize = 4;
/// The normal: three numbers.
pub(super) const NORMAL: usize = 6;
/// The tilt of the ellipse: two numbers; not of level 0, of which each is needed once. After it the
/// colour, three, and the tangent, three, if the scene has them.
pub(super) const TILT: usize = 9;
/// The first number that not every scene has.
pub(super) const FURTHER: usize = 11;

/// [`Kind::Tube`] as a number.
pub(super) const TUBE: f32 = Kind::Tube as u8 as f32;

/// Cells before the first and after the last of a row that are always empty.
pub(super) const PAD: usize = LANES;

/// The shape of a level's memory: rows of `attributes` times `stride` numbers, cell x of a number
/// at [`PAD`] + x; an empty row above the first and below the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) attributes: usize,
    pub(super) stride: usize,
}

impl Shape {
    pub(super) fn new([width, height]: [u32; 2], has: Has) -> Self {
        let further = 3 * (usize::from(has.color) + usize::from(has.tangent));
        let (width, height) = (width as usize, height as usize);
        // Blocks of LANES coarser cells, which are two blocks of finer ones.
        let stride = PAD + width.next_multiple_of(2 * LANES) + PAD;
        Self { width, height, attributes: FURTHER + further, stride }
    }

    /// Numbers in a row of cells.
    pub(super) fn row(&self) -> usize {
        self.attributes * self.stride
    }
}

/// A level.
#[derive(Debug)]
pub(super) struct Level {
    pub(super) shape: Shape,
    numbers: Vec<f32>,
}

impl Level {
    /// An empty level.
    pub(super) fn new(shape: Shape) -> Self {
        Self { shape, numbers: vec![0.0; (shape.height + 2) * shape.row()] }
    }

    /// The row y of cells; -1 and the height are empty.
    #[inline(always)]
    pub(super) fn row(&self, y: isize) -> &[f32] {
        let start = (y + 1) as usize * self.shape.row();
        &self.numbers[start..start + self.shape.row()]
    }

    /// All rows of cells, to be written.
    pub(super) fn rows_mut(&mut self) -> std::slice::ChunksMut<'_, f32> {
        let row = self.shape.row();
        self.numbers[row..(self.shape.height + 1) * row].chunks_mut(row)
    }
}

/// [`LANES`] numbers of a row from an index on.
#[inline(always)]
pub(super) fn lanes(row: &[f32], at: usize) -> Lanes {
    let mut lanes = [0.0; LANES];
    lanes.copy_from_slice(&row[at..at + LANES]);
    lanes
}
