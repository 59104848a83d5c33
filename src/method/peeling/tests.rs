use super::*;
use crate::composite::sum;
use crate::frame::{Exec, NO_ID, Plane, Samples};
use crate::method::{Method, Picture, Session};
use crate::number::Exact;
use crate::number::random::unit;
use crate::scene::{Camera, Cloud, Lens, Light, Pose, Scene, Surfels};
use crate::shade::phong::Shader;
use crate::source::Shape;
use crate::splat::{
    Epsilon, Fate, Outline, Projector, Shared, SplatSettings, View, batch, project,
};
use glam::{DVec3, Vec3};
use proptest::prelude::*;

fn scene(cloud: Cloud, lights: Vec<Light>) -> Scene {
    let surfels = Surfels::new(cloud).unwrap().0;
    Scene { lights, ..Scene::unlit("test", surfels) }
}

/// Looks from the origin along -z.
fn camera(width: u32, height: u32, lens: Lens) -> Camera {
    let pose = Pose { eye: DVec3::ZERO, target: -DVec3::Z, up: DVec3::Y };
    Camera::new(width, height, pose, lens).unwrap()
}

/// A sheet of discs at z = -depth that fills the view.
fn sheet(cloud: &mut Cloud, depth: f32, opacity: f32, color: Vec3) {
    for i in 0..81_u16 {
        let (x, y) = (f32::from(i % 9) - 4.0, f32::from(i / 9) - 4.0);
        cloud.position.push(Vec3::new(0.5 * x, 0.5 * y, -depth));
        cloud.normal.get_or_insert_default().push(Vec3::Z);
        cloud.radius.get_or_insert_default().push(0.75);
        cloud.color.get_or_insert_default().push(color);
        cloud.opacity.get_or_insert_default().push(opacity);
    }
}

fn settings(epsilon: f32) -> Settings {
    let default = Settings::default();
    let splats = SplatSettings { epsilon: Epsilon::World(epsilon), ..default.splats };
    Settings { splats, ..default }
}

/// The picture by the definition.
fn define<R: Exact>(
    scene: &Scene,
    camera: &Camera,
    method: impl Into<Method>,
    exec: &Exec,
    stages: bool,
) -> Result<Picture<R>> {
    Session::new(scene, method.into(), exec)?.define(camera, stages)
}

fn render<R: Exact>(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    exec: &Exec,
    stages: bool,
) -> Result<Picture<R>> {
    define(scene, camera, *settings, exec, stages)
}

fn peel(scene: &Scene, camera: &Camera, settings: &Settings) -> Picture<f64> {
    render(scene, camera, settings, &Exec::sequential(), true).unwrap()
}

fn scalar<'a, R: Exact>(picture: &'a Picture<R>, name: &str) -> &'a [R] {
    match picture.frame.plane(name) {
        Some(Samples::Scalar(plane)) => plane.values(),
        other => panic!("{name}: {other:?}"),
    }
}

fn color<'a, R: Exact>(picture: &'a Picture<R>, name: &str) -> &'a [[R; 3]] {
    match picture.frame.plane(name) {
        Some(Samples::Color(plane)) => plane.values(),
        other => panic!("{name}: {other:?}"),
    }
}

fn count<'a, R: Exact>(picture: &'a Picture<R>, name: &str) -> &'a [u8] {
    match picture.frame.plane(name) {
        Some(Samples::Count(plane)) => plane.values(),
        other => panic!("{name}: {other:?}"),
    }
}

/// A fragment of a pixel: surfel, nearness, depth, weight, whether the back is seen.
type Fragment<R> = (u32, R, R, R, bool);

/// The expected picture: colour, opacity, depth, surfel, count of layers.
type Expected<R> = (Vec<[R; 3]>, Vec<R>, Vec<R>, Vec<u32>, Vec<u8>);

