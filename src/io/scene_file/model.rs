//! Load one model: its surfels and primitives in the coordinates of its file.

use super::open::read_number;
use super::{Draw, FileKind, Model, Source, read_model, read_properties};
use crate::error::{Error, Result};
use crate::frame::Exec;
use crate::index::mipmap;
use crate::io::ply::ReadOptions;
use crate::io::{ply, texture};
use crate::progress::Progress;
use crate::scene::{Cloud, Primitives, Surfels};
use crate::source::derive::{self, Derive, Derived};
use crate::source::{plant, viridis};
use glam::DVec3;
use std::path::Path;

/// A model in the coordinates of its file.
pub(super) struct ModelParts {
    pub(super) surfels: Surfels,
    pub(super) primitives: Primitives,
    pub(super) derived: Option<Derived>,
    /// Whether all colours, at all levels asked for, come from a texture.
    pub(super) painted: bool,
    /// What the reader subtracted from the positions of the file.
    pub(super) offset: DVec3,
    /// What the reader doubts about the file.
    pub(super) warnings: Vec<String>,
    pub(super) colored: Option<Colored>,
}

/// The numbers by which a model is coloured.
#[derive(Clone, Debug, PartialEq)]
pub struct Colored {
    /// The name of the numbers.
    pub by: String,
    /// The least number, which has the first colour of the map.
    pub low: f64,
    /// The greatest number, which has the last colour of the map.
    pub high: f64,
    /// How many points have no finite number, and are grey.
    pub without: u64,
}

impl ModelParts {
    fn none() -> Self {
        let (surfels, primitives) = (Surfels::none(), Primitives::default());
        let (offset, warnings) = (DVec3::ZERO, Vec::new());
        let (derived, painted, colored) = (None, false, None);
        Self { surfels, primitives, derived, painted, offset, warnings, colored }
    }

    fn new(surfels: Surfels, primitives: Primitives, derived: Derived) -> Self {
        Self { surfels, primitives, derived: Some(derived), ..Self::none() }
    }
}

/// Whether a model would show the colours of a texture.
fn shows_texture(model: &Model) -> bool {
    model.color.is_none()
        && color_by(model).is_none()
        && !matches!(model.draw, Draw::Ribbons | Draw::Tubes)
}

/// The name of the numbers that colour a model.
fn color_by(model: &Model) -> Option<&str> {
    match &model.source {
        Source::File { color_by, .. } => color_by.as_deref(),
        Source::Shape { .. } | Source::Tree { .. } => None,
    }
}

/// Why a scene is loaded.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Purpose<'a> {
    /// To draw it; everything is read.
    Scene,
    /// To draw views, each of which reads only what it needs of a hierarchy.
    View,
    /// To draw parts of a view, each of which reads only what it needs of a folder of blocks too.
    Parts,
    /// To choose candidates: vertices of polygons keep their opacities and these properties.
    Candidates(&'a [String]),
}

