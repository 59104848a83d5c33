//! The camera, the settings, the lights and the material of a case as JSON.

use crate::error::{Error, Result};
use crate::scene::camera::clip::to_clip;
use crate::scene::{Camera, Convention, Gaussians, Light, Phong, Projection, Scene, Sphere};
use crate::setting::{Fields, Value};
use crate::splat::record::shared_numbers;
use crate::verdict::conformance::{Case, Rule};
use glam::{DMat4, DVec3, DVec4, Vec3};
use serde_json::{Map, Value as Json, json};

/// The text of `scene.json`.
pub(super) fn text(rule: &Rule, case: &Case) -> Result<String> {
    let Case { scene, camera, method, .. } = case;
    let settings = method.values().into_iter();
    let settings: Map<_, _> =
        settings.map(|(name, value)| (name.into(), setting(&value))).collect();
    let resolved = method.settings_in_scene(scene, camera).into_iter();
    let resolved: Map<_, _> = resolved.map(|(name, text)| (name.into(), number(&text))).collect();
    let splats = method.splats().map(|splats| {
        let shared = shared_numbers(camera, &splats.kernel).into_iter();
        shared.map(|(name, value)| (name.to_owned(), json!(value))).collect::<Map<_, _>>()
    });
    let groups = scene.surfels.groups().map(|groups| json!({ "scale": groups.scale() }));
    let json = json!({
        "splatref": env!("CARGO_PKG_VERSION"),
        "method": method.name(),
        "rule": rule.name,
        "tests": rule.tests,
        "surfels": scene.surfels.len(),
        "gaussians": scene.gaussians.as_ref().map_or(0, Gaussians::len),
        "colors": scene.gaussians.as_ref().map(|gaussians| gaussians.encoding().name()),
        "camera": self::camera(scene, camera)?,
        "settings": settings,
        "settings_in_scene": resolved,
        "splats": splats,
        "groups": groups,
        "lights": scene.lights.iter().map(light).collect::<Vec<_>>(),
        "material": material(&scene.material),
        "environment": if scene.environment.is_some() { "sky" } else { "black" },
        "surface": scene.surface.as_ref().map(|_| super::SURFACE),
    });
    let text = serde_json::to_string_pretty(&json);
    text.map(|text| text + "\n").map_err(|error| Error::Invalid(error.to_string()))
}

fn setting(value: &Value) -> Json {
    match value {
        Value::Whole(number) => json!(number),
        Value::Number(number) => json!(number),
        Value::Switch(on) => json!(on),
        Value::Text(text) => json!(text),
        Value::Numbers(numbers) => json!(numbers),
        Value::Parts(parts) => {
            parts.iter().map(|(name, part)| (name.clone(), json!(part))).collect()
        }
    }
}

/// A number or an array that is written as TOML; infinity stays a text.
fn number(text: &str) -> Json {
    serde_json::from_str(text).unwrap_or_else(|_| json!(text))
}

fn vector(v: Vec3) -> [f32; 3] {
    v.to_array()
}

fn light(light: &Light) -> Json {
    match *light {
        Light::Directional { towards, color } => {
            json!({ "kind": "directional", "towards": vector(towards), "color": vector(color) })
        }
        Light::Headlight { towards, color } => {
            json!({ "kind": "headlight", "towards": vector(towards), "color": vector(color) })
        }
        Light::Point { position, color } => {
            json!({ "kind": "point", "position": vector(position), "color": vector(color) })
        }
    }
}

fn material(material: &Phong) -> Json {
    let Phong { ambient, diffuse, specular, shininess, color } = *material;
    json!({
        "ambient": ambient,
        "diffuse": diffuse,
        "specular": specular,
        "shininess": shininess,
        "color": vector(color),
    })
}

/// Twice the depth of the farthest point of a scene, so that a far plane there cuts nothing.
fn far(scene: &Scene, camera: &Camera) -> f64 {
    let Sphere { center, radius } = scene.bounding_sphere();
    let depth = -camera.view_from_world.as_dmat4().transform_point3(center).z + radius;
    let near = f64::from(camera.near);
    2.0 * if depth > near { depth } else { near + 1.0 }
}

fn rows(matrix: &DMat4) -> Vec<[f64; 4]> {
    (0..4).map(|i| matrix.row(i).to_array()).collect()
}

fn camera(scene: &Scene, camera: &Camera) -> Result<Json> {
    let Camera { width, height, fx, fy, cx, cy, near, .. } = *camera;
    let far = far(scene, camera);
    let view = camera.view_from_world.as_dmat4();
    let clip = |convention| to_clip(camera, convention, far).map(|matrix| rows(&matrix));
    let clip = |convention| clip(convention).map_err(Error::Invalid);
    // The rows of y and z are negated, and 0 is added so that none is -0.
    let down = DMat4::from_diagonal(DVec4::new(1.0, -1.0, -1.0, 1.0)) * view;
    let down = DMat4::from_cols_array(&down.to_cols_array().map(|v| v + 0.0));
    let DVec3 { x, y, z } = camera.eye();
    Ok(json!({
        "width": width,
        "height": height,
        "projection": match camera.projection {
            Projection::Perspective => "perspective",
            Projection::Orthographic => "orthographic",
        },
        "fx": fx,
        "fy": fy,
        "cx": cx,
        "cy": cy,
        "near": near,
        "far": far,
        "eye": [x, y, z],
        "view_from_world": { "opengl": rows(&view), "opencv": rows(&down) },
        "clip_from_view": {
            "opengl": clip(Convention::OpenGl)?,
            "vulkan": clip(Convention::Vulkan)?,
            "d3d": clip(Convention::Direct3d)?,
        },
    }))
}