/// The fragments that are inside, for every pixel: no tiles, no bins, no bounds.
fn fragments<R: Exact>(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
) -> Vec<Vec<Fragment<R>>> {
    let view = View::<R>::new(camera);
    let shared = Shared::new(&view, &settings.splats.kernel);
    let projector = Projector::new(view, &settings.splats.kernel, settings.splats.cull);
    let mut pixels = vec![Vec::new(); (camera.width * camera.height) as usize];
    for i in 0..scene.surfels.len() {
        let (splat, reasons) = project(&projector, &batch::disc(&scene.surfels, i), i as u32);
        if reasons.fate() != Fate::Visible {
            continue;
        }
        for (pixel, found) in (0..).zip(&mut pixels) {
            let (x, y) = ((pixel % camera.width) as f32 + 0.5, (pixel / camera.width) as f32 + 0.5);
            let dx = R::from_f32(x) - splat.footprint.center.x;
            let dy = R::from_f32(y) - splat.footprint.center.y;
            let (q, w) = splat.footprint.fragment(&shared, dx, dy);
            if q <= shared.limit {
                found.push((i as u32, w, shared.depth(w), splat.footprint.weight(q), splat.back));
            }
        }
    }
    pixels
}

/// The average of the fragments of one layer: normal, colour, opacity.
fn average<R: Exact>(surfels: &Surfels, layer: &[Fragment<R>]) -> ([R; 3], Option<[R; 3]>, R) {
    let mean = |value: &dyn Fn(usize) -> f32, sign: bool| {
        let (mut sum, mut total) = (R::ZERO, R::ZERO);
        for &(i, _, _, weight, back) in layer {
            let value = R::from_f32(value(i as usize));
            sum = sum + weight * if sign && back { -value } else { value };
            total = total + weight;
        }
        if total > R::ZERO { sum / total } else { R::ZERO }
    };
    let n = [0, 1, 2].map(|c| mean(&|i| surfels.normal()[i][c], true));
    let length = ((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]).sqrt();
    let normal = if length > R::ZERO { n.map(|c| c / length) } else { [R::ZERO; 3] };
    let color = surfels.color().map(|all| [0, 1, 2].map(|c| mean(&|i| all[i][c], false)));
    (normal, color, mean(&|i| surfels.opacity().map_or(1.0, |all| all[i]), false))
}

/// Depth peeling exactly as its page says: every pixel has the list of all its fragments.
fn by_the_page<R: Exact>(scene: &Scene, camera: &Camera, settings: &Settings) -> Expected<R> {
    let (width, height) = (camera.width, camera.height);
    let epsilon = R::from_f32(settings.splats.epsilon.resolve(&scene.surfels));
    let shader = Shader::new(View::new(camera), &scene.lights, scene.material);
    let mut left = fragments::<R>(scene, camera, settings);
    let n = left.len();
    let own = scene.material.color.to_array().map(R::from_f32);
    let (mut colors, mut alphas, mut through) =
        (vec![[R::ZERO; 3]; n], vec![R::ZERO; n], vec![R::ONE; n]);
    let (mut depths, mut ids, mut counts) = (vec![R::INFINITY; n], vec![NO_ID; n], vec![0; n]);
    for j in 0..settings.layers {
        let mut depth = Plane::filled(width, height, R::INFINITY);
        let mut normal = Plane::filled(width, height, [R::ZERO; 3]);
        let mut surface = Plane::filled(width, height, own);
        let mut opacity = vec![R::ZERO; n];
        for pixel in 0..n {
            let Some(&(mut id, mut w, mut t, ..)) = left[pixel].first() else { continue };
            for &(other, nearness, depth, ..) in &left[pixel] {
                if nearness > w {
                    (id, w, t) = (other, nearness, depth);
                }
            }
            let (layer, rest) = left[pixel].iter().partition(|f| f.2 <= t + epsilon);
            left[pixel] = rest;
            let (n, color, alpha) = average(&scene.surfels, &layer);
            depth.values_mut()[pixel] = t;
            normal.values_mut()[pixel] = n;
            surface.values_mut()[pixel] = color.unwrap_or(own);
            opacity[pixel] = alpha;
            counts[pixel] += 1;
            if j == 0 {
                (depths[pixel], ids[pixel]) = (t, id);
            }
        }
        let shaded = shader.shade(&depth, Some(&normal), None, Some(surface), &Exec::sequential());
        for pixel in 0..n {
            let factor = through[pixel] * opacity[pixel];
            colors[pixel] = sum::add(colors[pixel], factor, shaded.values()[pixel]);
            alphas[pixel] = alphas[pixel] + factor;
            through[pixel] = through[pixel] * (R::ONE - opacity[pixel]);
        }
    }
    let alphas = alphas.into_iter().map(|a| if a > R::ONE { R::ONE } else { a }).collect();
    (colors, alphas, depths, ids, counts)
}

