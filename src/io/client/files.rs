//! Read the files of planes, each once.

use super::format::Format;
use super::numbers::{Numbers, ask};
use super::raw;
use super::wanted::Wanted;
use crate::error::{Error, Result};
use crate::frame::image::Values;
use crate::frame::{Exec, Image};
use crate::io::exr::{self, ChannelType};
use crate::io::{Reason, extension, npy, npz, provenance};
use crate::method::Holds;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The kind of a file, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Exr,
    Npy,
    Npz,
    Png,
    Raw,
    /// In memory.
    Array,
}

impl Kind {
    pub(super) fn from_extension(path: &Path) -> Option<Self> {
        match extension(path)?.as_str() {
            "exr" => Some(Self::Exr),
            "npy" => Some(Self::Npy),
            "npz" => Some(Self::Npz),
            "png" => Some(Self::Png),
            "raw" | "bin" => Some(Self::Raw),
            _ => None,
        }
    }
}

/// A file of several channels.
#[derive(Debug)]
pub(super) struct Picture {
    pub(super) image: Image,
    /// The stored format of each channel, by name.
    formats: BTreeMap<String, Format>,
}

/// The pictures that were read so far.
#[derive(Debug)]
pub(super) struct Files<'e> {
    exec: &'e Exec,
    arrays: &'e BTreeMap<String, Numbers>,
    pictures: BTreeMap<PathBuf, Picture>,
}

impl<'e> Files<'e> {
    pub(super) fn new(exec: &'e Exec, arrays: &'e BTreeMap<String, Numbers>) -> Self {
        Self { exec, arrays, pictures: BTreeMap::new() }
    }

    /// The picture at `path`, an EXR or a PNG; read on the first call.
    pub(super) fn picture(&mut self, path: &Path, kind: Kind) -> Result<&Picture> {
        if !self.pictures.contains_key(path) {
            let picture = if kind == Kind::Png { png(path)? } else { self.exr(path)? };
            self.pictures.insert(path.to_owned(), picture);
        }
        Ok(&self.pictures[path])
    }

    fn exr(&self, path: &Path) -> Result<Picture> {
        let header = exr::read_header(path)?;
        provenance::check_finished(path, header.text.as_deref())?;
        let formats = header.channels.into_iter().map(|(name, stored)| {
            let format = match stored {
                ChannelType::Half => Format::F16,
                ChannelType::Float => Format::F32,
                ChannelType::Uint => Format::U32,
            };
            (name, format)
        });
        let formats = formats.collect();
        Ok(Picture { image: exr::read_with(path, self.exec)?, formats })
    }

    /// The numbers of a plane; `size` is for a raw file.
    pub(super) fn numbers(
        &mut self,
        wanted: &Wanted,
        path: &Path,
        kind: Kind,
        size: [u32; 2],
    ) -> Result<Numbers> {
        let Wanted { keys, row, key, .. } = wanted;
        let components = wanted.channels().len();
        let place = if kind == Kind::Array { Path::new("") } else { path };
        let refused = |what: String| Error::format(place, format!("planes.{key}: {what}"));
        let count = |found: usize| match found == components {
            true => Ok(()),
            false => {
                let holds = row.holds.words();
                Err(refused(format!("{found} numbers a pixel, but the plane holds {holds}")))
            }
        };
        match kind {
            Kind::Array => {
                let array = path.to_str().and_then(|key| self.arrays.get(key));
                let array = array.ok_or_else(|| refused("no array".into()))?;
                count(array.components.len())?;
                ask(array.size, components).map_err(refused)?;
                Ok(array.clone())
            }
            Kind::Raw => {
                let format = keys.format.unwrap_or(match row.holds.plain() {
                    Holds::Index => Format::U32,
                    Holds::Count => Format::U8,
                    _ => Format::F32,
                });
                raw::read(path, key, keys, format, components, size)
            }
            Kind::Npy | Kind::Npz => {
                // The name does not matter: only the number of components does.
                let (image, is_half) = match (kind, keys.channel.as_deref()) {
                    (Kind::Npy, _) => npy::read_stored(path, "v")?,
                    (_, None) => npz::read_stored(path, &wanted.name, "v")?,
                    (_, Some([name])) => npz::read_stored(path, name, "v")?,
                    (_, Some(_)) => {
                        return Err(refused("`channel` of an NPZ is the name of one array".into()));
                    }
                };
                let names: Vec<String> =
                    image.channels.iter().map(|(name, _)| name.clone()).collect();
                count(names.len())?;
                let half = names.iter().filter(|_| is_half).map(|name| (name.clone(), Format::F16));
                let picture = Picture { image, formats: half.collect() };
                picture.numbers(&names).map_err(refused)
            }
            Kind::Exr | Kind::Png => {
                let picture = self.picture(path, kind)?;
                let names = picture.names(wanted, kind).map_err(refused)?;
                let mut numbers = picture.numbers(&names).map_err(refused)?;
                // A PNG has stored whole numbers as codes of colours.
                if matches!(row.holds.plain(), Holds::Index | Holds::Count) {
                    numbers.as_codes();
                }
                Ok(numbers)
            }
        }
    }
}

