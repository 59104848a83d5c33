//! Builders of scenes and cameras.

use crate::oracle::kit::dice::Dice;
use glam::{DVec3, Mat4, Vec3};
use splatref::scene::{Camera, Cloud, Groups, Lens, Light, Pose, Scene, Surfels};
use splatref::source::Shape;
use splatref::splat::Outline;

pub(crate) const OUTLINES: [Outline; 3] = [Outline::Affine, Outline::Perspective, Outline::RayCast];

/// At the origin, looking along -z.
pub(crate) const AHEAD: Pose = Pose { eye: DVec3::ZERO, target: DVec3::NEG_Z, up: DVec3::Y };

/// Unlit, of the default material.
pub(crate) fn scene(surfels: Surfels) -> Scene {
    Scene::unlit("", surfels)
}

/// The surfels of a cloud that are any, none of no points.
pub(crate) fn surfels(cloud: Cloud) -> Surfels {
    if cloud.position.is_empty() {
        return Surfels::none();
    }
    Surfels::new(cloud).expect("good surfels").0
}

/// Discs without colours, each a position, a normal and a radius.
pub(crate) fn discs(all: impl IntoIterator<Item = (Vec3, Vec3, f32)>) -> Cloud {
    let (mut position, mut normal, mut radius) = (Vec::new(), Vec::new(), Vec::new());
    for (p, n, r) in all {
        position.push(p);
        normal.push(n);
        radius.push(r);
    }
    Cloud { position, normal: Some(normal), radius: Some(radius), ..Cloud::default() }
}

/// Changes the surfels of a scene.
pub(crate) fn change(scene: &mut Scene, change: impl FnOnce(&mut Cloud)) {
    let mut cloud = std::mem::replace(&mut scene.surfels, Surfels::none()).into_cloud();
    change(&mut cloud);
    scene.surfels = surfels(cloud);
}

/// Groups without any extension.
pub(crate) fn groups(own: Vec<u8>, count: usize) -> Groups {
    Groups::new(own, Vec::new(), vec![1.0; count]).expect("groups below the count")
}

/// None to three lights, one of each kind.
pub(crate) fn lights(dice: &mut Dice) -> Vec<Light> {
    let color = dice.vector(Vec3::splat(0.25), Vec3::ONE);
    let all = [
        Light::Headlight { towards: Vec3::new(0.25, 0.5, 1.0), color },
        Light::Directional { towards: Vec3::new(-1.0, 2.0, 3.0), color },
        Light::Point { position: Vec3::new(2.0, 3.0, 4.0), color },
    ];
    all[..dice.below(4)].to_vec()
}

/// A camera that looks along -z from the origin: its view matrix is the identity.
pub(crate) fn ahead(lens: Lens, [width, height]: [u32; 2]) -> Camera {
    let mut camera = Camera::new(width, height, AHEAD, lens).expect("a plain camera");
    camera.view_from_world = Mat4::IDENTITY;
    camera
}

/// As [`ahead`], of either kind, with a near plane exact in few digits.
pub(crate) fn near(orthographic: bool, size: [u32; 2]) -> Camera {
    let lens = if orthographic { Lens::Orthographic(6.0) } else { Lens::Focal(28.0) };
    let mut camera = ahead(lens, size);
    camera.near = 0.0625;
    camera
}

/// As [`near`], with pixels that are not square and a principal point off the middle.
pub(crate) fn straight(orthographic: bool, size: [u32; 2]) -> Camera {
    let mut camera = near(orthographic, size);
    camera.fx *= 1.125;
    camera.cx += 1.25;
    camera
}

/// The camera of a shape, orthographic on demand.
pub(crate) fn framed(shape: &Shape, orthographic: bool, [width, height]: [u32; 2]) -> Camera {
    let lens = if orthographic { Lens::Orthographic(2.5) } else { shape.default_lens() };
    Camera::new(width, height, shape.default_pose(), lens).expect("the camera of a shape")
}

/// A view that is turned about two axes.
pub(crate) fn turned(dice: &mut Dice) -> Mat4 {
    Mat4::from_rotation_x(0.1) * Mat4::from_rotation_z(dice.within(-3.0, 3.0))
}
