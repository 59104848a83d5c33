//! The settings of the method.

use crate::error::Result;
use crate::frame::raster::Snap;
use crate::setting::{Field, Fields, Slot, Visit, Words};
use crate::splat::culling;

/// The weights of the cells that a pixel is interpolated from \[MKC08, section 3.3, Fig. 4\].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Weights {
    /// 1 inside the ellipse.
    Box,
    /// exp(-2 d^2) inside the ellipse, d the elliptical distance. `Decided:` the rim is two
    /// standard deviations from the centre, as it is by default for every splat of the crate.
    #[default]
    Gaussian,
}

/// When a cell that is not empty counts as occluded, by the interval [front, back] of its parent,
/// the cell of the next coarser level that it is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Occlusion {
    /// front > parent's back. `Departs:` by the words of the paper a cell in *front* of its
    /// parent's interval is "occluded" too. Then the surface behind would overwrite a triangle or a
    /// thin ribbon, which takes no part in the coarser level, against section 5.1.
    #[default]
    Behind,
    /// front > parent's back, or front < parent's front: the words of \[MKC08, section 3.3\].
    Outside,
}

/// The settings of the method; each of them may change the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// See [`Weights`].
    pub weights: Weights,
    /// See [`Occlusion`].
    pub occlusion: Occlusion,
    /// Whether surfels and triangles seen from behind are dropped.
    pub cull: bool,
    /// Binary digits after the point of the corners of triangles and lines, see [`Snap`].
    pub subpixel_bits: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            weights: Weights::default(),
            occlusion: Occlusion::default(),
            cull: true,
            subpixel_bits: 8,
        }
    }
}

impl Fields for Settings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        let weights = "choose the interpolation weights within an ellipse";
        each(Field::new("weights", weights, Slot::Word(&mut self.weights)));
        let occluded = "treat a cell as occluded if it lies behind the depths of its parent, or \
                        also if it lies in front of them";
        each(Field::new("occluded", occluded, Slot::Word(&mut self.occlusion)));
        each(culling(&mut self.cull));
        let bits = "snap the corners of triangles and lines to this many sub-pixel bits";
        each(
            Field::new("subpixel_bits", bits, Slot::Count(&mut self.subpixel_bits))
                .range("0 to 12"),
        );
    }
}

impl Words for Weights {
    const WORDS: &'static [(&'static str, Self)] =
        &[("box", Self::Box), ("gaussian", Self::Gaussian)];
}

impl Words for Occlusion {
    const WORDS: &'static [(&'static str, Self)] =
        &[("behind", Self::Behind), ("outside", Self::Outside)];
}

impl Settings {
    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] as [`Snap::new`].
    pub fn check(&self) -> Result<()> {
        Snap::new(self.subpixel_bits).map(|_| ())
    }
}
