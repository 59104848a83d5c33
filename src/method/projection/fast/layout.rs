//! How a level is held: rows of numbers, one number of all cells of a row after the other.

use crate::number::lanes::LANES;

/// Cells before the first and after the last of a row that are always empty.
pub(in crate::method) const PAD: usize = LANES;

/// The layout of a level in memory: rows of `attributes` times `stride` numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::method) struct RowLayout {
    pub(in crate::method) width: usize,
    pub(in crate::method) height: usize,
    pub(in crate::method) attributes: usize,
    pub(in crate::method) stride: usize,
}

impl RowLayout {
    pub(in crate::method) fn new([width, height]: [u32; 2], attributes: usize) -> Self {
        let (width, height) = (width as usize, height as usize);
        // Blocks of LANES coarser cells, which are two blocks of finer ones.
        let stride = PAD + width.next_multiple_of(2 * LANES) + PAD;
        Self { width, height, attributes, stride }
    }

    /// Numbers in a row of cells.
    pub(in crate::method) fn row(&self) -> usize {
        self.attributes * self.stride
    }

    /// Where in a row a number of cell x is.
    #[inline(always)]
    pub(in crate::method) fn at(&self, attribute: usize, x: usize) -> usize {
        attribute * self.stride + PAD + x
    }
}
