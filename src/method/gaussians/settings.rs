//! The settings of the method.

use crate::error::{Error, Result};
use crate::setting::{Field, Fields, Slot, Visit, Words};
use crate::splat::gaussian::{Clamp, Compensation, GaussianKernel};
use crate::splat::ray_disc::DiscRule;

/// The settings of the method; each of them may change the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// How a Gaussian becomes an ellipse.
    pub kernel: GaussianKernel,
    /// The greatest degree of the spherical harmonics that is used: 0 to 3.
    pub degree: u32,
    /// How colours are bounded before they are blended.
    pub bounds: ColorBounds,
    /// The order of blending.
    pub order: Order,
    /// The pixels that a splat may touch.
    pub support: Support,
    /// The radius of [`Support`] in standard deviations, and that of a surfel: 0.25 to 4.
    pub cutoff: f32,
    /// The alpha below which a fragment is skipped: 0 to 1.
    pub least_alpha: f32,
    /// The greatest alpha of a fragment: above 0 to 1.
    pub most_alpha: f32,
    /// Blending ends before the fragment that takes the transmittance below this: 0 to 1.
    pub stop: f32,
    /// Whether it also ends where the transmittance becomes [`Settings::stop`] itself, if that is not
    /// 0.
    pub stop_at: bool,
    /// The space in which colours are blended.
    pub blend: BlendSpace,
}

/// How a colour is bounded after the spherical harmonics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorBounds {
    /// Not at all.
    None,
    /// A component below 0 becomes 0.
    Zero,
    /// Components are bounded to [0, 1].
    Unit,
}

/// The order of blending, from front to back; ties go to the lower index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// By the depth t of the centre, one order for the picture.
    Depth,
    /// By the distance of the centre from the camera's centre, one order for the picture. Under an
    /// orthographic camera by t.
    Distance,
    /// By the distance in 65,536 equal steps from the least to the greatest of the splats drawn:
    /// those that are neither behind nor degenerate, and whose bounds hold a pixel of the picture.
    Steps,
    /// At each pixel by the depth at which the density along its ray is greatest.
    Pixel,
}

/// The pixels that a splat may touch, beside the rule for small alphas. e is an extent in px.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// Every pixel.
    None,
    /// Pixels with q <= k k.
    Ellipse,
    /// All tiles of 16 x 16 pixels that a square touches, as in the original program: e = ceil(k
    /// sqrt(m + sqrt(max(0.1, m m - det V)))) with m = (Vxx + Vyy) / 2, and tiles floor((X - 1/2 - e)
    /// / 16) to floor((X + e - 3/2) / 16). Tile i has the columns 16 i <= x < 16 i + 16, and so for
    /// rows.
    Tiles,
    /// All tiles of 16 x 16 pixels that a box touches, as in gsplat: ex = ceil(k' sqrt(Vxx)), ey =
    /// ceil(k' sqrt(Vyy)) with k' = sqrt(2 ln(255 o)), at most k, and o after compensation.
    Boxes,
}

/// The space in which colours are blended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlendSpace {
    /// As the scene stores them.
    Stored,
    /// Linear light: sRGB colours are decoded first.
    Linear,
    /// sRGB: linear colours are encoded first.
    Srgb,
}

impl Words for ColorBounds {
    const WORDS: &'static [(&'static str, Self)] =
        &[("none", Self::None), ("zero", Self::Zero), ("unit", Self::Unit)];
}

impl Words for Order {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("depth", Self::Depth),
        ("distance", Self::Distance),
        ("steps", Self::Steps),
        ("pixel", Self::Pixel),
    ];
}

impl Words for Support {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("none", Self::None),
        ("ellipse", Self::Ellipse),
        ("tiles", Self::Tiles),
        ("boxes", Self::Boxes),
    ];
}

impl Words for BlendSpace {
    const WORDS: &'static [(&'static str, Self)] =
        &[("stored", Self::Stored), ("linear", Self::Linear), ("srgb", Self::Srgb)];
}

impl Words for Settings {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("khr", Self::KHR),
        ("inria", Self::INRIA),
        ("gsplat", Self::GSPLAT),
        ("mip", Self::MIP),
        ("exact", Self::EXACT),
        ("2dgs", Self::DISCS),
    ];

    fn is(&self, other: &Self) -> bool {
        self == other
    }
}

/// 1/255, rounded to `f32`: the least alpha that 8 bits can hold.
const CODE: f32 = 1.0 / 255.0;

