//! Pictures between their passes: a record a pixel, tile by tile.

use super::algorithm::Job;
use super::record::{self, Field};
use super::stage::Conditions;
use crate::frame::{Grid, NamedPlane, Plane, Rect};
use crate::number::Real;

/// A record for each pixel of a picture; the pixels of a tile are together, row by row.
#[derive(Clone, Debug)]
pub(crate) struct Tiled<T> {
    grid: Grid,
    tiles: Vec<Vec<T>>,
}

impl<T: Send> Tiled<T> {
    /// Runs a pass over every tile: its number and its pixels.
    pub(crate) fn new(job: &Job<'_>, pass: impl Fn(usize, Rect) -> Vec<T> + Sync + Send) -> Self {
        let grid = job.grid();
        let tiles =
            job.exec.ordered(grid.rects().into_iter().enumerate().collect(), |(tile, rect)| {
                pass(tile, rect)
            });
        Self { grid, tiles }
    }
}

impl<T> Tiled<T> {
    /// The tiles of a picture that passes have made.
    pub(crate) fn from_tiles(grid: Grid, tiles: Vec<Vec<T>>) -> Self {
        Self { grid, tiles }
    }

    /// The images of all groups, or layers, from those of each tile: `tiles[tile][image][pixel]`.
    pub(crate) fn images(grid: Grid, tiles: Vec<Vec<Vec<T>>>) -> Vec<Self> {
        let count = tiles.first().map_or(0, Vec::len);
        let mut images: Vec<_> = (0..count).map(|_| Self { grid, tiles: Vec::new() }).collect();
        for tile in tiles {
            for (image, pixels) in images.iter_mut().zip(tile) {
                image.tiles.push(pixels);
            }
        }
        images
    }

    /// The records of a tile, row by row.
    pub(crate) fn tile(&self, tile: usize) -> &[T] {
        &self.tiles[tile]
    }

    /// The record of a pixel.
    pub(crate) fn at(&self, x: u32, y: u32) -> &T {
        let (tile, pixel) = self.grid.place(x, y);
        &self.tiles[tile][pixel]
    }

    /// The record of a pixel, to be changed.
    pub(crate) fn at_mut(&mut self, x: u32, y: u32) -> &mut T {
        let (tile, pixel) = self.grid.place(x, y);
        &mut self.tiles[tile][pixel]
    }

    /// All records, tile by tile.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &T> {
        self.tiles.iter().flatten()
    }

    /// A record made of each record.
    pub(crate) fn map<U>(&self, of: impl Fn(&T) -> U) -> Tiled<U> {
        let tiles = self.tiles.iter().map(|pixels| pixels.iter().map(&of).collect());
        Tiled { grid: self.grid, tiles: tiles.collect() }
    }

    /// A record made of each two of a pixel.
    pub(crate) fn with<U, V>(&self, other: &Tiled<U>, of: impl Fn(&T, &U) -> V) -> Tiled<V> {
        let tiles = self.tiles.iter().zip(&other.tiles);
        let both = tiles.map(|(a, b)| a.iter().zip(b).map(|(a, b)| of(a, b)).collect());
        Tiled { grid: self.grid, tiles: both.collect() }
    }

    /// The planes of the records, if they are there; `number` stands for the rows' `#`.
    pub(crate) fn planes<R: Real>(
        &self,
        fields: &[Field<T, R>],
        number: usize,
        there: &Conditions,
    ) -> Vec<NamedPlane<R>>
    where
        T: Copy,
    {
        record::planes(fields, number, (self.grid.size(), &|x, y| *self.at(x, y)), there)
    }

    /// One value of each record.
    pub(crate) fn plane<V>(&self, value: impl Fn(&T) -> V) -> Plane<V> {
        Plane::from_pixels(self.grid.size(), |x, y| value(self.at(x, y)))
    }
}

/// The pixels of a tile as column and row in the picture, row by row.
pub(crate) fn pixels(rect: Rect) -> impl Iterator<Item = (u32, u32)> {
    (rect.y0..rect.y1).flat_map(move |y| (rect.x0..rect.x1).map(move |x| (x, y)))
}
