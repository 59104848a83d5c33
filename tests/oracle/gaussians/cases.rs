//! Scenes of Gaussians, cameras and settings.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::scene;
use glam::{DVec3, Vec3};
use splatref::frame::Plane;
use splatref::method::gaussians::{BlendSpace, ColorBounds, Order, Settings, Support};
use splatref::scene::environment::Map;
use splatref::scene::gaussians::{Encoding, coefficients};
use splatref::scene::{
    Camera, Environment, GaussianArrays, Gaussians, Lens, Pose, Scene, Surface, Surfels,
};
use splatref::splat::gaussian::{Clamp, Compensation, GaussianKernel};
use splatref::splat::ray_disc::DiscRule;

/// The presets, and the paper's rule of discs.
pub(crate) const PRESETS: [(&str, Settings); 7] = [
    ("khr", Settings::KHR),
    ("inria", Settings::INRIA),
    ("gsplat", Settings::GSPLAT),
    ("mip", Settings::MIP),
    ("exact", Settings::EXACT),
    ("2dgs", Settings::DISCS),
    ("rays", RAYS),
];

/// Discs as the paper draws them.
pub(crate) const RAYS: Settings = Settings {
    kernel: GaussianKernel { disc: DiscRule::Ray, ..Settings::DISCS.kernel },
    ..Settings::DISCS
};

/// A quaternion of any direction; the constructor makes it a unit.
pub(crate) fn rotation(dice: &mut Dice) -> [f32; 4] {
    loop {
        let q = [(); 4].map(|()| dice.within(-1.0, 1.0));
        let square: f32 = q.iter().map(|part| part * part).sum();
        if square > 0.125 && square < 1.0 {
            return q;
        }
    }
}

/// A scale between two powers of two.
fn scale(dice: &mut Dice, low: f32, high: f32) -> f32 {
    f64::from(dice.within(low, high)).exp2() as f32
}

/// Random Gaussians about the origin, needles and flakes among them.
pub(crate) fn arrays(n: usize, degree: u32, seed: u64) -> GaussianArrays {
    let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9).wrapping_add(degree.into()));
    let mut arrays = GaussianArrays { degree, ..GaussianArrays::default() };
    for i in 0..n {
        arrays.position.push(dice.vector(Vec3::splat(-1.25), Vec3::splat(1.25)));
        let axis = [(); 3].map(|()| scale(&mut dice, -6.0, -1.0));
        arrays.scale.push(Vec3::from_array(axis));
        arrays.rotation.push(rotation(&mut dice));
        arrays.opacity.push([dice.within(0.0, 1.0), dice.within(0.25, 1.0)][i % 2]);
        for j in 0..coefficients(degree) {
            let most = if j == 0 { 2.0 } else { 0.75 };
            arrays.harmonics.push(dice.vector(Vec3::splat(-most), Vec3::splat(most)));
        }
    }
    arrays
}

pub(crate) fn scene_of(arrays: GaussianArrays) -> Scene {
    Scene::of_gaussians("", Gaussians::new(arrays).expect("good Gaussians").0)
}

pub(crate) fn random(n: usize, degree: u32, encoding: Encoding, seed: u64) -> Scene {
    scene_of(GaussianArrays { encoding, ..arrays(n, degree, seed) })
}

/// A camera that looks at the origin from nowhere special, with fx unlike fy and the principal
/// point off the middle.
pub(crate) fn camera(orthographic: bool, [width, height]: [u32; 2]) -> Camera {
    let pose = Pose {
        eye: DVec3::new(1.5, -0.75, 3.0),
        target: DVec3::new(0.125, 0.0625, 0.0),
        up: DVec3::new(0.25, 1.0, 0.125),
    };
    let size = f64::from(height);
    let lens = if orthographic { Lens::Orthographic(2.5) } else { Lens::Focal(1.25 * size) };
    let mut camera = Camera::new(width, height, pose, lens).expect("a plain camera");
    camera.fx *= 1.125;
    camera.cx += 1.25;
    camera.cy -= 0.625;
    camera
}

fn case(
    name: impl Into<String>,
    scene: Scene,
    camera: Camera,
    settings: Settings,
) -> Case<Settings> {
    Case { name: name.into(), scene, camera, settings, groups: None, exact: false }
}

