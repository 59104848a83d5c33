//! Scenes for the reconstruction with templates, drawn by lot: discs placed by their pixels.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::scene::{discs, lights, scene, straight, surfels, turned};
use glam::{Mat4, Vec3};
use splatref::scene::{Camera, Cloud, Projection, Scene};

pub(crate) const SIZES: [[u32; 2]; 7] =
    [[1, 1], [1, 7], [2, 2], [13, 9], [16, 16], [31, 33], [64, 48]];

/// A radius in pixels.
fn extent(dice: &mut Dice, kind: usize) -> f32 {
    match kind {
        // About a pixel, then a few, then many.
        0 => dice.within(0.25, 1.5),
        1 => dice.within(0.5, 7.0),
        2 => dice.within(4.0, 40.0),
        // Far below a pixel, and beyond every picture.
        3 => [1e-30, 1e-12, 1e-3, 0.1, 1.0][dice.below(5)],
        4 => [0.5, 3.0, 20.0, 300.0, 1e30][dice.below(5)],
        // Just where a centre changes its level.
        5 => [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 12.0, 14.0, 16.0][dice.below(12)],
        _ => extent_of_any_kind(dice),
    }
}

fn extent_of_any_kind(dice: &mut Dice) -> f32 {
    let kind = dice.below(6);
    extent(dice, kind)
}

/// A normal in view space.
fn normal(dice: &mut Dice, kind: usize) -> Vec3 {
    match kind {
        0 => Vec3::Z,
        // Edge-on in the picture, and nearly so.
        1 => [Vec3::X, Vec3::Y, Vec3::new(1.0, 0.0, 1e-4), Vec3::new(0.6, 0.8, -0.01), Vec3::Z]
            [dice.below(5)],
        2 => (dice.direction() + Vec3::Z * 2.0).normalize(),
        3 => [Vec3::Z, Vec3::NEG_Z, Vec3::new(0.0, 0.6, 0.8)][dice.below(3)],
        _ => dice.direction(),
    }
}

/// How depths differ: not at all, by little, within a disc's own radius, beyond it, by a lot; and a
/// few at the near plane and behind the camera.
fn depth(dice: &mut Dice, kind: usize, radius: f32) -> f32 {
    let by = dice.within(-1.0, 1.0);
    let radius = if radius < 0.5 { radius } else { 0.5 };
    match (dice.below(32), kind) {
        (0, _) => [0.0625, -4.0][dice.below(2)],
        (_, 0) => 4.0,
        (_, 1) => f32::from_bits(4.0_f32.to_bits() + dice.below(5) as u32),
        (_, 2) => 4.0 + by * 2.0 * radius,
        (_, 3) => 4.0 + by * 6.0 * radius,
        _ => 4.0 + 2.0 * by,
    }
}

/// View space to world space, of a point of the picture at a depth.
fn placed(camera: &Camera, [x, y]: [f32; 2], t: f32) -> Vec3 {
    let far = if camera.projection == Projection::Perspective { t } else { 1.0 };
    Vec3::new((x - camera.cx) / camera.fx * far, (camera.cy - y) / camera.fy * far, -t)
}

/// `count` discs by lot.
fn cloud(dice: &mut Dice, camera: &Camera, count: usize) -> Cloud {
    let [sizes, normals] = [dice.below(7), dice.below(5)];
    // In sheets before a turned camera rounding alone would say which disc is in front.
    let turned = camera.view_from_world != Mat4::IDENTITY;
    let depths = if turned { 2 + dice.below(3) } else { dice.below(5) };
    let world = camera.view_from_world.inverse();
    let [width, height] = [camera.width as f32, camera.height as f32];
    let (mut position, mut all_normals, mut radii): (Vec<Vec3>, Vec<_>, Vec<_>) =
        (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..count {
        let at = [dice.within(-0.5, width + 0.5), dice.within(-0.5, height + 0.5)];
        let pixels = extent(dice, sizes);
        let t = depth(dice, depths, pixels * 4.0 / camera.fx);
        let far = if camera.projection == Projection::Perspective { t } else { 1.0 };
        let again = (dice.below(8) == 0).then(|| position.last().copied()).flatten();
        position.push(again.unwrap_or_else(|| world.transform_point3(placed(camera, at, t))));
        all_normals.push(world.transform_vector3(normal(dice, normals)).normalize());
        radii.push(pixels * far / (camera.fx * camera.fy).sqrt());
    }
    let color = (dice.below(3) > 0)
        .then(|| (0..count).map(|_| dice.vector(Vec3::ZERO, Vec3::ONE)).collect());
    Cloud { position, normal: Some(all_normals), radius: Some(radii), color, ..Cloud::default() }
}

/// A disc of which all numbers are those of the picture: before [`exact_camera`], at a place in
/// pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dot {
    pub(crate) place: [f32; 2],
    pub(crate) depth: f32,
    /// In pixels and in world units.
    pub(crate) radius: f32,
    pub(crate) normal: Vec3,
    pub(crate) color: Vec3,
}

impl Dot {
    /// White, facing the camera at depth 4.
    pub(crate) fn new(x: f32, y: f32, radius: f32) -> Self {
        Self { place: [x, y], depth: 4.0, radius, normal: Vec3::Z, color: Vec3::ONE }
    }

    pub(crate) fn at_depth(self, depth: f32) -> Self {
        Self { depth, ..self }
    }
}

/// Orthographic, a pixel a unit: a disc at (x, -y) has its centre at (x, y) in the picture.
pub(crate) fn exact_camera([width, height]: [u32; 2]) -> Camera {
    let mut camera = straight(true, [width, height]);
    (camera.fx, camera.fy, camera.cx, camera.cy) = (1.0, 1.0, 0.0, 0.0);
    camera
}

/// Discs before [`exact_camera`], coloured, unlit.
pub(crate) fn exact_scene(all: &[Dot]) -> Scene {
    let place = |d: &Dot| Vec3::new(d.place[0], -d.place[1], -d.depth);
    let cloud = discs(all.iter().map(|d| (place(d), d.normal, d.radius)));
    let surfels = surfels(Cloud { color: Some(all.iter().map(|d| d.color).collect()), ..cloud });
    assert_eq!(surfels.len(), all.len(), "no disc is dropped");
    scene(surfels)
}

/// The case of a number: every size, few and many discs, both cameras, turned or not.
pub(crate) fn case(number: usize) -> Case<()> {
    let mut dice = Dice(number as u64 * 7919 + 11);
    dice.below(1);
    let size = SIZES[number % SIZES.len()];
    let orthographic = number / SIZES.len() % 2 == 1;
    let mut camera = straight(orthographic, size);
    if dice.below(2) == 0 {
        camera.view_from_world = turned(&mut dice);
    }
    let pixels = (size[0] * size[1]) as usize;
    let many = [pixels / 4, pixels / 2, pixels][dice.below(3)] + 3;
    let count = [1, 3, 12, 40, many, many][dice.below(6)];
    let surfels = surfels(cloud(&mut dice, &camera, count));
    let scene = Scene { lights: lights(&mut dice), ..scene(surfels) };
    let name = format!("number {number}, {count} discs, orthographic {orthographic}");
    Case { name, scene, camera, settings: (), groups: None, exact: false }
}
