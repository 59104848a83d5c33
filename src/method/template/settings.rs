//! What may change the picture.

use crate::error::{Error, Result};
use crate::setting::{Field, Fields, Slot, Visit, Words};
use crate::splat::culling;

/// The level at which a centre stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LevelRule {
    /// The least l >= 0 with rho <= h 2^l: a cell of level l is found from every pixel within h 2^l
    /// pixels of any point in it, so that the whole ellipse is found. But an ellipse that has just
    /// left a level shares a cell of the next with others that it does not cover, and is merged
    /// with them: a sampling of large or tilted discs gets holes (with k = 3 always, with k = 5
    /// from a tilt of 45 degrees on, with k = 7 from 62).
    Covering,
    /// The least l >= 0 with rho <= k 2^l, which is \[MOC08, eq. 1\], l = ceil(log2(D / `t_s`)), D
    /// being "the projected radius" and `t_s` the size of the template. It cuts ellipses:
    /// guaranteed is a distance of h 2^l only, half the radius or less. Surfaces have fewer holes
    /// by it nevertheless, since discs overlap and fewer are merged.
    #[default]
    Published,
}

/// What is computed; everything here may change the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// k: 3, 5 or 7.
    pub size: u32,
    /// See [`LevelRule`].
    pub levels: LevelRule,
    /// Whether surfels seen from behind are dropped.
    pub cull: bool,
}

impl Default for Settings {
    /// 5 x 5, which \[MOC08, section 5\] finds sufficient.
    fn default() -> Self {
        Self { size: 5, levels: LevelRule::default(), cull: true }
    }
}

impl Fields for Settings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        let size = "width of the template";
        each(
            Field::new("template", size, Slot::Count(&mut self.size))
                .unit("cells")
                .range("3, 5 or 7"),
        );
        let levels = "the level of an ellipse: the one that covers it, or that of the paper";
        each(Field::new("levels", levels, Slot::Word(&mut self.levels)));
        each(culling(&mut self.cull));
    }
}

impl Words for LevelRule {
    const WORDS: &'static [(&'static str, Self)] =
        &[("covering", Self::Covering), ("published", Self::Published)];
}

impl Settings {
    /// Whether the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the template is not 3, 5 or 7 cells wide.
    pub fn check(&self) -> Result<()> {
        if [3, 5, 7].contains(&self.size) {
            Ok(())
        } else {
            Err(Error::Invalid(format!("template: a size of {}; give 3, 5 or 7", self.size)))
        }
    }

    /// h: how many cells the template reaches to every side.
    #[must_use]
    pub fn half(&self) -> u32 {
        (self.size - 1) / 2
    }

    /// The largest radius in pixels that stays at a level, exactly.
    #[must_use]
    pub fn reach(&self, level: usize) -> f32 {
        let cells = match self.levels {
            LevelRule::Covering => self.half(),
            LevelRule::Published => self.size,
        };
        cells as f32 * (1_u32 << level) as f32
    }
}
