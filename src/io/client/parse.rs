//! Parse the text of a TOML file into a [`Sidecar`].

use super::convert;
use super::format::Format;
use super::keys::Keys;
use super::numbers::Numbers;
use super::records::Place;
use crate::error::{Error, Result};
use crate::io::{Reason, input};
use crate::setting::Words;
use crate::verdict::client::{Rounding, Storage, Ties};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The contents of a TOML file; no other file has been read yet.
#[derive(Clone, Debug)]
pub(super) struct Sidecar {
    pub(super) file: Option<PathBuf>,
    pub(super) rounding: Rounding,
    pub(super) accumulator: Storage,
    pub(super) ties: Ties,
    pub(super) upwards: bool,
    pub(super) size: Option<[u32; 2]>,
    /// The projected splats.
    pub(super) records: Option<Place>,
    pub(super) depth: DepthKeys,
    pub(super) depth_test: Storage,
    /// The planes, by their names in the file.
    pub(super) planes: Vec<(String, PlaneKeys)>,
    /// The planes that are in memory, by these names.
    pub(super) arrays: BTreeMap<String, Numbers>,
}

/// How depths are stored.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DepthKeys {
    pub(super) meaning: Option<Meaning>,
    pub(super) near: Option<f64>,
    pub(super) far: Option<f64>,
}

/// The keys of one plane.
#[derive(Clone, Debug, Default)]
pub(super) struct PlaneKeys {
    pub(super) file: Option<PathBuf>,
    pub(super) channel: Option<Vec<String>>,
    pub(super) format: Option<Format>,
    pub(super) offset: Option<u64>,
    pub(super) row_stride: Option<u64>,
    pub(super) pixel_stride: Option<u64>,
    pub(super) empty: Option<f64>,
    pub(super) id_base: Option<u32>,
    pub(super) premultiplied: Option<bool>,
    pub(super) encoding: Option<Encoding>,
    pub(super) range: Option<[f64; 2]>,
    pub(super) depth: DepthKeys,
}

/// What a stored number means in terms of the depth t.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Meaning {
    #[default]
    T,
    Inverse,
    NearOver,
    ZBuffer,
    ReversedZ,
    Linear,
}

impl Words for Meaning {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("t", Self::T),
        ("1/t", Self::Inverse),
        ("near/t", Self::NearOver),
        ("z-buffer", Self::ZBuffer),
        ("reversed-z", Self::ReversedZ),
        ("linear", Self::Linear),
    ];
}

impl Meaning {
    pub(super) fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, meaning)| *meaning == self).map_or("", |(word, _)| word)
    }
}

/// How a colour, or a unit vector, is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Linear,
    Srgb,
    /// For unit vectors, in two numbers.
    Octahedral,
}

impl Words for Encoding {
    const WORDS: &'static [(&'static str, Self)] =
        &[("linear", Self::Linear), ("srgb", Self::Srgb), ("octahedral", Self::Octahedral)];
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Origin {
    TopLeft,
    BottomLeft,
}

impl Words for Origin {
    const WORDS: &'static [(&'static str, Self)] =
        &[("top-left", Self::TopLeft), ("bottom-left", Self::BottomLeft)];
}

#[derive(Clone, Copy)]
enum Accumulator {
    F32,
    F16,
}

impl Words for Accumulator {
    const WORDS: &'static [(&'static str, Self)] = &[("f32", Self::F32), ("f16", Self::F16)];
}

impl Sidecar {
    /// The description of a picture without a TOML file.
    pub(super) fn of_picture(path: &Path) -> Self {
        Self {
            file: Some(path.to_owned()),
            rounding: Rounding::default(),
            accumulator: Storage::Single,
            ties: Ties::default(),
            upwards: false,
            size: None,
            records: None,
            depth: DepthKeys::default(),
            depth_test: Storage::Single,
            planes: Vec::new(),
            arrays: BTreeMap::new(),
        }
    }

    /// Parses the text of the file at `path`; other files are relative to its folder.
    pub(super) fn parse(text: &str, path: &Path) -> Result<Self> {
        Self::parse_with(text, path, false)
    }

