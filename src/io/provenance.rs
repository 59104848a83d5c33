//! The text that a picture carries: what it is a picture of, and by which settings.

use crate::io::scene_file::{MethodName, Number, words};
use crate::method::single_pass::{BinCount, DepthTest};
use crate::method::{Method, transparent, transparent_hq};
use crate::scene::{Camera, Counts, Groups, Projection, Scene};
use crate::shade::optics::Refraction;
use crate::splat::{Kernel, SplatSettings};

/// The text as TOML, for the attribute [`super::exr::ATTRIBUTE`].
///
/// Equal for equal pictures: nothing in it depends on the time, the machine, the directory or the
/// way the picture was computed. Floats are the shortest decimals that give the same `f32`. The
/// scene is identified by [`Scene::sha256`], its groups by [`crate::scene::Groups::sha256`],
/// the camera by all its numbers. `bins_in_world_units` are `d_min`, `d_max` and n of \[ZP06, eq.
/// 6\].
#[must_use]
pub fn text(
    scene: &Scene,
    groups: Option<&Groups>,
    camera: &Camera,
    method: &Method,
    number: Number,
) -> String {
    let groups = groups.map_or(String::new(), |groups| {
        format!("[groups]\ncount = {}\nsha256 = \"{}\"\n\n", groups.len(), groups.sha256())
    });
    let resolved = method.resolved(scene, camera);
    let resolved = resolved.into_iter().map(|(name, value)| format!("{name} = {value}\n"));
    let primitives = if scene.primitives.is_empty() {
        String::new()
    } else {
        let Counts { triangles, ribbons, tubes } = scene.primitives.counts();
        format!("triangles = {triangles}\nribbons = {ribbons}\ntubes = {tubes}\n")
    };
    let projection = match camera.projection {
        Projection::Perspective => "perspective",
        Projection::Orthographic => "orthographic",
    };
    let rows: Vec<String> =
        (0..4).map(|i| format!("  {:?},\n", camera.view_from_world.row(i).to_array())).collect();
    format!(
        "splatref = \"{version}\"\nnumber = \"{number}\"\n\n\
         [scene]\nname = {name}\nsurfels = {surfels}\n{primitives}sha256 = \"{hash}\"\n\n\
         [method]\nname = \"{method}\"\n{splats}cull = {cull}\n{further}\n{groups}\
         [camera]\nsize = [{width}, {height}]\nprojection = \"{projection}\"\n\
         f = [{fx:?}, {fy:?}]\nc = [{cx:?}, {cy:?}]\nnear = {near:?}\n\
         view_from_world = [\n{rows}]\n",
        version = env!("CARGO_PKG_VERSION"),
        number = words::of_number(number),
        name = toml::Value::String(scene.name.clone()),
        surfels = scene.surfels.len(),
        hash = scene.sha256(),
        method = words::of_method(MethodName::of(method)),
        further = further(method) + &resolved.collect::<String>(),
        splats = splats(method).map_or(String::new(), footprints),
        cull = culls(method),
        width = camera.width,
        height = camera.height,
        fx = camera.fx,
        fy = camera.fy,
        cx = camera.cx,
        cy = camera.cy,
        near = camera.near,
        rows = rows.concat(),
    )
}

/// What of a method is about splats.
pub fn splats(method: &Method) -> Option<&SplatSettings> {
    match method {
        Method::Ewa(settings) => Some(settings),
        Method::SinglePass(settings) => Some(&settings.splats),
        Method::Transparent(settings) => Some(&settings.splats),
        Method::TransparentHq(settings) => Some(&settings.layers.splats),
        Method::Peeling(settings) => Some(&settings.splats),
        Method::Pyramid(_) | Method::Template(_) => None,
    }
}

/// Whether a method drops what is seen from behind.
pub fn culls(method: &Method) -> bool {
    match method {
        Method::Pyramid(settings) => settings.cull,
        Method::Template(settings) => settings.cull,
        _ => splats(method).is_some_and(|splats| splats.cull),
    }
}

/// Kernel and epsilon, as lines of TOML.
fn footprints(splats: &SplatSettings) -> String {
    let Kernel { outline, cutoff, low_pass } = splats.kernel;
    format!(
        "outline = \"{}\"\ncutoff = {cutoff:?}\nlow_pass = {low_pass:?}\nepsilon = \"{}\"\n",
        words::of_outline(outline),
        words::of_epsilon(splats.epsilon),
    )
}

/// The settings that only some methods have, as lines of TOML.
#[must_use]
pub fn further(method: &Method) -> String {
    let bins = |bins: &BinCount| match bins {
        BinCount::Epsilon => "bins = \"epsilon\"\n".to_owned(),
        BinCount::Count(count) => format!("bins = {count}\n"),
    };
    let depth = |test: DepthTest| format!("depth = \"{}\"\n", words::of_depth(test));
    let blending = |settings: &transparent::Settings| {
        format!("{}holes = \"{}\"\n", bins(&settings.bins), words::of_holes(settings.holes))
    };
    match method {
        Method::Ewa(_) => String::new(),
        Method::Peeling(settings) => format!("peel = {}\n", settings.layers),
        Method::Pyramid(settings) => format!(
            "weights = \"{}\"\noccluded = \"{}\"\nsubpixel_bits = {}\n",
            words::of_weights(settings.weights),
            words::of_occluded(settings.occlusion),
            settings.subpixel_bits
        ),
        Method::Template(settings) => {
            let levels = words::of_levels(settings.levels);
            format!("template = {}\nlevels = \"{levels}\"\n", settings.size)
        }
        Method::SinglePass(settings) => match &settings.depth {
            DepthTest::Plain => depth(settings.depth),
            DepthTest::Voronoi(count) => depth(settings.depth) + &bins(count),
        },
        Method::Transparent(settings) => blending(settings),
        Method::TransparentHq(transparent_hq::Settings { layers, nearest, refraction }) => {
            let refraction = refraction.map_or(String::new(), |Refraction { ratio, layers }| {
                format!("refraction = {ratio:?}\nbends = \"{}\"\n", words::of_bends(layers))
            });
            format!("{}{}{refraction}", blending(layers), depth(*nearest))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Lens, Light, Phong, Pose};
    use crate::source::Shape;
    use glam::DVec3;

    #[test]
    fn the_text_is_toml_with_exact_numbers() {
        let shape = Shape::by_name("torus").unwrap();
        let name = "a \"b\"\n\u{e4}".to_owned();
        let surfels = shape.surfels(100, 0).unwrap();
        let lights = vec![Light::DEFAULT];
        let material = Phong::default();
        let scene = Scene {
            name: name.clone(),
            surfels,
            lights,
            material,
            primitives: Default::default(),
            environment: None,
        };
        let eye = DVec3::new(0.1, 1.0 / 3.0, 5.0);
        let pose = Pose { eye, target: DVec3::ZERO, up: DVec3::Y };
        let camera = Camera::new(61, 47, pose, Lens::FieldOfView(33.3)).unwrap();
        let settings = SplatSettings::default();
        let method = Method::Ewa(settings);
        let text = text(&scene, None, &camera, &method, Number::F64);

        let table: toml::Table = text.parse().unwrap();
        assert_eq!(table["number"].as_str(), Some("f64"));
        assert_eq!(table["scene"]["name"].as_str(), Some(name.as_str()));
        assert_eq!(table["scene"]["sha256"].as_str(), Some(scene.sha256().as_str()));
        assert_eq!(
            words::epsilon(table["method"]["epsilon"].as_str().unwrap()),
            Ok(settings.epsilon)
        );
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
