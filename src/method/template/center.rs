//! The centre of an ellipse that a level stores for each of its cells.

use crate::frame::NO_ID;
use crate::method::projection::{PixelSample, SampleKind};
use crate::number::{Real, Vector2, Vector3};

/// The centre of an ellipse in a cell of a level; view space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Center<R> {
    /// The surfel; if several were merged, the foremost; [`NO_ID`] in an empty cell.
    pub id: u32,
    /// Depth t in world units; +inf in an empty cell.
    pub depth: R,
    /// Radius r in world units.
    pub radius: R,
    /// Radius rho in pixels.
    pub extent: R,
    /// Position in the picture, in pixels.
    pub center: Vector2<R>,
    /// Normal, of any length.
    pub normal: Vector3<R>,
    /// Linear RGB.
    pub color: [R; 3],
}

impl<R> Center<R> {
    /// Converts each number to another arithmetic.
    #[must_use]
    pub fn map<S>(self, f: impl Fn(R) -> S) -> Center<S> {
        Center {
            id: self.id,
            depth: f(self.depth),
            radius: f(self.radius),
            extent: f(self.extent),
            center: self.center.map(&f),
            normal: self.normal.map(&f),
            color: self.color.map(&f),
        }
    }
}

impl<R: Real> Center<R> {
    /// An empty cell: all numbers but depth and id are 0.
    #[must_use]
    pub fn empty() -> Self {
        Self {
            id: NO_ID,
            depth: R::INFINITY,
            radius: R::ZERO,
            extent: R::ZERO,
            center: Vector2::new(R::ZERO, R::ZERO),
            normal: Vector3::ZERO,
            color: [R::ZERO; 3],
        }
    }

    /// A centre of level 0.
    #[must_use]
    pub fn new(sample: &PixelSample<R>) -> Self {
        if sample.kind == SampleKind::Empty {
            return Self::empty();
        }
        Self {
            id: sample.id,
            depth: sample.depth,
            radius: sample.radius,
            extent: sample.extent,
            center: sample.center,
            normal: sample.normal,
            color: sample.color,
        }
    }

    /// Whether there is a centre.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.id != NO_ID
    }
}
