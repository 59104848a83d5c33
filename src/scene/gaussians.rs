//! 3D Gaussians: the checked structure of arrays that the method `gaussians` draws.

use crate::error::{Error, Result};
use crate::number::MapInline;
use crate::scene::light::MAX_RADIANCE;
use glam::{DVec3, Vec3};

/// The greatest degree of the spherical harmonics.
pub const MAX_DEGREE: u32 = 3;

/// 3D Gaussians as arrays of one length. Their numbers are activated: scales are standard
/// deviations, not logarithms, and opacities are not logits.
///
/// The constructor guarantees:
///
/// - at least one Gaussian, and less than 2^32 - 1;
/// - finite positions;
/// - coefficients of at most [`MAX_RADIANCE`] in magnitude;
/// - finite scales >= 0;
/// - rotations of length 1 within 2^-20;
/// - opacities in [0, 1], none of them -0.
#[derive(Clone, Debug, PartialEq)]
pub struct Gaussians {
    position: Vec<Vec3>,
    scale: Vec<Vec3>,
    rotation: Vec<[f32; 4]>,
    opacity: Vec<f32>,
    degree: u32,
    harmonics: Vec<Vec3>,
    encoding: Encoding,
}

/// How the colours of Gaussians are stored. Colours are blended as they are stored, and the picture
/// is decoded after the blending.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// Encoded with the transfer function of sRGB (`srgb_rec709_display`), as programs train them.
    #[default]
    Srgb,
    /// Linear light (`lin_rec709_display`).
    Linear,
}

impl Encoding {
    /// The name in `KHR_gaussian_splatting`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Srgb => "srgb_rec709_display",
            Self::Linear => "lin_rec709_display",
        }
    }
}

/// What keeps a Gaussian from being drawn. Greater coefficients would make sums that leave `f32`.
pub const UNDRAWABLE: &str = "a number that is not finite, a scale < 0, a rotation of length 0, an \
                              opacity outside [0, 1] or a coefficient beyond +-65536";

/// Gaussians as a file holds them after activation, unchecked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GaussianArrays {
    /// Centres, in world units.
    pub position: Vec<Vec3>,
    /// Standard deviations along the own axes, in world units.
    pub scale: Vec<Vec3>,
    /// Quaternions (x, y, z, w) of the rotations from the own axes to the world; of any length but
    /// 0.
    pub rotation: Vec<[f32; 4]>,
    /// Opacities in [0, 1].
    pub opacity: Vec<f32>,
    /// The degree of the spherical harmonics, 0 to [`MAX_DEGREE`].
    pub degree: u32,
    /// (degree + 1)^2 coefficients for each Gaussian, one after the other, in the order of
    /// [`crate::shade::harmonics`]. Each is a colour.
    pub harmonics: Vec<Vec3>,
    /// How the colours are stored.
    pub encoding: Encoding,
}

impl GaussianArrays {
    fn check_lengths(&self) -> Result<()> {
        let n = self.position.len();
        if self.degree > MAX_DEGREE {
            let what =
                format!("spherical harmonics of degree {}; give 0 to {MAX_DEGREE}", self.degree);
            return Err(Error::Invalid(what));
        }
        let coefficients = n * coefficients(self.degree);
        let lengths = [
            ("scales", self.scale.len(), n),
            ("rotations", self.rotation.len(), n),
            ("opacities", self.opacity.len(), n),
            ("coefficients of spherical harmonics", self.harmonics.len(), coefficients),
        ];
        for (what, found, wanted) in lengths {
            if found != wanted {
                let what = format!("{n} Gaussians, but {found} {what}; give {wanted}");
                return Err(Error::Invalid(what));
            }
        }
        if n as u64 >= u64::from(u32::MAX) {
            return Err(Error::Invalid(format!(
                "{n} Gaussians, but ids have 32 bits: split the scene"
            )));
        }
        Ok(())
    }
}

