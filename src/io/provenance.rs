//! Describe a picture in a text that its file carries: the scene, and the settings.

use crate::error::{Error, Result};
use crate::io::scene_file::OutputSettings;
use crate::method::Method;
use crate::method::buffer_formats::Formats;
use crate::method::projection::Has;
use crate::scene::{Camera, Counts, Groups, Light, Objects, Phong, Projection, Scene};
use crate::setting::{Fields, Word};
use glam::DVec3;
use std::path::Path;

/// The text as TOML, for the attribute [`super::exr::ATTRIBUTE`].
///
/// Equal pictures have equal texts: nothing depends on the time, the machine, the directory or the
/// way the picture was computed. The offset is in the text if there is one, [`Scene::offset`]. Floats are the shortest decimals that give the same `f32`.
/// [`Scene::sha256`] identifies the scene, [`crate::scene::Groups::sha256`] its groups, and the
/// camera is described by all its numbers. `bins_in_world_units` are `d_min`, `d_max` and n of
/// \[ZP06, eq. 6\].
#[must_use]
pub fn text(
    scene: &Scene,
    groups: Option<&Groups>,
    camera: &Camera,
    method: &Method,
    output: OutputSettings,
) -> String {
    let groups = groups.map_or(String::new(), |groups| {
        format!("[groups]\ncount = {}\nsha256 = \"{}\"\n\n", groups.len(), groups.sha256())
    });
    let chosen = method.values().into_iter().map(|(name, value)| (name, value.to_string()));
    let settings = chosen.chain(method.settings_in_scene(scene, camera));
    let settings: String = settings.map(|(name, value)| format!("{name} = {value}\n")).collect();
    let primitives = if scene.primitives.is_empty() {
        String::new()
    } else {
        let Counts { triangles, ribbons, tubes } = scene.primitives.counts();
        format!("triangles = {triangles}\nribbons = {ribbons}\ntubes = {tubes}\n")
    };
    format!(
        "splatref = \"{version}\"\nnumber = \"{number}\"\n{formats}\n\
         [scene]\nname = {name}\nsurfels = {surfels}\n{primitives}{offset}sha256 = \"{hash}\"\n\n\
         [method]\nname = \"{method}\"\n{settings}\n{groups}\
         [camera]\n{camera}",
        version = env!("CARGO_PKG_VERSION"),
        number = output.number.word(),
        formats = formats(output.formats),
        name = toml::Value::String(scene.name.clone()),
        surfels = scene.surfel_count(),
        offset = offset(scene.offset),
        hash = scene.sha256(),
        method = method.name(),
        camera = self::camera(camera, scene.offset),
    )
}

/// Begins what the text of a part adds to the text of the picture.
const PROJECTION: &str = "\n# The planes of the projection alone: `splatref assemble` joins such parts, and runs the \
                          other stages.\n[projection]\n";

/// The text of a part that holds the [projection](crate::method::projection) alone: `whole`, the text of
/// the picture, and what the stages after the projection need. These are the lights and the material, as
/// the tables `[[light]]` and `[material]` of a scene file, and the table `[projection]`:
///
/// - `stages`: whether the joined picture keeps the planes of every stage;
/// - `colors`, `tangents`, `environment`: whether the scene has colours, tubes and an environment.
///
/// The environment itself is not in the text, because the parts have its light as a plane.
#[must_use]
pub fn text_of_projection(whole: &str, scene: &Scene, output: OutputSettings) -> String {
    let Has { color, tangent } = Has::in_scene(scene);
    let color = color || scene.objects.as_ref().is_some_and(Objects::have_colors);
    let (stages, environment) = (output.stages, scene.environment.is_some());
    let lights: String = scene.lights.iter().map(light).collect();
    let Phong { ambient, diffuse, specular, shininess, color: surface } = scene.material;
    format!(
        "{whole}{PROJECTION}stages = {stages}\ncolors = {color}\ntangents = {tangent}\n\
         environment = {environment}\n\n{lights}[material]\nambient = {ambient:?}\n\
         diffuse = {diffuse:?}\nspecular = {specular:?}\nshininess = {shininess:?}\n\
         color = {surface:?}\n",
        surface = surface.to_array(),
    )
}

/// A light as a table of a scene file.
fn light(light: &Light) -> String {
    let (kind, key, place, color) = match *light {
        Light::Directional { towards, color } => ("directional", "towards", towards, color),
        Light::Headlight { towards, color } => ("headlight", "towards", towards, color),
        Light::Point { position, color } => ("point", "position", position, color),
    };
    let [place, color] = [place, color].map(|v| v.to_array());
    format!("[[light]]\nkind = \"{kind}\"\n{key} = {place:?}\ncolor = {color:?}\n\n")
}

