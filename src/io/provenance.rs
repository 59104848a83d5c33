//! The text that a picture carries: what it is a picture of, and by which settings.

use crate::composite::bins::Range;
use crate::io::scene_file::{MethodName, Number, words};
use crate::method::single_pass::{BinCount, DepthTest};
use crate::method::transparent::Settings;
use crate::method::{Method, Preparation, ewa};
use crate::scene::{Camera, Counts, Projection, Scene};
use crate::shade::optics::Refraction;
use crate::splat::Kernel;

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
    preparation: &Preparation,
    camera: &Camera,
    method: &Method,
    number: Number,
) -> String {
    let groups = preparation.groups().map_or(String::new(), |groups| {
        format!("[groups]\ncount = {}\nsha256 = \"{}\"\n\n", groups.len(), groups.sha256())
    });
    // The picture has been drawn, so that its bins can be counted.
    let bins = method.depth_bins(&scene.surfels, camera).ok().flatten();
    let bins = bins.map_or(String::new(), |Range { nearest, farthest, count }| {
        format!("bins_in_world_units = [{nearest:?}, {farthest:?}, {count}]\n")
    });
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
        further = further(method) + &bins,
        splats = method.splats().map_or(String::new(), |splats| footprints(splats, scene)),
        cull = method.culls(),
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

/// Kernel and epsilon, as lines of TOML.
fn footprints(splats: &ewa::Settings, scene: &Scene) -> String {
    let Kernel { outline, cutoff, low_pass } = splats.kernel;
    format!(
        "outline = \"{}\"\ncutoff = {cutoff:?}\nlow_pass = {low_pass:?}\nepsilon = \"{}\"\n\
         epsilon_in_world_units = {:?}\n",
        words::of_outline(outline),
        words::of_epsilon(splats.epsilon),
        splats.epsilon.resolve(&scene.surfels),
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
        Method::Transparent(settings) => {
            let Settings { holes, nearest, refraction, .. } = *settings;
            let nearest = nearest.map_or(String::new(), depth);
            let refraction = refraction.map_or(String::new(), |Refraction { ratio, layers }| {
                format!("refraction = {ratio:?}\nbends = \"{}\"\n", words::of_bends(layers))
            });
            let holes = format!("holes = \"{}\"\n", words::of_holes(holes));
            format!("{}{holes}{nearest}{refraction}", bins(&settings.bins))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Exec;
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
        let settings = ewa::Settings::default();
        let method = Method::Ewa(settings);
        let exec = Exec::sequential();
        let preparation = Preparation::new(&scene.surfels, None, &method, &exec);
        let text = text(&scene, &preparation, &camera, &method, Number::F64);

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
