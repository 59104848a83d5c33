//! Prefilter colours against aliasing: the colour in which pass 4 draws a surfel \[GBP04, 4.4\].
//!
//! If several surfels lie in a pixel, one is selected, and the colours of the others are lost. A
//! surfel with a [mipmap](crate::scene::Mipmap) is drawn in the average colour of the surface over
//! about the area of a pixel. The colour is a function of the surfel in its place and of the
//! camera. It is found before anything is drawn, in f64 from the `f32` numbers of both, and rounded
//! to `f32` once. So the colour is an input of pass 4, the other passes ignore it, and it is the
//! same for every number type.
//!
//! **Level.** With area as [`mod@crate::splat::project`] has it with k = 1, in f64,
//!
//! ```text
//!   x     = sqrt(2 / area)
//!   level = j + (x / 2^j - 1)        2^j the greatest power of two <= x, j from 0
//! ```
//!
//! area is the area in px^2 that the square on the surfel's radius covers on the screen: the
//! determinant of the Jacobian from the surfel's plane to the screen, times r r. For an ellipse,
//! the parallelogram on its half axes takes the place of the square. So x is sqrt(2) times the side
//! of a pixel in radii, if a pixel were a square there.
//!
//! - If x < 1, the level is 0.
//! - If the formula gives L or more, the level is L; also if area is 0.
//! - If area is NaN, or t = -p.z is not > 0, the level is 0, because no pass draws the surfel.
//!
//! **Colour.** `c_0` is the surfel's own colour, `c_1` to `c_L` are the prefiltered colours, and
//! j < L. For each component
//!
//! ```text
//!   c = c_j + (c_(j+1) - c_j) (level - j)        c_L at the level L
//! ```
//!
//! rounded to `f32`, plus 0. Equal colours give that colour, bit for bit.
//!
//! # Decided
//!
//! - The coefficient is the determinant. \[GBP04\] takes the coefficient "from the Jacobian matrix"
//!   and does not say how. The measurement behind the choice (the sphere of the bench `deferred`)
//!   is flicker and error against `ewa` of all surfels, at one surfel a pixel and at four:
//!
//!   | x | flicker | error | flicker | error |
//!   |---|---|---|---|---|
//!   | no mipmaps | 0.123 | 0.091 | 0.275 | 0.224 |
//!   | sqrt(1 / area) | 0.094 | 0.072 | 0.151 | 0.155 |
//!   | sqrt(2 / area) | 0.072 | 0.064 | 0.126 | 0.146 |
//!   | sqrt(4 / area) | 0.065 | 0.082 | 0.123 | 0.154 |
//!   | greatest length of a pixel | 0.072 | 0.066 | 0.138 | 0.152 |
//!   | sqrt(2) times that | 0.065 | 0.077 | 0.125 | 0.151 |
//!   | least length of a pixel | 0.123 | 0.091 | 0.199 | 0.178 |
//!
//!   A smaller x leaves aliasing, a larger one blurs the picture. At a quarter of a surfel a pixel,
//!   the greatest length of trilinear filtering, times sqrt(2), has half as much error again as no
//!   mipmaps.
//! - The 2: the colour of level k is a mean of variance R R / 8 along each axis, R = 2^k r. At x =
//!   2^k this variance is 1/4 px^2, the variance of the default low-pass filter.
//! - Between two powers of two the coefficient is linear in x, not in the logarithm of x. The two
//!   differ by less than 0.087. So no function is needed here whose bits depend on a library.
//! - An object with its own colour has that colour, and so has everything that belongs to it.
//!
//! Source: \[GBP04, 4.4\], after Pfister et al. 2000 (*Surfels*).

use crate::frame::Exec;
use crate::scene::{Camera, Surfels};
use crate::splat::batch::disc;
use crate::splat::{Disc, Kernel, Projector, View};
use glam::Vec3;

/// Recolours surfels as a camera sees them; surfels without prefiltered colours stay as they are.
pub(super) fn filtered(surfels: Surfels, camera: &Camera, exec: &Exec) -> Surfels {
    if surfels.mipmap().is_none() {
        return surfels;
    }
    let view = View::new(camera);
    let mut colors = Vec::with_capacity(surfels.len());
    exec.extend(&mut colors, surfels.len(), |i| {
        color(&surfels, i, Level::of_surfel(&view, &surfels, i))
    });
    surfels.recolored(colors)
}

/// A position between two colours of a surfel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// j, the whole part.
    pub below: usize,
    /// The share of the next level, 0 to 1; 0 at the last.
    pub part: f64,
}

impl Level {
    /// The level of a surfel; 0 without prefiltered colours.
    #[must_use]
    pub fn of_surfel(view: &View<f64>, surfels: &Surfels, i: usize) -> Self {
        let levels = surfels.mipmap().map_or(0, crate::scene::Mipmap::levels);
        Self::at(pixel(view, &disc(surfels, i)), levels)
    }

    /// The level of x, between 0 and `levels`.
    fn at(x: f64, levels: usize) -> Self {
        let (mut below, mut rest) = (0, x);
        while below < levels && rest >= 2.0 {
            rest *= 0.5;
            below += 1;
        }
        let inside = below < levels && rest > 1.0;
        Self { below, part: if inside { rest - 1.0 } else { 0.0 } }
    }

    /// The level as one number.
    #[must_use]
    pub fn number(&self) -> f64 {
        self.below as f64 + self.part
    }
}

/// x of a surfel; +inf edge-on, NaN if the surfel is not in front.
fn pixel(view: &View<f64>, disc: &Disc<f64>) -> f64 {
    if !(view.point(disc.position).z < 0.0) {
        return f64::NAN;
    }
    let kernel = Kernel { cutoff: 1.0, ..Kernel::DEFAULT };
    (2.0 / Projector::new(*view, &kernel, false).area(disc)).sqrt()
}

/// The colour of a surfel at a level; black if surfels have no colours.
#[must_use]
pub fn color(surfels: &Surfels, i: usize, level: Level) -> Vec3 {
    let own = surfels.color().map_or(Vec3::ZERO, |colors| colors[i]);
    let Some(mipmap) = surfels.mipmap() else { return own };
    let of = |k: usize| if k == 0 { own } else { mipmap.of_surfel(i)[k - 1] }.as_dvec3();
    let from = of(level.below);
    let mixed =
        if level.part > 0.0 { from + (of(level.below + 1) - from) * level.part } else { from };
    mixed.as_vec3() + Vec3::ZERO
}

#[cfg(test)]
mod tests;
