//! Known answers: pictures whose numbers follow from closed forms or quadrature.

use crate::oracle::kit::draw::Drawing;
use crate::oracle::kit::eye::{Eye, dot, wide};
use crate::oracle::kit::planes::{plane, scalars};
use crate::oracle::kit::scene::{self, ahead, change, discs, surfels};
use glam::Vec3;
use splatref::frame::{Frame, Samples};
use splatref::method::ewa::Settings;
use splatref::number::Exact;
use splatref::scene::{Camera, Cloud, Lens, Scene};
use splatref::source::Shape;
use splatref::splat::Epsilon;
use splatref::splat::{Kernel, Outline};
use std::f64::consts::PI;

/// Discs of one radius, coloured or not.
fn scene(all: &[(Vec3, Vec3)], radius: f32, color: Option<Vec3>) -> Scene {
    let color = color.map(|c| vec![c; all.len()]);
    let cloud = discs(all.iter().map(|(p, n)| (*p, *n, radius)));
    scene::scene(surfels(Cloud { color, ..cloud }))
}

/// At the origin, looking along -z.
fn camera(lens: Lens, size: u32) -> Camera {
    ahead(lens, [size; 2])
}

fn render<R: Exact>(scene: &Scene, camera: &Camera, settings: &Settings) -> Frame<R> {
    Drawing::new(scene, camera, *settings).frame()
}

fn settings(outline: Outline, cutoff: f32, low_pass: f32) -> Settings {
    let kernel = Kernel { outline, cutoff, low_pass };
    Settings { kernel, epsilon: Epsilon::World(f32::INFINITY), cull: false }
}

/// A Gaussian disc seen at an angle, warped by the projection linearized at its centre and
/// convolved with the low-pass Gaussian, by the trapezoidal rule over the plane of the disc.
fn convolution(eye: &Eye, p: [f64; 3], n: [f64; 3], s: f64, h: f64, at: [f64; 2]) -> f64 {
    let first = {
        let length = (n[0] * n[0] + n[2] * n[2]).sqrt();
        [n[2] / length, 0.0, -n[0] / length]
    };
    let second = [
        n[1] * first[2] - n[2] * first[1],
        n[2] * first[0] - n[0] * first[2],
        n[0] * first[1] - n[1] * first[0],
    ];
    let center = eye.pixel(p);
    // The Jacobian by central differences of the projection itself.
    let slope = |axis: [f64; 3]| -> [f64; 2] {
        let step = 1e-5;
        let moved = |by: f64| eye.pixel(std::array::from_fn(|i| p[i] + by * axis[i]));
        let (ahead, back) = (moved(step), moved(-step));
        std::array::from_fn(|i| (ahead[i] - back[i]) / (2.0 * step))
    };
    let (a, b) = (slope(first), slope(second));
    let area = (a[0] * b[1] - a[1] * b[0]).abs();
    let (mut sum, step, reach) = (0.0, s / 8.0, 64);
    for i in -reach..=reach {
        for j in -reach..=reach {
            let (u, v) = (f64::from(i) * step, f64::from(j) * step);
            let x = at[0] - center[0] - (u * a[0] + v * b[0]);
            let y = at[1] - center[1] - (u * a[1] + v * b[1]);
            let disc = (-0.5 * (u * u + v * v) / (s * s)).exp();
            sum += disc * (-0.5 * (x * x + y * y) / h).exp();
        }
    }
    sum * step * step * area / (2.0 * PI * h)
}

