//! Prefiltered colours: what pass 4 draws a surfel in \[GBP04, 4.4\].
//!
//! Where several surfels lie in a pixel one is selected, and the colours of the others are lost. A
//! surfel with a [mipmap](crate::scene::Mipmap) is drawn in the colour that the surface has on the
//! average over about as much as a pixel covers. The colour is a function of the surfel in its place
//! and of the camera, found before anything is drawn, in f64 from the `f32` numbers of both, and
//! rounded to `f32` once: it is an input of pass 4 and of the others no concern, and the same for every
//! number type.
//!
//! **Level.** With the names of [`mod@crate::splat::project`], in f64: p in view space, t = -p.z, m =
//! 1/t and d = (p.x m, p.y m), or m = 1 and d = (0, 0) under an orthographic camera. N is the normal in
//! view space, each component times (r r), or U x V of an ellipse with the half axes U and V in view
//! space.
//!
//! ```text
//!   area  = |((fx m) (fy m)) ((N.x d.x + N.y d.y) - N.z)|        px^2
//!   x     = sqrt(1 / area)
//!   level = k + (x / 2^k - 1)        2^k the greatest power of two <= x, k from 0
//! ```
//!
//! `area` is what the square of the side r around the surfel covers on the screen: the determinant of
//! the Jacobian J of the projection from the surfel's plane to the screen, times r r. x is the side of
//! a pixel on the surface, in radii, if the pixel were a square there. Where x < 1 the level is 0, and
//! where it is L or more, L; where area is 0 it is L, and where area is NaN or t <= 0, which no pass
//! draws, 0.
//!
//! **Colour.** With c_0 the surfel's own colour and k < L, per component
//!
//! ```text
//!   c = c_k + (c_(k+1) - c_k) (level - k)        c_L at the level L
//! ```
//!
//! rounded to `f32`, plus 0. Equal colours give that colour, bit for bit.
//!
//! # Decided
//!
//! - \[GBP04\] takes the coefficient "from the Jacobian matrix" and does not say how. Here it is the
//!   determinant: surfels are lost in proportion to the area that a pixel covers, in whatever direction
//!   the surface is foreshortened. LEVELRULE
//! - Between two powers of two the coefficient is linear in x, not in its logarithm, from which it
//!   differs by less than 0.087: so there is no function here whose bits depend on a library.
//! - An object with a colour of its own has that colour, and so has what belongs to it.
//!
//! Source: \[GBP04, 4.4\], after \[PZvG00\].

use crate::frame::Exec;
use crate::number::Vector3;
use crate::scene::{Camera, Surfels};
use crate::splat::batch::disc;
use crate::splat::{Disc, View};
use glam::Vec3;

/// Surfels in the colours in which a camera sees them; as they are if they have no prefiltered ones.
pub(super) fn filtered(surfels: Surfels, camera: &Camera, exec: &Exec) -> Surfels {
    if surfels.mipmap().is_none() {
        return surfels;
    }
    let view = View::new(camera);
    let mut colors = Vec::with_capacity(surfels.len());
    exec.extend(&mut colors, surfels.len(), |i| color(&surfels, i, Level::of(&view, &surfels, i)));
    surfels.recolored(colors)
}

/// Where between two colours of a surfel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// k, the whole part.
    pub below: usize,
    /// How much there is of the next, 0 to 1; 0 at the last.
    pub part: f64,
}

impl Level {
    /// The level of a surfel; 0 without prefiltered colours.
    #[must_use]
    pub fn of(view: &View<f64>, surfels: &Surfels, i: usize) -> Self {
        let levels = surfels.mipmap().map_or(0, crate::scene::Mipmap::levels);
        Self::at(pixel(view, &disc(surfels, i)), levels)
    }

    /// The level of x, of 0 to `levels`.
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

/// x: the side of a pixel on a surfel, in its radii; +inf edge-on, NaN of what is not in front.
fn pixel(view: &View<f64>, disc: &Disc<f64>) -> f64 {
    let p = view.point(disc.position);
    let t = -p.z;
    if !(t > 0.0) {
        return f64::NAN;
    }
    let m = if view.perspective { 1.0 / t } else { 1.0 };
    let (dx, dy) = if view.perspective { (p.x * m, p.y * m) } else { (0.0, 0.0) };
    let normal: Vector3<f64> = match disc.tangents {
        None => view.direction(disc.normal) * (disc.radius * disc.radius),
        Some(tangents) => {
            let [u, v] = tangents.map(|tangent| view.direction(tangent));
            u.cross(v)
        }
    };
    let along = (normal.x * dx + normal.y * dy) - normal.z;
    let area = (((view.fx * m) * (view.fy * m)) * along).abs();
    (1.0 / area).sqrt()
}

/// The colour of a surfel at a level; black if surfels have no colours.
#[must_use]
pub fn color(surfels: &Surfels, i: usize, level: Level) -> Vec3 {
    let own = surfels.color().map_or(Vec3::ZERO, |colors| colors[i]);
    let Some(mipmap) = surfels.mipmap() else { return own };
    let of = |k: usize| if k == 0 { own } else { mipmap.of(i)[k - 1] }.as_dvec3();
    let from = of(level.below);
    let mixed =
        if level.part > 0.0 { from + (of(level.below + 1) - from) * level.part } else { from };
    mixed.as_vec3() + Vec3::ZERO
}

#[cfg(test)]
mod tests;
