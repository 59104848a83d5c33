//! Turn a TOML file's description into the planes of a client.

use super::convert;
use super::files::{Files, Kind};
use super::numbers::{Numbers, ask};
use super::octahedral;
use super::parse::{DepthKeys, PlaneKeys, Sidecar};
use super::records;
use super::straight::straight;
use super::wanted::Wanted;
use crate::error::{Error, Result};
use crate::frame::named::{COLOR, component};
use crate::frame::{Exec, Frame, Image, Plane, Samples};
use crate::io::Reason;
use crate::method::{Algorithm, Holds, Stage, gaussians};
use crate::verdict::client::{Client, Storage};
use std::path::{Path, PathBuf};

/// A plane after reading.
struct Read {
    wanted: Wanted,
    samples: Samples<f64>,
    storage: Storage,
}

/// Reads the planes of these stages that the file at `path` describes.
pub(super) fn client(
    path: &Path,
    sidecar: &Sidecar,
    stages: &[Stage],
    camera: [u32; 2],
    exec: &Exec,
) -> Result<Client> {
    let refused = |what: String| Error::format(path, what);
    let mut files = Files::new(exec, &sidecar.arrays);
    let mut wanted = named(sidecar, stages).map_err(refused)?;
    let mut unknown = Vec::new();
    if let Some(file) = &sidecar.file {
        if Kind::from_extension(file) != Some(Kind::Exr) {
            let what = "file: only an EXR holds several planes; name other files in [planes]";
            return Err(Error::format(path, what));
        }
        let image = &files.picture(file, Kind::Exr)?.image;
        // // A name in [planes] wins over a channel of the common file.
        wanted.extend(in_picture(image, &wanted, stages, sidecar.depth));
        unknown = left(image, &wanted, file);
    }
    if wanted.is_empty() {
        return Err(refused(format!(
            "no channel has the name of a plane; the planes are {}",
            names(stages)
        )));
    }
    let planes = read(path, sidecar, wanted, camera, &mut files)?;
    drop(files);
    let mut client = joined(planes).map_err(|error| match error {
        Error::Invalid(what) => Error::format(path, what),
        other => other,
    })?;
    client.rounding = sidecar.rounding;
    client.accumulator = sidecar.accumulator;
    client.ties = sidecar.ties;
    client.depth_test = sidecar.depth_test;
    client.unknown = unknown;
    if let Some(place) = &sidecar.records {
        // Each of the two kinds of records has its method.
        if stages == <gaussians::Settings as Algorithm>::STAGES {
            client.gaussian_records = Some(records::gaussians(place)?);
        } else {
            client.records = Some(records::splats(place)?);
        }
    }
    Ok(client)
}

/// The planes that the TOML file lists.
fn named(sidecar: &Sidecar, stages: &[Stage]) -> Reason<Vec<Wanted>> {
    let mut all: Vec<Wanted> = Vec::new();
    for (key, keys) in &sidecar.planes {
        let row_of = |name: &str| stages.iter().find_map(|stage| stage.row(name));
        // Colours as NPY and EXR files name them: `RGB` for the picture, `attributes.RGB` for a
        // stage.
        let color = if key == "RGB" { Some("") } else { key.strip_suffix(".RGB") };
        let color = color.and_then(|name| Some((name, row_of(name)?)));
        let color = color.filter(|(_, row)| row.holds == Holds::Color);
        let found = row_of(key).map(|row| (key.as_str(), row)).or(color);
        let (name, row) = found.ok_or_else(|| {
            let known = names(stages);
            format!("planes: no plane is called `{}`; there are {known}", key.escape_debug())
        })?;
        if let Some(twin) = all.iter().find(|other| other.name == name) {
            return Err(format!(
                "planes: `{}` and `{key}` are the same plane; remove one",
                twin.key
            ));
        }
        all.push(Wanted::new(key, name, row, keys.clone(), sidecar.depth));
    }
    Ok(all)
}

/// The names of all planes of these stages, as a TOML file spells them.
fn names(stages: &[Stage]) -> String {
    let rows = stages.iter().flat_map(|stage| stage.leaves);
    let names = rows.map(|row| if row.name.is_empty() { "RGB" } else { row.name });
    names.collect::<Vec<_>>().join(", ")
}

/// The further planes that a picture holds under the crate's names.
fn in_picture(image: &Image, wanted: &[Wanted], stages: &[Stage], all: DepthKeys) -> Vec<Wanted> {
    let mut found: Vec<Wanted> = Vec::new();
    for row in stages.iter().flat_map(|stage| stage.leaves) {
        for (channel, _) in &image.channels {
            // One of three channels stands for the plane, so that it is found once.
            let name = match row.holds.plain() {
                Holds::Color if channel == COLOR[0] => Some(""),
                Holds::Color => channel.strip_suffix(".R"),
                Holds::Vector => channel.strip_suffix(".X"),
                _ => Some(channel.as_str()),
            };
            let Some(name) = name.filter(|name| row.is_called(name)) else { continue };
            let is_new = wanted.iter().chain(&found).all(|other| other.name != name);
            if is_new && row.holds.channels(name).iter().all(|name| image.channel(name).is_some()) {
                let key = if name.is_empty() { "RGB" } else { name };
                found.push(Wanted::new(key, name, row, PlaneKeys::default(), all));
            }
        }
    }
    found
}