impl Settings {
    /// The original program of 2023, as its CUDA rasterizer draws.
    pub const INRIA: Self = Self {
        kernel: GaussianKernel {
            disc: DiscRule::Projected,
            near: 0.2,
            clamp: Clamp::Fov,
            low_pass: 0.3,
            compensation: Compensation::None,
        },
        degree: 3,
        bounds: ColorBounds::Zero,
        order: Order::Depth,
        support: Support::Tiles,
        cutoff: 3.0,
        least_alpha: CODE,
        most_alpha: 0.99,
        stop: 1e-4,
        stop_at: false,
        blend: BlendSpace::Stored,
    };

    /// gsplat 1.5.3. `Decided:` a Gaussian at the depth of 0.01 itself is not drawn, and one beyond
    /// 1e10 is; gsplat does the reverse.
    pub const GSPLAT: Self = Self {
        kernel: GaussianKernel { near: 0.01, clamp: Clamp::Edges, ..Self::INRIA.kernel },
        support: Support::Boxes,
        cutoff: 3.33,
        most_alpha: 0.999,
        stop_at: true,
        ..Self::INRIA
    };

    /// The review draft of `KHR_gaussian_splatting`, which says nothing about a low-pass filter:
    /// `Decided:` 0.3 px^2, with which splats are trained.
    pub const KHR: Self = Self {
        kernel: GaussianKernel { near: 0.0, clamp: Clamp::None, ..Self::INRIA.kernel },
        bounds: ColorBounds::None,
        order: Order::Distance,
        support: Support::Ellipse,
        least_alpha: 0.0,
        most_alpha: 1.0,
        stop: 0.0,
        ..Self::INRIA
    };

    /// The original program with the filter of Mip-Splatting (Yu et al. 2024): 0.1 px^2, compensated.
    pub const MIP: Self = Self {
        kernel: GaussianKernel {
            low_pass: 0.1,
            compensation: Compensation::Mip,
            ..Self::INRIA.kernel
        },
        ..Self::INRIA
    };

    /// What the others approximate: each pixel has its own order, alphas from 1/1024 count, nothing is
    /// clamped, and blending does not end early.
    pub const EXACT: Self = Self {
        kernel: GaussianKernel { near: 0.0, clamp: Clamp::None, ..Self::INRIA.kernel },
        order: Order::Pixel,
        support: Support::None,
        least_alpha: 1.0 / 1024.0,
        most_alpha: 1.0,
        stop: 0.0,
        ..Self::INRIA
    };

    /// The program of 2D Gaussian splatting (Huang et al. 2024): the original program, but for discs
    /// that meet the rays of pixels.
    pub const DISCS: Self = Self {
        kernel: GaussianKernel { disc: DiscRule::RayBox, low_pass: 0.5, ..Self::INRIA.kernel },
        ..Self::INRIA
    };

    /// Whether discs meet the rays of pixels.
    pub(crate) fn meets_rays(&self) -> bool {
        self.kernel.disc != DiscRule::Projected
    }

    /// Checks that the numbers are in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if one is not, or if nothing bounds a splat.
    pub fn check(&self) -> Result<()> {
        let within = |name: &str, value: f32, [low, high]: [f32; 2], range: &str| {
            if value >= low && value <= high {
                Ok(())
            } else {
                Err(Error::Invalid(format!("gaussians: {name} = {value}; give {range}")))
            }
        };
        let least = f32::from_bits(1);
        within("near_depth", self.kernel.near, [0.0, 1e6], "0 to 1000000")?;
        within("low_pass", self.kernel.low_pass, [0.0, 16.0], "0 to 16")?;
        within("cutoff", self.cutoff, [0.25, 4.0], "0.25 to 4")?;
        within("least_alpha", self.least_alpha, [0.0, 1.0], "0 to 1")?;
        within("most_alpha", self.most_alpha, [least, 1.0], "above 0 to 1")?;
        within("stop", self.stop, [0.0, 1.0], "0 to 1")?;
        if self.degree > crate::scene::gaussians::MAX_DEGREE {
            let what = format!("gaussians: degree = {}; give 0 to 3", self.degree);
            return Err(Error::Invalid(what));
        }
        if self.support == Support::None && self.least_alpha == 0.0 {
            let what = "gaussians: nothing bounds a splat; give support = \"ellipse\", or a least_alpha \
                        above 0";
            return Err(Error::Invalid(what.into()));
        }
        Ok(())
    }
}

impl Default for Settings {
    /// The original program: files are trained with it.
    fn default() -> Self {
        Self::INRIA
    }
}