/// Refuses a model that cannot be drawn as chosen, or with the chosen opacity, texture or mipmaps.
pub(super) fn check_draw(model: &Model, purpose: Purpose<'_>) -> Result<()> {
    model.draw.check(&model.source).map_err(Error::Invalid)?;
    if let Source::File { path, color_range: Some(_), .. } = &model.source
        && matches!(
            FileKind::from_extension(path)?,
            FileKind::Obj | FileKind::E57 | FileKind::Blocks
        )
    {
        let what = "color_range applies to a PLY, a LAS or a LAZ; remove it";
        return Err(Error::format(path, what));
    }
    if let (Some(by), Some(_)) = (color_by(model), model.color) {
        let (name, by) = (model.source.name(), by.escape_debug());
        let what = format!("{name}: a model in one colour is not coloured by {by}; remove one");
        return Err(Error::Invalid(what));
    }
    if model.progressive && !matches!(model.source, Source::File { .. }) {
        let name = model.source.name();
        let what = format!(
            "{name}: only the ordered points of a file can be progressive; remove `progressive`"
        );
        return Err(Error::Invalid(what));
    }
    if matches!(model.source, Source::File { texture: Some(_), .. }) && !shows_texture(model) {
        let what = match (model.color, color_by(model)) {
            (Some(_), _) => "a model in one colour".to_owned(),
            (None, Some(by)) => format!("a model coloured by {}", by.escape_debug()),
            (None, None) => format!("a model drawn as {}", model.draw.word()),
        };
        let name = model.source.name();
        return Err(Error::Invalid(format!("{name}: {what} has no texture; remove one of them")));
    }
    let surfels = !matches!(model.draw, Draw::Polygons | Draw::Ribbons | Draw::Tubes | Draw::Lines);
    if model.mipmaps.is_some_and(|levels| levels > 0) && (!surfels || model.color.is_some()) {
        let name = model.source.name();
        let what = if surfels {
            "a model in one colour has the same at every level".to_owned()
        } else {
            format!("a model drawn as {} has no surfels", model.draw.word())
        };
        return Err(Error::Invalid(format!("{name}: {what}; remove the mipmaps")));
    }
    // For candidates, a model is drawn as polygons that keep their opacities.
    let veiled = matches!(model.draw, Draw::Surfels | Draw::Points | Draw::Facets)
        || matches!(purpose, Purpose::Candidates(_));
    if model.opacity.is_some() && !veiled {
        let (name, word) = (model.source.name(), model.draw.word());
        let what = format!("{name}: a model drawn as {word} is opaque; remove the opacity");
        return Err(Error::Invalid(what));
    }
    Ok(())
}

pub(super) fn read(
    model: &Model,
    purpose: Purpose<'_>,
    keep_place: bool,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<ModelParts> {
    let further = if let Purpose::Candidates(names) = purpose { names } else { &[] };
    ply_of(model, further)?;
    match &model.source {
        Source::File { path, radius, prefix, texture, color_range, color_by } => {
            let options = ReadOptions { color_range: *color_range, keep_place };
            let mut cloud = read_model(path, &options, exec)?;
            let offset = cloud.offset;
            let warnings = std::mem::take(&mut cloud.warnings).into_iter();
            let warnings = warnings.map(|what| Error::format(path, what).to_string()).collect();
            let by = color_by.as_deref();
            let colored = by.map(|by| color_points(&mut cloud, path, by)).transpose()?;
            read_properties(path, further, &mut cloud)?;
            if model.draw == Draw::Polygons && !matches!(purpose, Purpose::Candidates(_)) {
                // Polygons are drawn opaque.
                cloud.opacity = None;
            }
            if shows_texture(model) {
                let levels = model.mipmaps.unwrap_or(0);
                texture::paint(&mut cloud, path, texture.as_deref(), levels, exec)?;
            }
            let painted = cloud.paint.is_some();
            let options = Derive { radius: *radius };
            let parts = first(cloud, *prefix, model.progressive)
                .and_then(|cloud| of_file(cloud, &model.draw, &options, exec, progress));
            let more = |parts| ModelParts { painted, offset, warnings, colored, ..parts };
            parts.map(more).map_err(|error| match error {
                Error::Invalid(what) => Error::format(path, what),
                other => other,
            })
        }
        Source::Shape { shape, count, seed } => {
            Ok(ModelParts { surfels: shape.surfels(*count, *seed)?, ..ModelParts::none() })
        }
        Source::Tree { leaves, seed } => {
            let tree = plant::apple_tree(*leaves, *seed)?;
            let primitives =
                if model.draw == Draw::Polygons { tree.polygons() } else { tree.lines() }?;
            Ok(ModelParts { primitives, ..ModelParts::none() })
        }
    }
}

/// Replaces the colours of a cloud by colours of a number of each point.
fn color_points(cloud: &mut Cloud, path: &Path, by: &str) -> Result<Colored> {
    let (values, more) = read_number(path, by, cloud)?;
    let Some(viridis::Colored { color, low, high, without }) = viridis::colored(&values) else {
        let what = format!("no point has a finite number `{}` to colour it by", by.escape_debug());
        return Err(Error::format(path, what));
    };
    cloud.color = Some(color);
    (cloud.mipmap, cloud.triangle_color) = (None, None);
    let [low, high] = [low, high].map(|value| f64::from(value) + more);
    Ok(Colored { by: by.to_owned(), low, high, without })
}

/// Checks in the header of a model's file that its vertices have these properties.
///
/// # Errors
/// [`Error::Usage`] if there are names, but the model is no PLY; [`Error::Format`] as
/// [`ply::properties`].
pub(super) fn check_properties(model: &Model, names: &[String]) -> Result<()> {
    match ply_of(model, names)? {
        Some(path) => ply::check_properties(path, names),
        None => Ok(()),
    }
}

/// The PLY file of a model, if there are names of properties to read from it.
fn ply_of<'a>(model: &'a Model, names: &[String]) -> Result<Option<&'a Path>> {
    let Some(first) = names.first() else { return Ok(None) };
    match &model.source {
        Source::File { path, .. } if FileKind::from_extension(path)? == FileKind::Ply => {
            Ok(Some(path))
        }
        source => Err(Error::Usage(format!(
            "{}: no property {}; only vertices of a .ply have such properties",
            source.name(),
            first.escape_debug()
        ))),
    }
}

