//! Join the parts of a picture, EXR files whose data windows are regions of one display window.

use super::{ChannelType, Compression, PictureHeader, read_header, read_region};
use crate::error::{Error, Result};
use crate::frame::image::Values;
use crate::frame::{Exec, Frame, Plane, Rect, Samples};
use crate::io::provenance::is_projection;
use crate::memory;
use std::path::{Path, PathBuf};

/// A picture that was joined from its parts.
#[derive(Clone, Debug)]
pub struct Assembled {
    /// The planes of the whole picture.
    pub frame: Frame<f32>,
    /// The text that all parts carry.
    pub text: String,
    /// How the first part, counted row by row, is compressed.
    pub compression: Compression,
}

/// A file with a part of a picture.
struct Part<'a> {
    path: &'a Path,
    header: PictureHeader,
    region: Rect,
}

/// Joins the parts of a picture in any order. Written as an EXR with the text and the compression of
/// its parts, the frame has the bytes of the file of the whole picture. Parts may overlap.
///
/// Parts that hold the [projection](crate::method::projection) alone are joined as they are:
/// [`finish`](crate::io::scene_file::projection::finish) makes the picture of them.
///
/// Memory holds the whole picture and one part.
///
/// # Errors
/// As [`read_region`]. [`Error::Format`] on a part that carries no text of this crate, or another
/// text, size or other channels than the first, that differs from a part that it overlaps, or whose
/// projection has a NaN.
/// [`Error::Invalid`] if no part has some pixel; the message names a region that is missing.
pub fn assemble(paths: &[PathBuf], exec: &Exec) -> Result<Assembled> {
    let mut parts = paths.iter().map(|path| open(path)).collect::<Result<Vec<_>>>()?;
    let Some((first, others)) = parts.split_first() else {
        return Err(Error::Usage("no part is given; give the files that --region wrote".into()));
    };
    others.iter().try_for_each(|part| check(part, first))?;
    parts.sort_by_key(|part| (part.region.y0, part.region.x0));
    let first = &parts[0];
    let picture = Rect::of_size([first.header.width, first.header.height]);
    check_complete(picture, &parts)?;
    let (channels, compression) = join(&parts, picture, exec)?;
    let text = first.header.text.clone().unwrap_or_default();
    Ok(Assembled { frame: frame(picture.size(), channels)?, text, compression })
}

/// Reads the header of a part.
fn open(path: &Path) -> Result<Part<'_>> {
    let header = read_header(path)?;
    let names_its_version = |text: &String| {
        text.parse::<toml::Table>().is_ok_and(|table| table.contains_key("splatref"))
    };
    if !header.text.as_ref().is_some_and(names_its_version) {
        let what = "no text of splatref says which picture this is a part of; give files that \
                    `splatref render --region` wrote";
        return Err(Error::format(path, what));
    }
    let region = header.data.ok_or_else(|| {
        Error::format(path, "header: a data window that is not inside the picture; render it again")
    })?;
    Ok(Part { path, header, region })
}

/// Checks that two parts belong to one picture.
fn check(part: &Part<'_>, first: &Part<'_>) -> Result<()> {
    let (own, other) = (&part.header, &first.header);
    let place = first.path.display();
    let refuse = |what: String| {
        Err(Error::format(part.path, format!("{what}; give the parts of one picture")))
    };
    if (own.width, own.height) != (other.width, other.height) {
        return refuse(format!(
            "part of a picture of {} x {} pixels, but {place} is part of one of {} x {}",
            own.width, own.height, other.width, other.height
        ));
    }
    if own.text != other.text {
        let [own, other] = [own, other].map(|header| header.text.as_deref().unwrap_or_default());
        let [projects, finished] = ["the projection alone", "finished pixels"];
        let holds = |text| if is_projection(text) { projects } else { finished };
        if holds(own) != holds(other) {
            return refuse(format!("it holds {}, but {place} {}", holds(own), holds(other)));
        }
        return refuse(match differing(own, other) {
            Some(key) => format!("`{key}` is not as in {place}"),
            None => format!("its text is not as in {place}"),
        });
    }
    if own.channels != other.channels {
        let lacks = |here: &PictureHeader, there: &PictureHeader| {
            here.channels.iter().find(|one| !there.channels.contains(one)).map(|one| one.0.clone())
        };
        let name = lacks(own, other).or_else(|| lacks(other, own)).unwrap_or_default();
        return refuse(format!("its channel `{name}` is not as in {place}"));
    }
    Ok(())
}

