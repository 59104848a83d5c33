//! Draw the discs of a tile.

use crate::composite::decide;
use crate::frame::{FramebufferTile, NO_ID, Rect, TileMut};
use crate::method::blue::discs::{DiscFragment, column, row};
use crate::method::blue::squares::{Square, Squares};
use crate::method::clock::{Work, spend};
use crate::method::fast::store::clear;
use crate::method::fragment::facing;
use crate::number::lanes::{LANES, Lanes, each, mask, select, select_u32, vectorized};
use crate::scene::Scene;
use crate::splat::View;

/// Side of a window in pixels.
const SIDE: usize = 4;
const _: () = assert!(SIDE * SIDE == LANES, "a lane is a pixel of a window");

/// The memory of one tile, used for many tiles.
#[derive(Default)]
pub(super) struct TileOfDiscs {
    rect: Rect,
    squares: Vec<Square<f32>>,
    /// Depth of each pixel, and the place of its disc in the list. Rows and columns are longer than
    /// the tile's, because a window may begin at any pixel.
    depth: Vec<f32>,
    disc: Vec<u32>,
    /// a of each column and b of each row.
    a: Vec<f32>,
    b: Vec<f32>,
}

impl TileOfDiscs {
    /// Starts a tile of these pixels, with the squares that touch it.
    pub(super) fn gather(&mut self, squares: &Squares<f32>, tile: usize, rect: Rect) {
        spend(Work::Gather);
        self.rect = rect;
        self.squares.clear();
        squares.for_each(tile, |square| {
            if !square.bounds.intersection(&rect).is_empty() {
                self.squares.push(*square);
            }
        });
    }

    /// The length of a row.
    fn stride(&self) -> usize {
        self.rect.columns() + SIDE - 1
    }

    /// Draws the squares.
    pub(super) fn draw(&mut self, view: &View<f32>) {
        if self.squares.is_empty() {
            return;
        }
        spend(Work::Discs);
        let Rect { x0, y0, .. } = self.rect;
        let (columns, rows) = (self.stride(), self.rect.rows() + SIDE - 1);
        self.a.clear();
        self.a.extend((x0..x0 + columns as u32).map(|x| column(view, x)));
        self.b.clear();
        self.b.extend((y0..y0 + rows as u32).map(|y| row(view, y)));
        self.depth.clear();
        self.depth.resize(columns * rows, f32::INFINITY);
        self.disc.clear();
        self.disc.resize(columns * rows, NO_ID);
        if view.perspective {
            draw::<true>(self, view.near);
        } else {
            draw::<false>(self, view.near);
        }
    }

    /// Writes the surface of each pixel.
    pub(super) fn store(&self, scene: &Scene, pixels: &mut FramebufferTile<'_, f32>) {
        spend(Work::Store);
        let rect = &self.rect;
        if self.squares.is_empty() {
            return clear(pixels);
        }
        let (columns, stride) = (rect.columns(), self.stride());
        for (own, row) in self.depth.chunks(stride).zip(pixels.depth.rows()) {
            row.copy_from_slice(&own[..columns]);
        }
        self.fill(&mut pixels.id, NO_ID, |square| square.surfel);
        self.fill(&mut pixels.weight, 0.0, |_| 1.0);
        if let Some(normal) = &mut pixels.normal {
            let own = scene.surfels.normal();
            self.fill(normal, [0.0; 3], |square| {
                positive(facing(own[square.surfel as usize].to_array(), square.back))
            });
        }
        if let Some(color) = &mut pixels.color {
            let own = scene.surfels.color();
            self.fill(color, [0.0; 3], |square| {
                let color = own.map_or(scene.material.color, |own| own[square.surfel as usize]);
                positive(color.to_array())
            });
        }
    }

    /// Fills the rows of a plane: with `of` the pixel's disc, or with `none`.
    #[inline(always)]
    fn fill<T: Copy>(&self, plane: &mut TileMut<'_, T>, none: T, of: impl Fn(&Square<f32>) -> T) {
        for (discs, row) in self.disc.chunks(self.stride()).zip(plane.rows()) {
            for (pixel, &disc) in row.iter_mut().zip(discs) {
                *pixel = if disc == NO_ID { none } else { of(&self.squares[disc as usize]) };
            }
        }
    }
}

