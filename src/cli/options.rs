//! Options that several commands share.

use super::camera::{CameraOptions, replace};
use super::rows::{OfGroups, OfMethods, OfNumber, RowOptions};
use splatref::frame::Exec;
use splatref::io::scene_file::{EnvironmentChoice, SceneFile, Source};
use splatref::io::scene_file::{check_mipmaps, check_opacity, check_prefix};
use splatref::method::Method;
use splatref::{Error, Result};
use std::path::{Path, PathBuf};

/// How a picture is computed; no option here changes a bit of it.
#[derive(clap::Args)]
pub(super) struct ExecOptions {
    /// Use N threads; 0 uses every core
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
    /// Set the side of a tile in pixels: 8, 16, 32 or 64
    #[arg(long, value_name = "N", default_value_t = 32)]
    tile: u32,
}

impl ExecOptions {
    pub(super) fn exec(&self) -> Result<Exec> {
        Exec::new(self.threads, self.tile)
    }
}

/// The scene and its camera; each option replaces the value of a scene file.
#[derive(clap::Args)]
pub(super) struct SceneOptions {
    /// Render this frame of the sequence, from 0 [default: 0]
    #[arg(long, value_name = "N", help_heading = "Camera")]
    frame: Option<u32>,
    /// Continue from the state after the previous frame, which render --keep-state wrote
    #[arg(long, value_name = "FILE", help_heading = "Camera")]
    state: Option<PathBuf>,
    #[command(flatten)]
    camera: CameraOptions,

    /// Surround the scene with a latitude-longitude map, or with the procedural sky
    #[arg(long, value_name = "FILE.exr|sky", value_parser = environment,
        help_heading = "Environment")]
    environment: Option<EnvironmentChoice>,
    /// Mix the splats with opaque geometry by depth: an EXR with Z and R, G, B that another method drew
    /// from the same camera (method gaussians)
    #[arg(long, value_name = "FILE.exr", help_heading = "Environment")]
    surface: Option<PathBuf>,

    /// Choose the method
    #[arg(long, value_name = "NAME", value_parser = method, help = methods(),
        help_heading = "Method")]
    method: Option<&'static str>,
    #[command(flatten)]
    settings: RowOptions<OfMethods>,
    #[command(flatten)]
    groups: RowOptions<OfGroups>,
    #[command(flatten)]
    number: RowOptions<OfNumber>,

    /// Set the opacity of all surfels, 0 to 1
    #[arg(long, value_name = "A", allow_hyphen_values = true, help_heading = "Shapes and models")]
    opacity: Option<f32>,
    /// Use only the first N points of a file: one level of what `splatref surfels` writes
    #[arg(long, value_name = "N", help_heading = "Shapes and models")]
    prefix: Option<usize>,
    /// Draw as many of the ordered points as the view needs, with discs PIXELS wide where the
    /// points are nearest
    #[arg(long, value_name = "PIXELS", help_heading = "Shapes and models")]
    surfel_size: Option<f32>,
    /// Draw at most N of the ordered points, the best first [--surfel-size: 2]
    #[arg(long, value_name = "N", help_heading = "Shapes and models")]
    surfel_budget: Option<u32>,
    /// Replace the colours of a file by this texture: a .png, a .jpg or an .exr
    #[arg(long, value_name = "FILE", help_heading = "Shapes and models")]
    texture: Option<PathBuf>,
    /// Colour the points of a file by this number of each, with the colour map viridis: x, y, z, or
    /// a property of the file, such as intensity
    #[arg(long, value_name = "PROPERTY", help_heading = "Shapes and models")]
    color_by: Option<String>,
    /// Prefilter this many mip levels of colours for each surfel (method deferred); 0 drops the
    /// levels in a file
    #[arg(long, value_name = "LEVELS", help_heading = "Shapes and models")]
    mipmaps: Option<usize>,
    /// Make a procedural shape of about N surfels, or a tree of N leaves [default: 200000, 50124]
    #[arg(long, value_name = "N", help_heading = "Shapes and models")]
    count: Option<usize>,
    /// Set the random seed of a procedural shape [default: 0]
    #[arg(long, value_name = "N", help_heading = "Shapes and models")]
    seed: Option<u64>,
}

impl SceneOptions {
    /// The scene that `name` stands for, a shape or a file, with these options applied.
    pub(super) fn scene_file(&self, name: &Path) -> Result<SceneFile> {
        let mut file = SceneFile::open_with(name, self.count, self.seed)?;
        self.check_hierarchy(&file)?;
        self.camera.apply(&mut file)?;
        if let Some(frame) = self.frame {
            file.check_frame(frame)?;
            file.frame = frame;
        }
        replace(&mut file.environment, self.environment.clone());
        replace(&mut file.surface, self.surface.clone());
        if let Some(opacity) = self.opacity {
            usage(check_opacity(opacity))?;
            file.all_models_mut().for_each(|model| model.opacity = Some(opacity));
        }
        if let Some(levels) = self.mipmaps {
            usage(check_mipmaps(levels))?;
            file.all_models_mut().for_each(|model| model.mipmaps = Some(levels));
        }
        self.choose_of_files(&mut file)?;
        self.choose_refinement(&mut file)?;
        file.choose_method(self.method, &self.settings.chosen, &self.groups.chosen)?;
        file.output = self.number.chosen.on(file.output, "the output")?;
        Ok(file)
    }

