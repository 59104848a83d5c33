//! Hold a picture between its passes: a record a pixel, tile by tile.

use super::algorithm::Job;
use super::clock::{Work, spend};
use super::record::{self, Field};
use super::stage::Conditions;
use crate::frame::{Grid, NamedPlane, Plane, Rect};
use crate::number::Real;

/// A record for each pixel of a picture. The pixels of a tile lie together, row by row.
#[derive(Clone, Debug)]
pub(crate) struct Tiled<T> {
    grid: Grid,
    tiles: Vec<Vec<T>>,
}

impl<T: Send> Tiled<T> {
    /// Runs a pass over every tile. The pass gets the number and the pixels of the tile.
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
    /// Holds tiles that passes have already made.
    pub(crate) fn from_tiles(grid: Grid, tiles: Vec<Vec<T>>) -> Self {
        Self { grid, tiles }
    }

    /// Turns the images of each tile, `tiles[tile][image][pixel]`, into one picture for each group
    /// or layer.
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

    /// The record of a pixel, mutable.
    pub(crate) fn at_mut(&mut self, x: u32, y: u32) -> &mut T {
        let (tile, pixel) = self.grid.place(x, y);
        &mut self.tiles[tile][pixel]
    }

    /// All records, tile by tile.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &T> {
        self.tiles.iter().flatten()
    }

    /// Makes a new record from each record.
    pub(crate) fn map<U>(&self, of: impl Fn(&T) -> U) -> Tiled<U> {
        let tiles = self.tiles.iter().map(|pixels| pixels.iter().map(&of).collect());
        Tiled { grid: self.grid, tiles: tiles.collect() }
    }

    /// Makes a new record from the two records of each pixel.
    pub(crate) fn with<U, V>(&self, other: &Tiled<U>, of: impl Fn(&T, &U) -> V) -> Tiled<V> {
        let tiles = self.tiles.iter().zip(&other.tiles);
        let both = tiles.map(|(a, b)| a.iter().zip(b).map(|(a, b)| of(a, b)).collect());
        Tiled { grid: self.grid, tiles: both.collect() }
    }

    /// Makes planes from the records, for the rows that are there. `number` stands for the rows'
    /// `#`.
    pub(crate) fn planes<R: Real>(
        &self,
        fields: &[Field<T, R>],
        number: usize,
        there: &Conditions,
    ) -> Vec<NamedPlane<R>>
    where
        T: Copy,
    {
        record::planes(fields, number, self.grid.window(), &|x, y| *self.at(x, y), there)
    }

    /// Makes a plane from one value of each record.
    pub(crate) fn plane<V>(&self, value: impl Fn(&T) -> V) -> Plane<V> {
        spend(Work::Store);
        Plane::of_window(self.grid.window(), |x, y| value(self.at(x, y)))
    }
}

/// The pixels of a tile as columns and rows of the picture, row by row.
pub(crate) fn pixels(rect: Rect) -> impl Iterator<Item = (u32, u32)> {
    (rect.y0..rect.y1).flat_map(move |y| (rect.x0..rect.x1).map(move |x| (x, y)))
}
