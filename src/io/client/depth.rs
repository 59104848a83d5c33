//! Write depths as other programs store them, with the TOML file from which [`super::read`] reads
//! them.

use super::convert::ends;
use super::parse::{DepthKeys, Meaning};
use crate::error::{Error, Result};
use crate::frame::Plane;
use crate::io::replace::write_atomically;
use crate::io::{Reason, npy};
use crate::setting::Words;
use std::io::Write;
use std::path::Path;

/// The greatest code of 16 bits.
const MOST: f64 = 65_535.0;

/// The file of depths, beside its TOML file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthFile {
    /// Codes of 16 bits.
    Png,
    /// 32-bit floats.
    Npy,
}

impl DepthFile {
    /// The extension of the file.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Npy => "npy",
        }
    }
}

/// What a stored number means in terms of the depth t: a meaning of the table in [`super`].
///
/// The number v is computed in f64 with n = 1/near and s = 1/near - 1/far:
///
/// ```text
///   t           t                      reversed-z  (1/t - 1/far) / s
///   1/t         1 / t                  z-buffer    (n - 1/t) / s
///   near/t      near / t               linear      (t - near) / (far - near)
/// ```
///
/// An NPY holds v, rounded to `f32`. A PNG holds the code floor(65535 v + 1/2), or for t
/// floor(scale t + 1/2). An empty pixel has the number of the table, and the code 0 for t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthConvention {
    file: DepthFile,
    meaning: Meaning,
    near: f64,
    far: f64,
    /// Codes for each world unit, for t in a PNG.
    scale: f64,
}

