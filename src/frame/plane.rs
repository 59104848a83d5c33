//! A rectangle of pixels of one type.

use super::Rect;
use std::slice::ChunksMut;

/// `width` x `height` values, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane<T> {
    width: u32,
    height: u32,
    values: Vec<T>,
}

impl<T> Plane<T> {
    /// A plane filled with one value.
    #[must_use]
    pub fn filled(width: u32, height: u32, value: T) -> Self
    where
        T: Clone,
    {
        Self { width, height, values: vec![value; width as usize * height as usize] }
    }

    /// A plane with these values, row by row.
    ///
    /// # Panics
    /// If there are not `width * height` values.
    #[must_use]
    pub fn from_values(width: u32, height: u32, values: Vec<T>) -> Self {
        assert_eq!(values.len(), width as usize * height as usize, "values of a plane");
        Self { width, height, values }
    }

    /// Computes a value for each pixel from its column and row.
    pub(crate) fn from_pixels([width, height]: [u32; 2], value: impl Fn(u32, u32) -> T) -> Self {
        Self::of_window(Rect::of_size([width, height]), value)
    }

    /// As [`Plane::from_pixels`], for the pixels of a part of a picture, counted in the picture.
    pub(crate) fn of_window(window: Rect, value: impl Fn(u32, u32) -> T) -> Self {
        let [width, height] = window.size();
        let columns = window.x0..window.x1;
        let pixels = (window.y0..window.y1).flat_map(|y| columns.clone().map(move |x| (x, y)));
        Self::from_values(width, height, pixels.map(|(x, y)| value(x, y)).collect())
    }

    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All values, row by row.
    #[must_use]
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// All values, row by row, without a copy.
    #[must_use]
    pub fn into_values(self) -> Vec<T> {
        self.values
    }

    /// All values, row by row.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// The rows of pixels, from the top, writable.
    pub fn rows_mut(&mut self) -> ChunksMut<'_, T> {
        let width = self.width.max(1) as usize;
        self.values.chunks_mut(width)
    }

    /// The value at column `x`, row `y`.
    ///
    /// # Panics
    /// If the pixel lies outside.
    #[inline]
    #[must_use]
    pub fn at(&self, x: u32, y: u32) -> &T {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) outside the plane");
        &self.values[y as usize * self.width as usize + x as usize]
    }

    /// The values with their rows in reverse order.
    pub(crate) fn flipped(&self) -> Self
    where
        T: Copy,
    {
        Self::from_pixels([self.width, self.height], |x, y| *self.at(x, self.height - 1 - y))
    }

    /// A plane of the same size, each value computed from the value here.
    #[must_use]
    pub fn map<U>(&self, f: impl Fn(&T) -> U) -> Plane<U> {
        let values = self.values.iter().map(f).collect();
        Plane { width: self.width, height: self.height, values }
    }
}