/// The vector with +0 in the place of -0.
#[inline(always)]
fn positive([x, y, z]: [f32; 3]) -> [f32; 3] {
    [x + 0.0, y + 0.0, z + 0.0]
}

/// a and b of the pixels of the window that begins here.
#[inline(always)]
fn rays(a: &[f32], b: &[f32], [x, y]: [usize; 2]) -> (Lanes, Lanes) {
    let row: [f32; SIDE] = a[x..x + SIDE].as_chunks().0[0];
    let column: [f32; SIDE] = b[y..y + SIDE].as_chunks().0[0];
    let (mut a, mut b) = ([0.0; LANES], [0.0; LANES]);
    let rows = a.as_chunks_mut::<SIDE>().0.iter_mut().zip(b.as_chunks_mut::<SIDE>().0);
    for ((a, b), own) in rows.zip(column) {
        (*a, *b) = (row, [own; SIDE]);
    }
    (a, b)
}

/// The window of a plane whose first pixel is `first`.
#[inline(always)]
fn window<T: Copy + Default>(plane: &[T], first: usize, stride: usize) -> [T; LANES] {
    let mut lanes = [T::default(); LANES];
    for (k, row) in lanes.as_chunks_mut::<SIDE>().0.iter_mut().enumerate() {
        let at = first + k * stride;
        *row = plane[at..at + SIDE].as_chunks().0[0];
    }
    lanes
}

/// Overwrites what [`window`] reads.
#[inline(always)]
fn put_window<T: Copy>(plane: &mut [T], first: usize, stride: usize, lanes: &[T; LANES]) {
    for (k, row) in lanes.as_chunks::<SIDE>().0.iter().enumerate() {
        let at = first + k * stride;
        plane[at..at + SIDE].as_chunks_mut().0[0] = *row;
    }
}

vectorized!(
    fn draw<const PERSPECTIVE: bool>(tile: &mut TileOfDiscs, near: f32) {
        let (rect, stride) = (tile.rect, tile.stride());
        let TileOfDiscs { squares, depth, disc: discs, a, b, .. } = tile;
        for (place, square) in (0..).zip(squares.iter()) {
            let inner = square.bounds.intersection(&rect);
            let disc = square.disc;
            let (x0, x1) = ((inner.x0 - rect.x0) as usize, (inner.x1 - rect.x0) as usize);
            let (y0, y1) = ((inner.y0 - rect.y0) as usize, (inner.y1 - rect.y0) as usize);
            for y in (y0..y1).step_by(SIDE) {
                for x in (x0..x1).step_by(SIDE) {
                    // -- The fragments of the window
                    let (a, b) = rays(a, b, [x, y]);
                    let (mut ts, mut offsets) = ([0.0; LANES], [0.0; LANES]);
                    for i in 0..LANES {
                        let DiscFragment { t, offset } = disc.at([a[i], b[i]], PERSPECTIVE);
                        (ts[i], offsets[i]) = (t, offset);
                    }
                    let holds = mask(|i| {
                        let inside = (i % SIDE < x1 - x) & (i / SIDE < y1 - y);
                        inside & disc.holds(&DiscFragment { t: ts[i], offset: offsets[i] }, near)
                    });
                    // -- Keep the nearest
                    let first = y * stride + x;
                    let (kept, ids) = (window(depth, first, stride), window(discs, first, stride));
                    let nearer = mask(|i| decide::before(ts[i], kept[i]));
                    let takes = each(|i| holds[i] & nearer[i]);
                    // Adding 0 turns -0 into +0.
                    let kept = select(&takes, &each(|i| ts[i] + 0.0), &kept);
                    let ids = select_u32(&takes, &[place; LANES], &ids);
                    put_window(depth, first, stride, &kept);
                    put_window(discs, first, stride, &ids);
                }
            }
        }
    }
);