/// How many coefficients a Gaussian of this degree has.
#[must_use]
pub fn coefficients(degree: u32) -> usize {
    let rows = degree as usize + 1;
    rows * rows
}

impl Gaussians {
    /// Checks Gaussians, drops those that cannot be drawn, and counts the dropped ones.
    ///
    /// Dropped is a Gaussian with one of [`UNDRAWABLE`]. A rotation whose square length is within
    /// 2^-20 of 1 is kept as it is. Any other is divided by its length, the root of
    /// `((x x + y y) + z z) + w w`, in f64, component by component, and rounded once.
    ///
    /// # Errors
    /// [`Error::Invalid`] if an array has the wrong length, if nothing is left, if there are more
    /// than 2^32 - 2 Gaussians, or if the degree is more than [`MAX_DEGREE`].
    pub fn new(arrays: GaussianArrays) -> Result<(Self, u64)> {
        arrays.check_lengths()?;
        let GaussianArrays { mut rotation, mut opacity, degree, encoding, .. } = arrays;
        rotation.iter_mut().for_each(|rotation| *rotation = unit(*rotation));
        // Adding 0 turns -0 into 0.
        opacity.iter_mut().for_each(|opacity| *opacity += 0.0);
        let each = coefficients(degree);
        let good = |i: usize| {
            let finite = arrays.position[i].is_finite() && arrays.scale[i].is_finite();
            let harmonics = &arrays.harmonics[i * each..][..each];
            finite
                && arrays.scale[i].cmpge(Vec3::ZERO).all()
                && rotation[i].iter().all(|part| part.is_finite())
                && (0.0..=1.0).contains(&opacity[i])
                && harmonics.iter().all(|color| color.abs().cmple(Vec3::splat(MAX_RADIANCE)).all())
        };
        let n = opacity.len();
        let kept: Vec<usize> = (0..n).filter(|&i| good(i)).collect();
        if kept.is_empty() {
            return Err(Error::Invalid(format!(
                "the scene is empty: none of its {n} Gaussians can be drawn, because each has {UNDRAWABLE}"
            )));
        }
        let dropped = (n - kept.len()) as u64;
        let all = dropped == 0;
        let harmonics = if all {
            arrays.harmonics
        } else {
            kept.iter().flat_map(|&i| &arrays.harmonics[i * each..][..each]).copied().collect()
        };
        let gaussians = Self {
            position: picked(arrays.position, &kept),
            scale: picked(arrays.scale, &kept),
            rotation: picked(rotation, &kept),
            opacity: picked(opacity, &kept),
            degree,
            harmonics,
            encoding,
        };
        Ok((gaussians, dropped))
    }

    /// How many Gaussians there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Always false, because there is at least one.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Centres, in world units.
    #[must_use]
    pub fn position(&self) -> &[Vec3] {
        &self.position
    }

    /// Standard deviations along the own axes, in world units.
    #[must_use]
    pub fn scale(&self) -> &[Vec3] {
        &self.scale
    }

    /// Unit quaternions (x, y, z, w), from the own axes to the world.
    #[must_use]
    pub fn rotation(&self) -> &[[f32; 4]] {
        &self.rotation
    }

    /// Opacities in [0, 1].
    #[must_use]
    pub fn opacity(&self) -> &[f32] {
        &self.opacity
    }

    /// The degree of the spherical harmonics, 0 to [`MAX_DEGREE`].
    #[must_use]
    pub fn degree(&self) -> u32 {
        self.degree
    }

    /// The coefficients of Gaussian `i`: (degree + 1)^2 colours.
    #[must_use]
    pub fn harmonics(&self, i: usize) -> &[Vec3] {
        let each = coefficients(self.degree);
        &self.harmonics[i * each..][..each]
    }

    /// All coefficients, (degree + 1)^2 for each Gaussian.
    #[must_use]
    pub fn all_harmonics(&self) -> &[Vec3] {
        &self.harmonics
    }