/// The first `prefix` points of a file, or all; a prefix needs points without triangles and edges.
fn first(cloud: Cloud, prefix: Option<usize>, progressive: bool) -> Result<Cloud> {
    let Some(count) = prefix.or(progressive.then_some(usize::MAX)) else { return Ok(cloud) };
    if !(cloud.triangles.is_empty() && cloud.edges.is_empty()) {
        let what = "a prefix needs points, but the file has triangles or edges; \"splatref \
                    surfels\" samples triangles";
        return Err(Error::Invalid(what.into()));
    }
    if count >= cloud.position.len() {
        return Ok(cloud);
    }
    Ok(cloud.some(&(0..count as u32).collect::<Vec<_>>()))
}

fn of_file(
    cloud: Cloud,
    draw: &Draw,
    options: &Derive,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<ModelParts> {
    let none = Primitives::default();
    Ok(match draw {
        Draw::Surfels => {
            let (surfels, derived) = derive::facets_or_surfels(cloud, options, exec, progress)?;
            ModelParts::new(surfels, none, derived)
        }
        Draw::Points => {
            let (surfels, derived) = derive::surfels(cloud, options, exec, progress)?;
            ModelParts::new(surfels, none, derived)
        }
        Draw::Facets => {
            let (surfels, derived) = derive::facets(cloud, exec, progress)?;
            ModelParts::new(surfels, none, derived)
        }
        Draw::Polygons => {
            let (triangles, derived) = derive::polygons(cloud, exec, progress)?;
            ModelParts::new(Surfels::none(), Primitives { triangles, ..none }, derived)
        }
        Draw::Hybrid(half) => {
            let (surfels, triangles, derived) =
                derive::hybrid(cloud, half, options, exec, progress)?;
            ModelParts::new(surfels, Primitives { triangles, ..none }, derived)
        }
        Draw::Ribbons => {
            let (ribbons, derived) = derive::ribbons(cloud, options)?;
            ModelParts::new(Surfels::none(), Primitives { ribbons, ..none }, derived)
        }
        Draw::Tubes => {
            let (tubes, derived) = derive::tubes(cloud, options)?;
            ModelParts::new(Surfels::none(), Primitives { tubes, ..none }, derived)
        }
        // `check_draw` refuses this before any file is read.
        Draw::Lines => return Err(Error::Invalid("only a tree can be drawn as lines".into())),
    })
}

/// The surfels of a model with the mipmaps that it asks for.
pub(super) fn prefiltered(
    surfels: Surfels,
    model: &Model,
    exec: &Exec,
    progress: Progress<'_>,
) -> Result<Surfels> {
    let made = match model.mipmaps {
        None => return Ok(surfels),
        Some(0) => None,
        Some(_) if surfels.is_empty() => return Ok(surfels),
        Some(levels) => {
            let made = mipmap::build(&surfels, levels, exec, progress);
            Some(made.map_err(|error| match (error, &model.source) {
                (Error::Invalid(what), Source::File { path, .. }) => Error::format(path, what),
                (Error::Invalid(what), other) => {
                    Error::Invalid(format!("{}: {what}", other.name()))
                }
                (other, _) => other,
            })?)
        }
    };
    surfels.with_mipmap(made)
}
