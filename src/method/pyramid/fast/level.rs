//! Hold a level in rows of numbers.

use crate::method::projection::fast::RowLayout;
use crate::method::projection::{Has, SampleKind};

/// The numbers of a cell, by their place in a row; [`KIND`] is the [`SampleKind`] as a number.
pub(super) const KIND: usize = 0;
pub(super) const FRONT: usize = 1;
pub(super) const BACK: usize = 2;
pub(super) const RADIUS: usize = 3;
/// The displacement: two numbers. Level 0 does not store it: it is 0 there until the push, and not
/// wanted afterwards.
pub(super) const PLACE: usize = 4;
/// The normal: three numbers.
pub(super) const NORMAL: usize = 6;
/// The tilt of the ellipse: two numbers. Level 0 does not store it, because each tilt is needed
/// once there. After the tilt come the colour, three, and the tangent, three, if the scene has
/// them.
pub(super) const TILT: usize = 9;
/// The first number that not every scene has.
pub(super) const FURTHER: usize = 11;

/// The first number of the tangent, in a scene with tubes; the end, in one without.
pub(super) fn tangent(layout: &RowLayout, tubes: bool) -> usize {
    layout.attributes - if tubes { 3 } else { 0 }
}

/// [`SampleKind::Tube`] as a number.
pub(super) const TUBE: f32 = SampleKind::Tube as u8 as f32;

/// The layout of a level of this size.
pub(super) fn layout(size: [u32; 2], has: Has) -> RowLayout {
    let further = 3 * (usize::from(has.color) + usize::from(has.tangent));
    RowLayout::new(size, FURTHER + further)
}

/// A level, with an empty row above the first and below the last.
#[derive(Debug)]
pub(super) struct CellLevel {
    pub(super) layout: RowLayout,
    numbers: Vec<f32>,
}

impl CellLevel {
    /// An empty level.
    pub(super) fn new(layout: RowLayout) -> Self {
        Self { layout, numbers: vec![0.0; (layout.height + 2) * layout.row()] }
    }

    /// The row y of cells; -1 and the height are empty.
    #[inline(always)]
    pub(super) fn row(&self, y: isize) -> &[f32] {
        let start = (y + 1) as usize * self.layout.row();
        &self.numbers[start..start + self.layout.row()]
    }

    /// All rows of cells, to be written.
    pub(super) fn rows_mut(&mut self) -> std::slice::ChunksMut<'_, f32> {
        let row = self.layout.row();
        self.numbers[row..(self.layout.height + 1) * row].chunks_mut(row)
    }
}
