//! Scenes whose geometries have levels of detail, some of them, before a camera that goes far.

use crate::oracle::deferred::cases::{Sequence, geometry, settings};
use crate::oracle::deferred::ids::Numbers;
use crate::oracle::deferred::laws::all as all_numbers;
use crate::oracle::deferred::place::{Thing, World, similarity};
use crate::oracle::deferred::view::{self, View};
use crate::oracle::kit::dice::Dice;
use crate::oracle::kit::scene::{change, lights, scene, straight, surfels};
use glam::{Mat4, Vec3};
use splatref::frame::Exec;
use splatref::scene::indexed::Indexed;
use splatref::scene::objects::Ids;
use splatref::scene::{
    Camera, Geometry, Primitives, Scene, Similarity, Surfels, Triangles, Vertices,
};
use splatref::source::Shape;

/// A few triangles through surfels, with colours or without.
fn triangles(dice: &mut Dice, of: &Surfels, colored: bool) -> Triangles {
    let any = |dice: &mut Dice| of.position()[dice.below(of.len())];
    let mut vertices = Vertices::default();
    let corners: Vec<_> = (0..3 * (1 + dice.below(4)) as u32).collect();
    for _ in &corners {
        let near = dice.vector(Vec3::splat(-0.25), Vec3::splat(0.25));
        vertices.position.push(any(dice) + near);
        vertices.direction.push(dice.direction());
        vertices.radius.push(0.0);
        if colored {
            let color = dice.vector(Vec3::ZERO, Vec3::ONE);
            vertices.color.get_or_insert_default().push(color);
        }
    }
    let corners = corners.chunks(3).map(|c| [c[0], c[1], c[2]]).collect();
    Indexed::new(vertices, corners).expect("good triangles").0
}

/// What geometries have beside surfels.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Beside {
    Nothing,
    Triangles {
        colored: bool,
    },
    /// Colours of the triangles alone, or of the surfels alone.
    Alone {
        colored: bool,
    },
}

/// A geometry, of which every third has no levels of detail.
fn whole(dice: &mut Dice, number: usize, beside: Beside) -> Geometry {
    let mut surfels = if dice.below(2) == 0 {
        geometry(dice, false, false)
    } else {
        let seed = dice.bits();
        Shape::Sphere.surfels(60 + dice.below(240), seed).expect("surfels")
    };
    let name = format!("geometry {number}");
    let mut primitives = Primitives::default();
    if let Beside::Triangles { colored } | Beside::Alone { colored } = beside {
        primitives.triangles = triangles(dice, &surfels, colored);
    }
    if let Beside::Alone { colored } = beside {
        let color = vec![dice.vector(Vec3::ZERO, Vec3::ONE); surfels.len()];
        let mut one = scene(surfels);
        change(&mut one, |cloud| cloud.color = (!colored).then_some(color));
        surfels = one.surfels;
    }
    let geometry = Geometry { name, surfels, primitives, detail: None };
    if dice.below(3) == 0 {
        return geometry;
    }
    let threshold = [0.0, 0.5, 2.0, 2.0, 8.0][dice.below(5)];
    geometry.with_detail(threshold, &Exec::sequential()).expect("levels of detail")
}

/// Near or far, small or large; now and then beside the picture or behind the camera.
fn place(dice: &mut Dice, middle: Vec3) -> Similarity {
    let far = [2.0, 4.0, 12.0, 40.0][dice.below(4)];
    let mut to = dice.vector(Vec3::new(-0.5, -0.4, 0.0), Vec3::new(0.5, 0.4, 0.0)) * far;
    to.z = -far * dice.within(0.75, 1.25);
    match dice.below(8) {
        0 => to.x += 4.0 * far,
        1 => to.z = 3.0,
        _ => {}
    }
    let scale = [1.0, 1.0, 0.25, 3.0, f64::from(dice.within(0.1, 2.0))][dice.below(5)];
    let axis = dice.direction().as_dvec3();
    let turn = similarity(axis, dice.within(-180.0, 180.0).into(), scale, to.as_dvec3());
    let back = turn.rotation * middle.as_dvec3() * scale;
    Similarity { translation: turn.translation - back, ..turn }
}

