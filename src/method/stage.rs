//! List the passes of a method: what each stage reads, and which planes it leaves.

use super::projection::Has;
use crate::error::Error;
use crate::frame::named::{COLOR, VECTOR, component};
use crate::frame::{Frame, NamedPlane, Plane, Samples};
use crate::scene::Scene;

/// A pass of a method.
///
/// A method lists its stages in the order in which they run. The
/// [timings](super::Picture::timings) of a picture carry the names of these stages, whether the
/// definition or the fast path drew it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stage {
    /// The name of the pass: `visibility`.
    pub name: &'static str,
    /// The stages whose planes or records this stage reads. Every stage reads the scene and the
    /// camera.
    pub reads: &'static [&'static str],
    /// The planes that this stage leaves.
    pub leaves: &'static [PlaneRow],
}

/// A plane that a stage leaves: one row says everything about it.
///
/// The plane of a record is one row of that record's table of planes, see `record.rs`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlaneRow {
    /// The name, see [`crate::frame::NamedPlane`]. Each run of `#` stands for a number of as many
    /// digits: `group##.Z`.
    pub name: &'static str,
    /// The kind of the values.
    pub holds: Holds,
    /// The unit of the values: `px`, `world units`. Empty for values without a unit.
    pub unit: &'static str,
    /// What a value means, and which value an empty pixel has.
    pub meaning: &'static str,
    /// The pictures that have the plane.
    pub when: When,
}

/// The kind of values that a plane holds. Several kinds share one type of [`Samples`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// One number a pixel.
    Scalar,
    /// Depth t, one number a pixel; +inf where a pixel is empty.
    Depth,
    /// One number a pixel that describes the picture. No buffer of a renderer holds it.
    Diagnostic,
    /// Linear RGB.
    Color,
    /// Three components.
    Vector,
    /// Unit normals; the null vector where a pixel is empty.
    Normal,
    /// Indices: the lowest 32 bits of the ids of the surfels and primitives drawn.
    Index,
    /// The highest 8 bits of the ids whose [`Holds::Index`] the same stage leaves.
    HighIndex,
    /// Small counts.
    Count,
}

/// The condition under which a stage leaves a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// In every picture.
    Always,
    /// In every picture of a lit scene, and with the planes of the stages.
    Lit,
    /// In every picture of a scene with tubes.
    Tubes,
    /// With the planes of the stages.
    Stages,
    /// With the planes of the stages, if the scene has colours.
    Colored,
    /// With the planes of the stages, if the scene has tubes.
    StagesOfTubes,
    /// With the planes of the stages, if ids have more than 32 bits.
    Wide,
    /// With the planes of the stages, if the settings ask for the quantity.
    Settings,
    /// With the planes of the stages of a whole picture. Not where the stage runs on a client's
    /// planes, because those planes do not hold what the quantity needs.
    Whole,
    /// Where the stage runs alone: the next stage reads the plane, and no picture keeps it.
    Alone,
}

/// Which planes of the stages a frame keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Keep {
    /// No planes of the stages: a picture as every frame has it.
    Picture,
    /// The planes of a picture with the planes of the stages.
    Stages,
    /// The planes of a stage that runs alone.
    Alone,
}

/// The facts that decide which planes are there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conditions {
    keep: Keep,
    has: Has,
    lit: bool,
    wide: bool,
    settings: bool,
}

impl Conditions {
    /// The conditions in a frame of this scene. None of the settings asks for a plane.
    pub(crate) fn new(scene: &Scene, keep: Keep) -> Self {
        let (mut has, mut wide) = (Has::in_scene(scene), false);
        if let Some(objects) = &scene.objects {
            (has.color, wide) = (has.color || objects.have_colors(), objects.ids().is_wide());
        }
        let lit = !scene.lights.is_empty();
        Self { keep, has, lit, wide, settings: false }
    }

    /// The same conditions, with planes of [`When::Settings`] if `settings` is true.
    pub(crate) fn with_settings(self, settings: bool) -> Self {
        Self { settings, ..self }
    }

    /// The same conditions, in a scene with these attributes.
    pub(crate) fn with_attributes(self, has: Has) -> Self {
        Self { has, ..self }
    }

    /// Whether the plane of a row is there.
    pub(crate) fn hold(&self, row: &PlaneRow) -> bool {
        let stages = self.keep != Keep::Picture;
        match row.when {
            When::Always => true,
            When::Lit => stages || self.lit,
            When::Tubes => self.has.tangent,
            When::Stages => stages,
            When::Colored => stages && self.has.color,
            When::StagesOfTubes => stages && self.has.tangent,
            When::Wide => stages && self.wide,
            When::Settings => stages && self.settings,
            When::Whole => self.keep == Keep::Stages,
            When::Alone => self.keep == Keep::Alone,
        }
    }
}

impl Holds {
    /// The kind without the meaning of its values: one kind for each type of [`Samples`].
    #[must_use]
    pub fn plain(self) -> Self {
        match self {
            Self::Scalar | Self::Depth | Self::Diagnostic => Self::Scalar,
            Self::Color => Self::Color,
            Self::Vector | Self::Normal => Self::Vector,
            Self::Index => Self::Index,
            Self::HighIndex | Self::Count => Self::Count,
        }
    }