#[test]
fn one_splat_is_the_convolution_that_ewa_approximates() {
    let normals = [
        Vec3::Z,
        Vec3::new(0.6, 0.0, 0.8),
        Vec3::new(0.48, 0.6, 0.64),
        Vec3::new(-0.8, 0.36, 0.48),
    ];
    for (number, normal) in normals.into_iter().enumerate() {
        for lens in [Lens::Focal(40.0), Lens::Orthographic(4.0)] {
            let camera = camera(lens, 48);
            let (k, h, r) = (2.0, 1.0, 0.75);
            let position = Vec3::new(0.25, -0.375, -3.0);
            let frame = render::<f64>(
                &scene(&[(position, normal)], r, None),
                &camera,
                &settings(Outline::Affine, k, h),
            );
            let weights = scalars(&frame, "attributes.weight");
            let eye = Eye::new(&camera);
            let (p, n) = (wide(position), wide(normal));
            let mut checked = 0;
            for i in (0..weights.len()).step_by(3).filter(|i| weights[*i] > 0.0) {
                let at = [(i % 48) as f64 + 0.5, (i / 48) as f64 + 0.5];
                let expected = convolution(&eye, p, n, f64::from(r / k), h.into(), at);
                // Normals are unit to 2^-24, the differences of the projection good to 10^-9.
                let error = (weights[i] - expected).abs() / expected;
                assert!(
                    error < 1e-6,
                    "normal {number}, pixel {at:?}: {} for {expected}",
                    weights[i]
                );
                checked += 1;
            }
            assert!(checked > 10, "normal {number}: {checked} pixels");
        }
    }
}

#[test]
fn one_splat_sums_to_its_integral() {
    // The integral of A exp(-q/2) over q <= k k is 2 pi A sqrt(det V) (1 - exp(-k k / 2)), and
    // A sqrt(det V) is the area s s |a x b . n| of the disc's own Gaussian on the screen.
    for (normal, slant) in
        [(Vec3::Z, 1.0), (Vec3::new(0.6, 0.0, 0.8), 0.8), (Vec3::new(0.0, 0.96, 0.28), 0.28)]
    {
        for (k, h) in [(2.0, 0.25), (1.0, 1.0), (3.0, 16.0)] {
            let camera = camera(Lens::Orthographic(4.0), 400);
            let radius = 0.25 * k;
            let scene = scene(&[(Vec3::new(0.001953125, -0.00390625, -3.0), normal)], radius, None);
            let frame = render::<f64>(&scene, &camera, &settings(Outline::Affine, k, h));
            let sum: f64 = scalars(&frame, "attributes.weight").iter().sum();
            let deviation = f64::from(radius / k) * f64::from(camera.fx);
            let cut = 1.0 - (-0.5 * f64::from(k * k)).exp();
            let integral = 2.0 * PI * deviation * deviation * slant * cut;
            // The rim cuts pixels: their count differs from its area by its lattice discrepancy,
            // far below the length of the rim 2 pi k sigma, times the weight there, over the whole.
            let rim = 2.0 * PI * f64::from(k) * deviation * (1.0 - cut) * slant;
            let bound = 0.25 * rim / integral + 1e-6;
            let error = (sum / integral - 1.0).abs();
            assert!(error < bound, "k {k}, h {h}, {normal:?}: {sum} for {integral}, bound {bound}");
            assert!(bound < 0.02, "the bound says something: {bound}");
        }
    }
}

