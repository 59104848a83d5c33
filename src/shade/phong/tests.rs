use super::*;
use crate::number::random::unit;
use crate::scene::{Camera, Lens, Pose};
use glam::{DVec3, Vec3};

const LENSES: [Lens; 2] = [Lens::FieldOfView(50.0), Lens::Orthographic(3.0)];

fn camera(width: u32, lens: Lens) -> Camera {
    let eye = DVec3::new(3.0, -1.0, 2.0);
    let pose = Pose { eye, target: DVec3::new(0.5, 0.25, -4.0), up: DVec3::new(0.25, 1.0, 0.125) };
    Camera::new(width, 3, pose, lens).unwrap()
}

/// A random direction.
fn direction(seed: u64, i: u64) -> Vec3 {
    let [x, y, z] = [0, 1, 2].map(|c| unit(seed, 3 * i + c) - 0.5);
    Vec3::new(x, y, z).normalize()
}

/// A vector for each pixel; some are null, some have a length that nothing can be divided by.
fn vectors<R: Exact>(seed: u64, width: u32) -> Plane<[R; 3]> {
    let vector = |i: u64| match (unit(seed + 1, i) * 16.0) as u32 {
        0..4 => Vec3::ZERO,
        4 => direction(seed, i) * 1e-30,
        5 => direction(seed, i) * 1e30,
        6 => Vec3::Z,
        _ => direction(seed, i),
    };
    let values = (0..3 * u64::from(width)).map(|i| vector(i).to_array().map(R::from_f32));
    Plane::from_values(width, 3, values.collect())
}

/// Depths; a third of the pixels and one long run of them are empty.
fn depths<R: Exact>(seed: u64, width: u32) -> Plane<R> {
    let depth = |i: u64| {
        let empty = unit(seed, i) < 0.33 || (40..75).contains(&i);
        if empty { R::INFINITY } else { R::from_f32(0.125 + 8.0 * unit(seed + 1, i)) }
    };
    Plane::from_values(width, 3, (0..3 * u64::from(width)).map(depth).collect())
}

fn lights(seed: u64) -> Vec<Light> {
    let all = [
        Light::DEFAULT,
        Light::Point { position: Vec3::new(1.0, 2.0, -1.0), color: Vec3::new(0.5, 2.0, 0.0) },
        Light::Directional { towards: Vec3::new(0.0, 3.0, 1.0), color: Vec3::new(0.25, 1.0, 9.0) },
        Light::Headlight { towards: Vec3::Z, color: Vec3::ONE },
    ];
    all[..seed as usize % 5].to_vec()
}

/// Shades random planes, and compares every pixel with the definition.
fn lanes_are_the_definition<R: Exact>() {
    let shininess = [1.0, 2.0, 5.0, 10.0, 32.0, 100.0, 64.5, 0.0, 65_536.0, 0.5];
    for seed in 0..400_u64 {
        let width = 1 + (unit(seed, 0) * 70.0) as u32;
        let material = Phong {
            shininess: shininess[seed as usize % shininess.len()],
            specular: if seed % 7 == 6 { 0.0 } else { 0.75 },
            ..Phong::default()
        };
        let camera = camera(width, LENSES[seed as usize / 2 % 2]);
        let shader = Shader::<R>::new(View::new(&camera), &lights(seed / 4), material);
        let depth = depths(seed, width);
        let normal = (seed % 8 != 7).then(|| vectors(seed + 10, width));
        let tangent = (seed % 3 == 0).then(|| vectors(seed + 20, width));
        let color = (seed % 2 == 0).then(|| vectors::<R>(seed + 30, width).map(|v| v.map(R::abs)));
        let exec = Exec::new(1 + seed as usize % 3, 32).unwrap();
        let found = shader.shade(&depth, normal.as_ref(), tangent.as_ref(), color.clone(), &exec);
        let own = material.color.to_array().map(R::from_f32);
        for i in 0..depth.values().len() {
            let at = |plane: &Option<Plane<[R; 3]>>| {
                let [x, y, z] = plane.as_ref().map_or([R::ZERO; 3], |plane| plane.values()[i]);
                Vector3::new(x, y, z)
            };
            let place = (i % width as usize, i / width as usize);
            let surface = color.as_ref().map_or(own, |plane| plane.values()[i]);
            let depth = depth.values()[i];
            let expected = shader.pixel(place, depth, at(&normal), at(&tangent), surface);
            let bits = |color: [R; 3]| color.map(|v| v.to_f64().to_bits());
            let found = found.values()[i];
            assert_eq!(bits(found), bits(expected), "seed {seed}, pixel {i} of {width} x 3");
        }
    }
}

#[test]
fn lanes_have_the_bits_of_the_definition() {
    lanes_are_the_definition::<f32>();
    lanes_are_the_definition::<f64>();
}

