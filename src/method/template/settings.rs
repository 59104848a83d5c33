//! The settings of the method.

use crate::error::{Error, Result};
use crate::setting::{Field, Fields, Slot, Visit, Words};
use crate::splat::culling;

/// The level at which a centre stays: the least l >= 0 at which its radius rho, in pixels, is at
/// most [`Settings::reach`]. Three rules are three readings of \[MOC08, eq. 1\], l = ceil(log2(D /
/// `t_s`)), where D is "the projected radius" and `t_s` the size of the template.
///
/// A cell of level l is found from every pixel within h 2^l pixels of any point in it, and not from
/// all within more. A rule whose reach is longer cuts ellipses. A rule whose reach is shorter makes
/// ellipses move on sooner; they then meet in cells that they do not cover, and are merged there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LevelRule {
    /// rho <= k 2^l: the paper's words, D = rho. Cuts a disc to half its radius or less.
    Radius,
    /// 2 rho <= k 2^l: D is the diameter, as in the program of the paper's authors. It is also "the
    /// level that fully covers \[the splat\] with a k x k template" (section 3.1), except for the
    /// half cell by which a centre may lie off the middle of its cell.
    Diameter,
    /// rho <= h 2^l, 2 h + 1 = k: the whole ellipse is found, wherever in its cell its centre lies
    /// \[MOC08, figure 3\].
    Covering,
    /// [`Self::Radius`] for k = 3, [`Self::Diameter`] for k = 5 and 7. `Decided:` this default, by
    /// measurement (bench `reconstruction`, 28 scenes in five sizes):
    ///
    /// - A template of 3 x 3 merges most. It has the fewest holes by the rule that moves least.
    /// - With 7 x 7 the diameter is best.
    /// - With 5 x 5 radius and diameter have as many holes in the mean. But the radius leaves a
    ///   pattern of holes in evenly sampled surfaces whose discs are just cut: up to 28 per mille
    ///   of a sphere's inside in one size of the picture, and none in the next.
    #[default]
    BySize,
}

/// The weights of the centres that a pixel gathers, by the elliptical distance d of the pixel from
/// each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Falloff {
    /// 1 - d \[MOC08, eq. 2\].
    #[default]
    Linear,
    /// exp(-2 d^2), the weight of [`crate::method::pyramid::Weights`]. \[MOC08, section 3.2\] tried
    /// it and reports that it "leaves clear silhouette traces", because the weight at the rim is
    /// 0.135 and not 0.
    Gaussian,
}

/// The settings of the method; each of them may change the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// k: 3, 5 or 7.
    pub size: u32,
    /// See [`LevelRule`].
    pub levels: LevelRule,
    /// See [`Falloff`].
    pub falloff: Falloff,
    /// Whether surfels seen from behind are dropped.
    pub cull: bool,
}

impl Default for Settings {
    /// 5 x 5, which \[MOC08, section 5\] finds sufficient.
    fn default() -> Self {
        Self { size: 5, levels: LevelRule::default(), falloff: Falloff::default(), cull: true }
    }
}

impl Fields for Settings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        let size = "set the width of the template";
        each(
            Field::new("template", size, Slot::Count(&mut self.size))
                .unit("cells")
                .range("3, 5 or 7"),
        );
        let levels = "choose the level of an ellipse: eq. 1 of its radius or its diameter \
                      (by-size: radius for 3, else diameter), or the level that covers it";
        each(Field::new("levels", levels, Slot::Word(&mut self.levels)));
        let falloff = "choose how the weight falls off from the centre of an ellipse";
        each(Field::new("falloff", falloff, Slot::Word(&mut self.falloff)));
        each(culling(&mut self.cull));
    }
}

impl Words for LevelRule {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("radius", Self::Radius),
        ("diameter", Self::Diameter),
        ("covering", Self::Covering),
        ("by-size", Self::BySize),
    ];
}

impl Words for Falloff {
    const WORDS: &'static [(&'static str, Self)] =
        &[("linear", Self::Linear), ("gaussian", Self::Gaussian)];
}

impl Settings {
    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the template is not 3, 5 or 7 cells wide.
    pub fn check(&self) -> Result<()> {
        if [3, 5, 7].contains(&self.size) {
            Ok(())
        } else {
            Err(Error::Invalid(format!("template: {} cells; give 3, 5 or 7", self.size)))
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
        let (radius, diameter) = (self.size as f32, self.size as f32 / 2.0);
        let cells = match self.levels {
            LevelRule::Radius => radius,
            LevelRule::Diameter => diameter,
            LevelRule::Covering => self.half() as f32,
            LevelRule::BySize if self.size == 3 => radius,
            LevelRule::BySize => diameter,
        };
        cells * (1_u32 << level) as f32
    }
}
