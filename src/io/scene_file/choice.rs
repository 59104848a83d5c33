//! The method and its groups as far as they were chosen, and the defaults for the rest.

use crate::error::{Error, Result};
use crate::index::grouping::{Coplanar, Extension, Grouping, Rules};
use crate::method::ewa::{self, Epsilon};
use crate::method::pyramid::{self, Occlusion, Weights};
use crate::method::single_pass::{self, BinCount, DepthTest};
use crate::method::template::{self, LevelRule};
use crate::method::transparent::{self, Holes};
use crate::method::{Method, peeling};
use crate::shade::optics::{BendingLayers, Refraction};
use crate::splat::{Kernel, Outline};

/// A method by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MethodName {
    /// `ewa`: 2+1 passes.
    #[default]
    Ewa,
    /// `single-pass`: Algorithm 1 of \[ZP06\].
    SinglePass,
    /// `transparent`: Algorithm 2 of \[ZP06\].
    Transparent,
    /// `transparent-hq`: Algorithm 3 of \[ZP06\].
    TransparentHq,
    /// `peeling`: depth peeling.
    Peeling,
    /// `pyramid`: pull-push interpolation \[MKC08\].
    Pyramid,
    /// `template`: reconstruction with templates \[MOC08\].
    Template,
}

impl MethodName {
    /// The name of a method.
    #[must_use]
    pub fn of(method: &Method) -> Self {
        match method {
            Method::Ewa(_) => Self::Ewa,
            Method::SinglePass(_) => Self::SinglePass,
            Method::Transparent(transparent::Settings { nearest: None, .. }) => Self::Transparent,
            Method::Transparent(_) => Self::TransparentHq,
            Method::Peeling(_) => Self::Peeling,
            Method::Pyramid(_) => Self::Pyramid,
            Method::Template(_) => Self::Template,
        }
    }
}

/// Settings as far as they were chosen; one that its method does not have is refused.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MethodChoice {
    /// Which method.
    pub name: Option<MethodName>,
    /// A preset; the three that follow replace parts of it.
    pub kernel: Option<Kernel>,
    /// See [`Kernel`].
    pub outline: Option<Outline>,
    /// See [`Kernel`].
    pub cutoff: Option<f32>,
    /// See [`Kernel`].
    pub low_pass: Option<f32>,
    /// See [`ewa::Settings`].
    pub epsilon: Option<Epsilon>,
    /// See [`ewa::Settings`].
    pub cull: Option<bool>,
    /// Whether groups keep what is nearest to its own centre, [`DepthTest::Voronoi`]; yes if
    /// absent.
    pub voronoi: Option<bool>,
    /// How many depth bins, see [`BinCount`]; as epsilon has it if absent.
    pub bins: Option<u32>,
    /// See [`transparent::Settings`].
    pub holes: Option<Holes>,
    /// Ratios of refraction, see [`Refraction`]; none are bent by if absent.
    pub refraction: Option<[f32; 3]>,
    /// How many layers bend; [`BendingLayers::Multiple`] if absent.
    pub bends: Option<BendingLayers>,
    /// The most layers that are peeled, see [`peeling::Settings`].
    pub peel: Option<u32>,
    /// See [`pyramid::Settings`].
    pub weights: Option<Weights>,
    /// See [`pyramid::Settings`].
    pub occluded: Option<Occlusion>,
    /// See [`pyramid::Settings`].
    pub subpixel_bits: Option<u32>,
    /// How wide the template is, see [`template::Settings`].
    pub template: Option<u32>,
    /// See [`template::Settings`].
    pub levels: Option<LevelRule>,
}

/// How groups are extended, without its parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExtensionChoice {
    /// See [`Extension::None`].
    None,
    /// See [`Extension::Add`].
    Add,
    /// See [`Extension::Enlarge`].
    Enlarge,
}

impl ExtensionChoice {
    /// With its parameter, [`DEFAULT_MOST`] if there is none.
    #[must_use]
    pub fn extension(self, most: Option<f32>) -> Extension {
        match self {
            Self::None => Extension::None,
            Self::Add => Extension::Add { most: most.unwrap_or(DEFAULT_MOST) },
            Self::Enlarge => Extension::Enlarge,
        }
    }
}

