//! The settings of the method.

use crate::setting::{Fields, Visit};
use crate::splat::culling;

/// The settings of the method; each of them may change the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Whether surfels and triangles seen from behind are dropped.
    pub cull: bool,
}

impl Default for Settings {
    /// Culling is on, as in the other methods of opaque surfaces.
    fn default() -> Self {
        Self { cull: true }
    }
}

impl Fields for Settings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        each(culling(&mut self.cull));
    }
}