    /// The channel names in a file of a plane called `name`.
    #[must_use]
    pub fn channels(self, name: &str) -> Vec<String> {
        let letters = match self.plain() {
            Self::Color => COLOR,
            Self::Vector => VECTOR,
            _ => return vec![name.to_owned()],
        };
        letters.map(|letter| component(name, letter)).to_vec()
    }

    /// The type in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self.plain() {
            Self::Color => "colours",
            Self::Vector => "vectors",
            Self::Index => "indices of 32 bits",
            Self::Count => "counts of 8 bits",
            _ => "one number a pixel",
        }
    }
}

impl When {
    /// The condition in the words of [`mod@super::planes`].
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Always => "always",
            Self::Lit => "lit",
            Self::Tubes => "tubes",
            Self::Stages => "stages",
            Self::Colored => "stages, colours",
            Self::StagesOfTubes => "stages, tubes",
            Self::Wide => "stages, wide ids",
            Self::Settings => "stages, setting",
            Self::Whole => "stages, whole",
            Self::Alone => "alone",
        }
    }
}

impl PlaneRow {
    /// A row whose plane is there with the planes of the stages.
    #[must_use]
    pub const fn new(name: &'static str, holds: Holds, meaning: &'static str) -> Self {
        let unit = match holds {
            Holds::Depth => "world units",
            Holds::Color => "linear RGB",
            _ => "",
        };
        Self { name, holds, unit, meaning, when: When::Stages }
    }

    /// The row with another unit.
    #[must_use]
    pub const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// The row with another condition.
    #[must_use]
    pub const fn when(self, when: When) -> Self {
        Self { when, ..self }
    }

    /// The row with another meaning.
    #[must_use]
    pub const fn says(self, meaning: &'static str) -> Self {
        Self { meaning, ..self }
    }

    /// The name of the plane, with a number in place of `#`.
    #[must_use]
    pub fn numbered(&self, number: usize) -> String {
        numbered(self.name, number)
    }

    /// A plane of this row; `number` stands for `#`.
    pub(crate) fn plane<R>(&self, number: usize, samples: Samples<R>) -> NamedPlane<R> {
        debug_assert!(self.holds(&samples), "{}", self.name);
        NamedPlane { name: self.numbered(number), samples }
    }

    /// A plane of this row, of one number a pixel.
    pub(crate) fn scalar<R>(&self, number: usize, plane: Plane<R>) -> NamedPlane<R> {
        self.plane(number, Samples::Scalar(plane))
    }

    /// A plane of this row, of three numbers a pixel.
    pub(crate) fn triple<R>(&self, number: usize, plane: Plane<[R; 3]>) -> NamedPlane<R> {
        match self.holds.plain() {
            Holds::Vector => self.plane(number, Samples::Vector(plane)),
            _ => self.plane(number, Samples::Color(plane)),
        }
    }

    /// A plane of this row, of surfel indices.
    pub(crate) fn index<R>(&self, number: usize, plane: Plane<u32>) -> NamedPlane<R> {
        self.plane(number, Samples::Index(plane))
    }

    /// A plane of this row, of small counts.
    pub(crate) fn count<R>(&self, number: usize, plane: Plane<u8>) -> NamedPlane<R> {
        self.plane(number, Samples::Count(plane))
    }

    /// Whether `name` is a name of this row's plane.
    #[must_use]
    pub fn is_called(&self, name: &str) -> bool {
        // A `#` of the row stands for one digit of the name.
        let same = |(of, c): (u8, u8)| of == c || (of == b'#' && c.is_ascii_digit());
        self.name.len() == name.len() && self.name.bytes().zip(name.bytes()).all(same)
    }

    /// Whether a plane of this row can hold these values.
    #[must_use]
    pub fn holds<R>(&self, samples: &Samples<R>) -> bool {
        let holds = match samples {
            Samples::Scalar(_) => Holds::Scalar,
            Samples::Color(_) => Holds::Color,
            Samples::Vector(_) => Holds::Vector,
            Samples::Index(_) => Holds::Index,
            Samples::Count(_) => Holds::Count,
        };
        self.holds.plain() == holds
    }
}

/// Puts a number in place of the run of `#` in a name.
pub(crate) fn numbered(name: &str, number: usize) -> String {
    let digits = name.bytes().filter(|&c| c == b'#').count();
    let number = format!("{number:0digits$}");
    match name.split_once('#') {
        None => name.to_owned(),
        Some((before, after)) => {
            format!("{before}{number}{}", after.trim_start_matches('#'))
        }
    }
}

impl Stage {
    /// The row of a plane that the stage leaves.
    #[must_use]
    pub fn row(&self, name: &str) -> Option<&'static PlaneRow> {
        self.leaves.iter().find(|row| row.is_called(name))
    }

    /// The planes of a frame that this stage left.
    #[must_use]
    pub fn planes_of<R: Clone>(&self, frame: &Frame<R>) -> Frame<R> {
        let own = frame.planes.iter().filter(|plane| self.row(&plane.name).is_some());
        Frame { width: frame.width, height: frame.height, planes: own.cloned().collect() }
    }
}

/// The error for a stage that does not exist or does not run on planes.
pub(crate) fn unknown(stage: &str) -> Error {
    Error::Invalid(format!("there is no stage `{stage}` that runs on planes"))
}