#[test]
fn a_dense_plane_is_a_partition_of_unity() {
    // A grid of spacing L px of Gaussians of variance V and height A. Poisson: without a cut-off
    // the sum is 2 pi A V / L^2 within the factor 1 +- 4.01 exp(-2 pi^2 V / L^2). Each lattice
    // point beyond the cut-off R = k sqrt(V) weighs at most the average over its cell moved inwards
    // by the half diagonal d = L / sqrt(2), so the cut takes at most the factor (1 + d / (R - 2 d))
    // exp(-(R - 2 d)^2 / 2V).
    let (pixels, spacing, k, h) = (64_u32, 0.0625_f32, 4.0_f32, 0.25_f32);
    let deviations = 3.0_f32;
    let camera = camera(Lens::Orthographic(1.0), pixels);
    let grid: Vec<_> = (-32..=32)
        .flat_map(|i| (-32..=32).map(move |j| (i, j)))
        .map(|(i, j)| (Vec3::new(i as f32 * spacing, j as f32 * spacing, -2.0), Vec3::Z))
        .collect();
    let color = Vec3::new(0.1, 0.7, 0.3);
    let scene = scene(&grid, k * deviations * spacing, Some(color));
    for outline in [Outline::Affine, Outline::Perspective] {
        let frame = render::<f32>(&scene, &camera, &settings(outline, k, h));
        let scale = f64::from(camera.fx);
        let (lattice, s) = (f64::from(spacing) * scale, f64::from(deviations * spacing) * scale);
        let variance = s * s + f64::from(h);
        let amplitude = s * s / variance;
        let mean = 2.0 * PI * amplitude * variance / (lattice * lattice);
        let ripple = 4.01 * (-2.0 * PI * PI * variance / (lattice * lattice)).exp();
        let (rim, d) = (f64::from(k) * variance.sqrt(), lattice / 2.0_f64.sqrt());
        let cut = (1.0 + d / (rim - 2.0 * d)) * (-0.5 * (rim - 2.0 * d).powi(2) / variance).exp();
        assert!(cut + ripple < 0.005, "the bound says something: {cut} {ripple}");
        for weight in scalars(&frame, "attributes.weight") {
            let relative = f64::from(*weight) / mean - 1.0;
            assert!(
                relative < ripple + 1e-5 && relative > -(ripple + cut + 1e-5),
                "{outline:?}: {relative}"
            );
        }
        let Samples::Color(resolved) = plane(&frame, "resolved") else { panic!("no colour") };
        for value in resolved.values() {
            for (component, expected) in value.iter().zip(color.to_array()) {
                // n terms a sum: n roundings at most, sqrt(n) likely; n is about 450.
                let ulps = component.ulps_to(expected);
                assert!(ulps < 64.0, "{outline:?}: {component} for {expected}");
            }
        }
    }
}

#[test]
fn the_depth_of_a_sphere_is_within_the_sagitta_of_its_discs() {
    // A disc of radius r tangent to a sphere of radius 1 lies between it and the sphere of radius
    // sqrt(1 + r^2). A ray at the distance b from the centre passes through that shell in
    // sqrt(1 + r r - b b) - sqrt(1 - b b) before it meets the sphere.
    let shape = Shape::by_name("sphere").expect("a shape");
    let scene = scene::scene(shape.surfels(2000, 1).expect("surfels"));
    let radius = f64::from(scene.surfels.radius()[0]);
    for lens in [shape.default_lens(), Lens::Orthographic(2.25)] {
        let camera = Camera::new(64, 64, shape.default_pose(), lens).expect("a camera");
        let eye = Eye::new(&camera);
        let center = eye.point([0.0; 3]);
        let kernel = settings(Outline::RayCast, 2.0, 0.0);
        let frame = render::<f32>(&scene, &camera, &Settings { cull: true, ..kernel });
        let mut hits = 0;
        for (i, z) in scalars(&frame, "visibility.Z").iter().enumerate() {
            let (origin, ray) = eye.ray((i % 64) as f64 + 0.5, (i / 64) as f64 + 0.5);
            let to: [f64; 3] = std::array::from_fn(|i| center[i] - origin[i]);
            let (rr, along) = (dot(ray, ray), dot(ray, to));
            let bb = dot(to, to) - along * along / rr;
            // A disc covers this pixel for sure only away from the silhouette.
            if bb > 0.9 {
                continue;
            }
            let depth = along / rr - ((1.0 - bb) / rr).sqrt();
            let shell = ((1.0 + radius * radius - bb).sqrt() - (1.0 - bb).sqrt()) / rr.sqrt();
            let rounding = 1e-5;
            let ahead = depth - f64::from(*z);
            assert!(ahead > -rounding && ahead < shell + rounding, "pixel {i}: {ahead}, {shell}");
            hits += 1;
        }
        assert!(hits > 1000, "{hits} pixels");
    }
}

