//! Draw the discs of a tile.

use crate::composite::decide;
use crate::frame::{FramebufferTile, NO_ID, Rect, TileMut};
use crate::method::blue::discs::{DiscFragment, column, row};
use crate::method::blue::squares::{Square, Squares};
use crate::method::clock::{Work, spend};
use crate::method::fast::store::clear;
use crate::method::fragment::facing;
use crate::number::lanes::{LANES, vectorized};
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
                    let (a, b) = (&a[x..x + SIDE], &b[y..y + SIDE]);
                    let (mut ts, mut holds) = ([0.0; LANES], [0_u32; LANES]);
                    for i in 0..LANES {
                        let ray = [a[i % SIDE], b[i / SIDE]];
                        let fragment = disc.at(ray, PERSPECTIVE);
                        let DiscFragment { t, .. } = fragment;
                        let inside = (x + i % SIDE < x1) & (y + i / SIDE < y1);
                        ts[i] = t + 0.0;
                        holds[i] = u32::from(inside & disc.holds(&fragment, near)).wrapping_neg();
                    }
                    let first = y * stride + x;
                    for k in 0..SIDE {
                        let at = first + k * stride;
                        let (depth, discs) = (&mut depth[at..at + SIDE], &mut discs[at..at + SIDE]);
                        for i in 0..SIDE {
                            let t = ts[k * SIDE + i];
                            let kept = holds[k * SIDE + i]
                                & u32::from(decide::before(t, depth[i])).wrapping_neg();
                            let bits = (t.to_bits() & kept) | (depth[i].to_bits() & !kept);
                            depth[i] = f32::from_bits(bits);
                            discs[i] = (place & kept) | (discs[i] & !kept);
                        }
                    }
                }
            }
        }
    }
);