    /// Refuses options of models for a hierarchy, which has no models.
    fn check_hierarchy(&self, file: &SceneFile) -> Result<()> {
        let given = [
            (self.opacity.is_some(), "--opacity"),
            (self.prefix.is_some(), "--prefix"),
            (self.texture.is_some(), "--texture"),
            (self.color_by.is_some(), "--color-by"),
            (self.mipmaps.is_some(), "--mipmaps"),
        ];
        match given.iter().find(|(given, _)| *given) {
            Some((_, option)) if file.hierarchy.is_some() => {
                let what = format!(
                    "{option} applies to models, but {} is a hierarchy; remove {option}",
                    file.name
                );
                Err(Error::Usage(what))
            }
            _ => Ok(()),
        }
    }

    /// Sets the prefix, the texture and the colouring of every model; each must be a file.
    fn choose_of_files(&self, file: &mut SceneFile) -> Result<()> {
        usage(self.prefix.map_or(Ok(()), check_prefix))?;
        let what = match (self.prefix, &self.texture, &self.color_by) {
            (None, None, None) => return Ok(()),
            (Some(_), _, _) => "--prefix applies to the points of a file",
            (None, Some(_), _) => "--texture applies to a file",
            (None, None, Some(_)) => "--color-by applies to a file",
        };
        for model in file.all_models_mut() {
            match &mut model.source {
                Source::File { prefix, texture, color_by, .. } => {
                    replace(prefix, self.prefix);
                    replace(texture, self.texture.clone());
                    replace(color_by, self.color_by.clone());
                }
                other => {
                    return Err(Error::Usage(format!(
                        "{what}, but {} is not one; remove the option",
                        other.name()
                    )));
                }
            }
        }
        Ok(())
    }

    /// Sets the refinement of progressive models. If no model is progressive, all become so.
    fn choose_refinement(&self, file: &mut SceneFile) -> Result<()> {
        if self.surfel_size.is_none() && self.surfel_budget.is_none() {
            return Ok(());
        }
        let refinement = &mut file.refinement;
        refinement.surfel_size = self.surfel_size.unwrap_or(refinement.surfel_size);
        refinement.budget = self.surfel_budget.or(refinement.budget);
        usage(refinement.check())?;
        if file.all_models().all(|model| !model.progressive) {
            if let Some(geometry) = file.geometries.iter().find(|one| one.detail.is_some()) {
                let name = &geometry.name;
                let what = format!(
                    "--surfel-size and --surfel-budget apply to ordered points, but {name} has a \
                     tree; remove them"
                );
                return Err(Error::Usage(what));
            }
            file.all_models_mut().for_each(|model| model.progressive = true);
        }
        Ok(())
    }

    /// Whether the options choose one frame.
    pub(super) fn names_frame(&self) -> bool {
        self.frame.is_some()
    }

    /// The method that the options name, if they do.
    pub(super) fn chosen_method(&self) -> Option<&'static str> {
        self.method
    }

    /// Refuses `--state` for a command that cannot use it; `why` goes into the error.
    pub(super) fn refuse_state(&self, why: &str) -> Result<()> {
        match &self.state {
            None => Ok(()),
            Some(_) => Err(Error::Usage(format!("--state: {why}"))),
        }
    }

    /// The file with the state after the previous frame.
    pub(super) fn state(&self) -> Option<&Path> {
        self.state.as_deref()
    }
}

/// What an option says is wrong usage if it cannot be; the same in a scene file is not.
fn usage<T>(checked: Result<T>) -> Result<T> {
    checked.map_err(|error| match error {
        Error::Invalid(what) => Error::Usage(what),
        other => other,
    })
}

/// Parses `sky` or a file name.
fn environment(text: &str) -> std::result::Result<EnvironmentChoice, String> {
    Ok(EnvironmentChoice::from_text(text))
}

/// Parses the name of a method.
pub(super) fn method(text: &str) -> std::result::Result<&'static str, String> {
    Method::by_name(text).map(|method| method.name()).map_err(|error| error.to_string())
}

/// The help text of `--method`: each method on a line.
fn methods() -> String {
    let all = Method::all();
    let of = |method: &Method| format!("\n  {:<15} {}", method.name(), method.summary());
    let lines: String = all.iter().map(of).collect();
    format!("Choose the method [default: {}]{lines}", Method::default().name())
}