/// A disc of radius 4 px about a pixel's centre, moved to the right by `shift` px.
fn cut_off<R: Exact>(outline: Outline, shift: f32) -> Vec<u32> {
    let mut camera = camera(Lens::Orthographic(16.0), 16);
    (camera.fx, camera.fy, camera.cx, camera.cy) = (1.0, 1.0, 8.5, 8.5);
    let scene = scene(&[(Vec3::new(shift, 0.0, -3.0), Vec3::Z)], 4.0, None);
    let frame = render::<R>(&scene, &camera, &settings(outline, 2.0, 0.0));
    let weights = scalars(&frame, "attributes.weight");
    let inside = (0..weights.len()).filter(|i| weights[*i] > R::ZERO).map(|i| i as u32).collect();
    for (i, w) in weights.iter().enumerate() {
        let (dx, dy) = ((i % 16) as f64 - 8.0 - f64::from(shift), (i / 16) as f64 - 8.0);
        let q = (dx * dx + dy * dy) / 4.0;
        // Above and below q exceeds 4 by 2^-32 if the disc is moved: f32 rounds that away.
        let open = size_of::<R>() == 4 && q > 4.0 && q < 4.0 + 1e-8;
        assert_eq!(*w > R::ZERO, q <= 4.0 || open, "{outline:?}, pixel {i}: q {q}");
    }
    inside
}

#[test]
fn a_splat_ends_at_the_cut_off_and_includes_it() {
    let pixel = |x: u32, y: u32| y * 16 + x;
    let rim = [pixel(12, 8), pixel(4, 8), pixel(8, 12), pixel(8, 4)];
    for outline in [Outline::Affine, Outline::Perspective, Outline::RayCast] {
        for inside in [cut_off::<f32>(outline, 0.0), cut_off::<f64>(outline, 0.0)] {
            assert!(rim.iter().all(|p| inside.contains(p)), "{outline:?}: q = k^2 is inside");
            // The lattice points of a disc of radius 4.
            assert_eq!(inside.len(), 49, "{outline:?}");
        }
        // A little to the left, and the pixel to the right is outside.
        let step = -(2.0_f32).powi(-15);
        for inside in [cut_off::<f32>(outline, step), cut_off::<f64>(outline, step)] {
            assert!(inside.contains(&rim[1]) && !inside.contains(&rim[0]), "{outline:?}");
        }
        assert_eq!(
            cut_off::<f64>(outline, step).len(),
            46,
            "{outline:?}: three of the rim are outside"
        );
    }
}

#[test]
fn orthographic_depths_stop_at_the_near_plane() {
    let mut camera = camera(Lens::Orthographic(6.0), 24);
    camera.near = 0.0625;
    let scene = scene(&[(Vec3::new(0.0, 0.0, -3.0), Vec3::new(0.8, 0.0, 0.6))], 30.0, None);
    for outline in [Outline::Affine, Outline::Perspective, Outline::RayCast] {
        let frame = render::<f64>(&scene, &camera, &settings(outline, 2.0, 0.25));
        for z in scalars(&frame, "visibility.Z") {
            assert!(*z >= 0.0625, "{outline:?}: depth {z} before the near plane");
        }
    }
}

#[test]
fn an_ellipse_partly_in_sight_is_drawn() {
    let camera = camera(Lens::Orthographic(6.0), 60);
    // Conjugate half axes that are not perpendicular reach sqrt(1 + 0.81) = 1.345 to the right; and
    // a radius that says nothing of the tangents. The left edge of the view is at -3.
    for (x, radius, tangents) in
        [(-4.2, 1.0, [Vec3::X, Vec3::new(0.9, 0.3, 0.0)]), (-3.5, 0.01, [Vec3::X, Vec3::Y])]
    {
        let disc = [(Vec3::new(x, 0.0, -3.0), Vec3::Z)];
        let mut one = scene(&disc, radius, None);
        change(&mut one, |cloud| cloud.tangents = Some(vec![tangents]));
        for outline in [Outline::Affine, Outline::Perspective, Outline::RayCast] {
            let frame = render::<f64>(&one, &camera, &settings(outline, 2.0, 0.0));
            let seen = scalars(&frame, "attributes.weight").iter().filter(|w| **w > 0.0).count();
            assert!(seen > 0, "{outline:?}, radius {radius}: nothing is drawn");
        }
    }
}