/// Whether a file with this text holds the projection of a part alone.
#[must_use]
pub fn is_projection(text: &str) -> bool {
    text.parse::<toml::Table>().is_ok_and(|table| table.contains_key("projection"))
}

/// Checks that a file with this text has the pixels of a picture.
///
/// # Errors
/// [`Error::Format`] if it holds the projection alone.
pub fn check_finished(path: &Path, text: Option<&str>) -> Result<()> {
    if !text.is_some_and(is_projection) {
        return Ok(());
    }
    let what = "holds the projection of a region, no pixels of a picture; join all parts by `splatref \
                assemble`, and give the picture";
    Err(Error::format(path, what))
}

/// The text of the whole picture in the text of a part, [`text_of_projection`].
pub(crate) fn without_projection(text: &str) -> Option<&str> {
    Some(&text[..text.rfind(PROJECTION)?])
}

/// What was subtracted from the coordinates of the files, as TOML, unless it is 0.
fn offset(offset: DVec3) -> String {
    match offset == DVec3::ZERO {
        true => String::new(),
        false => format!("offset = {:?}\n", offset.to_array()),
    }
}

/// The formats that differ from `f32`, as TOML.
fn formats(formats: Formats) -> String {
    if formats.keep_all() {
        return String::new();
    }
    let Formats { buffers, depth } = formats;
    format!("storage = \"{}\"\ndepth_storage = \"{}\"\n", buffers.word(), depth.word())
}

/// All numbers of a camera as TOML, its size included, and the offset of its scene unless it is 0.
/// This is a table `[camera]` of a scene file, and gives the same camera bit for bit.
#[must_use]
pub fn camera(camera: &Camera, offset: DVec3) -> String {
    let Camera { width, height, fx, fy, cx, cy, near, .. } = *camera;
    let projection = match camera.projection {
        Projection::Perspective => "perspective",
        Projection::Orthographic => "orthographic",
    };
    let rows: Vec<String> =
        (0..4).map(|i| format!("  {:?},\n", camera.view_from_world.row(i).to_array())).collect();
    let (rows, offset) = (rows.concat(), self::offset(offset));
    let other_eye = camera.other_eye.map_or(String::new(), |x| format!("other_eye = {x:?}\n"));
    format!(
        "size = [{width}, {height}]\nprojection = \"{projection}\"\n\
         f = [{fx:?}, {fy:?}]\nc = [{cx:?}, {cy:?}]\nnear = {near:?}\n{offset}{other_eye}\
         view_from_world = [\n{rows}]\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::scene_file::Number;
    use crate::method::buffer_formats::Buffers;
    use crate::scene::{Lens, Pose};
    use crate::setting::Value;
    use crate::source::Shape;
    use crate::splat::{Epsilon, SplatSettings};

    #[test]
    fn the_text_is_toml_with_exact_numbers() {
        let shape = Shape::by_name("torus").unwrap();
        let name = "a \"b\"\n\u{e4}".to_owned();
        let surfels = shape.surfels(100, 0).unwrap();
        let scene = Scene::lit(&name, surfels);
        let eye = DVec3::new(0.1, 1.0 / 3.0, 5.0);
        let pose = Pose { eye, target: DVec3::ZERO, up: DVec3::Y };
        let camera = Camera::new(61, 47, pose, Lens::FieldOfView(33.3)).unwrap();
        let settings = SplatSettings::default();
        let method = Method::Ewa(settings);
        let formats = Formats { buffers: Buffers::F16, ..Formats::default() };
        let output = OutputSettings { number: Number::F64, formats, ..OutputSettings::default() };
        let text = text(&scene, None, &camera, &method, output);

        let table: toml::Table = text.parse().unwrap();
        assert_eq!(table["number"].as_str(), Some("f64"));
        assert_eq!(table["storage"].as_str(), Some("f16"));
        assert_eq!(table["depth_storage"].as_str(), Some("f32"));
        assert_eq!(table["scene"]["name"].as_str(), Some(name.as_str()));
        assert_eq!(table["scene"]["sha256"].as_str(), Some(scene.sha256().as_str()));
        let epsilon = Value::Text(table["method"]["epsilon"].as_str().unwrap().into());
        let mut read = SplatSettings { epsilon: Epsilon::World(0.0), ..settings };
        assert_eq!(read.set("epsilon", &epsilon), Ok(()));
        assert_eq!(read.epsilon, settings.epsilon);
        let f = table["camera"]["f"][0].as_float().unwrap();
        assert_eq!((f as f32).to_bits(), camera.fx.to_bits());
        for i in 0..4 {
            for j in 0..4 {
                let value = table["camera"]["view_from_world"][i][j].as_float().unwrap() as f32;
                assert_eq!(value.to_bits(), camera.view_from_world.row(i)[j].to_bits());
            }
        }
    }
}
