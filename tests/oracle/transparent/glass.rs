//! Environments behind transparent layers and through glass, in closed form.

use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::eye::{Eye, dot, unit};
use crate::oracle::kit::planes::{index, value};
use crate::oracle::transparent::known::{
    PIXELS, SIZE, Sheet, TESTS, assert_near, camera, over, render, settings, sheet, sheets,
};
use crate::oracle::transparent::surroundings::{radiance, world_ray};
use glam::{DVec3, Vec3};
use splatref::frame::{NO_ID, Plane};
use splatref::method::single_pass::DepthTest;
use splatref::scene::environment::Map;
use splatref::scene::{Camera, Environment, Lens, Pose};
use splatref::shade::optics::{BendingLayers, Refraction};

fn noise() -> Environment {
    let mut dice = Dice(9);
    let values = (0..128).map(|_| [(); 3].map(|()| dice.within(0.0, 2.0))).collect();
    Environment::Map(Map::new(Plane::from_values(16, 8, values)).expect("twice as wide as high"))
}

#[test]
fn an_empty_picture_is_the_environment_along_its_rays() {
    let scene = sheets(&[sheet(-5.0, [1.0; 3], 0.5), sheet(-9.0, [1.0; 3], 1.0)], 2);
    let pose = Pose { eye: DVec3::ZERO, target: DVec3::new(0.5, 0.25, -1.0), up: DVec3::Y };
    let turned = Camera::new(SIZE, SIZE, pose, Lens::Focal(16.0)).expect("a plain camera");
    for environment in [None, Some(Environment::Sky), Some(noise())] {
        for (camera, test) in [camera(false), camera(true), turned].iter().zip(TESTS) {
            let mut scene = scene.clone();
            scene.0.environment = environment.clone();
            let frame = render::<f64>(&scene, camera, &settings(0, test));
            let eye = Eye::new(camera);
            for i in 0..PIXELS {
                let place = [i as u32 % SIZE, i as u32 / SIZE].map(|v| f64::from(v) + 0.5);
                let light = match &environment {
                    None => [0.0; 3],
                    Some(env) => radiance(env, world_ray(&eye, place), 0.0).map(|n| n.value),
                };
                assert_near(value(&frame, "", i), light, 1e-13, "an empty picture");
                let alpha = if environment.is_some() { 1.0 } else { 0.0 };
                assert_eq!(value(&frame, "A", i), [alpha; 3]);
                assert_eq!(value(&frame, "Z", i), [f64::INFINITY; 3]);
                assert_eq!(index(&frame, "id", i), NO_ID);
                assert_eq!(value(&frame, "layers", i), [0.0; 3]);
            }
        }
    }
}

/// Glass that the eye meets head-on under an orthographic camera: nothing is bent, and Fresnel's
/// equations are ((1 - ratio) / (1 + ratio))^2.
#[test]
fn glass_met_head_on_reflects_what_is_behind_the_eye() {
    let alpha = 0.25;
    let front = sheet(5.0, [0.5, 0.25, 1.0], alpha);
    let middle = sheet(6.0, [0.25, 0.75, 0.5], alpha);
    let wall = sheet(7.0, [1.0, 0.0, 0.5], 1.0);
    let ratio = [0.5, 1.0, 1.5];
    let environment = noise();
    let [ahead, back] =
        [-1.0, 1.0].map(|z| radiance(&environment, [0.0, 0.0, z], 0.0).map(|n| n.value));
    for (layers, kind) in [
        (vec![front], BendingLayers::Multiple),
        (vec![front, middle], BendingLayers::Multiple),
        (vec![front, middle, wall], BendingLayers::Multiple),
        (vec![wall, middle, front], BendingLayers::Single),
    ] {
        let mut given = sheets(&layers, 3);
        given.0.environment = Some(environment.clone());
        let mut settings = settings(0, Some(DepthTest::Plain));
        settings.refraction = Some(Refraction { ratio, layers: kind });
        let frame = render::<f64>(&given, &camera(true), &settings);
        let others: Vec<Sheet> = layers.iter().filter(|l| l.depth > 5.0).copied().collect();
        let (mut behind, _) = over(&others);
        let glass = others.iter().filter(|l| l.alpha < 1.0).count() as i32;
        let mut hides = others.iter().any(|l| l.alpha == 1.0);
        let (a, mut l) = (f64::from(alpha), 1 + glass);
        if kind == BendingLayers::Single {
            (behind, hides, l) = ([0.0; 3], false, 1);
        }
        let expected = [0, 1, 2].map(|c| {
            let (eta, own) = (f64::from(ratio[c]), f64::from(front.color[c]));
            let share = ((1.0 - eta) / (1.0 + eta)).powi(2);
            let open = if hides { 0.0 } else { (1.0 - a).powi(l) };
            let inner = (1.0 - a) * behind[c] + open * ahead[c];
            a * own + (1.0 - a) * share * back[c] + (1.0 - share) * inner
        });
        for i in 0..PIXELS {
            assert_near(value(&frame, "", i), expected, 1e-14, &format!("{layers:?}"));
            assert_near(value(&frame, "l", i), [f64::from(1 + glass); 3], 1e-14, "l");
        }
    }
}

