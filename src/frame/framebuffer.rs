//! The framebuffer: depth, stencil and floating accumulation.

use super::tile::TileMut;
use super::{Grid, NO_ID, Plane, Rect};
use crate::number::Real;

/// What splats are drawn into.
///
/// `depth` holds nearness (see [`crate::splat`]) while splats are drawn, as the depth buffer of a
/// GPU holds 1/t, and depth t once resolved; `color` and `normal` hold weighted sums while splats
/// are drawn, and averages once resolved. A plane that the picture does not need is not there.
#[derive(Clone, Debug)]
pub struct Framebuffer<R> {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Nearness of the nearest fragment, then its depth in world units; +inf where there is none.
    pub depth: Plane<R>,
    /// Surfel of the nearest fragment; [`NO_ID`] where there is none.
    pub id: Plane<u32>,
    /// Sum of the weights.
    pub weight: Plane<R>,
    /// Weighted sum of normals, then their direction; world space.
    pub normal: Plane<[R; 3]>,
    /// Weighted sum of colours, then their average; linear RGB.
    pub color: Option<Plane<[R; 3]>>,
    /// Fragments that were accumulated, up to 255.
    pub stencil: Option<Plane<u8>>,
    /// How close the nearest decision came to flipping, in units of the last place.
    pub margin: Option<Plane<R>>,
}

/// One tile of a [`Framebuffer`], writable.
#[derive(Debug)]
pub struct FramebufferTile<'a, R> {
    /// The pixels of the tile.
    pub rect: Rect,
    /// See [`Framebuffer::depth`].
    pub depth: TileMut<'a, R>,
    /// See [`Framebuffer::id`].
    pub id: TileMut<'a, u32>,
    /// See [`Framebuffer::weight`].
    pub weight: TileMut<'a, R>,
    /// See [`Framebuffer::normal`].
    pub normal: TileMut<'a, [R; 3]>,
    /// See [`Framebuffer::color`].
    pub color: Option<TileMut<'a, [R; 3]>>,
    /// See [`Framebuffer::stencil`].
    pub stencil: Option<TileMut<'a, u8>>,
    /// See [`Framebuffer::margin`].
    pub margin: Option<TileMut<'a, R>>,
}

impl<R: Real> Framebuffer<R> {
    /// A framebuffer cleared to `empty`, the nearness of an empty pixel.
    ///
    /// `color`: whether the scene has colours. `observed`: whether fragments are counted and margins
    /// kept.
    #[must_use]
    pub fn new(width: u32, height: u32, empty: R, color: bool, observed: bool) -> Self {
        let zero = [R::ZERO; 3];
        Self {
            width,
            height,
            depth: Plane::filled(width, height, empty),
            id: Plane::filled(width, height, NO_ID),
            weight: Plane::filled(width, height, R::ZERO),
            normal: Plane::filled(width, height, zero),
            color: color.then(|| Plane::filled(width, height, zero)),
            stencil: observed.then(|| Plane::filled(width, height, 0)),
            margin: observed.then(|| Plane::filled(width, height, R::INFINITY)),
        }
    }

    /// The tiles of every plane, row by row.
    pub fn tiles(&mut self, grid: &Grid) -> Vec<FramebufferTile<'_, R>> {
        fn optional<'a, T>(
            grid: &Grid,
            plane: &'a mut Option<Plane<T>>,
        ) -> impl Iterator<Item = Option<TileMut<'a, T>>> {
            let mut tiles = plane.as_mut().map(|plane| grid.split(plane).into_iter());
            std::iter::repeat_with(move || tiles.as_mut().and_then(Iterator::next))
        }
        let mut id = grid.split(&mut self.id).into_iter();
        let mut weight = grid.split(&mut self.weight).into_iter();
        let mut normal = grid.split(&mut self.normal).into_iter();
        let mut color = optional(grid, &mut self.color);
        let mut stencil = optional(grid, &mut self.stencil);
        let mut margin = optional(grid, &mut self.margin);
        let depth = grid.split(&mut self.depth).into_iter();
        let tiles = grid.rects().into_iter().zip(depth).filter_map(|(rect, depth)| {
            Some(FramebufferTile {
                rect,
                depth,
                id: id.next()?,
                weight: weight.next()?,
                normal: normal.next()?,
                color: color.next()?,
                stencil: stencil.next()?,
                margin: margin.next()?,
            })
        });
        tiles.collect()
    }
}