/// Groups as far as they were chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GroupChoice {
    /// See [`Rules::overlap`].
    pub overlap: Option<f32>,
    /// See [`Rules::opposite`]; true if absent.
    pub opposite: Option<bool>,
    /// See [`Rules::coplanar`]; none if absent.
    pub coplanar: Option<Coplanar>,
    /// The most groups; the overlap is then the largest that gives so few.
    pub count: Option<usize>,
    /// See [`Extension`].
    pub extension: Option<ExtensionChoice>,
    /// See [`Extension::Add`]; [`DEFAULT_MOST`] if absent.
    pub most: Option<f32>,
}

/// c of single-pass rendering if nobody says: what \[ZP06, section 6.1\] finds acceptable.
pub const DEFAULT_OVERLAP: f32 = 0.4;
/// K of transparency if nobody says: what \[ZP06, section 6.2\] finds sufficient.
pub const DEFAULT_TRANSPARENT_GROUPS: usize = 4;
/// How far a surfel may be covered that is added to a group, if nobody says.
pub const DEFAULT_MOST: f32 = 0.5;

impl MethodChoice {
    /// The method: what was chosen, and the defaults for the rest.
    ///
    /// # Errors
    /// [`Error::Invalid`] if something was chosen that the method does not have, or is out of
    /// range.
    pub fn method(&self) -> Result<Method> {
        use MethodName::{Ewa, Peeling, Pyramid, SinglePass, Template, Transparent, TransparentHq};
        let name = self.name.unwrap_or_default();
        let kept = self.of_method(name);
        if let Some(key) = self.lost(&kept) {
            let name = super::words::of_method(name);
            return Err(Error::Invalid(format!("`{key}` means nothing to the method {name}")));
        }
        if self.bends.is_some() && self.refraction.is_none() {
            return Err(Error::Invalid("`bends` means nothing without a `refraction`".into()));
        }
        let splats = self.splats(ewa::Settings::default());
        let method = match name {
            Pyramid => {
                let default = pyramid::Settings::default();
                Method::Pyramid(pyramid::Settings {
                    weights: self.weights.unwrap_or(default.weights),
                    occlusion: self.occluded.unwrap_or(default.occlusion),
                    cull: self.cull.unwrap_or(default.cull),
                    subpixel_bits: self.subpixel_bits.unwrap_or(default.subpixel_bits),
                })
            }
            Template => {
                let default = template::Settings::default();
                Method::Template(template::Settings {
                    size: self.template.unwrap_or(default.size),
                    levels: self.levels.unwrap_or(default.levels),
                    cull: self.cull.unwrap_or(default.cull),
                })
            }
            Ewa => Method::Ewa(splats),
            SinglePass => Method::SinglePass(single_pass::Settings { splats, depth: self.depth() }),
            Peeling => {
                let default = peeling::Settings::default();
                Method::Peeling(peeling::Settings {
                    splats: self.splats(default.splats),
                    layers: self.peel.unwrap_or(default.layers),
                })
            }
            Transparent | TransparentHq => {
                let default = transparent::Settings::default();
                Method::Transparent(transparent::Settings {
                    splats: self.splats(default.splats),
                    bins: self.bin_count(),
                    holes: self.holes.unwrap_or(default.holes),
                    nearest: (name == TransparentHq).then(|| self.depth()),
                    refraction: self.refraction.map(|ratio| Refraction {
                        ratio,
                        layers: self.bends.unwrap_or(BendingLayers::Multiple),
                    }),
                })
            }
        };
        method.check()?;
        Ok(method)
    }

