//! Textures of meshes, and their mean colours over the ellipses of surfels \[GBP04, 4.4; BJFM19,
//! 3.1\].
//!
//! ```text
//!    v = 1 ┌───┬───┬ ─ ─ ┐      texel (i, j): column i, row j from the top
//!          │0,0│1,0│            its centre: u = (i + 1/2) / W      v = 1 - (j + 1/2) / H
//!          ├───┼───┼ ─ ─ ┤      in texels: x = u W      y = (1 - v) H
//!          │0,1│1,1│            so that texel (i, j) is the square from (i, j) to (i + 1, j + 1)
//!    v = 0 └ ─ ┴ ─ ┴ ─ ─ ┘
//!        u = 0          u = 1
//! ```
//!
//! `Decided:` v grows upwards, as in OBJ files and in the programs that write PLY files with
//! textures.
//!
//! A matrix of vectors in (u, v) becomes a matrix of vectors in texels:
//!
//! ```text
//!   Mxx = Muu (W W)      Mxy = -(Muv (W H))      Myy = Mvv (H H)
//! ```
//!
//! **Pyramid.** Level 0 consists of the texels. A cell (i, j) of level l is the mean of the texels
//! in the columns from i 2^l to min((i + 1) 2^l, W) and the rows likewise. Cells at the right and
//! at the bottom are cut, so that textures of any size have exact means. A cell is computed from
//! the up to four cells of the level before, in the order of rows and columns, in f64: the sum of
//! area times colour divided by the sum of the areas, from 0, rounded to `f32` once. The last level
//! is one cell.
//!
//! **Mean.** The mean colour around (x, y) is weighted within an ellipse. The ellipse is given by
//! M, the matrix p p^T + q q^T of two conjugate half axes p and q, in texels. All in f64, each
//! operation rounded in the order written:
//!
//! ```text
//!   half  = (Mxx + Myy) / 2      diff = (Mxx - Myy) / 2      root = sqrt(diff diff + Mxy Mxy)
//!   level l: from 0, while it is not the last and ( 16 4^(l + 1) <= half - root  or  16384 4^l < half + root ): the next
//!   g     = 2^l                  V = M + g g I               det = Vxx Vyy - Vxy Vxy
//! ```
//!
//! The sums go over all cells of level l with q < 1, row by row from the top, in a row from the
//! left. d is the difference of the cell's centre, the centre of its cut square, and (x, y); a is
//! the cell's area in texels:
//!
//! ```text
//!   q      = ((Vyy / det) (dx dx) - (2 (Vxy / det)) (dx dy)) + (Vxx / det) (dy dy)
//!   w      = a ((1 - q) (1 - q))
//!   colour = (sum of colour w) / (sum of w), rounded to f32 once, plus 0
//! ```
//!
//! Where det or the sum of w is not > 0, the colour is the colour of the last level's cell. Where
//! x, y or (Mxx + Mxy) + Myy is not finite, the colour is NaN, and no surfel is made from it. A
//! texture of one colour gives that colour, bit for bit.
//!
//! **Borders.** An axis that repeats has the texture again and again: cells of the tiles 16 before
//! to 16 behind the tile of (x, y) count. On such an axis x = (u - floor u) W, y = (r - floor r) H
//! with r = 1 - v. Beside an axis that does not repeat there is nothing, which has no weight.
//!
//! # What the papers leave open, decided here
//!
//! - (1 - q)^2 is the weight of [`crate::index::mipmap`], so prefiltered colours are the same kind
//!   of mean whether they come from a texture or from neighbours. g g I makes the mean of a point
//!   smooth: at level 0 it averages the texels nearer than one texel. On a ramp the mean differs
//!   from the value of that point by up to a fifth of a texel.
//! - Where g is a quarter of the shorter half axis or less, it widens the ellipse by less than 4 %.
//!   In an ellipse more than 16 times as long as wide, a cell may be larger, down to 1/128 of the
//!   longer half axis: the mean is then blurred across the ellipse.
//! - An axis repeats only if some coordinate lies outside \[0, 1\] ([`Coordinates::repeats`]),
//!   because files do not say otherwise. An atlas must not bleed over its borders, and a wall of
//!   bricks must not end.
//! - Whatever lies beside the texture is left out, and the border is not extended, because it is
//!   not on the surface.

use super::light::MAX_RADIANCE;
use super::{Coordinates, camera::MAX_EXTENT};
use crate::error::{Error, Result};
use crate::frame::Plane;
use crate::memory;
use crate::number::MapInline;
use crate::number::Real;
use glam::{DVec2, DVec3, Vec3};
use std::fmt;
use std::sync::Arc;

/// How many repetitions to each side count.
const REPEATS: i64 = 16;

/// A picture of linear RGB with its pyramid; copies share it.
#[derive(Clone, PartialEq)]
pub struct Texture(Arc<Vec<Plane<[f32; 3]>>>);

impl fmt::Debug for Texture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size();
        write!(f, "Texture({width} x {height})")
    }
}

