//! Options that several commands share.

use glam::DVec3;
use splatref::frame::Exec;
use splatref::io::scene_file::{
    DEFAULT_COUNT, EnvironmentChoice, ExtensionChoice, MethodName, Number, SceneFile, Source,
    check_opacity, words,
};
use splatref::method::ewa::Epsilon;
use splatref::method::pyramid::{Occlusion, Weights};
use splatref::method::template::LevelRule;
use splatref::method::transparent::Holes;
use splatref::scene::Lens;
use splatref::shade::optics::BendingLayers;
use splatref::source::{Shape, plant};
use splatref::splat::{Kernel, Outline};
use splatref::{Error, Result};
use std::path::Path;

/// How a picture is made; cannot change one bit of it.
#[derive(clap::Args)]
pub(super) struct ExecOptions {
    /// Threads; 0 takes every core
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,
    /// Side of a tile in pixels: 8, 16, 32 or 64
    #[arg(long, value_name = "N", default_value_t = 32)]
    tile: u32,
}

impl ExecOptions {
    pub(super) fn exec(&self) -> Result<Exec> {
        Exec::new(self.threads, self.tile)
    }
}

/// What is pictured; each option replaces what a scene file says.
#[derive(clap::Args)]
pub(super) struct SceneOptions {
    /// Size of the picture in pixels [default: 1024x768]
    #[arg(long, value_name = "WxH", value_parser = size, help_heading = "Camera")]
    size: Option<[u32; 2]>,
    /// Where the camera stands
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true,
        help_heading = "Camera")]
    eye: Option<DVec3>,
    /// What is in the middle of the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true,
        help_heading = "Camera")]
    target: Option<DVec3>,
    /// What is up in the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true,
        help_heading = "Camera")]
    up: Option<DVec3>,
    /// Vertical field of view in degrees
    #[arg(
        long,
        value_name = "DEG",
        group = "lens",
        allow_hyphen_values = true,
        help_heading = "Camera"
    )]
    fov: Option<f64>,
    /// Focal length in pixels
    #[arg(
        long,
        value_name = "PX",
        group = "lens",
        allow_hyphen_values = true,
        help_heading = "Camera"
    )]
    focal: Option<f64>,
    /// Orthographic, with this height of the picture in world units
    #[arg(
        long,
        value_name = "HEIGHT",
        group = "lens",
        allow_hyphen_values = true,
        help_heading = "Camera"
    )]
    ortho: Option<f64>,

    /// What surrounds the scene: a latitude-longitude map, or the procedural sky
    #[arg(long, value_name = "FILE.exr|sky", value_parser = environment,
        help_heading = "Environment")]
    environment: Option<EnvironmentChoice>,

    /// The method: ewa, single-pass, transparent, transparent-hq, peeling, pyramid, template
    /// [default: ewa]
    #[arg(long, value_name = "NAME", value_parser = words::method, help_heading = "Method")]
    method: Option<MethodName>,
    /// Preset of outline, cut-off and low-pass filter: default, zpvbg01 or zp06
    #[arg(long, value_name = "NAME", value_parser = words::kernel, help_heading = "Method")]
    kernel: Option<Kernel>,
    /// Shape of a splat: affine, perspective or raycast
    #[arg(long, value_name = "NAME", value_parser = words::outline, help_heading = "Method")]
    outline: Option<Outline>,
    /// Cut-off in standard deviations
    #[arg(long, value_name = "K", allow_hyphen_values = true, help_heading = "Method")]
    cutoff: Option<f32>,
    /// Variance of the low-pass filter in px^2
    #[arg(long, value_name = "H", allow_hyphen_values = true, help_heading = "Method")]
    low_pass: Option<f32>,
    /// Depth of the visible band in world units, or in median radii as in 1.5r; or inf
    #[arg(long, value_name = "DEPTH", value_parser = words::epsilon, allow_hyphen_values = true,
        help_heading = "Method")]
    epsilon: Option<Epsilon>,
    /// Whether surfels seen from behind are dropped: on or off [default: on]
    #[arg(long, value_name = "on|off", value_parser = switch, num_args = 0..=1,
        require_equals = true, default_missing_value = "on", help_heading = "Method")]
    cull: Option<bool>,
    /// Arithmetic: f32 or f64
    #[arg(long, value_name = "TYPE", value_parser = words::number, help_heading = "Method")]
    number: Option<Number>,

    /// Most overlap c of the splats of a group, 0 to 1 [default: 0.4; of transparency by --groups]
    #[arg(long, value_name = "C", allow_hyphen_values = true, help_heading = "Groups")]
    overlap: Option<f32>,
    /// Most groups; the overlap is the largest that gives so few [default of transparency: 4]
    #[arg(long, value_name = "K", help_heading = "Groups")]
    groups: Option<usize>,
    /// What a group keeps of overlapping splats: plain or voronoi [default: voronoi]
    #[arg(long, value_name = "NAME", value_parser = words::depth, help_heading = "Groups")]
    depth: Option<bool>,
    /// Depth bins, 1 to 65535 [default: as deep as epsilon]
    #[arg(long, value_name = "N", help_heading = "Groups")]
    bins: Option<u32>,
    /// How groups are made to cover the surface: none, add or enlarge [default of transparency:
    /// add]
    #[arg(long, value_name = "NAME", value_parser = words::extension, help_heading = "Groups")]
    extend: Option<ExtensionChoice>,

    /// Opacity of all surfels, 0 to 1
    #[arg(long, value_name = "A", allow_hyphen_values = true, help_heading = "Transparency")]
    opacity: Option<f32>,
    /// What a group without fragments gives to the average: skipped or background
    #[arg(long, value_name = "NAME", value_parser = words::holes, help_heading = "Transparency")]
    holes: Option<Holes>,
    /// Ratios of refraction for red, green and blue, or one for all: 0.6667 from air to glass
    #[arg(long, value_name = "R,G,B", value_parser = ratios, allow_hyphen_values = true,
        help_heading = "Transparency")]
    refraction: Option<[f32; 3]>,
    /// How many layers bend light: single or multiple [default: multiple]
    #[arg(long, value_name = "NAME", value_parser = words::bends, help_heading = "Transparency")]
    bends: Option<BendingLayers>,
    /// Most layers that are peeled, 1 to 256 [default: 64]
    #[arg(long, value_name = "N", help_heading = "Transparency")]
    peel: Option<u32>,

    /// Weights of the pull-push interpolation: box or gaussian [default: gaussian]
    #[arg(long, value_name = "NAME", value_parser = words::weights,
        help_heading = "Image space (pyramid, template)")]
    weights: Option<Weights>,
    /// What of the pyramid is occluded: behind or outside the parent's depth [default: behind]
    #[arg(long, value_name = "NAME", value_parser = words::occluded,
        help_heading = "Image space (pyramid, template)")]
    occluded: Option<Occlusion>,
    /// Binary digits after the point of the corners of triangles and lines, 0 to 12 [default: 8]
    #[arg(long, value_name = "N", help_heading = "Image space (pyramid, template)")]
    subpixel_bits: Option<u32>,
    /// Width of the template in cells: 3, 5 or 7 [default: 5]
    #[arg(long, value_name = "K", help_heading = "Image space (pyramid, template)")]
    template: Option<u32>,
    /// The level of an ellipse: covering or published [default: published]
    #[arg(long, value_name = "NAME", value_parser = words::levels,
        help_heading = "Image space (pyramid, template)")]
    levels: Option<LevelRule>,

    /// Surfels of a procedural shape, leaves of the tree [default: 200000, 50124]
    #[arg(long, value_name = "N", help_heading = "Shapes")]
    count: Option<usize>,
    /// Seed of a procedural shape [default: 0]
    #[arg(long, value_name = "N", help_heading = "Shapes")]
    seed: Option<u64>,
}

