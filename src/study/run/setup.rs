//! Everything that is loaded before anything is measured.

use super::bench::{Bench, LeftOut};
use super::record::Subject;
use super::truths::{Known, Truths};
use crate::compare::digest;
use crate::error::Result;
use crate::frame::{Exec, Image};
use crate::io::provenance;
use crate::io::scene_file::SceneFile;
use crate::progress::Progress;
use crate::scene::Camera;
use crate::study::sweep::{Candidate, candidates};

/// The candidates of a scene, and its truth.
#[derive(Debug)]
pub struct Setup {
    /// The scenes of the candidates.
    pub bench: Bench,
    /// The candidates that can be drawn, in the order of [`mod@crate::study::sweep`]; at least one.
    pub candidates: Vec<Candidate>,
    /// The methods that cannot draw the scene, and why.
    pub left_out: Vec<LeftOut>,
    /// The content of the true picture.
    pub known: Known,
    /// The camera, the same for all candidates.
    pub camera: Camera,
    /// What was read in an unexpected way: one line each.
    pub warnings: Vec<String>,
}

impl Setup {
    /// Loads the candidates of a scene; with `only`, those of one method. The truth is the surface
    /// of `truth`, or of the scene itself if absent.
    ///
    /// # Errors
    /// As [`candidates`], [`Bench::load`] and [`Known::about`].
    pub fn load(
        scene: &SceneFile,
        only: Option<&str>,
        truth: Option<&SceneFile>,
        exec: &Exec,
        progress: Progress<'_>,
    ) -> Result<Self> {
        let all = candidates(scene, only)?;
        let (mut bench, candidates, left_out) = Bench::load(all, exec, progress)?;
        let ready = bench.visit(&candidates[0], exec, progress)?.ready;
        let known = Known::about(truth.unwrap_or(scene), &ready.loaded.scene, exec, progress)?;
        let (camera, warnings) = (ready.camera, ready.loaded.warnings.clone());
        Ok(Self { bench, candidates, left_out, known, camera, warnings })
    }

    /// The subject of the study, with its true pictures.
    ///
    /// # Errors
    /// As [`Bench::visit`] and [`crate::io::scene_file::Ready::identity`].
    pub fn subject(&mut self, truths: &Truths, exec: &Exec) -> Result<Subject> {
        let (first, camera) = (&self.candidates[0], &self.camera);
        let ready = self.bench.visit(first, exec, &|_, _, _| ())?.ready;
        Ok(Subject {
            splatref: env!("CARGO_PKG_VERSION").into(),
            scene: first.file.name.clone(),
            scene_sha256: ready.identity(exec)?,
            size: [camera.width, camera.height],
            camera: provenance::camera(camera, ready.loaded.scene.offset),
            truth: self.known.in_words(&truths.still),
            truth_sha256: digest::sha256([("truth", &Image::from(&truths.still.frame))]),
        })
    }
}