impl Texture {
    /// Makes a texture from these texels, and computes its pyramid.
    ///
    /// # Errors
    /// [`Error::Invalid`] as [`Texture::check_size`], if a component is not in [0,
    /// [`MAX_RADIANCE`]] (the error names the texel), or if the process may not hold the pyramid.
    pub fn new(mut texels: Plane<[f32; 3]>) -> Result<Self> {
        let (width, height) = (texels.width(), texels.height());
        Self::check_size(width, height)?;
        let bad = |v: &f32| !(0.0..=MAX_RADIANCE).contains(v);
        if let Some(i) = texels.values().iter().position(|texel| texel.iter().any(bad)) {
            let [r, g, b] = texels.values()[i];
            let (x, y) = (i % width as usize, i / width as usize);
            return Err(Error::Invalid(format!(
                "texel ({x}, {y}) is [{r}, {g}, {b}]; clamp the texture to [0, {MAX_RADIANCE}]"
            )));
        }
        // A third of the texels' bytes, and the cells along sides that are not halved.
        memory::ask(u64::from(width) * u64::from(height) * 4 + (1 << 20), || {
            format!("the pyramid of a texture of {width} x {height} pixels")
        })?;
        // Adding 0 turns -0 into 0.
        texels.values_mut().as_flattened_mut().iter_mut().for_each(|value| *value += 0.0);
        let mut levels = vec![texels];
        for level in 0.. {
            let last = &levels[level];
            if last.width() == 1 && last.height() == 1 {
                break;
            }
            levels.push(coarser(last, level as u32, [width, height]));
        }
        Ok(Self(Arc::new(levels)))
    }

    /// Checks that a texture may have this size.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it has no pixel or a side of more than [`MAX_EXTENT`].
    pub fn check_size(width: u32, height: u32) -> Result<()> {
        if (1..=MAX_EXTENT).contains(&width) && (1..=MAX_EXTENT).contains(&height) {
            return Ok(());
        }
        Err(Error::Invalid(format!(
            "a texture of {width} x {height} pixels; give sides of 1 to {MAX_EXTENT}"
        )))
    }

    /// Width and height in texels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        [self.0[0].width(), self.0[0].height()]
    }

    /// The mean of the module page, around a place and within an ellipse, both in texels. On axes
    /// that repeat, the place is in the tile at the origin.
    fn mean(&self, at: DVec2, ellipse: Ellipse, repeats: [bool; 2]) -> Vec3 {
        if !(at.is_finite() && (ellipse.xx + ellipse.xy + ellipse.yy).is_finite()) {
            return Vec3::NAN;
        }
        let last = self.0.len() - 1;
        let level = ellipse.level(last);
        let side = (1_u64 << level) as f64;
        let [xx, xy, yy] = [ellipse.xx + side * side, ellipse.xy, ellipse.yy + side * side];
        let det = xx * yy - xy * xy;
        let axes = [0, 1].map_inline(|i| Axis {
            texels: self.size()[i].into(),
            side: 1 << level,
            repeats: repeats[i],
        });
        let [a, b, c] = [yy / det, 2.0 * (xy / det), xx / det];
        let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
        let cells = &self.0[level];
        let reach = yy.sqrt();
        let [first, end] = axes[1].range(at.y - reach, at.y + reach);
        // A degenerate ellipse has no cells, and takes the colour of the last level.
        for row in if det > 0.0 { first..end } else { 0..0 } {
            let (y, height) = axes[1].cell(row);
            let dy = y - at.y;
            // Where q = 1 in this row. The range includes a few cells that have no weight.
            let middle = at.x + (xy / yy) * dy;
            let rest = (det / yy) * (1.0 - (dy * dy) / yy).at_least(0.0);
            let [first, end] = axes[0].range(middle - rest.sqrt(), middle + rest.sqrt());
            for column in first..end {
                let (x, width) = axes[0].cell(column);
                let dx = x - at.x;
                let q = (a * (dx * dx) - b * (dx * dy)) + c * (dy * dy);
                if q < 1.0 {
                    let w = (width * height) * ((1.0 - q) * (1.0 - q));
                    let color = *cells.at(axes[0].index(column), axes[1].index(row));
                    sum += DVec3::from_array(color.map_inline(f64::from)) * w;
                    weight += w;
                }
            }
        }
        if weight > 0.0 {
            return (sum / weight).as_vec3() + Vec3::ZERO;
        }
        Vec3::from_array(self.0[last].values()[0])
    }
}

/// The level after one, for a picture of this size.
fn coarser(fine: &Plane<[f32; 3]>, level: u32, size: [u32; 2]) -> Plane<[f32; 3]> {
    let [columns, rows] =
        size.map_inline(|texels| Axis { texels: texels.into(), side: 1 << level, repeats: false });
    let half = |n: u32| n.div_ceil(2);
    // A product of whole numbers below 2^53 is exact, so it may be computed in any way.
    let area = |i: u32, j: u32| (columns.length(i.into()) * rows.length(j.into())) as f64;
    Plane::from_pixels([half(fine.width()), half(fine.height())], |x, y| {
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for j in 2 * y..fine.height().min(2 * y + 2) {
            for i in 2 * x..fine.width().min(2 * x + 2) {
                let own = area(i, j);
                sum += DVec3::from_array(fine.at(i, j).map_inline(f64::from)) * own;
                total += own;
            }
        }
        (sum / total).as_vec3().to_array()
    })
}

