//! The files that `splatref render` writes.

use super::options::SceneOptions;
use super::output;
use splatref::frame::{Exec, Frame, Rect};
use splatref::index::seen::Seen;
use splatref::io::client::{DepthConvention, DepthFile};
use splatref::io::exr::{self, Window};
use splatref::io::replace::Pending;
use splatref::io::scene_file::{FileKind, OutputSettings, Ready, SceneFile};
use splatref::io::state::{self, State};
use splatref::io::{png, provenance};
use splatref::method::{Method, Session};
use splatref::scene::{Camera, Groups, Scene};
use splatref::{Error, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// The default folder of pictures; made when they are written.
const FOLDER: &str = "out";

/// What the command line says of the files of `render`.
pub(super) struct Destination<'a> {
    pub(super) scene: &'a Path,
    /// Where the picture goes, if somebody says.
    pub(super) output: Option<&'a Path>,
    /// Where what the last frame saw goes, if it is kept.
    pub(super) keep_state: Option<&'a Path>,
    pub(super) options: &'a SceneOptions,
    /// The part of the picture that is drawn; none: all of it.
    pub(super) region: Option<Rect>,
    pub(super) depth: Option<Depth>,
}

/// A file of depths beside the picture.
#[derive(Clone, Copy)]
pub(super) struct Depth {
    pub(super) file: DepthFile,
    pub(super) convention: DepthConvention,
}

impl Depth {
    /// The file, and the TOML file that describes it.
    pub(super) fn places(self, picture: &Path) -> [PathBuf; 2] {
        let kind = self.file.extension();
        [kind, "toml"].map(|end| picture.with_extension(format!("depth.{end}")))
    }
}

impl Destination<'_> {
    /// The path of the picture, or of one of several, whose name ends in `part`.
    pub(super) fn place(&self, file: &SceneFile, part: &str) -> Result<PathBuf> {
        let named = |path: &Path| match part {
            "" => path.to_owned(),
            part => path.with_extension(format!("{part}.exr")),
        };
        match self.output {
            Some(path) if matches!(FileKind::from_extension(path), Ok(FileKind::Exr)) => {
                let path = named(path);
                output::check(&path, self.scene, file)?;
                self.check_depth(&path, file)?;
                Ok(path)
            }
            Some(path) => {
                let path = path.display();
                Err(Error::Usage(format!(
                    "{path}: the picture is an EXR; give a name that ends in .exr"
                )))
            }
            None => {
                // Parts with names of their own, so that none replaces another, or the whole picture.
                let part = self.region.map_or(String::new(), |Rect { x0, y0, x1, y1 }| {
                    format!(".{x0}-{y0}-{x1}-{y1}")
                });
                let path = named(&Path::new(FOLDER).join(format!("{}{part}.exr", file.name)));
                output::check_unread(&path, self.scene, file)?;
                self.check_depth(&path, file)?;
                Ok(path)
            }
        }
    }

    /// Checks that the scene is not read from the files of the depths.
    fn check_depth(&self, picture: &Path, file: &SceneFile) -> Result<()> {
        let places = self.depth.iter().flat_map(|depth| depth.places(picture));
        places.into_iter().try_for_each(|place| output::check_unread(&place, self.scene, file))
    }

    /// Writes the state after a frame, if `--keep-state` asks for it.
    pub(super) fn keep(
        &self,
        ready: &Ready,
        frame: u32,
        seen: Option<&Seen>,
        exec: &Exec,
    ) -> Result<()> {
        let (Some(path), Some(seen)) = (self.keep_state, seen) else { return Ok(()) };
        let state = State { frame, seen: seen.clone() };
        state::pending(path, &state, &ready.identity(exec)?)?.put()
    }

    /// Checks, before anything is drawn, that the state can be written beside these pictures.
    pub(super) fn check_state(
        &self,
        ready: &Ready,
        file: &SceneFile,
        pictures: &[PathBuf],
    ) -> Result<()> {
        if let Some(read) = self.options.state() {
            let pictures = pictures.iter().map(PathBuf::as_path);
            self.keep_state
                .into_iter()
                .chain(pictures)
                .try_for_each(|path| output::check_other(path, read))?;
        }
        let Some(path) = self.keep_state else { return Ok(()) };
        if !ready.method.draws_objects() {
            let name = ready.method.name();
            let what = format!(
                "--keep-state: the method {name} has no state between frames; give --method deferred"
            );
            return Err(Error::Usage(what));
        }
        output::check(path, self.scene, file)?;
        for picture in pictures {
            output::check_two(path, picture)?;
            output::check_two(path, &picture.with_extension("png"))?;
        }
        Ok(())
    }

    /// Checks, before long work, that the region is inside a camera's picture.
    pub(super) fn check_region(&self, camera: &Camera) -> Result<()> {
        self.region.map_or(Ok(()), |region| camera.check_region(&region))
    }

    /// Whether the files hold the projection of the region alone.
    pub(super) fn projects(&self, method: &Method, camera: &Camera) -> bool {
        let is_part = self.region.is_some_and(|region| region != Rect::of_size(camera.size()));
        is_part && method.projects_regions()
    }

    /// The text of the picture, or of the part.
    pub(super) fn text(
        &self,
        scene: &Scene,
        groups: Option<&Groups>,
        camera: &Camera,
        method: &Method,
        output: OutputSettings,
    ) -> String {
        let whole = provenance::text(scene, groups, camera, method, output);
        match self.projects(method, camera) {
            true => provenance::text_of_projection(&whole, scene, output),
            false => whole,
        }
    }

    /// Makes a session draw the region alone. Returns the place of its pixels in the camera's picture.
    pub(super) fn limit(&self, session: &mut Session<'_>, camera: &Camera) -> Result<Window> {
        session.set_region(self.region)?;
        Ok(Window { region: session.window(camera)?, picture: camera.size() })
    }

    /// Makes the default folder, if no output is named.
    pub(super) fn make_folder(&self) -> Result<()> {
        if self.output.is_some() {
            return Ok(());
        }
        let folder = Path::new(FOLDER);
        fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))
    }
}

/// Writes a picture and its preview; both are complete before either replaces an old file. Then
/// writes the depths, if they are wanted.
pub(super) fn write(
    picture: &Path,
    frame: &Frame<f32>,
    window: Window,
    text: impl Fn() -> String + Sync,
    output: OutputSettings,
    depth: Option<Depth>,
    exec: &Exec,
) -> Result<()> {
    let (small, large) = exec.join(
        || png::pending_frame(&picture.with_extension("png"), frame),
        || exr::pending_part(picture, frame, window, &text(), output.compression, exec),
    );
    let (small, large) = (small?, large?);
    large.put()?;
    small.map_or(Ok(()), Pending::put)?;
    let Some(depth) = depth else { return Ok(()) };
    let [file, description] = depth.places(picture);
    depth.convention.write(&file, &description, frame.scalar("Z")?)
}
