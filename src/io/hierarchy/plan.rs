//! Hash the settings and the scene, and check that a folder belongs to them.

use super::bytes::{Hash, Writer};
use super::index::similarity;
use crate::error::{Error, Result};
use crate::io::input;
use crate::io::replace::{NewFolder, write_atomically};
use crate::scene::Object;
use crate::source::candidates::Directions;
use crate::source::hierarchy::{Sampler, Settings, Traversal};
use crate::source::sampler::Schedule;
use glam::Vec3;
use sha2::{Digest, Sha256};
use std::fs;
use std::io::Write;
use std::path::Path;

const MAGIC: &str = "splatref hierarchy 1\n";

/// The hash of all that decides what is computed from the geometries.
pub(super) fn hash(settings: &Settings, fill: Vec3, objects: &[Object], geometries: usize) -> Hash {
    let Settings { most, side, directions, sampler, seed, traversal, properties } = settings;
    let mut to = Writer::default();
    to.bytes(MAGIC.as_bytes());
    to.words(&[*most, *side]);
    let sampler = match sampler {
        Sampler::Greedy => 0,
        Sampler::Progressive(Schedule::Paper) => 1,
        Sampler::Progressive(Schedule::AsShipped) => 2,
        Sampler::Random => 3,
    };
    // Not 1, the word of a version that drew surfels as squares: a folder that it began is refused.
    let traversal = match traversal {
        Traversal::TopDown => 0,
        Traversal::BottomUp => 2,
    };
    to.bytes(&[sampler, traversal]);
    to.long(*seed);
    match directions {
        Directions::Cube => to.words(&[0]),
        Directions::Box => to.words(&[1]),
        Directions::These(all) => {
            to.words(&[2 + all.len() as u32]);
            all.iter().flat_map(|d| d.to_array()).for_each(|v| to.double(v));
        }
    }
    to.vector(fill);
    to.long(geometries as u64);
    to.long(objects.len() as u64);
    for object in objects {
        to.long(object.geometry as u64);
        to.long(object.motion.keys().len() as u64);
        for (frame, place) in object.motion.keys() {
            to.words(&[*frame]);
            similarity(&mut to, place);
        }
        to.bytes(&[u8::from(object.color.is_some())]);
        object.color.iter().for_each(|color| to.vector(*color));
    }
    properties.iter().for_each(|name| to.text(name));
    Sha256::digest(&to.0).into()
}

/// The hash of a hierarchy.
pub(super) fn of_all(plan: &Hash, geometries: &[Hash]) -> Hash {
    let mut hash = Sha256::new();
    hash.update(plan);
    geometries.iter().for_each(|geometry| hash.update(geometry));
    hash.finalize().into()
}

/// Makes a folder for a plan, unless it is already there; returns whether it was.
pub(super) fn begin(folder: &Path, plan: &Hash) -> Result<bool> {
    let io = |source| Error::io(folder, source);
    let _goes_if_empty = NewFolder::make(folder)?;
    let path = folder.join("plan");
    let digits: String = plan.iter().map(|byte| format!("{byte:02x}")).collect();
    let text = format!("{MAGIC}{digits}\n");
    if path.exists() {
        let found = input::bytes(&path).map_err(|source| Error::io(&path, source))?;
        if found != text.as_bytes() {
            return Err(refused(folder, "other settings, other objects or another version"));
        }
        return Ok(true);
    }
    for entry in fs::read_dir(folder).map_err(io)? {
        // A run that was killed before the plan was written may leave a partial file.
        let name = entry.map_err(io)?.file_name();
        if !name.to_string_lossy().ends_with(".partial") {
            let what = "the folder holds other files; give the name of a new folder";
            return Err(Error::format(folder, what));
        }
    }
    write_atomically(&path, |to| to.write_all(text.as_bytes()))?;
    Ok(false)
}

/// The error for a folder that holds another hierarchy.
pub(super) fn refused(folder: &Path, of: &str) -> Error {
    let what = format!("the folder holds a hierarchy of {of}; remove it, or give another name");
    Error::format(folder, what)
}