    /// The same for a text that may be without planes if there are arrays.
    pub(super) fn parse_with(text: &str, path: &Path, has_arrays: bool) -> Result<Self> {
        input::ask_for_toml(path, text)?;
        let table = text.parse::<toml::Table>();
        let table = table.map_err(|error| input::no_toml(path, text, &error))?;
        let mut read = Self::of_keys(Keys::new(table), has_arrays)
            .map_err(|what| Error::format(path, what))?;
        // `join` keeps an absolute path as it is.
        let folder = path.parent().unwrap_or(Path::new(""));
        let files = read.planes.iter_mut().map(|(_, plane)| &mut plane.file);
        let records = read.records.as_mut().and_then(Place::file_mut);
        for file in files.chain([&mut read.file]).flatten().chain(records) {
            *file = folder.join(&file);
        }
        Ok(read)
    }

    /// All files that the description names.
    pub(super) fn files(&self) -> impl Iterator<Item = &Path> {
        let planes = self.planes.iter().filter_map(|(_, plane)| plane.file.as_deref());
        let records = self.records.as_ref().and_then(Place::file);
        planes.chain(self.file.as_deref()).chain(records)
    }

    fn of_keys(mut keys: Keys, has_arrays: bool) -> Reason<Self> {
        let mut depth = keys.table("depth")?;
        let mut test = keys.table("depth-test")?;
        let planes = keys.table("planes")?.tables()?.into_iter();
        let planes = planes.map(|(name, keys)| Ok((name, PlaneKeys::of_keys(keys)?)));
        let read = Self {
            planes: planes.collect::<Reason<_>>()?,
            depth: DepthKeys::of_keys(&mut depth)?,
            depth_test: convert::depth_test(
                test.word("format")?.unwrap_or(Format::F32),
                DepthKeys::of_keys(&mut test)?,
            )?,
            file: keys.path("file")?,
            rounding: keys.word("profile")?.unwrap_or_default(),
            accumulator: match keys.word("accumulator")?.unwrap_or(Accumulator::F32) {
                Accumulator::F32 => Storage::Single,
                Accumulator::F16 => Storage::Half,
            },
            ties: keys.word("ties")?.unwrap_or_default(),
            upwards: keys.word("origin")? == Some(Origin::BottomLeft),
            size: keys.size("size")?,
            records: keys.path("records")?.map(Place::File),
            arrays: BTreeMap::new(),
        };
        depth.done()?;
        test.done()?;
        keys.done()?;
        if read.planes.is_empty() && read.file.is_none() && !has_arrays {
            return Err("no plane; give a `file`, or a table such as [planes.Z]".into());
        }
        Ok(read)
    }
}

impl DepthKeys {
    fn of_keys(keys: &mut Keys) -> Reason<Self> {
        let read = Self {
            meaning: keys.word("meaning")?,
            near: keys.number("near")?,
            far: keys.number("far")?,
        };
        for (key, value) in [("near", read.near), ("far", read.far)] {
            if value.is_some_and(|value| !(value >= 0.0)) {
                return Err(format!("{}{key} must be a depth, from 0", keys.prefix()));
            }
        }
        Ok(read)
    }

    /// These keys, completed by the `other` ones.
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            meaning: self.meaning.or(other.meaning),
            near: self.near.or(other.near),
            far: self.far.or(other.far),
        }
    }
}

impl PlaneKeys {
    fn of_keys(mut keys: Keys) -> Reason<Self> {
        let read = Self {
            file: keys.path("file")?,
            channel: keys.names("channel")?,
            format: keys.word("format")?,
            offset: keys.bytes("offset")?,
            row_stride: keys.bytes("row_stride")?,
            pixel_stride: keys.bytes("pixel_stride")?,
            empty: keys.number("empty")?,
            id_base: keys.whole("id_base")?,
            premultiplied: keys.switch("premultiplied")?,
            encoding: keys.word("encoding")?,
            range: keys.range("range")?,
            depth: DepthKeys::of_keys(&mut keys)?,
        };
        keys.done()?;
        Ok(read)
    }
}