impl SceneOptions {
    /// The scene that `name` stands for, a shape or a file, with these options on top.
    pub(super) fn scene_file(&self, name: &Path) -> Result<SceneFile> {
        let mut file = named(name, self.count, self.seed)?;
        let camera = &mut file.camera;
        replace(&mut camera.size, self.size);
        replace(&mut camera.eye, self.eye);
        replace(&mut camera.target, self.target);
        replace(&mut camera.up, self.up);
        replace(&mut camera.lens, self.fov.map(Lens::FieldOfView));
        replace(&mut camera.lens, self.focal.map(Lens::Focal));
        replace(&mut camera.lens, self.ortho.map(Lens::Orthographic));
        replace(&mut file.environment, self.environment.clone());
        if let Some(opacity) = self.opacity {
            check_opacity(opacity)?;
            file.models.iter_mut().for_each(|model| model.opacity = Some(opacity));
        }
        replace(&mut file.groups.overlap, self.overlap);
        replace(&mut file.groups.count, self.groups);
        replace(&mut file.groups.extension, self.extend);
        let method = &mut file.method;
        if let Some(name) = self.method {
            // What the file says of its own method does not hold for another.
            *method = method.of_method(name);
        }
        replace(&mut method.voronoi, self.depth);
        replace(&mut method.bins, self.bins);
        replace(&mut method.holes, self.holes);
        replace(&mut method.refraction, self.refraction);
        replace(&mut method.bends, self.bends);
        replace(&mut method.peel, self.peel);
        replace(&mut method.weights, self.weights);
        replace(&mut method.occluded, self.occluded);
        replace(&mut method.subpixel_bits, self.subpixel_bits);
        replace(&mut method.template, self.template);
        replace(&mut method.levels, self.levels);
        if self.kernel.is_some() {
            // A preset replaces all that the file says of the kernel.
            (method.outline, method.cutoff, method.low_pass) = (None, None, None);
        }
        replace(&mut method.kernel, self.kernel);
        replace(&mut method.outline, self.outline);
        replace(&mut method.cutoff, self.cutoff);
        replace(&mut method.low_pass, self.low_pass);
        replace(&mut method.epsilon, self.epsilon);
        replace(&mut method.cull, self.cull);
        let grouped = self.overlap.is_some() || self.groups.is_some() || self.extend.is_some();
        if grouped && !file.method.method()?.needs_groups() {
            let what = "--overlap, --groups and --extend are for methods that draw groups; give a --method";
            return Err(Error::Usage(what.into()));
        }
        file.output.number = self.number.unwrap_or(file.output.number);
        Ok(file)
    }
}