/// The channels of a picture that no plane uses.
fn left(image: &Image, wanted: &[Wanted], file: &Path) -> Vec<String> {
    let of_it = |wanted: &&Wanted| wanted.keys.file.as_deref().is_none_or(|of| of == file);
    let taken = wanted
        .iter()
        .filter(of_it)
        .flat_map(|wanted| wanted.chosen().unwrap_or_else(|| wanted.channels()));
    let taken: Vec<String> = taken.collect();
    let names = image.channels.iter().map(|(name, _)| name);
    names.filter(|name| !taken.contains(name)).cloned().collect()
}

/// Reads the planes; raw files last, because the other files know their own size.
fn read(
    path: &Path,
    sidecar: &Sidecar,
    wanted: Vec<Wanted>,
    camera: [u32; 2],
    files: &mut Files<'_>,
) -> Result<Vec<Read>> {
    let mut placed = Vec::new();
    for wanted in wanted {
        let (file, kind) = file_of(&wanted, sidecar).map_err(|what| Error::format(path, what))?;
        placed.push((kind, file, wanted));
    }
    placed.sort_by_key(|(kind, ..)| *kind == Kind::Raw);
    let mut size = sidecar.size.map(|size| (size, "`size`".to_owned()));
    let mut planes = Vec::new();
    for (kind, file, wanted) in placed {
        let raw = size.as_ref().map_or(camera, |(size, _)| *size);
        let numbers = files.numbers(&wanted, &file, kind, raw)?;
        let (known, of) =
            size.get_or_insert_with(|| (numbers.size, format!("planes.{}", wanted.key)));
        let ([w, h], [width, height]) = (numbers.size, *known);
        if [w, h] != [width, height] {
            return Err(Error::format(
                path,
                format!("planes.{}: {w} x {h} pixels, but {of} is {width} x {height}", wanted.key),
            ));
        }
        planes.push(
            turned(sidecar, wanted, kind, numbers).map_err(|what| Error::format(path, what))?,
        );
    }
    Ok(planes)
}

/// The file of a plane.
fn file_of(wanted: &Wanted, sidecar: &Sidecar) -> Reason<(PathBuf, Kind)> {
    let key = &wanted.key;
    let plain = key.trim_matches('"');
    if sidecar.arrays.contains_key(plain) {
        return Ok((plain.into(), Kind::Array));
    }
    let file = wanted.keys.file.as_ref().or(sidecar.file.as_ref());
    let file = file.ok_or_else(|| {
        format!("planes.{key}: no `file`, neither here nor for all planes; give one")
    })?;
    let kind = Kind::from_extension(file).ok_or_else(|| {
        format!("planes.{key}.file is {file:?}; give an .exr, .npy, .npz, .png, .raw or .bin")
    })?;
    Ok((file.clone(), kind))
}

/// Turns the numbers of a file into a plane.
fn turned(sidecar: &Sidecar, wanted: Wanted, kind: Kind, mut numbers: Numbers) -> Reason<Read> {
    if sidecar.upwards {
        numbers.flip();
    }
    let (samples, storage) = convert::plane(&wanted, kind, numbers)
        .map_err(|what| format!("planes.{}: {what}", wanted.key))?;
    Ok(Read { wanted, samples, storage })
}

/// Joins the planes into a client. Premultiplied colours are divided by alpha, and vectors in two
/// numbers are decoded.
fn joined(mut planes: Vec<Read>) -> Result<Client> {
    let mut radii = Vec::new();
    for i in 0..planes.len() {
        let Read { wanted, samples, storage } = &planes[i];
        let (changed, off) = match samples {
            Samples::Color(color) if wanted.keys.premultiplied == Some(true) => {
                let name = component(&wanted.name, "A");
                let (alpha, alpha_storage) = other(&planes, wanted, "premultiplied", &name)?;
                ask([color.width(), color.height()], 3).map_err(Error::Invalid)?;
                let (values, off) = straight(color, *storage, alpha, alpha_storage);
                (Samples::Color(values), off)
            }
            Samples::Vector(pairs) if wanted.is_octahedral() => {
                let (layer, _) = wanted.name.rsplit_once('.').unwrap_or_default();
                let (depths, _) = other(&planes, wanted, "octahedral", &component(layer, "Z"))?;
                ask([pairs.width(), pairs.height()], 3).map_err(Error::Invalid)?;
                let (values, off) = octahedral::decoded(pairs, *storage, depths);
                (Samples::Vector(values), off)
            }
            _ => continue,
        };
        radii.push((wanted.name.clone(), off));
        planes[i].samples = changed;
    }
    let (width, height) = planes.first().map_or((0, 0), |plane| plane.samples.size());
    let mut frame = Frame::new(width, height);
    let mut storages = Vec::new();
    for Read { wanted, samples, storage } in planes {
        frame.push(&wanted.name, samples)?;
        storages.push((wanted.name, storage));
    }
    let client = Client::new(frame);
    let client =
        storages.into_iter().fold(client, |client, (name, storage)| client.stored(&name, storage));
    radii.into_iter().try_fold(client, |client, (name, off)| client.within(&name, off))
}

/// Finds the plane that a key of another plane needs.
fn other<'a>(
    planes: &'a [Read],
    wanted: &Wanted,
    key: &str,
    name: &str,
) -> Result<(&'a Plane<f64>, Storage)> {
    let found = planes.iter().find_map(|plane| match &plane.samples {
        Samples::Scalar(found) if plane.wanted.name == name => Some((found, plane.storage)),
        _ => None,
    });
    found.ok_or_else(|| {
        Error::Invalid(format!("planes.{}: `{key}` needs the plane `{name}`", wanted.key))
    })
}
