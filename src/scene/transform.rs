//! Move, turn and scale a model.

use super::degenerate::unit;
use super::{Cloud, Vertices};
use crate::error::{Error, Result};
use crate::number::elementary;
use glam::{DMat3, DVec3, Vec3};

/// A similarity: a point p goes to `rotation (p scale) + translation`.
///
/// Everything is computed in f64 and rounded to f32 once. Normals and tangents are turned, radii
/// are scaled, and half axes are both turned and scaled. With x, y, z the coordinates, m0, m1, m2 a
/// row of the rotation, t the row's component of the translation and s the scale, a component is
///
/// ```text
///   point      ((m0 (x s) + m1 (y s)) + m2 (z s)) + t
///   normal     (m0 x + m1 y) + m2 z
///   half axis  (m0 (x s) + m1 (y s)) + m2 (z s)          radius  r s
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    /// A rotation matrix, see [`Similarity::check`].
    pub rotation: DMat3,
    /// Scale in all directions, finite and > 0.
    pub scale: f64,
    /// Displacement in world units.
    pub translation: DVec3,
}

impl Similarity {
    /// Everything stays where it is, bit for bit.
    pub const IDENTITY: Self =
        Self { rotation: DMat3::IDENTITY, scale: 1.0, translation: DVec3::ZERO };

    /// Checks that the matrix is a rotation and the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the scale is not finite and > 0, if the translation is not finite, if
    /// a component of R^T R differs from the unit matrix by more than 1e-6, or if R is a
    /// reflection.
    pub fn check(&self) -> Result<()> {
        let invalid = |what: &str| Err(Error::Invalid(format!("transform: {what}")));
        if !(self.scale > 0.0 && self.scale.is_finite()) {
            return invalid("the scale must be a finite number > 0");
        }
        if !self.translation.is_finite() {
            return invalid("the translation must be finite numbers");
        }
        let product = self.rotation.transpose() * self.rotation;
        let off = (product - DMat3::IDENTITY).to_cols_array();
        if !(off.iter().all(|v| v.abs() <= 1e-6) && self.rotation.determinant() > 0.0) {
            return invalid(
                "the matrix is not a rotation: its rows must be perpendicular, of length 1 and \
                 right-handed",
            );
        }
        Ok(())
    }

    /// Combines this similarity, first, and `next` after it into one. With R, s and t of `next`:
    ///
    /// ```text
    ///   scale        s scale
    ///   rotation     R rotation, each element a sum ((a + b) + c)
    ///   translation  R (translation s) + t, the sums likewise
    /// ```
    ///
    /// each operation rounded to f64. If `next` is [`Similarity::IDENTITY`], the result is this
    /// similarity, bit for bit.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        if *next == Self::IDENTITY {
            return *self;
        }
        Self {
            rotation: next.rotation * self.rotation,
            scale: next.scale * self.scale,
            translation: next.rotation * (self.translation * next.scale) + next.translation,
        }
    }

    /// Applies it to every array of a cloud.
    pub fn apply(&self, cloud: &mut Cloud) {
        if *self == Self::IDENTITY {
            return;
        }
        cloud.position.iter_mut().for_each(|p| self.place(p));
        cloud.normal.iter_mut().flatten().for_each(|v| self.turn(v));
        cloud.tangent.iter_mut().flatten().for_each(|v| self.turn(v));
        cloud.radius.iter_mut().flatten().for_each(|radius| self.enlarge(radius));
        for half in cloud.tangents.iter_mut().flatten().flatten() {
            *half = self.stretch(*half);
        }
    }

    /// Applies it to vertices of primitives.
    pub fn apply_to_vertices(&self, vertices: &mut Vertices) {
        if *self == Self::IDENTITY {
            return;
        }
        vertices.position.iter_mut().for_each(|p| self.place(p));
        vertices.direction.iter_mut().for_each(|v| self.turn(v));
        vertices.radius.iter_mut().for_each(|radius| self.enlarge(radius));
    }

    /// Places the position and the normal of a surfel; they stay valid for a surfel.
    pub(crate) fn surfel(&self, position: Vec3, normal: Vec3) -> (Vec3, Vec3) {
        (self.point(position), self.normal(normal))
    }

    /// A normal, turned and made a unit vector again.
    #[inline(always)]
    pub(crate) fn normal(&self, mut normal: Vec3) -> Vec3 {
        self.turn(&mut normal);
        unit(&mut normal);
        normal
    }

    /// Where a point goes.
    #[inline(always)]
    pub(crate) fn point(&self, p: Vec3) -> Vec3 {
        (self.rotation * (p.as_dvec3() * self.scale) + self.translation).as_vec3()
    }

    pub(super) fn place(&self, p: &mut Vec3) {
        *p = self.point(*p);
    }

    pub(super) fn turn(&self, v: &mut Vec3) {
        *v = (self.rotation * v.as_dvec3()).as_vec3();
    }

    /// A half axis, turned and scaled.
    pub(super) fn stretch(&self, half: Vec3) -> Vec3 {
        (self.rotation * (half.as_dvec3() * self.scale)).as_vec3()
    }

    pub(super) fn enlarge(&self, radius: &mut f32) {
        *radius = (f64::from(*radius) * self.scale) as f32;
    }
}

