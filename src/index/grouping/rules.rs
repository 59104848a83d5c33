//! Rules that say which surfels may not share a group.

use crate::error::{Error, Result};
use crate::setting::{Field, Slot, Visit};

/// Which surfels may not share a group \[ZP06, section 4.1\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// c: surfels conflict if `|p_i - p_j| < c (r_i + r_j)`. In [0, 1].
    pub overlap: f32,
    /// Whether surfels with `n_i . n_j < 0` never conflict (the paper's modification 2).
    pub opposite: bool,
    /// Which surfels are virtually co-planar and so never conflict (modification 1); none means
    /// that any may conflict.
    pub coplanar: Option<Coplanar>,
}

/// When two surfels count as virtually co-planar and as one colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coplanar {
    /// The least `n_i . n_j`. In [0, 1].
    pub cosine: f32,
    /// The largest distance of either centre from the other's plane, as a part of `r_i + r_j`. In
    /// [0, 1].
    pub offset: f32,
    /// The largest difference of any component of the colours. In [0, inf].
    pub color: f32,
}

impl Default for Rules {
    /// c = 1, no modification: groups do not overlap.
    fn default() -> Self {
        Self { overlap: 1.0, opposite: false, coplanar: None }
    }
}

impl Rules {
    /// The rows of the rules.
    pub(super) fn fields(&mut self, each: &mut Visit<'_>) {
        let overlap = "set c: splats nearer than c times their radii go into different groups";
        each(Field::new("overlap", overlap, Slot::Number(&mut self.overlap)).range("0 to 1"));
        let opposite = "let splats that face opposite ways share a group";
        each(Field::new("opposite", opposite, Slot::Switch(&mut self.opposite)));
        let mut parts =
            self.coplanar.map(|Coplanar { cosine, offset, color }| [cosine, offset, color]);
        let coplanar = "let splats of one plane share a group: least cosine of the normals, \
                        largest distance from each other's plane in sums of their radii, largest \
                        difference of colours";
        let names = ["cosine", "offset", "color"];
        each(
            Field::new("coplanar", coplanar, Slot::Parts(&mut parts, names))
                .range("0 to 1, 0 to 1 and 0 to inf"),
        );
        self.coplanar = parts.map(|[cosine, offset, color]| Coplanar { cosine, offset, color });
    }

    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if one is not.
    pub fn check(&self) -> Result<()> {
        let unit = 0.0..=1.0;
        if !unit.contains(&self.overlap) {
            let what = format!("overlap: c = {}; give 0 to 1", self.overlap);
            return Err(Error::Invalid(what));
        }
        let Some(Coplanar { cosine, offset, color }) = self.coplanar else { return Ok(()) };
        if unit.contains(&cosine) && unit.contains(&offset) && color >= 0.0 {
            Ok(())
        } else {
            let what = format!(
                "coplanar: cosine {cosine}, offset {offset}, color {color}; give 0 to 1, 0 to 1, \
                 and a number >= 0"
            );
            Err(Error::Invalid(what))
        }
    }
}