/// At rest, or elsewhere in every frame: between keys libraries may differ.
fn keys(dice: &mut Dice, middle: Vec3) -> Vec<(u32, Similarity)> {
    let first = place(dice, middle);
    let step = |dice: &mut Dice| {
        let step = dice.vector(Vec3::splat(-0.75), Vec3::splat(0.75)).as_dvec3();
        let scale = first.scale * f64::from(dice.within(0.5, 1.5));
        Similarity { translation: first.translation + step, scale, ..first }
    };
    match dice.below(3) {
        0 => (0..6).map(|f| (f, step(dice))).collect(),
        1 => (0..6).map(|f| (f, place(dice, middle))).collect(),
        _ => vec![(0, first)],
    }
}

fn camera(dice: &mut Dice, still: Camera) -> Camera {
    let turn = Mat4::from_rotation_y(dice.within(-0.4, 0.4));
    let roll = Mat4::from_rotation_z(dice.within(-3.0, 3.0));
    let far = [0.0, 0.0, 3.0, 12.0][dice.below(4)];
    let step = Mat4::from_translation(Vec3::new(dice.within(-0.5, 0.5), 0.0, -far));
    Camera { view_from_world: roll * turn * step, ..still }
}

/// The middle of surfels.
fn middle(of: &Geometry) -> Vec3 {
    let all = of.surfels.position();
    all.iter().copied().sum::<Vec3>() / all.len() as f32
}

const SIZES: [[u32; 2]; 6] = [[1, 9], [17, 12], [23, 17], [32, 16], [41, 30], [60, 40]];

/// The sequence of a number.
pub(crate) fn leveled(number: u64) -> Sequence {
    by_lot(number, Beside::Nothing)
}

/// The sequence of a number, with triangles.
pub(crate) fn walled(number: u64) -> Sequence {
    let colored = number.is_multiple_of(2);
    let lot = number.is_multiple_of(3);
    by_lot(number, if lot { Beside::Alone { colored } } else { Beside::Triangles { colored } })
}

/// The sequence of a number, in which objects may be left out.
pub(crate) fn shared(number: u64) -> Sequence {
    let beside =
        [Beside::Nothing, Beside::Triangles { colored: true }][usize::from(number % 8 < 4)];
    let mut sequence = by_lot(number + 1000, beside);
    sequence.settings.share = [0.03125, 0.125, 0.5, 1.0][number as usize % 4];
    sequence.name += " with a share";
    sequence
}

fn by_lot(number: u64, beside: Beside) -> Sequence {
    let mut dice = Dice(number.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x51A7_1E7E);
    dice.bits();
    let settings = settings(&mut dice);
    let whole: Vec<_> = (0..1 + dice.below(3)).map(|i| whole(&mut dice, i, beside)).collect();
    let thing = |dice: &mut Dice| {
        let geometry = dice.below(whole.len());
        let alone = matches!(beside, Beside::Alone { .. });
        let color = dice.vector(Vec3::ZERO, Vec3::ONE);
        let color = (dice.below(3) == 0 && !alone).then_some(color);
        Thing { geometry, keys: keys(dice, middle(&whole[geometry])), color }
    };
    let objects = (0..1 + dice.below(5)).map(|_| thing(&mut dice)).collect();
    let geometries = whole.iter().map(|of| of.surfels.clone()).collect();
    let world = World { geometries, whole, objects, fill: dice.vector(Vec3::ZERO, Vec3::ONE) };
    let still = straight(dice.below(3) == 0, SIZES[number as usize % SIZES.len()]);
    let mut last = camera(&mut dice, still);
    let frames = [[0, 1, 2, 3], [0, 3, 3, 5], [2, 1, 4, 0]][dice.below(3)];
    let frames = frames.into_iter().map(|frame| {
        if dice.below(2) == 0 {
            last = camera(&mut dice, still);
        }
        (frame, last, dice.below(8) > 0)
    });
    let frames = frames.collect();
    let around = Scene { lights: lights(&mut dice), ..scene(surfels(Default::default())) };
    let name = format!("levels of detail, number {number}, {settings:?}");
    Sequence { name, world, around, settings, frames, exact: false }
}