/// Whether this is an axis that a model can be turned about.
pub(crate) fn is_axis(axis: DVec3) -> bool {
    axis.length() > 0.0 && axis.is_finite()
}

/// The rotation about an axis of any length but 0, counter-clockwise when the axis points at the
/// viewer.
///
/// With k the axis divided by its length, and c and s the cosine and sine of the angle:
/// `c I + s [k]x + (1 - c) k k^T`. In f64, each operation rounded in the order written, e one of
/// the axes x, y and z:
///
/// ```text
///   angle    = degrees q                       q = PI / 180 in f64, 0.017453292519943295
///   c, s     = cos(angle), sin(angle)          of number::elementary
///   k        = axis (1 / sqrt((ax ax + ay ay) + az az))      the quotient once, then three products
///   column e = (e c + (k x e) s) + k ((k . e) (1 - c))
///   a x b    = (a.y b.z - b.y a.z, a.z b.x - b.z a.x, a.x b.y - b.x a.y)
///   a . b    = (a.x b.x + a.y b.y) + a.z b.z
/// ```
#[must_use]
pub fn rotation(axis: DVec3, degrees: f64) -> DMat3 {
    let k = axis.normalize();
    let angle = degrees.to_radians();
    let (c, s) = (elementary::cos(angle), elementary::sin(angle));
    let column = |e: DVec3| e * c + k.cross(e) * s + k * (k.dot(e) * (1.0 - c));
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_array_is_transformed() {
        let mut cloud = Cloud {
            position: vec![Vec3::new(1.0, 2.0, 3.0)],
            normal: Some(vec![Vec3::X]),
            radius: Some(vec![0.5]),
            tangents: Some(vec![[Vec3::Y, Vec3::Z]]),
            tangent: Some(vec![Vec3::Y]),
            ..Cloud::default()
        };
        // x to y, y to z, z to x: exact, so the answer is known to the bit.
        let rotation = DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X);
        let moved = Similarity { rotation, scale: 2.0, translation: DVec3::new(10.0, 0.0, 0.0) };
        moved.check().unwrap();
        moved.apply(&mut cloud);
        assert_eq!(cloud.position, [Vec3::new(16.0, 2.0, 4.0)]);
        assert_eq!(cloud.normal, Some(vec![Vec3::Y]));
        assert_eq!(cloud.radius, Some(vec![1.0]));
        assert_eq!(cloud.tangents, Some(vec![[2.0 * Vec3::Z, 2.0 * Vec3::X]]));
        assert_eq!(cloud.tangent, Some(vec![Vec3::Z]));
        let mut vertices = Vertices {
            position: vec![Vec3::new(1.0, 2.0, 3.0)],
            direction: vec![Vec3::X],
            radius: vec![0.5],
            color: None,
            ..Vertices::default()
        };
        moved.apply_to_vertices(&mut vertices);
        assert_eq!(vertices.position, cloud.position);
        assert_eq!((vertices.direction[0], vertices.radius[0]), (Vec3::Y, 1.0));
    }

    #[test]
    fn one_after_the_other_is_both() {
        let a = Similarity {
            rotation: rotation(DVec3::ONE, 40.0),
            scale: 3.0,
            translation: DVec3::new(1.0, -2.0, 0.5),
        };
        let b = Similarity {
            rotation: rotation(DVec3::X, -70.0),
            scale: 0.25,
            translation: DVec3::new(0.0, 4.0, 8.0),
        };
        let apply = |by: &Similarity, p: DVec3| by.rotation * (p * by.scale) + by.translation;
        let p = DVec3::new(0.3, 0.6, -0.9);
        let off = apply(&a.then(&b), p) - apply(&b, apply(&a, p));
        assert!(off.length() < 1e-14, "{off}");
        assert_eq!((a.then(&Similarity::IDENTITY), Similarity::IDENTITY.then(&b)), (a, b));
    }

    #[test]
    fn rotations_turn_the_right_way() {
        let quarter = rotation(DVec3::new(0.0, 0.0, 7.0), 90.0) * DVec3::X;
        assert!((quarter - DVec3::Y).length() < 1e-15, "{quarter}");
        let third = rotation(DVec3::ONE, 120.0) * DVec3::new(1.0, 2.0, 3.0);
        assert!((third - DVec3::new(3.0, 1.0, 2.0)).length() < 1e-14, "{third}");
    }

    #[test]
    fn what_is_no_similarity_is_refused() {
        let with = |rotation, scale, x| Similarity {
            rotation,
            scale,
            translation: DVec3::new(x, 0.0, 0.0),
        };
        let one = DMat3::IDENTITY;
        let mirror = DMat3::from_cols(-DVec3::X, DVec3::Y, DVec3::Z);
        let nothing = rotation(DVec3::ZERO, 30.0);
        for bad in [
            with(one, 0.0, 0.0),
            with(one, -1.0, 0.0),
            with(one, f64::INFINITY, 0.0),
            with(one, 1.0, f64::NAN),
            with(one * 1.001, 1.0, 0.0),
            with(mirror, 1.0, 0.0),
            with(nothing, 1.0, 0.0),
        ] {
            assert!(bad.check().is_err(), "{bad:?}");
        }
        assert!(with(rotation(DVec3::ONE, 12.0), 3.0, 1.0).check().is_ok());
    }
}
