//! Focal lengths and principal points in pixels, of a picture of a certain size.
//!
//! Pixels are counted as in [`super`]: (0, 0) is the upper left corner of the picture, and the
//! centre of the first pixel is (0.5, 0.5). COLMAP, nerfstudio and Blender count like this.
//!
//! In f64, each operation rounded; [`super::Camera`] gets the results rounded to `f32` once:
//!
//! ```text
//!   in a picture of W' x H', not W x H    f.x W' / W    f.y H' / H    c.x W' / W    c.y H' / H
//!   an angle a that the width W spans     (W / 2) / tan(a / 2)
//! ```
//!
//! A product is taken before the quotient. In a picture of the same size, nothing is computed.

use super::{Camera, Lens, Projection};
use crate::error::{Error, Result};
use crate::number::elementary;
use std::f64::consts::PI;

/// The opening of a camera in pixels, see the [module](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// The size of the picture that the other numbers belong to.
    pub size: [u32; 2],
    /// What `f` scales.
    pub projection: Projection,
    /// Focal lengths in pixels, or pixels per world unit: horizontal, vertical.
    pub f: [f64; 2],
    /// The principal point in pixels: column, row.
    pub c: [f64; 2],
}

impl Intrinsics {
    /// A perspective opening with the principal point in the middle.
    #[must_use]
    pub fn centered(size: [u32; 2], f: [f64; 2]) -> Self {
        let c = size.map(|side| f64::from(side) / 2.0);
        Self { size, projection: Projection::Perspective, f, c }
    }

    /// The focal length in pixels of an angle that a side of the picture spans.
    ///
    /// # Errors
    /// [`Error::Invalid`] unless the angle is in (0, PI).
    pub fn focal(side: u32, radians: f64) -> Result<f64> {
        if !(radians > 0.0 && radians < PI) {
            let what = format!("camera: an angle of {radians} radians; give one in (0, pi)");
            return Err(Error::Invalid(what));
        }
        Ok(f64::from(side) / 2.0 / elementary::tan(radians / 2.0))
    }

    /// The same opening in a picture of another size.
    #[must_use]
    pub fn resized(self, size: [u32; 2]) -> Self {
        if size == self.size {
            return self;
        }
        let by = |v: [f64; 2]| {
            let side = |i: usize| v[i] * f64::from(size[i]) / f64::from(self.size[i]);
            [side(0), side(1)]
        };
        Self { size, f: by(self.f), c: by(self.c), ..self }
    }

    /// The lens to place a camera with, so that it shows a scene: the lesser focal length, and the
    /// principal point in the middle.
    #[must_use]
    pub fn lens(&self) -> Lens {
        let [x, y] = self.f;
        let scale = if x < y { x } else { y };
        match self.projection {
            Projection::Perspective => Lens::Focal(scale),
            Projection::Orthographic => Lens::Orthographic(f64::from(self.size[1]) / scale),
        }
    }

    /// The camera with this opening in place of its own.
    #[must_use]
    pub fn on(&self, camera: Camera) -> Camera {
        let ([width, height], [fx, fy], [cx, cy]) =
            (self.size, self.f.map(|f| f as f32), self.c.map(|c| c as f32));
        Camera { width, height, projection: self.projection, fx, fy, cx, cy, ..camera }
    }
}
