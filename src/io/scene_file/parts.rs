//! Write a model as a folder of blocks, and draw the folder part by part: each part of a picture reads
//! what it may show.

use super::model::Purpose;
use super::{Draw, FileKind, Loaded, ModelReport, Ready, SceneFile, Source, load, offset};
use crate::error::{Error, Result};
use crate::frame::{Exec, Rect};
use crate::io::blocks::{self, Blocks, Input, Tiled};
use crate::io::ply::Stream;
use crate::progress::Progress;
use crate::scene::{Counts, Dropped, Scene};
use crate::source::derive::{Derived, Origin};
use std::path::Path;

impl SceneFile {
    /// As [`SceneFile::ready`]. But if the scene is one folder of [blocks], as it
    /// is in the folder, and each pixel of the method depends on its own fragments alone, then nothing
    /// of the folder is read yet except its index: call [`Ready::part`] before you draw.
    ///
    /// # Errors
    /// As [`SceneFile::ready`].
    pub fn ready_in_parts(&self, exec: &Exec, progress: Progress<'_>) -> Result<Ready> {
        self.ready_for(Purpose::Parts, exec, progress)
    }

    /// Writes the surfels of a model into a folder of [blocks], in spatial order. The
    /// parent of the folder must exist. Blocks that are already there are replaced as a whole.
    ///
    /// A complete binary little-endian PLY of vertices with normals, radii and float coordinates is
    /// read in parts. Every other model is loaded as a whole, with what must be derived for it; the
    /// folder holds what was derived.
    ///
    /// `progress` gets the name of a step, how many surfels are done, and their total.
    ///
    /// # Errors
    /// [`Error::Usage`] if the scene is not one model without choices of its own, such as a place.
    /// [`Error::Format`] if no surfel is left, if the model has triangles that are drawn, Gaussians,
    /// groups or prefiltered colours, or if the folder holds a [hierarchy](crate::io::hierarchy).
    /// [`Error::Io`] if a file cannot be read or written; else as [`SceneFile::load`]. An error if the
    /// process may not hold a few MiB, or a model that is loaded as a whole.
    pub fn tile(&self, folder: &Path, exec: &Exec, progress: Progress<'_>) -> Result<Tiled> {
        let alone = Self::of_model(match self.models.as_slice() {
            [model] => model.source.clone(),
            _ => return Err(self.no_model()),
        });
        if alone.models != self.models || self.has_objects() || !self.objects.is_empty() {
            return Err(self.no_model());
        }
        let stream = match &alone.models[0].source {
            Source::File { path, .. } if FileKind::from_extension(path)? == FileKind::Ply => {
                Stream::open(path)?
            }
            _ => Err("it is no PLY"),
        };
        let (mut input, dropped) = match stream {
            Ok(stream) => (Input::Stream(stream), 0),
            Err(why) => alone.loaded_input(why, exec, progress)?,
        };
        let built = blocks::build(&mut input, folder, exec, progress)?;
        let tiled = built.ok_or_else(|| {
            let what = "none of its points can be a surfel: give finite positions, normals that are \
                        not zero, and radii above 0";
            Error::Invalid(format!("{}: {what}", self.name))
        })?;
        Ok(Tiled { dropped: tiled.dropped + dropped, ..tiled })
    }

    /// Why a scene cannot be tiled.
    fn no_model(&self) -> Error {
        Error::Usage(format!("{}: only one model as its file has it can be tiled", self.name))
    }

    /// The surfels of a model that cannot be read in parts, and how many points were dropped.
    fn loaded_input(&self, why: &str, exec: &Exec, progress: Progress<'_>) -> Result<(Input, u64)> {
        let whole = |what: String| format!("{what}; the file was not read in parts, because {why}");
        let Loaded { scene, dropped, .. } =
            self.load(exec, progress).map_err(|error| match error {
                Error::Invalid(what) => Error::Invalid(whole(what)),
                Error::Format { path, what } => Error::Format { path, what: whole(what) },
                other => other,
            })?;
        let held = [
            (scene.gaussians.is_some(), "3D Gaussians"),
            (!scene.primitives.is_empty(), "triangles or lines"),
            (scene.surfels.groups().is_some(), "groups"),
            (scene.surfels.mipmap().is_some(), "prefiltered colours"),
        ];
        if let Some((_, what)) = held.iter().find(|(is, _)| *is) {
            return Err(Error::Invalid(format!("{}: {what} cannot be tiled", self.name)));
        }
        Ok((Input::Loaded(scene.surfels, scene.offset), dropped.total()))
    }

