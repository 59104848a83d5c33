//! Lay out a level in memory: rows of numbers, one number of all cells of a row after the other.

use crate::number::lanes::LANES;

/// Cells before the first and after the last of a row that are always empty.
pub(crate) const PAD: usize = LANES;

/// The layout of a level in memory: rows of `attributes` times `stride` numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RowLayout {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) attributes: usize,
    pub(crate) stride: usize,
}

impl RowLayout {
    pub(crate) fn new([width, height]: [u32; 2], attributes: usize) -> Self {
        let (width, height) = (width as usize, height as usize);
        // The stride fits blocks of LANES coarser cells, which are two blocks of finer cells.
        let stride = PAD + width.next_multiple_of(2 * LANES) + PAD;
        Self { width, height, attributes, stride }
    }

    /// Numbers in a row of cells.
    pub(crate) fn row(&self) -> usize {
        self.attributes * self.stride
    }

    /// The index in a row of a number of cell x.
    #[inline(always)]
    pub(crate) fn at(&self, attribute: usize, x: usize) -> usize {
        attribute * self.stride + PAD + x
    }
}