    /// How the colours are stored.
    #[must_use]
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// Turns the Gaussians back into arrays, to be changed or written to a file.
    #[must_use]
    pub fn into_arrays(self) -> GaussianArrays {
        let Self { position, scale, rotation, opacity, degree, harmonics, encoding } = self;
        GaussianArrays { position, scale, rotation, opacity, degree, harmonics, encoding }
    }

    /// The corners of the smallest axis-parallel box around all centres.
    #[must_use]
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let first = self.position.first().copied().unwrap_or_default();
        self.position.iter().fold((first, first), |(low, high), p| (low.min(*p), high.max(*p)))
    }

    /// The largest distance from a point to a centre, plus three of the largest standard deviation
    /// of that Gaussian, in f64.
    pub(super) fn reach(&self, center: DVec3) -> f64 {
        let far = self.position.iter().zip(&self.scale).map(|(position, scale)| {
            (position.as_dvec3() - center).length() + 3.0 * f64::from(scale.max_element())
        });
        far.fold(0.0, |most, far| if far > most { far } else { most })
    }
}

/// A quaternion of length 1; not finite if it has length 0.
fn unit(rotation: [f32; 4]) -> [f32; 4] {
    let [x, y, z, w] = rotation.map_inline(f64::from);
    let square = ((x * x + y * y) + z * z) + w * w;
    if (square - 1.0).abs() <= 1.0 / 1_048_576.0 {
        return rotation;
    }
    let length = square.sqrt();
    [x, y, z, w].map_inline(|part| (part / length) as f32)
}

fn picked<T: Copy>(values: Vec<T>, kept: &[usize]) -> Vec<T> {
    if kept.len() == values.len() { values } else { kept.iter().map(|&i| values[i]).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrays(n: usize) -> GaussianArrays {
        GaussianArrays {
            position: vec![Vec3::ONE; n],
            scale: vec![Vec3::splat(0.5); n],
            rotation: vec![[0.0, 0.0, 0.0, 2.0]; n],
            opacity: vec![-0.0; n],
            degree: 1,
            harmonics: vec![Vec3::X; 4 * n],
            encoding: Encoding::Srgb,
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_dropped_with_its_coefficients() {
        let mut given = arrays(6);
        given.position[0].x = f32::NAN;
        given.scale[1].y = -1e-9;
        given.rotation[2] = [0.0; 4];
        given.opacity[3] = 1.5;
        given.harmonics[4 * 4 + 2].z = -70_000.0;
        given.harmonics[5 * 4 + 1] = Vec3::Z;
        let (kept, dropped) = Gaussians::new(given).unwrap();
        assert_eq!((kept.len(), dropped), (1, 5));
        assert_eq!(kept.harmonics(0), [Vec3::X, Vec3::Z, Vec3::X, Vec3::X], "those of the last");
        assert_eq!(kept.rotation()[0], [0.0, 0.0, 0.0, 1.0], "made a unit");
        assert_eq!(kept.opacity()[0].to_bits(), 0, "no -0");
    }

    #[test]
    fn the_reason_names_the_bound() {
        assert!(UNDRAWABLE.ends_with(&format!("+-{MAX_RADIANCE}")));
    }

    #[test]
    fn wrong_lengths_and_degrees_are_refused() {
        let refused = |change: fn(&mut GaussianArrays)| {
            let mut given = arrays(2);
            change(&mut given);
            Gaussians::new(given).unwrap_err().to_string()
        };
        assert!(refused(|g| g.degree = 4).contains("degree 4; give 0 to 3"));
        assert!(refused(|g| g.degree = 2).contains("8 coefficients"));
        assert!(refused(|g| g.opacity.clear()).contains("0 opacities; give 2"));
        assert!(refused(|g| g.opacity.fill(2.0)).contains("none of its 2 Gaussians"));
    }
}
