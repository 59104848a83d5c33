//! Reflect and refract an environment, pixel by pixel: \[ZP06 5.2.3\], eqs. 11 and 12.
//!
//! The nearest layer of a pixel is a thin sheet of clear material. Its opacity alpha is the part of
//! the sheet that opaque colour covers. The view vector v towards the eye and the normal n are unit
//! vectors in world space with n . v >= 0. For each colour channel c:
//!
//! ```text
//!   l   = 1 + layers(alpha_total of the other layers, alpha)
//!   R   = reflect(v, n)        T_c = refract(v, n, ratio_c, l)
//!   F_c = fresnel(n . v, ratio_c), 1 where there is no T_c
//!   I_c = alpha C_F_c + ((1 - alpha) F_c env(R)_c
//!           + (1 - F_c) ((1 - alpha) C_O_c + (1 - hidden) (1 - alpha)^l env(T_c)_c))
//! ```
//!
//! `C_F` is the Phong colour of the composited nearest layer. `C_O` is the average of the images of
//! the other layers over black. One ratio for each channel gives chromatic dispersion.
//!
//! Decided: the paper combines the parts "using" Fresnel's equations without saying how.
//! - The equations are the exact ones of an unpolarized dielectric, not Schlick's approximation.
//!   Schlick's has no total reflection and no Brewster angle, and is wrong for ratios near 1.
//! - Opacity covers the optics: F acts on the part 1 - alpha of a surface. So an opaque pixel is
//!   its Phong colour exactly, and a nearly opaque one nearly so. Without reflection (F = 0) the
//!   result is the paper's alpha `C_F` + (1 - alpha) `C_O` over the absorbed environment.
//! - l counts the nearest layer itself, so that eq. 11 attenuates by it too.
//! - Opaque surfels among the other layers hide the environment; `hidden` says what part of it. Eq.
//!   11 alone, made for one opacity everywhere, would let light through them.
//! - `C_O` is seen straight through the surface, not refracted, because there is nothing to look it
//!   up in.
//! - [`BendingLayers::Single`] is Fig. 14 a: reflection and refraction at the nearest surface
//!   alone, l = 1 and `C_O` = hidden = 0.
//! - A normal that faces away is turned round, because a sheet has two sides.
//!
//! A law follows. Take an environment of radiance 1, and a surface of colour 1 in front of layers
//! that send what they absorb, `C_O` = 1 - (1 - alpha)^(l - 1). The surface sends 1, whatever the
//! angle and the ratios.

#[cfg(test)]
mod tests;

use crate::error::{Error, Result};
use crate::number::MapInline;
use crate::number::{Exact, Real, Truth, Vector3};
use crate::scene::Environment;
use crate::setting::Words;

/// How many surfaces bend the light: the count l of the module page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BendingLayers {
    /// Only the nearest: l = 1. Behind the nearest surface only the environment is seen: `C_O` and
    /// `hidden` count as 0.
    Single,
    /// As many as the accumulated opacity tells: l = 1 + [`layers`], not rounded to an integer; 1
    /// where alpha is 0.
    Multiple,
}

impl Words for BendingLayers {
    const WORDS: &'static [(&'static str, Self)] =
        &[("single", Self::Single), ("multiple", Self::Multiple)];
}

/// How a transparent surface bends light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refraction {
    /// Refraction ratios of red, green and blue: the index outside over the index inside, 2/3 from
    /// air to glass. In (0, 4].
    pub ratio: [f32; 3],
    /// How many surfaces bend the light.
    pub layers: BendingLayers,
}

/// The largest ratio of refraction.
pub const MAX_RATIO: f32 = 4.0;

impl Refraction {
    /// Checks that the ratios are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if one is not in (0, [`MAX_RATIO`]].
    pub fn check(&self) -> Result<()> {
        match self.ratio.iter().find(|ratio| !(**ratio > 0.0 && **ratio <= MAX_RATIO)) {
            None => Ok(()),
            Some(ratio) => Err(Error::Invalid(format!(
                "refraction: a ratio of {ratio}; give a number in (0, {MAX_RATIO}], such as 0.6667 \
                 from air to glass"
            ))),
        }
    }
}

