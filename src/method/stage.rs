//! Stages as values: the passes of a method, what each reads, and the planes that each leaves.

use crate::error::Error;
use crate::frame::named::{COLOR, VECTOR, component};
use crate::frame::{Frame, NamedPlane, Plane, Samples};

/// A pass of a method.
///
/// A method lists its stages in the order in which they run. The timings of a picture carry the
/// names of these stages, whether the definition or the fast path drew it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stage {
    /// What the pass is called: `visibility`.
    pub name: &'static str,
    /// The stages whose planes or records it reads; every stage reads the scene and the camera.
    pub reads: &'static [&'static str],
    /// The planes it leaves.
    pub leaves: &'static [PlaneRow],
}

/// A plane that a stage leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlaneRow {
    /// The name, see [`crate::frame::NamedPlane`]; each run of `#` stands for a number of as many
    /// digits: `group##.Z`.
    pub name: &'static str,
    /// The type of the values.
    pub holds: Holds,
    /// The unit of the values: `px`, `world units`; empty for what has none.
    pub unit: &'static str,
    /// What a value says, and what an empty pixel has.
    pub meaning: &'static str,
    /// When the plane is there.
    pub when: When,
}

/// The type of a plane's values, see [`Samples`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// One number a pixel.
    Scalar,
    /// Linear RGB.
    Color,
    /// Three components.
    Vector,
    /// Indices.
    Index,
    /// Small counts.
    Count,
}

/// When a stage leaves a plane.
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
    /// With the planes of the stages of a whole picture; not where the stage runs on somebody's
    /// planes, which do not hold what the quantity takes.
    Whole,
    /// Where the stage runs alone: what the next stage reads, and no picture keeps.
    Alone,
}

impl Holds {
    /// The names that the channels of a plane called `name` have in a file.
    #[must_use]
    pub fn channels(self, name: &str) -> Vec<String> {
        match self {
            Self::Color => COLOR.map(|letter| component(name, letter)).to_vec(),
            Self::Vector => VECTOR.map(|letter| component(name, letter)).to_vec(),
            Self::Scalar | Self::Index | Self::Count => vec![name.to_owned()],
        }
    }

    /// The type in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Scalar => "one number a pixel",
            Self::Color => "colours",
            Self::Vector => "vectors",
            Self::Index => "indices of 32 bits",
            Self::Count => "counts of 8 bits",
        }
    }
}

impl When {
    /// The condition in words, those of [`mod@super::planes`].
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
    /// A row.
    #[must_use]
    pub const fn new(
        name: &'static str,
        holds: Holds,
        unit: &'static str,
        meaning: &'static str,
        when: When,
    ) -> Self {
        Self { name, holds, unit, meaning, when }
    }

    /// The name, with a number in place of `#`.
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
        match self.holds {
            Holds::Vector => self.plane(number, Samples::Vector(plane)),
            _ => self.plane(number, Samples::Color(plane)),
        }
    }

    /// A plane of this row, of surfels.
    pub(crate) fn index<R>(&self, number: usize, plane: Plane<u32>) -> NamedPlane<R> {
        self.plane(number, Samples::Index(plane))
    }

    /// A plane of this row, of small counts.
    pub(crate) fn count<R>(&self, number: usize, plane: Plane<u8>) -> NamedPlane<R> {
        self.plane(number, Samples::Count(plane))
    }

    /// Whether a plane of this name is of this row.
    #[must_use]
    pub fn is_called(&self, name: &str) -> bool {
        let same = |(of, c): (u8, u8)| of == c || (of == b'#' && c.is_ascii_digit());
        self.name.len() == name.len() && self.name.bytes().zip(name.bytes()).all(same)
    }

    /// Whether a plane of these values can be of this row.
    #[must_use]
    pub fn holds<R>(&self, samples: &Samples<R>) -> bool {
        let holds = match samples {
            Samples::Scalar(_) => Holds::Scalar,
            Samples::Color(_) => Holds::Color,
            Samples::Vector(_) => Holds::Vector,
            Samples::Index(_) => Holds::Index,
            Samples::Count(_) => Holds::Count,
        };
        self.holds == holds
    }
}

/// A name with a number in place of its run of `#`.
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

/// There is no stage of this name, or none that runs on planes.
pub(crate) fn unknown(stage: &str) -> Error {
    Error::Invalid(format!("there is no stage `{stage}` that runs on planes"))
}
