//! Scenes of discs, drawn by lot: placed by their pixels, of few pixels or many, tilted or not.

use crate::oracle::kit::case::Case;
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::scene::{discs, lights, scene, straight, surfels, turned};
use glam::Vec3;
use splatref::method::blue::Settings;
use splatref::scene::{Cloud, Primitives, Projection, Sides, Triangles, Vertices};

pub(crate) const SIZES: [[u32; 2]; 6] = [[1, 1], [1, 7], [13, 9], [16, 16], [33, 31], [64, 48]];

/// A radius in pixels.
fn extent(dice: &mut Dice, kind: usize) -> f32 {
    match kind {
        0 => dice.within(0.25, 1.5),
        1 => dice.within(0.5, 7.0),
        2 => dice.within(4.0, 40.0),
        3 => [1e-12, 0.1, 1.0, 30.0, 1e20][dice.below(5)],
        _ => [0.5, 1.0, 1.5, 2.0, 4.0][dice.below(5)],
    }
}

fn normal(dice: &mut Dice, kind: usize) -> Vec3 {
    match kind {
        0 => Vec3::Z,
        1 => [Vec3::X, Vec3::Y, Vec3::new(0.6, 0.8, -0.01), Vec3::Z, Vec3::NEG_Z][dice.below(5)],
        2 => (dice.direction() + Vec3::Z * 2.0).normalize(),
        _ => dice.direction(),
    }
}

/// The side of the square of each surfel, or none.
fn sides(dice: &mut Dice, count: usize) -> Option<Sides> {
    let side = |dice: &mut Dice| match dice.below(5) {
        0 => None,
        1 => Some([0.25, 1.0, 2.0, 3.0, 1e30][dice.below(5)]),
        2 => Some(dice.within(8.0, 60.0)),
        _ => Some(dice.within(0.5, 8.0)),
    };
    let runs = match dice.below(3) {
        0 => return None,
        1 => vec![(0, side(dice))],
        _ => (0..count as u32).step_by(3).map(|first| (first, side(dice))).collect(),
    };
    Sides::new(runs).ok()
}

/// Triangles among the discs.
fn triangles(dice: &mut Dice, count: usize) -> Primitives {
    let corners = 3 * count;
    let vertices = Vertices {
        position: (0..corners)
            .map(|_| dice.vector(Vec3::new(-3.0, -3.0, -7.0), Vec3::new(3.0, 3.0, -2.0)))
            .collect(),
        direction: (0..corners).map(|_| dice.direction()).collect(),
        radius: vec![0.0; corners],
        color: (dice.below(2) == 0)
            .then(|| (0..corners).map(|_| dice.vector(Vec3::ZERO, Vec3::ONE)).collect()),
        ..Vertices::default()
    };
    let all = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let triangles = Triangles::new(vertices, all).expect("triangles").0;
    Primitives { triangles, ..Primitives::default() }
}

/// A case by lot; half of them with triangles.
pub(crate) fn case(seed: u64) -> Case<Settings> {
    let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + 1);
    let orthographic = dice.below(2) == 0;
    let mut camera = straight(orthographic, SIZES[dice.below(SIZES.len())]);
    if dice.below(2) == 0 {
        camera.view_from_world = turned(&mut dice);
    }
    let world = camera.view_from_world.inverse();
    let [sizes, normals, count] = [dice.below(5), dice.below(4), 1 + dice.below(80)];
    let (mut all, mut colors) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let [width, height] = [camera.width as f32, camera.height as f32];
        let at = [dice.within(-2.0, width + 2.0), dice.within(-2.0, height + 2.0)];
        let t = match dice.below(16) {
            0 => [0.0625, -4.0, 0.07][dice.below(3)],
            1 | 2 => 4.0,
            _ => dice.within(2.0, 6.0),
        };
        let far = if camera.projection == Projection::Perspective { t } else { 1.0 };
        let p = Vec3::new(
            (at[0] - camera.cx) / camera.fx * far,
            (camera.cy - at[1]) / camera.fy * far,
            -t,
        );
        let radius = extent(&mut dice, sizes) * far.abs() / camera.fx;
        let n = normal(&mut dice, normals);
        all.push((world.transform_point3(p), world.transform_vector3(n).normalize(), radius));
        colors.push(dice.vector(Vec3::ZERO, Vec3::ONE));
    }
    let colored = dice.below(2) == 0;
    let cloud = Cloud { color: colored.then_some(colors), ..discs(all) };
    let mut scene = scene(surfels(cloud));
    scene.sides = sides(&mut dice, count);
    scene.lights = lights(&mut dice);
    if dice.below(2) == 0 {
        let count = 1 + dice.below(4);
        scene.primitives = triangles(&mut dice, count);
    }
    let settings = Settings { cull: dice.below(2) == 0 };
    Case { name: format!("discs {seed}"), scene, camera, settings, groups: None, exact: false }
}