/// The composited nearest layer of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestLayer<R> {
    /// `C_F`: linear RGB after Phong shading.
    pub color: [R; 3],
    /// alpha, in [0, 1].
    pub opacity: R,
    /// The world-space normal, of any length: interpolated normals are shorter than 1.
    pub normal: Vector3<R>,
}

/// What lies behind the nearest layer, averaged over the groups.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Behind<R> {
    /// `C_O`: linear RGB, blended over black.
    pub color: [R; 3],
    /// The sum of the opacities of the layers in front of the first opaque one.
    pub opacity: R,
    /// The part of the groups in which an opaque surfel hides the environment, in [0, 1].
    pub hidden: R,
}

/// The direction from which a mirror shows light: n (2 (n . v)) - v, as in [`super::phong`].
///
/// `view` points from the surface to the eye; both are unit vectors.
#[inline]
#[must_use]
pub fn reflect<R: Real>(view: Vector3<R>, normal: Vector3<R>) -> Vector3<R> {
    let cosine = normal.dot(view);
    normal * (cosine + cosine) - view
}

/// The direction in which light is seen through `layers` surfaces, eq. 12. The sine of its angle is
/// ratio^layers times the sine of the angle of incidence. The direction lies in the plane of `view`
/// and `normal`, on the other side of the surface. None under total internal reflection, where that
/// sine is > 1; at 1 the direction runs along the surface.
///
/// `view` points from the surface to the eye; both are unit vectors, n . v >= 0; `ratio` > 0,
/// `layers` >= 0.
///
/// ```text
///   c = n . v      t = n c - v, the tangent      s = |t|, the sine of incidence
///   m = ratio^layers
///   k = (1 - m)(1 + m) + (m c)(m c)  if m <= 1, else  1 - (m s)(m s):  the squared cosine of T
///   T = t m - n sqrt(k)
/// ```
///
/// The two forms of k are equal; each is used where it does not cancel. Where s = 0 the direction
/// is -n for every ratio. With m = 1, as for no layers, T is -v up to the rounding of t.
#[must_use]
pub fn refract<R: Exact>(
    view: Vector3<R>,
    normal: Vector3<R>,
    ratio: R,
    layers: R,
) -> Option<Vector3<R>> {
    let (there, direction) = bent(view, normal, ratio, layers);
    there.then_some(direction)
}

/// Whether [`refract`] has a direction, and the direction.
fn bent<R: Real>(
    view: Vector3<R>,
    normal: Vector3<R>,
    ratio: R,
    layers: R,
) -> (R::Truth, Vector3<R>) {
    let c = normal.dot(view);
    let tangent = normal * c - view;
    let s = tangent.dot(tangent).root_of_squares();
    let m = ratio.pow(layers);
    let small = (R::ONE - m) * (R::ONE + m) + (m * c) * (m * c);
    let large = R::ONE - (m * s) * (m * s);
    // m may have overflowed: then k is -inf.
    let k = R::select(m.le(R::ONE), small, large);
    let slanted = s.gt(R::ZERO);
    let through = tangent * m - normal * k.at_least(R::ZERO).root_of_squares();
    let part = |through: R, straight: R| R::select(slanted, through, straight);
    let direction = Vector3::new(
        part(through.x, -normal.x),
        part(through.y, -normal.y),
        part(through.z, -normal.z),
    );
    (k.ge(R::ZERO) | !slanted, direction)
}

/// The part of the light that passes through `layers` layers of opacity `alpha`, eq. 11: (1 -
/// alpha)^layers, in \[0, 1\].
///
/// `alpha` is brought into [0, 1]; `layers` >= 0. No layers let everything through, opaque or not.
#[inline]
#[must_use]
pub fn absorption<R: Real>(alpha: R, layers: R) -> R {
    (R::ONE - alpha).clamped(R::ZERO, R::ONE).pow(layers)
}

