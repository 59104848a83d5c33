//! What `study` and `plan` share: a scene, its candidates, and its true picture.

use super::options::{ExecOptions, SceneOptions};
use super::{progress, warn};
use splatref::frame::Exec;
use splatref::io::scene_file::SceneFile;
use splatref::scene::Camera;
use splatref::study::run::truths::Known;
use splatref::study::run::{Bench, LeftOut};
use splatref::study::sweep::{Candidate, candidates};
use splatref::study::truth::Truth;
use splatref::{Error, Result};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(super) struct Tried {
    /// A .ply, .obj, .las, .laz, .e57, .glb, .gltf, .splat or .spz, a scene .toml, a folder of surfels, or a shape
    // Required, except before a subcommand.
    #[arg(required = true)]
    scene: Option<PathBuf>,
    /// Use the surface of this scene as the truth, such as the mesh that the points were sampled
    /// from
    #[arg(long, value_name = "SCENE")]
    truth: Option<PathBuf>,
    #[command(flatten)]
    exec: ExecOptions,
    #[command(flatten)]
    options: SceneOptions,
}

/// Everything that is loaded before anything is measured.
pub(super) struct Loaded<'e> {
    pub(super) bench: Bench<'e>,
    pub(super) candidates: Vec<Candidate>,
    pub(super) left_out: Vec<LeftOut>,
    pub(super) known: Known,
    pub(super) camera: Camera,
}

impl Tried {
    /// The path of the scene.
    pub(super) fn path(&self) -> Result<&Path> {
        self.scene.as_deref().ok_or_else(|| Error::Usage("give a scene".into()))
    }

    /// The scene, with the options applied.
    pub(super) fn scene_file(&self) -> Result<SceneFile> {
        self.options.refuse_state("every candidate starts without a state; remove the option")?;
        self.options.scene_file(self.path()?)
    }

    /// The scene of the truth, if it is another one.
    pub(super) fn truth(&self) -> Option<&Path> {
        self.truth.as_deref()
    }

    pub(super) fn exec(&self) -> Result<Exec> {
        self.exec.exec()
    }

    /// Loads the scene and its candidates.
    pub(super) fn load<'e>(
        &self,
        scene: &SceneFile,
        exec: &'e Exec,
        steps: &progress::Steps,
    ) -> Result<Loaded<'e>> {
        let show = |what: &str, done, of| steps.show(what, done, of);
        let all = candidates(scene, self.options.chosen_method())?;
        let (mut bench, candidates, left_out) = Bench::load(all, exec, &show)?;
        let other = self.truth.as_deref().map(SceneFile::open).transpose()?;
        let shown = other.as_ref().unwrap_or(scene);
        let ready = bench.visit(&candidates[0], &show)?.ready;
        let known = Known::about(shown, &ready.loaded.scene, exec, &show)?;
        let camera = ready.camera;
        warn(&ready.loaded.warnings);
        Ok(Loaded { bench, candidates, left_out, known, camera })
    }
}

/// How the truth is computed, and why it is no better.
pub(super) fn truth_in_words(known: &Known, truth: &Truth) -> String {
    known.unknown().map_or_else(|| truth.how.to_string(), |why| format!("{} ({why})", truth.how))
}
