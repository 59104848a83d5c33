//! Load the geometries of objects. A geometry may have a file for each frame, which is read when the
//! frame is drawn.
//!
//! The method [`deferred`](crate::method::deferred) remembers surfels by their numbers, so it also draws
//! points that move \[GBP04, 4.3\]. The files of a sequence must therefore hold the same points in the
//! same order. This is checked: a file with another number of surfels is refused, and so is a file with a
//! point that cannot be a surfel.

use super::file_sequence::FileSequence;
use super::load::join_surfels;
use super::model::{Purpose, read};
use super::objects::Geometry as Choice;
use super::{Loaded, SceneFile, Source};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::progress::Progress;
use crate::scene::{Geometry, Object, Objects, Scene, Surfels};
use crate::source::sampler::estimate;
use glam::Vec3;
use std::ops::Range;
use std::path::{Path, PathBuf};

impl Choice {
    /// The files of the frames, if there is one for each.
    pub(super) fn files(&self) -> std::result::Result<Option<FileSequence>, String> {
        match &self.model.source {
            Source::File { path, .. } => FileSequence::of(path),
            Source::Shape { .. } | Source::Tree { .. } => Ok(None),
        }
    }
}

impl SceneFile {
    /// Loads the models and the geometries as geometries of objects, in frame 0.
    pub(super) fn load_objects(
        &self,
        objects: Vec<Object>,
        loaded: &mut Loaded,
        purpose: Purpose<'_>,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<()> {
        let fill = self.material.color;
        let own = self.models.iter().map(|model| Choice {
            name: model.source.name(),
            detail: None,
            model: model.clone(),
        });
        let mut geometries = Vec::new();
        for choice in own {
            geometries.push(loaded.geometry(&choice, fill, purpose, exec, progress)?);
        }
        for choice in &self.geometries {
            let files = choice.files().map_err(Error::Invalid)?;
            let Some(files) = files else {
                geometries.push(loaded.geometry(choice, fill, purpose, exec, progress)?);
                continue;
            };
            let (first, before) = (choice_at(choice, files.at(0)), loaded.dropped.total());
            let geometry = loaded.geometry(&first, fill, purpose, exec, progress)?;
            check_whole(&files.at(0), loaded.dropped.total() - before)?;
            let (index, count) = (geometries.len(), geometry.surfels.len());
            loaded.moving.geometries.push(MovingGeometry { index, count, files, choice: first });
            geometries.push(geometry);
        }
        loaded.moving.fill = fill;
        loaded.scene.objects = Some(Objects::new(geometries, objects, fill)?);
        Ok(())
    }
}

impl Loaded {
    /// Reads a geometry.
    fn geometry(
        &mut self,
        Choice { name, detail, model }: &Choice,
        fill: Vec3,
        purpose: Purpose<'_>,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Geometry> {
        let part = read(model, purpose, true, exec, progress)?;
        let (surfels, primitives) =
            self.place(model, part, name.clone(), purpose, exec, progress)?;
        let parts = if surfels.is_empty() { vec![] } else { vec![(model.clone(), surfels)] };
        let (surfels, lost) = join_surfels(parts, primitives.is_empty(), fill, exec)?;
        self.dropped += lost;
        let geometry = Geometry { name: name.clone(), surfels, primitives, detail: None };
        match detail {
            Some(threshold) => geometry.with_detail(*threshold, exec),
            None if model.progressive => in_order(geometry),
            None => Ok(geometry),
        }
    }
}

/// A geometry of ordered surfels, which views draw as a prefix.
fn in_order(geometry: Geometry) -> Result<Geometry> {
    let estimate = estimate(geometry.surfels.position(), geometry.surfels.normal());
    geometry.with_prefix(estimate)
}

/// The geometries that have a file for each frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Moving {
    geometries: Vec<MovingGeometry>,
    /// The colour of surfels without one.
    fill: Vec3,
}

impl Moving {
    pub(super) fn is_empty(&self) -> bool {
        self.geometries.is_empty()
    }

    /// Checks, before long work, that the files of these frames exist.
    pub(super) fn check_files(&self, frames: Range<u32>) -> Result<()> {
        let all = self.geometries.iter();
        let mut files = all.flat_map(|one| frames.clone().map(|frame| one.files.at(frame)));
        files.try_for_each(|path| match std::fs::metadata(&path) {
            Ok(_) => Ok(()),
            Err(error) => Err(Error::io(&path, error)),
        })
    }

    /// The objects in a frame, with its geometries; and what is to be doubted about its files.
    ///
    /// # Errors
    /// As [`SceneFile::load`] and [`Objects::at`]; [`Error::Format`] if a file has not the surfels of
    /// frame 0.
    pub(super) fn at(
        &self,
        objects: Objects,
        frame: u32,
        exec: &Exec,
    ) -> Result<(Objects, Vec<String>)> {
        let mut warnings = Vec::new();
        // The geometries are those of the frame that the objects are in.
        if self.is_empty() || objects.frame() == frame {
            return Ok((objects.at(frame)?, warnings));
        }
        let mut read = Vec::new();
        for one in &self.geometries {
            let (geometry, doubts) = one.read(frame, self.fill, exec)?;
            read.push((one.index, geometry));
            warnings.extend(doubts);
        }
        Ok((objects.with_geometries(read).at(frame)?, warnings))
    }
}

/// A geometry that has a file for each frame.
#[derive(Clone, Debug)]
struct MovingGeometry {
    /// Its number in the scene.
    index: usize,
    /// How many surfels it has in every frame.
    count: usize,
    files: FileSequence,
    /// The geometry in frame 0.
    choice: Choice,
}

impl MovingGeometry {
    /// The geometry in a frame, and what is to be doubted about its file.
    fn read(&self, frame: u32, fill: Vec3, exec: &Exec) -> Result<(Geometry, Vec<String>)> {
        let path = self.files.at(frame);
        let choice = choice_at(&self.choice, path.clone());
        let mut loaded = Loaded::nothing_of(Scene::unlit(&choice.name, Surfels::none()));
        let quiet = &|_: &str, _, _| ();
        let geometry = loaded.geometry(&choice, fill, Purpose::Scene, exec, quiet)?;
        check_whole(&path, loaded.dropped.total())?;
        let (count, first) = (geometry.surfels.len(), self.count);
        if count != first {
            let of_first = self.files.at(0);
            let what = format!(
                "{count} surfels, but {} has {first}; give every frame the same points in the same order",
                of_first.display()
            );
            return Err(Error::format(&path, what));
        }
        Ok((geometry, loaded.warnings))
    }
}

/// A geometry with the file of a frame.
fn choice_at(choice: &Choice, frame: PathBuf) -> Choice {
    let mut choice = choice.clone();
    if let Source::File { path, .. } = &mut choice.model.source {
        *path = frame;
    }
    choice
}

/// Checks that no point of a file was lost, because those behind it would get other numbers.
fn check_whole(path: &Path, lost: u64) -> Result<()> {
    if lost > 0 {
        let what = format!(
            "{lost} points cannot be surfels, so the points behind them would change their numbers; \
             give every frame the same points, all with finite values"
        );
        return Err(Error::format(path, what));
    }
    Ok(())
}
