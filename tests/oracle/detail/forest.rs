//! Scenes of objects with prefixes, of which some are finer ones of others, by lot.

use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::scene::surfels;
use crate::oracle::sampler::cases::mesh;
use glam::{DVec3, Vec3};
use splatref::scene::camera::stereo::Eye;
use splatref::scene::objects::detail::prefix::Estimate;
use splatref::scene::objects::detail::refine::Refinement;
use splatref::scene::transform::rotation;
use splatref::scene::{
    Camera, Cloud, Geometry, Lens, Motion, Object, Objects, Pose, Primitives, Similarity, Stereo,
    Surfels, Triangles,
};

/// Objects that are still to be asked for something, and a camera.
pub(crate) struct Forest {
    pub(crate) objects: Objects,
    pub(crate) camera: Camera,
}

fn points(dice: &mut Dice, count: usize) -> Surfels {
    let reach = dice.vector(Vec3::ZERO, Vec3::splat(2.0));
    let color = (dice.below(3) == 0)
        .then(|| (0..count).map(|_| dice.vector(Vec3::ZERO, Vec3::ONE)).collect());
    surfels(Cloud {
        position: (0..count).map(|_| dice.vector(-reach, reach)).collect(),
        normal: Some((0..count).map(|_| dice.direction()).collect()),
        radius: Some((0..count).map(|_| dice.within(0.01, 0.5)).collect()),
        color,
        ..Cloud::default()
    })
}

fn triangles(dice: &mut Dice, count: usize) -> Triangles {
    let corners = 3 * count;
    let reach = Vec3::splat(dice.within(0.25, 4.0));
    let position = (0..corners + 1).map(|_| dice.vector(-reach, reach)).collect();
    let normal = (0..corners + 1).map(|_| dice.direction()).collect();
    // The first vertex belongs to none.
    let all = (0..count as u32).map(|i| [3 * i + 1, 3 * i + 2, 3 * i + 3]).collect();
    mesh(position, normal, None, all)
}

/// Surfels in an order with primitives or without, or one of both alone.
fn geometry(dice: &mut Dice) -> Geometry {
    let name = String::new();
    let some = |dice: &mut Dice| {
        let count = 1 + dice.below(5);
        Primitives { triangles: triangles(dice, count), ..Primitives::default() }
    };
    let kind = dice.below(8);
    let primitives = if [0, 1, 2].contains(&kind) { some(dice) } else { Primitives::default() };
    let count = [1, 2, 7, 60, 300][dice.below(5)];
    let surfels = if kind == 0 { Surfels::none() } else { points(dice, count) };
    let geometry = Geometry { name, surfels, primitives, detail: None };
    if kind == 0 || kind == 3 {
        return geometry;
    }
    let distance = match dice.below(8) {
        0 => 0.0,
        1 => [1e-30, 1e20, 1e-38][dice.below(3)],
        _ => dice.within(0.02, 0.5),
    };
    let count = 1 + dice.below(count) as u32;
    geometry.with_prefix(Estimate { count, distance }).expect("an order")
}

fn place(dice: &mut Dice) -> Similarity {
    Similarity {
        rotation: rotation(dice.direction().as_dvec3(), f64::from(dice.within(0.0, 360.0))),
        scale: if dice.below(3) == 0 { 1.0 } else { f64::from(dice.within(0.25, 4.0)) },
        translation: dice.vector(Vec3::splat(-6.0), Vec3::splat(6.0)).as_dvec3(),
    }
}

/// Each of some objects is a finer one of another in a random order, or of none; only those with a
/// prefix or without surfels have finer ones.
fn coarser(dice: &mut Dice, geometries: &[Geometry], shown: &[usize]) -> Vec<Option<u32>> {
    let mut order: Vec<usize> = (0..shown.len()).collect();
    for i in (1..order.len()).rev() {
        order.swap(i, dice.below(i + 1));
    }
    let mut all = vec![None; shown.len()];
    let loose = dice.below(4);
    for (rank, &object) in order.iter().enumerate().skip(1) {
        let above = order[dice.below(rank)];
        let of = &geometries[shown[above]];
        if (of.detail.is_some() || of.surfels.is_empty()) && dice.below(4) >= loose {
            all[object] = Some(above as u32);
        }
    }
    all
}

fn camera(dice: &mut Dice) -> Camera {
    let eye = dice.vector(Vec3::splat(-8.0), Vec3::splat(8.0)).as_dvec3();
    let eye = eye * [1.0, 0.125, 8.0, 60.0][dice.below(4)];
    let target = dice.vector(Vec3::splat(-4.0), Vec3::splat(4.0)).as_dvec3();
    let pose = Pose { eye, target, up: DVec3::new(0.1, 1.0, 0.2) };
    let lens = match dice.below(3) {
        0 => Lens::Orthographic(f64::from(dice.within(2.0, 30.0))),
        1 => Lens::Focal(f64::from(dice.within(20.0, 500.0))),
        _ => Lens::FieldOfView(f64::from(dice.within(10.0, 120.0))),
    };
    let mut camera = Camera::new(64, 48, pose, lens).expect("a camera");
    if dice.below(2) == 0 {
        camera.fx *= dice.within(0.5, 2.0);
        camera.cx += dice.within(-10.0, 10.0);
        camera.near = dice.within(0.0625, 3.0);
    }
    // Last, so that the other cases stay as they are.
    if dice.below(3) == 0 {
        let distance = f64::from(dice.within(0.0625, 4.0));
        let eye = Some(Eye::BOTH[dice.below(2)]);
        camera = Stereo { distance, eye }.camera(camera).expect("an eye");
    }
    camera
}

pub(crate) fn forest(seed: u64) -> Forest {
    let mut dice = Dice(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + 3);
    let count = 1 + dice.below(5);
    let geometries: Vec<Geometry> = (0..count).map(|_| geometry(&mut dice)).collect();
    let count = 1 + dice.below(9);
    let shown: Vec<usize> = (0..count).map(|_| dice.below(geometries.len())).collect();
    let coarser = coarser(&mut dice, &geometries, &shown);
    let object = |geometry| {
        let keys = [(0, place(&mut dice)), (4, place(&mut dice))];
        let motion = Motion::new(keys[..1 + dice.below(2)].to_vec()).expect("keys");
        let color = (dice.below(3) == 0).then(|| dice.vector(Vec3::ZERO, Vec3::ONE));
        Object { name: String::new(), geometry, motion, color }
    };
    let all = shown.into_iter().map(object).collect();
    let objects = Objects::new(geometries, all, Vec3::splat(0.5)).expect("objects");
    let objects = objects.with_coarser(coarser).expect("a forest");
    let objects = objects.at(dice.below(6) as u32).expect("a frame");
    Forest { objects, camera: camera(&mut dice) }
}

/// Wishes of a view.
pub(crate) fn wishes(seed: u64) -> Refinement {
    let mut dice = Dice(seed ^ 0xABCD_EF01);
    let surfel_size = match dice.below(8) {
        0 => [1e-30, 4096.0, 1.0][dice.below(3)],
        _ => 2.0_f32.powi(dice.below(12) as i32 - 4) * dice.within(1.0, 2.0),
    };
    let budget = [None, Some(dice.below(30) as u32 + 1), Some(dice.below(1000) as u32 + 1)];
    let mut at = [0, 1, 2, 3].map(|_| dice.below(12) as f32 * 10.0);
    at.sort_by(f32::total_cmp);
    let zones = at.map(|d| [d, dice.within(0.25, 8.0)])[..dice.below(5)].to_vec();
    Refinement { surfel_size, budget: budget[dice.below(3)], zones }
}
