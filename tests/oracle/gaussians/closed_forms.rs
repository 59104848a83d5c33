//! Pictures of Gaussians whose numbers are known in closed form.

use crate::oracle::gaussians::cases::{self, PRESETS};
use crate::oracle::gaussians::laws::alike;
use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::planes::{index, number, value};
use crate::oracle::kit::scene::ahead;
use glam::{Quat, Vec3};
use splatref::frame::{Frame, Plane};
use splatref::method::gaussians::{BlendSpace, Order, Settings, Support};
use splatref::scene::environment::Map;
use splatref::scene::gaussians::Encoding;
use splatref::scene::{Cloud, Environment, GaussianArrays, Lens, Scene, Surfels};
use splatref::splat::gaussian::Compensation;

/// The coefficient of degree 0 that makes a component, but for rounding.
fn flat(component: f32) -> f32 {
    (component - 0.5) / 0.282_094_8
}

const RED: [f32; 3] = [0.75, 0.25, 0.5];
const BLUE: [f32; 3] = [0.125, 0.5, 0.875];

/// Spheres before the camera, each with its depth, deviation, opacity and colour.
fn spheres(all: &[(f32, f32, f32, [f32; 3])], encoding: Encoding) -> Scene {
    cases::scene_of(GaussianArrays {
        position: all.iter().map(|s| Vec3::new(0.0, 0.0, -s.0)).collect(),
        scale: all.iter().map(|s| Vec3::splat(s.1)).collect(),
        rotation: vec![[0.0, 0.0, 0.0, 1.0]; all.len()],
        opacity: all.iter().map(|s| s.2).collect(),
        degree: 0,
        harmonics: all.iter().map(|s| Vec3::from_array(s.3.map(flat))).collect(),
        encoding,
    })
}

fn surrounded(scene: Scene, light: [f32; 3]) -> Scene {
    let map = Map::new(Plane::filled(8, 4, light)).expect("twice as wide as high");
    Scene { environment: Some(Environment::Map(map)), ..scene }
}

const SIZE: [u32; 2] = [15, 9];

fn drawn(scene: &Scene, settings: Settings) -> Frame<f64> {
    Drawing::new(scene, &ahead(Lens::Focal(24.0), SIZE), settings).frame()
}

/// alpha of a sphere on the axis at each pixel: its ellipse is a circle.
fn circle(depth: f64, deviation: f64, opacity: f64, i: usize) -> f64 {
    let (x, y) = ((i % 15) as f64 + 0.5 - 7.5, (i / 15) as f64 + 0.5 - 4.5);
    let variance = (24.0 * deviation / depth).powi(2) + f64::from(0.3_f32);
    opacity * (-(x * x + y * y) / (2.0 * variance)).exp()
}

fn near(found: [f64; 3], wanted: [f64; 3], what: &str) {
    for (found, wanted) in found.into_iter().zip(wanted) {
        assert!((found - wanted).abs() < 2e-7, "{what}: {found} for {wanted}");
    }
}