/// Discs, or ellipses by their tangents.
pub(crate) fn surfels(n: usize, ellipses: bool, seed: u64) -> Scene {
    let mut dice = Dice(seed);
    let discs = (0..n).map(|_| {
        let at = dice.vector(Vec3::splat(-1.0), Vec3::ONE);
        let normal = dice.direction();
        (at, normal, scale(&mut dice, -4.0, 0.0))
    });
    let mut cloud = scene::discs(discs.collect::<Vec<_>>());
    cloud.color = Some((0..n).map(|_| dice.vector(Vec3::ZERO, Vec3::splat(1.5))).collect());
    cloud.opacity = Some((0..n).map(|_| dice.within(0.0, 1.0)).collect());
    if ellipses {
        let normals = cloud.normal.as_ref().expect("normals");
        let across = normals.iter().map(|n| {
            let u = n.any_orthonormal_vector();
            [u * scale(&mut dice, -3.0, 0.0), n.cross(u) * scale(&mut dice, -3.0, 0.0)]
        });
        cloud.tangents = Some(across.collect());
    }
    Scene::unlit("", Surfels::new(cloud).expect("good surfels").0)
}

/// A map of few colours that differ from pixel to pixel.
fn surrounded(scene: Scene) -> Scene {
    let mut dice = Dice(77);
    let colors = (0..32).map(|_| [(); 3].map(|()| dice.within(0.0, 1.5)));
    let map = Map::new(Plane::from_values(8, 4, colors.collect())).expect("a map");
    Scene { environment: Some(Environment::Map(map)), ..scene }
}

const SIZE: [u32; 2] = [33, 17];

/// Every preset, every degree, both encodings, both cameras.
fn by_preset() -> Vec<Case<Settings>> {
    let mut all = Vec::new();
    for (p, (name, settings)) in PRESETS.into_iter().enumerate() {
        for degree in 0..4 {
            let encoding = [Encoding::Srgb, Encoding::Linear][(degree as usize + p) % 2];
            let orthographic = (degree as usize + p) % 3 == 2;
            let scene = random(40, degree, encoding, 100 + p as u64);
            let what = format!("{name}, degree {degree}, {encoding:?}");
            all.push(case(what, scene, camera(orthographic, SIZE), settings));
        }
        let around = surrounded(random(12, 1, Encoding::Srgb, 7));
        all.push(case(format!("{name} in a room"), around, camera(false, SIZE), settings));
        for ellipses in [false, true] {
            let scene = surfels(24, ellipses, 5 + p as u64);
            let what = format!("{name}, surfels, ellipses: {ellipses}");
            all.push(case(what, scene, camera(ellipses && p == 1, SIZE), settings));
        }
    }
    all
}

