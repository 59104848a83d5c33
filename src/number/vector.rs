//! Small vectors over [`Real`] with a written-out order of operations.
//!
//! glam serves the public interface (positions, matrices). The arithmetic that defines pictures is
//! spelled out here, so that its bits are part of the specification.

use super::Real;
use std::ops::{Add, Mul, Neg, Sub};

/// Two components; on the screen x points right and y down, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector2<R> {
    /// First component.
    pub x: R,
    /// Second component.
    pub y: R,
}

/// Three components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector3<R> {
    /// First component.
    pub x: R,
    /// Second component.
    pub y: R,
    /// Third component.
    pub z: R,
}

impl<R> Vector2<R> {
    /// The vector (x, y).
    #[inline(always)]
    pub const fn new(x: R, y: R) -> Self {
        Self { x, y }
    }

    /// Converts each component to another number.
    #[inline(always)]
    #[must_use]
    pub fn map<S>(self, f: impl Fn(R) -> S) -> Vector2<S> {
        Vector2::new(f(self.x), f(self.y))
    }
}

impl<R> Vector3<R> {
    /// The vector (x, y, z).
    #[inline(always)]
    pub const fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }

    /// Converts each component to another number.
    #[inline(always)]
    #[must_use]
    pub fn map<S>(self, f: impl Fn(R) -> S) -> Vector3<S> {
        Vector3::new(f(self.x), f(self.y), f(self.z))
    }
}

impl<R: Real> Vector3<R> {
    /// The null vector.
    pub const ZERO: Self = Self::new(R::ZERO, R::ZERO, R::ZERO);

    /// The components of a glam vector, exactly.
    #[inline(always)]
    #[must_use]
    pub fn from_glam(v: glam::Vec3) -> Self {
        Self::new(R::from_f32(v.x), R::from_f32(v.y), R::from_f32(v.z))
    }

    /// `(x x' + y y') + z z'`.
    #[inline(always)]
    #[must_use]
    pub fn dot(self, v: Self) -> R {
        (self.x * v.x + self.y * v.y) + self.z * v.z
    }

    /// `(y z' - z y', z x' - x z', x y' - y x')`.
    #[inline(always)]
    #[must_use]
    pub fn cross(self, v: Self) -> Self {
        Self::new(
            self.y * v.z - self.z * v.y,
            self.z * v.x - self.x * v.z,
            self.x * v.y - self.y * v.x,
        )
    }

    /// `sqrt(dot(self, self))`.
    #[inline(always)]
    #[must_use]
    pub fn length(self) -> R {
        self.dot(self).sqrt()
    }

    /// Each component divided by the length; the null vector if the length is 0 or not finite.
    #[inline(always)]
    #[must_use]
    pub fn normalized(self) -> Self {
        let length = self.length();
        let some = length.gt(R::ZERO) & length.is_finite();
        Self::new(
            part(some, self.x, length),
            part(some, self.y, length),
            part(some, self.z, length),
        )
    }
}

/// A component of a unit vector. It is not a closure, because a closure would not be inlined where
/// numbers are balls.
#[inline(always)]
fn part<R: Real>(some: R::Truth, component: R, length: R) -> R {
    R::select(some, component / length, R::ZERO)
}

impl<R: Real> Add for Vector3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, v: Self) -> Self {
        Self::new(self.x + v.x, self.y + v.y, self.z + v.z)
    }
}

impl<R: Real> Sub for Vector3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, v: Self) -> Self {
        Self::new(self.x - v.x, self.y - v.y, self.z - v.z)
    }
}

impl<R: Real> Mul<R> for Vector3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: R) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl<R: Real> Neg for Vector3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
