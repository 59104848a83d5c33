//! Rectangles of pixels.

use crate::error::{Error, Result};

/// The pixels of columns `x0 .. x1` and rows `y0 .. y1`, the ends exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Rect {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl Rect {
    /// One pixel.
    pub(crate) fn pixel((x, y): (u32, u32)) -> Self {
        Self { x0: x, y0: y, x1: x + 1, y1: y + 1 }
    }

    /// All pixels of a picture of this width and height.
    #[must_use]
    pub fn of_size([x1, y1]: [u32; 2]) -> Self {
        Self { x0: 0, y0: 0, x1, y1 }
    }

    /// Width and height of a rectangle that is not reversed.
    #[inline(always)]
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.x1 - self.x0, self.y1 - self.y0]
    }

    /// Checks that a region has pixels, all of them in a picture of this width and height.
    ///
    /// # Errors
    /// [`Error::Usage`] if it has none, or others.
    pub fn check_inside(&self, [w, h]: [u32; 2]) -> Result<()> {
        let Self { x0, y0, x1, y1 } = *self;
        if self.is_empty() {
            return Err(Error::Usage(format!(
                "the region {x0},{y0},{x1},{y1} has no pixel, because the ends are excluded; give the \
                 first column and row, then one after the last"
            )));
        }
        if self.intersection(&Self::of_size([w, h])) == *self {
            return Ok(());
        }
        Err(Error::Usage(format!(
            "the region {x0},{y0},{x1},{y1} is not inside the picture of {w} x {h} pixels; give columns \
             up to {w} and rows up to {h}"
        )))
    }

    /// Whether no pixel is inside.
    #[inline(always)]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.x0 >= self.x1 || self.y0 >= self.y1
    }

    /// How many pixels are inside.
    #[must_use]
    pub fn pixels(&self) -> usize {
        if self.is_empty() {
            0
        } else {
            (self.x1 - self.x0) as usize * (self.y1 - self.y0) as usize
        }
    }

    /// The smallest rectangle that contains both.
    #[must_use]
    pub(crate) fn hull(&self, other: &Self) -> Self {
        if self.is_empty() {
            return *other;
        }
        if other.is_empty() {
            return *self;
        }
        let (x0, y0) = (self.x0.min(other.x0), self.y0.min(other.y0));
        Self { x0, y0, x1: self.x1.max(other.x1), y1: self.y1.max(other.y1) }
    }

    /// How many columns a rectangle that is not empty has.
    #[inline(always)]
    #[must_use]
    pub fn columns(&self) -> usize {
        (self.x1 - self.x0) as usize
    }

    /// How many rows a rectangle that is not empty has.
    #[inline(always)]
    #[must_use]
    pub fn rows(&self) -> usize {
        (self.y1 - self.y0) as usize
    }

    /// Whether the pixel is inside.
    #[must_use]
    pub fn contains(&self, x: u32, y: u32) -> bool {
        (self.x0..self.x1).contains(&x) && (self.y0..self.y1).contains(&y)
    }

    /// The pixels that are in both.
    #[inline(always)]
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self {
            x0: self.x0.max(other.x0),
            y0: self.y0.max(other.y0),
            x1: self.x1.min(other.x1),
            y1: self.y1.min(other.y1),
        }
    }
}
