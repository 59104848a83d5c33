//! The brightest colours and zeros of both signs: no plane of any stage holds a NaN or a -0.

use crate::frame::{Exec, Frame, Samples};
use crate::method::{Method, Session, transparent_hq};
use crate::number::Exact;
use crate::scene::environment::{Environment, Map};
use crate::scene::light::MAX_RADIANCE;
use crate::scene::{Camera, Cloud, Lens, Light, Phong, Pose, Scene, Surfels};
use crate::shade::optics::{BendingLayers, Refraction};
use glam::{DVec3, Vec3};

/// A value that no plane may hold.
fn bad<R: Exact>(values: &[R]) -> Option<&R> {
    values.iter().find(|v| {
        let v = v.to_f64();
        v.is_nan() || (v == 0.0 && v.is_sign_negative())
    })
}

fn assert_sound<R: Exact>(frame: &Frame<R>, what: &str) {
    for plane in &frame.planes {
        let (found, least) = match &plane.samples {
            Samples::Scalar(plane) => (bad(plane.values()), None),
            Samples::Color(plane) => {
                let values = plane.values().as_flattened();
                (bad(values), values.iter().find(|v| !v.is_finite()))
            }
            Samples::Vector(plane) => (bad(plane.values().as_flattened()), None),
            Samples::Index(_) | Samples::Count(_) => (None, None),
        };
        assert!(found.is_none() && least.is_none(), "{what}, {}: {found:?} {least:?}", plane.name);
    }
}

/// Sheets of surfels that face the axes, one behind another, all with this colour and opacity.
fn scene(color: f32, opacity: Option<f32>, light: f32) -> Scene {
    let mut cloud = Cloud { color: Some(Vec::new()), ..Cloud::default() };
    for i in 0..300_u16 {
        let [x, y, z] = [i % 10, i / 10 % 10, i / 100].map(|v| f32::from(v) * 0.25);
        cloud.position.push(Vec3::new(x - 1.0, y - 1.0, -z));
        let normal = [Vec3::new(-0.0, -0.0, 1.0), Vec3::new(-0.0, 0.6, 0.8)][usize::from(i % 2)];
        cloud.normal.get_or_insert_default().push(normal);
        cloud.radius.get_or_insert_default().push(0.25);
        cloud.color.get_or_insert_default().push(Vec3::new(color, -0.0, color));
    }
    cloud.opacity = opacity.map(|opacity| vec![opacity; 300]);
    let mut scene = Scene::unlit("sheets", Surfels::new(cloud).unwrap().0);
    let color = Vec3::new(light, -0.0, light);
    scene.lights = vec![
        Light::Headlight { towards: Vec3::new(-0.0, -0.0, 1.0), color },
        Light::Point { position: Vec3::new(-0.0, -0.0, 2.0), color },
    ];
    scene.material = Phong { ambient: 1.0, diffuse: 1.0, specular: 1.0, ..Phong::default() };
    scene
}

#[test]
fn no_plane_holds_a_nan_or_a_negative_zero() {
    let exec = Exec::new(2, 16).unwrap();
    let pose = Pose { eye: DVec3::new(0.0, -0.0, 4.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(41, 29, pose, Lens::FieldOfView(40.0)).unwrap();
    let sky = crate::frame::Plane::filled(8, 4, [MAX_RADIANCE, -0.0, MAX_RADIANCE]);
    let environment = Environment::Map(Map::new(sky).unwrap());
    let refraction = Refraction { ratio: [0.75, 0.7, 0.65], layers: BendingLayers::Multiple };
    let refraction = Some(refraction);
    let mut methods = Method::all();
    methods.push(transparent_hq::Settings { refraction, ..Default::default() }.into());
    for color in [MAX_RADIANCE, f32::MIN_POSITIVE, -0.0] {
        for (opacity, light) in [(None, MAX_RADIANCE), (Some(0.5), 0.0), (Some(-0.0), MAX_RADIANCE)]
        {
            let mut scene = scene(color, opacity, light);
            scene.environment = Some(environment.clone());
            for &method in &methods {
                let what = format!("{} of {color:e}, {opacity:?}, {light:e}", method.name());
                let mut session = Session::new(&scene, method, &exec).unwrap();
                assert_sound(&session.define::<f32>(&camera, true).unwrap().frame, &what);
                assert_sound(&session.define::<f64>(&camera, true).unwrap().frame, &what);
                assert_sound(&session.render(&camera).unwrap().frame, &what);
            }
        }
    }
}

/// A colour brighter than any light may be is dropped, like every other impossible colour.
#[test]
fn brighter_colours_are_dropped() {
    let cloud = |colors: [f32; 4]| Cloud {
        position: (0..4_u8).map(|i| Vec3::X * f32::from(i)).collect(),
        normal: Some(vec![Vec3::Z; 4]),
        radius: Some(vec![1.0; 4]),
        color: Some(colors.map(|c| Vec3::new(0.0, c, 0.0)).to_vec()),
        ..Cloud::default()
    };
    let colors = [MAX_RADIANCE, MAX_RADIANCE.next_up(), 3.4e38, f32::INFINITY];
    let (surfels, dropped) = Surfels::new(cloud(colors)).unwrap();
    assert_eq!((surfels.len(), dropped.attribute), (1, 3));
}