/// The first component of a white tube in white light from one direction, both in world space.
fn tube<R: Exact>(material: Phong, tangent: Vec3, towards: Vec3, lens: Lens) -> f64 {
    let light = Light::Directional { towards, color: Vec3::ONE };
    let material = Phong { color: Vec3::ONE, ambient: 0.0, ..material };
    let camera = camera(64, lens);
    let shader = Shader::<R>::new(View::new(&camera), &[light], material);
    let plane = |v: Vec3| Plane::filled(64, 3, v.to_array().map(R::from_f32));
    let depth = Plane::filled(64, 3, R::from_f32(2.0));
    // The normal is not used: this one would face the light.
    let (normal, tangent) = (plane(towards), plane(tangent));
    let shaded = shader.shade(&depth, Some(&normal), Some(&tangent), None, &Exec::sequential());
    shaded.at(21, 1)[0].to_f64()
}

const DIFFUSE: Phong =
    Phong { ambient: 0.0, diffuse: 1.0, specular: 0.0, shininess: 1.0, color: Vec3::ONE };
const SPECULAR: Phong = Phong { diffuse: 0.0, specular: 1.0, ..DIFFUSE };

#[test]
fn a_tube_is_lit_by_the_sine_of_the_angle_between_light_and_tangent() {
    for i in 0..2_000 {
        let (tangent, towards) = (direction(1, i), direction(2, i));
        let cosine = tangent.as_dvec3().normalize().dot(towards.as_dvec3().normalize());
        let sine = (1.0 - cosine * cosine).sqrt();
        let lens = LENSES[i as usize % 2];
        // The length of the tangent does not matter.
        let found = tube::<f64>(DIFFUSE, tangent * (1 + i % 5) as f32, towards, lens);
        // The view matrix is rounded to f32, which turns angles by about 2^-23.
        assert!((found - sine).abs() < 1e-6, "{found} {sine}");
        let narrow = tube::<f32>(DIFFUSE, tangent, towards, lens);
        assert!((narrow - sine).abs() < 2e-6, "{narrow} {sine}");
        let behind = tube::<f64>(DIFFUSE, tangent, -towards, lens);
        assert_eq!(behind, tube::<f64>(DIFFUSE, tangent, towards, lens), "light from behind");
    }
}

/// With n as defined, r . v = 2 (n . l) (n . v) - l . v = l . v - 2 (l . T) (v . T).
#[test]
fn the_highlight_of_a_tube_takes_the_normal_of_the_light() {
    let mut bright = 0;
    for i in 0..2_000 {
        let (tangent, towards) = (direction(3, i), direction(4, i));
        let (t, l) = (tangent.as_dvec3().normalize(), towards.as_dvec3().normalize());
        let v = DVec3::new(3.0, -1.0, 2.0) - DVec3::new(0.5, 0.25, -4.0);
        let v = v.normalize();
        let mirrored = l.dot(v) - 2.0 * l.dot(t) * v.dot(t);
        let expected = if mirrored > 0.0 { mirrored * mirrored * mirrored } else { 0.0 };
        bright += u32::from(mirrored > 0.0);
        let material = Phong { shininess: 3.0, ..SPECULAR };
        let found = tube::<f64>(material, tangent, towards, LENSES[1]);
        assert!((found - expected).abs() < 3e-6, "{found} {expected}");
    }
    assert!((600..1_400).contains(&bright), "{bright}");
}

#[test]
fn light_along_a_tube_adds_nothing() {
    // Exactly 0 where the dot product is exact; otherwise a rounding error, and not its direction.
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let shader = Shader::<f32>::new(
            View::new(&camera(64, LENSES[1])),
            &[Light::Headlight { towards: axis, color: Vec3::ONE }],
            Phong { diffuse: 1.0, ..SPECULAR },
        );
        let form = Form { normal: Vector3::from_glam(axis), tangent: Vector3::from_glam(-axis) };
        assert_eq!(shader.lit(Vector3::ZERO, |l| form.towards(l), [1.0; 3]), [0.0; 3]);
    }
    for i in 0..2_000 {
        let along = direction(5, i);
        for sign in [1.0, -1.0] {
            let found = tube::<f32>(DIFFUSE, along * sign * 0.75, along, LENSES[0]);
            assert!(found < 1e-6, "{along}: {found}");
        }
    }
}

#[test]
fn without_a_measurable_tangent_a_pixel_shows_a_surface() {
    let towards = Vec3::new(0.0, 0.6, 0.8);
    for tangent in [Vec3::ZERO, towards * 1e-30, towards * 1e30, Vec3::NAN] {
        let found = tube::<f32>(DIFFUSE, tangent, towards, LENSES[0]);
        assert!((found - 1.0).abs() < 1e-6, "lit by its normal: {found}");
    }
    assert!(tube::<f32>(DIFFUSE, towards, towards, LENSES[0]) < 1e-6, "a tube");
}
