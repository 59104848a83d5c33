//! `splatref info`: describes a file or a folder of surfels.

use super::report::{self, line};
use super::{Ended, Ending, hierarchy, progress, region, say, warn, warn_of};
use splatref::Result;
use splatref::frame::Exec;
use splatref::io::exr::{self, ChannelType};
use splatref::io::gaussians;
use splatref::io::hierarchy::Hierarchy;
use splatref::io::ply::ReadOptions;
use splatref::io::provenance;
use splatref::io::scene_file::{Draw, EnvironmentChoice, FileKind, Model, SceneFile, Source};
use splatref::io::scene_file::{Loaded, read_model};
use splatref::scene::Light;
use splatref::source::derive::{self, Derive};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  splatref info bunny.ply
  splatref info out/cluster.exr")]
pub(super) struct Args {
    /// A .ply, .obj, .las, .laz, .e57, .glb, .gltf, .splat or .spz, a scene .toml, an .exr, a folder that "splatref tile" or "splatref surfels" wrote, or a shape
    file: PathBuf,
}

pub(super) fn run(args: &Args) -> Ended {
    if args.file.to_str().is_some_and(|name| Source::procedural(name).is_some()) {
        scene(&args.file)?;
        return Ok(Ending::Good);
    }
    if Hierarchy::is_in(&args.file) {
        hierarchy::info(&args.file)?;
        return Ok(Ending::Good);
    }
    let kind = FileKind::from_extension(&args.file)?;
    if kind.is_model() && gaussians::holds(&args.file) {
        gaussians_of(&args.file)?;
        return Ok(Ending::Good);
    }
    match kind {
        FileKind::Ply | FileKind::Obj | FileKind::Las | FileKind::E57 | FileKind::Gaussians => {
            points(&args.file)?;
        }
        FileKind::Toml => scene(&args.file)?,
        FileKind::Blocks => scene(&args.file)?,
        FileKind::Exr => picture(&args.file)?,
    }
    Ok(Ending::Good)
}

fn gaussians_of(path: &Path) -> Result<()> {
    let loaded = SceneFile::open(path)?.load(&Exec::sequential(), &|_, _, _| ())?;
    warn(&loaded.warnings);
    report::scene(&loaded);
    line("  sha256", loaded.scene.sha256());
    Ok(())
}

fn points(path: &Path) -> Result<()> {
    let mut cloud = read_model(path, &ReadOptions::default(), &Exec::sequential())?;
    line("points", cloud.position.len());
    line("triangles", cloud.triangles.len());
    let edges = cloud.edges.len();
    if edges > 0 {
        line("edges", edges);
    }
    let arrays = [
        ("normals", cloud.normal.is_some()),
        ("radii", cloud.radius.is_some()),
        ("colours", cloud.color.is_some()),
        ("face colours", cloud.triangle_color.is_some()),
        ("opacities", cloud.opacity.is_some()),
        ("half axes", cloud.tangents.is_some()),
        ("tangents", cloud.tangent.is_some()),
        ("mipmaps", cloud.mipmap.is_some()),
        ("texture coordinates", cloud.coordinates.is_some()),
        ("groups", cloud.groups.is_some()),
    ];
    let there: Vec<&str> = arrays.iter().filter(|(_, is)| *is).map(|(name, _)| *name).collect();
    line("has", if there.is_empty() { "positions only".into() } else { there.join(", ") });
    for property in &cloud.properties {
        line("property", property.name.escape_debug());
    }
    for name in &cloud.textures {
        let name = name.escape_debug().to_string();
        line("texture", if name.is_empty() { "none for some polygons" } else { &name });
    }

    warn_of(path, &mut cloud);
    let offset = cloud.offset;
    let steps = progress::Steps::new("loading");
    let show = |what: &str, done, of| steps.show(what, done, of);
    let found = derive::facets_or_surfels(cloud, &Derive::default(), &Exec::new(0, 32)?, &show);
    drop(steps);
    let (surfels, derived) = match found {
        Ok(found) => found,
        // The points of lines need not have enough for surfels.
        Err(error) if edges > 0 => {
            line("surfels", format!("none: {error}"));
            return Ok(());
        }
        Err(error) => return Err(splatref::Error::format(path, error.to_string())),
    };
    line("surfels", surfels.len());
    line("  normals", report::normals(derived.normals));
    line("  radii", report::radii(derived.radii));
    line("  dropped", report::dropped(&derived.dropped, 0));
    report::offset(offset);
    let (low, high) = surfels.bounds();
    report::bounds(low, high);
    report::radius(&surfels);
    Ok(())
}

fn scene(path: &Path) -> Result<()> {
    let file = SceneFile::open(path)?;
    for model in file.all_models() {
        line("source", source(model));
    }
    let steps = progress::Steps::new("loading");
    let loaded: Loaded =
        file.load_outlined(&Exec::new(0, 32)?, &|what, done, of| steps.show(what, done, of))?;
    drop(steps);
    warn(&loaded.warnings);
    report::scene(&loaded);
    line("  sha256", loaded.scene.sha256());
    if file.frame_count() > 1 {
        line("frames", file.frame_count());
    }
    for light in &file.lights {
        line(
            "light",
            match light {
                Light::Directional { towards, .. } => format!("directional, towards {towards}"),
                Light::Headlight { towards, .. } => format!("headlight, towards {towards}"),
                Light::Point { position, .. } => format!("point, at {position}"),
            },
        );
    }
    match &file.environment {
        None => {}
        Some(EnvironmentChoice::Sky) => line("around", "the procedural sky"),
        Some(EnvironmentChoice::File(path)) => line("around", path.display()),
    }
    let camera = file.camera(&loaded.scene)?;
    report::camera(&camera);
    report::picture(&camera, file.output);
    let method = file.method.method()?;
    match &loaded.scene.objects {
        None => report::method(&method, &loaded.scene, &camera),
        // What the settings come to is known only for surfels in their places, and those may not
        // fit into memory.
        Some(_) => report::settings(&method),
    }
    Ok(())
}

fn source(model: &Model) -> String {
    match &model.source {
        Source::File { path, .. } => match model.draw {
            Draw::Surfels => path.display().to_string(),
            draw => format!("{}, drawn as {}", path.display(), draw.word()),
        },
        Source::Shape { shape, count, seed } => {
            format!("{shape:?}, about {count} surfels, seed {seed}")
        }
        Source::Tree { leaves, seed } => {
            let word = model.draw.word();
            format!("Tree of {leaves} leaves, seed {seed}, drawn as {word}")
        }
    }
}

fn picture(path: &Path) -> Result<()> {
    let header = exr::read_header(path)?;
    line("picture", format!("{} x {} pixels", header.width, header.height));
    if let Some(data) = header.data.filter(|data| data.size() != [header.width, header.height]) {
        line("region", region::words(data));
    }
    if header.text.as_deref().is_some_and(provenance::is_projection) {
        line("holds", region::PROJECTION);
    }
    line("stored", header.compressions.join("; "));
    for (name, kind) in &header.channels {
        line(
            "channel",
            format!(
                "{name}: {}",
                match kind {
                    ChannelType::Half => "half",
                    ChannelType::Float => "float",
                    ChannelType::Uint => "uint",
                }
            ),
        );
    }
    match header.text {
        Some(text) => say(format!("\n{}", text.trim_end())),
        None => line("text", "none from splatref"),
    }
    Ok(())
}