impl Fields for Settings {
    fn fields(&mut self, each: &mut Visit<'_>) {
        let preset = "choose whose picture it is: the draft of glTF, the original program, gsplat, the \
                      original with the filter of Mip-Splatting, what they all approximate, or the \
                      program of 2D Gaussian splatting";
        let mut chosen = *self;
        each(Field::new("preset", preset, Slot::Preset(&mut chosen)));
        *self = chosen;
        self.shapes(each);
        self.blending(each);
    }
}

impl Settings {
    /// The rows of projection and colour.
    fn shapes(&mut self, each: &mut Visit<'_>) {
        let Self { kernel, degree, bounds, .. } = self;
        let disc = "draw ellipses of all three axes, or discs that the pixels' rays meet: as in the \
                    paper of 2D Gaussian splatting, or as in its program";
        each(Field::new("disc", disc, Slot::Word(&mut kernel.disc)));
        let rays = kernel.disc != DiscRule::Projected;
        let (mut other, mut none) = (Self::INRIA.kernel.clamp, Self::INRIA.kernel.compensation);
        if rays {
            // What has no effect has its default, so that equal pictures have equal settings.
            (kernel.clamp, kernel.compensation) = (other, none);
        }
        let idle = "with discs that meet rays";
        let near = "drop Gaussians up to this depth; 0 for the camera's near plane";
        each(
            Field::new("near_depth", near, Slot::Number(&mut kernel.near))
                .unit("world units")
                .range("0 to 1000000"),
        );
        let clamp = "bound x/t and y/t in the Jacobian: not at all, to 1.3 times half the field of \
                     view, or to the picture's edges and 0.3 times that beyond";
        let slot = Slot::Word(if rays { &mut other } else { &mut kernel.clamp });
        let field = Field::new("clamp", clamp, slot);
        each(if rays { field.idle(idle) } else { field });
        let variance = "set the variance of the low-pass filter";
        each(
            Field::new("low_pass", variance, Slot::Number(&mut kernel.low_pass))
                .unit("px^2")
                .range("0 to 16"),
        );
        let compensation = "multiply opacities by sqrt(det V0 / det V), so that the low-pass filter \
                            adds no light; floor: by 0.005 at least; mip: as Mip-Splatting does";
        let slot = Slot::Word(if rays { &mut none } else { &mut kernel.compensation });
        let field = Field::new("compensation", compensation, slot);
        each(if rays { field.idle(idle) } else { field });
        let harmonics = "use spherical harmonics up to this degree";
        each(Field::new("degree", harmonics, Slot::Count(degree)).range("0 to 3"));
        let colors = "bound colours before blending: not at all, from 0, or to 0 to 1";
        each(Field::new("color_bounds", colors, Slot::Word(bounds)));
    }

    /// The rows of blending.
    fn blending(&mut self, each: &mut Visit<'_>) {
        let (no_stop, stop_at_zero) = (self.stop == 0.0, "without a stop");
        let order = "blend by depth, by distance, by distance in 65,536 steps, or in an order of each \
                     pixel's own";
        each(Field::new("order", order, Slot::Word(&mut self.order)));
        let support = "bound a splat: not at all, by an ellipse, by the tiles of the original program, \
                       or by those of gsplat";
        each(Field::new("support", support, Slot::Word(&mut self.support)));
        each(
            Field::new(
                "cutoff",
                "cut the kernel off at this radius",
                Slot::Number(&mut self.cutoff),
            )
            .unit("standard deviations")
            .range("0.25 to 4"),
        );
        let least = "skip fragments with less alpha";
        each(Field::new("least_alpha", least, Slot::Number(&mut self.least_alpha)).range("0 to 1"));
        let most = "bound the alpha of a fragment from above";
        each(
            Field::new("most_alpha", most, Slot::Number(&mut self.most_alpha))
                .range("above 0 to 1"),
        );
        let stop = "end before the fragment that takes the transmittance below this; 0 for never";
        each(Field::new("stop", stop, Slot::Number(&mut self.stop)).range("0 to 1"));
        let at = "end where the transmittance becomes that of `stop` itself, too";
        let field = Field::new("stop_at", at, Slot::Switch(&mut self.stop_at));
        each(if no_stop { field.idle(stop_at_zero) } else { field });
        let space = "blend colours as they are stored, or as linear light, or as sRGB";
        each(Field::new("blend", space, Slot::Word(&mut self.blend)));
    }
}
