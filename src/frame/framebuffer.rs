//! The framebuffer: depth, stencil and floating-point accumulation.

use super::tile::TileMut;
use super::{Exec, Grid, Plane};
use crate::number::Real;

/// The id of a pixel that no surfel covers.
pub const NO_ID: u32 = u32::MAX;

/// Which planes a picture needs besides depth, id and weight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Normals: needed where there is light.
    pub normal: bool,
    /// Colours: needed where the surfels have their own.
    pub color: bool,
    /// Counts of fragments and margins of decisions.
    pub observed: bool,
}

/// The planes that splats are drawn into.
///
/// While splats are drawn, `depth` holds nearness (see [`crate::splat`]), as the depth buffer of a
/// GPU holds 1/t; once resolved, it holds depth t. `color` and `normal` hold weighted sums while
/// splats are drawn, and averages once resolved. A plane that the picture does not need is not
/// allocated.
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
    pub normal: Option<Plane<[R; 3]>>,
    /// Weighted sum of colours, then their average; linear RGB.
    pub color: Option<Plane<[R; 3]>>,
    /// How many fragments were accumulated, up to 255.
    pub stencil: Option<Plane<u8>>,
    /// How close the nearest decision came to flipping, in units of the last place.
    pub margin: Option<Plane<R>>,
}

/// One tile of the planes that a fast path writes.
#[derive(Debug)]
pub struct FramebufferTile<'a, R> {
    /// See [`Framebuffer::depth`].
    pub depth: TileMut<'a, R>,
    /// See [`Framebuffer::id`].
    pub id: TileMut<'a, u32>,
    /// See [`Framebuffer::weight`].
    pub weight: TileMut<'a, R>,
    /// See [`Framebuffer::normal`].
    pub normal: Option<TileMut<'a, [R; 3]>>,
    /// See [`Framebuffer::color`].
    pub color: Option<TileMut<'a, [R; 3]>>,
}

impl<R: Real> Framebuffer<R> {
    /// A framebuffer cleared to `empty`, the nearness of an empty pixel.
    #[must_use]
    pub fn new(width: u32, height: u32, empty: R, wanted: Wanted) -> Self {
        let zero = [R::ZERO; 3];
        Self {
            width,
            height,
            depth: Plane::filled(width, height, empty),
            id: Plane::filled(width, height, NO_ID),
            weight: Plane::filled(width, height, R::ZERO),
            normal: wanted.normal.then(|| Plane::filled(width, height, zero)),
            color: wanted.color.then(|| Plane::filled(width, height, zero)),
            stencil: wanted.observed.then(|| Plane::filled(width, height, 0)),
            margin: wanted.observed.then(|| Plane::filled(width, height, R::INFINITY)),
        }
    }

    /// Cuts the planes into tiles, row by row.
    pub fn cut(&mut self, grid: &Grid, exec: &Exec) -> Vec<FramebufferTile<'_, R>> {
        let depth = grid.cut(&mut self.depth, exec);
        let mut id = grid.cut(&mut self.id, exec).into_iter();
        let mut weight = grid.cut(&mut self.weight, exec).into_iter();
        let cut = |plane| grid.cut(plane, exec).into_iter();
        let mut normal = self.normal.as_mut().map(cut);
        let mut color = self.color.as_mut().map(cut);
        let tiles = depth.into_iter().filter_map(|depth| {
            Some(FramebufferTile {
                depth,
                id: id.next()?,
                weight: weight.next()?,
                normal: normal.as_mut().and_then(Iterator::next),
                color: color.as_mut().and_then(Iterator::next),
            })
        });
        tiles.collect()
    }
}