/// The scene that `name` stands for; count and seed are for shapes alone, the count of a tree is
/// that of its leaves.
pub(super) fn named(name: &Path, count: Option<usize>, seed: Option<u64>) -> Result<SceneFile> {
    if let Some(shape) = name.to_str().and_then(Shape::by_name) {
        let count = count.unwrap_or(DEFAULT_COUNT);
        return Ok(SceneFile::of_model(Source::Shape { shape, count, seed: seed.unwrap_or(0) }));
    }
    if name == Path::new(words::TREE) {
        let leaves = count.unwrap_or(plant::LEAVES);
        return Ok(SceneFile::of_model(Source::Tree { leaves, seed: seed.unwrap_or(0) }));
    }
    if count.is_some() || seed.is_some() {
        let what = "--count and --seed are for procedural shapes; this scene is a file";
        return Err(Error::Usage(what.into()));
    }
    match kind(name)? {
        Kind::Ply => Ok(SceneFile::of_model(Source::File { path: name.to_owned(), radius: None })),
        Kind::Toml => SceneFile::read(name),
        Kind::Exr => Err(Error::Usage(format!(
            "{}: an EXR is a picture, not a scene; `splatref info` describes it",
            name.display()
        ))),
    }
}

/// What a file is, by its extension.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Ply,
    Toml,
    Exr,
}

pub(super) fn kind(path: &Path) -> Result<Kind> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("ply") => Ok(Kind::Ply),
        Some("toml") => Ok(Kind::Toml),
        Some("exr") => Ok(Kind::Exr),
        _ => Err(Error::Usage(format!(
            "{}: no known kind of file; give a .ply, a scene .toml, an .exr, or a shape: {}",
            path.display(),
            words::shapes()
        ))),
    }
}

/// Replaces what was chosen, if there is something to replace it by.
fn replace<T>(chosen: &mut Option<T>, by: Option<T>) {
    if by.is_some() {
        *chosen = by;
    }
}

/// `640x480`.
fn size(text: &str) -> std::result::Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides.ok_or_else(|| "give width and height in pixels, such as 640x480".into())
}

/// `on` or `off`.
fn switch(text: &str) -> std::result::Result<bool, String> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err("give on or off".into()),
    }
}

/// `sky` or a file.
fn environment(text: &str) -> std::result::Result<EnvironmentChoice, String> {
    Ok(words::environment(text))
}

/// `0.66,0.67,0.68`, or one number for all three.
fn ratios(text: &str) -> std::result::Result<[f32; 3], String> {
    let numbers: Option<Vec<f32>> = text.split(',').map(|v| v.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[all]) => Ok([all; 3]),
        Some(&[r, g, b]) => Ok([r, g, b]),
        _ => Err("give one number or three, such as 0.66,0.67,0.68".into()),
    }
}

/// `1,-2.5,3`.
fn vector(text: &str) -> std::result::Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|v| v.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
        _ => Err("give three numbers, such as 1,-2.5,3".into()),
    }
}
