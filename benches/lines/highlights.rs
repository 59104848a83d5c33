//! Shading before and after the interpolation: \[MKC08, Fig. 5\], "sharper specular highlights".
//!
//! A sphere whose material shines (specular 0.6, shininess 60), 600 x 600 pixels. *Shaded after*:
//! the method interpolates normals, and each pixel is shaded. *Shaded before*: each surfel is shaded at its
//! centre, and the method interpolates colours. RMSE to the true picture, and the brightest pixel as
//! a part of the true one.

use crate::common::report::{Arguments, Table};
use crate::common::shot::Shot;
use splatref::Result;
use splatref::compare::metrics::rmse;
use splatref::frame::Exec;
use splatref::method::{Method, Session, ewa, pyramid, template};
use splatref::number::{Real, Vector3};
use splatref::scene::{Camera, Phong, Scene};
use splatref::shade::phong::Shader;
use splatref::source::Shape;
use splatref::splat::View;

pub(crate) fn table(arguments: &Arguments, exec: &Exec) -> Result<()> {
    let methods: [(&str, Method); 3] = [
        ("EWA", ewa::Settings::default().into()),
        ("pyramid", pyramid::Settings::default().into()),
        ("template", template::Settings::default().into()),
    ];
    let mut table = Table::new(&["surfels", "method", "shaded after", "shaded before"]);
    for count in [1_000, 3_000, 10_000, 100_000] {
        let shape = Shape::Sphere;
        let camera = Camera::new(600, 600, shape.default_pose(), shape.default_lens())?;
        let mut scene = Scene::lit("sphere", shape.surfels(count, 0)?);
        scene.material = Phong { specular: 0.6, shininess: 60.0, ..Phong::default() };
        let truth = Shot::truth(&scene, &shape, &camera, exec)?;
        let before = shaded(&scene, &camera)?;
        for (name, method) in methods.iter().filter(|m| m.0.contains(&arguments.pattern)) {
            let cells = [&scene, &before].map(|scene| {
                let frame = Session::new(scene, *method, exec)?.render(&camera)?.frame.clone();
                let shot = Shot::of(frame);
                let [a, b] = [&shot, &truth].map(|shot| shot.color.values().as_flattened());
                let [brightest, true_one] =
                    [a, b].map(|v| v.iter().fold(0.0_f32, |most, v| most.at_least(*v)));
                Ok(format!("{:.4}, {:.2}", rmse(a, b), brightest / true_one))
            });
            let [deferred, before]: [Result<String>; 2] = cells;
            table.row(&format!("{count} | {name} | {} | {}", deferred?, before?));
        }
    }
    table.publish(arguments, "image-space.md", "highlights")
}

/// The scene without light, its surfels in the colours that they have under the light.
fn shaded(scene: &Scene, camera: &Camera) -> Result<Scene> {
    let shader = Shader::<f32>::new(View::new(camera), &scene.lights, scene.material);
    let mut cloud = scene.surfels.clone().into_cloud();
    let surface = |i: usize| cloud.color.as_ref().map_or(scene.material.color, |color| color[i]);
    let colors = (0..cloud.position.len()).map(|i| {
        let [place, normal] = [cloud.position[i], cloud.normal.as_ref().expect("surfels")[i]];
        let own = surface(i).to_array();
        shader.surfel(Vector3::from_glam(place), Vector3::from_glam(normal), own).into()
    });
    cloud.color = Some(colors.collect());
    let surfels = splatref::scene::Surfels::new(cloud)?.0;
    Ok(Scene { lights: Vec::new(), surfels, ..scene.clone() })
}
