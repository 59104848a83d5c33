//! What `study` and `plan` share: a scene, its candidates, and its true picture.

use super::options::{ExecOptions, SceneOptions};
use super::{progress, warn};
use splatref::frame::Exec;
use splatref::io::scene_file::SceneFile;
use splatref::study::run::Setup;
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
    pub(super) fn load(
        &self,
        scene: &SceneFile,
        exec: &Exec,
        steps: &progress::Steps,
    ) -> Result<Setup> {
        let show = |what: &str, done, of| steps.show(what, done, of);
        let truth = self.truth.as_deref().map(SceneFile::open).transpose()?;
        let only = self.options.chosen_method();
        let setup = Setup::load(scene, only, truth.as_ref(), exec, &show)?;
        warn(&setup.warnings);
        Ok(setup)
    }
}