/// In white light l sheets of white glass send what they absorb: nothing is seen of them, whatever
/// the angle and the ratios. (As long as all groups have the same layers.)
#[test]
fn white_glass_in_white_light_is_not_seen() {
    let white = Map::new(Plane::filled(8, 4, [1.0; 3])).expect("twice as wide as high");
    for count in 1..5 {
        let layers: Vec<Sheet> = (0..count)
            .map(|i| Sheet {
                normal: Vec3::new(0.6, 0.0, 0.8),
                ..sheet(9.0 + 3.0 * i as f32, [1.0; 3], 0.3)
            })
            .collect();
        let mut given = sheets(&layers, 2);
        given.0.environment = Some(Environment::Map(white.clone()));
        let mut settings = settings(2, Some(DepthTest::Plain));
        settings.refraction =
            Some(Refraction { ratio: [0.5, 0.75, 1.75], layers: BendingLayers::Multiple });
        let frame = render::<f64>(&given, &camera(true), &settings);
        for i in 0..PIXELS {
            assert_eq!(value(&frame, "layers", i)[0], f64::from(count), "{count} sheets");
            assert_near(value(&frame, "", i), [1.0; 3], 1e-14, &format!("{count} sheets"));
        }
    }
}

/// Eq. 12 at a known angle: two sheets of ratio 1/2 met at 60 degrees turn the sine to sqrt(3)/8.
#[test]
fn light_is_bent_by_as_many_layers_as_there_are() {
    let normal = Vec3::new(0.75_f32.sqrt(), 0.0, 0.5);
    let layers = [9.0, 15.0].map(|depth| Sheet { normal, ..sheet(depth, [0.0; 3], 0.5) });
    let mut given = sheets(&layers, 1);
    given.0.environment = Some(Environment::Sky);
    let mut settings = settings(2, Some(DepthTest::Plain));
    settings.refraction = Some(Refraction { ratio: [0.5; 3], layers: BendingLayers::Multiple });
    let frame = render::<f64>(&given, &camera(true), &settings);
    let n = unit([f64::from(normal.x), 0.0, f64::from(normal.z)]);
    let sine = 0.75_f64.sqrt() / 4.0;
    // In the plane of n and v, where the tangent points away from the eye's side.
    let tangent = unit([n[0] * n[2], 0.0, n[2] * n[2] - 1.0]);
    let cosine = (1.0 - sine * sine).sqrt();
    let seen: [f64; 3] = std::array::from_fn(|i| tangent[i] * sine - n[i] * cosine);
    let mirror: [f64; 3] =
        std::array::from_fn(|i| 2.0 * n[2] * n[i] - if i == 2 { 1.0 } else { 0.0 });
    assert!((dot(seen, seen) - 1.0).abs() < 1e-12 && dot(mirror, n) > 0.0);
    // Fresnel at 60 degrees, sin 60 / 2 inside.
    let (c, t) = (0.5, (1.0 - 0.1875_f64).sqrt());
    let (s, p) = ((0.5 * c - t) / (0.5 * c + t), (c - 0.5 * t) / (c + 0.5 * t));
    let share = (s * s + p * p) / 2.0;
    let [through, back] = [seen, mirror].map(|d| radiance(&Environment::Sky, d, 0.0));
    let expected =
        [0, 1, 2].map(|i| 0.5 * share * back[i].value + (1.0 - share) * 0.25 * through[i].value);
    for i in 0..PIXELS {
        // The normal is a unit vector to f32, and the sky has fine rings.
        assert_near(value(&frame, "", i), expected, 2e-5, "two sheets at 60 degrees");
    }
}
