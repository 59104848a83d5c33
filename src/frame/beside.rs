//! Join frames that lie side by side.

use super::{Frame, NamedPlane, Plane, Samples};
use crate::error::{Error, Result};

impl<R: Copy> Frame<R> {
    /// This frame with another to its right.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the two differ in height, or in the names or the kinds of their planes.
    ///
    /// ```
    /// use splatref::frame::{Frame, Plane, Samples};
    ///
    /// let depths = |width, value| Samples::Scalar(Plane::filled(width, 1, value));
    /// let left = Frame::new(2, 1).with("Z", depths(2, 1.0_f32))?;
    /// let right = Frame::new(1, 1).with("Z", depths(1, 5.0_f32))?;
    /// assert_eq!(left.beside(&right)?.scalar("Z")?.values(), [1.0, 1.0, 5.0]);
    /// # Ok::<(), splatref::Error>(())
    /// ```
    pub fn beside(&self, right: &Self) -> Result<Self> {
        let named = |frame: &Self| -> Vec<_> {
            let kinds = frame.planes.iter();
            kinds.map(|p| (p.name.clone(), std::mem::discriminant(&p.samples))).collect()
        };
        if self.height != right.height || named(self) != named(right) {
            let what = "frames side by side must have one height and the same planes";
            return Err(Error::Invalid(what.into()));
        }
        let planes = self.planes.iter().zip(&right.planes).map(|(one, other)| NamedPlane {
            name: one.name.clone(),
            samples: match (&one.samples, &other.samples) {
                (Samples::Scalar(a), Samples::Scalar(b)) => Samples::Scalar(joined(a, b)),
                (Samples::Color(a), Samples::Color(b)) => Samples::Color(joined(a, b)),
                (Samples::Vector(a), Samples::Vector(b)) => Samples::Vector(joined(a, b)),
                (Samples::Index(a), Samples::Index(b)) => Samples::Index(joined(a, b)),
                (Samples::Count(a), Samples::Count(b)) => Samples::Count(joined(a, b)),
                // Their kinds are the same.
                (other, _) => other.clone(),
            },
        });
        let planes = planes.collect();
        Ok(Self { width: self.width + right.width, height: self.height, planes })
    }
}

fn joined<T: Copy>(left: &Plane<T>, right: &Plane<T>) -> Plane<T> {
    let size = [left.width() + right.width(), left.height()];
    Plane::from_pixels(size, |x, y| match x.checked_sub(left.width()) {
        None => *left.at(x, y),
        Some(x) => *right.at(x, y),
    })
}