fn decoded(v: f64) -> f64 {
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

fn encoded(v: f64) -> f64 {
    if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

#[test]
fn one_splat_before_a_background() {
    for encoding in [Encoding::Linear, Encoding::Srgb] {
        let scene = spheres(&[(2.0, 0.25, 0.75, RED)], encoding);
        let frame = drawn(&surrounded(scene, BLUE), Settings::EXACT);
        for i in 0..135 {
            let alpha = circle(2.0, 0.25, 0.75, i);
            let alpha = if alpha < 1.0 / 1024.0 { 0.0 } else { alpha };
            let mixed = |c: usize, back: f64| alpha * f64::from(RED[c]) + (1.0 - alpha) * back;
            let light = [0, 1, 2].map(|c| match encoding {
                Encoding::Linear => mixed(c, BLUE[c].into()),
                Encoding::Srgb => decoded(mixed(c, encoded(BLUE[c].into()))),
            });
            near(value(&frame, "", i), light, &format!("{encoding:?}, pixel {i}"));
            near([number(&frame, "T", i); 3], [1.0 - alpha; 3], "T");
            assert_eq!(number(&frame, "A", i), 1.0);
        }
    }
}

#[test]
fn two_splats_that_overlap_exactly_are_in_the_order_of_their_indices() {
    let both = [(2.0, 0.25, 0.75, RED), (2.0, 0.25, 0.75, BLUE)];
    for (name, settings) in PRESETS {
        let settings = Settings { blend: BlendSpace::Stored, ..settings };
        let frame = drawn(&spheres(&both, Encoding::Linear), settings);
        for i in 0..135 {
            if number(&frame, "count", i) == 0.0 {
                continue;
            }
            // The floor of a compensation is far below this splat's.
            let alpha = 1.0 - number(&frame, "T", i).sqrt();
            let sum =
                |c: usize| alpha * f64::from(RED[c]) + (1.0 - alpha) * alpha * f64::from(BLUE[c]);
            near(value(&frame, "blended", i), [0, 1, 2].map(sum), name);
            assert_eq!([index(&frame, "id", i), index(&frame, "heaviest", i)], [0, 0], "{name}");
            assert_eq!(number(&frame, "count", i), 2.0, "{name}");
            if !["mip", "2dgs", "rays"].contains(&name) {
                near([alpha; 3], [circle(2.0, 0.25, 0.75, i); 3], name);
            }
        }
    }
}

/// With compensation, alpha is the convolution of the splat with the normalized low-pass filter; so
/// a far splat keeps its light, and without compensation it does not.
#[test]
fn a_far_splat_tends_to_the_convolution_integral() {
    let settings = |compensation| {
        let mut settings = Settings { support: Support::Ellipse, cutoff: 4.0, ..Settings::EXACT };
        settings.least_alpha = 0.0;
        settings.kernel.compensation = compensation;
        settings
    };
    let h = f64::from(0.3_f32);
    for depth in [4.0, 64.0, 4096.0_f32] {
        let scene = spheres(&[(depth, 0.25, 0.75, RED)], Encoding::Linear);
        let frame = drawn(&scene, settings(Compensation::Ratio));
        let sigma = 24.0 * 0.25 / f64::from(depth);
        let mut sum = 0.0;
        for i in 0..135 {
            let alpha = 1.0 - number(&frame, "T", i);
            sum += alpha;
            let at = [(i % 15) as f64 - 7.0, (i / 15) as f64 - 4.0];
            if at[0].hypot(at[1]) > 2.0 {
                continue;
            }
            // Both Gaussians are products, and so is the integral.
            let integral: f64 = at.map(|at| convolved(at, sigma, h)).iter().product();
            let wanted = 0.75 * integral;
            assert!((alpha - wanted).abs() < 1e-9 * wanted.max(1e-6), "{depth}: {alpha} {wanted}");
        }
        // The rule of samples is exact but for 2 e^(-2 pi^2 h) of a line.
        let area = 0.75 * std::f64::consts::TAU * sigma * sigma;
        assert!((sum / area - 1.0).abs() < 0.012, "{depth}: {sum} for {area}");
        let bright = drawn(&scene, settings(Compensation::None));
        let middle = 7 + 4 * 15;
        assert!((1.0 - number(&bright, "T", middle) - 0.75).abs() < 1e-12, "no fainter afar");
    }
}

/// The integral of e^(-s s / 2 sigma^2) times the normal density of variance h about `at`, by the
/// midpoint rule, which converges geometrically for Gaussians.
fn convolved(at: f64, sigma: f64, h: f64) -> f64 {
    let step = sigma / 8.0;
    let terms = (-100..=100).map(|i| {
        let s = f64::from(i) * step;
        (-s * s / (2.0 * sigma * sigma) - (at - s) * (at - s) / (2.0 * h)).exp()
    });
    terms.sum::<f64>() * step / (std::f64::consts::TAU * h).sqrt()
}

/// One red disc at the depth 2 on the axis of view.
fn disc(scale: Vec3, turn: Quat) -> Scene {
    cases::scene_of(GaussianArrays {
        position: vec![Vec3::new(0.0, 0.0, -2.0)],
        scale: vec![scale],
        rotation: vec![turn.to_array()],
        opacity: vec![0.75],
        degree: 0,
        harmonics: vec![Vec3::from_array(RED.map(flat))],
        encoding: Encoding::Linear,
    })
}

/// alpha at a pixel where half of rho is this, if it is not skipped.
fn alpha_of(half: f64) -> f64 {
    let alpha = 0.75 * (-half).exp();
    if alpha < f64::from(1.0_f32 / 255.0) { 0.0 } else { alpha }
}

/// The third scale has no effect, and a disc of less than a pixel shows its filter alone.
#[test]
fn a_disc_that_faces_the_camera() {
    for settings in [Settings::DISCS, cases::RAYS] {
        for (sx, sy) in [(0.25, 0.125_f32), (0.0625, 0.015_625)] {
            let scene = disc(Vec3::new(sx, sy, 0.5), Quat::IDENTITY);
            let frame = drawn(&scene, Settings { support: Support::None, ..settings });
            for i in 0..135 {
                let (x, y) = ((i % 15) as f64 + 0.5 - 7.5, (i / 15) as f64 + 0.5 - 4.5);
                let (u, v) = (x / (12.0 * f64::from(sx)), y / (12.0 * f64::from(sy)));
                let half = ((u * u + v * v) / 2.0).min(x * x + y * y);
                let alpha = alpha_of(half);
                near([1.0 - number(&frame, "T", i); 3], [alpha; 3], "alpha");
                let depth = if alpha > 0.0 { 2.0 } else { f64::INFINITY };
                assert_eq!(number(&frame, "Z", i), depth);
            }
        }
    }
}

/// Every ray but those in its plane meets it in the eye: the paper's filter shows the disc, and the
/// program skips it.
#[test]
fn a_disc_edge_on() {
    // The axes become y and z, to the bit.
    let scene = disc(Vec3::new(0.5, 0.25, 0.0), Quat::from_array([0.5; 4]));
    let frame = drawn(&scene, Settings { support: Support::None, ..cases::RAYS });
    for i in 0..135 {
        let (x, y) = ((i % 15) as f64 - 7.0, (i / 15) as f64 - 4.0);
        near([1.0 - number(&frame, "T", i); 3], [alpha_of(x * x + y * y); 3], "alpha");
    }
    let frame = drawn(&scene, Settings::DISCS);
    assert!((0..135).all(|i| number(&frame, "count", i) == 0.0));
}

/// The same discs as Gaussians of two scales, and as surfels with tangents.
#[test]
fn a_gaussian_without_thickness_is_the_surfel_of_the_same_disc() {
    let mut arrays = cases::arrays(30, 0, 91);
    arrays.scale.iter_mut().for_each(|s| s.z = 0.0);
    arrays.encoding = Encoding::Linear;
    // Surfels have no colours below 0.
    arrays.harmonics.iter_mut().for_each(|c| *c = c.abs());
    let flakes = cases::scene_of(arrays);
    let gaussians = flakes.gaussians.as_ref().expect("Gaussians");
    for (name, settings) in PRESETS {
        let settings = Settings { cutoff: 2.0, ..settings };
        let own = |i: usize| Quat::from_array(gaussians.rotation()[i]);
        let half_axis = |i: usize, axis: Vec3| {
            own(i).as_dquat().normalize() * (axis * gaussians.scale()[i] * 2.0).as_dvec3()
        };
        let color = |i: usize| gaussians.harmonics(i)[0] * 0.282_094_8 + 0.5;
        let cloud = Cloud {
            position: gaussians.position().to_vec(),
            normal: Some((0..30).map(|i| own(i) * Vec3::Z).collect()),
            radius: Some(vec![1.0; 30]),
            color: Some((0..30).map(color).collect()),
            opacity: Some(gaussians.opacity().to_vec()),
            tangents: Some(
                (0..30).map(|i| [Vec3::X, Vec3::Y].map(|e| half_axis(i, e).as_vec3())).collect(),
            ),
            ..Cloud::default()
        };
        let surfels = Scene::unlit("", Surfels::new(cloud).expect("good surfels").0);
        for order in [settings.order, Order::Pixel] {
            let settings = Settings { order, ..settings };
            for orthographic in [false, true] {
                let camera = cases::camera(orthographic, [33, 17]);
                let [a, b] = [&flakes, &surfels]
                    .map(|scene| Drawing::new(scene, &camera, settings).frame::<f64>());
                alike(&a, &b, 1e-5, name);
            }
        }
    }
}