fn agrees_with_the_page<R: Exact>(scene: &Scene, camera: &Camera, settings: &Settings) {
    let (colors, alphas, depths, ids, counts) = by_the_page::<R>(scene, camera, settings);
    for (threads, tile) in [(1, 32), (3, 8)] {
        let exec = Exec::new(threads, tile).unwrap();
        let found = render::<R>(scene, camera, settings, &exec, false).unwrap();
        assert_eq!(color(&found, ""), colors);
        assert_eq!(scalar(&found, "A"), alphas);
        assert_eq!(scalar(&found, "Z"), depths);
        assert_eq!(
            found.frame.plane("id"),
            Some(&Samples::Index(Plane::from_values(camera.width, camera.height, ids.clone())))
        );
        assert_eq!(count(&found, "layers"), counts);
    }
}

/// A few large discs at all angles, in a box before the camera. Every fourth lies on the disc
/// before, with another colour and opacity.
fn jumble(seed: u64, n: usize, colored: bool, transparent: bool) -> Cloud {
    let value = |i: usize, c: u64| {
        let i = if i % 4 == 3 && c < 9 { i - 1 } else { i };
        unit(seed, 16 * i as u64 + c)
    };
    let vector = |i: usize, c: u64| Vec3::new(value(i, c), value(i, c + 1), value(i, c + 2));
    let opacity = |i: usize| match (value(i, 9) * 4.0) as u32 {
        0 => 0.0,
        1 => 1.0,
        _ => value(i, 10),
    };
    Cloud {
        position: (0..n).map(|i| vector(i, 0) * 2.0 - Vec3::new(1.0, 1.0, 4.0)).collect(),
        normal: Some((0..n).map(|i| vector(i, 3) - Vec3::splat(0.5)).collect()),
        radius: Some((0..n).map(|i| 0.1 + value(i, 6)).collect()),
        color: colored.then(|| (0..n).map(|i| vector(i, 11)).collect()),
        opacity: transparent.then(|| (0..n).map(opacity).collect()),
        ..Cloud::default()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn peeling_is_what_its_page_says(
        (seed, n) in (any::<u64>(), 1_usize..40),
        (colored, transparent, lit, cull) in any::<(bool, bool, bool, bool)>(),
        perspective in any::<bool>(),
        epsilon in prop::sample::select(vec![0.0, 0.0625, 0.5, f32::INFINITY]),
        outline in prop::sample::select(vec![Outline::Affine, Outline::Perspective, Outline::RayCast]),
        layers in prop::sample::select(vec![1, 2, 5, 64]),
    ) {
        let scene =
            scene(jumble(seed, n, colored, transparent), if lit { vec![Light::DEFAULT] } else { vec![] });
        let lens = if perspective { Lens::Focal(14.0) } else { Lens::Orthographic(2.0) };
        let camera = camera(19, 11, lens);
        let mut settings = Settings { layers, ..settings(epsilon) };
        settings.splats.cull = cull;
        settings.splats.kernel.outline = outline;
        agrees_with_the_page::<f32>(&scene, &camera, &settings);
        agrees_with_the_page::<f64>(&scene, &camera, &settings);
    }
}

fn opaque_is_ewa<R: Exact>(scene: &Scene, camera: &Camera, settings: &Settings) {
    let exec = Exec::sequential();
    let peeled = render::<R>(scene, camera, settings, &exec, true).unwrap();
    let ewa = define::<R>(scene, camera, settings.splats, &exec, true).unwrap();
    for plane in ["", "A", "Z", "id"] {
        assert_eq!(peeled.frame.plane(plane), ewa.frame.plane(plane), "{plane}");
    }
    assert_eq!(color(&peeled, "layer1"), color(&ewa, ""));
    assert_eq!(scalar(&peeled, "layer1.A"), scalar(&ewa, "A"));
    assert_eq!(scalar(&peeled, "layer1.Z"), scalar(&ewa, "Z"));
    assert_eq!(count(&peeled, "layer1.count"), count(&ewa, "attributes.count"));
    assert!(count(&peeled, "layers").iter().any(|&layers| layers > 1), "something is hidden");
}

#[test]
fn opaque_surfels_give_the_ewa_picture_to_the_last_bit() {
    let shape = Shape::Torus;
    for lens in [shape.default_lens(), Lens::Orthographic(3.0)] {
        let camera = Camera::new(50, 41, shape.default_pose(), lens).unwrap();
        let surfels = shape.surfels(3_000, 1).unwrap();
        let plain = Cloud { opacity: None, ..surfels.into_cloud() };
        let ones = Cloud { opacity: Some(vec![1.0; plain.position.len()]), ..plain.clone() };
        let gray = Cloud { color: None, ..plain.clone() };
        for (cloud, lights) in
            [(plain, vec![Light::DEFAULT]), (ones, vec![]), (gray, vec![Light::DEFAULT])]
        {
            let scene = scene(cloud, lights);
            opaque_is_ewa::<f32>(&scene, &camera, &Settings::default());
            opaque_is_ewa::<f64>(&scene, &camera, &Settings::default());
        }
    }
}

#[test]
fn two_parallel_sheets_are_alpha_blended() {
    let (front, back) = (Vec3::new(0.5, 0.25, 1.0), Vec3::new(0.125, 1.0, 0.75));
    for (a, b) in [(0.25, 0.75), (0.5, 1.0), (1.0, 0.5), (0.75, 0.0)] {
        let mut cloud = Cloud::default();
        // The farther one first, because the order of the surfels is not the order of depth.
        sheet(&mut cloud, 3.0, b, back);
        sheet(&mut cloud, 2.0, a, front);
        let picture =
            peel(&scene(cloud, vec![]), &camera(16, 16, Lens::Focal(16.0)), &settings(0.5));
        let (a, b) = (f64::from(a), f64::from(b));
        for pixel in 0..256 {
            for c in 0..3 {
                let blended = a * f64::from(front[c]) + (1.0 - a) * (b * f64::from(back[c]));
                assert!((color(&picture, "")[pixel][c] - blended).abs() < 1e-14);
            }
            assert!((scalar(&picture, "A")[pixel] - (1.0 - (1.0 - a) * (1.0 - b))).abs() < 1e-14);
            assert!((scalar(&picture, "layer2.A")[pixel] - b).abs() < 1e-14);
            assert!((scalar(&picture, "Z")[pixel] - 2.0).abs() < 1e-14);
            assert!((scalar(&picture, "layer2.Z")[pixel] - 3.0).abs() < 1e-14);
            assert_eq!(scalar(&picture, "layer3.Z")[pixel], f64::INFINITY);
            assert_eq!(count(&picture, "layers")[pixel], 2);
        }
    }
}

#[test]
fn what_has_opacity_0_shows_what_is_behind() {
    let mut cloud = Cloud::default();
    sheet(&mut cloud, 3.0, 0.375, Vec3::X);
    sheet(&mut cloud, 3.75, 1.0, Vec3::Y);
    let view = camera(16, 16, Lens::Focal(16.0));
    let lights = || vec![Light::DEFAULT];
    let without = peel(&scene(cloud.clone(), lights()), &view, &settings(0.5));
    sheet(&mut cloud, 2.0, 0.0, Vec3::Z);
    let with = peel(&scene(cloud, lights()), &view, &settings(0.5));
    assert_eq!(color(&with, ""), color(&without, ""));
    assert_eq!(scalar(&with, "A"), scalar(&without, "A"));
    assert_eq!(color(&with, "layer2"), color(&without, "layer1"));
}

#[test]
fn layers_end_at_the_limit_and_without_one_where_the_fragments_do() {
    let mut cloud = Cloud::default();
    (0..20_u8).for_each(|i| sheet(&mut cloud, 2.0 + 0.25 * f32::from(i), 0.125, Vec3::ONE));
    let scene = scene(cloud, vec![]);
    let view = camera(8, 8, Lens::Focal(16.0));
    let mut alpha = 0.0;
    for layers in 1..=24 {
        let picture = peel(&scene, &view, &Settings { layers, ..settings(0.125) });
        if layers <= 20 {
            alpha = 0.125 + 0.875 * alpha;
        }
        assert!(scalar(&picture, "A").iter().all(|a| (a - alpha).abs() < 1e-13), "{layers}");
        assert!(color(&picture, "").iter().all(|[r, ..]| (r - alpha).abs() < 1e-13), "{layers}");
        let expected = if layers < 20 { layers as u8 } else { 20 };
        assert!(count(&picture, "layers").iter().all(|&found| found == expected));
        let last = format!("layer{}", layers.min(STAGES));
        assert!(picture.frame.plane(&last).is_some());
        let beyond = format!("layer{}", layers.min(STAGES) + 1);
        assert!(picture.frame.plane(&beyond).is_none(), "planes follow from the settings");
    }
}

#[test]
fn opacity_never_exceeds_1() {
    // Without the cut, rounding in f32 leaves 1 + 2^-23 at some pixels.
    let mut cloud = Cloud::default();
    sheet(&mut cloud, 2.0, 0.257_803_1, Vec3::ONE);
    sheet(&mut cloud, 3.0, 0.763_128_5, Vec3::ONE);
    sheet(&mut cloud, 3.75, 1.0, Vec3::ONE);
    let (scene, view) = (scene(cloud, vec![]), camera(64, 64, Lens::Focal(64.0)));
    let picture = render::<f32>(&scene, &view, &settings(0.5), &Exec::sequential(), false).unwrap();
    assert!(scalar(&picture, "A").iter().all(|&alpha| alpha > 0.999 && alpha <= 1.0));
}

#[test]
fn threads_and_tiles_leave_no_trace() {
    let scene = scene(jumble(5, 300, true, true), vec![Light::DEFAULT]);
    let camera = camera(70, 45, Lens::Focal(40.0));
    let draw = |threads, tile| {
        let exec = Exec::new(threads, tile).unwrap();
        render::<f32>(&scene, &camera, &settings(0.03125), &exec, true).unwrap()
    };
    let reference = draw(1, 64);
    assert!(count(&reference, "layers").iter().any(|&layers| layers > 8));
    for (threads, tile) in [(1, 8), (2, 16), (5, 32)] {
        let found = draw(threads, tile);
        assert_eq!(found.frame, reference.frame, "{threads} threads, tiles of {tile}");
        assert_eq!(found.tally, reference.tally);
    }
}

#[test]
fn numbers_out_of_range_are_refused() {
    for layers in [0, MAX_LAYERS + 1] {
        let error = Settings { layers, ..Settings::default() }.check().unwrap_err();
        assert!(error.to_string().starts_with("peel: "), "{error}");
    }
    assert!(Settings { layers: MAX_LAYERS, ..Settings::default() }.check().is_ok());
    assert!(settings(-1.0).check().is_err(), "epsilon");
}

#[test]
fn a_layer_follows_from_the_planes_of_the_one_before() {
    let scene = scene(jumble(11, 60, true, true), vec![Light::DEFAULT]);
    let camera = camera(23, 17, Lens::Focal(14.0));
    let exec = Exec::new(2, 8).unwrap();
    let session = Session::new(&scene, settings(0.0625).into(), &exec).unwrap();
    let all = session.define::<f32>(&camera, true).unwrap().frame;
    let of = |name: &str, number: u32| name.starts_with(&format!("layer{number}"));
    for number in 2..=STAGES {
        let mut before = all.clone();
        before.planes.retain(|plane| (1..number).any(|earlier| of(&plane.name, earlier)));
        let found = session.stage(&camera, "layers", &before).unwrap();
        assert_eq!(found.planes.len(), 4);
        for plane in found.planes {
            assert!(of(&plane.name, number), "{}", plane.name);
            assert_eq!(Some(&plane.samples), all.plane(&plane.name), "{}", plane.name);
        }
    }
}