/// How often what was seen.
#[derive(Debug, Default)]
struct Seen {
    views: u64,
    /// Objects with levels of detail that are out of sight.
    out: u64,
    /// Lists that were not looked at to their ends.
    short: u64,
    /// Nodes that are surfels; that stand for some.
    leaves: u64,
    inner: u64,
}

#[test]
fn deferred_views_take_the_nodes_of_the_page() {
    let (exec, mut seen) = (Exec::sequential(), Seen::default());
    for sequence in (0..400).map(leveled) {
        for (frame, camera, _) in &sequence.frames {
            let world = &sequence.world;
            let objects = world.objects().at(*frame).expect("in range");
            let found = objects.seen_from(camera, &exec).expect("ids");
            let name = format!("frame {frame} of {}", sequence.name);
            let view = View::new(world, *frame, camera, (&Default::default(), 0.0));
            assert_eq!(found.median_radius(), view.median, "{name}");
            assert_eq!(found.ids().split(), view.numbers.split, "{name}");
            let ids: Vec<_> = view.every.iter().map(|&(o, s)| view.numbers.id(o, s)).collect();
            assert_eq!(found.drawn_ids(), ids, "{name}");
            assert_eq!(found.drawn_total(), ids.len() as u64, "{name}");
            let (placed, _) = found.flattened(&exec).expect("few");
            assert_eq!(placed.len(), view.surfels.len(), "{name}");
            let (placed, own) = (all_numbers(&placed), all_numbers(&view.surfels));
            assert!(ids.is_empty() || placed == own, "surfels in their places of {name}");
            for o in 0..world.objects.len() {
                let own = view::taken(&objects, o, camera);
                assert_eq!(own.is_some(), found.drawn(o as u32).is_some(), "{name}");
                let all = world.geometries[world.objects[o].geometry].len() as u32;
                assert_eq!(found.ids().all(o as u32), all, "{name}");
                let Some(own) = own else { continue };
                let mask = found.drawn(o as u32).expect("levels of detail");
                let nodes: Vec<_> = mask.surfels().map(|s| s as u32).collect();
                assert_eq!(nodes, own.nodes, "object {o} in {name}");
                assert_eq!(found.ids().count(o as u32), own.first, "object {o} in {name}");
                let list = found.geometry(o as u32).tree().expect("a list").list();
                let leaves = nodes.iter().filter(|n| list.surfel(**n as usize).is_some()).count();
                seen.views += 1;
                seen.out += u64::from(own.first == 0);
                seen.short += u64::from(own.first > 0 && own.first < all);
                seen.leaves += leaves as u64;
                seen.inner += (nodes.len() - leaves) as u64;
            }
        }
    }
    println!("{seen:?}");
    let Seen { out, short, leaves, inner, .. } = seen;
    assert!([out, short, leaves, inner].iter().all(|n| *n > 100), "too easy: {seen:?}");
}

#[test]
fn deferred_ids_of_the_first_few_are_those_of_so_many() {
    let mut dice = Dice(43);
    for _ in 0..60 {
        let objects = 1 + dice.below(5000);
        let most = [1 << 20, (1 << 17) + 5, 1 << 17, 99][dice.below(4)];
        let all: Vec<u32> = (0..objects).map(|_| 1 + dice.below(most) as u32).collect();
        let near = |n: &u32, dice: &mut Dice| match dice.below(40) {
            0 => *n,
            1 => 0,
            _ => dice.below((*n).min(1 << 17) as usize + 1) as u32,
        };
        let counts: Vec<u32> = all.iter().map(|n| near(n, &mut dice)).collect();
        let own = Numbers::new(&counts);
        let found = Ids::first(counts.clone(), all.clone(), |o| format!("object {o}"));
        assert_eq!(own.is_some(), found.is_ok(), "{counts:?}");
        let (Some(own), Ok(found)) = (own, found) else { continue };
        assert_eq!(found.split(), own.split);
        for o in (0..objects).filter(|o| counts[*o] > 0) {
            let last = counts[o] - 1;
            assert_eq!(found.id(o as u32, last), own.id(o, last));
            assert_eq!((found.count(o as u32), found.all(o as u32)), (counts[o], all[o]));
        }
    }
}
