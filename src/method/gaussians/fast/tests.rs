use super::super::Support;
use super::*;
use crate::frame::{Exec, Frame, Rect};
use crate::method::buffer_formats::{DepthBuffer, Formats};
use crate::method::{Method, Session};
use crate::number::Real;
use crate::number::random::unit;
use crate::scene::gaussians::{Encoding, GaussianArrays, Gaussians, coefficients};
use crate::scene::{Camera, Environment, Lens, Pose, Scene, Surface};
use crate::setting::Words;
use crate::splat::gaussian::GaussianKernel;
use crate::splat::ray_disc::DiscRule;
use glam::{DVec3, Vec3};

/// Splats of all shapes and opacities, some of them huge, tiny, flat, behind the camera or at one
/// depth; every eleventh lies where the one before it does, in another colour.
fn scene(count: u64, degree: u32, seed: u64) -> Scene {
    let random = |i: u64, k: u64| 2.0 * unit(seed, 97 * i + k) - 1.0;
    let vector = |i: u64, k: u64| Vec3::new(random(i, k), random(i, k + 1), random(i, k + 2));
    let each = coefficients(degree) as u64;
    let places = || (0..count).map(|i| i - u64::from(i % 11 == 10));
    let sizes = [0.02, 0.1, 0.4, 3.0, 0.0];
    let arrays = GaussianArrays {
        position: places()
            .map(|i| {
                let at = vector(i, 0) * Vec3::new(2.5, 2.0, 4.0);
                if i % 3 == 0 { Vec3::new(at.x, at.y, 0.5) } else { at }
            })
            .collect(),
        scale: places().map(|i| (vector(i, 3).abs() + 0.05) * sizes[(i % 5) as usize]).collect(),
        rotation: places()
            .map(|i| [random(i, 6), random(i, 7), random(i, 8), random(i, 9)])
            .collect(),
        opacity: places()
            .map(|i| match i % 7 {
                0 => 1.0,
                1 => 0.0,
                _ => random(i, 10).abs(),
            })
            .collect(),
        degree,
        harmonics: (0..count).flat_map(|i| (0..each).map(move |k| vector(i, 11 + 3 * k))).collect(),
        encoding: if seed.is_multiple_of(2) { Encoding::Srgb } else { Encoding::Linear },
    };
    Scene::of_gaussians("splats", Gaussians::new(arrays).unwrap().0)
}

fn cameras() -> Vec<Camera> {
    let pose = Pose { eye: DVec3::new(0.3, 0.2, 5.0), target: DVec3::ZERO, up: DVec3::Y };
    let camera = |w, h, lens| Camera::new(w, h, pose, lens).unwrap();
    let mut odd = camera(67, 41, Lens::FieldOfView(70.0));
    (odd.cx, odd.fy) = (odd.cx + 9.0, odd.fy * 1.3);
    vec![
        camera(1, 1, Lens::FieldOfView(50.0)),
        camera(96, 64, Lens::FieldOfView(50.0)),
        odd,
        camera(70, 33, Lens::Orthographic(4.0)),
    ]
}

/// Depths around those of the splats in some pixels, one of them exactly where a third of the splats
/// are, and nothing opaque in others.
fn surface(size: [u32; 2], seed: u64) -> Surface {
    let number = |x: u32, y: u32, k: u64| unit(seed, 1000 * u64::from(y) + 4 * u64::from(x) + k);
    let depth = |x, y| match (x + y) % 3 {
        0 => f32::INFINITY,
        1 => 10.0 * number(x, y, 0),
        _ => 4.5,
    };
    let color = |x, y| [1, 2, 3].map(|k| 2.0 * number(x, y, k));
    Surface::new(Plane::from_pixels(size, depth), Plane::from_pixels(size, color)).unwrap()
}

#[test]
fn every_pixel_has_the_bits_of_the_definition() {
    for (number, (_, preset)) in Settings::WORDS.iter().enumerate() {
        let others = [
            *preset,
            Settings { order: Order::Steps, stop: 0.3, stop_at: true, ..*preset },
            Settings { cutoff: 1.5, least_alpha: 0.1, most_alpha: 0.4, degree: 1, ..*preset },
            Settings { least_alpha: 3e-44, stop: 0.0, ..*preset },
            Settings { kernel: GaussianKernel { disc: DiscRule::Ray, ..preset.kernel }, ..*preset },
            Settings { order: Order::Pixel, support: Support::Ellipse, ..*preset },
        ];
        for (k, settings) in others.into_iter().enumerate() {
            let mut scene = scene(300, (k + number) as u32 % 4, (3 * number + k) as u64);
            scene.environment = (k == 1).then_some(Environment::Sky);
            for (exec, camera) in [8, 16, 64, 32].into_iter().zip(cameras()) {
                let exec = Exec::new(2, exec).unwrap();
                scene.surface = (k % 2 == 0).then(|| surface(camera.size(), k as u64));
                let method = Method::Gaussians(settings);
                let mut session = Session::new(&scene, method, &exec).unwrap();
                let definition = session.define::<f32>(&camera, false).unwrap().frame;
                let picture = session.render(&camera).unwrap();
                assert_eq!(picture.frame.planes.len(), definition.planes.len());
                for (own, other) in picture.frame.planes.iter().zip(&definition.planes) {
                    assert!(own == other, "{settings:?} {}", own.name);
                }
            }
        }
    }
}

