//! Pictures between their passes: a record a pixel, tile by tile, and somebody's planes coming in.

use super::algorithm::Job;
use crate::error::{Error, Result};
use crate::frame::{Frame, Grid, NO_ID, Plane, Rect, Samples};
use crate::method::stage::{Holds, PlaneRow};
use crate::number::Exact;

/// A record for each pixel of a picture; the pixels of a tile are together, row by row.
#[derive(Clone, Debug)]
pub(super) struct Tiled<T> {
    grid: Grid,
    tiles: Vec<Vec<T>>,
}

impl<T: Send> Tiled<T> {
    /// Runs a pass over every tile: its number and its pixels.
    pub(super) fn new(job: &Job<'_>, pass: impl Fn(usize, Rect) -> Vec<T> + Sync + Send) -> Self {
        let grid = job.exec.grid(job.camera.width, job.camera.height);
        let tiles =
            job.exec.ordered(grid.rects().into_iter().enumerate().collect(), |(tile, rect)| {
                pass(tile, rect)
            });
        Self { grid, tiles }
    }
}

impl<T> Tiled<T> {
    /// The tiles of a picture that passes have made.
    pub(super) fn from_tiles(grid: Grid, tiles: Vec<Vec<T>>) -> Self {
        Self { grid, tiles }
    }

    /// The images of all groups, or layers, from those of each tile: `tiles[tile][image][pixel]`.
    pub(super) fn images(grid: Grid, tiles: Vec<Vec<Vec<T>>>) -> Vec<Self> {
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
    pub(super) fn tile(&self, tile: usize) -> &[T] {
        &self.tiles[tile]
    }

    /// The record of a pixel.
    pub(super) fn at(&self, x: u32, y: u32) -> &T {
        let (tile, pixel) = self.grid.place(x, y);
        &self.tiles[tile][pixel]
    }

    /// A record made of each record.
    pub(super) fn map<U>(&self, of: impl Fn(&T) -> U) -> Tiled<U> {
        let tiles = self.tiles.iter().map(|pixels| pixels.iter().map(&of).collect());
        Tiled { grid: self.grid, tiles: tiles.collect() }
    }

    /// A record made of each two of a pixel.
    pub(super) fn with<U, V>(&self, other: &Tiled<U>, of: impl Fn(&T, &U) -> V) -> Tiled<V> {
        let tiles = self.tiles.iter().zip(&other.tiles);
        let both = tiles.map(|(a, b)| a.iter().zip(b).map(|(a, b)| of(a, b)).collect());
        Tiled { grid: self.grid, tiles: both.collect() }
    }

    /// One value of each record.
    pub(super) fn plane<V>(&self, value: impl Fn(&T) -> V) -> Plane<V> {
        let [width, height] = self.grid.size();
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Plane::from_values(width, height, pixels.map(|(x, y)| value(self.at(x, y))).collect())
    }
}

/// The pixels of a tile as column and row in the picture, row by row.
pub(super) fn pixels(rect: Rect) -> impl Iterator<Item = (u32, u32)> {
    (rect.y0..rect.y1).flat_map(move |y| (rect.x0..rect.x1).map(move |x| (x, y)))
}

/// Somebody's planes, for a stage that reads them.
#[derive(Clone, Copy)]
pub(super) struct Given<'a, R> {
    frame: &'a Frame<R>,
    job: &'a Job<'a>,
}

impl<'a, R: Exact> Given<'a, R> {
    /// The planes of a frame, of which each that is read must have the size of the job's picture.
    pub(super) fn new(frame: &'a Frame<R>, job: &'a Job<'a>) -> Self {
        Self { frame, job }
    }

    /// Whether there is a plane of a row; `number` stands for the row's `#`.
    pub(super) fn has(&self, row: &PlaneRow, number: usize) -> bool {
        self.frame.plane(&row.numbered(number)).is_some()
    }

    /// One number a pixel.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the plane is missing, or of another type or size.
    pub(super) fn scalar(&self, row: &PlaneRow, number: usize) -> Result<&'a Plane<R>> {
        match self.samples(row, number)? {
            Samples::Scalar(plane) => self.sized(row, number, plane),
            _ => Err(self.of_another_type(row, number)),
        }
    }

    /// Colours or vectors, as the row says.
    ///
    /// # Errors
    /// As [`Given::scalar`].
    pub(super) fn triple(&self, row: &PlaneRow, number: usize) -> Result<&'a Plane<[R; 3]>> {
        match (row.holds, self.samples(row, number)?) {
            (Holds::Color, Samples::Color(plane)) | (Holds::Vector, Samples::Vector(plane)) => {
                self.sized(row, number, plane)
            }
            _ => Err(self.of_another_type(row, number)),
        }
    }

    /// Small counts.
    ///
    /// # Errors
    /// As [`Given::scalar`].
    pub(super) fn count(&self, row: &PlaneRow, number: usize) -> Result<&'a Plane<u8>> {
        match self.samples(row, number)? {
            Samples::Count(plane) => self.sized(row, number, plane),
            _ => Err(self.of_another_type(row, number)),
        }
    }

    /// The indices of surfels of the scene.
    ///
    /// # Errors
    /// As [`Given::scalar`], and if the scene has no surfel of an index.
    pub(super) fn surfels(&self, row: &PlaneRow, number: usize) -> Result<&'a Plane<u32>> {
        let Samples::Index(plane) = self.samples(row, number)? else {
            return Err(self.of_another_type(row, number));
        };
        let count = self.job.scene.surfels.len();
        let known = |id: &&u32| **id != NO_ID && **id as usize >= count;
        if let Some(id) = plane.values().iter().find(known) {
            let name = row.numbered(number);
            let what = format!("the plane `{name}`: there is no surfel {id}, but {count} of them");
            return Err(Error::Invalid(what));
        }
        self.sized(row, number, plane)
    }

    /// A record for each pixel, made of the values of planes there.
    pub(super) fn tiled<T: Send>(&self, record: impl Fn(u32, u32) -> T + Sync + Send) -> Tiled<T> {
        Tiled::new(self.job, |_, rect| pixels(rect).map(|(x, y)| record(x, y)).collect())
    }

    fn samples(&self, row: &PlaneRow, number: usize) -> Result<&'a Samples<R>> {
        let name = row.numbered(number);
        let missing = || Error::Invalid(format!("the plane `{name}` is missing"));
        self.frame.plane(&name).ok_or_else(missing)
    }

    fn sized<T>(&self, row: &PlaneRow, number: usize, plane: &'a Plane<T>) -> Result<&'a Plane<T>> {
        let (found, camera) = ([plane.width(), plane.height()], self.job.camera);
        if found == [camera.width, camera.height] {
            return Ok(plane);
        }
        Err(Error::Invalid(format!(
            "the plane `{}` is {} x {}, the picture {} x {}",
            row.numbered(number),
            found[0],
            found[1],
            camera.width,
            camera.height
        )))
    }

    fn of_another_type(&self, row: &PlaneRow, number: usize) -> Error {
        let (name, holds) = (row.numbered(number), row.holds.words());
        Error::Invalid(format!("the plane `{name}` is of another type; give {holds}"))
    }
}