/// The part of unpolarized light that the surface of a dielectric reflects, in [0, 1]: Fresnel's
/// equations.
///
/// `cosine` is the cosine of the angle of incidence, in [0, 1]; `ratio` in (0, [`MAX_RATIO`]].
///
/// ```text
///   k = (1 - ratio)(1 + ratio) + (ratio cosine)(ratio cosine)      1 if k < 0: total reflection
///   t = sqrt(k), the cosine inside
///   s = (ratio cosine - t) / (ratio cosine + t)      p = (cosine - ratio t) / (cosine + ratio t)
///   (s s + p p) / 2
/// ```
///
/// At grazing incidence everything is reflected, except with a ratio of 1: that is no surface, and
/// reflects nothing.
#[must_use]
pub fn fresnel<R: Real>(cosine: R, ratio: R) -> R {
    let scaled = ratio * cosine;
    let k = (R::ONE - ratio) * (R::ONE + ratio) + scaled * scaled;
    let t = k.at_least(R::ZERO).root_of_squares();
    let s = (scaled - t) / (scaled + t);
    let p = (cosine - ratio * t) / (cosine + ratio * t);
    let part = R::select((scaled + t).gt(R::ZERO), (s * s + p * p) / R::from_f32(2.0), R::ZERO);
    R::select(k.lt(R::ZERO), R::ONE, part)
}

/// How many layers of opacity `alpha` have opacities that sum to `total`: total / alpha, and 0
/// where `alpha` is 0. \[ZP06 5.2.3\]
#[inline]
#[must_use]
pub fn layers<R: Real>(total: R, alpha: R) -> R {
    R::select(alpha.gt(R::ZERO), total / alpha, R::ZERO)
}

/// The colour of one pixel, see the module page.
///
/// `view` is the unit vector from the surface to the eye in world space: the ray of the pixel,
/// [`crate::splat::View::ray`], normalized and turned round. Sums and products are rounded in the
/// order of the module page, (1 - hidden) and (1 - alpha)^l first. n is normalized, then turned
/// round if n . v < 0. The cosine is at most 1, alpha at least 0 and at most 1. Where the normal
/// has no length, light passes straight through the surface.
#[must_use]
pub fn shade<R: Exact>(
    environment: &Environment,
    refraction: &Refraction,
    view: Vector3<R>,
    nearest: &NearestLayer<R>,
    behind: &Behind<R>,
) -> [R; 3] {
    shade_before(|direction| environment.radiance(direction), refraction, view, nearest, behind)
}

/// [`shade`] with any function that gives the light from a direction.
pub(crate) fn shade_before<R: Real>(
    light: impl Fn(Vector3<R>) -> [R; 3],
    refraction: &Refraction,
    view: Vector3<R>,
    nearest: &NearestLayer<R>,
    behind: &Behind<R>,
) -> [R; 3] {
    let alpha = nearest.opacity.clamped(R::ZERO, R::ONE);
    let Vector3 { x, y, z } = nearest.normal.normalized();
    let away = Vector3::new(x, y, z).dot(view).lt(R::ZERO);
    let part = |n: R| R::select(away, -n, n);
    let normal = Vector3::new(part(x), part(y), part(z));
    let cosine = normal.dot(view).at_most(R::ONE);
    let (count, behind_color, seen) = match refraction.layers {
        BendingLayers::Single => (R::ONE, [R::ZERO; 3], R::ONE),
        BendingLayers::Multiple => {
            (R::ONE + layers(behind.opacity, alpha), behind.color, R::ONE - behind.hidden)
        }
    };
    let clear = R::ONE - alpha;
    let through = seen * absorption(alpha, count);
    let reflected = light(reflect(view, normal));
    [0, 1, 2].map_inline(|c| {
        let ratio = R::from_f32(refraction.ratio[c]);
        let (there, direction) = bent(view, normal, ratio, count);
        // Where there certainly is no refracted direction, there is no light to look up.
        let beyond = if there.possibly() { light(direction)[c] } else { R::ZERO };
        let f = R::select(there, fresnel(cosine, ratio), R::ONE);
        let beyond = R::select(there, beyond, R::ZERO);
        alpha * nearest.color[c]
            + ((clear * f) * reflected[c]
                + (R::ONE - f) * (clear * behind_color[c] + through * beyond))
    })
}