/// Discs side by side in one plane that faces an orthographic camera have one depth in every pixel.
#[test]
fn splats_of_one_depth_in_different_places_are_drawn_in_the_order_of_their_indices() {
    let upright = Pose { eye: 5.0 * DVec3::Z, target: DVec3::ZERO, up: DVec3::Y };
    let camera = Camera::new(70, 33, upright, Lens::Orthographic(4.0)).unwrap();
    let exec = Exec::sequential();
    let colors = [Vec3::X, Vec3::Y, Vec3::Z];
    let draw = |order: [usize; 3]| {
        let arrays = GaussianArrays {
            position: order.map(|i| Vec3::new(0.3 * i as f32 - 0.3, 0.1, 0.25)).into(),
            scale: vec![Vec3::new(0.5, 0.5, 0.01); 3],
            rotation: vec![[1.0, 0.0, 0.0, 0.0]; 3],
            opacity: vec![0.6; 3],
            degree: 0,
            harmonics: order.map(|i| colors[i]).into(),
            encoding: Encoding::Linear,
        };
        let scene = Scene::of_gaussians("discs", Gaussians::new(arrays).unwrap().0);
        let mut session = Session::new(&scene, Settings::EXACT.into(), &exec).unwrap();
        let definition = session.define::<f32>(&camera, false).unwrap().frame;
        let frame = &session.render(&camera).unwrap().frame;
        assert!(frame.planes.iter().zip(&definition.planes).all(|(own, other)| own == other));
        let [x, y] = camera.size().map(|side| side / 2);
        (*frame.index("id").unwrap().at(x, y), *frame.scalar("Z").unwrap().at(x, y))
    };
    for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
        assert_eq!(draw(order), (0, 4.75), "{order:?}");
    }
}

/// A splat that is behind a surface by less than a step of a depth buffer of 16 bits.
#[test]
fn a_depth_buffer_of_few_digits_draws_what_it_cannot_tell_apart() {
    let (camera, exec) = (cameras().remove(1), Exec::sequential());
    let mut scene = scene(1, 0, 2);
    let draw = |scene: &Scene, depth| {
        let mut session = Session::new(scene, Settings::INRIA.into(), &exec).unwrap();
        let formats = Formats { depth, ..Formats::WHOLE };
        session.emulate(&camera, formats, true).unwrap().frame
    };
    let drawn = |frame: &Frame<f32>| frame.count("count").unwrap().values().iter().any(|&n| n > 0);
    let bare = draw(&scene, DepthBuffer::F32);
    let depth = bare.scalar("Z").unwrap().values().iter().fold(f32::INFINITY, |a, b| a.at_most(*b));
    let [width, height] = camera.size();
    for (nearer, expected) in [(1e-6, [false, true]), (0.1, [false, false]), (0.0, [true, true])] {
        let depths = Plane::filled(width, height, depth * (1.0 - nearer));
        let colors = Plane::filled(width, height, [0.5; 3]);
        scene.surface = Some(Surface::new(depths, colors).unwrap());
        let all = [DepthBuffer::F32, DepthBuffer::Unorm16].map(|format| draw(&scene, format));
        assert_eq!(all.map(|frame| drawn(&frame)), expected, "{nearer}");
    }
}

/// Only some of the splats touch the region; what its fragments need beside a splat is still that of the splat.
#[test]
fn a_region_has_the_bits_of_the_picture_for_every_order_and_disc() {
    let (camera, exec) = (cameras().remove(1), Exec::sequential());
    let scene = scene(300, 1, 4);
    let region = Rect { x0: 20, y0: 30, x1: 61, y1: 50 };
    for (_, order) in Order::WORDS {
        for (_, disc) in DiscRule::WORDS {
            let kernel = GaussianKernel { disc: *disc, ..Settings::INRIA.kernel };
            let settings = Settings { order: *order, kernel, ..Settings::INRIA };
            let mut session = Session::new(&scene, Method::Gaussians(settings), &exec).unwrap();
            let whole = session.render(&camera).unwrap().frame.scalar("Z").unwrap().clone();
            session.set_region(Some(region)).unwrap();
            let part = session.render(&camera).unwrap().frame.scalar("Z").unwrap();
            for (y, row) in (region.y0..).zip(part.values().chunks(41)) {
                for (x, depth) in (region.x0..).zip(row) {
                    assert!(depth == whole.at(x, y), "{order:?} {disc:?} {x} {y}");
                }
            }
        }
    }
}