/// One axis of a level: cells along the texels. Cells of the tile at the origin count from 0; cells
/// of the tile before it have numbers below 0.
#[derive(Clone, Copy)]
struct Axis {
    texels: i64,
    /// How many texels a cell has.
    side: i64,
    repeats: bool,
}

impl Axis {
    fn cells(self) -> i64 {
        (self.texels + self.side - 1) / self.side
    }

    /// The length of a cell of the tile at the origin.
    fn length(self, cell: i64) -> i64 {
        self.texels.min((cell + 1) * self.side) - cell * self.side
    }

    /// The centre of a cell, and its length.
    fn cell(self, cell: i64) -> (f64, f64) {
        let (tile, own) = (cell.div_euclid(self.cells()), cell.rem_euclid(self.cells()));
        let (start, end) = (own * self.side, self.texels.min((own + 1) * self.side));
        ((tile * self.texels) as f64 + (start + end) as f64 / 2.0, (end - start) as f64)
    }

    /// The index of a cell's colour.
    fn index(self, cell: i64) -> u32 {
        cell.rem_euclid(self.cells()) as u32
    }

    /// The first cell between two places, and the cell after the last; one more on each side.
    fn range(self, from: f64, to: f64) -> [i64; 2] {
        let tiles = if self.repeats { [-REPEATS, REPEATS + 1] } else { [0, 1] };
        let [low, high] = tiles.map_inline(|tile| tile * self.texels);
        let cell = |place: f64| {
            // Held within the tiles, so that nothing overflows.
            let place = place.clamped(low as f64, high as f64).floor() as i64;
            let (tile, own) = (place.div_euclid(self.texels), place.rem_euclid(self.texels));
            tile * self.cells() + own / self.side
        };
        let [low, high] = tiles.map_inline(|tile| tile * self.cells());
        [low.max(cell(from) - 1), high.min(cell(to) + 2)]
    }
}

/// The matrix p p^T + q q^T of an ellipse with the conjugate half axes p and q, in any plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ellipse {
    pub(crate) xx: f64,
    pub(crate) xy: f64,
    pub(crate) yy: f64,
}

impl Ellipse {
    /// The matrix of two half axes.
    pub(crate) fn from_half_axes(p: DVec2, q: DVec2) -> Self {
        Self { xx: p.x * p.x + q.x * q.x, xy: p.x * p.y + q.x * q.y, yy: p.y * p.y + q.y * q.y }
    }

    /// Scales the matrix; the half axes are scaled by the root of the factor.
    pub(crate) fn times(self, s: f64) -> Self {
        Self { xx: self.xx * s, xy: self.xy * s, yy: self.yy * s }
    }

    /// The level l of the module page.
    fn level(self, last: usize) -> usize {
        let (half, diff) = ((self.xx + self.yy) / 2.0, (self.xx - self.yy) / 2.0);
        let root = (diff * diff + self.xy * self.xy).sqrt();
        let (mut level, mut side2) = (0, 1.0);
        while level < last && (64.0 * side2 <= half - root || 16384.0 * side2 < half + root) {
            level += 1;
            side2 *= 4.0;
        }
        level
    }
}

/// The texture of a mesh, and how it lies on the mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Paint {
    texture: Texture,
    repeats: [bool; 2],
    levels: usize,
}

impl Paint {
    /// Makes the paint: a texture for all of the coordinates, and how many levels of [prefiltered
    /// colours](super::Mipmap) are made from it: 0 to [`super::mipmap::MOST_LEVELS`].
    #[must_use]
    pub fn new(texture: Texture, coordinates: &Coordinates, levels: usize) -> Self {
        Self { texture, repeats: coordinates.repeats(), levels }
    }

    /// How many levels of prefiltered colours are made.
    #[must_use]
    pub fn levels(&self) -> usize {
        self.levels
    }

    /// The mean around (u, v) within an ellipse of that plane; NaN unless both are finite.
    pub(crate) fn color(&self, at: DVec2, ellipse: Ellipse) -> Vec3 {
        let [width, height] = self.texture.size().map_inline(f64::from);
        let tile = |place: f64, repeats: bool| if repeats { place - place.floor() } else { place };
        let [column, row] = self.repeats;
        let at = DVec2::new(tile(at.x, column) * width, tile(1.0 - at.y, row) * height);
        // y runs against v.
        let ellipse = Ellipse {
            xx: ellipse.xx * (width * width),
            xy: -(ellipse.xy * (width * height)),
            yy: ellipse.yy * (height * height),
        };
        self.texture.mean(at, ellipse, self.repeats)
    }
}

#[cfg(test)]
mod tests;