impl Picture {
    /// The names of a plane's channels in this file.
    fn names(&self, wanted: &Wanted, kind: Kind) -> Reason<Vec<String>> {
        let components = wanted.channels().len();
        if let Some(names) = wanted.chosen() {
            if names.len() == components {
                return Ok(names);
            }
            return Err(format!(
                "`channel` names {} of them, but the plane holds {}; give {components}",
                names.len(),
                wanted.row.holds.words()
            ));
        }
        let names = wanted.channels();
        let has = |name: &String| self.image.channel(name).is_some();
        if kind == Kind::Exr || names.iter().all(has) {
            return Ok(names);
        }
        // A PNG has only the names of its colours, whatever its numbers mean.
        let colors = ["R", "G", "B"].map(str::to_owned);
        let [red, green, blue] = colors.each_ref().map(|name| self.image.channel(name));
        match components {
            3 => Ok(colors.to_vec()),
            _ if red == green && green == blue => Ok(colors[..1].to_vec()),
            _ => {
                Err("the PNG is not grey; give the `channel`: \"R\", \"G\", \"B\" or \"A\"".into())
            }
        }
    }

    /// The numbers of these channels.
    fn numbers(&self, names: &[String]) -> Reason<Numbers> {
        let Image { width, height, channels, .. } = &self.image;
        ask([*width, *height], names.len())?;
        let mut components = Vec::new();
        let mut file = None;
        for name in names {
            let missing = || {
                let there: Vec<&str> = channels.iter().map(|(name, _)| name.as_str()).collect();
                format!("no channel `{}`; there are {}", name.escape_debug(), there.join(", "))
            };
            let values = self.image.channel(name).ok_or_else(missing)?;
            let format = self.formats.get(name).copied().unwrap_or(match values {
                Values::Float(_) => Format::F32,
                Values::Index(_) => Format::U32,
            });
            if *file.get_or_insert(format) != format {
                return Err(format!(
                    "the channel `{name}` is {}, but another is not",
                    format.word()
                ));
            }
            components.push(match values {
                // A PNG's codes, before they were rounded to `f32`.
                Values::Float(values) if format.is_unorm() => {
                    values.iter().map(|&v| format.nearest(v.into())).collect()
                }
                Values::Float(values) => values.iter().map(|&v| v.into()).collect(),
                Values::Index(values) => values.iter().map(|&v| v.into()).collect(),
            });
        }
        let file = file.unwrap_or(Format::F32);
        Ok(Numbers { size: [*width, *height], components, file })
    }
}

#[cfg(feature = "cli")]
fn png(path: &Path) -> Result<Picture> {
    let stored = crate::io::png::read(path)?;
    let format = if stored.most == u16::MAX { Format::Unorm16 } else { Format::Unorm8 };
    let names = stored.image.channels.iter().map(|(name, _)| (name.clone(), format));
    Ok(Picture { formats: names.collect(), image: stored.image })
}

#[cfg(not(feature = "cli"))]
fn png(path: &Path) -> Result<Picture> {
    Err(Error::format(path, "PNG is read with the feature `cli` of this crate only"))
}
