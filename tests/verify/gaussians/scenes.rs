//! The scenes that the renderer is tried on: scenes of the suite, and larger ones.

use glam::{DVec3, Vec3, Vec4};
use splatref::frame::Exec;
use splatref::method::Method;
use splatref::method::gaussians::Settings;
use splatref::number::random::unit;
use splatref::scene::gaussians::Encoding;
use splatref::scene::{Camera, Environment, GaussianArrays, Gaussians, Lens, Pose, Scene, Surfels};
use splatref::verdict::conformance::Rule;

/// A scene with its name.
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) scene: Scene,
    pub(super) camera: Camera,
    pub(super) settings: Settings,
}

/// The scenes of the suite for which a filter holds.
pub(super) fn suite(wanted: impl Fn(&str) -> bool) -> Vec<Case> {
    let exec = Exec::sequential();
    let rules = Rule::all("gaussians").unwrap();
    let small = rules.into_iter().filter(|rule| !rule.large && wanted(&rule.name));
    let case = |rule: Rule| {
        let case = rule.case(&exec).unwrap();
        let Method::Gaussians(settings) = case.method else { panic!("a rule of Gaussians") };
        let name = String::leak(rule.name);
        Case { name, scene: case.scene, camera: case.camera, settings }
    };
    small.map(case).collect()
}

/// The scenes of the suite in which some bug shows best.
const SOME: [&str; 24] = [
    "rotation-inverse",
    "low-pass-0.1",
    "compensation-floor",
    "most-alpha",
    "most-alpha-0.999",
    "least-alpha",
    "stop",
    "order-by-depth",
    "order-distance",
    "tie",
    "near",
    "behind",
    "beside",
    "direction-of-world",
    "colors-below-0",
    "count-17",
    "background",
    "surface-cuts",
    "surface-seen",
    "surface-hides",
    "disc-tilted",
    "principal-point",
    "pixel-aspect",
    "orthographic",
];

/// 403 splats of every shape, around a camera that looks along no axis.
fn larger(name: &'static str, settings: Settings, sky: bool) -> Case {
    let random = |i: u64, k: u64| 2.0 * unit(29, 80 * i + k) - 1.0;
    let of = |f: &dyn Fn(u64) -> Vec3| (0..403).map(f).collect::<Vec<_>>();
    let size = |r: f32| 0.02 + 0.3 * (0.5 * (1.0 + r)) * (0.5 * (1.0 + r));
    let rotation = |i: u64| {
        Vec4::new(random(i, 6), random(i, 7), random(i, 8), random(i, 9)).normalize().to_array()
    };
    let color = |i: u64, k: u64| {
        Vec3::new(random(i, 3 * k + 20), random(i, 3 * k + 21), random(i, 3 * k + 22))
    };
    let arrays = GaussianArrays {
        position: of(&|i| Vec3::new(3.0 * random(i, 0), 2.5 * random(i, 1), 3.0 * random(i, 2))),
        scale: of(&|i| Vec3::new(size(random(i, 3)), size(random(i, 4)), size(random(i, 5)))),
        rotation: (0..403).map(rotation).collect(),
        // A tenth is opaque.
        opacity: (0..403)
            .map(|i| if i % 10 == 0 { 1.0 } else { 0.55 + 0.45 * random(i, 10) })
            .collect(),
        degree: 3,
        harmonics: (0..403 * 16)
            .map(|j| color(j / 16, j % 16) * if j % 16 == 0 { 1.5 } else { 0.3 })
            .collect(),
        encoding: Encoding::Srgb,
    };
    let pose = Pose {
        eye: DVec3::new(2.1, 1.7, 5.2),
        target: DVec3::new(0.2, -0.1, 0.3),
        up: DVec3::new(0.1, 1.0, 0.05),
    };
    let mut camera = Camera::new(160, 120, pose, Lens::FieldOfView(50.0)).unwrap();
    (camera.cx, camera.cy) = (camera.cx + 7.25, camera.cy - 4.5);
    let scene = Scene {
        environment: sky.then_some(Environment::Sky),
        gaussians: Some(Gaussians::new(arrays).unwrap().0),
        ..Scene::unlit(name, Surfels::none())
    };
    Case { name, scene, camera, settings }
}

/// Larger scenes.
pub(super) fn large() -> Vec<Case> {
    vec![
        larger("the original program", Settings::INRIA, false),
        larger("KHR_gaussian_splatting", Settings::KHR, true),
        larger("Mip-Splatting", Settings::MIP, false),
    ]
}

/// Some scenes of the suite, and the larger ones.
pub(super) fn some() -> Vec<Case> {
    let mut all = suite(|name| SOME.contains(&name));
    assert_eq!(all.len(), SOME.len(), "the suite has them");
    all.extend(large());
    all
}