/// The first entry in which two texts differ, such as `camera.f`.
fn differing(own: &str, other: &str) -> Option<String> {
    let [own, other]: [toml::Table; 2] = [own.parse().ok()?, other.parse().ok()?];
    let keys = |table: &toml::Table| table.keys().cloned().collect::<Vec<_>>();
    let mut all = keys(&own);
    all.extend(keys(&other).into_iter().filter(|key| !own.contains_key(key)));
    let key = all.into_iter().find(|key| own.get(key) != other.get(key))?;
    let (Some(toml::Value::Table(own)), Some(toml::Value::Table(other))) =
        (own.get(&key), other.get(&key))
    else {
        return Some(key);
    };
    let mut all = keys(own);
    all.extend(keys(other).into_iter().filter(|key| !own.contains_key(key)));
    all.into_iter().find(|inner| own.get(inner) != other.get(inner)).map(|i| format!("{key}.{i}"))
}

/// Checks that every pixel of a picture is in a part.
fn check_complete(picture: Rect, parts: &[Part<'_>]) -> Result<()> {
    let mut missing = vec![picture];
    for part in parts {
        missing = missing.iter().flat_map(|rect| without(rect, &part.region)).collect();
    }
    missing.sort_by_key(|rect| (rect.y0, rect.x0));
    let Some(Rect { x0, y0, x1, y1 }) = missing.first() else { return Ok(()) };
    let more = match missing.len() - 1 {
        0 => String::new(),
        count => format!(", and {count} more"),
    };
    Err(Error::Invalid(format!(
        "no part has the pixels of --region {x0},{y0},{x1},{y1}{more}; render them too"
    )))
}

/// The parts of a rectangle outside another one: above and below over the whole width, so that a
/// missing tile stays whole.
fn without(rect: &Rect, hole: &Rect) -> Vec<Rect> {
    let inner = rect.intersection(hole);
    if inner.is_empty() {
        return vec![*rect];
    }
    let around = [
        Rect { y1: inner.y0, ..*rect },
        Rect { x1: inner.x0, y0: inner.y0, y1: inner.y1, ..*rect },
        Rect { x0: inner.x1, y0: inner.y0, y1: inner.y1, ..*rect },
        Rect { y0: inner.y1, ..*rect },
    ];
    around.into_iter().filter(|rect| !rect.is_empty()).collect()
}

/// The channels of a picture by name.
type Channels = Vec<(String, Values)>;

/// Copies the pixels of all parts to their places.
fn join(parts: &[Part<'_>], picture: Rect, exec: &Exec) -> Result<(Channels, Compression)> {
    let (header, pixels) = (&parts[0].header, picture.pixels());
    // The colour is there twice while its channels are put together.
    memory::ask(4 * (pixels * (header.channels.len() + 3)) as u64, || {
        format!("a picture of {} x {} pixels", header.width, header.height)
    })?;
    let empty = |kind| match kind {
        ChannelType::Uint => Values::Index(vec![0; pixels]),
        ChannelType::Half | ChannelType::Float => Values::Float(vec![0.0; pixels]),
    };
    let mut channels: Channels =
        header.channels.iter().map(|(name, kind)| (name.clone(), empty(*kind))).collect();
    let projection = header.text.as_deref().is_some_and(is_projection);
    let mut compression = None;
    for (index, part) in parts.iter().enumerate() {
        let read = read_region(part.path, exec)?;
        let kinds = |values: &Values| matches!(values, Values::Float(_));
        let same = read.window.region == part.region
            && read.window.picture == picture.size()
            && read.image.text == header.text
            && read
                .image
                .channels
                .iter()
                .map(|(name, values)| (name, kinds(values)))
                .eq(channels.iter().map(|(name, values)| (name, kinds(values))));
        if !same {
            let what = "the file changed while it was read; assemble again";
            return Err(Error::format(part.path, what));
        }
        compression = compression.or(Some(read.compression.unwrap_or_default()));
        for ((name, whole), (_, own)) in channels.iter_mut().zip(&read.image.channels) {
            if let Some((x, y)) = nan(own, &part.region).filter(|_| projection) {
                let what = format!("`{name}` at pixel {x} {y} is NaN; render this part again");
                return Err(Error::format(part.path, what));
            }
            let differs = |before: &&Part<'_>| {
                let shared = before.region.intersection(&part.region);
                difference(own, &part.region, whole, &picture, &shared).is_some()
            };
            if let Some(before) = parts[..index].iter().find(differs) {
                let shared = before.region.intersection(&part.region);
                let at = difference(own, &part.region, whole, &picture, &shared);
                let (x, y) = at.unwrap_or_default();
                let other = before.path.display();
                let what =
                    format!("`{name}` at pixel {x} {y} differs from {other}; render both again");
                return Err(Error::format(part.path, what));
            }
            copy(own, &part.region, whole, &picture);
        }
    }
    Ok((channels, compression.unwrap_or_default()))
}

/// The first pixel of a part at which a channel is NaN.
fn nan(values: &Values, region: &Rect) -> Option<(u32, u32)> {
    let Values::Float(values) = values else { return None };
    let at = values.iter().position(|value| value.is_nan())?;
    let (x, y) = (at % region.columns(), at / region.columns());
    Some((region.x0 + x as u32, region.y0 + y as u32))
}

/// The indices of a row of `rect` in the values of a larger rectangle.
fn row(large: &Rect, rect: &Rect, y: u32) -> std::ops::Range<usize> {
    let start = (y - large.y0) as usize * large.columns() + (rect.x0 - large.x0) as usize;
    start..start + rect.columns()
}

/// The first pixel of `shared` at which two channels have other bits.
fn difference(
    own: &Values,
    region: &Rect,
    whole: &Values,
    picture: &Rect,
    shared: &Rect,
) -> Option<(u32, u32)> {
    if shared.is_empty() {
        return None;
    }
    (shared.y0..shared.y1).find_map(|y| {
        let (here, there) = (row(region, shared, y), row(picture, shared, y));
        let x = match (own, whole) {
            (Values::Float(own), Values::Float(whole)) => {
                let mut both = own[here].iter().zip(&whole[there]);
                both.position(|(a, b)| a.to_bits() != b.to_bits())
            }
            (Values::Index(own), Values::Index(whole)) => {
                own[here].iter().zip(&whole[there]).position(|(a, b)| a != b)
            }
            _ => Some(0),
        };
        Some((shared.x0 + x? as u32, y))
    })
}

/// Copies the values of a part to their place.
fn copy(own: &Values, region: &Rect, whole: &mut Values, picture: &Rect) {
    for y in region.y0..region.y1 {
        let (here, there) = (row(region, region, y), row(picture, region, y));
        match (own, &mut *whole) {
            (Values::Float(own), Values::Float(whole)) => {
                whole[there].copy_from_slice(&own[here]);
            }
            (Values::Index(own), Values::Index(whole)) => {
                whole[there].copy_from_slice(&own[here]);
            }
            _ => {}
        }
    }
}

/// The channels as planes: R, G and B as the colour of the picture, every other channel by itself.
fn frame([width, height]: [u32; 2], mut channels: Channels) -> Result<Frame<f32>> {
    let mut frame = Frame::new(width, height);
    let place = |channels: &Channels, wanted: &str| {
        channels
            .iter()
            .position(|(name, values)| name == wanted && matches!(values, Values::Float(_)))
    };
    if ["R", "G", "B"].iter().all(|name| place(&channels, name).is_some()) {
        let mut color = vec![[0.0; 3]; width as usize * height as usize];
        for (i, name) in ["R", "G", "B"].into_iter().enumerate() {
            let taken = place(&channels, name).map(|place| channels.remove(place).1);
            if let Some(Values::Float(values)) = taken {
                color.iter_mut().zip(values).for_each(|(pixel, value)| pixel[i] = value);
            }
        }
        frame.push("", Samples::Color(Plane::from_values(width, height, color)))?;
    }
    for (name, values) in channels {
        let samples = match values {
            Values::Float(values) => Samples::Scalar(Plane::from_values(width, height, values)),
            Values::Index(values) => Samples::Index(Plane::from_values(width, height, values)),
        };
        frame.push(&name, samples)?;
    }
    Ok(frame)
}
