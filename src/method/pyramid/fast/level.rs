//! A level in rows of numbers.

use crate::method::projection::{Has, SampleKind};

pub(super) use crate::method::projection::fast::{PAD, Shape, lanes};

/// The numbers of a cell, by their place in a row; [`KIND`] is the [`SampleKind`] as a number.
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

/// [`SampleKind::Tube`] as a number.
pub(super) const TUBE: f32 = SampleKind::Tube as u8 as f32;

/// The shape of a level's memory.
pub(super) fn shape(size: [u32; 2], has: Has) -> Shape {
    let further = 3 * (usize::from(has.color) + usize::from(has.tangent));
    Shape::new(size, FURTHER + further)
}

/// A level; an empty row above the first and below the last.
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