/// A name, and what it changes.
type Change = (&'static str, fn(&mut Settings));

/// Every setting at another value.
const CHANGES: &[Change] = &[
    ("near_depth 3", |s| s.kernel.near = 3.0),
    ("clamp none", |s| s.kernel.clamp = Clamp::None),
    ("clamp fov", |s| s.kernel.clamp = Clamp::Fov),
    ("clamp edges", |s| s.kernel.clamp = Clamp::Edges),
    ("low_pass 0", |s| s.kernel.low_pass = 0.0),
    ("low_pass 2.5", |s| s.kernel.low_pass = 2.5),
    ("compensation ratio", |s| s.kernel.compensation = Compensation::Ratio),
    ("compensation floor", |s| s.kernel.compensation = Compensation::Floor),
    ("compensation mip", |s| s.kernel.compensation = Compensation::Mip),
    ("degree 0", |s| s.degree = 0),
    ("degree 2", |s| s.degree = 2),
    ("bounds none", |s| s.bounds = ColorBounds::None),
    ("bounds unit", |s| s.bounds = ColorBounds::Unit),
    ("order distance", |s| s.order = Order::Distance),
    ("order steps", |s| s.order = Order::Steps),
    ("order pixel", |s| s.order = Order::Pixel),
    ("support none", |s| (s.support, s.least_alpha) = (Support::None, 0.01)),
    ("support ellipse", |s| s.support = Support::Ellipse),
    ("support tiles", |s| s.support = Support::Tiles),
    ("support boxes", |s| s.support = Support::Boxes),
    ("cutoff 1.5", |s| s.cutoff = 1.5),
    ("least_alpha 0", |s| (s.least_alpha, s.support) = (0.0, Support::Tiles)),
    ("least_alpha 0.125", |s| s.least_alpha = 0.125),
    ("most_alpha 0.5", |s| s.most_alpha = 0.5),
    ("stop 0.25", |s| s.stop = 0.25),
    ("stop_at", |s| (s.stop, s.stop_at) = (0.5, true)),
    ("blend stored", |s| s.blend = BlendSpace::Stored),
    ("blend linear", |s| s.blend = BlendSpace::Linear),
    ("blend srgb", |s| s.blend = BlendSpace::Srgb),
];

fn by_setting() -> Vec<Case<Settings>> {
    let mut all = Vec::new();
    for (i, (name, change)) in CHANGES.iter().enumerate() {
        for (p, (preset, settings)) in [PRESETS[1], PRESETS[2], PRESETS[4]].into_iter().enumerate()
        {
            let mut settings = settings;
            change(&mut settings);
            let encoding = [Encoding::Srgb, Encoding::Linear][(i + p) % 2];
            let scene = random(30, 3, encoding, 31 * i as u64 + p as u64);
            let scene = if i % 3 == 0 { surrounded(scene) } else { scene };
            let what = format!("{preset} with {name}");
            all.push(case(what, scene, camera(i % 5 == 4, SIZE), settings));
        }
    }
    all
}

/// Scenes at the limits of the rules.
fn limits() -> Vec<Case<Settings>> {
    let mut all = Vec::new();
    for (name, settings) in PRESETS {
        let mut add = |what: &str, arrays: GaussianArrays, camera: Camera| {
            all.push(case(format!("{name}, {what}"), scene_of(arrays), camera, settings));
        };
        let mut inside = camera(false, SIZE);
        inside.view_from_world.w_axis = Vec3::new(0.125, -0.0625, -0.25).extend(1.0);
        inside.near = 0.0625;
        add("from the midst", arrays(60, 1, 21), inside);
        let mut huge = arrays(12, 2, 22);
        huge.scale.iter_mut().for_each(|s| *s *= 32.0);
        add("huge", huge.clone(), camera(false, SIZE));
        add("huge from afar", huge, camera(true, [50, 40]));
        let mut opaque = arrays(30, 0, 23);
        opaque.opacity.iter_mut().enumerate().for_each(|(i, o)| *o = [0.0, 1.0, 0.5][i % 3]);
        add("opacities 0 and 1", opaque.clone(), camera(false, SIZE));
        add("one pixel", opaque, camera(false, [1, 1]));
        let mut tied = arrays(24, 1, 24);
        tied.position = (0..24).map(|i| [Vec3::ZERO, Vec3::X, Vec3::Y / 2.0][i % 3]).collect();
        add("ties", tied, camera(false, SIZE));
        let mut behind = arrays(5, 0, 25);
        behind.position.iter_mut().for_each(|p| *p += Vec3::new(15.0, -7.5, 30.0));
        add("all behind", behind, camera(false, SIZE));
        let mut flat = arrays(30, 1, 26);
        flat.scale.iter_mut().enumerate().for_each(|(i, s)| s[i % 3] = 0.0);
        add("flat", flat.clone(), camera(false, SIZE));
        flat.scale.iter_mut().enumerate().for_each(|(i, s)| s[(i + 1) % 3] = 0.0);
        add("needles", flat.clone(), camera(true, SIZE));
        flat.scale.fill(Vec3::ZERO);
        add("points", flat, camera(false, SIZE));
        let mut far = arrays(30, 1, 27);
        far.position.iter_mut().for_each(|p| *p *= Vec3::new(6.0, 6.0, 1.0));
        far.scale.iter_mut().for_each(|s| *s *= 4.0);
        add("beside the picture", far, camera(false, SIZE));
    }
    all.push(steps());
    all.push(hidden(false));
    all.push(hidden(true));
    let mut plain = surfels(9, false, 61);
    scene::change(&mut plain, |cloud| cloud.color = None);
    all.push(case("surfels without colours", plain, camera(false, SIZE), Settings::KHR));
    let compensated = |compensation| {
        let mut settings = Settings::GSPLAT;
        (settings.kernel.compensation, settings.kernel.low_pass) = (compensation, 1.5);
        let scene = random(40, 1, Encoding::Srgb, 62);
        case("compensated boxes", scene, camera(false, SIZE), settings)
    };
    all.extend([Compensation::Ratio, Compensation::Floor, Compensation::Mip].map(compensated));
    all
}

/// Splats closer together than a step of the quantized order, against the order of their indices.
fn steps() -> Case<Settings> {
    let mut arrays = arrays(33, 0, 28);
    for (i, p) in arrays.position.iter_mut().enumerate() {
        *p = Vec3::new(0.0, 0.0, if i == 0 { -4.0 } else { i as f32 / 65_536.0 });
    }
    arrays.scale.fill(Vec3::splat(0.25));
    let camera = scene::straight(false, SIZE);
    let mut camera = Camera { near: 0.0625, ..camera };
    camera.view_from_world.w_axis.z = -2.0;
    let settings = Settings { order: Order::Steps, ..Settings::GSPLAT };
    case("steps", scene_of(arrays), camera, settings)
}

/// A splat that hides at one pixel, to the last bit, what is behind it.
fn hidden(stop_at: bool) -> Case<Settings> {
    let mut arrays = arrays(8, 0, 29);
    for (i, p) in arrays.position.iter_mut().enumerate() {
        *p = Vec3::new(0.0, 0.0, -2.0 - i as f32);
    }
    arrays.opacity[3] = 1.0;
    let settings = Settings { stop_at, ..Settings::KHR };
    case(
        format!("hidden, stop_at: {stop_at}"),
        scene_of(arrays),
        scene::near(false, SIZE),
        settings,
    )
}

/// Every rule of discs with every setting that it reads, of Gaussians and of surfels.
fn discs() -> Vec<Case<Settings>> {
    let others: [Change; 8] = [
        ("nothing", |_| ()),
        ("low_pass 0", |s| s.kernel.low_pass = 0.0),
        ("low_pass 2.5", |s| s.kernel.low_pass = 2.5),
        ("order pixel", |s| s.order = Order::Pixel),
        ("support none", |s| s.support = Support::None),
        ("support ellipse", |s| s.support = Support::Ellipse),
        ("support boxes", |s| s.support = Support::Boxes),
        ("near_depth 3", |s| s.kernel.near = 3.0),
    ];
    let mut all = Vec::new();
    for (i, (name, change)) in others.into_iter().enumerate() {
        for disc in [DiscRule::Ray, DiscRule::RayBox] {
            let mut settings = Settings::DISCS;
            settings.kernel.disc = disc;
            change(&mut settings);
            let scene = match i % 3 {
                0 => random(30, 1, Encoding::Srgb, 400 + i as u64),
                which => surfels(24, which == 1, 400 + i as u64),
            };
            let camera = camera(i % 4 == 1, SIZE);
            all.push(case(format!("{disc:?} with {name}"), scene, camera, settings));
        }
    }
    all
}

/// Depths about those of the splats, and nothing opaque in a third of the pixels.
pub(crate) fn opaque([width, height]: [u32; 2], seed: u64) -> Surface {
    let (mut dice, count) = (Dice(seed), (width * height) as usize);
    let mut depth = || if dice.below(3) == 0 { f32::INFINITY } else { dice.within(1.5, 5.5) };
    let depths = (0..count).map(|_| depth()).collect();
    let colors = (0..count).map(|_| [(); 3].map(|()| dice.within(0.0, 1.5))).collect();
    let depths = Plane::from_values(width, height, depths);
    Surface::new(depths, Plane::from_values(width, height, colors)).expect("a surface")
}

/// Every preset, every order and every space of blending, mixed with a surface.
fn mixed() -> Vec<Case<Settings>> {
    let mut all = Vec::new();
    for (p, (name, preset)) in PRESETS.into_iter().enumerate() {
        let seed = 500 + 4 * p as u64;
        let others = [
            preset,
            Settings { order: Order::Steps, stop: 0.25, ..preset },
            Settings { order: Order::Pixel, blend: BlendSpace::Linear, ..preset },
            Settings { order: Order::Distance, blend: BlendSpace::Srgb, ..preset },
        ];
        for (settings, seed) in others.into_iter().zip(seed..) {
            let scene = match seed % 4 {
                1 => surfels(24, true, seed),
                2 => surrounded(random(30, 1, Encoding::Linear, seed)),
                _ => random(40, 1, Encoding::Srgb, seed),
            };
            let scene = Scene { surface: Some(opaque(SIZE, seed)), ..scene };
            let what = format!("{name}, {:?}, {:?}, a surface", settings.order, settings.blend);
            all.push(case(what, scene, camera(p % 3 == 1, SIZE), settings));
        }
    }
    all
}

pub(crate) fn all() -> Vec<Case<Settings>> {
    let mut all = by_preset();
    all.extend(mixed());
    all.extend(discs());
    all.extend(by_setting());
    all.extend(limits());
    all
}
