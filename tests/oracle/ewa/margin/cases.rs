//! Scenes for the margin: those of the method, and two made for the rules that those never need.

use crate::oracle::ewa::cases::{KINDS, case};
use crate::oracle::kit::case::Case;
use crate::oracle::kit::goldens;
use crate::oracle::kit::scene::{discs, near, scene, straight, surfels};
use glam::{Mat4, Vec3};
use splatref::method::ewa::Settings;
use splatref::scene::{Camera, Cloud};
use splatref::splat::{Epsilon, Kernel, Outline};

pub(crate) fn all() -> Vec<Case<Settings>> {
    let mut cases = drawn();
    cases.push(thin());
    for ortho in [false, true] {
        cases.extend([false, true].map(|cull| doubtful(ortho, cull)));
    }
    cases
}

fn made(name: &str, cloud: Cloud, camera: Camera, settings: Settings) -> Case<Settings> {
    let (name, scene) = (format!("{name} {settings:?}"), scene(surfels(cloud)));
    Case { name, scene, camera, settings, groups: None, exact: false }
}

/// An ellipse so thin that the ball of q is never certain along it: its bounds must be. It lies
/// along a diagonal of pixel centres.
fn thin() -> Case<Settings> {
    let (u, v) = (Vec3::new(0.375, 0.375, 0.0), Vec3::new(-0.375, 0.375, 0.0));
    let tangents = vec![[u, v / (1_u32 << 20) as f32]];
    let cloud = discs([(Vec3::new(0.125, 0.125, -4.0), Vec3::Z, 0.5)]);
    let kernel = Kernel { cutoff: 2.1, low_pass: 0.0, ..Kernel::DEFAULT };
    let settings = Settings { kernel, epsilon: Epsilon::World(0.0), cull: false };
    let cloud = Cloud { tangents: Some(tangents), ..cloud };
    made("thin", cloud, near(true, [32, 24]), settings)
}

/// Discs of which it is not certain that they are drawn: edge-on to a rounding, and a last one at
/// the near plane to a rounding.
fn doubtful(ortho: bool, cull: bool) -> Case<Settings> {
    let mut camera = straight(ortho, [40, 24]);
    camera.view_from_world = Mat4::from_rotation_x(0.1);
    let there = camera.view_from_world.inverse();
    let ray = |p: Vec3| if ortho { Vec3::Z } else { p };
    let across = |p: Vec3, side: Vec3| ray(p).cross(side).normalize();
    let mut all: Vec<_> = (0_u8..6)
        .map(|i| {
            let p = Vec3::new(f32::from(i) * 0.7 - 1.9, 1.3 - f32::from(i) * 0.45, -3.1);
            (p, across(p, Vec3::new(0.3, 1.0, f32::from(i) * 0.1)), 0.4)
        })
        .collect();
    all.push((Vec3::new(-0.3, 0.2, -2.3), Vec3::new(0.6, 0.0, 0.8), 0.3));
    let world = |v: Vec3| there.transform_vector3(v);
    let cloud = discs(all.iter().map(|(p, n, r)| (world(*p), world(*n), *r)));
    // The depth in f64, where it is exact to a few digits more.
    let row = camera.view_from_world.row(2).as_dvec4();
    camera.near = -row.truncate().dot(cloud.position[6].as_dvec3()) as f32;
    made("doubtful", cloud, camera, Settings { cull, ..Settings::default() })
}

/// The goldens of the affine outline, and of each kind a scene before each camera: with and without
/// culling, with kernels of few digits and of many, and with a near plane that surfels reach.
fn drawn() -> Vec<Case<Settings>> {
    let mut cases: Vec<Case<Settings>> = goldens::of();
    cases.retain(|case| case.settings.kernel.outline == Outline::Affine);
    let odd = Kernel { cutoff: 1.1, low_pass: 0.3, ..Kernel::DEFAULT };
    let bare = Kernel { low_pass: 0.0, ..Kernel::DEFAULT };
    let kernels = [Kernel::DEFAULT, odd, Kernel::ZPVBG01, bare, Kernel::DEFAULT];
    let bands = [
        Epsilon::MedianRadii(1.0),
        Epsilon::World(0.0),
        Epsilon::World(0.125),
        Epsilon::World(f32::INFINITY),
    ];
    for (i, kind) in KINDS.into_iter().enumerate() {
        for ortho in [false, true] {
            let (kernel, epsilon) = (kernels[i % 5], bands[i % 4]);
            let settings = Settings { kernel, epsilon, cull: (i % 2 == 0) == ortho };
            let mut case = case(kind, 900 + i as u64, settings, ortho);
            if i % 3 == 0 {
                case.camera.near = 3.7;
            }
            cases.push(case);
        }
    }
    cases
}