    /// The folder that can be read in parts, if the scene is one.
    pub(super) fn blocks(&self) -> Result<Option<Blocks>> {
        let [model] = self.models.as_slice() else { return Ok(None) };
        let Source::File { path, prefix, texture, color_range, color_by, .. } = &model.source
        else {
            return Ok(None);
        };
        let changed = prefix.is_some()
            || texture.is_some()
            || color_range.is_some()
            || color_by.is_some()
            || model.mipmaps.is_some_and(|levels| levels > 0)
            || !load::is_as_read(model);
        let drawn = matches!(model.draw, Draw::Surfels | Draw::Points);
        let whole = self.method.method()?.skirt().is_none();
        if changed || !drawn || whole || self.has_objects() || !Blocks::is_in(path) {
            return Ok(None);
        }
        let blocks = Blocks::open(path)?;
        let (low, high) = blocks.bounds();
        let reach = f64::from(low.abs().max(high.abs()).max_element());
        // Where the scene takes another offset than the file, it moves every surfel.
        let own = blocks.offset();
        let scene = offset::of_model(model, own, || reach).unwrap_or_default();
        Ok((scene == own).then_some(blocks))
    }
}

impl Loaded {
    /// Whether the scene is a folder of [blocks] of which nothing is read yet except its index: then
    /// [`Ready::part`] reads what a picture shows.
    #[must_use]
    pub fn is_in_parts(&self) -> bool {
        self.blocks.is_some()
    }

    /// Takes the index of a folder of blocks, and none of its surfels.
    pub(super) fn read_index(&mut self, blocks: Blocks, name: String, exec: &Exec) -> Result<()> {
        let (surfels, excerpt) = blocks.nothing(exec)?;
        self.move_to(blocks.offset());
        let derived = Derived {
            normals: Origin::File,
            radii: Origin::File,
            dropped: Dropped::default(),
            dropped_primitives: 0,
        };
        self.models.push(ModelReport {
            name,
            surfels: excerpt.total() as usize,
            primitives: Counts::default(),
            derived: Some(derived),
            colored: None,
        });
        (self.scene.surfels, self.scene.excerpt) = (surfels, Some(excerpt));
        self.blocks = Some(blocks);
        Ok(())
    }
}

impl Ready {
    /// The most surfels that [`Ready::part`] reads for a region of the picture, and the bytes that it
    /// needs to hold them; none if the scene was loaded as a whole.
    #[must_use]
    pub fn most_of_part(&self, region: Rect) -> (u64, u64) {
        match (&self.loaded.blocks, self.method.skirt()) {
            (Some(blocks), Some(skirt)) => blocks.most_near(&self.camera, region, skirt),
            _ => (0, 0),
        }
    }

    /// The scene with the surfels that may touch a region of the picture, or the whole picture, read
    /// from a folder of blocks; the picture of that scene has the same bits there. `None` if the scene
    /// was loaded as a whole.
    ///
    /// # Errors
    /// As [`Camera::check_region`](crate::scene::Camera::check_region) and [`Blocks::read`].
    pub fn part(&self, region: Option<Rect>, exec: &Exec) -> Result<Option<Scene>> {
        let (Some(blocks), Some(skirt)) = (&self.loaded.blocks, self.method.skirt()) else {
            return Ok(None);
        };
        let region = region.unwrap_or(Rect::of_size(self.camera.size()));
        self.camera.check_region(&region)?;
        let (surfels, excerpt) = blocks.near(&self.camera, region, skirt, exec)?;
        Ok(Some(Scene { surfels, excerpt: Some(excerpt), ..self.loaded.scene.clone() }))
    }
}