    /// The first key that was chosen but not kept.
    fn lost(&self, kept: &Self) -> Option<&'static str> {
        let keys = [
            ("depth", self.voronoi.is_some() && kept.voronoi.is_none()),
            ("bins", self.bins.is_some() && kept.bins.is_none()),
            ("holes", self.holes.is_some() && kept.holes.is_none()),
            ("refraction", self.refraction.is_some() && kept.refraction.is_none()),
            ("bends", self.bends.is_some() && kept.bends.is_none()),
            ("peel", self.peel.is_some() && kept.peel.is_none()),
            ("kernel", self.kernel.is_some() && kept.kernel.is_none()),
            ("outline", self.outline.is_some() && kept.outline.is_none()),
            ("cutoff", self.cutoff.is_some() && kept.cutoff.is_none()),
            ("low_pass", self.low_pass.is_some() && kept.low_pass.is_none()),
            ("epsilon", self.epsilon.is_some() && kept.epsilon.is_none()),
            ("weights", self.weights.is_some() && kept.weights.is_none()),
            ("occluded", self.occluded.is_some() && kept.occluded.is_none()),
            ("subpixel_bits", self.subpixel_bits.is_some() && kept.subpixel_bits.is_none()),
            ("template", self.template.is_some() && kept.template.is_none()),
            ("levels", self.levels.is_some() && kept.levels.is_none()),
        ];
        keys.into_iter().find_map(|(key, lost)| lost.then_some(key))
    }

    /// What was chosen that means something to a method, with this method.
    #[must_use]
    pub fn of_method(&self, name: MethodName) -> Self {
        use MethodName::{Peeling, Pyramid, SinglePass, Template, Transparent, TransparentHq};
        let groups = matches!(name, SinglePass | Transparent | TransparentHq);
        let blends = matches!(name, Transparent | TransparentHq);
        let nearest = name == TransparentHq;
        let (pyramid, template) = (name == Pyramid, name == Template);
        let splats = !(pyramid || template);
        Self {
            name: Some(name),
            kernel: self.kernel.filter(|_| splats),
            outline: self.outline.filter(|_| splats),
            cutoff: self.cutoff.filter(|_| splats),
            low_pass: self.low_pass.filter(|_| splats),
            epsilon: self.epsilon.filter(|_| splats),
            cull: self.cull,
            voronoi: self.voronoi.filter(|_| nearest || name == SinglePass),
            bins: self.bins.filter(|_| groups),
            holes: self.holes.filter(|_| blends),
            refraction: self.refraction.filter(|_| nearest),
            bends: self.bends.filter(|_| nearest),
            peel: self.peel.filter(|_| name == Peeling),
            weights: self.weights.filter(|_| pyramid),
            occluded: self.occluded.filter(|_| pyramid),
            subpixel_bits: self.subpixel_bits.filter(|_| pyramid),
            template: self.template.filter(|_| template),
            levels: self.levels.filter(|_| template),
        }
    }

    fn splats(&self, default: ewa::Settings) -> ewa::Settings {
        let preset = self.kernel.unwrap_or(default.kernel);
        ewa::Settings {
            kernel: Kernel {
                outline: self.outline.unwrap_or(preset.outline),
                cutoff: self.cutoff.unwrap_or(preset.cutoff),
                low_pass: self.low_pass.unwrap_or(preset.low_pass),
            },
            epsilon: self.epsilon.unwrap_or(default.epsilon),
            cull: self.cull.unwrap_or(default.cull),
        }
    }

    fn bin_count(&self) -> BinCount {
        self.bins.map_or(BinCount::Epsilon, BinCount::Count)
    }

    fn depth(&self) -> DepthTest {
        match self.voronoi {
            Some(false) => DepthTest::Plain,
            _ => DepthTest::Voronoi(self.bin_count()),
        }
    }
}

impl GroupChoice {
    /// The grouping for a method: what was chosen, and its defaults for the rest.
    #[must_use]
    pub fn grouping(&self, method: &Method) -> Grouping {
        let blends = matches!(method, Method::Transparent(_));
        let (overlap, count, extension) = if blends {
            (1.0, Some(DEFAULT_TRANSPARENT_GROUPS), ExtensionChoice::Add)
        } else {
            (DEFAULT_OVERLAP, None, ExtensionChoice::None)
        };
        Grouping {
            rules: Rules {
                // With a count the overlap is its upper end.
                overlap: self.overlap.unwrap_or(if self.count.is_some() { 1.0 } else { overlap }),
                opposite: self.opposite.unwrap_or(true),
                coplanar: self.coplanar,
            },
            count: self.count.or(if self.overlap.is_some() { None } else { count }),
            extension: self.extension.unwrap_or(extension).extension(self.most),
        }
    }

    /// Whether what was chosen is in range.
    ///
    /// # Errors
    /// [`Error::Invalid`] if it is not.
    pub fn check(&self) -> Result<()> {
        if self.most.is_some() && self.extension.is_some_and(|e| e != ExtensionChoice::Add) {
            return Err(Error::Invalid("`most` means nothing unless splats are added".into()));
        }
        // The ranges are the same for every method.
        self.grouping(&Method::Transparent(transparent::Settings::default())).check()
    }

    /// Whether nothing was chosen.
    #[must_use]
    pub fn is_open(&self) -> bool {
        *self == Self::default()
    }
}