impl DepthConvention {
    /// Parses a meaning and its numbers: `t` for an NPY or `t,SCALE` for a PNG, `1/t`,
    /// `near/t,NEAR`, or `z-buffer,NEAR,FAR` and so for `reversed-z` and `linear`.
    ///
    /// # Errors
    /// One line if there is no such meaning, or if it has other numbers.
    pub fn parse(file: DepthFile, text: &str) -> Reason<Self> {
        let mut parts = text.split(',');
        let word = parts.next().unwrap_or_default();
        let meaning = Meaning::named(word).ok_or_else(|| {
            let all: Vec<&str> = Meaning::WORDS.iter().map(|(word, _)| *word).collect();
            format!("`{}`; give one of {}", word.escape_debug(), all.join(", "))
        })?;
        let parse = |part: &str| {
            part.trim().parse().map_err(|_| format!("`{}` is not a number", part.escape_debug()))
        };
        let numbers: Vec<f64> = parts.map(parse).collect::<Reason<_>>()?;
        let (count, wanted) = match (meaning, file) {
            (Meaning::T, DepthFile::Png) => (1, ",SCALE, the codes for each world unit"),
            (Meaning::T, DepthFile::Npy) | (Meaning::Inverse, _) => (0, " alone"),
            (Meaning::NearOver, _) => (1, ",NEAR"),
            (Meaning::ZBuffer | Meaning::ReversedZ | Meaning::Linear, _) => (2, ",NEAR,FAR"),
        };
        if numbers.len() != count {
            let text = text.escape_debug();
            let kind = file.extension();
            return Err(format!("`{text}` for a depth in {kind}; give {word}{wanted}"));
        }
        let number = |at: usize| numbers.get(at).copied();
        let (near, far, scale) = match meaning {
            Meaning::T => (None, None, number(0).unwrap_or(1.0)),
            _ => (number(0), number(1), 1.0),
        };
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(format!("a scale of {scale}; give the codes for each world unit"));
        }
        let (near, far) = ends(&DepthKeys { meaning: Some(meaning), near, far }, meaning, "depth")?;
        Ok(Self { file, meaning, near, far, scale })
    }

    /// Writes a plane of depths to `path`, and to `description` the TOML file.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a depth has no number of its own, because it is beyond the range or
    /// would have the number of an empty pixel. [`Error::Io`] if a file cannot be written.
    pub fn write(&self, path: &Path, description: &Path, depths: &Plane<f32>) -> Result<()> {
        let (width, height) = (depths.width(), depths.height());
        let numbers = depths.values().iter().map(|&t| self.number(t));
        let numbers = numbers.collect::<std::result::Result<Vec<f64>, f32>>().map_err(|t| {
            let (of, word) = (path.display(), self.meaning.word());
            Error::Invalid(format!(
                "{of}: a depth of {t} cannot be told apart in the convention {word}; give it other \
                 numbers, or npy"
            ))
        })?;
        match self.file {
            DepthFile::Npy => {
                let floats: Vec<f32> = numbers.iter().map(|&v| v as f32).collect();
                npy::write(path, npy::Values::Floats(&floats), width as usize)?;
            }
            DepthFile::Png => {
                let codes: Vec<u16> = numbers.iter().map(|&code| code as u16).collect();
                png(path, [width, height], &codes)?;
            }
        }
        let name = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
        let text = self.text(&name);
        write_atomically(description, |file| file.write_all(text.as_bytes()))
    }

    /// The number of a depth, in a PNG its code; the depth itself if it has none.
    fn number(&self, t: f32) -> std::result::Result<f64, f32> {
        let Self { file, meaning, near, far, scale } = *self;
        let slope = 1.0 / near - 1.0 / far;
        let of = |t: f64| match meaning {
            Meaning::T => t,
            Meaning::Inverse => 1.0 / t,
            Meaning::NearOver => near / t,
            Meaning::ZBuffer => (1.0 / near - 1.0 / t) / slope,
            Meaning::ReversedZ => (1.0 / t - 1.0 / far) / slope,
            Meaning::Linear => (t - near) / (far - near),
        };
        let empty = match meaning {
            Meaning::T if file == DepthFile::Npy => f64::INFINITY,
            Meaning::T | Meaning::Inverse | Meaning::NearOver | Meaning::ReversedZ => 0.0,
            Meaning::ZBuffer | Meaning::Linear if file == DepthFile::Png => MOST,
            Meaning::ZBuffer | Meaning::Linear => 1.0,
        };
        if t == f32::INFINITY {
            return Ok(empty);
        }
        let v = of(t.into());
        let (stored, most) = match file {
            DepthFile::Npy => (f64::from(v as f32), f64::INFINITY),
            DepthFile::Png if meaning == Meaning::T => ((scale * v + 0.5).floor(), MOST),
            DepthFile::Png => ((MOST * v + 0.5).floor(), MOST),
        };
        let least = if file == DepthFile::Png { 0.0 } else { f64::NEG_INFINITY };
        let fits = least <= stored && stored <= most && stored.is_finite() && stored != empty;
        if fits { Ok(stored) } else { Err(t) }
    }

    /// The text of the TOML file.
    fn text(&self, name: &str) -> String {
        let Self { file, meaning, near, far, scale } = *self;
        let name = toml::Value::String(name.to_owned());
        let mut text = format!("[planes.Z]\nfile = {name}\nmeaning = \"{}\"\n", meaning.word());
        if file == DepthFile::Png {
            text += "format = \"unorm16\"\n";
        }
        match meaning {
            Meaning::T if file == DepthFile::Png => {
                text += &format!("range = [0, {:?}]\nempty = 0\n", MOST / scale);
            }
            Meaning::T | Meaning::Inverse => {}
            Meaning::NearOver => text += &format!("near = {near:?}\n"),
            Meaning::ZBuffer | Meaning::ReversedZ | Meaning::Linear => {
                text += &format!("near = {near:?}\nfar = {far:?}\n");
            }
        }
        text
    }
}

#[cfg(feature = "cli")]
fn png(path: &Path, size: [u32; 2], codes: &[u16]) -> Result<()> {
    crate::io::png::write_grey(path, size, codes)
}

#[cfg(not(feature = "cli"))]
fn png(path: &Path, _: [u32; 2], _: &[u16]) -> Result<()> {
    Err(Error::format(path, "PNG is written with the feature `cli` of this crate only"))
}
